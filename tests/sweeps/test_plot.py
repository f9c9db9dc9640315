"""The figures of a sweep's page, compared with plain NumPy over all rows."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from motionsync_fmu.sweeps.conditions import RowCondition
from motionsync_fmu.sweeps.database import Database
from motionsync_fmu.sweeps.plot.cells import Axis, choose_statistic, divide_into_cells, plane
from motionsync_fmu.sweeps.plot.curves import boundary, curves
from motionsync_fmu.sweeps.plot.pareto_front import front
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.sweeps import example_plans

V, A, LENGTH, _ = example_plans.FACTORS
Rows = dict[str, NDArray[Any]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The finished sweep of 1080 runs."""
    made = tmp_path_factory.mktemp("sweep") / "small"
    example_plans.sweep(made, 12, 3, 15, 2)
    return made


@pytest.fixture(scope="module")
def rows(folder: Path) -> Rows:
    return example_plans.rows(SweepPlan.read(folder))


def opened(folder: Path) -> Database:
    return Database(folder, sorted(folder.glob("part-*.parquet")), example_plans.FACTORS)


def database(folder: Path, **columns: NDArray[Any]) -> Database:
    """A database of columns of its own; `v` is a factor."""
    count = len(next(iter(columns.values())))
    example_plans.write(folder, {"run": np.arange(count)} | columns, 100)
    return Database(folder, sorted(folder.glob("part-*.parquet")), ["v"])


def cells_of(axis: Axis, values: NDArray[Any]) -> NDArray[np.int64]:
    """The cell of each value by the edges alone."""
    return np.clip(np.searchsorted(axis.edges, values, "right") - 1, 0, len(axis) - 1)


@pytest.mark.parametrize(
    ("name", "asked", "together"),
    [
        ("passed", "", np.mean),
        ("cut_error", "", np.nanmean),
        ("cut_error", "min", np.nanmin),
        ("slave.acceleration.max", "max", np.nanmax),
        ("cut_error", "count", len),
    ],
)
def test_cells_have_the_figures_of_their_runs(
    folder: Path, rows: Rows, name: str, asked: str, together: Callable[[NDArray[Any]], float]
) -> None:
    """12 velocities, each a cell; 15 lengths in 8 cells of two."""
    db = opened(folder)
    x, y = divide_into_cells(db, db.columns[V], "x", 20), divide_into_cells(db, db.columns[LENGTH], "y", 8)
    assert (len(x), len(y), x.single, y.single) == (12, 8, True, False)
    result = plane(db, x, y, choose_statistic(db.columns[name], asked))
    cx, cy = cells_of(x, rows[V]), cells_of(y, rows[LENGTH])
    assert len(result["cx"]) == 12 * 8
    for i, (column, row) in enumerate(zip(result["cx"], result["cy"], strict=True)):
        inside = (cx == column) & (cy == row)
        values = rows[name][inside].astype(float)
        assert result["runs"][i] == np.count_nonzero(inside)
        if np.isfinite(values).any() or asked == "count":
            assert result["value"][i] == pytest.approx(together(values), rel=1e-12)
            assert inside[int(result["pick"][i])]


def test_the_run_of_a_cell_is_the_nearest_to_its_mean_and_the_first_of_these(tmp_path: Path) -> None:
    """Of 1, 2, 4, 5 in one cell the mean is 3: 2 and 4 are as near, and 2 comes first; NaN is never it."""
    db = database(
        tmp_path,
        v=np.zeros(6),
        w=np.zeros(6),
        e=np.array([1.0, np.nan, 2.0, 4.0, 5.0, np.nan]),
        passed=np.ones(6, bool),
    )
    x, y = divide_into_cells(db, db.columns["v"], "x", 5), divide_into_cells(db, db.columns["w"], "y", 5)
    result = plane(db, x, y, choose_statistic(db.columns["e"]))
    assert {name: values.tolist() for name, values in result.items()} == {
        "cx": [0], "cy": [0], "runs": [6], "value": [3.0], "least": [1.0], "greatest": [5.0], "pick": [2],
    }  # fmt: skip


