"""The report of a run: which charts it has, what they show, and what the page states."""

import hashlib
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest
from plotly.offline import get_plotlyjs_version

from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages.numbers import jumps, points, rounded, thinned
from motionsync_fmu.pages.report.origin import describe_fmu
from motionsync_fmu.pages.report.page import PLOTLY, run_charts, write_report
from motionsync_fmu.pages.style import TEMPLATES, load_template, typeset
from motionsync_fmu.scenario.cutting import CutSpec
from motionsync_fmu.scenario.evaluate.cuts import passages
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.evaluate.reference_comparison import read_reference
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.settings import Setting
from tests import ROOT
from tests.pages.reports import Run, coloured, named, notes, page, sheets, words
from tests.support.hosts.fmus import Fmus

CYCLIC_CUT = "FlyingSaw/cyclic_cut"
SHOWN = (
    CYCLIC_CUT,
    "Synchronizer/polynomial",
    "RemoteSync/accelerating_axis",
    "Follower/cyclic_through",
    "Gearing/ccw_direct",
    "CutToLength/cyclic_orders",
)
SHOWN_ELSEWHERE = (
    "limit of the axis",
    "tolerance",
    "cutting",
    "stems",
    "to spare at each piece",
    "at rest before each piece",
)  # another trace shows the same


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    """Scenarios of all blocks, and their recordings."""
    loaded = {name: load_scenario(ROOT / "scenarios" / name / "scenario.toml") for name in SHOWN}
    return {name: (s, run_in_process(s, s.step_size)) for name, s in loaded.items()}


@pytest.fixture(scope="module")
def cyclic_cut(runs: dict[str, Run]) -> Run:
    return runs[CYCLIC_CUT]


# --- the page ---


def test_a_report_is_small_and_loads_nothing(runs: dict[str, Run], tmp_path: Path) -> None:
    """Plotly.js' basic bundle is the greater part of it."""
    for run in runs.values():
        whole = page(run, tmp_path)
        assert len(whole.encode()) < 2_500_000
        text = whole.replace(PLOTLY.read_text("utf-8"), "")
        assert len(text) < len(whole)
        assert not re.search(r"<(script|link|img|iframe)[^>]+(src|href)=", text)
        assert not re.search(r"https?://(?!www\.w3\.org/2000/svg\b)|@import|url\(|fetch\(|XMLHttpRequest", text)
        assert '<a href="out.csv">' in text


def test_plotly_js_is_the_one_that_was_looked_at() -> None:
    """The digest is that of `plotly-basic.min.js` of the npm package plotly.js-basic-dist-min 4.1.1."""
    text = PLOTLY.read_bytes()
    assert hashlib.sha256(text).hexdigest() == "99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba"
    assert b"Licensed under the MIT license" in text[:300]
    assert b"</script" not in text
    readme = PLOTLY.with_name("README.md").read_text("utf-8")
    assert f"plotly.js {get_plotlyjs_version()}," in readme
    assert "MIT" in PLOTLY.with_name("plotly-basic.MIT.txt").read_text("utf-8")


def test_the_charts_are_what_plotly_js_takes(runs: dict[str, Run]) -> None:
    """Plotly's own schema refuses a property or value that plotly.js does not know."""
    light, dark = sheets()
    assert light.keys() >= dark.keys() - {"--ink", "--paper", "--muted", "--grid", "--axis"}
    for run in runs.values():
        for chart in run_charts(*run).values():
            data = coloured(json.loads(json.dumps(chart.as_json(), allow_nan=False)), light)
            go.Figure(data)
            go.Figure(coloured(chart.as_json(), light | dark))


def test_a_dark_page_has_a_colour_of_its_own_for_each_of_a_light_one() -> None:
    light, dark = sheets()
    assert light.keys() == dark.keys()
    assert not [name for name in light if light[name] == dark[name]]


# --- figures, and where they come from ---


