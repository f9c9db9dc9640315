"""The report of a machine that cuts to length, of a run by hand (`tests/support/scenarios/hand_made_run.py`).

The line runs at 1000 u/s, the front end stands for a cut at 198, the kerf is 4: pieces of 500, 1500, 1500, 1000, 3004
and 1500 end at 702, 2206, 3710, 4714, 7722 and 9226.
"""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from motionsync.cutting.interface import PieceKind
from motionsync_fmu.pages.pictures import piece_ends
from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.pages.report.page import run_charts
from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.files.reader import load_scenario
from tests.pages import reports
from tests.pages.reports import Run, page, words
from tests.support.scenarios.hand_made_run import APPROACH, CUT, HandMadeRun, record

TEXT = """
title = "All kinds"
fmu = "CutToLength"
stop_time = 12.0
step_size = 0.01
[start]
kerf = 4.0
"axis.max_velocity" = 2000.0
"axis.min_position" = -250.0
"axis.max_position" = 650.0
[master]
velocity = 1000.0
[[set]]
at = 0.2
start = true
[cuts]
tolerance = 0.1
"""
PIECES = [
    (PieceKind.TRIM, 500.0, 0.0),
    (PieceKind.PRODUCT, 1500.0, 0.0),
    (PieceKind.PRODUCT, 1500.0, 0.05),
    (PieceKind.SAMPLE, 1000.0, 0.0),
    (PieceKind.MERGED, 3004.0, 1504.0),
    (PieceKind.PRODUCT, 1500.0, 0.7),
]
BEGINS, ENDS = [198.0, 702.0, 2206.0, 3710.0, 4714.0, 7722.0], [702.0, 2206.0, 3710.0, 4714.0, 7722.0, 9226.0]
RESERVES = [1.0, 0.5, 0.4, 0.05, 0.6, 0.0]
LIMIT, ASKED = [(0.0, 1250.0), (5.0, 950.0)], [(0.0, 1100.0), (5.0, 900.0)]


def error_text(error: float) -> str:
    return f"error {error:g} mm"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    file = tmp_path_factory.mktemp("kinds") / "scenario.toml"
    file.write_text(TEXT, "utf-8")
    s = load_scenario(file)
    return s, record(s, HandMadeRun(198.0, 4.0, PIECES, RESERVES, ASKED, LIMIT, [4]), 0.2, 0.01)


def named(chart: Chart, name: str) -> dict[str, Any]:
    (trace,) = reports.named(chart, name)
    return trace


def at(trace: dict[str, Any], time: float) -> float:
    """A curve at a time: the value of the last point up to it."""
    return float(trace["y"][int(np.searchsorted(trace["x"], time, side="right")) - 1])


# --- charts ---


def test_the_pieces_lie_on_the_material_in_the_colours_of_their_kinds(run: Run) -> None:
    chart = run_charts(*run)["list"]
    assert not chart.timed
    lain = {}
    for trace in chart.traces:
        for begin, length, text in zip(trace["base"], trace["x"], trace["customdata"], strict=True):
            lain[begin] = (begin + length, trace["marker"]["color"], text)
    assert sorted(lain) == pytest.approx(BEGINS)
    ends, colours, texts = zip(*(lain[begin] for begin in sorted(lain)), strict=True)
    assert ends == pytest.approx(ENDS)
    assert colours == ("--kind-4", "--kind-1", "--kind-1", "--kind-2", "--kind-6", "--kind-1")
    assert texts[4] == "piece 5, MERGED: 3004 mm, error 1504 mm"
    products = named(chart, "PRODUCT")
    assert products["marker"]["line"]["color"] == ["--ink", "--ink", "--bad"]


def test_the_pieces_pass_the_saw_as_bands(run: Run) -> None:
    """The sample is between 3710 and 4714: at 4 s these places are at 290 and -714 of the saw, at 4.5 s at 790 and
    -214; what is outside the window is cut off."""
    s, recording = run
    chart = run_charts(s, recording)["pieces"]
    low, high = chart.axis(1)["range"]
    saw = recording.values["slave.position"]
    assert low < saw.min()
    assert high > saw.max()
    band = named(chart, "SAMPLE")
    assert band["fillcolor"] == "--kind-2"
    outline = [(x, y) for x, y in zip(band["x"], band["y"], strict=True) if x is not None]
    times = np.array([x for x, _ in outline])
    turn = int(np.argmax(times)) + 1  # along the lower edge and back along the upper one
    for time, upper, lower in ((4.0, 290.0, low), (4.5, high, low), (4.9, high, 186.0)):
        seen = [np.interp(time, *zip(*sorted(part), strict=True)) for part in (outline[turn:], outline[:turn])]
        assert seen == pytest.approx([upper, lower], abs=0.1)
    numbers = {n["text"]: n["x"] for n in chart.layout["annotations"] if re.fullmatch(r"\d", n["text"])}
    assert list(numbers) == ["1", "2", "3", "4", "5", "6"]
    assert numbers["4"] * 1000.0 - (3710.0 + 4714.0) / 2.0 == pytest.approx(
        chart.layout["annotations"][1]["y"], abs=1.0
    )


