"""The plan of a sweep: its runs' values, however they are cut into chunks, and its file."""

import pickle
import tracemalloc
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu import __version__
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.sweeps.samples import Method
from motionsync_fmu.sweeps.sweep_plan import MOST_RUNS, Factor, SweepPlan
from tests.support.blocks.drawn import drawn

SAW = load_example("FlyingSaw").file
CUTTER = load_example("CutToLength").file


def saw(*settings: str, **options: Any) -> SweepPlan:
    return SweepPlan.of(SAW, settings, **options)


@cache
def mixed() -> SweepPlan:
    return saw(
        "axis.max_acceleration=1000:5000:5",
        "master.velocity=200..300",
        "axis.max_deceleration=axis.max_acceleration",
        "length=2*gear_in_pos.slave_sync_position + master.velocity",
        "axis.max_jerk=2e4,3e4,5e4",
        "move_absolute.velocity=500..700",
        samples=7,
        seed=3,
    )


@cache
def sobol() -> SweepPlan:
    ranges = ("master.velocity=200..300", "move_absolute.velocity=500..700")
    return saw("axis.max_acceleration=1000,2000", *ranges, samples=50, method=Method.SOBOL)


def same(values: dict[str, Any], expected: dict[str, Any]) -> bool:
    return [*values] == [*expected] and all(np.array_equal(values[name], expected[name]) for name in expected)


def test_values_with_a_unit_are_in_the_units_of_the_scenario() -> None:
    plan = saw("master.velocity=12 m/min:1 m/s:5", "axis.max_acceleration=2 m/s2")
    assert plan.values(0, 5)["master.velocity"].tolist() == [200.0, 400.0, 600.0, 800.0, 1000.0]
    assert plan.values(0, 5)["axis.max_acceleration"].tolist() == 5 * [2000.0]


def test_the_runs_are_all_combinations_of_the_grids_with_every_sample() -> None:
    assert mixed().runs == 5 * 3 * 7
    values = mixed().values(0, 105)
    assert [*values] == [factor.name for factor in mixed().factors]
    assert values["axis.max_acceleration"].tolist() == np.repeat([1000.0, 2000, 3000, 4000, 5000], 21).tolist()
    assert values["axis.max_jerk"].tolist() == np.tile(np.repeat([2e4, 3e4, 5e4], 7), 5).tolist()
    assert values["axis.max_deceleration"].tolist() == values["axis.max_acceleration"].tolist()
    assert values["length"].tolist() == (200.0 + values["master.velocity"]).tolist()
    samples = values["master.velocity"].reshape(15, 7)
    assert (samples == samples[0]).all()
    assert len(set(samples[0])) == 7


@pytest.mark.parametrize("make_plan", [mixed, sobol])
@given(st.data())
@drawn(60, anew=True)
def test_the_values_do_not_depend_on_how_the_runs_are_cut(
    make_plan: Callable[[], SweepPlan], data: st.DataObject
) -> None:
    plan = make_plan()
    whole = plan.values(0, plan.runs)
    first = data.draw(st.integers(0, plan.runs))
    last = data.draw(st.integers(first, plan.runs))
    assert same(plan.values(first, last), {name: values[first:last] for name, values in whole.items()})


@given(st.integers(1, 200), st.integers(0, 2**40))
@drawn(25, anew=True)
def test_each_stratum_of_a_latin_hypercube_has_one_sample(samples: int, seed: int) -> None:
    plan = SweepPlan(SAW, SAW.read_text(), mixed().factors[1:2], samples, Method.LHS, seed)
    share = (plan.values(0, samples)["master.velocity"] - 200.0) / 100.0
    strata = np.floor(share * samples + 1e-9 * (share * samples % 1.0 > 1.0 - 1e-9))
    assert sorted(strata.tolist()) == list(range(samples))


