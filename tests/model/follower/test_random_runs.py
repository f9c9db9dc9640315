"""The Follower on random machines is its oracle: linear slaves and cyclic ones, fixed and variable cycles, with values
of sync_master that come in time, late, or too soon, and cycles that are skipped."""

from collections import defaultdict
from collections.abc import Callable
from random import Random
from typing import Any

from motionsync.follower.block import Follower
from motionsync_fmu.interface.stepper import Stepper
from tests.oracle.follower import events, reference

SPEED = 200.0  # of the master, u/s
STOP = 12.0  # s
STEP = 0.05  # s
EXPECTED = {"start missed", "start skipped", "value too soon", "recovered", "waiting", "following", "decel", "homing"}


def random_script(r: Random) -> dict[str, Any]:
    """Positioned at 0.1 s; then sync_master and the levels that skip a cycle change up to eight times, a little after
    communication points."""
    to_sync, to_out, onwards = r.choice([60.0, 100.0, 150.0]), r.choice([50.0, 100.0, 200.0]), r.choice([50.0, 200.0])
    is_cyclic, is_variable = r.random() < 0.7, r.random() < 0.6
    if is_cyclic:
        cycle = to_out + r.uniform(0.4, 3.0) * (to_sync + onwards)
    else:
        cycle = (2.0 * to_sync + to_out + 2.0 * onwards) * r.uniform(1.05, 2.0)
    start = {
        "slave_cycle": to_sync + to_out + onwards if is_cyclic else 0.0,
        "sync_slave": to_sync,
        "sync_out": to_sync + to_out,
        "space_stop_slave": onwards,
        "master_cycle": float(round(cycle)),
        "sync_master": float(r.randint(-500, 1500)),
        "variable_cycle": is_variable,
        "stop_in_park": r.random() < 0.3,
        "recover_late_sync": r.random() < 0.8,
        "space_wait_in_park": r.choice([0.0, 0.1 * onwards]),
    }
    sets: list[dict[str, Any]] = [{"at": 0.1, "position_to_park": True}]
    for at in sorted(round(r.uniform(0.2, STOP - 0.5), 2) + 0.003 for _ in range(r.randint(1, 8))):
        value = start["sync_master"] + r.randint(-300, 300)
        if is_variable:
            value = round(SPEED * at + r.uniform(0.0, 2.5) * cycle)
        levels = {name: r.random() < 0.5 for name in ("skip_next_cycle", "sync_assumed") if r.random() < 0.2}
        sets.append({"at": at, "sync_master": float(value), **levels})
    segments = [{"duration": STOP, "velocity": SPEED}]
    master = {"position": 0.0, "velocity": SPEED, "segments": segments}
    return {"stop_time": STOP, "step_size": STEP, "start": start, "master": master, "set": sets}


def test_the_block_is_its_oracle(soak: Callable[[int, int], int]) -> None:
    met: set[str] = set()
    for seed in range(soak(80, 800)):
        script = random_script(Random(seed))
        times = [STEP * i + 0.0217 for i in range(int(STOP / STEP))]
        expected = defaultdict(list)
        for row in reference(script, times):
            expected[row["time"]].append(row)
        met |= {name for _, name in events(script)}
        assert_as_expected(script, expected)
    assert met >= EXPECTED


def assert_as_expected(script: dict[str, Any], expected: dict[float, list[dict[str, float]]]) -> None:
    """The block is stepped to each of these times and to each of the script's."""
    stepper, now = Stepper(Follower()), 0.0
    stepper.set({**script["start"], "master.velocity": SPEED})
    stepper.initialize()
    sets = {table["at"]: {name: value for name, value in table.items() if name != "at"} for table in script["set"]}
    for time in sorted(expected.keys() | sets.keys()):
        stepper.set({"master.position": SPEED * now, "master.velocity": SPEED})
        stepper.step(time - now)
        now = time
        rows = expected.get(time, [])
        assert not rows or any(is_as_expected(stepper, row) for row in rows), (time, script)
        stepper.set(sets.get(time, {}))


def is_as_expected(stepper: Stepper, row: dict[str, float]) -> bool:
    tolerances = {"slave.position": 1e-6, "slave.velocity": 1e-5, "master_to_sync": 1e-6, "state_code": 0.0}
    return all(abs(stepper[name] - row[name]) <= tolerance for name, tolerance in tolerances.items())
