"""FMUs whose variables are turned, both flavours: the results of the default interface, and each range judged."""

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from motionsync.blocks import BLOCKS
from motionsync.gearing.interface import StartMode, Transition
from motionsync_fmu.build import Flavour, build, fmu_path, outdated
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.turns import Interface
from motionsync_fmu.scenario.fmu_instance import FmuError, FmuInstance, recipe_of
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.run import simulate
from tests import ROOT
from tests.support.fmus import Fmus, Shared, build_here
from tests.support.random_runs import calm
from tests.support.runs import Run

H = 2.0**-7  # s
TURNED = {  # something of each kind, where the block has it
    "Synchronizer": Interface(
        input="output_phasing", parameter=("active", "rest_value"), local=("slave.jerk", "ready"), output="local.*"
    ),
    "FlyingSaw": Interface(
        input=("gear_in_pos.ratio_*", "sync_mode.*", "axis.max_*"),
        parameter=("gear_in_pos.master_start_distance", "move_absolute.position"),
        local=("slave.jerk", "coupled"),
        output=("characteristics.*", "local.progress"),
    ),
    "Gearing": Interface(
        input=("gearing.*", "gear_in.[!o]*", "gear_out.time"),
        parameter=("activate", "gear_in.offset", "set_master.value"),
        local="slave.velocity",
        output="local.*",
    ),
    "Follower": Interface(
        input=("k_slave_master", "check_*", "max_*"),
        parameter=("sync_master", "sync_assumed"),
        local="master_to_*",
        output="local.p*",
    ),
    "RemoteSync": Interface(
        input=("delay_time_offset", "max_position_difference"),
        parameter="enable",
        local=("drift", "slave.j*"),
        output=("beats", "cycle_index_difference"),
    ),
    "CutToLength": Interface(
        input=("order.skip", "order.clear", "calibration.[emr]*", "clear_statistics", "kerf"),
        parameter=("length*", "order.length", "mark.position", "line.wanted_velocity"),
        local=("slave.jerk", "order.waiting", "statistics.skipped"),
        output=("batch_[cd]*", "piece.*", "tool.blade_down"),
    ),
}
NATIVE = ("Gearing", "FlyingSaw")  # building one takes long; the C files are the same for all


def turned(block: str) -> Recipe:
    return Recipe(block, interface=TURNED[block])


@pytest.fixture(
    scope="session",
    params=[(Flavour.PYTHON, block) for block in BLOCKS] + [(Flavour.NATIVE, block) for block in NATIVE],
    ids=lambda of: f"{of[0].value}-{of[1]}",
)
def pair(request: pytest.FixtureRequest, fmus: Fmus, shared: Shared) -> tuple[str, Path, Path]:
    """A block, its FMU, and the one with turned variables, of the same flavour."""
    flavour, block = request.param
    return block, fmus.built(flavour, block), turned_fmu(shared, flavour, block)


def turned_fmu(shared: Shared, flavour: Flavour, block: str) -> Path:
    recipe = turned(block)
    folder = shared.once(
        f"turned/{flavour.value}/{block}", lambda f: build_here(flavour, recipe, fmu_path(recipe, f, flavour))
    )
    return fmu_path(recipe, folder, flavour)


@pytest.fixture(params=list(Flavour))
def gearing(request: pytest.FixtureRequest, shared: Shared) -> Path:
    """The Gearing with turned variables, in each flavour."""
    return turned_fmu(shared, request.param, "Gearing")


def rows(fmu: Path, run: Run) -> list[dict[str, Any]]:
    """All variables, initially and after each step, floats as their bits."""
    found = []
    with FmuInstance(fmu) as host:
        host.initialize(run.start)
        for h, values in [(0.0, {}), *run.steps]:
            if h:
                host.step(h, values)
            found.append({n: x.hex() if isinstance(x, float) else int(x) for n, x in host.get().items()})
    return found


