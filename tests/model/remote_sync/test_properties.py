"""RemoteSync on random clocks and telegrams: the oracle, continuity, limits, step sizes, symmetries, no NaN."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import Phase, example, given, seed, settings
from hypothesis import strategies as st

from motionsync.remote_sync.faults import Fault
from motionsync.remote_sync.interface import Estimator, Mode
from tests.model.remote_sync.harness import OUTPUTS, RemoteSyncHarness, T
from tests.oracle.remote_sync import RemoteSyncOracle

settings.register_profile("remote_sync", derandomize=True, deadline=None, max_examples=60)
repeatable = settings.get_profile("remote_sync")
rngs = st.integers(0, 2**32 - 1).map(Random)

BEAT, PHASE = Estimator.BEAT, Estimator.PHASE
INDEX = "remote.cycle_index"
INPUTS = ("enable", "delay_time_offset", "remote.position", "remote.velocity", "remote.acceleration")
SHOWN = (*OUTPUTS, *INPUTS)
TINY = 5e-324
BURST, BURST_STEP = 3, 5  # together beyond the greatest max_cycle_index_difference + 2 that is drawn
NEAR = {  # limits that no telegram meets but for rounding
    "threshold_for_sync": (0.0512345, 0.3123, 0.0077, 2.345),
    "max_position_difference": (0.0, 0.0, 0.0, 1.51234, 4.31234),  # of the axis' way in a cycle
}


@dataclass(frozen=True)
class Clock:
    """How a sender's index comes: its gain a cycle of its own, jitter, and how often a cycle something happens.

    A burst jumps in several cycles one after the other, each time too little for a fault; together too much for the
    correction."""

    drift: float
    jitter: float = 0.0
    losses: float = 0.0
    jumps: float = 0.0
    bursts: float = 0.0
    changes: float = 0.0

    def indices(self, r: Random, cycles: int, ratio: float) -> Iterator[int]:
        """What is seen in each of the receiver's cycles, counted on without wrapping."""
        phase, drift, sent, jumped, seen, lost, burst = r.random(), self.drift, 0, 0, 0, 0, 0
        for _ in range(cycles):
            sent = max(sent, math.floor(phase + r.gauss(0.0, self.jitter)))
            if r.random() < self.losses:
                lost = r.choice((3, 6, 6, 9))
            if r.random() < self.jumps:
                jumped += r.choice((1, -1, 2, -2, 3, 5, 20))
            if r.random() < self.bursts:
                burst = BURST
            if burst > 0:
                jumped += BURST_STEP
                burst -= 1
            if r.random() < self.changes:
                drift = r.choice((-drift, -drift, 0.6 * drift, self.drift))
            seen = seen if lost else sent + jumped
            lost = max(lost - 1, 0)
            yield seen
            phase += (1.0 + drift) / ratio


@dataclass(frozen=True)
class ReceivedRun:
    """Start values, and what is set before each of the receiver's cycles."""

    start: dict[str, Any]
    cycles: list[dict[str, Any]] = field(repr=False)

    @property
    def cycle(self) -> float:
        return float(self.start["task_cycle_time"])

    @property
    def ratio(self) -> float:
        return self.start["data_cycle_time"] / self.cycle if self.start["data_cycle_time"] else 1.0

    def rows(self) -> list[dict[str, Any]]:
        """Inputs, outputs and locals, a row a cycle."""
        receiver = RemoteSyncHarness(self.start)
        return [receiver.step(self.cycle, values).stepper.get(SHOWN) for values in self.cycles]


ALL = st.sampled_from((BEAT, PHASE))
FREE: dict[str, Any] = {"max_cycle_index_difference": 0, "age_of_data_limit": 0}  # so that nothing is a fault


CHOICES: dict[str, tuple[Any, ...]] = {
    "end_of_transition_limit": (3, 10, 30),
    "new_drift_blending_cycles": (1, 7, 30, 90),
    "time_mode_blending_cycles": (1, 7, 30, 90),
    "periods_for_mean_drift": (1, 1, 1, 2, 4),
    "slope1_numerator": (0.95, 0.5, 1.0, 0.3),
    "slope1_denominator": (0.5, 0.2, 0.7),
    "max_cycle_index_difference": (7, 12),
    "age_of_data_limit": (7, 12, 0),
    "force_time_mode": (False,) * 7 + (True,),
    "automatic_reinit": (False, True, True, True),
    "start_up_mode": (4, 2, 1, 4),
    "fall_back_mode": (1, 2),
    "use_acceleration": (False, True),
    "pt1_factor_position": (3.0, 0.5),
}


