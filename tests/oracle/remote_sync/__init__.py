"""Reference for RemoteSync (TwinCAT TS5066): cycles, faults, modes and shifted axis values, one cycle after another.

Estimators: `remote_sync_estimators`, with the readings that concern them. Time and indices are exact, the rest has 50
digits. A comparison with a limit is exact too: numbers that meet one to rounding prove nothing.

Readings of the description:
- inputs are looked at in cycles only; but `enable` that goes and comes between two cycles is a new start;
- before the first cycle the outputs are the axis and the index as received, the mode of `enable`, and zeros;
- k starts with the received index modulo 65536, at every new start; the diagnosis starts at 0 with it, but the total of
  equal data goes on;
- PT1 starts with the x of the first cycle of all and is never restarted;
- `cycle_index_difference` is the step of this cycle; an equal datum is a step of 0, in every cycle, whatever r is;
- limits of the cycle index are compared with data indices, not scaled by r;
- the first fault in the order of the numbers counts. 0x4B51 and 0x4B52 are found before the estimator sees the index;
  0x4B59 is looked for in the mode that the cycle would have;
- a fault holds all that has been estimated as it was in the cycle before it; the index's step and the equal data are
  those of the fault's cycle.
  `enable` false holds everything but what the description names;
- forced time mode never becomes synced; the state is the start-up mode, as always until then;
- weights are those of the instant of a change of mode: it starts with the change, it does not lead it;
- a tunable is bad if NaN, infinite or outside its range; it is read in every enabled cycle without a fault;
- of parameters that contradict one another the later one is named.
"""

import math
from collections.abc import Mapping
from itertools import takewhile
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.remote_sync.estimators import Beat, Phase, whole_ratio

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "corrected_cycle_index",
    "correction_time",
    "drift",
    "state_code",
    "synced",
    "start_up",
    "warning",
    "beats",
    "cycle_index_difference",
    "equal_data_total",
    "equal_data_consecutive",
    "error_id",
)
"""What a scenario's reference holds beside the time."""

BEAT, PHASE = 1, 2
BYPASS, PT1, SYNC, TIME = 1, 2, 3, 4

DIFFERENCE, AGE, CORRECTION, TUNABLE, POSITION = 0x4B51, 0x4B52, 0x4B53, 0x4B56, 0x4B59

PARAMETERS: dict[str, Any] = {
    "task_cycle_time": 0.002,
    "data_cycle_time": 0.0,
    "estimator": BEAT,
    "threshold_for_sync": 0.05,
    "max_cycle_index_difference": 7,
    "age_of_data_limit": 7,
    "periods_for_mean_drift": 1,
    "delay_time_offset": 0.0,
    "slope1_numerator": 0.95,
    "slope1_denominator": 0.5,
    "end_of_transition_limit": 90,
    "new_drift_blending_cycles": 90,
    "time_mode_blending_cycles": 90,
    "force_time_mode": False,
    "automatic_reinit": False,
    "start_up_mode": TIME,
    "fall_back_mode": PT1,
    "max_position_difference": 0.0,
    "use_acceleration": True,
    "pt1_factor_position": 3.0,
    "pt1_factor_velocity": 3.0,
    "blending_time": 0.06,
}
TUNABLES = ("delay_time_offset", "max_position_difference")
INPUTS: dict[str, Any] = {
    "enable": True,
    "remote.cycle_index": 0,
    "remote.position": 0.0,
    "remote.velocity": 0.0,
    "remote.acceleration": 0.0,
}
AXIS = ("remote.position", "remote.velocity", "remote.acceleration")

LARGEST, LONGEST, MOST_CYCLES = 1e12, 1e6, 10**6
"""Limits of a Real input, a step (s), the cycles in one step."""

EARLY = mp.mpq(1, 10**6)
"""Share of a cycle by which it may lie before the end of a step and still be the next step's."""

Rates = tuple[Number, Number, Number]
"""Position, velocity, acceleration."""