def test_the_figures_come_first(cyclic_cut: Run, tmp_path: Path) -> None:
    """The scenario asks for 20 cuts within 1e-9 mm; its axis has the limits in its file."""
    text = words(page(cyclic_cut, tmp_path))
    begin = text[: text.index("Cuts A cut each time")]
    for part in (
        "cuts 20 a mark every 1500 mm",
        "worst error of a cut 0 (to rounding) tolerance 1e-9 mm",
        "limit -250 to 800 mm",
        "greatest acceleration of the saw 10000 mm/s² limit 10000 mm/s², 100 % used",
        "limit 1500 mm/s,",
    ):
        assert part in begin, begin
    assert re.search(r"verdict as expected (\d+) of \1 expectations met", begin)


def test_cuts_machine_motion_and_states_follow_one_another(cyclic_cut: Run, tmp_path: Path) -> None:
    text = page(cyclic_cut, tmp_path)
    headings = re.findall(r"<h2[^>]*>(.*?)</h2>", text)
    assert headings[:4] == ["Cuts", "The machine", "Motion", "States and commands"]
    assert headings[-1] == "Test record"
    assert text.count("<h1>") == 1
    assert len(re.findall(r'class="plot" role="img" aria-label="[^"]+"', text)) == 3


def test_nothing_is_said_of_a_reference_that_there_is_not(cyclic_cut: Run, tmp_path: Path) -> None:
    s, recording = cyclic_cut
    alone = replace(s, file=tmp_path / "scenario.toml", expectations=())
    alone.file.write_text("", "utf-8")
    nothing = replace(evaluate_run(alone, recording), expectations=[], reference=[])
    write_report(tmp_path / "report.html", alone, recording, nothing)
    text = words((tmp_path / "report.html").read_text("utf-8"))
    assert "reference" not in text
    assert "0 of 0" not in text
    assert "the scenario expects nothing" in text
    assert not named(run_charts(alone, recording)["motion"], "reference")


def test_the_page_states_which_fmu_and_script_it_comes_from(runs: dict[str, Run], fmus: Fmus, tmp_path: Path) -> None:
    original, recording = runs["Synchronizer/polynomial"]
    s, fmu = replace(original, step_size=0.02), fmus.python("Synchronizer")
    write_report(tmp_path / "report.html", s, recording, evaluate_run(s, recording), fmu)
    text = words((tmp_path / "report.html").read_text("utf-8"))
    assert f"Synchronizer.fmu, FMI 2.0, python flavour, GUID {compute_guid(Recipe('Synchronizer'))}" in text
    assert "step size 0.02 s; outputs were recorded at 801 times up to 8 s" in text
    assert re.search(r"date \d{4}-\d\d-\d\d \d\d:\d\d:\d\d[+-]\d\d:\d\d motionsync \d", text)
    assert re.search(r"platform \w+ \S+, \w+, Python 3\.", text)
    assert s.file.read_text("utf-8").splitlines()[0].replace('"', "&#34;") in (tmp_path / "report.html").read_text(
        "utf-8"
    )
    head = "from position in deg velocity in deg/s acceleration in deg/s² jerk in deg/s³"
    assert f"{head} 0 s 0 90 0 0" in text
    assert "python flavour" in describe_fmu(fmu)


REACTING = """
title = "A <b>stop</b> </script> & more"
fmu = "Synchronizer"
stop_time = 1.0
step_size = 0.01
[start]
curve = "PARABOLA"
[master]
velocity = 100.0
[[on]]
when = "syn_ramp_on"
after = 0.05
set = { stop = true }
[[on]]
when = "slave.position > 1e6"
set = { rest_value = 5.0 }
"""


@pytest.fixture
def reacting(tmp_path: Path) -> Run:
    """A scenario with reactions that never happen, and with a title that is no HTML."""
    (tmp_path / "odd").mkdir()
    file = tmp_path / "odd" / "scenario.toml"
    file.write_text(REACTING, "utf-8")
    s = load_scenario(file)
    return s, run_in_process(s, s.step_size)


