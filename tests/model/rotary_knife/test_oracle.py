"""The RotaryKnife against its oracle, in all outputs: known results, commands, and scripts at random."""

from random import Random
from typing import Any

import pytest

from tests.model.rotary_knife.knife_scripts import HORIZONTAL, LATE, STOP_LINE, script, steady
from tests.model.rotary_knife.scripted_runs import differences, random_script
from tests.support.blocks.oracle_runs import Script, grid

pytestmark = pytest.mark.slow  # make quick tests blocks by what is known of them


def differing(run: Script, step: float = 0.01, *, stride: int = 1) -> list[str]:
    """In steps of this length, s."""
    return differences(run, grid(run, step), stride=stride)


@pytest.mark.parametrize("length", [300.0, 400.0, 600.0, 900.0, 1217.0, 1500.0])
def test_each_format(length: float) -> None:
    assert differing(steady(1000.0, 5.0, length=length)) == []


@pytest.mark.parametrize(
    "values",
    [
        {"knife__blades": 2, "knife__park_angle": 90.0, "length": 300.0},
        {"sync__overspeed": 0.05},
        {"sync__mode": HORIZONTAL, "sync__before": 60.0, "sync__after": 60.0},
        {"sync__mode": HORIZONTAL, "sync__before": 80.0, "sync__after": 80.0},
    ],
)
def test_each_kind_of_knife(values: dict[str, Any]) -> None:
    assert differing(steady(500.0, 4.0, **{"length": 600.0, **values}), stride=5) == []


@pytest.mark.parametrize("late_mode", [1, LATE, STOP_LINE])
def test_each_late_mode(late_mode: int) -> None:
    assert differing(steady(1200.0, 3.0, length=300.0, late_mode=late_mode), stride=3) == []


@pytest.mark.parametrize(
    ("sets", "values"),
    [
        ([{"at": 1.7, "stop": True}], {}),
        ([{"at": 1.7, "abort": True}], {}),
        (
            [{"at": 1.9, "cut_now": True}, {"at": 2.9, "cut_now": False}, {"at": 3.1, "cut_now": True}],
            {"length": 900.0},
        ),
        ([{"at": 2.9, "cut_now": True}], {"length": 1900.0}),
        ([{"at": 1.9, "hold": True}, {"at": 3.0, "hold": False}], {}),
        ([{"at": 1.25, "length": 300.0}, {"at": 2.05, "length": 1500.0}], {}),
        ([{"at": 1.25, "length": 400.0}, {"at": 2.05, "length": 900.0}], {"change_mode": 2}),
    ],
)
def test_each_command(sets: list[dict[str, Any]], values: dict[str, Any]) -> None:
    assert differing(steady(600.0, 4.5, *sets, **{"length": 600.0, **values}), stride=3) == []


def test_a_line_that_turns_back_over_several_pieces() -> None:
    segments = [{"duration": 2.0}, {"duration": 1.0, "acceleration": -1600.0}, {"duration": 0.5}]
    segments += [{"duration": 1.0, "acceleration": 1600.0}, {"duration": 1.0}]
    run = script(segments, {"at": 0.2, "start": True}, velocity=800.0, length=600.0)
    assert differing(run, stride=9) == []


@pytest.mark.parametrize("step", [0.007, 0.0471])
def test_the_block_is_its_oracle(step: float) -> None:
    """Random knives, lines and commands; all outputs to 1e-9 of the machine's size."""
    for seed in (*range(16), 47, 76, 2108707):
        run = random_script(Random(seed), 4.0, step)
        assert differing(run, step, stride=max(int(0.09 / step), 1)) == [], seed


def test_a_horizontal_knife_is_its_oracle() -> None:
    for seed in range(4):
        run = random_script(Random(seed), 3.0, 0.01, horizontal=True)
        assert differing(run, stride=25) == [], seed