def test_the_sobol_points_are_those_of_scipy_called_once() -> None:
    from scipy.stats import qmc  # noqa: PLC0415 (it takes long to load, in every process that collects tests)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        points = qmc.Sobol(2, rng=np.random.default_rng(11)).random(1000)
    plan = saw("master.velocity=0.5..1", "move_absolute.velocity=1..2", samples=1000, method=Method.SOBOL, seed=11)
    chunks = [plan.values(first, min(first + 37, 1000)) for first in range(0, 1000, 37)]
    result = np.array([np.concatenate([chunk[name] for chunk in chunks]) for name in chunks[0]]).T
    assert result.tolist() == (np.array([0.5, 1.0]) + points * np.array([0.5, 1.0])).tolist()


def test_the_seed_decides_the_samples() -> None:
    by_seed = [saw("master.velocity=200..300", samples=5, seed=seed).values(0, 5) for seed in (1, 1, 2)]
    assert same(by_seed[0], by_seed[1])
    assert not same(by_seed[0], by_seed[2])


def test_a_plan_of_a_thousand_million_runs_needs_no_memory() -> None:
    plan = saw("axis.max_acceleration=1000:5000:1000", "axis.max_jerk=1e4:9e4:1000", "length=400:800:1000")
    assert plan.runs == MOST_RUNS
    tracemalloc.start()
    last = plan.values(MOST_RUNS - 2, MOST_RUNS)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100_000
    assert last["length"].tolist() == pytest.approx([400.0 + 998 * 400.0 / 999, 800.0], rel=1e-15)
    assert last["axis.max_acceleration"].tolist() == [5000.0, 5000.0]
    assert plan.scenario(MOST_RUNS - 1).start["axis.max_jerk"] == 9e4


def test_columns_have_the_types_of_their_variables() -> None:
    plan = SweepPlan.of(
        CUTTER,
        ["order.quantity=1..3", "start_mode=TRIM,CONTINUE", "length=500,600", "set.1.start=true,false",
         "order.length=length"],
        samples=4,
    )  # fmt: skip
    values = plan.values(0, plan.runs)
    assert [values[name].dtype.kind for name in values] == ["i", "U", "f", "b", "f"]
    assert set(values["order.quantity"].tolist()) <= {1, 2, 3}
    scenario = plan.scenario(plan.runs - 1)
    assert (scenario.start["start_mode"], scenario.start["length"], scenario.start["order.length"]) == (3, 600.0, 600.0)
    assert scenario.settings[1].values == {"start": False}


def test_an_expression_may_use_what_does_not_vary_and_other_expressions() -> None:
    plan = saw(
        "axis.max_jerk=10*axis.max_deceleration",
        "axis.max_deceleration=axis.max_acceleration/2",
        "axis.max_acceleration=1000,2000",
        "cuts.offset=gear_in_pos.slave_sync_position + cuts.count",
        "master.velocity=cuts.length/2",
        "length=400,500",
    )
    values = plan.values(0, 4)
    assert values["axis.max_jerk"].tolist() == [5000.0, 5000.0, 10000.0, 10000.0]
    assert values["cuts.offset"].tolist() == [102.0] * 4
    assert values["master.velocity"].tolist() == [200.0, 250.0, 200.0, 250.0]


def test_a_value_that_the_reader_refuses_is_reported_with_its_run() -> None:
    plan = saw("axis.max_acceleration=-1000:1000:5")
    assert plan.scenario(3).start["axis.max_acceleration"] == 500.0
    with pytest.raises(
        UserError, match=r"^run 1: .*example\.toml:11: axis\.max_acceleration: .* = -500 is not allowed"
    ):
        plan.scenario(1)
    result = plan.scenarios(0, 5)
    assert [isinstance(scenario, UserError) for scenario in result] == [True, True, True, False, False]
    with pytest.raises(UserError, match="there are no runs 5 to 5: the sweep has those from 0 to 4"):
        plan.scenario(5)