def test_the_saw_is_thick_while_it_cuts(run: Run) -> None:
    x = named(run_charts(*run)["pieces"], "cutting")["x"]
    stretches = [part.split() for part in " ".join("|" if t is None else str(t) for t in x).split("|") if part.strip()]
    assert len(stretches) == len(ENDS)
    for stretch, end in zip(stretches, ENDS, strict=True):
        sync = (end + APPROACH) / 1000.0
        assert (float(stretch[0]), float(stretch[-1])) == pytest.approx((sync, sync + CUT), abs=0.011)


def test_the_requested_velocity_is_drawn_with_the_line_s_own_and_its_limit(run: Run) -> None:
    chart = run_charts(*run)["pieces"]
    for name, before, after in (
        ("line", 1000.0, 1000.0),
        ("requested velocity", 1100.0, 900.0),
        ("limit of the line", 1250.0, 950.0),
    ):
        assert (at(named(chart, name), 3.0), at(named(chart, name), 8.0)) == (before, after)
    assert chart.axis(2)["range"][1] > 1250.0


def test_a_limit_far_above_the_line_does_not_flatten_it(run: Run) -> None:
    s, recording = run
    values = recording.values | {"limits.max_line_velocity": np.full(len(recording.time), 1e9)}
    chart = run_charts(s, replace(recording, values=values))["pieces"]
    assert 1100.0 < chart.axis(2)["range"][1] < 1300.0


def test_errors_are_stems_and_the_tolerance_a_band(run: Run) -> None:
    """The worst product is off by 0.7, so that 1.05 is shown; the merged piece is off by 1504: an arrow at the edge."""
    chart = run_charts(*run)["pieces"]
    trace = named(chart, "length error")
    assert trace["y"] == pytest.approx([0.0, 0.0, 0.05, 0.0, 1.05, 0.7])
    assert trace["marker"]["symbol"] == ["circle"] * 4 + ["triangle-up", "circle"]
    assert trace["marker"]["color"] == ["--muted", "--ok", "--ok", "--muted", "--bad", "--bad"]
    assert trace["customdata"][4].endswith(error_text(1504.0))
    assert trace["customdata"][5].endswith(error_text(0.7))
    times = [(end + APPROACH) / 1000.0 + CUT for end in ENDS]
    assert trace["x"] == pytest.approx(times, abs=0.011)
    assert sorted(set(named(chart, "tolerance")["y"])) == [-0.1, 0.1]


def test_errors_that_are_rounding_are_not_drawn_large(run: Run) -> None:
    """1e-11 with positions of 12000 is rounding: the row has the height of the tolerance, 0.1."""
    s, recording = run
    values = recording.values | {"last.error": np.where(recording.values["last.error"] > 0.0, 1e-11, 0.0)}
    chart = run_charts(s, replace(recording, values=values))["pieces"]
    assert chart.axis(3)["range"] == pytest.approx([-0.168, 0.168])
    assert any(str(n["text"]).startswith("0 to rounding: at most 1e-11 mm") for n in chart.layout["annotations"])
    exact = run_charts(replace(s, pieces=replace(s.pieces, tolerance=1e-9)), replace(recording, values=values))[
        "pieces"
    ]
    assert exact.axis(3)["tickvals"] == [0]
    small = recording.values | {"last.error": np.where(recording.values["last.error"] > 0.0, 1e-4, 0.0)}
    tight = run_charts(replace(s, pieces=replace(s.pieces, tolerance=1e-4)), replace(recording, values=small))["pieces"]
    assert tight.axis(3)["exponentformat"] == "power"  # whose 0 is 0
    assert "tickformat" not in tight.axis(3)


def test_each_reserve_is_a_bar(run: Run) -> None:
    chart = run_charts(*run)["pieces"]
    trace = named(chart, "to spare")
    assert trace["y"] == pytest.approx([100.0, 50.0, 40.0, 5.0, 60.0, 0.0])
    assert trace["x"] == pytest.approx([(end + APPROACH) / 1000.0 for end in ENDS], abs=1e-6)
    assert trace["marker"]["color"] == ["--ok"] * 5 + ["--bad"]
    # 1 - 1000/1250 and 1 - 1000/950, not below 0 in this run by hand
    curve = named(chart, "to spare at this velocity")
    assert (at(curve, 3.0), at(curve, 8.0)) == (pytest.approx(20.0), 0.0)


