"""The Gearing on random scripts is its oracle: all outputs, in steps of any size, whatever the inputs hold."""

from random import Random
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from motionsync.gearing.block import Gearing
from motionsync.gearing.interface import StartMode, StopMode, Transition
from motionsync.master import MasterInput
from tests.oracle.gearing import COLUMNS, reference
from tests.support.blocks.drawn import drawn
from tests.support.blocks.harness import MOTION
from tests.support.blocks.oracle_runs import Script, find_differences, simulate

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
LENGTH = 10.0
LEAST = 0.2 * LENGTH  # distance of a transition
FASTEST = 32.0

repeatable = drawn(400)


def order(r: Random, engage: bool) -> dict[str, Any]:
    """An edge of start with what it reads."""
    group = "gear_in" if engage else "gear_out"
    values: dict[str, Any] = {
        f"{group}.transition": r.choice(list(Transition)),
        f"{group}.distance": r.choice([0.0, *[r.uniform(LEAST, LENGTH)] * 4, -1.0]),
        f"{group}.time": r.choice([*[r.uniform(0.2, 1.5)] * 9, 0.0]),
        "start": engage,
    }
    if engage:
        values |= {"gear_in.start_mode": r.choice(list(StartMode)), "gear_in.offset": r.choice([0.0, 0.37])}
        values["gear_in.reference_position"] = LENGTH * r.uniform(-2.0, 2.0)
    else:
        values |= {"gear_out.stop_mode": r.choice(list(StopMode))}
        values["gear_out.stop_position"] = LENGTH * r.uniform(-2.0, 2.0)
    return values


def random_script(r: Random, *, jumps: bool) -> Script:
    """A master that wanders, stops and turns, all in binary fractions, and edges of start; `jumps`: of its velocity."""
    speed = 8.0 * r.randint(-2, 2)
    segments: list[dict[str, float]] = []
    master = {"position": r.uniform(-5.0, 5.0), "velocity": speed, "segments": segments}
    for _ in range(r.randint(3, 10)):
        segment = {"duration": r.choice([0.25, 0.5, 1.0])}
        target = float(r.randint(-16, 16)) if r.random() < 0.8 else 0.0
        match r.choice(["steady", "ramp", "ramp", *["jump"] * jumps]):
            case "ramp":
                segment["acceleration"] = (target - speed) / segment["duration"]
                speed = target
            case "jump":
                segment["velocity"] = speed = target
        segments.append(segment)
    stop = sum(segment["duration"] for segment in segments)
    sets: list[dict[str, Any]] = []
    engaged = False
    for at in sorted(r.uniform(0.0, stop) for _ in range(r.randint(1, 8))):
        values: dict[str, Any] = {}
        if r.random() < 0.8:
            engaged = not engaged
            values |= order(r, engaged)
        if r.random() < 0.15:
            values |= {"gearing.numerator": r.choice([1, 3, -2, 0]), "gearing.denominator": r.choice([1, 2, -5])}
        if r.random() < 0.1:
            values |= {"activate": r.random() < 0.7, "reset": r.random() < 0.5}
        if r.random() < 0.1:
            values |= {"set_slave.execute": r.random() < 0.7, "set_slave.value": r.uniform(-9.0, 9.0)}
            values |= {"set_master.execute": r.random() < 0.7, "set_master.value": r.uniform(-9.0, 9.0)}
        sets.append({"at": at, **values})
    start = {
        "gearing.numerator": r.choice([1, 3, -2, 7]),
        "gearing.denominator": r.choice([1, 2, -5]),
        "slave.initial_position": r.uniform(-5.0, 5.0),
        "master.period": r.choice([0.0, 27.0]),
        "slave.period": r.choice([0.0, 13.0]),
    }
    return {"stop_time": stop, "step_size": 0.01, "start": start, "master": master, "set": sets}


GREATEST = 2.0 * FASTEST / 0.25  # acceleration of the master
SIZES = (
    *(LENGTH, FASTEST, GREATEST + FASTEST**2 / LEAST),
    FASTEST**3 / LEAST**2 + 3.0 * FASTEST * GREATEST / LEAST,
)
TOLERANCES = dict.fromkeys(COLUMNS, 0.0) | {
    **{name: 7e-9 * size for name, size in zip(MOTION, SIZES, strict=True)},
    **{"local.trigger_position": 7e-8, "local.line_offset": 7e-8, "local.progress": 1e-8},
}
"""Relative to the sizes of the motion; the ratio is 7 at most."""


@repeatable
@given(st.integers(0, 2**32 - 1).map(Random), st.sampled_from([START, END]))
def test_the_block_is_its_oracle(r: Random, mode: MasterInput) -> None:
    script = random_script(r, jumps=mode == START)
    start = script["start"]
    periods = {"slave.position": start["slave.period"], "local.trigger_position": start["master.period"]}
    ends = [r.uniform(0.0, script["stop_time"]) for _ in range(r.choice([0, 5, 40]))]
    rows = simulate(Gearing(), script, ends, COLUMNS, mode=mode)
    assert find_differences(reference, script, rows, TOLERANCES, periods) == [], script