@st.composite
def received_runs(
    draw: st.DrawFn,
    /,
    *,
    cycles: int = 800,
    estimators: st.SearchStrategy[Estimator] = ALL,
    calm: bool = False,
    **own: Any,
) -> ReceivedRun:
    """Beats twice to ten times as far apart as they have to be; `calm`: nothing but clocks that beat. `own` values, and
    the ratio of the cycles, go before those that are drawn."""
    estimator = draw(estimators)
    ratio = own.pop("ratio", None) or draw(st.sampled_from((1.0, 1.0, 1.0, 2.0, 3.0, 0.5, 0.25)))
    ratio = 1.0 if estimator == PHASE else ratio
    cycle = draw(st.sampled_from((0.002, 0.001, 0.0005, 0.01)))
    start = {name: draw(st.sampled_from(choice)) for name, choice in (CHOICES | NEAR).items()}
    speed = draw(st.floats(-300.0, 300.0))
    start["max_position_difference"] *= cycle * max(1.0, abs(speed))
    start |= {
        "task_cycle_time": cycle,
        "data_cycle_time": ratio * cycle if ratio != 1.0 else draw(st.sampled_from((0.0, cycle))),
        "estimator": estimator,
        "blending_time": cycle * draw(st.sampled_from((3.7, 12.0, 30.0))),
        "delay_time_offset": cycle * draw(st.sampled_from((0.0, 1.0, -0.3))),
    }
    start |= own
    clock = draw(clocks(ratio, start["end_of_transition_limit"], calm))
    rng = draw(rngs)
    telegrams = draw(axes(list(clock.indices(rng, cycles, ratio)), ratio * cycle, speed))
    if not calm:
        order(rng, telegrams, start)
    return ReceivedRun(start, telegrams)


@st.composite
def clocks(draw: st.DrawFn, ratio: float, limit: int, calm: bool) -> Clock:
    """`limit`: the cycles without a change that end a transition zone."""
    apart = max(20.0, limit * draw(st.sampled_from((2.0, 4.0, 10.0))))
    drift = draw(st.sampled_from((1.0, -1.0))) * ratio / apart
    jitter = draw(st.sampled_from((0.0, 0.01, 0.05)))
    rare = 0.0 if calm else draw(st.sampled_from((0.0, 0.2, 0.5))) / apart
    return Clock(drift, jitter, rare, rare, 0.3 * rare, rare)


@st.composite
def axes(draw: st.DrawFn, indices: list[int], data_cycle: float, speed: float) -> list[dict[str, Any]]:
    """The telegrams with these indices of an axis with constant acceleration, which may be 0."""
    base = draw(st.sampled_from((0, 65000, 70000, -5)))
    curved = draw(st.sampled_from((0.0, 20.0)))
    times = [index * data_cycle for index in indices]
    return [
        {
            INDEX: base + index,
            "remote.position": speed * t + 0.5 * curved * t * t,
            "remote.velocity": speed + curved * t,
            "remote.acceleration": curved,
        }
        for index, t in zip(indices, times, strict=True)
    ]


def order(r: Random, telegrams: list[dict[str, Any]], start: dict[str, Any]) -> None:
    """New starts, and tunables that are good, or bad for a while."""
    cycle, enabled = start["task_cycle_time"], True
    for values in telegrams:
        if r.random() < (0.001 if enabled else 0.1):
            enabled = not enabled
            values["enable"] = enabled
        if r.random() < 0.002:
            values["delay_time_offset"] = cycle * r.choice((0.0, 1.0, 1.0, math.nan, 2.0))
        elif r.random() < 0.05:
            values["delay_time_offset"] = start["delay_time_offset"]
        if r.random() < 0.0005:
            values["max_position_difference"] = r.choice((0.0, -1.0, math.inf))
        elif r.random() < 0.05:
            values["max_position_difference"] = start["max_position_difference"]