@pytest.mark.parametrize(
    ("given", "options", "message"),
    [
        ([], {}, "a sweep varies something: give --set NAME=VALUES"),
        (["axis.max_acc=1"], {}, "axis.max_acc=1: no variable of FlyingSaw or number of the scenario is named"),
        (["axis.max_jerk=5:1:3"], {}, "axis.max_jerk=5:1:3: the range is reversed"),
        (["axis.max_jerk=1..1"], {"samples": 3}, "axis.max_jerk=1..1: the range is empty"),
        (["axis.max_jerk=abc"], {}, "axis.max_jerk=abc: 'abc' is no number, and no variable of FlyingSaw"),
        (["axis.max_jerk=1,abc"], {}, "axis.max_jerk=1,abc: 'abc' is no number"),
        (["axis.max_jerk=1:5:0"], {}, "axis.max_jerk=1:5:0: a count of 0 is not allowed"),
        (["axis.max_jerk=1e4:9e4:1000000001"], {}, "the sweep has 1,000,000,001 runs; more than 1,000,000,000 need"),
        (["axis.max_jerk=1e4..9e4"], {}, "axis.max_jerk has a range, which is sampled: say how often with --samples"),
        (["axis.max_jerk=1e4,9e4"], {"samples": 9}, "--samples 9: no factor has a range to be sampled"),
        (["axis.max_jerk=1e4..9e4"], {"samples": 0}, "--samples 0 is not allowed: it must be >= 1"),
        (["axis.max_jerk=1e4..9e4"], {"samples": 5, "seed": -1}, "--seed -1 is not allowed"),
        (["axis.max_jerk=1e4..9e4"], {"samples": 5, "seed": 2**53 + 1}, "--seed 9007199254740993 is not allowed"),
        (["axis.max_jerk=1e4..9e4"], {"samples": 10**8}, "a Latin hypercube of 100,000,000 samples does not fit"),
        (["axis.max_jerk=1e4"], {"chunk": -1}, "a chunk of -1 runs is not allowed"),
        (["axis.max_jerk=1e4", "axis.max_jerk=2e4"], {}, "axis.max_jerk is given twice, as axis.max_jerk=1e4"),
        (["length=400", "cuts.length=500"], {}, "cuts.length=500: cuts.length is length, too, as length=400"),
        (["axis.max_jerk=axis.max_jerk*2"], {}, "a value cannot follow from itself: axis.max_jerk from axis.max_jerk"),
        (["length=master.velocity", "master.velocity=2*cuts.length"], {}, "a value cannot follow from itself"),
        (["axis.max_jerk=2*nothing"], {}, "axis.max_jerk=2*nothing: no variable of FlyingSaw"),
        (["axis.max_jerk=master.acceleration"], {}, "master.acceleration has no value in the scenario"),
        (["axis.max_jerk=gear_in_pos.master_sync_position"], {}, "has several values in the scenario"),
        (["axis.max_jerk=-1,-2"], {}, "run 0: "),
        (["set.0.at=4.4:9:3"], {}, "at: 4.4 is not before stop_time = 4.4"),
    ],
)  # fmt: skip
def test_what_makes_no_sweep_is_reported_in_one_line(given: list[str], options: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError) as e:
        saw(*given, **options)
    assert message in str(e.value)
    assert "\n" not in str(e.value)


def test_more_than_a_thousand_million_runs_need_a_yes() -> None:
    assert saw("axis.max_jerk=1e4:9e4:1000000001", yes=True).runs == 1_000_000_001
    grids = [f"{name}=1000:2000:{10**7}" for name in ("axis.max_jerk", "axis.max_acceleration", "length")]
    with pytest.raises(UserError, match="the most that can be numbered"):
        saw(*grids, yes=True)


def test_a_scenario_that_cannot_be_read_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        SweepPlan.of(tmp_path / "missing.toml", ["length=1"])
    (tmp_path / "wrong.toml").write_text("fmu = 5")
    with pytest.raises(UserError, match=r"wrong\.toml:1: fmu: 5 is not a text"):
        SweepPlan.of(tmp_path / "wrong.toml", ["length=1"])


