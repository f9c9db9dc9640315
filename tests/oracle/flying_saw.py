"""Reference for the FlyingSaw (TS5055 universal flying saw): the true behaviour on the continuous time axis.

An event loop over stretches on which the master moves one way. Between two events the slave follows one law: a
polynomial of time, with or without a multiple of the master's travel, or a planned curve over the master's position.
The plans are those of `flying_saw_plan`, the own motion that of `flying_saw_motion`, the function blocks' outputs those
of `flying_saw_commands`; each lists the readings of the specification that it takes.

A row is what the step that ends at its time puts out: what is set at that time does not show yet. A result that shows
for one step does so in the row whose step holds it: steps end at the multiples of the scenario's `step_size` and where
something is set, expected, or the master's script breaks.

Further readings of the specification that it leaves open:
- What is set where the master jumps acts with the master after the jump, and a coupled slave starts a new motion from
  what the coupling makes of that; a time-based ramp takes a jump of the master up from the slave's own velocity.
- `coupling_factor` is k while coupled, else 0. `characteristics` keep their values after uncoupling.
- Master positions are unwrapped from the first one in the period; those among the characteristics are put out wrapped.
- Waiting for `master_start_distance`: limits, factor, mode and a standing master are judged at the edge and again at
  the start, the slave's sync position only at the start. On a coupled slave the old coupling goes on meanwhile (its
  backstop, at which the block still parks, is not modelled here). gear_out then makes the slave acceleration-free as
  ever. Refused at the start the slave goes on by its own motion, a coupled one at constant velocity.
- The coupling position counts as passed once the master goes beyond it. Before sync a time-based coupling only notes
  it; passed by then, it must be passed forwards and backwards again to park the slave.
- The time-based limits are those of the own motion from v to the (clamped) target. Where the master's acceleration
  leaves no room (|k·a_m| not below the limit), the slave accelerates at its limit until that changes. A jump of the
  master's velocity and the begin and end of clamping are planned anew as well; the characteristics stay those of the
  edge. The two ignore bits do not concern it.
- The jerk of a coupled slave takes the master's jerk as 0, as far as a unit can know.
- Where a plan after the backstop is refused while the slave still halts, the halt goes on to its end, uncoupled.
- A slave that has reached its target velocity 0 is at STANDSTILL, still with in_velocity.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tests.oracle.flying_saw_commands import ABORTED, BUSY, DONE, ERROR, GROUPS, Command, Pulse, shown
from tests.oracle.flying_saw_curves import ZERO, Curve, value
from tests.oracle.flying_saw_curves import derivative as derived
from tests.oracle.flying_saw_limits import INSTANT_STOP, Axis, by_instant, by_motion, by_plan
from tests.oracle.flying_saw_limits import NONE as WITHIN_LIMITS
from tests.oracle.flying_saw_motion import Phases, limit_towards, move, ramp, ramp_between, stop
from tests.oracle.flying_saw_plan import (
    BAD_FACTOR,
    BAD_LIMIT,
    CHARACTERISTICS,
    CHECKS,
    GEAR_IN_POS,
    NOT_AHEAD,
    Limits,
    Plan,
    Request,
    planned,
    refusal,
    velocity_ramp,
)
from tests.oracle.master import CLOSE, Motion, Number, Stretch, mp, stretches
from tests.oracle.sets import gathered

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "slave.jerk",
    "state_code",
    "plcopen_state",
    "in_sync",
    "coupled",
    "error_id",
    "limit_exceeded",
    "local.exceeded_limit",
    "characteristics.profile",
    "characteristics.master_position_end",
    "characteristics.slave_position_end",
    "characteristics.slave_velocity_min",
    "characteristics.slave_velocity_max",
    "characteristics.slave_acceleration_min",
    "characteristics.slave_acceleration_max",
    "characteristics.slave_jerk_max",
    "characteristics.slave_velocity_mean",
    "characteristics.slave_acceleration_effective",
)
"""What a scenario's reference holds beside the time."""

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a jump makes two rows."""

ROUNDING = mp.mpf("1e-30")
"""Acceleration (u/s2) left at the end of a ramp by rounding."""

INACTIVE, CONSTANT_VELOCITY, ACCELERATING, DECELERATING = 0, 3, 4, 5
PREPHASE, SYNCHRONIZING, SYNCHRON = 11, 12, 13
STANDSTILL, DISCRETE_MOTION, CONTINUOUS_MOTION, SYNCHRONIZED_MOTION, STOPPING = range(1, 6)

LOCKED, BELOW_MINIMUM, ABOVE_MAXIMUM = 0x42EF, 0x4372, 0x4373

BITS = (
    "time_based",
    *CHECKS,
    "rollback_lock",
    "instant_stop_on_rollback",
    "prefer_constant_velocity",
    "ignore_master_acceleration",
    "ignore_slave_acceleration",
    "detailed_error_codes",
)
CHECKED_AT_FIRST = (
    "check_min_position",
    "check_max_position",
    "check_max_velocity",
    "check_max_acceleration",
    "check_max_deceleration",
)
LIMITS = ("velocity", "acceleration", "deceleration", "jerk")
GEAR = ("ratio_numerator", "ratio_denominator", *LIMITS)
INPUTS = {
    "gear_in_velo": GEAR,
    "gear_in_pos": (*GEAR, "master_sync_position", "slave_sync_position", "master_start_distance"),
    "halt": ("deceleration", "jerk"),
    "stop": ("deceleration", "jerk"),
    "move_velocity": LIMITS,
    "move_absolute": ("position", *LIMITS),
    "gear_out": (),
    "reset": (),
}
DEFAULTS: dict[str, Any] = {
    "axis.max_velocity": 2000.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 0.0,
    "axis.max_jerk": 100000.0,
    "axis.min_position": -1e9,
    "axis.max_position": 1e9,
    **{f"sync_mode.{bit}": bit in CHECKED_AT_FIRST for bit in BITS},
    **{f"{group}.{name}": 1 if name.startswith("ratio") else 0.0 for group in GROUPS for name in INPUTS[group]},
    **{f"{group}.execute": False for group in GROUPS},
}
"""What may be set while the block runs, with the start values."""


@dataclass(frozen=True, slots=True)
class Law:
    """Slave position: a polynomial of the time since `begin`, plus `factor` times the master's travel from `origin`."""

    begin: Number
    polynomial: Sequence[Number]
    factor: Number = ZERO
    origin: Number = ZERO

    def at(self, time: Number, master: Motion, side: int = 0) -> tuple[Number, Number, Number, Number]:
        """Position, velocity, acceleration, jerk; they do not depend on the `side` of the time."""
        x = time - self.begin
        s, v, a, j = (value(derived(self.polynomial, order), x) for order in range(4))
        k = self.factor
        return s + k * (master.position - self.origin), v + k * master.velocity, a + k * master.acceleration, j


