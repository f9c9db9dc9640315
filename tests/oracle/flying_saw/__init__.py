"""Reference for the FlyingSaw (TS5055 universal flying saw): the true behaviour on the continuous time axis.

An event loop over stretches on which the master moves one way. Between two events the slave follows one law: a
polynomial of time, with or without a multiple of the master's travel, or a planned curve over the master's position.
The plans are those of `flying_saw_plan`, the time-based ramp that of `flying_saw_time_based`, the own motion that of
`flying_saw_own_motion`, the function blocks' outputs those of `flying_saw_commands`; each lists the readings of the
specification that it takes.

A row is what the step that ends at its time puts out: what is set at that time does not show yet. A result that shows
for one step does so in the row whose step holds it: steps end at the multiples of the scenario's `step_size` and where
something is set, expected, or the master's script breaks.

Further readings of the specification that it leaves open:
- What is set where the master jumps acts with the master after the jump, and a coupled slave starts a new motion from
  what the coupling makes of that; a time-based ramp takes a jump of the master up from the slave's own velocity.
- `coupling_factor` is k while coupled, else 0. `characteristics` keep their values after uncoupling.
- The cycle of an encoder as master is its sample time, or without one the scenario's step.
- Master positions are unwrapped from the first one in the period; those among the characteristics are shown wrapped.
- Waiting for `master_start_distance`: limits, factor, mode and a master at rest are checked at the edge and again at
  the start, the slave's sync position only at the start. On a coupled slave the old coupling goes on meanwhile (its
  backstop, at which the block still parks, is not modelled here). gear_out then makes the slave acceleration-free as
  ever. Refused at the start the slave goes on by its own motion, a coupled one at constant velocity.
- The coupling position counts as passed once the master goes beyond it. Before sync a time-based coupling parks the
  slave there if one of the two reversal bits is set: at once with the instant stop, else by the halt of case 5.
- The jerk of a coupled slave takes the master's jerk as 0, as far as a unit can know.
- Where a plan after the backstop is refused while the slave still halts, the halt goes on to its end, uncoupled.
- A slave that has reached its target velocity 0 is at STANDSTILL, still with in_velocity.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from tests.oracle.event_run import Event, EventRun, events_of, rows_of
from tests.oracle.flying_saw.commands import ABORTED, BUSY, DONE, ERROR, GROUPS, Command
from tests.oracle.flying_saw.coupling import Coupling, passing_time
from tests.oracle.flying_saw.curves import ZERO, Curve
from tests.oracle.flying_saw.inputs import DEFAULTS, read_request
from tests.oracle.flying_saw.laws import Follow, Law
from tests.oracle.flying_saw.limits import INSTANT_STOP, AxisData, by_motion, by_plan
from tests.oracle.flying_saw.limits import NONE as WITHIN_LIMITS
from tests.oracle.flying_saw.motion import Phases
from tests.oracle.flying_saw.own_motion import read_own_motion
from tests.oracle.flying_saw.period import wrap, wrap_start
from tests.oracle.flying_saw.plan import (
    BAD_FACTOR,
    CHARACTERISTICS,
    NOT_AHEAD,
    Plan,
    planned,
    refusal,
    velocity_ramp,
)
from tests.oracle.flying_saw.request import Request
from tests.oracle.flying_saw.rows import (
    CONTINUOUS_MOTION,
    DISCRETE_MOTION,
    PREPHASE,
    ROUNDING,
    STANDSTILL,
    STOPPING,
    SYNCHRON,
    SYNCHRONIZED_MOTION,
    SYNCHRONIZING,
    FlyingSawRows,
    SawSnapshot,
    step_ends,
)
from tests.oracle.flying_saw.time_based import TimeBasedRamp
from tests.oracle.master import CLOSE, Motion, Stretch, stretches
from tests.oracle.motion_start import begin_of_own_motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
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

LOCKED = 0x42EF


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `step_size`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows,
    just before and just after, where the motion jumps or changes its state within 1e-9 s of a time.
    """
    return rows_of(FlyingSawRun, script, times)


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order.

    Raises ValueError for a set at or before 0 and for a set of something that is neither an input nor tunable.
    """
    return events_of(FlyingSawRun, script)


class FlyingSawRun(EventRun):
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through."""

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: start.get(name, default) for name, default in DEFAULTS.items()}
        self.period = mp.mpf(start.get("master.period", 0))
        cycle = start.get("master.sample_time", 0) or script["step_size"]
        self.encoder_noise = 2 * mp.mpf(start.get("master.encoder_scaling", 0)) / mp.mpf(cycle) ** 2
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
        self.time_based: TimeBasedRamp | None = None
        self.error_id = 0
        self.exceeded = WITHIN_LIMITS
        self.characteristics: dict[str, float] = {f"characteristics.{name}": 0.0 for name in CHARACTERISTICS}
        self.master = wrap_start(stretches(script["master"], horizon), self.period)
        self.begin_times = [stretch.begin for stretch in self.master]
        self.stretch = self.master[0]
        self.time = ZERO
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.snapshots: list[SawSnapshot] = []
        self._snap(-mp.inf)
        sets = gathered(script.get("set", ()), DEFAULTS)
        self._run([(mp.mpf(at), values) for at, values in sets.items()], horizon)
        pulses = sorted((p for c in self.commands.values() for p in c.pulses), key=lambda p: p.time)
        self.outputs = FlyingSawRows(self.snapshots, self.master, self.begin_times, pulses, step_ends(script))

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
        axis = AxisData.of(self.inputs)
        self.snapshots.append(SawSnapshot(time, self.given, self.law, self._outputs(), axis, self.exceeded))

    def _enter(self, stretch: Stretch) -> None:
        """The master goes on by another stretch; a time-based ramp is planned anew where its target jumps."""
        slave, target = self._slave(), self._target()
        self.stretch, self.time = stretch, stretch.begin
        if any(abs(a - b) > CLOSE * (1 + abs(a)) for a, b in zip(target, self._target(), strict=True)):
            self._plan_time_based(slave)
        if self.coupling and self.coupling.direction == 0:
            self.coupling.direction = stretch.direction
        self._note()

    def _next(self, until: Number) -> Event | None:
        """The first thing that happens until then."""
        result: list[Event] = []
        if self.phase_end <= until:
            result.append((self.phase_end, self._phase_over))
        if isinstance(self.law, Follow):
            forwards = int(mp.sign(self.law.plan.request.master.velocity))
            at = passing_time(self.stretch, self.time, until, self.law.plan.master_end, forwards, touching=True)
            result += [(at, self._follow_over)] if at is not None else []
        if self.time_based:
            changes = self.time_based.clamp_changes(self.stretch, self.time, until)
            result += [(at, self._replan_time_based) for at in changes]
        result += self._coupling_events(until)
        return min(result, key=lambda event: event[0]) if result else None

    def _coupling_events(self, until: Number) -> list[Event]:
        coupling = self.coupling
        if not coupling:
            return []
        if coupling.wait_until is not None:
            at = passing_time(self.stretch, self.time, until, coupling.wait_until, coupling.direction, touching=True)
            return [(at, self._start_after_waiting)] if at is not None else []
        if coupling.behind:
            at = passing_time(self.stretch, self.time, until, coupling.position, coupling.direction)
            return [(at, self._passed_forwards)] if at is not None else []
        at = passing_time(self.stretch, self.time, until, coupling.position, -coupling.direction)
        return [(at, self._passed_backwards)] if at is not None else []

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

    def _move_by(self, slave: Motion, phases: Phases, end: Motion | None, own_state: int, beyond: int) -> None:
        """The phases from here on; `end`: the velocity, and for a move the position, to which it comes exactly;
        `beyond`: the limit that the state before was beyond."""
        self.time_based = None
        self.phases, self.own_end, self.own_state = list(phases), end, own_state
        limits = {by_motion(slave, tuple(phases), AxisData.of(self.inputs)), beyond} - {WITHIN_LIMITS}
        self.exceeded = min(limits, default=WITHIN_LIMITS)
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
        if self.time_based:
            return self.time_based.law(self.time, slave, self._master_now(), jerk)
        acceleration = slave.acceleration if jerk or abs(slave.acceleration) > ROUNDING else ZERO
        return Law(self.time, [slave.position, slave.velocity, acceleration / 2, jerk / 6])

    def _phase_over(self) -> None:
        law = self.law
        assert isinstance(law, Law)
        if self.coupling and self.coupling.parked:
            slave = self._slave()
            self._stand(slave.position)
            self._note("parked slave at rest")
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
        """The last phase is over: in sync, or at rest, or at the requested velocity."""
        self.phase_end, self.exceeded = mp.inf, WITHIN_LIMITS
        if self.time_based:
            if self.time_based.is_clamped(self._master_now()):
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
        """An accepted plan starts."""
        request, slave = plan.request, self._slave()
        assert self.coupling
        self.coupling.state, self.coupling.wait_until, self.coupling.reached = SYNCHRONIZING, None, False
        self.phases, self.phase_end, self.time_based = [], mp.inf, None
        self._show_characteristics(plan)
        self.exceeded = by_plan(plan.curve, AxisData.of(self.inputs))
        self.log.append((self.time, f"synchronizing, profile {plan.profile}"))
        if not plan.profile:
            self._synchronous(request.factor, slave.position, self._master_now().position)
        elif request.time_based:
            self.time_based = TimeBasedRamp(request.factor, request.limits)
            self._plan_time_based(slave)
        else:
            self.law = Follow(plan)

    def _show_characteristics(self, plan: Plan) -> None:
        for name, number in plan.characteristics.items():
            if name.startswith("master_position") and self.period > 0:
                self.characteristics[f"characteristics.{name}"] = float(wrap(number, self.period))
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
        """A plan for a coupling is refused: the slave is uncoupled; the block shows why if it still has the command."""
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

    def _target(self) -> tuple[Number, Number]:
        """The velocity and acceleration at which a time-based ramp aims now; 0 if there is none."""
        return self.time_based.target(self._master_now()) if self.time_based else (ZERO, ZERO)

    def _replan_time_based(self) -> None:
        self._plan_time_based(self._slave())
        self._note()

    def _plan_time_based(self, slave: Motion) -> None:
        assert self.time_based
        self.phases = self.time_based.phases(slave, self._master_now())
        self._next_phase(slave)

    # --- reversal -------------------------------------------------------------------------------------------------

    def _passed_backwards(self) -> None:
        """The master, having reversed, passes the coupling position."""
        coupling = self.coupling
        assert coupling
        coupling.behind = True
        bits = coupling.request.bits
        parking_bits = {"rollback_lock"} if coupling.reached else {"rollback_lock", "instant_stop_on_rollback"}
        if (self.time_based or coupling.reached) and not parking_bits & {*bits}:
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
        if curve.segments:
            self.law = Law(self.time, curve.segments[0].polynomial)
            self.phase_end = self.time + curve.duration
            self.exceeded = by_plan(curve, AxisData.of(self.inputs))

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
            case "gear_in_velo" | "gear_in_pos":
                self._gear_in(group)
            case _:
                self._start_own_motion(group)

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

    def _start_own_motion(self, group: str) -> None:
        motion = read_own_motion(self.inputs, group)
        if isinstance(motion, int):
            self._refuse(group, motion)
            return
        self._accept(group)
        self.lock = group == "stop"
        axis = AxisData.of(self.inputs)
        slave, beyond = begin_of_own_motion(self._uncoupled(), axis, motion.deceleration, motion.jerk)
        self._move_by(slave, motion.plan(slave), motion.end, motion.state, beyond)

    def _gear_in(self, group: str) -> None:
        request, distance = read_request(
            self.inputs, group, self._master_now(), self._slave(), self.period, self.cosine
        )
        if request is None:
            self._refuse(group, BAD_FACTOR)
            return
        request = replace(request, encoder_noise=self.encoder_noise)
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
