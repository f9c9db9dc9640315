"""`motionsync sweep-plot`: the page of a sweep, and its messages about mistakes."""

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

from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.sweeps.plot.units import units
from motionsync_fmu.sweeps.sweep_plan import Factor, SweepPlan
from tests.support.project.command_line import Command, assert_one_line
from tests.sweeps import example_plans

V, A, LENGTH, TIME = example_plans.FACTORS
Rows = dict[str, NDArray[Any]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The finished sweep of 1080 runs."""
    sweep = tmp_path_factory.mktemp("sweep") / "small"
    example_plans.sweep(sweep, 12, 3, 15, 2)
    return sweep


@pytest.fixture(scope="module")
def rows(folder: Path) -> Rows:
    return example_plans.rows(SweepPlan.read(folder))


@pytest.fixture
def plotted(folder: Path, motionsync: Command) -> Callable[..., str]:
    """The text of a page of the small sweep."""

    def page(*options: str, status: int = 0) -> str:
        outcome = motionsync("sweep-plot", folder, "--output", "page.html", *options)
        assert (outcome.status, outcome.err) == (status, "")
        assert outcome.out == f"page: {Path('page.html').resolve().as_uri()}\n"
        return Path("page.html").read_text("utf-8")

    return page


def charts(page: str) -> dict[str, Any]:
    """The charts of a page by their titles, as plotly.js takes them; they fit its schema."""
    result = re.findall(
        r'aria-label="([^"]*)" style.*\n<script type="application/json" class="plot-data">(.*)</script>', page
    )
    charts_by_title = {name: json.loads(text) for name, text in result}
    for chart in charts_by_title.values():
        go.Figure(json.loads(re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart))))
    return charts_by_title


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


def test_a_page_shows_what_it_leaves_out(plotted: Callable[..., str], rows: Rows) -> None:
    """Of 12 x 3 x 15 x 2 runs those with 10000 mm/s2 at 100 mm/s are refused: 30."""
    page = plotted("--x", V, "--y", "cut_error")
    assert "<li>30 runs were refused; a refused run counts as one that did not pass.</li>" in page
    assert "<li>30 runs without a value of cut_error: no curve and no mean has them.</li>" in page


def test_an_unfinished_sweep_is_shown_as_far_as_it_is_done(folder: Path, tmp_path: Path, motionsync: Command) -> None:
    half = tmp_path / "half"
    shutil.copytree(folder, half)
    (half / "part-000001.parquet").unlink()
    assert motionsync("sweep-plot", half, "--x", V, "--y", LENGTH).status == 0
    assert (
        "The sweep is not finished: 500 runs of 1\N{NARROW NO-BREAK SPACE}080 runs" in (half / "plot.html").read_text()
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
    result = list(charts(plotted("--x", x, "--y", y, *more)))
    assert len(result) == len(titles)
    assert all(name.startswith(begin) for name, begin in zip(result, titles, strict=True)), result


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
    variables = load_scenario(example_plans.EXAMPLE).recipe.variables
    others = [v.name for v in variables.values() if v.kind == "Real" and v.variability in ("fixed", "tunable")]
    names = list(dict.fromkeys([V, LENGTH, *others]))[:factors]
    assert len(names) == factors
    text = example_plans.EXAMPLE.read_text("utf-8")
    SweepPlan(example_plans.EXAMPLE, text, tuple(Factor(name, "500") for name in names)).write(tmp_path)
    run = np.arange(count)
    shares = np.random.default_rng(5).random(count)
    texts = np.array([f"cuts within {i} mm of a mark, one mark each {i} mm, and more words" for i in range(1000)])
    columns = {"run": run} | {name: np.roll(shares, i * 1000) for i, name in enumerate(names)}
    columns |= {"passed": np.roll(shares, 7) < columns[LENGTH], "cut_error": np.roll(shares, 9)}
    which = pa.array((run % 1000).astype(np.int32))
    table = pa.table(columns | {"first_broken": pa.DictionaryArray.from_arrays(which, texts).cast(pa.string())})
    pq.write_table(table, tmp_path / "part-000000.parquet")
    outcome = motionsync("sweep-plot", tmp_path, "--x", V, "--y", LENGTH, "--colour", "cut_error", "--better", "x=min")
    assert (outcome.status, outcome.err) == (0, "")
    assert 1_500_000 < (tmp_path / "plot.html").stat().st_size < 3_000_000
    assert len(charts((tmp_path / "plot.html").read_text("utf-8"))) == 3


def test_the_values_of_a_command_have_all_their_bits(plotted: Callable[..., str], folder: Path) -> None:
    """The page's numbers, as JavaScript reads them, are those of the plan for the same run."""
    runs = data(plotted("--x", V, "--y", LENGTH))["runs"]
    numbers = [int(n) for n in example_plans.unpacked(runs["numbers"])]
    values = SweepPlan.read(folder).values(0, 1080)
    for column in runs["columns"]:
        if column["varied"]:
            assert example_plans.unpacked(column["values"]) == values[column["name"]][numbers].tolist()


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
def test_what_cannot_be_shown_is_reported(
    folder: Path, motionsync: Command, options: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    x, y, *more = options
    outcome = motionsync("sweep-plot", folder, "--x", x, "--y", y, "--output", "page.html", *more)
    if y == "refused_at":  # 30 runs have a value, all of them 0: one cell is as good as any
        assert outcome.status == 0
    else:
        assert_one_line(outcome, *parts)


def test_a_folder_without_a_sweep_is_reported(folder: Path, tmp_path: Path, motionsync: Command) -> None:
    options = ("--x", V, "--y", LENGTH)
    assert_one_line(motionsync("sweep-plot", "nowhere", *options), "nowhere", "no such folder")
    (tmp_path / "empty").mkdir()
    assert_one_line(motionsync("sweep-plot", "empty", *options), "plan.toml")
    shutil.copytree(folder, tmp_path / "unfinished", ignore=shutil.ignore_patterns("part-*"))
    assert_one_line(motionsync("sweep-plot", "unfinished", *options), "unfinished", "no finished run yet")


@pytest.mark.parametrize("number", [0, 2])
@pytest.mark.parametrize("damage", ["cut", "empty", "other"])
def test_a_damaged_part_is_named(folder: Path, tmp_path: Path, motionsync: Command, number: int, damage: str) -> None:
    shutil.copytree(folder, tmp_path / "sweep")
    part = tmp_path / "sweep" / f"part-{number:06}.parquet"
    if damage == "other":
        pq.write_table(pa.table({"run": np.arange(3)}), part)
    else:
        part.write_bytes(part.read_bytes()[: part.stat().st_size // 2] if damage == "cut" else b"")
    outcome = motionsync("sweep-plot", "sweep", "--x", V, "--y", LENGTH)
    assert_one_line(outcome, part.name, "other columns" if damage == "other" else "damaged")
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


def test_a_condition_that_is_none_is_reported(folder: Path, motionsync: Command) -> None:
    options = ("--x", V, "--y", LENGTH, "--passed")
    assert_one_line(motionsync("sweep-plot", folder, *options, "lte == 0"), "'lte'")
    assert_one_line(motionsync("sweep-plot", folder, *options, "cut_error == fast"), "'fast'")


@pytest.mark.parametrize(
    ("condition", "message"), [("cut_error < 1e6", "Every run passed"), ("cut_error < 0", "No run passed")]
)
def test_a_sweep_without_a_boundary_says_so(motionsync: Command, tmp_path: Path, condition: str, message: str) -> None:
    """One run, and the figures of one run: a cell each."""
    plan = SweepPlan.of(example_plans.EXAMPLE, [f"{V}=500", f"{A}=3000", f"{LENGTH}=1000", f"{TIME}=0.1"])
    plan.write(tmp_path)
    example_plans.write(tmp_path, example_plans.rows(plan), 1)
    outcome = motionsync("sweep-plot", tmp_path, "--x", V, "--y", LENGTH, "--passed", condition)
    assert (outcome.status, outcome.err) == (0, "")
    page = (tmp_path / "plot.html").read_text("utf-8")
    assert re.search(rf"<li>{message}.*: there is no boundary", page)
    assert list(charts(page)) == [f"The share of the runs that passed, over {V} and {LENGTH}"]


def test_a_result_without_any_value_is_reported(folder: Path, rows: Rows, motionsync: Command, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "sweep", ignore=shutil.ignore_patterns("part-*"))
    example_plans.write(tmp_path / "sweep", rows | {"cut_error": np.full(1080, np.nan)}, 500)
    assert_one_line(motionsync("sweep-plot", "sweep", "--x", V, "--y", "cut_error"), "cut_error", "no value in any run")


def test_a_changed_scenario_is_repeated_from_the_copy(tmp_path: Path, motionsync: Command) -> None:
    """The command names the file as long as it is what the sweep ran."""
    own_file = tmp_path / "own_file" / "scenario.toml"
    own_file.parent.mkdir()
    own_file.write_text(example_plans.EXAMPLE.read_text("utf-8"), "utf-8")
    plan = SweepPlan.of(own_file, example_plans.settings(2, 2, 3, 2))
    (tmp_path / "sweep").mkdir()
    plan.write(tmp_path / "sweep")
    example_plans.write(tmp_path / "sweep", example_plans.rows(plan), 500)
    for file in (own_file.parent, tmp_path / "sweep" / "swept_scenario.toml"):
        assert motionsync("sweep-plot", "sweep", "--x", V, "--y", LENGTH).status == 0
        page = (tmp_path / "sweep" / "plot.html").read_text("utf-8")
        assert data(page)["command"] == f"motionsync run {file}"
        own_file.write_text("", "utf-8")


# --- the histogram of one column ---


@pytest.fixture
def seeds(tmp_path: Path, motionsync: Command) -> Callable[..., str]:
    """The text of a page of a made-up Monte Carlo over 300 seeds."""
    example_plans.seeds(tmp_path / "seeds", 300)

    def page(*options: str) -> str:
        outcome = motionsync("sweep-plot", tmp_path / "seeds", *options)
        assert (outcome.status, outcome.err) == (0, "")
        return (tmp_path / "seeds" / "plot.html").read_text("utf-8")

    return page


def figure(page: str, name: str) -> tuple[str, str]:
    """The value and the note of a figure at the top of a page."""
    ((value, note),) = re.findall(rf"<dt>{re.escape(name)}</dt><dd>(.*?)<small>(.*?)</small>", page)
    return value.replace("\N{NARROW NO-BREAK SPACE}", ""), note.replace("\N{NARROW NO-BREAK SPACE}", "")


def cells(page: str, heading: str) -> list[list[str]]:
    """The cells of the table below a heading, without its head."""
    table = page.split(f"<h2>{heading}</h2>")[1].split("</table>", maxsplit=1)[0]
    return [re.findall("<td>(.*?)</td>", row) for row in table.splitlines() if "<td>" in row]


def test_the_histogram_has_the_products_of_all_runs(seeds: Callable[..., str], tmp_path: Path) -> None:
    """NumPy counts the errors of all runs between the borders of the bars."""
    errors = example_plans.seeds(tmp_path / "same", 300)
    page = seeds("--x", "true_length_errors")
    (chart,) = charts(page).values()
    bars = chart["data"][0]
    borders = np.array(data(page)["x"]["edges"])
    assert bars["y"] == np.histogram(errors, borders)[0].tolist()
    assert bars["x"] == pytest.approx((0.5 * (borders[1:] + borders[:-1])).tolist(), abs=1e-9)
    assert [c == "--bad" for c in bars["marker"]["color"]] == [abs(x) > 0.1 for x in bars["x"]]
    assert sorted(shape["x0"] for shape in chart["layout"]["shapes"]) == [-0.1, 0.1]
    numbers = example_plans.unpacked(data(page)["runs"]["numbers"])
    for bar, (runs, place) in enumerate(bars["customdata"]):
        inside = (errors >= borders[bar]) & (errors < borders[bar + 1])
        assert runs == np.count_nonzero(inside.any(axis=1))
        assert (place >= 0) == (runs > 0)
        if runs:  # the example is the run with the value that is farthest from the mean
            farthest = np.abs(np.where(inside, errors - errors.mean(), 0.0)).max(axis=1).argmax()
            assert numbers[place] == farthest


def test_the_page_of_a_monte_carlo_has_quantiles_and_the_capability(seeds: Callable[..., str], tmp_path: Path) -> None:
    errors = example_plans.seeds(tmp_path / "same", 300)
    page = seeds("--x", "true_length_errors")
    assert figure(page, "products") == ("3600", "1 out of tolerance, ±0.1 mm")
    low, high = np.quantile(errors, (0.005, 0.995), method="inverted_cdf")
    assert figure(page, "99 % of the products") == (
        f"{low:.4f} mm to {high:.4f} mm", "the farthest from 0 is -0.1200 mm"
    )  # fmt: skip
    assert figure(page, "mean true length error") == (
        f"{errors.mean():.4f} mm", f"one sigma is {errors.std(ddof=1):.4f} mm"
    )  # fmt: skip
    value, note = figure(page, "process capability")
    c_pk = (0.1 - errors.mean()) / (3.0 * errors.std(ddof=1))
    assert value == f"C_pk {c_pk:.2f}"
    ends = [float(text) for text in re.findall(r"\d\.\d\d", note)]
    assert ends[0] < c_pk < ends[1]
    assert f"C_pk is {note}." in page
    quantiles = cells(page, "Quantiles")
    for share, error in quantiles:
        expected = np.quantile(errors, float(share.split()[0]) / 100.0, method="inverted_cdf")
        assert float(error.removesuffix(" mm")) == pytest.approx(expected, abs=0.6e-4)
    assert len(quantiles) == 10
    worst = next(row for row in cells(page, "From run to run") if row[0] == "greatest length error")
    expected = np.quantile(np.abs(errors).max(axis=1), (0.0, 0.05, 0.5, 0.95, 1.0))
    assert [float(text.split()[0]) for text in worst[1:]] == pytest.approx(expected.tolist(), rel=1e-3)


def test_any_result_has_a_histogram(seeds: Callable[..., str], folder: Path, motionsync: Command, rows: Rows) -> None:
    page = seeds("--x", "true_length_sigma")
    (chart,) = charts(page).values()
    assert sum(chart["data"][0]["y"]) == 300
    assert chart["layout"]["shapes"] == []
    assert "process capability" not in page
    outcome = motionsync("sweep-plot", folder, "--x", "cut_error", "--output", "page.html")
    assert outcome.status == 0
    page = Path("page.html").read_text("utf-8")
    (chart,) = charts(page).values()
    assert sum(chart["data"][0]["y"]) == np.count_nonzero(np.isfinite(rows["cut_error"])) == 1050
    assert "<li>30 runs without a value of cut_error: they are not in the histogram.</li>" in page
    assert f"whatever their {' and '.join(example_plans.FACTORS)} is" in page


def test_runs_that_differ_in_more_than_their_seed_are_said_to_be_counted_together(
    tmp_path: Path, motionsync: Command
) -> None:
    example_plans.seeds(tmp_path / "alone", 8)
    example_plans.seeds(tmp_path / "both", 8, "master.smoothing_time=0.02")
    message = "The values of all runs are counted together, whatever their master.smoothing_time is."
    for name in ("alone", "both"):
        assert motionsync("sweep-plot", name, "--x", "true_length_errors").status == 0
        assert (message in (tmp_path / name / "plot.html").read_text("utf-8")) == (name == "both")


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        (("--x", "true_length_errors", "--colour", "passed"), ("--colour passed", "add --y")),
        (("--x", "true_length_errors", "--amount", "max"), ("--amount max", "add --y")),
        (("--x", "true_length_errors", "--better", "x=min"), ("--better x=min", "add --y")),
        (("--x", "true_length_errors", "--beside", "c_pk"), ("--beside c_pk", "add --y")),
        (("--x", "refusal"), ("--x refusal", "texts", "numbers")),
        (("--x", "passed"), ("--x passed", "true or false")),
        (("--x", "encoder.seed", "--y", "true_length_errors"), ("--y true_length_errors", "several numbers in a row")),
        (("--x", "true_length_errors", "--y", "c_pk"), ("--x true_length_errors", "several numbers in a row")),
        (("--x", "c_pk", "--y", "cut_movement", "--colour", "true_length_errors"), ("--colour", "several numbers")),
        (("--x", "c_pk", "--passed", "true_length_errors < 1"), ("true_length_errors", "several numbers in a row")),
    ],
)
def test_what_a_histogram_cannot_show_is_reported(
    tmp_path: Path, motionsync: Command, options: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    example_plans.seeds(tmp_path / "seeds", 8)
    assert_one_line(motionsync("sweep-plot", "seeds", *options), *parts)


@pytest.mark.parametrize(
    "values", [[800.0, 800.0, 800.0], [0.0, 0.0], [800.0, 800.0 + 1.2e-13, 800.0 - 1.2e-13], [5.0]]
)
def test_equal_values_have_a_histogram_of_one_bar(
    folder: Path, motionsync: Command, tmp_path: Path, values: list[float]
) -> None:
    """They may differ by rounding."""
    plan = SweepPlan.of(example_plans.EXAMPLE, [f"{V}={','.join(str(500 + i) for i in range(len(values)))}"])
    plan.write(tmp_path)
    runs = np.arange(len(values))
    columns = {"run": runs, V: 500.0 + runs, "passed": runs >= 0, "cut_error": np.array(values)}
    example_plans.write(tmp_path, columns, 10)
    assert motionsync("sweep-plot", tmp_path, "--x", "cut_error").status == 0
    (chart,) = charts((tmp_path / "plot.html").read_text("utf-8")).values()
    assert sorted(chart["data"][0]["y"])[-1] == len(values)


def test_results_have_their_units(tmp_path: Path, seeds: Callable[..., str]) -> None:
    """Those of the measured line, in mm; its axis moves 120 kg, so forces are in N."""
    names = units(SweepPlan.of(example_plans.MEASURED, ["encoder.noise=0.01,0.02", "servo.dead_time=0,0.001"]))
    expected = {"true_length_errors": "mm", "cut_movement": "mm", "following_error": "mm", "force_peak": "N"}
    expected |= {"encoder.noise": "mm", "servo.dead_time": "s"}
    assert expected.items() <= names.items()
    assert charts(seeds("--x", "true_length_sigma"))["Histogram of the true_length_sigma"]["layout"]["xaxis"][
        "title"
    ] == {"text": "true_length_sigma in mm"}