@dataclass(frozen=True, slots=True)
class Follow:
    """A planned curve over the master's position; velocity, acceleration and jerk by the chain rule."""

    plan: Plan

    def at(self, time: Number, master: Motion, side: int = 0) -> tuple[Number, Number, Number, Number]:
        """Just before the time (`side` -1), at it, or just after it (1)."""
        nominal = self.plan.request.master.velocity
        rate, change = master.velocity / nominal, master.acceleration / nominal
        travelled = (master.position - self.plan.request.master.position) / nominal
        s, v, a, j = self.plan.curve.at(travelled, side * mp.sign(rate) * WINDOW)
        return s, v * rate, a * rate**2 + v * change, j * rate**3 + 3 * a * rate * change


@dataclass(slots=True)
class Coupling:
    """A gear-in command at work.

    `request`: what the edge gave; `position`: the coupling position; `direction` in which the master passes it forwards
    (0: not known yet); `behind`: the master is behind it; `reached`: sync has been reached; `wait_until`: the master
    position to wait for, with `direction` then that of the edge.
    """

    group: str
    request: Request
    state: int
    position: Number
    direction: int
    behind: bool = False
    reached: bool = False
    wait_until: Number | None = None

    @property
    def parked(self) -> bool:
        return self.state == PREPHASE and self.wait_until is None


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The law and the outputs that hold from a time on; `given`: because of something set at that time.

    `axis`: the machine data then; `exceeded`: which limit the motion under way exceeds, as it was planned.
    """

    time: Number
    given: bool
    law: Law | Follow
    outputs: Mapping[str, float]
    axis: Axis
    exceeded: int


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `step_size`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows,
    just before and just after, where the motion jumps or changes its state within 1e-9 s of a time.
    """
    wanted = sorted(set(times))
    run = _Run(script, mp.mpf(max([script["stop_time"], *wanted])) + WINDOW)
    return [row for time in wanted for row in run.rows(time)]


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order.

    Raises ValueError for a set at or before 0 and for a set of something that is neither an input nor tunable.
    """
    run = _Run(script, mp.mpf(script["stop_time"]))
    return [(float(time), name) for time, name in run.log]


class _Run:
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through."""

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: start.get(name, default) for name, default in DEFAULTS.items()}
        self.period = mp.mpf(start.get("master.period", 0))
        self.cosine = mp.cos(mp.mpf(start.get("diagonal_angle", 0)) * mp.pi / 180)
        self.commands = {group: Command(group, bool(self.inputs[f"{group}.execute"])) for group in GROUPS}
        position, velocity = (mp.mpf(start.get(f"axis.initial_{name}", 0)) for name in ("position", "velocity"))
        self.law: Law | Follow = Law(ZERO, [position, velocity])
        self.phases: Phases = []
        self.phase_end = mp.inf
        self.own_state = CONTINUOUS_MOTION
        self.own_end: Motion | None = None
        self.owner: str | None = None
        self.lock = False
        self.coupling: Coupling | None = None
        self.time_based: Request | None = None
        self.error_id = 0
        self.exceeded = WITHIN_LIMITS
        self.characteristics: dict[str, float] = {f"characteristics.{name}": 0.0 for name in CHARACTERISTICS}
        self.master = _wrapped_start(stretches(script["master"], horizon), self.period)
        self.begins = [stretch.begin for stretch in self.master]
        self.stretch = self.master[0]
        self.time = ZERO
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.snapshots: list[Snapshot] = []
        self._snap(-mp.inf)
        self.grid = _points(script)
        sets = gathered(script.get("set", ()), DEFAULTS)
        self._run([(mp.mpf(at), values) for at, values in sets.items()], horizon)
        self.pulses = sorted((p for c in self.commands.values() for p in c.pulses), key=lambda p: p.time)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, sets: list[tuple[Number, dict[str, Any]]], horizon: Number) -> None:
        """All stretches, interrupted by the sets; what the motion does at the time of a set comes before it."""
        last = len(self.master) - 1
        for index, stretch in enumerate(self.master[1:], start=1):
            self._enter(stretch)
            while sets and (sets[0][0] < stretch.end or (index == last and sets[0][0] <= horizon)):
                at, values = sets.pop(0)
                self._until(at)
                self._set(values)
            self._until(stretch.end)

    def _note(self, name: str = "") -> None:
        """The present law and outputs hold from now on."""
        self._snap(self.time)
        if name:
            self.log.append((self.time, name))

    def _snap(self, time: Number) -> None:
        axis = Axis.of(self.inputs)
        self.snapshots.append(Snapshot(time, self.given, self.law, self._outputs(), axis, self.exceeded))

    def _enter(self, stretch: Stretch) -> None:
        """The master goes on by another stretch; a time-based ramp is planned anew where its target jumps."""
        slave, target = self._slave(), self._target()
        self.stretch, self.time = stretch, stretch.begin
        if any(abs(a - b) > CLOSE * (1 + abs(a)) for a, b in zip(target, self._target(), strict=True)):
            self._plan_time_based(slave)
        if self.coupling and self.coupling.direction == 0:
            self.coupling.direction = stretch.direction
        self._note()

    def _until(self, until: Number) -> None:
        """Everything that happens by itself until then."""
        for _ in range(100_000):
            event = self._next(until)
            if event is None:
                self.time = until
                return
            self.time, act = event
            act()
        raise ArithmeticError(f"no progress at {self.time}")

    def _next(self, until: Number) -> tuple[Number, Callable[[], None]] | None:
        """The first thing that happens until then."""
        found: list[tuple[Number, Callable[[], None]]] = []
        if self.phase_end <= until:
            found.append((self.phase_end, self._phase_over))
        if isinstance(self.law, Follow):
            forwards = int(mp.sign(self.law.plan.request.master.velocity))
            at = self._passes(self.law.plan.master_end, forwards, until, touching=True)
            found += [(at, self._follow_over)] if at is not None else []
        if self.time_based:
            found += [(at, self._replan_time_based) for at in self._clamp_changes(until)]
        found += self._coupling_events(until)
        return min(found, key=lambda event: event[0]) if found else None

    def _coupling_events(self, until: Number) -> list[tuple[Number, Callable[[], None]]]:
        coupling = self.coupling
        if not coupling:
            return []
        if coupling.wait_until is not None:
            at = self._passes(coupling.wait_until, coupling.direction, until, touching=True)
            return [(at, self._start_after_waiting)] if at is not None else []
        if coupling.behind:
            at = self._passes(coupling.position, coupling.direction, until)
            return [(at, self._passed_forwards)] if at is not None else []
        at = self._passes(coupling.position, -coupling.direction, until)
        return [(at, self._passed_backwards)] if at is not None else []

    def _passes(self, position: Number, direction: int, until: Number, *, touching: bool = False) -> Number | None:
        """When the master goes beyond (or touches) a position in that direction; now if it is beyond already."""
        if direction == 0 or self.stretch.direction != direction:
            here = self.stretch.at(self.time).position
            return self.time if touching and direction and (here - position) * direction >= 0 else None
        here, there = (self.stretch.at(time).position for time in (self.time, until))
        margin = CLOSE * (1 + abs(position))
        if (there - position) * direction <= (-margin if touching else margin):
            return None
        return self.time if (here - position) * direction >= 0 else self.stretch.when(position, self.time, until)

    # --- present values -------------------------------------------------------------------------------------------

    def _master_now(self) -> Motion:
        return self.stretch.at(self.time)

    def _slave(self) -> Motion:
        """The slave's motion now."""
        s, v, a, _ = self.law.at(self.time, self._master_now())
        return Motion(s, v, a)

    def _resting(self) -> bool:
        """Uncoupled at rest: nothing will move by itself."""
        return isinstance(self.law, Law) and self.law.factor == 0 and not any(self.law.polynomial[1:])

    # --- the slave's own motion -----------------------------------------------------------------------------------

    def _move_by(self, slave: Motion, phases: Phases, end: Motion | None, own_state: int) -> None:
        """The phases from here on; `end`: the velocity, and for a move the position, to which it comes exactly."""
        self.time_based = None
        self.phases, self.own_end, self.own_state = list(phases), end, own_state
        self.exceeded = by_motion(slave, tuple(phases), Axis.of(self.inputs))
        self._next_phase(slave)

    def _next_phase(self, slave: Motion) -> None:
        """The law of the next phase; after the last one what its end says."""
        if not self.phases:
            self._arrive(slave)
            return
        duration, jerk = self.phases.pop(0)
        self.law = self._phase_law(slave, jerk)
        self.phase_end = self.time + duration

    def _phase_law(self, slave: Motion, jerk: Number) -> Law:
        """Constant jerk; that of a time-based ramp is relative to its target."""
        if not self.time_based:
            acceleration = slave.acceleration if jerk or abs(slave.acceleration) > ROUNDING else ZERO
            return Law(self.time, [slave.position, slave.velocity, acceleration / 2, jerk / 6])
        if self._clamped():
            return Law(self.time, [slave.position, slave.velocity, slave.acceleration / 2, jerk / 6])
        velocity, acceleration = self._target()
        relative = [slave.position, slave.velocity - velocity, (slave.acceleration - acceleration) / 2, jerk / 6]
        return Law(self.time, relative, self.time_based.factor, self._master_now().position)

    def _phase_over(self) -> None:
        law = self.law
        assert isinstance(law, Law)
        if self.coupling and self.coupling.parked:
            slave = self._slave()
            self._stand(slave.position)
            self._note("parked slave stands")
            return
        self._next_phase(self._slave())
        self._note()

    def _stand(self, position: Number) -> None:
        self._constant(position, ZERO)

    def _constant(self, position: Number, velocity: Number) -> None:
        """Free of acceleration at once."""
        self.phases, self.phase_end, self.time_based = [], mp.inf, None
        self.exceeded = WITHIN_LIMITS
        self.law = Law(self.time, [position, velocity])

    def _arrive(self, slave: Motion) -> None:
        """The last phase is over: in sync, or at rest, or at the wanted velocity."""
        self.phase_end, self.exceeded = mp.inf, WITHIN_LIMITS
        if self.time_based:
            if self._clamped():
                self.law = Law(self.time, [slave.position, self._target()[0]])
                return
            self._synchronous(self.time_based.factor, slave.position, self._master_now().position)
            return
        end = self.own_end
        assert end
        position = slave.position if end.position is None else end.position
        self.law = Law(self.time, [position, end.velocity])
        owner = self.commands[self.owner] if self.owner and not self.coupling else None
        if owner and owner.shows == BUSY:
            owner.finish(DONE, self.time, self.given)
            self.log.append((self.time, f"{owner.group} done"))
            if owner.group != "move_velocity":
                self.owner = None
        self._release()

    def _release(self) -> None:
        """The lock of stop ends at rest with execute false."""
        if self.lock and self._resting() and not self.commands["stop"].execute:
            self.lock = False

    # --- coupled --------------------------------------------------------------------------------------------------

    def _synchronous(self, factor: Number, slave: Number, master: Number) -> None:
        """From now on the slave is synchronous; in sync unless the coupling waits for a new start."""
        self.phases, self.phase_end, self.time_based = [], mp.inf, None
        self.exceeded = WITHIN_LIMITS
        self.law = Law(self.time, [slave], factor, master)
        if self.coupling and self.coupling.wait_until is None:
            self.coupling.state, self.coupling.reached = SYNCHRON, True
            self.log.append((self.time, "in sync"))
            if self.owner == self.coupling.group:
                self.commands[self.owner].finish(DONE, self.time, self.given)

    def _follow_over(self) -> None:
        """The profile ends where it was planned to."""
        law = self.law
        assert isinstance(law, Follow)
        slave = law.plan.curve.finish()[0]
        self._synchronous(law.plan.request.factor, slave, law.plan.master_end)
        self._note()

    def _synchronize(self, plan: Plan) -> None:
        """An accepted plan begins."""
        request, slave = plan.request, self._slave()
        assert self.coupling
        self.coupling.state, self.coupling.wait_until, self.coupling.reached = SYNCHRONIZING, None, False
        self.phases, self.phase_end, self.time_based = [], mp.inf, None
        self._show_characteristics(plan)
        self.exceeded = by_plan(plan.curve, Axis.of(self.inputs))
        self.log.append((self.time, f"synchronizing, profile {plan.profile}"))
        if not plan.profile:
            self._synchronous(request.factor, slave.position, self._master_now().position)
        elif request.time_based:
            self.time_based = request
            self._plan_time_based(slave)
        else:
            self.law = Follow(plan)

    def _show_characteristics(self, plan: Plan) -> None:
        for name, number in plan.characteristics.items():
            if name.startswith("master_position") and self.period > 0:
                self.characteristics[f"characteristics.{name}"] = float(_wrapped(number, self.period))
            else:
                self.characteristics[f"characteristics.{name}"] = float(number) + 0.0

    def _start_after_waiting(self) -> None:
        """The master has come to the start distance: plan and check with the values of the edge."""
        coupling = self.coupling
        assert coupling
        plan = self._plan(coupling.request)
        if plan.error:
            slave = self._slave()
            self._give_up(plan.error)
            if self.time_based or isinstance(self.law, Follow) or self.law.factor:
                self._constant(slave.position, slave.velocity)
                self.own_state = CONTINUOUS_MOTION
        else:
            coupling.position, coupling.behind = self._master_now().position, False
            self._synchronize(plan)
        self._note()

    def _give_up(self, error_id: int) -> None:
        """A plan for a coupling is refused: the slave is uncoupled; the block tells why if it still has the command."""
        coupling, self.coupling, self.error_id = self.coupling, None, error_id
        assert coupling
        if self.owner == coupling.group:
            self.commands[self.owner].finish(ERROR, self.time, self.given, error_id)
        self.owner = None
        self.log.append((self.time, f"{coupling.group} refused {error_id:#x}"))

    def _plan(self, edge: Request) -> Plan:
        """The edge's request for the states of now."""
        return planned(replace(edge, master=self._master_now(), slave=self._slave()))

    # --- time based -----------------------------------------------------------------------------------------------

    def _clamped(self) -> bool:
        """The target velocity is beyond the limit, or at it and going beyond."""
        assert self.time_based
        master, factor = self._master_now(), self.time_based.factor
        velocity, change = factor * master.velocity, factor * master.acceleration
        excess = abs(velocity) - self.time_based.limits.velocity
        if abs(excess) <= CLOSE * self.time_based.limits.velocity:
            return bool(velocity * change > 0)
        return bool(excess > 0)

    def _target(self) -> tuple[Number, Number]:
        """The velocity and acceleration that a time-based ramp aims at now; 0 if there is none."""
        if not self.time_based:
            return ZERO, ZERO
        master, factor = self._master_now(), self.time_based.factor
        if self._clamped():
            return mp.sign(factor * master.velocity) * self.time_based.limits.velocity, ZERO
        return factor * master.velocity, factor * master.acceleration

    def _clamp_changes(self, until: Number) -> list[Number]:
        """When |k·v_m| next comes to the velocity limit, if it does so until then."""
        assert self.time_based
        if self.stretch.jerk != 0:
            raise ValueError("time-based synchronisation needs a master whose acceleration is constant in each segment")
        master = self._master_now()
        if master.acceleration == 0:
            return []
        limit = self.time_based.limits.velocity / abs(self.time_based.factor)
        delays = ((mp.sign(side) * limit - master.velocity) / master.acceleration for side in (1, -1))
        return [self.time + d for d in delays if d > CLOSE and self.time + d <= until]

    def _replan_time_based(self) -> None:
        self._plan_time_based(self._slave())
        self._note()

    def _plan_time_based(self, slave: Motion) -> None:
        """The ramp in w = v - target, with the limits of the own motion shifted by the target's acceleration."""
        assert self.time_based
        limits = self.time_based.limits
        velocity, acceleration = self._target()
        limit = limit_towards(slave.velocity, velocity, limits.acceleration, limits.deceleration)
        self.phases = ramp_between(
            slave.velocity - velocity,
            slave.acceleration - acceleration,
            -limit - acceleration,
            limit - acceleration,
            limits.jerk,
        )
        self._next_phase(slave)

    # --- reversal -------------------------------------------------------------------------------------------------

    def _passed_backwards(self) -> None:
        """The master, having turned round, passes the coupling position."""
        coupling = self.coupling
        assert coupling
        coupling.behind = True
        bits = coupling.request.bits
        if self.time_based or (coupling.reached and "rollback_lock" not in bits):
            return
        slave = self._slave()
        coupling.state = PREPHASE
        self.log.append((self.time, "parked"))
        if self.owner == coupling.group:
            self.commands[coupling.group].start()
        self._stand(slave.position)
        if "instant_stop_on_rollback" not in bits:
            self._halt_parked(slave)
        elif slave.velocity != 0:
            self.exceeded = INSTANT_STOP
        self._note()

    def _halt_parked(self, slave: Motion) -> None:
        """Velocity to 0 by the gear_in_velo ramp, in time."""
        assert self.coupling
        request = self.coupling.request
        jerk = request.limits.jerk if "check_max_jerk" in request.bits else None
        v, a, limit = slave.velocity, slave.acceleration, request.limits.deceleration
        curve: Curve = velocity_ramp(slave.position, v, a, ZERO, limit, jerk)
        if curve.pieces:
            self.law = Law(self.time, curve.pieces[0].polynomial)
            self.phase_end = self.time + curve.duration
            self.exceeded = by_plan(curve, Axis.of(self.inputs))

    def _passed_forwards(self) -> None:
        """The master passes the coupling position again: a parked slave is synchronised anew."""
        coupling = self.coupling
        assert coupling
        coupling.behind = False
        if not coupling.parked:
            return
        plan = self._plan(coupling.request)
        if plan.error:
            self._give_up(plan.error)
            self.own_end, self.own_state = Motion(None, ZERO, ZERO), DISCRETE_MOTION
        else:
            self._synchronize(plan)
        self._note()

    # --- commands -------------------------------------------------------------------------------------------------

    def _set(self, values: Mapping[str, Any]) -> None:
        """The inputs set now: falling edges, then the commands in their order."""
        before, self.inputs, self.given = self.inputs, {**self.inputs, **values}, True
        levels = {group: (bool(before[f"{group}.execute"]), bool(self.inputs[f"{group}.execute"])) for group in GROUPS}
        for group, (was, now) in levels.items():
            if was and not now:
                self.commands[group].fall()
        self._release()
        for group, (was, now) in levels.items():
            if now and not was:
                self.commands[group].execute = True
                self._command(group)
        self._note()
        self.given = False

    def _command(self, group: str) -> None:
        if self.lock and group not in ("reset", "stop"):
            self._refuse(group, LOCKED)
            return
        match group:
            case "reset" | "gear_out":
                self._immediate(group)
            case "stop" | "halt":
                self._stop(group)
            case "move_velocity":
                self._move_velocity()
            case "move_absolute":
                self._move_absolute()
            case _:
                self._gear_in(group)

    def _refuse(self, group: str, error_id: int) -> None:
        if self.owner == group:
            self.owner = None
        self.error_id = error_id
        self.commands[group].finish(ERROR, self.time, self.given, error_id)
        self.log.append((self.time, f"{group} refused {error_id:#x}"))

    def _accept(self, group: str) -> None:
        """The command takes the axis over; the one that had it is aborted."""
        self.error_id = 0
        self._abort(group)
        self.owner = group
        self.commands[group].start()
        self.log.append((self.time, f"{group} accepted"))

    def _abort(self, by: str) -> None:
        if self.owner and self.owner != by:
            self.commands[self.owner].finish(ABORTED, self.time, self.given)
        self.owner = None

    def _immediate(self, group: str) -> None:
        """reset and gear_out are done at once."""
        self.error_id = 0
        self.commands[group].finish(DONE, self.time, self.given)
        self.log.append((self.time, f"{group} done"))
        if group == "gear_out" and self.coupling:
            slave = self._uncoupled()
            self._abort(group)
            self._constant(slave.position, slave.velocity)
            self.own_state = CONTINUOUS_MOTION

    def _uncoupled(self) -> Motion:
        """The slave's motion with which an own motion starts; the coupling is gone."""
        self.coupling = None
        return self._slave()

    def _limit(self, group: str, name: str) -> Number:
        """A limit of a command; 0 means the axis's."""
        given = self.inputs[f"{group}.{name}"]
        return mp.mpf(given) if given != 0 else self._axis_limit(name)

    def _axis_limit(self, name: str) -> Number:
        """A limit of the axis; a deceleration of 0 means the acceleration."""
        given = self.inputs[f"axis.max_{name}"]
        return mp.mpf(self.inputs["axis.max_acceleration"] if name == "deceleration" and given == 0 else given)

    def _valid(self, *limits: Number) -> bool:
        return all(mp.isfinite(limit) and limit > 0 for limit in limits)

    def _stop(self, group: str) -> None:
        deceleration, jerk = self._limit(group, "deceleration"), self._limit(group, "jerk")
        if not self._valid(deceleration, jerk):
            self._refuse(group, BAD_LIMIT)
            return
        self._accept(group)
        self.lock = group == "stop"
        slave = self._uncoupled()
        self._move_by(slave, stop(slave, deceleration, jerk), Motion(None, ZERO, ZERO), DISCRETE_MOTION)

    def _move_velocity(self) -> None:
        target = mp.mpf(self.inputs["move_velocity.velocity"])
        limits = [self._limit("move_velocity", name) for name in LIMITS[1:]]
        most = mp.mpf(self.inputs["axis.max_velocity"])
        if not self._valid(most, *limits) or not abs(target) <= most:
            self._refuse("move_velocity", BAD_LIMIT)
            return
        self._accept("move_velocity")
        slave = self._uncoupled()
        limit = limit_towards(slave.velocity, target, *limits[:2])
        phases = ramp(slave.velocity, slave.acceleration, target, limit, limits[2])
        self._move_by(slave, phases, Motion(None, target, ZERO), CONTINUOUS_MOTION)

    def _move_absolute(self) -> None:
        target = mp.mpf(self.inputs["move_absolute.position"])
        limits = [self._limit("move_absolute", name) for name in LIMITS]
        error = 0 if self._valid(*limits) else BAD_LIMIT
        if not error and not target >= mp.mpf(self.inputs["axis.min_position"]):
            error = BELOW_MINIMUM
        if not error and not target <= mp.mpf(self.inputs["axis.max_position"]):
            error = ABOVE_MAXIMUM
        if error:
            self._refuse("move_absolute", error)
            return
        self._accept("move_absolute")
        slave = self._uncoupled()
        self._move_by(slave, move(slave, target, *limits), Motion(target, ZERO, ZERO), DISCRETE_MOTION)

    def _gear_in(self, group: str) -> None:
        request, distance = self._request(group)
        if request is None:
            self._refuse(group, BAD_FACTOR)
            return
        master, direction = request.master, int(mp.sign(request.master.velocity)) or self.stretch.direction
        error = refusal(request, slave_side=False) or (NOT_AHEAD if distance < 0 else 0)
        wait_until = request.sync[0] - direction * distance if request.sync and distance > 0 else master.position
        plan = None
        if not error and (wait_until - master.position) * direction <= 0:
            plan = planned(request)
            error = plan.error
        if error:
            self._refuse(group, error)
            return
        self._accept(group)
        self.coupling = Coupling(group, request, PREPHASE, master.position, direction, wait_until=wait_until)
        if plan:
            self._synchronize(plan)

    def _request(self, group: str) -> tuple[Request | None, Number]:
        """What the edge asks for, and the start distance (u); None if there is no factor."""
        denominator = mp.mpf(self.inputs[f"{group}.ratio_denominator"])
        if not denominator > 0:
            return None, ZERO
        factor = mp.mpf(self.inputs[f"{group}.ratio_numerator"]) / denominator / self.cosine
        master, sync, distance = self._master_now(), None, ZERO
        if group == GEAR_IN_POS:
            wanted, slave = (mp.mpf(self.inputs[f"{group}.{name}_sync_position"]) for name in ("master", "slave"))
            sync = (self._ahead(wanted, master), slave)
            distance = mp.mpf(self.inputs[f"{group}.master_start_distance"])
        bits = frozenset(bit for bit in BITS if self.inputs[f"sync_mode.{bit}"])
        ends = mp.mpf(self.inputs["axis.min_position"]), mp.mpf(self.inputs["axis.max_position"])
        limits = Limits(*(self._limit(group, name) for name in LIMITS))
        return Request(group, master, self._slave(), factor, limits, bits, ends, sync), distance

    def _ahead(self, wanted: Number, master: Motion) -> Number:
        """A sync position within the period means its next occurrence ahead of the master."""
        direction = mp.sign(master.velocity)
        if not (0 <= wanted < self.period) or direction == 0:
            return wanted
        turns = mp.floor((master.position - wanted) * direction / self.period) + 1
        return wanted + direction * turns * self.period

    # --- outputs --------------------------------------------------------------------------------------------------

    def _outputs(self) -> dict[str, float]:
        """The outputs that do not change between two events."""
        coupling = self.coupling
        synchronizing = coupling is not None and coupling.state != PREPHASE
        result = {
            "in_sync": float(coupling is not None and coupling.state == SYNCHRON),
            "coupled": float(coupling is not None),
            "coupling_factor": float(coupling.request.factor) if coupling else 0.0,
            "plcopen_state": float(self._plcopen_state()),
            "error": float(self.error_id != 0),
            "error_id": float(self.error_id),
            "coupled_state": float(coupling.state) if coupling else 0.0,
        }
        for command in self.commands.values():
            result |= command.outputs(synchronizing)
        return result | self.characteristics

    def _plcopen_state(self) -> int:
        if self.lock:
            return STOPPING
        if self.coupling:
            return SYNCHRONIZED_MOTION
        return STANDSTILL if self._resting() else self.own_state

    def rows(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if the motion changes a column within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.snapshots, t - WINDOW, key=lambda s: s.time) - 1
        last = bisect_right(self.snapshots, t + WINDOW, key=lambda s: s.time)
        latest = first
        while latest + 1 < last and not self.snapshots[latest + 1].given:
            latest += 1
        early = self._row(t, self.snapshots[first], -1)
        late = self._row(t, self.snapshots[latest], +1) if time > 0 else early
        return [early] if early == late else [early, late]

    def _row(self, t: Number, snapshot: Snapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity and the pulses of one side (-1 or 1) of it."""
        stretch = self.master[bisect_right(self.begins, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begins, t) - 1].at(t).position
        s, v, a, j = snapshot.law.at(t, replace(stretch.at(t), position=position), side)
        outputs = dict(snapshot.outputs)
        state = outputs.pop("coupled_state") or _own_state(v, a)
        for pulse in self._pulses(t, side):
            synchronizing = outputs["coupled"] != 0 and state != PREPHASE
            outputs |= shown(pulse.group, pulse.shows, pulse.error_id, synchronizing)
        found = {snapshot.exceeded, by_instant((s, v, a, j), snapshot.axis)} if t > 0 else set()
        exceeded = min(found - {WITHIN_LIMITS}, default=WITHIN_LIMITS)
        row = {
            "time": float(t),
            "slave.position": float(s) + 0.0,
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(a) + 0.0,
            "slave.jerk": float(j) + 0.0,
            "state": float(state),
            "state_code": float(state),
            "limit_exceeded": float(exceeded != WITHIN_LIMITS),
            "local.exceeded_limit": float(exceeded),
        }
        return row | outputs

    def _pulses(self, t: Number, side: int) -> list[Pulse]:
        """The results shown in the step that ends at t: those that arose in it, whether or not just at its ends."""
        begin = self.grid[max(bisect_left(self.grid, t - WINDOW) - 1, 0)]
        found = []
        for pulse in self.pulses:
            early, late = pulse.time - begin, pulse.time - t
            if pulse.given or side < 0:
                inside = early >= -WINDOW and late < -WINDOW
            else:
                inside = early > WINDOW and late <= WINDOW
            found += [pulse] if inside else []
        return found


def _own_state(v: Number, a: Number) -> int:
    v, a = (ZERO if abs(x) < ROUNDING else x for x in (v, a))
    if v == 0 and a == 0:
        return INACTIVE
    if a == 0:
        return CONSTANT_VELOCITY
    return DECELERATING if v * a < 0 else ACCELERATING


def _wrapped_start(pieces: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return pieces
    shift = mp.floor(pieces[0].start.position / period) * period
    return [replace(p, start=replace(p.start, position=p.start.position - shift)) for p in pieces]


def _wrapped(position: Number, period: Number) -> Number:
    result = position - mp.floor(position / period) * period
    return ZERO if float(result) >= float(period) else result


def _points(script: Mapping[str, Any]) -> list[Number]:
    """The ends of the steps: multiples of the step size, and where something is set, expected, or the script breaks."""
    stop, step = float(script["stop_time"]), float(script["step_size"])
    points = [i * step for i in range(int(stop / step * (1 + 1e-12)) + 1)]
    points += [float(table["at"]) for table in script.get("set", ())]
    points += [float(table[key]) for table in script.get("expect", ()) for key in ("at", "from", "to") if key in table]
    end = 0.0
    for segment in script["master"].get("segments", ()):
        end += float(segment["duration"])
        points.append(end)
    return [mp.mpf(p) for p in sorted({*points, stop}) if p <= stop]