def test_a_run_without_a_piece_and_one_with_very_many_have_their_charts(run: Run, tmp_path: Path) -> None:
    s, recording = run
    nothing = record(s, HandMadeRun(198.0, 4.0, [], [], ASKED, LIMIT), 0.2, 0.01)
    charts = run_charts(s, nothing)
    assert "list" not in charts
    assert any(n["text"] == "no piece" for n in charts["pieces"].layout["annotations"])
    assert "There was none." in words(page((s, nothing), tmp_path))
    many = 500
    counter = np.floor(np.linspace(0.0, many, len(recording.time)))
    values = recording.values | {"statistics.cuts": counter, "last.kind": np.ones(len(counter))}
    crowded = run_charts(s, replace(recording, values=values))
    assert crowded["pieces"].layout["annotations"][0]["text"] == "length in mm"
    for chart in (*charts.values(), *crowded.values()):
        text = re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart.as_json(), allow_nan=False))
        go.Figure(json.loads(text))  # plotly's own schema
        assert len(text) < 400_000


def test_kinds_have_the_same_colours_in_all_charts(run: Run) -> None:
    chart = run_charts(*run)["lanes"]
    bars = {(t["name"], t["marker"]["color"]) for t in chart.traces if t["type"] == "bar"}
    for name, colour in (("PRODUCT", "--kind-1"), ("SAMPLE", "--kind-2"), ("TRIM", "--kind-4"), ("MERGED", "--kind-6")):
        assert {colour_of_bar for kind, colour_of_bar in bars if kind == name} == {colour}


def test_the_picture_of_an_example_has_the_ends_of_its_pieces(run: Run) -> None:
    """Each passes the saw at 1000 u/s, and is where the saw is while that cuts."""
    s, recording = run
    ends = piece_ends(find_pieces(s, recording), s, recording)
    cutting = recording.values["tool.cutting"] != 0.0
    assert ends[cutting] == pytest.approx(recording.values["slave.position"][cutting], abs=1e-9)
    steps = np.diff(ends)
    assert steps[np.isfinite(steps)] == pytest.approx(10.0)
    assert np.isnan(ends).sum() > 100


# --- the page ---


def test_the_page_lists_the_pieces(run: Run, tmp_path: Path) -> None:
    text = words(page(run, tmp_path))
    figures = text[: text.index("Each piece passes the saw as a band")]
    for part in (
        "pieces 6 3 products, 2 good; also 1 trim, 1 sample, 1 merged",
        "greatest length error 0.7 mm (piece 6) of 3 products, 1 merged piece not included, tolerance 0.1 mm",
        "cuts skipped or late 1 skipped",
        "least time to spare at least 0 % (piece 6) of a cycle in which the saw",
        "greatest velocity of the line 1000 mm/s (60 m/min) above its limit for 7.01 s, most at 5 s: 1000 of 950 mm/s",
    ):
        assert part in figures, figures
    head = "piece kind ordered length error good measured time to spare in sync at"
    table = text[text.index(head) + len(head) :]
    assert table.strip().startswith(
        "1 TRIM 500 mm 500 mm 0 mm - 100 % 0.788603 s 2 PRODUCT 1500 mm 1500 mm 0 mm yes as reported 50 % 2.2926 s "
        "3 PRODUCT 1499.95 mm 1500 mm 0.05 mm yes as reported 40 % 3.7966 s"
    )
    assert "5 MERGED 1500 mm 3004 mm 1504 mm no as reported 60 % " in table
    assert "6 PRODUCT 1499.3 mm 1500 mm 0.7 mm no as reported 0 % 9.3126 s" in table


def test_a_merged_piece_without_an_ordered_length_has_no_error(run: Run, tmp_path: Path) -> None:
    """Between marks without a spacing the block knows no ordered length, and reports the error 0."""
    s, recording = run
    merged = recording.values["last.kind"] == PieceKind.MERGED
    errors = np.where(merged, 0.0, recording.values["last.error"])
    text = words(page((s, replace(recording, values=recording.values | {"last.error": errors})), tmp_path))
    assert "5 MERGED 3004 mm 3004 mm unknown no as reported" in text


def test_a_length_that_is_measured_otherwise_is_shown(run: Run, tmp_path: Path) -> None:
    """The saw is 0.25 behind in the third cut: the piece before it is 1500.25 long, the one after it 999.75."""
    s, recording = run
    third = (recording.time > 3.0) & (recording.time < 4.5) & (recording.values["tool.cutting"] != 0.0)
    saw = recording.values["slave.position"] - 0.25 * third
    text = words(page((s, replace(recording, values=recording.values | {"slave.position": saw})), tmp_path))
    assert "yes 1500.25 mm 40 %" in text
    assert "999.75 mm 5 %" in text
    assert "not met pieces as long as they are reported, within 0.1 mm" in text


def test_headings_come_in_the_sequence_of_a_reader_s_questions(run: Run, tmp_path: Path) -> None:
    headings = re.findall(r"<h2[^>]*>(.*?)</h2>", page(run, tmp_path))
    assert headings[:4] == ["Pieces", "The machine", "Motion", "States and commands"]