def test_a_turned_fmu_gives_the_bits_of_the_default_one(pair: tuple[str, Path, Path]) -> None:
    block, default, other = pair
    run = calm(block, H, 300)
    set_in_run = {name for _, values in run.steps for name in values}
    assert set_in_run & turned(block).turned.keys(), "nothing that is turned is set in the run"
    assert rows(other, run) == rows(default, run)


def test_the_validators_find_no_fault(pair: tuple[str, Path, Path]) -> None:
    fmu = str(pair[2])
    assert validate_fmu(fmu) == []
    tool = Path(sys.executable).with_name("fmutool")
    done = subprocess.run([tool, "-input", fmu, "-check"], capture_output=True, text=True, check=True)
    text = done.stdout + done.stderr
    assert "compliant with FMI-2.0" in text
    assert "No semantic error" in text
    assert "ERROR" not in text
    assert "WARNING" not in text


def test_the_recipe_is_read_back_from_the_fmu(pair: tuple[str, Path, Path]) -> None:
    block, default, other = pair
    found = recipe_of(other)
    assert dict(found.turned) == dict(turned(block).turned)
    assert found.guid() == turned(block).guid() == read_model_description(str(other)).guid
    assert dict(recipe_of(default).turned) == {}
    assert outdated(other, turned(block)) == ""
    assert outdated(other, Recipe(block)) == outdated(default, turned(block)) == "stale"


def test_a_start_value_of_an_enumeration_is_read_back_by_name(gearing: Path) -> None:
    assert recipe_of(gearing).starts["gear_in.start_mode"] == "WITH_CW_REFERENCE_POSITION"


def test_a_ratio_wired_by_a_time_series_acts_as_one_that_is_tuned(gearing: Path, fmus: Fmus) -> None:
    """The master goes 10 mm/s. From 0.1 s on the slave gears through (1, 0), 3 : 2; from 2 s on, -1 : 4. With the
    master at 20 it is at 1.5 * 19 = 28.5, with the master at 60 at 28.5 - 40 / 4 = 18.5."""
    times = np.arange(61) / 10.0
    late = times >= 2.0
    names = ("time", "master.position", "master.velocity", "start", "gearing.numerator", "gearing.denominator")
    columns = (times, 10.0 * times, np.full(61, 10.0), times > 0.05, np.where(late, -1, 3), np.where(late, 4, 2))
    kinds = (float, float, float, bool, int, int)
    signal = np.array(list(zip(*columns, strict=True)), dtype=list(zip(names, kinds, strict=True)))
    mode = {"gear_in.start_mode": int(StartMode.CW_CCW_DIRECT), "gear_in.transition": int(Transition.NONE)}
    wired = simulate_fmu(
        str(gearing), stop_time=6.0, output_interval=0.1, input=signal, start_values=mode, output=["slave.position"]
    )
    with FmuInstance(fmus.python("Gearing")) as host:
        host.initialize(mode | {"gearing.numerator": 3, "gearing.denominator": 2, "master.velocity": 10.0})
        tuned = [host.get(["slave.position"])["slave.position"]]
        for i, t in enumerate(times[:-1].tolist()):
            ratio = {"gearing.numerator": -1, "gearing.denominator": 4} if i == 20 else {}
            host.step(0.1, {"master.position": 10.0 * t, "start": i > 0, **ratio})
            tuned.append(host.get(["slave.position"])["slave.position"])
            if i == 19:
                assert tuned[-1] == pytest.approx(28.5, abs=1e-9)
    assert wired["slave.position"] == pytest.approx(tuned, abs=1e-9)
    assert tuned[-1] == pytest.approx(18.5, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "bad", "message"),
    [
        ("gear_in.time", 2e12, "gear_in.time = 2e+12 is not allowed: it must be -1e+12 to 1e+12"),
        ("gear_in.distance", 1e-10, "gear_in.distance = 1e-10 is not allowed: it must be 0, or 1e-09 to 1e+12"),
        ("gear_in.distance", -1.0, "gear_in.distance = -1 is not allowed: it must be 0, or 1e-09 to 1e+12"),
        ("gear_in.distance", math.nan, "gear_in.distance = nan is not allowed: it must be 0, or 1e-09 to 1e+12"),
        ("gear_in.offset", math.inf, "gear_in.offset = inf is not allowed: it must be -1e+12 to 1e+12"),
        ("set_master.value", math.nan, "set_master.value = nan is not allowed: it must be -1e+12 to 1e+12"),
        ("master.position", -3e12, "master.position = -3e+12 is not allowed: it must be -1e+12 to 1e+12"),
    ],
)
def test_a_step_judges_what_is_an_input_and_what_was_one(gearing: Path, name: str, bad: float, message: str) -> None:
    """A refused step changes nothing, and the next one with a good value goes on."""
    with FmuInstance(gearing) as host:
        host.initialize({"master.velocity": 10.0})
        host.step(0.1, {"start": True})
        before = host.get()
        host.set({name: bad})
        with pytest.raises(FmuError) as e:
            host.call(host.unit.doStep, host.time, 0.1)
        assert str(e.value) == message
        assert {n: x for n, x in host.get().items() if n != name} == {n: x for n, x in before.items() if n != name}
        host.step(0.1, {name: before[name]})