def _allowed(values: Mapping[str, Any]) -> dict[str, bool]:
    """Whether each parameter is in its range; NaN is in none."""
    positive = ("task_cycle_time", "threshold_for_sync", "pt1_factor_position", "pt1_factor_velocity")
    allowed = {name: value > 0 for name, value in values.items() if name in positive}
    not_negative = ("data_cycle_time", "max_cycle_index_difference", "age_of_data_limit", "blending_time")
    allowed |= {name: values[name] >= 0 for name in (*not_negative, "max_position_difference")}
    counts = ("end_of_transition_limit", "new_drift_blending_cycles", "time_mode_blending_cycles")
    allowed |= {name: values[name] >= 1 for name in counts}
    allowed |= {
        "estimator": values["estimator"] in (BEAT, PHASE),
        "periods_for_mean_drift": 1 <= values["periods_for_mean_drift"] <= 64,
        "slope1_numerator": 0 < values["slope1_numerator"] <= 1,
        "slope1_denominator": 0 < values["slope1_denominator"] < 1,
        "start_up_mode": values["start_up_mode"] in (BYPASS, PT1, TIME),
        "fall_back_mode": values["fall_back_mode"] in (BYPASS, PT1),
    }
    return {name: allowed.get(name, True) and math.isfinite(value) for name, value in values.items()}


def refusal(parameters: Mapping[str, Any]) -> str | None:
    """The first variable, in the order of the table, for which initialization is refused; None if it is not."""
    values = PARAMETERS | dict(parameters)
    if bad := [name for name, is_allowed in _allowed(values).items() if not is_allowed]:
        return bad[0]
    ratio = whole_ratio(values["task_cycle_time"], values["data_cycle_time"])
    if ratio is None:
        return "data_cycle_time"
    if values["estimator"] == PHASE and ratio != 1:
        return "estimator"
    if ratio >= 2 and 0 < values["age_of_data_limit"] < ratio:
        return "age_of_data_limit"
    return "max_cycle_index_difference" if 0 < values["max_cycle_index_difference"] * ratio < 1 else None


def _refused_input(inputs: Mapping[str, Any], h: float) -> str | None:
    """The first input, or the step, with which a step must fail."""
    for name in AXIS:
        if not abs(inputs[name]) <= LARGEST:
            return name
    return None if 0 < h <= LONGEST else "step size"


