"""`motionsync sweep-plot`: its figures, compared with plain NumPy over all rows, and what it says to a mistake."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from markupsafe import escape
from numpy.typing import NDArray

from motionsync_fmu.scenario.reader import load
from motionsync_fmu.sweep.conditions import RowCondition
from motionsync_fmu.sweep.plan import Factor, SweepPlan
from motionsync_fmu.sweep.plot.cells import Axis, amount, divided, plane
from motionsync_fmu.sweep.plot.curves import boundary, curves
from motionsync_fmu.sweep.plot.database import Database
from motionsync_fmu.sweep.plot.front import front
from tests.support.command_line import Command, assert_one_line
from tests.sweep import made_up

V, A, LENGTH, TIME = FACTORS = ("master.velocity", "axis.max_acceleration", "length", "tool.cut_time")
Rows = dict[str, NDArray[Any]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The finished sweep of 1080 runs."""
    made = tmp_path_factory.mktemp("sweep") / "small"
    made_up.sweep(made, 12, 3, 15, 2)
    return made


@pytest.fixture(scope="module")
def rows(folder: Path) -> Rows:
    return made_up.rows(SweepPlan.read(folder))


def opened(folder: Path) -> Database:
    return Database(folder, sorted(folder.glob("part-*.parquet")), FACTORS)


def database(folder: Path, **columns: NDArray[Any]) -> Database:
    """A database of columns of its own; `v` is a factor."""
    count = len(next(iter(columns.values())))
    made_up.write(folder, {"run": np.arange(count)} | columns, 100)
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
    x, y = divided(db, db.columns[V], "x", 20), divided(db, db.columns[LENGTH], "y", 8)
    assert (len(x), len(y), x.single, y.single) == (12, 8, True, False)
    found = plane(db, x, y, amount(db.columns[name], asked))
    cx, cy = cells_of(x, rows[V]), cells_of(y, rows[LENGTH])
    assert len(found["cx"]) == 12 * 8
    for i, (column, row) in enumerate(zip(found["cx"], found["cy"], strict=True)):
        inside = (cx == column) & (cy == row)
        values = rows[name][inside].astype(float)
        assert found["runs"][i] == np.count_nonzero(inside)
        if np.isfinite(values).any() or asked == "count":
            assert found["value"][i] == pytest.approx(together(values), rel=1e-12)
            assert inside[int(found["pick"][i])]


def test_the_run_of_a_cell_is_the_nearest_to_its_mean_and_the_first_of_these(tmp_path: Path) -> None:
    """Of 1, 2, 4, 5 in one cell the mean is 3: 2 and 4 are as near, and 2 comes first; NaN is never it."""
    db = database(
        tmp_path,
        v=np.zeros(6),
        w=np.zeros(6),
        e=np.array([1.0, np.nan, 2.0, 4.0, 5.0, np.nan]),
        passed=np.ones(6, bool),
    )
    x, y = divided(db, db.columns["v"], "x", 5), divided(db, db.columns["w"], "y", 5)
    found = plane(db, x, y, amount(db.columns["e"]))
    assert {name: values.tolist() for name, values in found.items()} == {
        "cx": [0], "cy": [0], "runs": [6], "value": [3.0], "least": [1.0], "greatest": [5.0], "pick": [2],
    }  # fmt: skip


def test_a_run_that_did_not_pass_stands_for_its_cell(tmp_path: Path) -> None:
    passed = np.array([True, True, False, True, False])
    db = database(tmp_path, v=np.zeros(5), w=np.zeros(5), passed=passed)
    x, y = divided(db, db.columns["v"], "x", 5), divided(db, db.columns["w"], "y", 5)
    found = plane(db, x, y, amount(db.columns["passed"]))
    assert (found["value"].tolist(), found["pick"].tolist()) == ([0.6], [2])


def test_a_cell_tells_its_most_frequent_text(tmp_path: Path) -> None:
    """Runs without a text do not count, unless there are no others."""
    texts = np.array(["", "", "", "late", "late", "fault", "", ""])
    db = database(tmp_path, v=np.repeat([0.0, 1.0], [6, 2]), w=np.zeros(8), text=texts)
    x, y = divided(db, db.columns["v"], "x", 5), divided(db, db.columns["w"], "y", 5)
    found = plane(db, x, y, amount(db.columns["text"]))
    assert (found["value"].tolist(), found["pick"].tolist()) == (["late", None], [3, 6])