def test_a_reaction_that_never_happened_is_reported(reacting: Run, tmp_path: Path) -> None:
    text = words(page(reacting, tmp_path))
    assert "reaction to syn_ramp_on once: found never" in text
    assert "when after set how often syn_ramp_on 0.05 s stop = true once" in text
    assert "slave.position &gt; 1e6 at once rest_value = 5 mm once" in text


def test_what_reactions_set_is_listed_with_its_time(cyclic_cut: Run, tmp_path: Path) -> None:
    s, recording = cyclic_cut
    assert s.reactions
    text = words(page(cyclic_cut, tmp_path))
    lanes = run_charts(s, recording)["lanes"]
    (marks,) = named(lanes, "set")
    assert len(marks["x"]) == len(recording.settings) > len(s.settings)
    for number in (1, len(recording.settings)):
        setting = recording.settings[number - 1]
        name, value = next(iter(setting.values.items()))
        text_of_value = s.recipe.variables[name].text(value)
        assert f"{number} {setting.at:.10g} s {name} {text_of_value}" in text
        assert f"{name} = {text_of_value}" in marks["customdata"][number - 1]


def test_of_very_many_settings_the_table_lists_the_first_thousand(runs: dict[str, Run], tmp_path: Path) -> None:
    s, recording = runs["Synchronizer/polynomial"]
    given = [Setting(0.001 * i, {"rest_value": 10000.0 + i}) for i in range(1, 1502)]
    run = s, replace(recording, settings=given)
    text = words(page(run, tmp_path))
    assert "1501 times at which something was set" in text
    assert "1000 1 s rest_value 11000 deg and 501 more times, which the chart shows" in text
    (marks,) = named(run_charts(*run)["lanes"], "set")
    assert len(marks["x"]) == 1501


def test_the_texts_of_a_scenario_are_escaped(reacting: Run, tmp_path: Path) -> None:
    text = page(reacting, tmp_path)
    assert "<h1>A &lt;b&gt;stop&lt;/b&gt; &lt;/script&gt; &amp; more</h1>" in text
    assert "<b>stop" not in text
    assert text.count("<script") == text.count("</script>")


# --- charts ---


def test_every_colour_has_a_legend_or_a_key_and_a_text_at_the_pointer(runs: dict[str, Run], tmp_path: Path) -> None:
    for name, run in runs.items():
        text = page(run, tmp_path)
        for chart in run_charts(*run).values():
            for trace in chart.traces:
                colour = trace.get("fillcolor") or trace.get("marker", trace.get("line"))["color"]
                legend = [t["showlegend"] for t in named(chart, trace["name"])].count(True)
                key = f'style="background: var({colour})"' in text
                is_explained = "hovertemplate" in trace or "fill" in trace or trace["name"] in SHOWN_ELSEWHERE
                assert is_explained, (name, trace["name"])
                assert legend == 1 or key or colour in ("--true", "--ink") or isinstance(colour, list), trace["name"]


def test_the_times_are_those_of_the_scenario_and_stand_above_one_another(runs: dict[str, Run]) -> None:
    for s, recording in runs.values():
        charts = run_charts(s, recording).values()
        assert {tuple(c.layout["xaxis"]["range"]) for c in charts if c.timed} == {(0.0, s.stop_time)}
        assert len({(chart.layout["margin"]["l"], chart.layout["margin"]["r"]) for chart in charts}) == 1


def test_the_limits_of_the_axis_are_dashed_lines(cyclic_cut: Run) -> None:
    """Those of the file; an acceleration and a deceleration that are the same have one line on each side."""
    s, recording = cyclic_cut
    charts = run_charts(s, recording)
    expected = {
        ("y", -250.0),
        ("y", 800.0),
        *(("y2", sign * 1500.0) for sign in (1, -1)),
        *(("y3", sign * 10000.0) for sign in (1, -1)),
        *(("y4", sign * 200000.0) for sign in (1, -1)),
    }
    lines = named(charts["motion"], "limit of the axis")
    assert {(t["yaxis"], t["y"][0]) for t in lines} == expected
    assert all(t["line"]["dash"] == "dash" and t["x"] == [0.0, s.stop_time] for t in lines)
    assert [t["y"][0] for t in named(charts["cuts"], "limit of the axis")] == [-250.0, 800.0]
    for text in ("max_velocity 1500 mm/s", "max_jerk -200000 mm/s³", "min_position -250 mm"):
        assert text in notes(charts["motion"])


