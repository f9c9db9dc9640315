"""The pictures of a measured line, on two pages and in the README, are true: the commands find what the tables have,
the pictures are drawn from these, and the figures next to them are theirs."""

import csv
import re
import shlex
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from motionsync_fmu import sweep
from motionsync_fmu.scenario.evaluate.true_pieces import TruePiece
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.sweeps.database import Database
from motionsync_fmu.sweeps.distribution import MOST, find_distribution
from tests import ROOT
from tests.support.project.pictures import assert_same_picture
from tools.measured_line_pictures import ErrorTable, draw_histogram, draw_line, draw_trade, run_line

DOCS = ROOT / "docs"
PAGE = "".join((DOCS / folder / "measured_line.md").read_text("utf-8") for folder in ("tutorial", "how_to"))
README = (ROOT / "README.md").read_text("utf-8")
PROSE, README_PROSE = (re.sub(r"\s+", " ", text) for text in (PAGE, README))
SMOOTHING, DURATION, SEED = "master.smoothing_time", "master.segments.1.duration", "encoder.seed"
SOME: dict[str, dict[str, str]] = {  # runs of each sweep that are made anew
    "seeds": {SEED: "0,417"},
    "noise": {SEED: "3,9", SMOOTHING: "0.005,0.08"},
    "ramps": {DURATION: "9.2,10.5", SMOOTHING: "0.01,0.04"},
}


def table(name: str) -> ErrorTable:
    return ErrorTable.read(DOCS / "measured_line" / f"{name}.csv")


def rows(name: str) -> list[dict[str, float]]:
    with (DOCS / "measured_line" / f"{name}.csv").open(newline="") as stream:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]


def factors(name: str) -> dict[str, Any]:
    """What the command of the page varies that made a table."""
    joined = PAGE.replace("\\\n", "")
    (line,) = re.findall(rf"^    motionsync (sweep CutToLength/measured_line .* --output {name})$", joined, re.M)
    words = shlex.split(line)
    return dict(words[i + 1].split("=", 1) for i, word in enumerate(words) if word == "--set")