def test_a_fault_is_a_name_and_has_no_mean(tmp_path: Path) -> None:
    """Its number can be compared nevertheless."""
    faults = np.array([0, 0, 0, 17118, 17118, 17119, 0, 0])
    db = database(tmp_path, v=np.repeat([0.0, 1.0], [6, 2]), w=np.zeros(8), fault=faults, passed=np.zeros(8, bool))
    x, y = divided(db, db.columns["v"], "x", 5), divided(db, db.columns["w"], "y", 5)
    found = plane(db, x, y, amount(db.columns["fault"]))
    assert (found["value"].tolist(), found["pick"].tolist()) == (["17118", None], [3, 6])
    db.judge(RowCondition.read("fault < 17119"))
    assert db.ask("SELECT passed FROM runs ORDER BY run")["passed"].tolist() == (faults < 17119).tolist()
    assert plane(db, x, y, amount(db.columns["fault"]))["value"].tolist() == ["17118", None]


def test_many_values_are_divided_evenly(tmp_path: Path) -> None:
    """20 000 different values: 50 cells of one width, with the runs that lie between the edges."""
    values = np.random.default_rng(1).normal(size=20_000)
    db = database(tmp_path, v=values, w=np.zeros(20_000))
    x, y = divided(db, db.columns["v"], "x", 50), divided(db, db.columns["w"], "y", 5)
    found = plane(db, x, y, amount(None))
    assert np.ptp(np.diff(x.edges)) < 1e-12
    expected = np.histogram(values, x.edges)[0]
    counted = np.zeros(50, int)
    counted[found["cx"].astype(int)] = found["runs"]
    assert counted.tolist() == expected.tolist()


def test_uneven_values_meet_in_the_middle(tmp_path: Path) -> None:
    """1, 2, 5, 20: edges at 0.5, 1.5, 3.5, 12.5, 27.5."""
    db = database(tmp_path, v=np.array([5.0, 1.0, 20.0, 2.0, 1.0]))
    assert divided(db, db.columns["v"], "x", 10).edges.tolist() == [0.5, 1.5, 3.5, 12.5, 27.5]


def test_curves_have_the_band_of_their_runs(folder: Path, rows: Rows) -> None:
    db = opened(folder)
    x, groups = divided(db, db.columns[V], "x", 20), divided(db, db.columns[A], "groups", 8)
    found = curves(db, x, db.columns["slave.velocity.max"], groups)
    values = rows["slave.velocity.max"]
    assert len(found["cx"]) == 12 * 3 - 1  # all runs of the slowest line with the quickest machine are refused
    for i, (cell, group) in enumerate(zip(found["cx"], found["group"], strict=True)):
        inside = (rows[V] == x.low[int(cell)]) & (rows[A] == groups.low[int(group)])
        assert found["runs"][i] == np.count_nonzero(inside)
        assert found["mean"][i] == pytest.approx(values[inside].mean(), rel=1e-14)
        assert (found["least"][i], found["greatest"][i]) == (values[inside].min(), values[inside].max())
        assert values[int(found["pick_least"][i])] == values[inside].min()
        assert values[int(found["pick_greatest"][i])] == values[inside].max()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_boundary_is_the_first_value_from_which_all_runs_pass(
    folder: Path, rows: Rows, tmp_path: Path, sign: float
) -> None:
    """By going through the lengths from the far end until a run did not pass; with the opposite sign it is below."""
    made_up.write(tmp_path, rows | {LENGTH: sign * rows[LENGTH]}, 500)
    db = opened(tmp_path)
    x, groups = divided(db, db.columns[V], "x", 20), divided(db, db.columns[A], "groups", 8)
    found = boundary(db, x, db.columns[LENGTH], groups)
    assert found is not None
    assert found.above == (sign > 0)
    lengths = np.unique(rows[LENGTH])
    for i, (cell, group) in enumerate(zip(found.points["cx"], found.points["group"], strict=True)):
        inside = (rows[V] == x.low[int(cell)]) & (rows[A] == groups.low[int(group)])
        surely = partly = np.nan
        for length in lengths[::-1]:
            if not rows["passed"][inside & (rows[LENGTH] == length)].all():
                break
            surely = length
        for length in lengths[::-1]:
            if rows["passed"][inside & (rows[LENGTH] == length)].any():
                partly = length
        assert found.points["surely"][i] == pytest.approx(sign * surely, nan_ok=True)
        assert found.points["partly"][i] == pytest.approx(sign * partly, nan_ok=True)
        pick, failed = int(found.points["pick"][i]), int(found.points["failed"][i])
        assert (pick < 0) == np.isnan(surely)
        assert pick < 0 or (rows["passed"][pick] and rows[LENGTH][pick] == surely)
        assert failed < 0 or not rows["passed"][failed]