def test_a_written_plan_is_read_back(tmp_path: Path) -> None:
    measures = {"slave.velocity": ("max", "above:500"), "state": "last"}
    plan = saw("master.velocity=200..300", "length=400,\t500", samples=5, seed=2, chunk=64, measures=measures)
    plan.write(tmp_path)
    result = SweepPlan.read(tmp_path)
    assert (result.differs(plan), plan.differs(result)) == ("", "")
    assert result.measures == {"slave.velocity": ("max", "above:500"), "state": ("last",)}
    assert (result.file, result.chunk, result.version, result.guid) == (
        SAW,
        64,
        __version__,
        compute_guid(Recipe("FlyingSaw")),
    )
    assert same(result.values(0, 10), plan.values(0, 10))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan.toml", "swept_scenario.toml"]


def test_a_damaged_plan_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"plan\.toml: cannot be read"):
        SweepPlan.read(tmp_path)
    saw("length=400").write(tmp_path)
    text = (tmp_path / "plan.toml").read_text()
    for old, new, message in (
        ("seed = 0", "", r"plan\.toml:\d+: seed: is missing"),
        ("seed = 0", "seeds = 0", "seeds: unknown key"),
        ('"lhs"', '"lhr"', "no method is named 'lhr'"),
        ("samples = 0", "samples = 'a'", "samples: 'a' is not a number"),
        ("[set]", "[set", "not TOML"),
    ):
        (tmp_path / "plan.toml").write_text(text.replace(old, new))
        with pytest.raises(UserError, match=message):
            SweepPlan.read(tmp_path)
    (tmp_path / "plan.toml").write_text(text)
    (tmp_path / "swept_scenario.toml").write_text("fmu = 5")
    with pytest.raises(UserError, match=r"scenario\.toml beside the plan has changed"):
        SweepPlan.read(tmp_path)


def test_a_folder_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(UserError, match="the plan cannot be written"):
        saw("length=400").write(file)


def test_what_differs_is_reported_in_one_sentence() -> None:
    plan = saw("length=400,500", "master.velocity=200..300", samples=5)
    length, velocity = plan.factors
    jerk = Factor("axis.max_jerk", "1e4..2e4")
    for changes, error in (
        ({"chunk": 7}, ""),
        ({"file": CUTTER}, ""),
        ({"factors": (Factor("length", "400,600"), velocity)}, "length is 400,600, not 400,500"),
        ({"factors": (length,), "samples": 0}, "master.velocity does not vary; the number of samples is 0, not 5"),
        ({"factors": (length, velocity, jerk)}, "axis.max_jerk is 1e4..2e4, not none"),
        ({"factors": (velocity, length)}, "the order is master.velocity, length, not length, master.velocity"),
        ({"samples": 6, "seed": 1}, "the number of samples is 6, not 5; seed is 1, not 0"),
        ({"method": Method.SOBOL}, "method is sobol, not lhs"),
        ({"measures": {"state": ("last", "max")}}, "--measure is state=last,max, not none"),
        ({"text": plan.text + "\n"}, "the scenario's file is not the same"),
        ({"version": "0.0.9"}, f"motionsync is 0.0.9, not {__version__}"),
        ({"guid": "{1}"}, f"the FMU's GUID is {{1}}, not {plan.guid}"),
        ({"sampler": ""}, f"scipy is none, not {plan.sampler}"),
    ):
        other = replace(plan, **changes)
        assert other.differs(plan) == error
        assert bool(plan.differs(other)) == bool(error)


def test_a_plan_goes_to_another_process_without_what_it_has_computed(tmp_path: Path) -> None:
    plan = SweepPlan.of(SAW, ["length=400:500:11", "master.velocity=200..300"], samples=100)
    plan.values(0, 10)
    sent = pickle.dumps(plan)
    assert len(sent) < len(SAW.read_text()) + 1000
    result = pickle.loads(sent)
    assert same(result.values(90, 210), plan.values(90, 210))
    assert result == plan


def test_samples_of_another_scipy_are_refused() -> None:
    plan = SweepPlan(SAW, SAW.read_text(), mixed().factors[1:2], 3, sampler="1.0")
    with pytest.raises(UserError, match=r"the samples of this sweep are made by scipy 1\.0, and here is "):
        plan.values(0, 1)
