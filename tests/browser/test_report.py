"""The report of a run in a browser: plots and machine show what the recording has, and share their time."""

import csv
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from tests.browser.charts import ChartView
from tests.browser.conftest import AtRest, Open, OpenReport, drawn
from tests.browser.runs import run
from tests.browser.visit import Visit, contrast
from tests.support.blocks.knife_runs import run_knife

CYCLIC_CUT = "FlyingSaw/cyclic_cut"
PIECES = "CutToLength/cyclic_orders"
ALL = (
    CYCLIC_CUT,
    PIECES,
    "CutToLength/measured_line",
    "FlyingSaw/diagonal_saw",
    "Follower/cyclic_through",
    "Follower/linear_wait_in_park",
    "Gearing/ccw_direct",
    "RemoteSync/accelerating_axis",
    "Synchronizer/polynomial",
)
MOTION, CUTS, LANES = "Motion of the slave", "The saw and the passing marks", "States"

FITTED = """document.documentElement.scrollWidth <= document.documentElement.clientWidth
  && [...document.querySelectorAll('.plot')].every((e) =>
    Math.abs(e.querySelector('.main-svg').getBoundingClientRect().width - e.clientWidth) < 1)"""
DRAWN = "new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)))"  # all that has been asked for


def recorded(name: str, variable: str, time: float) -> float:
    """A recorded output at a time."""
    _, recording = run(name)
    return float(np.interp(time, recording.time, recording.values[variable]))


@pytest.mark.parametrize("name", ALL)
def test_all_charts_are_drawn_with_their_legends_and_fit_their_window(open_report: OpenReport, name: str) -> None:
    """Offline; and no page has said a word (see `open_page`)."""
    visit = open_report(name)
    motion = ChartView(visit, MOTION)
    followed = "remote axis" if name.startswith("RemoteSync") else "master"
    assert {"slave", followed} <= set(motion.legend)
    assert motion.traces >= 8
    assert ChartView(visit, LANES).traces >= 1
    assert visit.page.locator(".motionsync-machine svg > g").count() >= 2
    if run(name)[0].cuts:
        assert "saw" in ChartView(visit, CUTS).legend
    for width in (1100, 320):
        visit.page.set_viewport_size({"width": width, "height": 900})
        visit.page.wait_for_function("document.documentElement.scrollWidth <= document.documentElement.clientWidth")


def test_the_pointer_over_the_pieces_shows_the_requested_velocity(at_rest: AtRest) -> None:
    """All rows are shown together: position of the saw, velocity of the line, requested velocity, and limit."""
    visit = at_rest(PIECES)
    chart = ChartView(visit, "Pieces passing")
    assert {"saw", "line", "requested velocity", "limit of the line", "tolerance"} <= set(chart.legend)
    time, values = chart.hover_values(8.0)
    assert values["saw"] == pytest.approx(recorded(PIECES, "slave.position", time), rel=1e-4, abs=1e-3)
    for name in ("line.velocity_request", "limits.max_line_velocity"):
        assert values[name] == pytest.approx(recorded(PIECES, name, time), rel=1e-4)


@pytest.mark.parametrize("name", [CYCLIC_CUT, "Gearing/ccw_direct", "Synchronizer/polynomial"])
def test_the_pointer_shows_the_slave_s_values(at_rest: AtRest, name: str) -> None:
    """Five significant digits, at a point that is drawn: points between are left out where nobody would see them."""
    visit = at_rest(name)
    chart = ChartView(visit, MOTION)
    stop = run(name)[0].stop_time
    for share in (0.21, 0.5, 0.83):
        time, values = chart.hover_values(share * stop)
        assert time == pytest.approx(share * stop, abs=0.01 * stop)
        for quantity in ("position", "velocity"):
            expected = recorded(name, f"slave.{quantity}", time)
            assert values[f"slave {quantity}"] == pytest.approx(expected, rel=1e-4, abs=1e-3)


def download_table(visit: Visit, name: str, folder: Path) -> list[dict[str, str]]:
    """The rows of the file that the button of a chart saves."""
    frame = ChartView(visit, name).frame
    frame.hover()
    with visit.page.expect_download() as download:
        frame.locator("[data-title='Download as CSV']").click()
    download.value.save_as(folder / "chart.csv")
    with (folder / "chart.csv").open() as file:
        return list(csv.DictReader(file))