def test_there_is_no_boundary_if_all_runs_passed(tmp_path: Path) -> None:
    db = database(tmp_path, v=np.arange(9.0) // 3, w=np.arange(9.0) % 3, passed=np.ones(9, bool))
    assert boundary(db, divided(db, db.columns["v"], "x", 9), db.columns["w"], None) is None


@pytest.mark.parametrize(("better_x", "better_y"), [("min", "min"), ("min", "max"), ("max", "min"), ("max", "max")])
def test_the_front_has_the_runs_that_no_other_beats(tmp_path: Path, better_x: str, better_y: str) -> None:
    """By comparing each run with each other one, among many equal values and some NaN; only runs that passed count."""
    random = np.random.default_rng(3)
    x, y = random.integers(0, 25, 400).astype(float), random.integers(0, 25, 400).astype(float)
    x[::50], y[::70] = np.nan, np.nan
    passed = random.random(400) < 0.3
    db = database(tmp_path, v=np.zeros(400), x=x, y=y, passed=passed)
    found = front(db, db.columns["x"], db.columns["y"], {"x": better_x, "y": better_y})
    u, w = x * (1 if better_x == "min" else -1), y * (1 if better_y == "min" else -1)
    counts = passed & np.isfinite(x) & np.isfinite(y)
    kept = {}
    for i in np.flatnonzero(counts):
        beaten = counts & (u <= u[i]) & (w <= w[i]) & ((u < u[i]) | (w < w[i]))
        if not beaten.any():
            kept.setdefault((x[i], y[i]), i)
    assert {(a, b): run for run, a, b in zip(*(found[k].tolist() for k in ("run", "x", "y")), strict=True)} == kept
    assert np.all(np.diff(u[found["run"]]) > 0.0)


# The page, and what the command says to a mistake.


@pytest.fixture
def plotted(folder: Path, motionsync: Command) -> Callable[..., str]:
    """The text of a page of the small sweep."""

    def page(*options: str, status: int = 0) -> str:
        done = motionsync("sweep-plot", folder, "--output", "page.html", *options)
        assert (done.status, done.err) == (status, "")
        assert done.out == f"page: {Path('page.html').resolve().as_uri()}\n"
        return Path("page.html").read_text("utf-8")

    return page


def charts(page: str) -> dict[str, Any]:
    """The charts of a page by their titles, as plotly.js takes them; they fit its schema."""
    found = re.findall(
        r'aria-label="([^"]*)" style.*\n<script type="application/json" class="plot-data">(.*)</script>', page
    )
    made = {name: json.loads(text) for name, text in found}
    for chart in made.values():
        go.Figure(json.loads(re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart))))
    return made


def data(page: str) -> Any:
    """What the page's script is given."""
    return json.loads(re.findall(r'<script type="application/json" id="sweep">(.*)</script>', page)[0])