def test_a_folder_s_name_is_no_pattern(tmp_path: Path) -> None:
    """As a pattern the first name would be that of the second folder."""
    first, second = (database(tmp_path / name, v=np.array([value])) for name, value in (("g[x]", 1.0), ("gx", 2.0)))
    assert [db.ask("SELECT v FROM runs")["v"].tolist() for db in (first, second)] == [[1.0], [2.0]]
    assert database(tmp_path / "a*b?'c", v=np.array([3.0])).ask("SELECT v FROM runs")["v"].tolist() == [3.0]


def test_a_run_that_did_not_pass_represents_its_cell(tmp_path: Path) -> None:
    passed = np.array([True, True, False, True, False])
    db = database(tmp_path, v=np.zeros(5), w=np.zeros(5), passed=passed)
    x, y = divide_into_cells(db, db.columns["v"], "x", 5), divide_into_cells(db, db.columns["w"], "y", 5)
    result = plane(db, x, y, choose_statistic(db.columns["passed"]))
    assert (result["value"].tolist(), result["pick"].tolist()) == ([0.6], [2])


def test_a_cell_shows_its_most_frequent_text(tmp_path: Path) -> None:
    """Runs without a text do not count, unless there are no others."""
    texts = np.array(["", "", "", "late", "late", "fault", "", ""])
    db = database(tmp_path, v=np.repeat([0.0, 1.0], [6, 2]), w=np.zeros(8), text=texts)
    x, y = divide_into_cells(db, db.columns["v"], "x", 5), divide_into_cells(db, db.columns["w"], "y", 5)
    result = plane(db, x, y, choose_statistic(db.columns["text"]))
    assert (result["value"].tolist(), result["pick"].tolist()) == (["late", None], [3, 6])


def test_a_fault_is_a_name_and_has_no_mean(tmp_path: Path) -> None:
    """Its number can be compared nevertheless."""
    faults = np.array([0, 0, 0, 17118, 17118, 17119, 0, 0])
    db = database(tmp_path, v=np.repeat([0.0, 1.0], [6, 2]), w=np.zeros(8), fault=faults, passed=np.zeros(8, bool))
    x, y = divide_into_cells(db, db.columns["v"], "x", 5), divide_into_cells(db, db.columns["w"], "y", 5)
    result = plane(db, x, y, choose_statistic(db.columns["fault"]))
    assert (result["value"].tolist(), result["pick"].tolist()) == (["17118", None], [3, 6])
    db.apply_condition(RowCondition.read("fault < 17119"))
    assert db.ask("SELECT passed FROM runs ORDER BY run")["passed"].tolist() == (faults < 17119).tolist()
    assert plane(db, x, y, choose_statistic(db.columns["fault"]))["value"].tolist() == ["17118", None]


def test_many_values_are_divided_evenly(tmp_path: Path) -> None:
    """20 000 different values: 50 cells of one width, with the runs that are between the edges."""
    values = np.random.default_rng(1).normal(size=20_000)
    db = database(tmp_path, v=values, w=np.zeros(20_000))
    x, y = divide_into_cells(db, db.columns["v"], "x", 50), divide_into_cells(db, db.columns["w"], "y", 5)
    result = plane(db, x, y, choose_statistic(None))
    assert np.ptp(np.diff(x.edges)) < 1e-12
    expected = np.histogram(values, x.edges)[0]
    counted = np.zeros(50, int)
    counted[result["cx"].astype(int)] = result["runs"]
    assert counted.tolist() == expected.tolist()


def test_uneven_values_meet_in_the_middle(tmp_path: Path) -> None:
    """1, 2, 5, 20: edges at 0.5, 1.5, 3.5, 12.5, 27.5."""
    db = database(tmp_path, v=np.array([5.0, 1.0, 20.0, 2.0, 1.0]))
    assert divide_into_cells(db, db.columns["v"], "x", 10).edges.tolist() == [0.5, 1.5, 3.5, 12.5, 27.5]