def test_the_curves_of_a_chart_are_saved_as_csv(at_rest: AtRest, tmp_path: Path) -> None:
    """Seven digits, at the points that are drawn; the line has one column for each of its curves."""
    visit = at_rest(PIECES)
    for name, heading, variable in (
        (MOTION, "slave velocity in mm/s", "slave.velocity"),
        ("Pieces passing", "line.velocity_request in mm/s", "line.velocity_request"),
    ):
        rows = [(float(row["time in s"]), row[heading]) for row in download_table(visit, name, tmp_path)]
        assert rows == sorted(rows, key=lambda row: row[0])
        times, values = zip(*((time, float(value)) for time, value in rows if value), strict=True)
        assert len(times) > 1000
        _, recording = run(PIECES)
        at = np.searchsorted(recording.time, np.array(times) - 1e-6)
        assert recording.time[at] == pytest.approx(times, abs=1e-7)
        assert recording.values[variable][at] == pytest.approx(values, rel=1e-6, abs=1e-9)


def test_the_bars_of_a_chart_are_saved_as_csv(at_rest: AtRest, tmp_path: Path) -> None:
    """A row for each time at which one of them changes, or something is set, has the values of all from then on, the
    last row those of the end; what was set has a text at its time only."""
    rows = download_table(at_rest(PIECES), LANES, tmp_path)
    scenario, recording = run(PIECES)
    times = [float(row["time in s"]) for row in rows]
    assert times == sorted(set(times))
    assert times[-1] == scenario.stop_time
    at = np.searchsorted(recording.time, np.array(times) - 1e-6)[:-1]
    states = {member.value: member.name for member in scenario.recipe.variables["state"].choices}
    assert [row["state"] for row in rows[:-1]] == [states[i] for i in recording.values["state"][at]]
    assert rows[-1]["state"] == states[recording.values["state"][-1]]
    (in_sync,) = [name for name in rows[0] if "in_sync" in name.split(" = ")]
    assert [row[in_sync] == "true" for row in rows[:-1]] == recording.values["in_sync"][at].astype(bool).tolist()
    assert {row[in_sync] for row in rows} == {"true", "false"}
    changed = [at for at, before in zip(rows[1:-1], rows[:-2], strict=True) if at["state"] != before["state"]]
    assert len(changed) == np.count_nonzero(np.diff(recording.values["state"]))
    *settings, reaction = [(float(row["time in s"]), row["what was set"]) for row in rows if row["what was set"]]
    assert [at for at, _ in settings] == [setting.at for setting in scenario.settings]
    assert settings[0][1] == "order.add = true, order.length = 1500 mm, order.quantity = 4"
    assert reaction[1] == "stop = true, line.wanted_velocity = 0 mm/s"


PAPER = {"width": 703, "height": 1031}  # px: what the margins leave of A4, 186 mm by 273 mm


@pytest.mark.parametrize("name", [PIECES, "CutToLength/measured_line"])
def test_printed_charts_are_whole_and_as_wide_as_the_paper(open_report: OpenReport, name: str) -> None:
    """Each chart is lower than a page, and no page ends in it."""
    visit = open_report(name, width=PAPER["width"])
    assert len(visit.page.pdf(prefer_css_page_size=True)) > 50_000
    visit.page.emulate_media(media="print")
    visit.page.evaluate("dispatchEvent(new Event('beforeprint'))")
    look = """all => all.map(e => {
      const svg = e.querySelector('.main-svg') ?? e.querySelector('svg');
      const box = e.getBoundingClientRect(), drawn = svg.getBoundingClientRect();
      return [box.height, drawn.width / box.width, getComputedStyle(e).breakInside];
    })"""
    right = visit.page.locator(".plot").evaluate_all("all => all.map(e => [e.ariaLabel, e._fullLayout._size.r])")
    assert all(margin <= 20.0 or label.startswith(MOTION) for label, margin in right)  # the motion has numbers there
    looks = visit.page.locator(".plot, .motionsync-machine").evaluate_all(look)
    assert len(looks) >= 5
    for height, share, rule in looks:
        assert height < PAPER["height"]
        assert 0.96 < share <= 1.0
        assert rule == "avoid"