def test_a_page_answers_how_short_a_piece_can_be(plotted: Callable[..., str], rows: Rows) -> None:
    """For each acceleration a line with the least length that passes with both times of a cut. At 100 mm/s v (t + 2.2
    v/a) + 50 is 101 mm with 2000 mm/s2, 93.7 mm with 6000 mm/s2; the lengths begin with 100 and 307.142857."""
    page = plotted("--x", V, "--y", LENGTH, "--colour", A, "--beside", "limits.min_length.last")
    title = f"The least {LENGTH} that passes, over {V}, for each {A}"
    lines = {t["name"]: t for t in charts(page)[title]["data"] if "customdata" in t}
    assert list(lines) == ["2000 mm/s²", "6000 mm/s²", "10000 mm/s²"]
    assert (lines["2000 mm/s²"]["y"][0], lines["6000 mm/s²"]["y"][0]) == (307.1429, 100)
    assert lines["10000 mm/s²"]["y"][0] is None  # refused
    assert f"The share of the runs that passed, over {V} and {LENGTH}" in charts(page)
    assert "1080 runs" in page.replace("1\N{NARROW NO-BREAK SPACE}080", "1080")


def test_a_page_tells_what_it_leaves_out(plotted: Callable[..., str], rows: Rows) -> None:
    """Of 12 x 3 x 15 x 2 runs those with 10000 mm/s2 at 100 mm/s are refused: 30."""
    page = plotted("--x", V, "--y", "cut_error")
    assert "<li>30 runs were refused; a refused run counts as one that did not pass.</li>" in page
    assert "<li>30 runs without a value of cut_error: no curve and no mean has them.</li>" in page


def test_an_unfinished_sweep_is_shown_as_far_as_it_is_done(folder: Path, tmp_path: Path, motionsync: Command) -> None:
    made = tmp_path / "half"
    shutil.copytree(folder, made)
    (made / "part-000001.parquet").unlink()
    assert motionsync("sweep-plot", made, "--x", V, "--y", LENGTH).status == 0
    assert (
        "The sweep is not finished: 500 runs of 1\N{NARROW NO-BREAK SPACE}080 runs" in (made / "plot.html").read_text()
    )


@pytest.mark.parametrize(
    ("options", "titles"),
    [
        ((V, LENGTH), (f"The least {LENGTH} that passes", "The share of the runs that passed")),
        ((V, LENGTH, "--colour", "cut_error"), ("The least", f"cut_error over {V}, for each {LENGTH}", "The mean of")),
        ((V, LENGTH, "--colour", "first_broken"), ("The least", "The most frequent first_broken")),
        ((V, "cut_error", "--amount", "max", "--colour", "cut_error"), ("cut_error over", "The greatest of cut_error")),
        ((V, "passed", "--colour", A), (f"passed over {V}, for each {A}",)),
        (("slave.velocity.max", "slave.acceleration.max"), ("The share of the runs that passed",)),
        (("cut_error", "slave.velocity.max", "--amount", "count"), ("How many runs there are",)),
    ],
)
def test_columns_decide_what_a_page_shows(
    plotted: Callable[..., str], options: tuple[str, ...], titles: tuple[str, ...]
) -> None:
    x, y, *more = options
    found = list(charts(plotted("--x", x, "--y", y, *more)))
    assert len(found) == len(titles)
    assert all(name.startswith(begin) for name, begin in zip(found, titles, strict=True)), found


def test_a_page_has_the_front_of_two_results(plotted: Callable[..., str], rows: Rows) -> None:
    page = plotted("--x", "slave.velocity.max", "--y", "slave.acceleration.max", "--better", "x=max")
    (chart,) = charts(page).values()
    drawn = next(trace for trace in chart["data"] if trace["name"] == "Pareto front")
    best = np.nanmax(np.where(rows["passed"], rows["slave.velocity.max"], np.nan))
    assert drawn["x"][0] == best
    assert f'<button type="button" data-pick="{drawn["customdata"][0]}">' in page