def test_the_names_of_limits_are_beyond_all_curves(cyclic_cut: Run) -> None:
    """An upper limit has its name above its line, a lower one below it, and the axis reaches so far."""
    motion = run_charts(*cyclic_cut)["motion"]
    limits = [note for note in motion.layout["annotations"] if str(note["text"]).startswith(("max_", "min_"))]
    assert len(limits) == 8
    for note in limits:
        is_upper = note["y"] > 0.0
        assert note["yanchor"] == ("bottom" if is_upper else "top")
        reached = motion.layout[note["yref"].replace("y", "yaxis")]["autorangeoptions"]["include"]
        assert any(value > 1.05 * note["y"] if is_upper else value < 1.05 * note["y"] for value in reached)


def test_values_that_were_set_have_their_units_and_the_file_no_folder_of_this_computer(
    cyclic_cut: Run, tmp_path: Path
) -> None:
    s, recording = cyclic_cut
    write_report(tmp_path / "report.html", s, recording, evaluate_run(s, recording))
    page = (tmp_path / "report.html").read_text("utf-8")
    assert '<td class="name">axis.max_velocity</td><td>1500 mm/s</td>' in page
    assert '<td class="name">gear_in_pos.execute</td><td>true</td>' in page
    limits = page.partition("The limits in use")[2].partition("</table>")[0]
    assert '<td class="name">axis.max_velocity</td><td>1500 mm/s</td><td>set</td>' in limits
    assert '<td class="name">axis.max_deceleration</td>' in limits
    assert str(s.file.parent.parent) not in page.partition("Where this comes from")[2].partition("</table>")[0]
    assert str(Path("cyclic_cut") / "scenario.toml") in page


def test_a_limit_far_from_what_is_shown_is_not_drawn(cyclic_cut: Run) -> None:
    s, recording = cyclic_cut
    far = replace(s, start={**s.start, "axis.max_velocity": 1e5, "axis.max_position": 1e5})
    lines = named(run_charts(far, recording)["motion"], "limit of the axis")
    assert {t["yaxis"] for t in lines} == {"y", "y3", "y4"}
    assert [t["y"][0] for t in lines if t["yaxis"] == "y"] == [-250.0]


def test_a_block_without_limits_shows_none(runs: dict[str, Run]) -> None:
    assert not named(run_charts(*runs["Gearing/ccw_direct"])["motion"], "limit of the axis")


def test_the_reference_is_drawn_as_the_samples_that_it_is(runs: dict[str, Run]) -> None:
    s, recording = runs["Synchronizer/polynomial"]
    reference = read_reference(s)
    assert reference
    names, rows = reference
    chart = run_charts(s, recording)["motion"]
    for axis, name in (
        ("y", "slave.position"),
        ("y2", "slave.velocity"),
        ("y3", "slave.acceleration"),
        ("y4", "slave.jerk"),
    ):
        (trace,) = named(chart, "reference", axis)
        assert trace["mode"] == "markers"
        every = round(len(rows) / len(trace["x"]))
        assert trace["x"] == pytest.approx(rows[::every, 0], rel=1e-8)
        assert trace["y"] == pytest.approx(rows[::every, 1 + names.index(name)], rel=1e-6, abs=1e-9)


def test_a_saw_is_not_drawn_over_the_axis_of_an_endless_material(cyclic_cut: Run) -> None:
    """The material goes 30 m, the saw 0.6 m: each has its own axis. The slave of a Synchronizer shares the master's."""
    s, recording = cyclic_cut
    chart = run_charts(s, recording)["motion"]
    (saw,) = named(chart, "slave", "y")
    (right,) = [t for t in named(chart, "master") if t["yaxis"] not in ("y2", "y3", "y4")]
    assert right["yaxis"] != "y"
    assert chart.layout[right["yaxis"].replace("y", "yaxis")]["side"] == "right"
    assert {"slave position in mm", "master in mm"} <= set(notes(chart))
    assert max(saw["y"]) == pytest.approx(recording.values["slave.position"].max(), rel=1e-6)