def test_curves_have_the_band_of_their_runs(folder: Path, rows: Rows) -> None:
    db = opened(folder)
    x, groups = divide_into_cells(db, db.columns[V], "x", 20), divide_into_cells(db, db.columns[A], "groups", 8)
    result = curves(db, x, db.columns["slave.velocity.max"], groups)
    values = rows["slave.velocity.max"]
    assert len(result["cx"]) == 12 * 3 - 1  # all runs of the slowest line with the quickest machine are refused
    for i, (cell, group) in enumerate(zip(result["cx"], result["group"], strict=True)):
        inside = (rows[V] == x.low[int(cell)]) & (rows[A] == groups.low[int(group)])
        assert result["runs"][i] == np.count_nonzero(inside)
        assert result["mean"][i] == pytest.approx(values[inside].mean(), rel=1e-14)
        assert (result["least"][i], result["greatest"][i]) == (values[inside].min(), values[inside].max())
        assert values[int(result["pick_least"][i])] == values[inside].min()
        assert values[int(result["pick_greatest"][i])] == values[inside].max()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_boundary_is_the_first_value_from_which_all_runs_pass(
    folder: Path, rows: Rows, tmp_path: Path, sign: float
) -> None:
    """By going through the lengths from the far end until a run did not pass; with the opposite sign it is below."""
    example_plans.write(tmp_path, rows | {LENGTH: sign * rows[LENGTH]}, 500)
    db = opened(tmp_path)
    x, groups = divide_into_cells(db, db.columns[V], "x", 20), divide_into_cells(db, db.columns[A], "groups", 8)
    result = boundary(db, x, db.columns[LENGTH], groups)
    assert result is not None
    assert result.above == (sign > 0)
    lengths = np.unique(rows[LENGTH])
    for i, (cell, group) in enumerate(zip(result.points["cx"], result.points["group"], strict=True)):
        inside = (rows[V] == x.low[int(cell)]) & (rows[A] == groups.low[int(group)])
        surely = partly = np.nan
        for length in lengths[::-1]:
            if not rows["passed"][inside & (rows[LENGTH] == length)].all():
                break
            surely = length
        for length in lengths[::-1]:
            if rows["passed"][inside & (rows[LENGTH] == length)].any():
                partly = length
        assert result.points["surely"][i] == pytest.approx(sign * surely, nan_ok=True)
        assert result.points["partly"][i] == pytest.approx(sign * partly, nan_ok=True)
        pick, failed = int(result.points["pick"][i]), int(result.points["failed"][i])
        assert (pick < 0) == np.isnan(surely)
        assert pick < 0 or (rows["passed"][pick] and rows[LENGTH][pick] == surely)
        assert failed < 0 or not rows["passed"][failed]


def test_there_is_no_boundary_if_all_runs_passed(tmp_path: Path) -> None:
    db = database(tmp_path, v=np.arange(9.0) // 3, w=np.arange(9.0) % 3, passed=np.ones(9, bool))
    assert boundary(db, divide_into_cells(db, db.columns["v"], "x", 9), db.columns["w"], None) is None


@pytest.mark.parametrize(("better_x", "better_y"), [("min", "min"), ("min", "max"), ("max", "min"), ("max", "max")])
def test_the_front_has_the_runs_that_no_other_beats(tmp_path: Path, better_x: str, better_y: str) -> None:
    """By comparing each run with each other one, among many equal values and some NaN; only runs that passed count."""
    random = np.random.default_rng(3)
    x, y = random.integers(0, 25, 400).astype(float), random.integers(0, 25, 400).astype(float)
    x[::50], y[::70] = np.nan, np.nan
    passed = random.random(400) < 0.3
    db = database(tmp_path, v=np.zeros(400), x=x, y=y, passed=passed)
    result = front(db, db.columns["x"], db.columns["y"], {"x": better_x, "y": better_y})
    u, w = x * (1 if better_x == "min" else -1), y * (1 if better_y == "min" else -1)
    counts = passed & np.isfinite(x) & np.isfinite(y)
    stored = {}
    for i in np.flatnonzero(counts):
        beaten = counts & (u <= u[i]) & (w <= w[i]) & ((u < u[i]) | (w < w[i]))
        if not beaten.any():
            stored.setdefault((x[i], y[i]), i)
    assert {(a, b): run for run, a, b in zip(*(result[k].tolist() for k in ("run", "x", "y")), strict=True)} == stored
    assert np.all(np.diff(u[result["run"]]) > 0.0)
