"""FMUs with causality overrides, both flavours: the results equal those without, and each range is checked."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu

from motionsync.blocks import BLOCKS
from motionsync.gearing.interface import StartMode, Transition
from motionsync_fmu.fmus.fmu import Flavour, build_python, fmu_path, why_outdated
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance, read_recipe
from motionsync_fmu.scenario.run.simulation import simulate
from tests import ROOT
from tests.support.blocks.by_block import load_test_module
from tests.support.blocks.random_runs import draw_accepted_run
from tests.support.blocks.runs import BlockRun
from tests.support.hosts.fmus import Fmus, Shared, build_for_host
from tests.support.hosts.importers import check_by_fmutool
from tests.support.hosts.validation import faults_by_fmpy

H = 2.0**-7  # s
NATIVE = ("Gearing", "FlyingSaw")  # building one takes long; the C files are the same for all


def recipe_with_overrides(block: str) -> Recipe:
    return Recipe(block, interface=load_test_module(block, "interface_facts").OVERRIDES)


@pytest.fixture(
    scope="session",
    params=[(Flavour.PYTHON, block) for block in BLOCKS] + [(Flavour.NATIVE, block) for block in NATIVE],
    ids=lambda pair: f"{pair[0].value}-{pair[1]}",
)
def pair(request: pytest.FixtureRequest, fmus: Fmus, shared: Shared) -> tuple[str, Path, Path]:
    """A block, its FMU, and the one with causality overrides, of the same flavour."""
    flavour, block = request.param
    return block, fmus.built(flavour, block), fmu_with_overrides(shared, flavour, block)


def fmu_with_overrides(shared: Shared, flavour: Flavour, block: str) -> Path:
    recipe = recipe_with_overrides(block)
    folder = shared.once(
        f"overrides/{flavour.value}/{block}", lambda f: build_for_host(flavour, recipe, fmu_path(recipe, f, flavour))
    )
    return fmu_path(recipe, folder, flavour)


@pytest.fixture(params=list(Flavour))
def gearing(request: pytest.FixtureRequest, shared: Shared) -> Path:
    """The Gearing with causality overrides, in each flavour."""
    return fmu_with_overrides(shared, request.param, "Gearing")


def rows(fmu: Path, run: BlockRun) -> list[dict[str, Any]]:
    """All variables, initially and after each step, floats as their bits."""
    result = []
    with FmuInstance(fmu) as host:
        host.initialize(run.start)
        for h, values in [(0.0, {}), *run.steps]:
            if h:
                host.step(h, values)
            result.append({n: x.hex() if isinstance(x, float) else int(x) for n, x in host.get().items()})
    return result


def test_an_fmu_with_overrides_gives_the_bits_of_the_default_one(pair: tuple[str, Path, Path]) -> None:
    block, default, other = pair
    run = draw_accepted_run(block, H, 300)
    set_in_run = {name for _, values in run.steps for name in values}
    assert set_in_run & recipe_with_overrides(block).causality_overrides.keys(), "the run sets no overridden variable"
    assert rows(other, run) == rows(default, run)


def test_the_validators_find_no_fault(pair: tuple[str, Path, Path], caplog: pytest.LogCaptureFixture) -> None:
    assert faults_by_fmpy(pair[2]) == []
    check_by_fmutool(pair[2], caplog)


def test_the_recipe_is_read_back_from_the_fmu(pair: tuple[str, Path, Path]) -> None:
    block, default, other = pair
    result = read_recipe(other)
    assert dict(result.causality_overrides) == dict(recipe_with_overrides(block).causality_overrides)
    assert compute_guid(result) == compute_guid(recipe_with_overrides(block)) == read_model_description(str(other)).guid
    assert dict(read_recipe(default).causality_overrides) == {}
    assert why_outdated(other, recipe_with_overrides(block)) == ""
    assert why_outdated(other, Recipe(block)) == why_outdated(default, recipe_with_overrides(block)) == "stale"


def test_a_start_value_of_an_enumeration_is_read_back_by_name(gearing: Path) -> None:
    assert read_recipe(gearing).starts["gear_in.start_mode"] == "WITH_CW_REFERENCE_POSITION"


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
    ("name", "invalid", "message"),
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
def test_a_step_checks_inputs_and_parameters_that_were_inputs(
    gearing: Path, name: str, invalid: float, message: str
) -> None:
    """A refused step changes nothing, and the next one with a valid value succeeds."""
    with FmuInstance(gearing) as host:
        host.initialize({"master.velocity": 10.0})
        host.step(0.1, {"start": True})
        before = host.get()
        host.set({name: invalid})
        with pytest.raises(FmuError) as e:
            host.call(host.unit.doStep, host.time, 0.1)
        assert str(e.value) == message
        assert {n: x for n, x in host.get().items() if n != name} == {n: x for n, x in before.items() if n != name}
        host.step(0.1, {name: before[name]})


def test_an_unwired_ratio_is_reported(gearing: Path, shared: Shared) -> None:
    with FmuInstance(gearing) as host, pytest.raises(FmuError) as e:
        host.initialize({"gearing.denominator": 0})
    assert str(e.value) == "gearing.denominator = 0 is not allowed: an unwired input gives 0"
    with FmuInstance(gearing) as host, pytest.raises(FmuError) as e:
        host.initialize({"gear_in.start_mode": 0})
    assert str(e.value).endswith("7 CONTINUE_SYNCHRONIZED; an unwired input gives 0")
    saw = fmu_with_overrides(shared, Flavour.NATIVE if "native" in gearing.parts else Flavour.PYTHON, "FlyingSaw")
    with FmuInstance(saw) as host, pytest.raises(FmuError) as e:
        host.initialize({"gear_in_pos.ratio_denominator": 0})
    assert str(e.value) == (
        "gear_in_pos.ratio_denominator = 0 is not allowed: it must be 1 to 2147483647; an unwired input gives 0"
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
    """Its FMU is in the same folder as the default one, and its results are the same."""
    source = ROOT / "scenarios" / "FlyingSaw" / "diagonal_saw"
    text = (source / "scenario.toml").read_text("utf-8")
    head, start, rest = text.partition("\n[start]")
    table = '\n[interface]\ninput = ["gear_in_pos.ratio_*", "axis.max_velocity"]\noutput = "characteristics.*"\n'
    file = tmp_path / "diagonal_saw" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(head + table + start + rest, "utf-8")
    scenario = load_scenario(file)
    assert set(scenario.recipe.causality_overrides.values()) == {"input", "output"}
    fmu = fmu_path(scenario.recipe, tmp_path, Flavour.PYTHON)
    assert fmu.name != "FlyingSaw.fmu"
    build_python(scenario.recipe, fmu)
    overridden = simulate(scenario, fmu, scenario.step_size)
    expected = simulate(load_scenario(source / "scenario.toml"), fmus.python("FlyingSaw"), scenario.step_size)
    assert overridden.values.keys() == expected.values.keys()
    assert all(np.array_equal(overridden.values[name], expected.values[name]) for name in expected.values)