def test_axes_of_one_range_share_it(runs: dict[str, Run]) -> None:
    chart = run_charts(*runs["Synchronizer/polynomial"])["motion"]
    assert len(named(chart, "master", "y")) == len(named(chart, "slave", "y")) == 1


def test_rounding_is_not_drawn_large(cyclic_cut: Run) -> None:
    """A jerk of 1e-9 mm/s3, with positions of 30 m, is 0; one of 1 mm/s3 is not."""
    s, recording = cyclic_cut
    still = np.zeros_like(recording.master)
    still[:, 0] = recording.master[:, 0]
    for size, rounding in ((1e-9, True), (1.0, False)):
        values = {**recording.values, "slave.jerk": size * np.sin(recording.time)}
        chart = run_charts(replace(s, file=Path("none"), start={}), replace(recording, values=values, master=still))[
            "motion"
        ]
        rounding_notes = [text for text in notes(chart) if text.startswith("0 to rounding: at most 1e-9")]
        assert (chart.axis(4).get("range") == [-1.0, 1.0]) == rounding
        assert bool(rounding_notes) == rounding
        assert ("yaxis4" in chart.layout["meta"]["rescaled"]) != rounding


def test_errors_of_cuts_are_shown_with_the_tolerance(cyclic_cut: Run) -> None:
    """They are rounding here: the plot has the height of the tolerance. With 0.05 mm off it shows 0.05 mm."""
    s, recording = cyclic_cut
    chart = run_charts(s, recording)["cuts"]
    assert chart.axis(2)["range"] == pytest.approx([-1.3e-9, 1.3e-9])
    assert [t["y"][0] for t in named(chart, "tolerance")] == [-1e-9, 1e-9]
    (errors,) = named(chart, "error of a cut")
    assert len(errors["x"]) == 20
    assert errors["customdata"][0][2] == "0 (to rounding)"
    assert s.cuts
    off = {**recording.values, "slave.position": recording.values["slave.position"] - 0.05}
    chart = run_charts(replace(s, cuts=replace(s.cuts, tolerance=0.04)), replace(recording, values=off))["cuts"]
    (errors,) = named(chart, "error of a cut")
    assert errors["y"] == pytest.approx([0.05] * 20)
    assert errors["customdata"][1][1:] == [f"{errors['customdata'][1][1]}", "0.05 mm"]
    assert set(errors["marker"]["color"]) == {"--bad"}
    assert "range" not in chart.axis(2)


@pytest.mark.parametrize("ratio", [1.0, -0.5, 2.0])
def test_marks_pass_the_saw_where_they_are(ratio: float) -> None:
    """Marks at 5 + 30 n on a material that goes from 0 to 100 in 10 s: seen from the saw, a mark p is at ratio (m - p).
    The window of the saw is 70 wide, so that several marks are in it at once; no point is on its edges."""
    time = np.linspace(0.0, 10.0, 1001)
    master = np.zeros((1001, 4))
    master[:, 0] = 10.0 * time
    spec = CutSpec("cut", 30.0, 5.0, ratio, 0.1, None)
    passing = list(passages(spec, Recording(time, {}, master, []), -30.003, 39.997))
    expected = {}
    for n in range(-10, 20):
        seen = ratio * (master[:, 0] - 5.0 - 30.0 * n)
        if (inside := (seen > -30.003) & (seen < 39.997)).any():
            expected[n] = (time[inside], seen[inside])
    assert sorted(p.number for p in passing) == sorted(expected)
    for p in passing:
        assert p.place == 5.0 + 30.0 * p.number
        assert p.time == pytest.approx(expected[p.number][0])
        assert p.position == pytest.approx(expected[p.number][1])


