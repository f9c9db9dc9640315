"""In random scripts the block does what its oracle does, at every step size."""

from random import Random
from typing import Any

import pytest

from tests.model.flying_saw.scripted import along
from tests.oracle.flying_saw import reference
from tests.support.harness import MOTION

STATES = ("state_code", "error_id", "characteristics.profile")
ROLLBACK = [(), ("rollback_lock",), ("instant_stop_on_rollback",), ("rollback_lock", "instant_stop_on_rollback")]


def segment(duration: float, acceleration: float) -> dict[str, float]:
    return {"duration": duration, "acceleration": acceleration}


def time_based_reversal(r: Random, bits: tuple[str, ...]) -> dict[str, Any]:
    """The master turns back before the slave is in sync, passes the coupling position, and comes forwards again."""
    speed = r.choice((-1.0, 1.0)) * r.uniform(50.0, 500.0)
    gains = {name: abs(speed) * r.uniform(0.2, 0.8) for name in ("acceleration", "deceleration")}
    start = {
        "axis.initial_velocity": speed * r.choice((0.0, 0.3, r.uniform(-1.0, 1.0))),
        "sync_mode.time_based": True,
        "sync_mode.check_max_jerk": r.random() < 0.5,
        **{f"sync_mode.{bit}": True for bit in bits},
        **{f"gear_in_velo.{name}": limit for name, limit in gains.items()},
        "gear_in_velo.jerk": abs(speed) * r.uniform(2.0, 20.0),
        "gear_in_velo.ratio_numerator": r.choice((1.0, 0.7, -1.3)),
    }
    turning, back, again = r.uniform(0.1, 0.5), r.uniform(1.2, 1.8), r.uniform(1.2, 2.0)
    segments = [
        segment(0.5 + r.uniform(0.0, 0.3), 0.0),
        segment(turning, -speed * back / turning),
        segment(1.5, 0.0),
        segment(0.5, speed * again * 2.0),
        segment(3.0, 0.0),
    ]
    sets = [{"at": 0.4, "gear_in_velo.execute": True}]
    return {"stop_time": 5.5, "step_size": 0.5, "start": start, "set": sets} | {
        "master": {"velocity": speed, "segments": segments}
    }


def encoder(r: Random) -> dict[str, Any]:
    """Both gear-in commands, while the master has an acceleration about as great as an encoder makes."""
    speed = r.choice((-1.0, 1.0)) * r.uniform(50.0, 500.0)
    counts, cycle = 10.0 ** r.uniform(-3.0, 0.0), 10.0 ** r.uniform(-3.0, -1.0)
    gains = [r.choice((-1.0, 1.0)) * min(2.0 * counts / cycle**2, abs(speed)) * r.uniform(0.5, 1.5) for _ in range(3)]
    start = {
        "axis.initial_velocity": speed * r.choice((0.0, 0.3, r.uniform(-1.0, 1.0))),
        "master.encoder_scaling": counts,
        "master.sample_time": cycle,
        "sync_mode.check_undershoot_velocity": r.random() < 0.5,
        "sync_mode.check_max_acceleration": False,
        "sync_mode.prefer_constant_velocity": r.random() < 0.3,
        "gear_in_pos.slave_sync_position": speed * r.uniform(0.5, 1.5),
        "gear_in_pos.master_sync_position": speed * r.uniform(1.5, 2.5),
        "gear_in_pos.master_start_distance": abs(speed) * r.choice((0.0, r.uniform(0.3, 1.5))),
    }
    segments = [segment(0.3, gain) for gain in gains]
    group = r.choice(("gear_in_pos", "gear_in_velo"))
    sets = [{"at": r.uniform(0.05, 0.85), f"{group}.execute": True}]
    master = {"velocity": speed, "segments": segments}
    return {"stop_time": 4.0, "step_size": 0.5, "start": start, "set": sets, "master": master}


def assert_as_the_oracle(script: dict[str, Any], steps: tuple[int, ...]) -> list[dict[str, float]]:
    """At times 20 ms apart, with steps of so many of them; the oracle's rows, which are two where something jumps."""
    times = [0.02 * i + 0.001 for i in range(1, round(script["stop_time"] / 0.02))]
    rows = reference(script, times)
    size = abs(script["master"]["velocity"])
    expected: dict[float, list[dict[str, float]]] = {}
    for row in rows:
        expected.setdefault(row["time"], []).append(row)
    for step in steps:
        for time, row in along(script, times[step - 1 :: step], (*MOTION[:3], *STATES)).items():
            same = [
                all(row[name] == other[name] for name in STATES)
                and all(row[name] == pytest.approx(other[name], abs=1e-7 * size) for name in MOTION[:3])
                for other in expected[time]
            ]
            assert any(same), (step, time, row, expected[time])
    return rows


@pytest.mark.slow
@pytest.mark.parametrize("bits", ROLLBACK)
def test_time_based_reversals(bits: tuple[str, ...]) -> None:
    met: set[float] = set()
    for seed in range(25):
        rows = assert_as_the_oracle(time_based_reversal(Random(seed), bits), (1, 7, 40))
        met |= {row["state_code"] for row in rows}
    assert met >= ({11.0, 12.0, 13.0} if bits else {12.0, 13.0})


@pytest.mark.slow
def test_accelerations_of_an_encoder() -> None:
    profiles: set[float] = set()
    for seed in range(80):
        rows = assert_as_the_oracle(encoder(Random(seed)), (1, 7, 40))
        profiles |= {row["characteristics.profile"] for row in rows}
    assert profiles >= {1.0, 2.0, 3.0}
