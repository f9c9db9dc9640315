"""Reference for the Synchronizer (PAM synchronizer pipe block): the true behaviour on the continuous time axis.

Closed forms of the two laws and an event loop over stretches on which the master moves one way; no stepping grid.
Within a stretch a threshold is crossed at most once. A command with a period that waits while the master moves
backwards has no events: its aimed occurrence is a function of the position, evaluated where it is needed.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tests.oracle.event_run import WINDOW, events_of, rows_of, wrapped_position
from tests.oracle.master import CLOSE, Motion, Stretch, stretches
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.sets import gathered

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "slave.jerk",
    "state_code",
    "synchronized",
    "syn_ramp_on",
    "error_id",
    "local.progress",
    "local.distance_to_begin",
    "local.distance_to_end",
)
"""What a scenario's reference holds beside the time."""

ZERO = mp.mpf(0)
RELATIVE, ROUNDING = mp.mpf(1e-9), mp.mpf(1e-15)
"""ε = RELATIVE·Δ + ROUNDING·|x|."""

SMALLEST, LARGEST = 1e-9, 1e12
"""Limits of |Δs| (u)."""

READY, EXECUTING, STACKED = 0, 1, 2
PARABOLA = 1
DEFAULTS: dict[str, Any] = {"active": True, "start": False, "stop": False, "rest_value": 0.0, "output_phasing": 90.0}


@dataclass(frozen=True, slots=True)
class Command:
    """A start or a stop with what it keeps of its edge: Δs and, for a stop, the rest value (u)."""

    start: bool
    phasing: Number
    rest_value: Number

    @property
    def name(self) -> str:
        return "start" if self.start else "stop"


@dataclass(frozen=True, slots=True)
class Ramp:
    """A command and one occurrence of its transition, in mirrored coordinates x = d·m, y = d·s (u)."""

    command: Command
    parabola: bool
    d: int
    size: Number
    rest: Number
    begin: Number
    end: Number

    @property
    def distance(self) -> Number:
        """Δm, the master distance of the transition."""
        return self.end - self.begin

    @property
    def armed_to(self) -> Number:
        """The largest x with x <= x_b + 1e-9·Δ + 1e-15·|x|."""
        limit = self.begin + RELATIVE * self.size
        return limit / (1 - mp.sign(limit) * ROUNDING)

    @property
    def completed_from(self) -> Number:
        """The smallest x with x >= x_e - 1e-9·Δ - 1e-15·|x|."""
        limit = self.end - RELATIVE * self.size
        return limit / (1 + mp.sign(limit) * ROUNDING)

    def aimed(self, x: Number, period: Number) -> "Ramp":
        """The first occurrence that x has not passed: the one shifted by ceil((x - x_b - ε)/P)·P."""
        epsilon = RELATIVE * self.size + ROUNDING * abs(x)
        shift = mp.ceil((x - self.begin - epsilon) / period) * period
        return replace(self, rest=self.rest + shift, begin=self.begin + shift, end=self.end + shift)

    def slave(self, x: Number) -> tuple[Number, Number, Number, Number]:
        """y and its first three derivatives by x on the ramp; x is clamped to x_b … x_e.

        Start: y0 + 2Δ·f(z), z = (x - x_b)/(2Δm). Stop: its point mirror through (y0, y0), where the value and the even
        derivatives change sign.
        """
        scale = 2 * self.distance
        travelled = x - self.begin if self.command.start else self.end - x
        f, slope, curvature, third = _doubled_law(self.parabola, min(max(travelled / scale, ZERO), mp.mpf(0.5)))
        sign, size = 1 if self.command.start else -1, 2 * self.size
        return (
            self.rest + sign * size * f,
            size * slope / scale,
            sign * size * curvature / scale**2,
            size * third / scale**3,
        )


def _doubled_law(parabola: bool, z: Number) -> tuple[Number, Number, Number, Number]:
    """f and its first three derivatives: 2z² or 10z³ - 15z⁴ + 6z⁵, of which 0 <= z <= 1/2 is used."""
    if parabola:
        return 2 * z**2, 4 * z, mp.mpf(4), ZERO
    return (
        z**3 * (10 - z * (15 - 6 * z)),
        30 * z**2 * (1 - z) ** 2,
        60 * z * (1 - z) * (1 - 2 * z),
        60 * (1 - z * (6 - 6 * z)),
    )