@pytest.mark.parametrize(("count", "factors"), [(1_000_000, 4), (60_000, 40)])
def test_a_page_of_a_million_runs_is_small(tmp_path: Path, motionsync: Command, count: int, factors: int) -> None:
    """Factors that are different in each run, and texts of a thousand kinds; below 3 MB are allowed."""
    variables = load(made_up.EXAMPLE).recipe.variables
    others = [v.name for v in variables.values() if v.kind == "Real" and v.variability in ("fixed", "tunable")]
    names = list(dict.fromkeys([V, LENGTH, *others]))[:factors]
    assert len(names) == factors
    text = made_up.EXAMPLE.read_text("utf-8")
    SweepPlan(made_up.EXAMPLE, text, tuple(Factor(name, "500") for name in names)).write(tmp_path)
    run = np.arange(count)
    some = np.random.default_rng(5).random(count)
    texts = np.array([f"cuts within {i} mm of a mark, one mark each {i} mm, and more words" for i in range(1000)])
    columns = {"run": run} | {name: np.roll(some, i * 1000) for i, name in enumerate(names)}
    columns |= {"passed": np.roll(some, 7) < columns[LENGTH], "cut_error": np.roll(some, 9)}
    which = pa.array((run % 1000).astype(np.int32))
    table = pa.table(columns | {"first_broken": pa.DictionaryArray.from_arrays(which, texts).cast(pa.string())})
    pq.write_table(table, tmp_path / "part-000000.parquet")
    done = motionsync("sweep-plot", tmp_path, "--x", V, "--y", LENGTH, "--colour", "cut_error", "--better", "x=min")
    assert (done.status, done.err) == (0, "")
    assert 1_500_000 < (tmp_path / "plot.html").stat().st_size < 3_000_000
    assert len(charts((tmp_path / "plot.html").read_text("utf-8"))) == 3


def test_the_values_of_a_command_have_all_their_bits(plotted: Callable[..., str], folder: Path) -> None:
    """The page's numbers, as JavaScript reads them, are those of the plan for the same run."""
    runs = data(plotted("--x", V, "--y", LENGTH))["runs"]
    numbers = [int(n) for n in made_up.unpacked(runs["numbers"])]
    values = SweepPlan.read(folder).values(0, 1080)
    for column in runs["columns"]:
        if column["varied"]:
            assert made_up.unpacked(column["values"]) == values[column["name"]][numbers].tolist()