def test_the_machine_follows_the_pointer(at_rest: AtRest) -> None:
    """A px is 36 ms of the cyclic cut; the other charts show a cursor there, the one under the pointer has its own."""
    visit = at_rest(CYCLIC_CUT)
    motion, cuts = ChartView(visit, MOTION), ChartView(visit, CUTS)
    motion.point(12.0)
    visit.page.wait_for_function("Math.abs(document.querySelector('.motionsync-machine').dataset.time - 12) < 0.05")
    visit.page.evaluate(DRAWN)
    assert visit.number(".carriage", "slave-position") == pytest.approx(
        recorded(CYCLIC_CUT, "slave.position", visit.time), abs=0.1
    )
    assert cuts.cursor == pytest.approx(visit.time, abs=0.05)
    assert motion.cursor is None


def test_the_plots_follow_the_machine(at_rest: AtRest) -> None:
    visit = at_rest(CYCLIC_CUT)
    charts = [ChartView(visit, name) for name in (MOTION, CUTS, LANES)]
    for t in (3.7, 21.0):
        visit.show(t)
        visit.page.evaluate(DRAWN)
        assert [chart.cursor for chart in charts] == pytest.approx([t] * 3, abs=0.05)


def test_the_slider_moves_the_saw_and_the_cursor(at_rest: AtRest) -> None:
    visit = at_rest(CYCLIC_CUT)
    motion = ChartView(visit, MOTION)
    slider = visit.page.get_by_role("slider", name="Time")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    visit.page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + box["height"] / 2)
    visit.page.mouse.down()
    visit.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2, steps=8)
    visit.page.mouse.up()
    visit.page.evaluate(DRAWN)
    assert visit.time == pytest.approx(0.6 * run(CYCLIC_CUT)[0].stop_time, abs=0.6)
    shown = visit.number(".carriage", "slave-position")
    assert shown == pytest.approx(recorded(CYCLIC_CUT, "slave.position", visit.time), abs=0.1)
    assert visit.page.locator(".motionsync-machine output").inner_text() == f"{visit.time:.3f} s"
    assert motion.cursor == pytest.approx(visit.time, abs=0.05)


def test_playing_moves_saw_and_cursor(at_rest: AtRest) -> None:
    """In real time: the plots keep up, a picture takes far less than the 0.1 s that playing makes up for."""
    visit = at_rest(CYCLIC_CUT)
    motion = ChartView(visit, MOTION)
    visit.listen()
    visit.page.get_by_role("button", name="Play").click()
    visit.page.wait_for_function("+document.querySelector('.motionsync-machine').dataset.time > 1")
    visit.page.get_by_role("button", name="Pause").click()
    visit.page.evaluate(DRAWN)
    assert motion.cursor == pytest.approx(visit.time, abs=0.05)
    assert len(visit.notified_times()) >= 10


def test_dark_mode_changes_page_plots_and_machine_and_back(open_report: OpenReport) -> None:
    visit = open_report(CYCLIC_CUT)
    seen = {}
    for scheme in ("light", "dark", "light"):
        visit.page.emulate_media(color_scheme=scheme)
        visit.page.evaluate(DRAWN)
        plot = visit.page.locator(".plot .main-svg").first.evaluate("e => getComputedStyle(e).backgroundColor")
        saw = visit.page.locator(".carriage rect[rx='5']").evaluate("e => getComputedStyle(e).fill")
        line = visit.page.locator(".plot .scatterlayer .trace path.js-line").last.evaluate("e => e.style.stroke")
        looks = (*visit.colours("body"), plot, saw, line)
        assert seen.setdefault(scheme, looks) == looks
        assert contrast(*visit.colours("body")) > 7.0
    assert all(light != dark for light, dark in zip(seen["light"], seen["dark"], strict=True))


def test_a_chart_in_a_window_that_gets_wider_has_its_legend_above_it(open_report: OpenReport) -> None:
    """As on a telephone that is turned, and after printing. A curve that is hidden stays so, also in other colours."""
    visit = open_report("Follower/cyclic_through", width=390)
    page, chart = visit.page, ChartView(visit, MOTION)
    curves, item = chart.traces, chart.frame.locator(".legend .traces").last
    item.locator(".legendtoggle").click()
    page.wait_for_function(
        "([frame, count]) => frame.querySelectorAll('.trace').length < count",
        arg=[chart.frame.element_handle(), curves],
    )
    left = chart.traces
    changes = (
        lambda: page.set_viewport_size({"width": 844, "height": 390}),
        lambda: page.evaluate("['beforeprint', 'afterprint'].forEach((name) => dispatchEvent(new Event(name)))"),
        lambda: page.emulate_media(color_scheme="dark"),
    )
    for change in changes:
        change()
        page.wait_for_function(FITTED)
        page.evaluate(DRAWN)
        legend, row = (chart.frame.locator(part).first.bounding_box() for part in (".legend .bg", ".nsewdrag"))
        assert legend["y"] + legend["height"] < row["y"]
        assert chart.traces == left
        assert item.evaluate("e => getComputedStyle(e).opacity") == "0.5"