class RemoteSyncOracle:
    """One unit; raises ValueError with the variable's name for what initialization or a step must refuse."""

    def __init__(self, parameters: Mapping[str, Any] | None = None, inputs: Mapping[str, Any] | None = None) -> None:
        self.values = PARAMETERS | dict(parameters or {})
        if name := refusal(self.values):
            raise ValueError(name)
        self.inputs = INPUTS | dict(inputs or {})
        self.task = mp.mpq(self.values["task_cycle_time"])
        ratio = whole_ratio(self.values["task_cycle_time"], self.values["data_cycle_time"])
        assert ratio
        self.ratio = ratio
        self.time = mp.mpq(0)
        self.cycles = 0
        self.filtered: tuple[Number, Number] | None = None
        self.running = self.synced = False
        self.error_id = 0
        self.indices: list[int] = []
        self.steps: list[int] = []
        self.equal = 0
        self.estimator: Beat | Phase | None = None
        self.estimated: dict[str, Any] = {"drift": 0.0, "warning": False, "beats": 0}
        self.corrected: Any = mp.mpq(self.inputs["remote.cycle_index"] % 65536)
        self.correction = mp.mpf(0)
        enabled = bool(self.inputs["enable"])
        self.mode = self.values["start_up_mode"] if enabled else BYPASS
        self.changed, self.weights_then = 0, self._unit(self.mode)
        p, v, a = self._received()
        self.outputs = self._outputs((p, v, a), enabled)

    def step(self, inputs: Mapping[str, Any] | None, h: float) -> dict[str, Any]:
        """All outputs after one doStep; `inputs` (and tunables) keep their values from one step to the next."""
        new_values = dict(inputs or {})
        changed = self.inputs | {name: value for name, value in new_values.items() if name in INPUTS}
        if unknown := new_values.keys() - INPUTS.keys() - set(TUNABLES):
            raise KeyError(f"{', '.join(sorted(unknown))} cannot be set")
        if name := _refused_input(changed, h):
            raise ValueError(name)
        end = self.time + mp.mpq(h)
        last = math.ceil(end / self.task - EARLY)
        if last - self.cycles > MOST_CYCLES:
            raise ValueError("step size")
        self.inputs = changed
        self.values |= {name: value for name, value in new_values.items() if name in TUNABLES}
        if not self.inputs["enable"]:
            self.running = False
        for i in range(self.cycles, last):
            self._cycle(i)
        self.cycles, self.time = max(last, self.cycles), end
        return self.outputs

    # --- one cycle ------------------------------------------------------------------------------------------------

    def _cycle(self, i: int) -> None:
        p, v, a = self._received()
        self._filter(p, v)
        enabled = bool(self.inputs["enable"])
        if not enabled:
            self.running, self.error_id = False, 0
        elif not self.running or (self.error_id and self.values["automatic_reinit"]):
            self._start()
        if self.running and not self.error_id:
            self._follow()
        self.synced = self.synced and self.running and not self.error_id
        self._enter(self._mode(), i)
        self.outputs = self._outputs(self._weighted(p, v, a, i), enabled)

    def _start(self) -> None:
        """A new first cycle: nothing is known but what the outputs hold."""
        self.running, self.error_id, self.synced = True, 0, False
        self.indices, self.steps = [], []
        kind = Beat if self.values["estimator"] == BEAT else Phase
        self.estimator = kind(self.values, self.ratio)

    def _follow(self) -> None:
        """The received index and what is made of it, or the fault that it is."""
        raw = self.inputs["remote.cycle_index"] % 65536
        if self.indices:
            step = (raw - self.indices[-1] + 32768) % 65536 - 32768
            self.steps.append(step)
            self.equal += step == 0
            self.indices.append(self.indices[-1] + step)
        else:
            self.indices.append(raw)
        self.error_id = self._index_fault()
        if self.error_id:
            return
        assert self.estimator
        corrected = self.estimator.cycle(len(self.indices) - 1, self.indices[-1])
        index_lead = mp.mpf(corrected - self.indices[-1])
        is_near = bool(abs(index_lead) * mp.mpf(self.ratio) < self.values["threshold_for_sync"])
        self.synced = self.estimator.is_drift_determined and (self.synced or is_near)
        self.error_id = self._correction_fault(index_lead)
        if not self.error_id:
            self.corrected, self.correction = corrected, self._time(index_lead)
            self.estimated = {
                "drift": float(self.estimator.drift),
                "warning": self.estimator.warning,
                "beats": self.estimator.beats,
            }

    def _index_fault(self) -> int:
        """A cycle index that steps too far, or that has not changed for too long."""
        max_difference, age = self.values["max_cycle_index_difference"], self.values["age_of_data_limit"]
        if self.steps and 0 < max_difference < abs(self.steps[-1]):
            return DIFFERENCE
        return AGE if 0 < age < self._equal_consecutive() else 0

    def _correction_fault(self, index_lead: Number) -> int:
        """A correction that is too large, by itself or by what it makes of the position; a bad tunable."""
        max_difference, max_distance = self.values["max_cycle_index_difference"], self.values["max_position_difference"]
        if max_difference and abs(index_lead) > max_difference + 2:
            return CORRECTION
        allowed = _allowed(self.values)
        if not all(allowed[name] for name in TUNABLES):
            return TUNABLE
        p, v, a = self._received()
        if (
            max_distance
            and self._mode() in (SYNC, TIME)
            and abs(self._shifted(p, v, a, self._time(index_lead))[0] - p) > max_distance
        ):
            return POSITION
        return 0

    def _time(self, index_lead: Number) -> Number:
        """The correction time (s) of a corrected index that is `ahead` of the received one."""
        return index_lead * mp.mpf(self.ratio * self.task) + mp.mpf(self.values["delay_time_offset"])

    def _equal_consecutive(self) -> int:
        return sum(1 for _ in takewhile(lambda step: step == 0, reversed(self.steps)))

    # --- modes and axis values ------------------------------------------------------------------------------------

    def _mode(self) -> int:
        if not self.running:
            return BYPASS
        if self.error_id:
            return int(self.values["fall_back_mode"])
        return SYNC if self.synced else int(self.values["start_up_mode"])

    def _enter(self, mode: int, i: int) -> None:
        """The mode from cycle i on."""
        if mode != self.mode:
            self.weights_then, self.changed, self.mode = self._weights(i), i, mode

    def _weights(self, i: int) -> list[Number]:
        """Of BYPASS, PT1, SYNC, TIME at cycle i: on the straight way from those at the change of mode."""
        elapsed, whole = (i - self.changed) * self.task, mp.mpq(self.values["blending_time"])
        share = mp.mpf(min(mp.mpq(1), elapsed / whole)) if whole else mp.mpf(1)
        return [w + (u - w) * share for w, u in zip(self.weights_then, self._unit(self.mode), strict=True)]

    @staticmethod
    def _unit(mode: int) -> list[Number]:
        return [mp.mpf(mode == other) for other in (BYPASS, PT1, SYNC, TIME)]

    def _received(self) -> Rates:
        p, v, a = (mp.mpf(self.inputs[name]) for name in AXIS)
        return p, v, a

    def _filter(self, p: Number, v: Number) -> None:
        """PT1 of position and velocity."""
        if self.filtered is None:
            self.filtered = p, v
        y, w = self.filtered
        y += (p - y) / (1 + mp.mpf(self.values["pt1_factor_position"]))
        w += (v - w) / (1 + mp.mpf(self.values["pt1_factor_velocity"]))
        self.filtered = y, w

    def _shifted(self, p: Number, v: Number, a: Number, by: Number) -> tuple[Number, Number]:
        """Position and velocity, `by` (s) later."""
        used = a if self.values["use_acceleration"] else mp.mpf(0)
        return p + v * by + used * by**2 / 2, v + used * by

    def _acceleration(self, a: Number) -> Number:
        return a if self.values["use_acceleration"] or self.mode not in (SYNC, TIME) else mp.mpf(0)

    def _weighted(self, p: Number, v: Number, a: Number, i: int) -> Rates:
        assert self.filtered
        shifted = self._shifted(p, v, a, self.correction)
        sources = ((p, v), self.filtered, shifted, shifted)
        weights = self._weights(i)
        position = sum(w * source[0] for w, source in zip(weights, sources, strict=True))
        velocity = sum(w * source[1] for w, source in zip(weights, sources, strict=True))
        return position, velocity, self._acceleration(a)

    def _outputs(self, slave: Rates, enabled: bool) -> dict[str, Any]:
        return {
            "slave.position": float(slave[0]),
            "slave.velocity": float(slave[1]),
            "slave.acceleration": float(slave[2]),
            "slave.jerk": 0.0,
            "state": self.mode,
            "state_code": self.mode,
            "error": self.error_id != 0,
            "error_id": self.error_id,
            "correction_time": float(self.correction),
            "corrected_cycle_index": float(self.corrected),
            "synced": self.synced,
            "start_up": enabled and not self.error_id and not self.synced,
            "cycle_index_difference": self.steps[-1] if self.steps else 0,
            "equal_data_total": self.equal,
            "equal_data_consecutive": self._equal_consecutive(),
            **self.estimated,
        }
