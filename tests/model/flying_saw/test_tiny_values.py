"""The FlyingSaw with masters that hardly move: no plan, refused or not, has a number that is none."""

import math
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.interface import State
from tests.model.flying_saw.harness import FlyingSawHarness
from tests.model.flying_saw.strategies import MODES
from tests.support.blocks.drawn import drawn
from tests.support.blocks.finite import run_finite
from tests.support.blocks.numbers import TINY, numbers_in
from tests.support.blocks.runs import BlockRun

LIMITS = (1e-12, 3e-11, 1e-9, 1e-3, 1.0, 100.0, 1e4, 1e5, 1e8, 1e12)
GEAR_INS, OTHERS = ("gear_in_velo", "gear_in_pos"), ("halt", "move_velocity", "move_absolute", "gear_out")


def number(r: Random, size: float) -> float:
    tiny = r.choice(TINY) * r.choice((1.0, -1.0, r.uniform(-10.0, 10.0)))
    return r.choice((0.0, 0.0, tiny, tiny, size * r.gauss(0.0, 1.0), size))


def hardly_moving(r: Random, steps: int) -> BlockRun:
    """Axes at rest, ordinary ones and ones that hardly move; commands to all of them, with all sorts of limits."""
    size = r.choice((1e-3, 1.0, 100.0, 1e5))
    places = ("master.position", "master.velocity", "master.acceleration")
    start: dict[str, Any] = {
        "master.input_mode": r.choice((1, 1, 1, 2)),
        "master.period": r.choice((0.0, 0.0, 1e-9, 5e-4, 360.0)),
        "axis.min_position": -1e9,
        "axis.max_position": 1e9,
        **{f"axis.max_{name}": r.choice(LIMITS) for name in ("velocity", "acceleration", "jerk")},
        "axis.max_deceleration": r.choice((0.0, *LIMITS)),
        **{name: number(r, size) for name in (*places, "axis.initial_position", "axis.initial_velocity")},
        **{f"sync_mode.{mode}": r.random() < 0.3 for mode in MODES},
    }

    def values() -> dict[str, Any]:
        changed = {name: number(r, size) for name in places if r.random() < 0.4}
        changed |= {f"{group}.execute": r.random() < 0.5 for group in GEAR_INS}
        changed |= {f"{group}.execute": r.random() < 0.1 for group in OTHERS}
        for group in GEAR_INS:
            changed[f"{group}.ratio_numerator"] = r.choice((1.0, 1.0, -1.0, 1e-12, 1e12, r.uniform(-3.0, 3.0)))
        for name in ("master_sync_position", "slave_sync_position"):
            changed[f"gear_in_pos.{name}"] = number(r, size)
        changed["gear_in_pos.master_start_distance"] = r.choice((0.0, 0.0, abs(number(r, size))))
        return changed | {"move_velocity.velocity": number(r, size), "move_absolute.position": number(r, size)}

    return BlockRun(
        start, [(r.choice((1e-3, 0.01, 1.0, 10.0 ** r.uniform(-15.0, 6.0))), values()) for _ in range(steps)]
    )


@drawn(120)
@given(st.integers(0, 2**32 - 1).map(Random))
def test_an_axis_that_hardly_moves_leads_to_no_number_that_is_none(r: Random) -> None:
    for saw in run_finite(FlyingSaw(), hardly_moving(r, 12)):
        assert saw.error == (saw.error_id != 0)


@pytest.mark.parametrize("speed", [5e-324, -1e-310, 1e-200, -9e-61])
@pytest.mark.parametrize("modes", [(), ("time_based",), ("check_max_jerk",)])
def test_a_master_of_almost_no_velocity_is_at_rest(speed: float, modes: tuple[str, ...]) -> None:
    """A ramp to 5e-324 u/s would take no time as a number. The slave at rest is in sync with it at once."""
    limits = {"axis.max_jerk": 1e-9, "axis.max_acceleration": 3e-11}
    saw = FlyingSawHarness(limits, speed=speed).modes(*modes).give("gear_in_velo").run(0.05)
    assert (saw.state, saw["in_sync"], saw["error_id"]) == (State.SYNCHRON, True, 0)
    assert all(map(math.isfinite, numbers_in(saw.block)))


@pytest.mark.parametrize("speed", [5e-324, -1e-310])
def test_a_master_of_almost_no_velocity_never_reaches_a_sync_position(speed: float) -> None:
    saw = FlyingSawHarness(speed=speed)
    saw.give("gear_in_pos", master_sync_position=math.copysign(100.0, speed), slave_sync_position=50.0).run(0.05)
    assert saw["gear_in_pos.error_id"] == 0x426E