@pytest.mark.slow
def test_the_lines_meet_what_is_to_be_proven_on_them() -> None:
    """Within 180 lines; those after the one with which all is met are not run."""
    met: set[Any] = set()
    events = ("synced", "warning", "beat", "forgotten")
    required = {
        *(("fault", fault) for fault in Fault),
        *(("mode", mode) for mode in Mode),
        *((kind, event) for kind in Estimator for event in events),
        "synced no more",
    }

    @seed(0)
    @settings(max_examples=180, deadline=None, phases=[Phase.generate])
    @given(received_runs())
    def draw(received: ReceivedRun) -> None:
        if met == required:
            return
        kind = received.start["estimator"]
        rows = received.rows()
        met.update(("fault", row["error_id"]) for row in rows)
        met.update(("mode", row["state"]) for row in rows)
        for before, now in going_on(rows):
            met.update((kind, name) for name in ("synced", "warning") if now[name])
            met.update({(kind, "beat")} if now["beats"] > before["beats"] else ())
            met.update({(kind, "forgotten")} if now["beats"] < before["beats"] else ())
            met.update({"synced no more"} if before["synced"] and not now["synced"] else ())

    draw()
    assert met == required


# --- the oracle -------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=40, phases=[Phase.generate])  # to shrink telegrams takes minutes and shows nothing
@given(received_runs(), rngs, st.sampled_from(((1.0,), (1.0,), (0.5,), (2.0,), (1.0, 0.25, 3.3), (0.7,))))
def test_the_block_is_as_the_oracle(received: ReceivedRun, rng: Random, sizes: tuple[float, ...]) -> None:
    """All outputs of all steps, to 1e-9 of their size, with steps that are no cycles too."""
    receiver, oracle = (
        RemoteSyncHarness(received.start | received.cycles[0]),
        RemoteSyncOracle(received.start, received.cycles[0]),
    )
    time = 0.0
    while time < len(received.cycles) - 4.0:
        size = rng.choice(sizes)
        values = received.cycles[math.ceil(time - 1e-6)]
        expected = oracle.step(values, size * received.cycle)
        receiver.step(size * received.cycle, values)
        for name, value in expected.items():
            scale = max(100.0 if name == "drift" else 1.0, abs(float(value)))
            assert abs(float(receiver[name]) - float(value)) <= 1e-9 * scale, name
        time += size


# --- continuity -------------------------------------------------------------------------------------------------------


def bounds(received: ReceivedRun, before: dict[str, Any], now: dict[str, Any]) -> float:
    """How far a step of c may differ from 1/r: by the drift, and by what an identification leaves to be worked off.

    That is at most the distance of c from the received index, which is limited, and the one index, with PHASE and its
    slack, in which the new law may begin.
    """
    start = received.start
    left = start["max_cycle_index_difference"] + 3.06
    blending = min(start["new_drift_blending_cycles"], start["time_mode_blending_cycles"])
    if start["estimator"] == PHASE:
        drift = max(abs(before["drift"]), abs(now["drift"])) * 1e-6
        return float(left / start["new_drift_blending_cycles"] + drift)
    height, corner = start["slope1_numerator"], start["slope1_denominator"]
    steepest = max(height / corner, (1.0 - height) / (1.0 - corner))
    distances = [row["local.beat_distance"] for row in (before, now) if row["local.beat_distance"] > 0.0]
    return float(left / blending + (steepest / min(distances) if distances else 0.0))


