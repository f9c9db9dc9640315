"""libcosim runs the FMUs of both flavours with the results of FMPy."""

import math
from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description

from motionsync_fmu.build.fmu import Flavour, build_python
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.cosim import cosim
from tests.support.fmus import Fmus, build_for_host


def libcosim(fmu: Path, plan: list[dict[str, Any]], h: float) -> list[dict[str, float]]:
    """The unit in libcosim, driven by overriding its inputs; start values are baked in, for it cannot set
    enumerations."""
    description = read_model_description(str(fmu))
    references = {v.name: (v.type, v.valueReference) for v in description.modelVariables}
    execution = cosim().CosimExecution.from_step_size(step_size=round(h * 1e9))
    slave = execution.add_local_slave(cosim().CosimLocalSlave(fmu_path=str(fmu), instance_name="unit"))
    manipulator, observer = cosim().CosimManipulator.create_override(), cosim().CosimObserver.create_last_value()
    assert execution.add_manipulator(manipulator)
    assert execution.add_observer(observer)
    rows = []
    for inputs in plan:
        for name, value in inputs.items():
            kind, reference = references[name]
            set_values = {
                "Real": manipulator.slave_real_values,
                "Integer": manipulator.slave_integer_values,
                "Boolean": manipulator.slave_boolean_values,
            }[kind]
            assert set_values(slave, [reference], [value])
        assert execution.step()
        assert execution.status().state != cosim().CosimExecutionState.ERROR.value
        rows.append({})
        for kind, get in (
            ("Real", observer.last_real_values),
            ("Integer", observer.last_integer_values),
            ("Boolean", observer.last_boolean_values),
        ):
            names = [n for n, (k, _) in references.items() if k == kind]
            rows[-1] |= zip(names, map(float, get(slave, [references[n][1] for n in names])), strict=True)
    return rows


def assert_fmpy_gives(rows: list[dict[str, float]], fmu: Path, plan: list[dict[str, Any]], h: float) -> None:
    with FmuInstance(fmu) as host:
        host.initialize(plan[0])
        for inputs, row in zip(plan, rows, strict=True):
            host.step(h, inputs)
            now = host.get()
            assert row == {name: float(now[name]) for name in row}


@pytest.mark.parametrize("curve", ["PARABOLA", "POLYNOMIAL_3_4_5"])
def test_libcosim_gives_the_results_of_fmpy(tmp_path: Path, curve: str) -> None:
    starts = {"master.period": "10", "output_phasing": "2", "rest_value": "4", "curve": curve}
    fmu = build_python(Recipe("Synchronizer", "mm", starts), tmp_path / "Synchronizer.fmu")
    h, plan = 1.0 / 128.0, []  # whole nanoseconds, and exact in binary
    for i in range(1500):
        t = i * h
        inputs = {"master.position": (3.0 * t) % 10.0, "master.velocity": 3.0, "master.acceleration": 0.0}
        plan.append({**inputs, "rest_value": 4.0, "active": True, "stop": 0.5 < t < 5.0, "start": t > 7.0})
    cosim = libcosim(fmu, plan, h)
    assert {row["state_code"] for row in cosim} == {0.0, 1.0}
    assert_fmpy_gives(cosim, fmu, plan, h)


def two_cuts(h: float) -> list[dict[str, Any]]:
    """Of a FlyingSaw, every 500 of a master at 250 u/s; the second is ordered on the way back."""
    plan = []
    for i in range(round(4.5 / h)):
        t = i * h
        plan.append(
            {
                "master.position": 250.0 * t,
                "master.velocity": 250.0,
                "gear_in_pos.master_sync_position": 250.0 if t < 2.0 else 750.0,
                "gear_in_pos.slave_sync_position": 100.0,
                "gear_in_pos.execute": 0.25 < t < 1.6 or 2.35 < t < 3.6,
                "move_absolute.velocity": 600.0,
                "move_absolute.execute": 1.6 < t < 2.35 or t > 3.6,
                "sync_mode.check_max_velocity": True,
            }
        )
    return plan


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_libcosim_gives_the_flying_saw_of_fmpy(fmus: Fmus, flavour: str) -> None:
    fmu = getattr(fmus, flavour)("FlyingSaw")
    h = 1.0 / 128.0
    plan = two_cuts(h)
    cosim = libcosim(fmu, plan, h)
    assert {row["state_code"] for row in cosim} >= {0.0, 4.0, 5.0, 12.0, 13.0}
    lags = [i * h * 250.0 + 250.0 * h - row["slave.position"] for i, row in enumerate(cosim) if row["in_sync"]]
    assert {round(lag, 9) for lag in lags} == {150.0, 650.0}
    assert_fmpy_gives(cosim, fmu, plan, h)


def in_gear_and_out(h: float) -> list[dict[str, Any]]:
    """Of a Gearing: engaged through (150, 0), the ratio changed from 1 to -2 at 250, disengaged to rest at -200."""
    return [
        {
            "master.position": 100.0 * i * h,
            "master.velocity": 100.0,
            "gear_in.reference_position": 150.0,
            "gear_out.stop_position": -200.0,
            "start": 0.25 < i * h < 3.0,
            "gearing.numerator": 1 if i * h < 2.5 else -2,
        }
        for i in range(round(5.0 / h))
    ]