@dataclass(frozen=True, slots=True)
class State:
    """Everything the block knows between two events.

    `ramp` is the running command at its aimed occurrence, or in READY the last one (None at first); `has_started`: its
    ramp drives the slave; `progress` is the value held in READY.
    """

    synchronized: bool = True
    rest: Number = ZERO
    active: bool = True
    error_id: int = 0
    code: int = READY
    ramp: Ramp | None = None
    armed: bool = False
    has_started: bool = False
    stacked: Command | None = None
    progress: Number = ZERO


def reference(scenario: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once); see `events` for the scenario.

    Two rows, just before and just after, where an event lies within 1e-9 s of a time and changes a column; if it is
    undone within the window, the second row is the one in between. Both rows have the master's position at that time.
    """
    return rows_of(_Path, scenario, times)


def events(scenario: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order.

    The scenario has `stop_time`, `[start]` values, the `[master]` script and `[[set]]` tables. Raises ValueError for a
    set at or before 0 and for a set of something that is no input of the block.
    """
    return events_of(_Path, scenario)


class _Path:
    """One run of the block: the states it went through, each with the time from which it holds."""

    def __init__(self, scenario: Mapping[str, Any], horizon: Number) -> None:
        start = scenario.get("start", {})
        self.inputs = {name: start.get(name, default) for name, default in DEFAULTS.items()}
        self.parabola = start.get("curve", 2) == PARABOLA
        self.period = mp.mpf(start.get("master.period", 0))
        self.state = State(active=bool(self.inputs["active"]))
        self.times: list[Number] = [-mp.inf]
        self.states = [self.state]
        self.log: list[tuple[Number, str]] = []
        self.master = stretches(scenario["master"], horizon)
        self.begin_times = [stretch.begin for stretch in self.master]
        sets = gathered(scenario.get("set", ()), DEFAULTS)
        self._run([(mp.mpf(at), values) for at, values in sets.items()], horizon)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, sets: list[tuple[Number, dict[str, Any]]], horizon: Number) -> None:
        """All stretches, interrupted by the sets; what the path does at the time of a set comes before it."""
        last = len(self.master) - 1
        for index, stretch in enumerate(self.master[1:], start=1):
            time = stretch.begin
            while sets and (sets[0][0] < stretch.end or (index == last and sets[0][0] <= horizon)):
                at, values = sets.pop(0)
                self._follow(stretch, time, at)
                self._set(values, at, stretch.at(at).position)
                time = at
            self._follow(stretch, time, stretch.end)

    def _change(self, time: Number, name: str = "", **fields: Any) -> None:
        self.state = replace(self.state, **fields)
        self.times.append(time)
        self.states.append(self.state)
        if name:
            self.log.append((time, name))

    def _follow(self, stretch: Stretch, time: Number, until: Number) -> None:
        """The running command along one stretch from `time` to `until`."""
        following: Number | None = time
        while following is not None and self.state.code != READY:
            following = self._next(stretch, following, until)

    def _next(self, stretch: Stretch, time: Number, until: Number) -> Number | None:
        """The next thing that happens to the running command, done; its time, None if there is none until then."""
        state, ramp = self.state, self.state.ramp
        assert ramp is not None
        d, forwards = ramp.d, ramp.d * stretch.direction
        present, later = d * stretch.at(time).position, d * stretch.at(until).position

        def reached(x: Number) -> Number:
            """When x is met, for a motion towards it; `time` if it is met already."""
            return time if (present - x) * forwards >= 0 else stretch.when(d * x, time, until)

        if not state.armed:
            if forwards < 0 and later <= ramp.armed_to:
                self._change(at := reached(ramp.armed_to), "armed", armed=True)
                return at
        elif present >= ramp.completed_from:
            self._complete(time)
            return time
        elif state.has_started and forwards > 0:
            if later >= ramp.completed_from:
                self._complete(at := reached(ramp.completed_from))
                return at
        elif state.has_started:
            if forwards < 0 and ramp.begin - later > CLOSE * (1 + abs(later)):
                self._change(at := reached(ramp.begin), "ramp left backwards", has_started=False)
                return at
        elif forwards >= 0 and later - ramp.begin >= -CLOSE * (1 + abs(later)):
            self._change(at := reached(ramp.begin), "ramp starts", has_started=True)
            return at
        elif forwards < 0 and self.period > 0 and (aimed := ramp.aimed(later, self.period)) != ramp:
            self._change(until, ramp=aimed)
        return None

    def _complete(self, time: Number) -> None:
        state, ramp = self.state, self.state.ramp
        assert ramp is not None
        rest = state.rest if ramp.command.start else ramp.d * ramp.rest
        ended = {"synchronized": ramp.command.start, "rest": rest, "code": READY, "armed": False, "has_started": False}
        self._change(time, f"completed {ramp.command.name}", **ended, stacked=None, progress=mp.mpf(1))
        if state.stacked:
            self._take_up(state.stacked, time, ramp.d * ramp.end, f"taken up {state.stacked.name}")

    def _take_up(self, command: Command, time: Number, master: Number, name: str) -> None:
        """Make `command` the running one, for a master at `master`."""
        d = int(mp.sign(command.phasing))
        size, rest = abs(command.phasing), d * (self.state.rest if command.start else command.rest_value)
        before = size if self.parabola or not command.start else size * 7 / 8
        after = size if self.parabola or command.start else size * 7 / 8
        ramp = Ramp(command, self.parabola, d, size, rest, rest - before, rest + after)
        if self.period > 0:
            ramp = ramp.aimed(d * master, self.period)
        armed = self.period > 0 or d * master <= ramp.armed_to
        self._change(time, name, code=EXECUTING, ramp=ramp, armed=armed, has_started=False)

    # --- commands -------------------------------------------------------------------------------------------------

    def _set(self, values: Mapping[str, Any], time: Number, master: Number) -> None:
        """The inputs set at one time: a change of `active`, then the edges of start and stop."""
        before, self.inputs = self.inputs, {**self.inputs, **values}
        if self.inputs["active"] and not before["active"]:
            self._change(time, "activated", active=True)
        elif before["active"] and not self.inputs["active"]:
            self._deactivate(time, master)
        for name in ("start", "stop"):
            if self.inputs[name] and not before[name]:
                self._command(name == "start", time, master)

    def _deactivate(self, time: Number, master: Number) -> None:
        """READY at once, as all pending commands would have left it."""
        state, ramp = self.state, self.state.ramp
        pending = [ramp.command] if state.code != READY and ramp else []
        pending += [state.stacked] if state.stacked else []
        synchronized, rest = state.synchronized, state.rest
        for command in pending:
            synchronized = command.start
            rest = rest if command.start else command.rest_value
        progress = _progress(state, master)
        idle = {"code": READY, "armed": False, "has_started": False, "stacked": None, "progress": progress}
        self._change(time, "deactivated", active=False, synchronized=synchronized, rest=rest, **idle)

    def _command(self, start: bool, time: Number, master: Number) -> None:
        state = self.state
        name = f"command {'start' if start else 'stop'}"
        rest_value, phasing = mp.mpf(self.inputs["rest_value"]), float(self.inputs["output_phasing"])
        if not state.active:
            rest = state.rest if start else rest_value
            self._change(time, f"{name} accepted", error_id=0, synchronized=start, rest=rest)
            return
        aim = state.ramp.command.start if state.code != READY and state.ramp else state.synchronized
        if state.code == STACKED or start == aim:
            self._change(time, f"{name} ignored", error_id=0)
        elif not SMALLEST <= abs(phasing) <= LARGEST:
            self._change(time, f"{name} refused", error_id=1)
        elif state.code == EXECUTING:
            command = Command(start, mp.mpf(phasing), rest_value)
            self._change(time, f"{name} stacked", error_id=0, code=STACKED, stacked=command)
        else:
            self._change(time, error_id=0)
            self._take_up(Command(start, mp.mpf(phasing), rest_value), time, master, f"{name} accepted")

    # --- outputs --------------------------------------------------------------------------------------------------

    def rows(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if a column changes within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.times, t - WINDOW) - 1
        last = bisect_right(self.times, t + WINDOW) - 1
        before = self._row(t, self.states[first], -1)
        for state in reversed(self.states[first : last + 1]):
            after = self._row(t, state, +1)
            if after != before:
                return [before, after]
        return [before]

    def _stretch(self, time: Number) -> Stretch:
        return self.master[bisect_right(self.begin_times, time) - 1]

    def _row(self, time: Number, state: State, side: int) -> dict[str, float]:
        """The outputs in `state` at `time`; velocity, acceleration and turns are those on one side (-1 or 1) of it."""
        nearby = self._stretch(time + side * WINDOW)
        aside = replace(nearby.at(time), position=self._stretch(time).at(time).position)
        ramp, armed, on = state.ramp, state.armed, state.has_started
        if ramp and state.code != READY and armed and not on and ramp.d * nearby.direction < 0:
            x = ramp.d * nearby.at(time + side * WINDOW).position
            ramp = ramp.aimed(x, self.period) if self.period > 0 else ramp
            state = replace(state, ramp=ramp)
        slave = _slave(state, on, aside)
        turns_side = side if time >= WINDOW else max(side, 0)  # nothing was before 0
        row = {
            "time": float(time),
            "slave.position": wrapped_position(slave[0], slave[1], turns_side, self.period),
            "slave.velocity": float(slave[1]),
            "slave.acceleration": float(slave[2]),
            "slave.jerk": float(slave[3]),
            "state_code": float(state.code),
            "ready": float(state.code == READY),
            "synchronized": float(state.synchronized),
            "syn_synchronized": float(state.synchronized and not on),
            "syn_ramp_on": float(on),
            "status": float(state.synchronized and not on) + 2.0 * float(on),
            "error": float(state.error_id != 0),
            "error_id": float(state.error_id),
            "local.progress": float(_progress(state, aside.position)),
        }
        return row | self._distances(state, aside.position) | self._characteristics(ramp)

    def _distances(self, state: State, master: Number) -> dict[str, float]:
        """Master travel still missing to x_b and x_e; not armed: the way back to x_b, and from there to x_e again."""
        begin = end = ZERO
        if state.code != READY and state.ramp:
            x, ramp = state.ramp.d * master, state.ramp
            begin = max(ramp.begin - x if state.armed else x - ramp.begin, ZERO)
            end = max(ramp.end - x, ZERO) if state.armed else begin + ramp.distance
        return {"local.distance_to_begin": float(begin), "local.distance_to_end": float(end)}

    def _characteristics(self, ramp: Ramp | None) -> dict[str, float]:
        """Limits and peaks of the aimed occurrence; 0 before the first command."""
        values = [ZERO] * 5
        if ramp:
            limits = (wrapped_position(ramp.d * x, ZERO, 0, self.period) for x in (ramp.begin, ramp.end))
            peaks = [1 / (2 * ramp.size), ZERO]
            if not ramp.parabola:
                peaks = [peaks[0] * 128 * mp.sqrt(3) / 135, mp.mpf(512) / 225 / ramp.size**2]
            values = [*limits, ramp.distance, *peaks]
        names = ("ramp_begin", "ramp_end", "transition_distance", "peak_acceleration_per_v2", "peak_jerk_per_v3")
        return {f"local.{name}": float(value) for name, value in zip(names, values, strict=True)}


def _slave(state: State, on: bool, master: Motion) -> tuple[Number, Number, Number, Number]:
    """The unwrapped setpoint and its time derivatives, by the chain rule with the master's jerk taken as 0."""
    m, v, a = master.position, master.velocity, master.acceleration
    if on and state.ramp:
        sigma, slope, curvature, third = state.ramp.slave(state.ramp.d * m)
        d = state.ramp.d
        jerk = third * v**3 + 3 * d * curvature * v * a
        return d * sigma, slope * v, d * curvature * v**2 + slope * a, jerk
    return (m, v, a, ZERO) if state.synchronized else (state.rest, ZERO, ZERO, ZERO)


def _progress(state: State, master: Number) -> Number:
    """clamp((x - x_b)/Δm, 0, 1); 0 while not armed; READY: the value held."""
    if state.code == READY or not state.ramp:
        return state.progress
    travelled = (state.ramp.d * master - state.ramp.begin) / state.ramp.distance
    return min(max(travelled, ZERO), mp.mpf(1)) if state.armed else ZERO