def going_on(rows: list[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """One cycle and the next one, between which there is neither a fault nor a new start."""
    for before, now in pairwise(rows):
        if now["enable"] and not (before["error"] or now["error"]) and now["local.cycles"] > 0:
            yield before, now


@repeatable
@given(received_runs())
def test_the_corrected_index_is_continuous_but_for_new_starts(received: ReceivedRun) -> None:
    """At beats, jumps, reversals, closed zones, changes of mode, lost telegrams."""
    for before, now in going_on(received.rows()):
        step = now["corrected_cycle_index"] - before["corrected_cycle_index"]
        assert abs(step - 1.0 / received.ratio) <= bounds(received, before, now) + 1e-9


DEFAULT: dict[str, Any] = {
    "end_of_transition_limit": 90,
    "new_drift_blending_cycles": 90,
    "time_mode_blending_cycles": 90,
    "max_cycle_index_difference": 7,
    "slope1_numerator": 0.95,
    "slope1_denominator": 0.5,
}


@settings(repeatable, max_examples=15)
@given(received_runs(cycles=2500, ratio=1.0, **DEFAULT))
def test_with_the_default_blendings_it_never_goes_back(received: ReceivedRun) -> None:
    """At most 10 indices are worked off in 90 cycles. With short blendings it may: a jump back is followed at once."""
    for before, now in going_on(received.rows()):
        assert now["corrected_cycle_index"] - before["corrected_cycle_index"] > 0.8


@repeatable
@given(received_runs())
def test_the_position_is_between_the_modes_and_jumps_no_more_than_they_do(received: ReceivedRun) -> None:
    """Three ways to make it: as received, smoothed, shifted. The weights sum to 1, none is negative, and from one cycle
    to the next they move at most by one part of the blending's cycles."""
    length = received.start["blending_time"] / received.cycle
    factor = received.start["pt1_factor_position"]
    last: tuple[tuple[float, ...], float] | None = None
    smoothed = received.cycles[0]["remote.position"]
    for row in received.rows():
        as_received, time = row["remote.position"], row["correction_time"]
        smoothed += (as_received - smoothed) / (1.0 + factor)
        shifted = as_received + row["remote.velocity"] * time
        if received.start["use_acceleration"]:
            shifted += 0.5 * row["remote.acceleration"] * time * time
        ways, position = (as_received, smoothed, shifted), row["slave.position"]
        tiny = 1e-12 * (1.0 + max(map(abs, ways)))
        assert min(ways) - tiny <= position <= max(ways) + tiny
        if last:
            own = max(abs(b - a) for a, b in zip(last[0], ways, strict=True))
            assert abs(position - last[1]) <= own + (max(last[0]) - min(last[0])) / length + tiny
        last = ways, position


@repeatable
@given(received_runs(), st.floats(-1e6, 1e6))
@example(ReceivedRun({"task_cycle_time": T, "blending_time": 12 * T}, [{INDEX: n} for n in range(40)]), TINY)
def test_an_axis_at_rest_is_where_it_is_in_every_mode(received: ReceivedRun, place: float) -> None:
    """To the rounding of the three shares in which the position is put together, each of which may underflow."""
    receiver = RemoteSyncHarness(received.start)
    standing = {"remote.position": place, "remote.velocity": 0.0, "remote.acceleration": 0.0}
    tolerance = max(1e-14 * abs(place), 3 * TINY)
    for values in received.cycles:
        receiver.step(received.cycle, values | standing)
        assert abs(receiver["slave.position"] - place) <= tolerance
        assert receiver.slave[1:] == (0.0, 0.0)


# --- limits and flags -------------------------------------------------------------------------------------------------


@repeatable
@given(received_runs())
def test_without_a_fault_all_limits_hold(received: ReceivedRun) -> None:
    start, cycle = received.start, received.cycle
    far, age = start["max_cycle_index_difference"], start["age_of_data_limit"]
    for row in received.rows():
        if row["error"] or not row["enable"]:
            continue
        assert abs(row["cycle_index_difference"]) <= far
        assert age == 0 or row["equal_data_consecutive"] <= age
        lead = (row["correction_time"] - row["delay_time_offset"]) / (received.ratio * cycle)
        assert abs(lead) <= far + 2.0 + 1e-9


@repeatable
@given(received_runs())
def test_flags_and_state_belong_together(received: ReceivedRun) -> None:
    """synced ends with a fault, a new start, `enable` false, or where beats are forgotten."""
    start = received.start
    rows = received.rows()
    for row in rows:
        assert row["start_up"] + row["synced"] + row["error"] + (not row["enable"]) == 1
        assert row["error"] == (row["error_id"] != 0)
        assert row["state_code"] == row["state"]
        expected = Mode.SYNC if row["synced"] else start["fall_back_mode"] if row["error"] else start["start_up_mode"]
        assert row["state"] == (expected if row["enable"] else Mode.BYPASS)
        assert row["slave.jerk"] == 0.0
    for before, now in going_on(rows):
        if before["synced"] and not now["synced"]:
            assert now["beats"] <= 1
            assert now["warning"]
        if start["estimator"] == BEAT:
            assert (now["drift"] != 0.0) == (now["beats"] > start["periods_for_mean_drift"])


# --- steps ------------------------------------------------------------------------------------------------------------


@repeatable
@given(received_runs(cycles=400), st.sampled_from((2, 3, 7, 10)))
def test_steps_that_divide_a_cycle_give_the_same_bits(received: ReceivedRun, parts: int) -> None:
    """At each part of it: the cycle acts in the first one."""
    whole, cut = RemoteSyncHarness(received.start), RemoteSyncHarness(received.start)
    for values in received.cycles:
        whole.step(received.cycle, values)
        for _ in range(parts):
            cut.step(received.cycle / parts, values)
            assert cut.shown() == whole.shown()


@repeatable
@given(received_runs(cycles=400), rngs)
def test_a_step_of_several_cycles_gives_the_bits_of_as_many_single_ones(received: ReceivedRun, rng: Random) -> None:
    single, several = RemoteSyncHarness(received.start), RemoteSyncHarness(received.start)
    for values in received.cycles:
        count = rng.choice((1, 1, 2, 5))
        for _ in range(count):
            single.step(received.cycle, values)
        several.step(count * received.cycle, values)
        assert several.shown() == single.shown()


# --- indices ----------------------------------------------------------------------------------------------------------


@repeatable
@given(received_runs(), st.integers(-(2**30), 2**30))
def test_another_first_index_moves_the_corrected_one_and_nothing_else(received: ReceivedRun, more: int) -> None:
    """At each new start it is the received one again, from 0 to 65535.

    Up to the first cycle without a fault it is the one that the initialization has seen, which therefore moves, too."""
    moved = ReceivedRun(
        received.start | {INDEX: more}, [values | {INDEX: values[INDEX] + more} for values in received.cycles]
    )
    for row, other in zip(received.rows(), moved.rows(), strict=True):
        change = other.pop("corrected_cycle_index") - row.pop("corrected_cycle_index") - more
        assert abs(math.remainder(change, 65536.0)) <= 1e-9
        assert repr(other) == repr(row)


@repeatable
@given(received_runs(cycles=300), rngs)
def test_an_index_may_be_sent_with_any_number_of_wraps(received: ReceivedRun, rng: Random) -> None:
    wrapped = [values | {INDEX: values[INDEX] + 65536 * rng.randint(-9, 9)} for values in received.cycles]
    assert repr(ReceivedRun(received.start, wrapped).rows()) == repr(received.rows())


@repeatable
@given(st.integers(1, 1000), st.integers(0, 65535), st.booleans())
def test_the_corrected_index_goes_on_over_many_wraps(share: int, first: int, backwards: bool) -> None:
    """`share` indices a cycle, which may also count down: then the law looks for beats, but the index is unwrapped."""
    sign = -1 if backwards else 1
    receiver = RemoteSyncHarness({**FREE, "data_cycle_time": 0.002 / share, "end_of_transition_limit": 10**6})
    for n in range(600):
        index = first + sign * share * n
        receiver.see(index % 65536)
        lead = receiver["correction_time"] / 0.002 * share
        assert receiver["corrected_cycle_index"] - lead == pytest.approx(index, rel=1e-12, abs=1e-9)
        assert receiver["corrected_cycle_index"] == pytest.approx(first + share * n, rel=1e-12)


@repeatable
@given(received_runs(calm=True, ratio=1.0, delay_time_offset=0.0, **FREE))
def test_a_sender_that_loses_what_another_gains_is_its_mirror_image(received: ReceivedRun) -> None:
    """BEAT: c - n has the other sign, to the last bit. PHASE: it is one less that, as telegrams give whole indices."""
    first = received.cycles[0][INDEX]
    mirrored = [
        {INDEX: 2 * n + 2 * first - values[INDEX], "remote.position": 0.0} for n, values in enumerate(received.cycles)
    ]
    straight = [{INDEX: values[INDEX], "remote.position": 0.0} for values in received.cycles]
    rows, others = (ReceivedRun(received.start, cycles).rows() for cycles in (straight, mirrored))
    one = received.cycle if received.start["estimator"] == PHASE else 0.0
    tolerance = 1e-9 if received.start["estimator"] == PHASE else 0.0
    for row, other in zip(rows, others, strict=True):
        assert abs(other["drift"] + row["drift"]) <= 1e3 * tolerance
        assert abs(other["correction_time"] + row["correction_time"] - one) <= tolerance * received.cycle
        if received.start["estimator"] == BEAT:
            assert (other["synced"], other["state"]) == (row["synced"], row["state"])
        assert (other["beats"], other["warning"]) == (row["beats"], row["warning"])