def test_an_unwired_ratio_is_told(gearing: Path, shared: Shared) -> None:
    with FmuInstance(gearing) as host, pytest.raises(FmuError) as e:
        host.initialize({"gearing.denominator": 0})
    assert str(e.value) == "gearing.denominator = 0 is not allowed: an unwired input gives 0"
    with FmuInstance(gearing) as host, pytest.raises(FmuError) as e:
        host.initialize({"gear_in.start_mode": 0})
    assert str(e.value).endswith("7 CONTINUE_SYNCHRONIZED; an unwired input gives 0")
    saw = turned_fmu(shared, Flavour.NATIVE if "native" in gearing.parts else Flavour.PYTHON, "FlyingSaw")
    with FmuInstance(saw) as host, pytest.raises(FmuError) as e:
        host.initialize({"gear_in_pos.ratio_denominator": 0})
    assert str(e.value) == (
        "gear_in_pos.ratio_denominator = 0 is not allowed: it must be >= 1; an unwired input gives 0"
    )


def test_a_fixed_parameter_stays_fixed_and_a_new_parameter_is_tunable(gearing: Path) -> None:
    with FmuInstance(gearing) as host:
        host.initialize()
        host.set({"activate": False, "gear_in.offset": 3.0})
        host.step(0.1)
        assert host.get(["activate", "gear_in.offset"]) == {"activate": False, "gear_in.offset": 3.0}
        with pytest.raises(FmuError, match=r"slave.period \(fixed parameter\) cannot be set now"):
            host.set({"slave.period": 5.0})


def test_a_scenario_runs_with_its_own_interface(fmus: Fmus, tmp_path: Path) -> None:
    """Its FMU lies beside the default one, and its results are the same."""
    source = ROOT / "scenarios" / "FlyingSaw" / "diagonal_saw"
    text = (source / "scenario.toml").read_text("utf-8")
    head, start, rest = text.partition("\n[start]")
    table = '\n[interface]\ninput = ["gear_in_pos.ratio_*", "axis.max_velocity"]\noutput = "characteristics.*"\n'
    file = tmp_path / "diagonal_saw" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(head + table + start + rest, "utf-8")
    scenario = load(file)
    assert set(scenario.recipe.turned.values()) == {"input", "output"}
    fmu = fmu_path(scenario.recipe, tmp_path, Flavour.PYTHON)
    assert fmu.name != "FlyingSaw.fmu"
    build(Flavour.PYTHON, scenario.recipe, fmu)
    own = simulate(scenario, fmu, scenario.step_size)
    expected = simulate(load(source / "scenario.toml"), fmus.python("FlyingSaw"), scenario.step_size)
    assert own.values.keys() == expected.values.keys()
    assert all(np.array_equal(own.values[name], expected.values[name]) for name in expected.values)