def test_marks_that_nobody_cut_stand_out(cyclic_cut: Run) -> None:
    s, recording = cyclic_cut
    names = {t["name"] for t in run_charts(s, recording)["cuts"].traces}
    assert "marks on the material" in names
    assert "marks that passed uncut" not in names
    values = {**recording.values, "in_sync": recording.values["in_sync"] * (recording.time < 10.0)}
    chart = run_charts(s, replace(recording, values=values))["cuts"]
    (missed,) = named(chart, "marks that passed uncut")
    assert missed["line"]["color"] == "--bad"
    assert min(x for x in missed["x"] if x is not None) > 10.0


@pytest.mark.parametrize(("until", "uncut"), [(240.0, 0), (237.0, 2), (231.0, 6)])
def test_of_very_many_marks_only_those_are_drawn_that_nobody_cut(until: float, uncut: int) -> None:
    """1.5 m at 1000 mm/s: 160 marks in 240 s. Cuts are taken out of the recording from a time on."""
    time = np.arange(0.0, 240.01, 0.01)
    master = np.zeros((len(time), 4))
    master[:, 0], master[:, 1] = 1000.0 * time, 1000.0
    phase = master[:, 0] % 1500.0
    saw = np.where(phase < 750.0, phase, 1500.0 - phase)  # out with the mark, and back
    s = replace(
        load_scenario(ROOT / "scenarios" / CYCLIC_CUT / "scenario.toml"),
        cuts=CutSpec("in_sync", 1500.0, 0.0, 1.0, 1e-6, None),
        stop_time=240.0,
    )
    cutting = (phase > 300.0) & (phase < 500.0) & (time < until)
    zeros = dict.fromkeys((v.name for v in s.recipe.variables.values() if not v.settable), np.zeros(len(time)))
    values = zeros | {"slave.position": saw, "in_sync": cutting.astype(float)}
    chart = run_charts(s, Recording(time, values, master, []))["cuts"]
    assert not [t for t in chart.traces if t["name"] == "marks on the material"]
    lines = [t for t in chart.traces if t["name"] == "marks that passed uncut"]
    marks = {mark for t in lines for mark in t["customdata"]}
    assert len(marks) == uncut
    (note,) = [n["text"] for n in chart.layout["annotations"] if "marks pass" in n["text"]]
    assert note.endswith(f"those without a cut, {uncut}, are drawn" if uncut else "too many to draw")


# --- lanes ---


def test_variables_that_are_always_the_same_share_a_lane(cyclic_cut: Run) -> None:
    """Each enumeration and Boolean that changes has exactly one lane, and no two lanes show the same."""
    s, recording = cyclic_cut
    by_name = s.recipe.variables
    same: dict[tuple[str, bytes], list[str]] = {}
    for name, values in recording.values.items():
        v = by_name[name]
        if v.kind in ("Enumeration", "Boolean") and (np.ptp(values) or name == "state"):
            same.setdefault((v.cell.type.__name__, values.tobytes()), []).append(name)
    chart = run_charts(s, recording)["lanes"]
    titles = notes(chart)
    assert len(titles) == len(same) + 1  # and that of what was set
    assert "gear_in_pos.busy = .active" in titles
    for group in same.values():
        assert len([t for t in titles if t.split(" = ")[0] == group[0] and t.count(" = ") == len(group) - 1]) == 1


def test_states_are_shaded_with_the_colours_of_their_key(cyclic_cut: Run, tmp_path: Path) -> None:
    s, recording = cyclic_cut
    text = page(cyclic_cut, tmp_path)
    charts = run_charts(s, recording)
    (lane,) = [t["y"][0] for t in charts["lanes"].traces if t["name"] == "SYNCHRON" and t["type"] == "bar"]
    bars = {t["name"]: t["marker"]["color"] for t in charts["lanes"].traces if t["type"] == "bar" and t["y"][0] == lane}
    seen = {s.recipe.variables["state"].text(x) for x in np.unique(recording.values["state"])}
    assert bars.keys() == seen
    assert len(set(bars.values())) == len(seen)
    assert {t["fillcolor"] for t in named(charts["motion"], "state")} == set(bars.values())
    for name, colour in bars.items():
        assert f'<i style="background: var({colour})"></i>{name}</span>' in text


