"""Random commands to the FlyingSaw: PLCopen's rules hold, and a refused command changes nothing."""

import math
from collections.abc import Iterable
from random import Random
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.master import MasterInput
from tests.model.flying_saw.harness import GROUPS, OUTPUTS, FlyingSawHarness
from tests.support.blocks.drawn import drawn
from tests.support.blocks.numbers import numbers_in

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
rngs = st.integers(0, 2**32 - 1).map(Random)

RESULT = {"gear_in_velo": "in_sync", "gear_in_pos": "in_sync", "move_velocity": "in_velocity"}
MODES = [name.removeprefix("sync_mode.") for name in FlyingSawHarness().stepper.cells if name.startswith("sync_mode.")]


def commanded(saw: FlyingSawHarness, rng: Random, group: str) -> dict[str, Any]:
    """Mostly feasible values for a command given now; lengths are of the size of 100."""
    values: dict[str, Any] = {}
    if group.startswith("gear_in"):
        values = {"ratio_numerator": rng.choice([1.0, 0.5, -1.0, 0.0]), "acceleration": rng.choice([0.0, 500.0, -1.0])}
    if group == "gear_in_pos":
        ahead = saw.speed * rng.uniform(0.2, 1.0)
        values["master_sync_position"] = saw.master_position + ahead
        values["slave_sync_position"] = saw.slave[0] + values["ratio_numerator"] * ahead * rng.uniform(0.1, 1.2)
        values["master_start_distance"] = abs(ahead) * rng.choice([0.0, 0.0, 0.5])
    if group == "move_velocity":
        values["velocity"] = rng.choice([0.0, rng.gauss(0.0, 100.0), 3e3])
    if group == "move_absolute":
        values["position"] = rng.choice([rng.gauss(0.0, 100.0), rng.gauss(0.0, 100.0), 2e9])
    return values


def random_step(saw: FlyingSawHarness, rng: Random, groups: Iterable[str] = GROUPS) -> None:
    """Perhaps falling edges, perhaps commands, then a step of a wandering master."""
    for group in sorted(saw.held):
        if rng.random() < 0.3:
            saw.release(group)
    free = [group for group in groups if group not in saw.held]
    if rng.random() < 0.35 and free:
        saw.modes(*(name for name in MODES if rng.random() < 0.12))
        for group in rng.sample(free, min(len(free), rng.choice([1, 1, 1, 2]))):
            if group != "stop" or rng.random() < 0.3:
                saw.give(group, **commanded(saw, rng, group))
    if rng.random() < 0.1:
        saw.speed = rng.choice([0.0, -saw.speed, rng.gauss(0.0, 100.0)])
    saw.run(10.0 ** rng.uniform(-3.0, -0.2), acceleration=rng.choice([0.0, 0.0, rng.gauss(0.0, 200.0)]))


MACHINE = {"axis.max_acceleration": 2000.0, "axis.max_deceleration": 1500.0, "axis.max_jerk": 20000.0}


@drawn(150)
@given(rngs, st.sampled_from([START, END, MasterInput.POSITION_ONLY]), st.sampled_from([0.0, 0.0, 70.0]))
def test_plcopen_s_rules_hold_and_nothing_is_ever_nan(rng: Random, mode: MasterInput, period: float) -> None:
    saw = FlyingSawHarness({**MACHINE, "master.period": period}, speed=rng.choice([100.0, -40.0, 0.0]), mode=mode)
    ordered: set[str] = set()  # groups that have had an edge since `execute` was false
    shown: dict[str, set[str]] = {group: set() for group in GROUPS}
    for _ in range(40):
        held = set(saw.held)
        random_step(saw, rng)
        ordered = (ordered | (saw.held - held)) & saw.held
        for group in GROUPS:
            now = saw.results(group)
            results = now & {RESULT.get(group, "done"), "command_aborted", "error"}
            assert ("busy" in now) == ("active" in now) or group in ("gear_out", "reset")
            assert len(results) + ("busy" in now) == 1 or group not in ordered
            assert len(results) + ("busy" in now) <= 1
            assert saw[f"{group}.error"] == (saw[f"{group}.error_id"] != 0)
            if group not in saw.held:
                assert not results & shown[group], "a result is shown again after the falling edge"
            shown[group] = results
        assert sum("busy" in saw.results(group) for group in GROUPS) <= 1
        for group in ("gear_in_velo", "gear_in_pos"):
            assert "in_sync" not in saw.results(group) or saw.state == State.SYNCHRON
        assert saw["error"] == (saw["error_id"] != 0)
        assert saw["in_sync"] == (saw.state == State.SYNCHRON)
        assert saw["state_code"] == int(saw.state)
        assert saw["coupled"] == (saw.state in (State.PREPHASE, State.SYNCHRONIZING, State.SYNCHRON))
        assert saw["coupled"] == (saw["plcopen_state"] == PlcopenState.SYNCHRONIZED_MOTION)
        _, v, a = saw.slave
        if not saw["coupled"]:
            moves = State.CONSTANT_VELOCITY if a == 0.0 else State.DECELERATING if v * a < 0.0 else State.ACCELERATING
            assert saw.state == (State.INACTIVE if v == a == 0.0 else moves)
        assert all(math.isfinite(x) for x in numbers_in(saw.block))
        assert 0.0 <= saw["local.progress"] <= 1.0


WRONG: dict[str, dict[str, Any]] = {
    "gear_in_pos": {"ratio_numerator": 0.0},
    "move_absolute": {"position": 3e9},
    "halt": {"deceleration": -1.0},
}


@drawn(60)
@given(rngs)
def test_refused_commands_leave_everything_else_as_it_is_to_the_last_bit(rng: Random) -> None:
    """A run with commands, and the same with refused ones of other groups among them."""
    commands = ("gear_in_velo", "gear_out", "move_velocity", "reset")
    saw = FlyingSawHarness(MACHINE, speed=rng.choice([100.0, -40.0, 0.0]))
    twin, seed = saw.twin(), rng.randint(0, 2**32)
    ours, theirs = Random(seed), Random(seed)
    for _ in range(40):
        for group, values in WRONG.items():
            if group in saw.held:
                saw.release(group)
            elif rng.random() < 0.3:
                saw.give(group, **values)
        held = {group for group in saw.held if group in WRONG}
        saw.held -= held
        random_step(saw, ours, commands)
        random_step(twin, theirs, commands)
        for name in OUTPUTS:
            if not name.startswith((*(f"{group}." for group in WRONG), "error", "local.plan_")):
                assert repr(saw[name]) == repr(twin[name]), name
        for group in WRONG:
            assert saw.results(group) == ({"error"} if group in saw.held else set())