@pytest.mark.parametrize("width", [1280, 390])
def test_no_texts_over_the_pieces_touch(open_report: OpenReport, width: int) -> None:
    """The numbers of the pieces, and the names of the limits; a wide window has each number, a narrow one some."""
    visit = open_report(PIECES, width=width)
    assert visit.overflow() <= 0.0
    frame = visit.page.locator(".plot[aria-label^='Pieces passing']")
    box = "const b = e.getBoundingClientRect(); return [e.textContent, b.x, b.right, b.y, b.bottom];"
    notes = f"all => all.map(e => {{ {box} }})"
    boxes = frame.locator(".annotation-text").evaluate_all(notes)
    upper = [box for box in boxes if box[0].isdigit() or box[0].startswith(("max_position", "min_position"))]
    numbers = [int(box[0]) for box in upper if box[0].isdigit()]
    assert numbers[0] == 1
    assert len(numbers) >= (15 if width == 1280 else 5)
    for i, (_, left, right, top, bottom) in enumerate(upper):
        for _, other_left, other_right, other_top, other_bottom in upper[:i]:
            assert left >= other_right or other_left >= right or top >= other_bottom or other_top >= bottom


@pytest.mark.parametrize(
    ("name", "chart"),
    [
        ("CutToLength/measured_line", "Histogram of the true length errors"),
        ("CutToLength/measured_line", "The axis and its motor over time"),
        ("RotaryKnife/formats", MOTION),
    ],
)
def test_a_curve_is_drawn_through_all_its_points(at_rest: AtRest, name: str, chart: str) -> None:
    """A line through a few of them has corners. What lies beyond the plot is not drawn."""
    counts = """frame => [
      frame.data.filter(({mode}) => mode === "lines").map(({y}) => y.filter((v) => v !== null).length),
      [...frame.querySelectorAll("path.js-line")].map((path) => path.getAttribute("d").match(/[MLHV]/g).length)]"""
    values, drawn_points = ChartView(at_rest(name), chart).frame.evaluate(counts)
    assert sum(drawn_points) > 0.9 * sum(values)


@pytest.mark.parametrize("width", [1280, 390])
def test_no_text_of_a_real_machine_is_hidden(open_report: OpenReport, width: int) -> None:
    """Neither cut off at the border of a chart, nor on another text."""
    visit = open_report("CutToLength/measured_line", width=width)
    assert visit.overflow() <= 0.0
    for name, text in (
        ("Pieces passing", "0 for each product"),
        ("Histogram of the true length errors", "0.1 mm"),
        ("True length errors over time", "tolerance 0.1 mm"),
        ("The axis and its motor", "continuous 900 N"),
        ("Force over velocity", "peak 3000 N"),
    ):
        chart = ChartView(visit, name)
        assert text in chart.texts
        assert chart.hidden_texts() == [], name


@pytest.mark.parametrize(("count", "first"), [(1, 1), (20, 7), (125, 50), (500, 130)])
def test_no_text_of_a_report_touches_another_one_however_many_pieces_there_are(
    open_page: Open, tmp_path: Path, count: int, first: int
) -> None:
    scenario, recording = run_knife(tmp_path, count, first)
    report = tmp_path / "report.html"
    write_report(report, scenario, recording, evaluate_run(scenario, recording))
    visit = drawn(open_page(report, width=1280))
    for width in (1280, 390):
        visit.page.set_viewport_size({"width": width, "height": 900})
        visit.page.wait_for_function(FITTED)
        visit.page.evaluate(DRAWN)
        for label in visit.page.locator(".plot").evaluate_all("all => all.map(e => e.getAttribute('aria-label'))"):
            assert ChartView(visit, label).hidden_texts() == [], (width, label)
        motion = visit.page.locator(f".plot[aria-label^='{MOTION}'] .scatterlayer path.js-line")
        assert motion.evaluate_all("all => all.filter(e => e.getAttribute('d')).length") >= 8