@pytest.mark.parametrize("flavour", [Flavour.PYTHON, Flavour.NATIVE])
def test_libcosim_gives_the_gearing_of_fmpy(tmp_path: Path, flavour: Flavour) -> None:
    starts = {"gear_in.start_mode": "WITH_CW_CCW_REFERENCE_POSITION", "gear_out.stop_mode": "WITH_CW_STOP_POSITION"}
    fmu = build_for_host(flavour, Recipe("Gearing", "mm", starts), tmp_path / "Gearing.fmu")
    h = 1.0 / 128.0
    plan = in_gear_and_out(h)
    cosim = libcosim(fmu, plan, h)
    assert {row["state_code"] for row in cosim} == {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}
    in_gear = [((i + 1) * h * 100.0, row["slave.position"]) for i, row in enumerate(cosim) if row["in_gear"]]
    offsets = {round(s - m, 9) if m <= 250.0 else round(s + 2.0 * m, 9) for m, s in in_gear}
    assert offsets == {-150.0, 600.0}
    assert cosim[-1]["slave.position"] == -200.0
    assert_fmpy_gives(cosim, fmu, plan, h)


def cycles(h: float) -> list[dict[str, Any]]:
    """Of a Follower with the cycle 1000: one whole way, and one whose synchronized phase is ended early."""
    return [
        {
            "master.position": 250.0 * i * h,
            "master.velocity": 250.0,
            "sync_master": 400.0,
            "position_to_park": i * h > 0.25,
            "end_synchronism": i * h > 6.0,
        }
        for i in range(round(9.0 / h))
    ]


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_libcosim_gives_the_follower_of_fmpy(fmus: Fmus, flavour: str) -> None:
    fmu = getattr(fmus, flavour)("Follower")
    h = 1.0 / 128.0
    plan = cycles(h)
    cosim = libcosim(fmu, plan, h)
    assert {row["state_code"] for row in cosim} == {1.0, 3.0, 5.0, 8.0, 9.0, 10.0}
    lags = [(i + 1) * h * 250.0 - row["slave.position"] for i, row in enumerate(cosim) if row["state_code"] == 8.0]
    assert {round(lag, 9) for lag in lags} == {300.0, 1300.0}
    assert cosim[-1]["cycle"] == 2.0
    assert_fmpy_gives(cosim, fmu, plan, h)


def telegrams(h: float) -> list[dict[str, Any]]:
    """Of a RemoteSync with the cycle h, from a sender whose clock runs 2 % fast: none come for a while, and then it is
    enabled anew."""
    plan = []
    for i in range(900):
        index = math.floor(1.02 * min(i, 600) + 0.3)
        plan.append(
            {
                "remote.cycle_index": index if i < 800 else 0,
                "remote.position": 250.0 * h * (index - 0.3) / 1.02,
                "remote.velocity": 250.0,
                "remote.acceleration": 0.0,
                "enable": i < 700,
            }
        )
    return plan


@pytest.mark.parametrize("flavour", [Flavour.PYTHON, Flavour.NATIVE])
def test_libcosim_gives_the_remote_axis_of_fmpy(tmp_path: Path, flavour: Flavour) -> None:
    h = 1.0 / 128.0
    starts = {"estimator": "PHASE", "task_cycle_time": repr(h), "end_of_transition_limit": "10"}
    fmu = build_for_host(flavour, Recipe("RemoteSync", "mm", starts), tmp_path / "RemoteSync.fmu")
    plan = telegrams(h)
    cosim = libcosim(fmu, plan, h)
    assert {row["state_code"] for row in cosim} == {1.0, 2.0, 3.0, 4.0}
    assert {row["error_id"] for row in cosim} == {0.0, 0x4B52}
    assert all(row["synced"] for row in cosim[200:600])
    lags = [i * h * 250.0 - cosim[i]["slave.position"] for i in range(400, 600)]
    assert max(map(abs, lags)) < 0.05 * 250.0 * h
    assert_fmpy_gives(cosim, fmu, plan, h)


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_an_exceeded_limit_is_logged_once_with_its_value(fmus: Fmus, flavour: str) -> None:
    """A move of a FlyingSaw at 300 u/s, whose axis can do 200; its end takes the output back."""
    limited = []
    with FmuInstance(getattr(fmus, flavour)("FlyingSaw")) as saw:
        saw.initialize({"axis.max_velocity": 200.0, "move_absolute.position": 900.0, "move_absolute.velocity": 300.0})
        for _ in range(40):
            saw.step(0.1, {"move_absolute.execute": True})
            limited.append(saw.get(["limit_exceeded"])["limit_exceeded"])
        messages = [text for text in saw.messages if "limit exceeded" in text]
    assert limited == [True] * sum(limited) + [False] * (40 - sum(limited))
    assert 30 < sum(limited) < 40  # 3 s at 300 u/s, with short ramps
    assert len(messages) == 1
    assert "local.exceeded_value = 300" in messages[0]
    assert "axis.max_velocity = 200" in messages[0]