def test_lines_at_what_was_set_thin_out(cyclic_cut: Run) -> None:
    s, recording = cyclic_cut
    for number, lines in ((40, 40), (41, 0)):
        settings = [replace(recording.settings[0], at=0.1 * i) for i in range(number)]
        chart = run_charts(s, replace(recording, settings=settings))["motion"]
        assert len([shape for shape in chart.layout["shapes"] if shape["line"]["dash"] == "dot"]) == lines


# --- points ---


def test_a_long_run_stays_small(cyclic_cut: Run) -> None:
    """Forty times as long: no curve has more points than a screen shows, and its greatest value is among them."""
    s, recording = cyclic_cut
    time = np.concatenate([recording.time + i * s.stop_time for i in range(40)]) + 1e-9 * np.arange(
        40 * len(recording.time)
    )
    values = {name: np.tile(column, 40) for name, column in recording.values.items()}
    values["slave.velocity"][123_456] = 1499.0
    long = Recording(time, values, np.tile(recording.master, (40, 1)), [])
    charts = run_charts(replace(s, stop_time=40.0 * s.stop_time), long)
    for chart in charts.values():
        for trace in chart.traces:
            assert len(trace["x"]) <= 9000, trace["name"]
    (velocity,) = named(charts["motion"], "slave", "y2")
    assert max(velocity["y"]) == 1499.0
    assert len(json.dumps([chart.as_json() for chart in charts.values()])) < 2_000_000


def test_the_extremes_and_what_is_to_be_kept_are_drawn() -> None:
    values = np.sin(np.linspace(0.0, 50.0, 100_000))
    values[54_321], values[77_777] = 7.0, -3.0
    chosen = thinned(values, np.array([11, 99_998]))
    assert len(chosen) < 3100
    assert {0, 11, 54_321, 77_777, 99_998, 99_999} <= set(chosen.tolist())
    assert thinned(values[:3000]).tolist() == list(range(3000))


def test_numbers_have_seven_digits_and_gaps_are_null() -> None:
    assert rounded([1.0, 2.0 / 3.0, 123456.789, 3.6e-12, np.nan]) == [1, 0.6666667, 123456.8, 3.6e-12, None]
    assert json.dumps(rounded([1.0, 0.25])) == "[1, 0.25]"


def test_a_wrapped_position_has_a_gap_where_it_jumps() -> None:
    """100 deg/s for 5 s, with a period of 180 deg: the jumps are at 1.8 s and 3.6 s."""
    time = np.linspace(0.0, 5.0, 501)
    position, velocity = (100.0 * time + 1e-9) % 180.0, np.full(501, 100.0)
    gaps = jumps(time, position, velocity)
    assert time[gaps] == pytest.approx([1.8, 3.6])
    x, y = points(time, position, gaps=gaps)
    assert [x[i] for i in range(len(y)) if y[i] is None] == pytest.approx([1.8, 3.6])
    assert len(y) == 503
    assert not len(jumps(time, 100.0 * time, velocity))


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("mm/s2", "mm/s²"),
        ("200000 mm/s3", "200000 mm/s³"),
        ("1/deg2", "1/deg²"),
        ("2 mm", "2 mm"),
        ("mm", "mm"),
        ("3.6e-12 mm", "3.6e-12 mm"),
    ],
)
def test_powers_of_units_are_raised(text: str, printed: str) -> None:
    assert typeset(text) == printed


def test_the_script_offers_no_button_that_sends_data() -> None:
    """plotly.js has one, `sendChartToCloud`; the list of buttons is the page's own."""
    text = load_template(TEMPLATES, "plots.js").render()
    (buttons,) = re.findall(r"modeBarButtons: \[\[(.*?)\]\]", text)
    assert set(re.findall(r'"(\w+)"', buttons)) == {
        "toImage",
        "zoom2d",
        "pan2d",
        "zoomIn2d",
        "zoomOut2d",
        "resetScale2d",
    }
    assert 'plotlyServerURL: ""' in text