@pytest.mark.parametrize("name", list(SOME))
def test_the_commands_find_what_the_tables_have(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Some of the runs, made anew and written by the code of the page."""
    assert SOME[name].keys() <= factors(name).keys()
    monkeypatch.chdir(tmp_path)
    sweep("CutToLength/measured_line", set=factors(name) | SOME[name], output=name, workers=1)
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    others = "|".join(other for other in SOME if other != name)
    exec(re.sub(rf'^    \("(?:{others})".*\n', "", code, flags=re.M), {})
    with (tmp_path / f"{name}.csv").open(newline="") as stream:
        made = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]
    chosen = {factor: {float(text) for text in texts.split(",")} for factor, texts in SOME[name].items()}
    expected = [row for row in rows(name) if all(round(row[f], 6) in values for f, values in chosen.items())]
    assert len(expected) > 20
    assert [{**row, "error": 0.0} for row in made] == [{**row, "error": 0.0} for row in expected]
    assert [row["error"] for row in made] == pytest.approx([row["error"] for row in expected], abs=2e-6)


def test_the_tables_are_those_of_the_whole_commands() -> None:
    assert {row[SEED] for row in rows("seeds")} == set(range(1000))
    for name, factor, count in (("noise", SEED, 10), ("ramps", DURATION, 16)):
        points = {(row[SMOOTHING], row[factor]) for row in rows(name)}
        assert len(points) == 9 * count
        assert sorted({time for time, _ in points}) == [float(t) for t in factors(name)[SMOOTHING].split(",")]


def test_the_figures_of_a_thousand_seeds(tmp_path: Path) -> None:
    errors_of: dict[float, list[float]] = {}
    for row in rows("seeds"):
        errors_of.setdefault(row[SEED], []).append(row["error"])
    columns = {"run": [*range(len(errors_of))], "true_length_errors": [*errors_of.values()]}
    pq.write_table(pa.table(columns | {"tolerance": np.full(len(errors_of), 0.1)}), tmp_path / "part-000000.parquet")
    d = find_distribution(Database(tmp_path, [tmp_path / "part-000000.parquet"], ()), "true_length_errors")
    assert d
    assert d.capability
    assert (d.count, d.capability.outside) == (12_000, 0)
    low, high = map(d.quantile, MOST)
    assert f"99 % of them are between {low:.4f} mm and {high:.4f} mm off, the worst one {d.worst:.4f} mm" in PROSE
    c = d.capability
    assert f"C_pk is {c.c_pk:.2f}, or {c.interval}" in PROSE
    seeds = table("seeds")
    assert f"The sigma of all products is {float(seeds.error.std(ddof=1)):.4f} mm" in PROSE
    errors = seeds.error.reshape(1000, 12)
    sigma = sqrt(float(errors.var(axis=0, ddof=1).mean()))
    assert f"a product is off by a sigma of {sigma:.3f} mm" in PROSE
    means = np.abs(errors.mean(axis=0))
    assert np.flatnonzero(means > 0.002).tolist() == [5, 6]
    assert f"are {means.max():.3f} mm off on average" in PROSE


def test_the_figures_of_the_smoothing_time() -> None:
    """Noise falls by the root, the error on a ramp grows by the square; the filter's error is what a stiff axis would
    leave: 0.05 mm at 10 ms, of which there are 0.065 mm."""
    noise, ramps = table("noise"), table("ramps")
    first, *_, last = noise.times()
    sigmas = [noise.sigma_of_noise(t) for t in noise.times()]
    assert sigmas == sorted(sigmas, reverse=True)
    for t, sigma in zip(noise.times(), sigmas, strict=True):
        predicted = sqrt(2.0) * 1.19 * sqrt(0.02**2 + 0.05**2 / 12.0) * sqrt(0.002 / t)
        assert predicted < sigma < 1.3 * predicted
    assert f"falls from {sigmas[0]:.3f} mm to {sigmas[-1]:.3f} mm" in PROSE
    assert f"grows from {ramps.greatest(first):.2f} mm to {ramps.greatest(last):.1f} mm" in PROSE
    for t in ramps.times():
        if t >= 0.02:
            assert ramps.greatest(t) == pytest.approx(2.0 * 250.0 * t * t, rel=0.2)
        elif t < 0.014:
            assert ramps.greatest(t) > 1.2 * 2.0 * 250.0 * t * t


def test_a_saw_that_cuts_long_averages(tmp_path: Path) -> None:
    made = sweep(
        "CutToLength/measured_line", set={SMOOTHING: [0.005, 0.04], SEED: "0:9"}, output=tmp_path / "rows", workers=1
    )
    errors = np.array(made.column("true_length_errors").to_pylist()).reshape(2, 10, 12)
    few, many = (sqrt(float(of_time.var(axis=0, ddof=1).mean())) for of_time in errors)
    assert f"is {few:.3f} mm at 5 ms and {many:.3f} mm at 40 ms" in PROSE
    movement = np.array(made.column("cut_movement").to_pylist()).reshape(2, 10).mean(axis=1)
    assert movement[1] < 0.7 * movement[0]


def test_the_pictures_are_drawn_from_the_tables() -> None:
    assert_same_picture(draw_histogram(table("seeds").error), DOCS / "length_errors.svg")
    assert_same_picture(draw_trade(table("noise"), table("ramps")), DOCS / "smoothing_time.svg")


@pytest.fixture(scope="module")
def line() -> tuple[Recording, list[TruePiece], list[TruePiece]]:
    return run_line()


def test_the_picture_of_the_line_is_the_run(line: tuple[Recording, list[TruePiece], list[TruePiece]]) -> None:
    assert_same_picture(draw_line(*line), DOCS / "measured_line.svg")


def test_its_caption_is_true(line: tuple[Recording, list[TruePiece], list[TruePiece]]) -> None:
    _, right, forgotten = line
    worst, far = (max(abs(piece.error) for piece in pieces) for pieces in (right, forgotten))
    assert all(f"the pieces are at most {worst:.3f} mm off" in text for text in (PROSE, README_PROSE))
    assert f"those that are cut at the stop are up to {far:.2f} mm off" in PROSE
    assert sum(abs(piece.error) > 0.1 for piece in forgotten) == 2
    assert all(piece.believed == pytest.approx(piece.ordered, abs=1e-9) for piece in [*right, *forgotten])