def test_a_wrong_name_gets_the_nearest_ones(folder: Path, motionsync: Command) -> None:
    assert_one_line(motionsync("sweep-plot", folder, "--x", "master.velocty", "--y", LENGTH), "'master.velocty'", V)
    assert_one_line(motionsync("sweep-plot", folder, "--x", V, "--y", "cut_eror"), "--y", "'cut_eror'", "cut_error")
    assert_one_line(
        motionsync("sweep-plot", folder, "--x", V, "--y", LENGTH, "--colour", "pased"), "--colour", "passed"
    )


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        ((V, V), ("--x and --y are both", V)),
        ((V, "first_broken"), ("--y first_broken", "texts", "numbers")),
        (("passed", LENGTH), ("--x passed", "true or false")),
        ((V, "refused_at"), ("refused_at",)),
        ((V, LENGTH, "--colour", "passed", "--amount", "max"), ("passed", "max")),
        ((V, LENGTH, "--better", "z=min"), ("--better z=min", "x=min,y=max")),
        ((V, LENGTH, "--beside", "refusal"), ("--beside refusal", "texts")),
    ],
)
def test_what_cannot_be_shown_is_told(
    folder: Path, motionsync: Command, options: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    x, y, *more = options
    done = motionsync("sweep-plot", folder, "--x", x, "--y", y, "--output", "page.html", *more)
    if y == "refused_at":  # 30 runs have a value, all of them 0: one cell is as good as any
        assert done.status == 0
    else:
        assert_one_line(done, *parts)


def test_a_folder_without_a_sweep_is_told(folder: Path, tmp_path: Path, motionsync: Command) -> None:
    asked = ("--x", V, "--y", LENGTH)
    assert_one_line(motionsync("sweep-plot", "nowhere", *asked), "nowhere", "no such folder")
    (tmp_path / "empty").mkdir()
    assert_one_line(motionsync("sweep-plot", "empty", *asked), "plan.toml")
    shutil.copytree(folder, tmp_path / "begun", ignore=shutil.ignore_patterns("part-*"))
    assert_one_line(motionsync("sweep-plot", "begun", *asked), "begun", "no finished run yet")


@pytest.mark.parametrize("number", [0, 2])
@pytest.mark.parametrize("damage", ["cut", "empty", "other"])
def test_a_damaged_part_is_named(folder: Path, tmp_path: Path, motionsync: Command, number: int, damage: str) -> None:
    shutil.copytree(folder, tmp_path / "sweep")
    part = tmp_path / "sweep" / f"part-{number:06}.parquet"
    if damage == "other":
        pq.write_table(pa.table({"run": np.arange(3)}), part)
    else:
        part.write_bytes(part.read_bytes()[: part.stat().st_size // 2] if damage == "cut" else b"")
    done = motionsync("sweep-plot", "sweep", "--x", V, "--y", LENGTH)
    assert_one_line(done, part.name, "other columns" if damage == "other" else "damaged")
    assert not (tmp_path / "sweep" / "plot.html").exists()


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("cut_error < 1e-9", lambda rows: rows["cut_error"] < 1e-9),
        ("cut_error > 100", lambda rows: rows["cut_error"] > 100.0),
        ("not passed", lambda rows: ~rows["passed"]),
        ("passed and length != 3000", lambda rows: rows["passed"] & (rows[LENGTH] != 3000.0)),
        ('refusal == ""', lambda rows: rows["refusal"] == ""),
    ],
)
def test_a_condition_takes_the_place_of_the_expectations(
    plotted: Callable[..., str], rows: Rows, condition: str, holds: Callable[[Rows], NDArray[Any]]
) -> None:
    """NaN, of refused runs, is neither less nor greater."""
    page = plotted("--x", V, "--y", LENGTH, "--passed", condition).replace("\N{NARROW NO-BREAK SPACE}", "")
    assert f"<small>{np.count_nonzero(holds(rows))} runs</small>" in page
    assert f"A run passes if {escape(condition)}." in page


def test_a_condition_that_is_none_is_told(folder: Path, motionsync: Command) -> None:
    asked = ("--x", V, "--y", LENGTH, "--passed")
    assert_one_line(motionsync("sweep-plot", folder, *asked, "lte == 0"), "'lte'")
    assert_one_line(motionsync("sweep-plot", folder, *asked, "cut_error == fast"), "'fast'")


@pytest.mark.parametrize(
    ("condition", "said"), [("cut_error < 1e6", "Every run passed"), ("cut_error < 0", "No run passed")]
)
def test_a_sweep_without_a_boundary_says_so(motionsync: Command, tmp_path: Path, condition: str, said: str) -> None:
    """One run, and the figures of one run: a cell each."""
    plan = SweepPlan.of(made_up.EXAMPLE, [f"{V}=500", f"{A}=3000", f"{LENGTH}=1000", f"{TIME}=0.1"])
    plan.write(tmp_path)
    made_up.write(tmp_path, made_up.rows(plan), 1)
    done = motionsync("sweep-plot", tmp_path, "--x", V, "--y", LENGTH, "--passed", condition)
    assert (done.status, done.err) == (0, "")
    page = (tmp_path / "plot.html").read_text("utf-8")
    assert re.search(rf"<li>{said}.*: there is no boundary", page)
    assert list(charts(page)) == [f"The share of the runs that passed, over {V} and {LENGTH}"]


def test_a_result_without_any_value_is_told(folder: Path, rows: Rows, motionsync: Command, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "sweep", ignore=shutil.ignore_patterns("part-*"))
    made_up.write(tmp_path / "sweep", rows | {"cut_error": np.full(1080, np.nan)}, 500)
    assert_one_line(motionsync("sweep-plot", "sweep", "--x", V, "--y", "cut_error"), "cut_error", "no value in any run")


def test_a_changed_scenario_is_repeated_from_the_copy(tmp_path: Path, motionsync: Command) -> None:
    """The command names the file as long as it is what the sweep ran."""
    mine = tmp_path / "mine" / "scenario.toml"
    mine.parent.mkdir()
    mine.write_text(made_up.EXAMPLE.read_text("utf-8"), "utf-8")
    plan = SweepPlan.of(mine, made_up.settings(2, 2, 3, 2))
    (tmp_path / "sweep").mkdir()
    plan.write(tmp_path / "sweep")
    made_up.write(tmp_path / "sweep", made_up.rows(plan), 500)
    for file in (mine.parent, tmp_path / "sweep" / "scenario.toml"):
        assert motionsync("sweep-plot", "sweep", "--x", V, "--y", LENGTH).status == 0
        page = (tmp_path / "sweep" / "plot.html").read_text("utf-8")
        assert data(page)["command"] == f"motionsync run {file}"
        mine.write_text("", "utf-8")
