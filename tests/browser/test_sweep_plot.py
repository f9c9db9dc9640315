"""The page of a sweep, in a real browser."""

import shlex
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.sweeps.plot.page import make_page
from motionsync_fmu.sweeps.plot.view import Question
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.browser.charts import ChartView
from tests.browser.conftest import Open
from tests.browser.visit import Visit, contrast
from tests.sweeps import example_plans

V, A, LENGTH = "master.velocity", "axis.max_acceleration", "length"
MAP, BOUNDARY = ".plot[aria-label^='The share']", ".plot[aria-label^='The least']"
HISTOGRAM = ".plot[aria-label^='Histogram']"


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """15 velocities, 3 accelerations, 30 lengths, 2 times of a cut."""
    folder = tmp_path_factory.mktemp("sweep")
    example_plans.sweep(folder, 15, 3, 30, 2)
    make_page(folder, Question(V, LENGTH, A))
    make_page(folder, Question("slave.velocity.max", "slave.acceleration.max"), folder / "front.html")
    return folder


@pytest.fixture(scope="module")
def monte_carlo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """300 seeds of the measured line; of all products one is out of tolerance: it is of run 7, 0.12 mm too short."""
    folder = tmp_path_factory.mktemp("seeds")
    example_plans.seeds(folder, 300)
    return make_page(folder, Question("true_length_errors"))


def at(visit: Visit, chart: str, right: float, up: float) -> tuple[float, float]:
    """A place of the plot in a chart, as shares of its width and height, in px of the window."""
    frame = visit.page.locator(chart)
    frame.scroll_into_view_if_needed()
    box = frame.locator(".nsewdrag").first.bounding_box()
    return box["x"] + right * box["width"], box["y"] + (1.0 - up) * box["height"]


def point(visit: Visit, chart: str, right: float, up: float) -> None:
    visit.page.mouse.move(*at(visit, chart, right, up))


def shown_text(visit: Visit) -> str:
    return str(visit.page.locator(".picked .where").inner_text())


def given(visit: Visit) -> dict[str, str]:
    """What the command that is shown sets."""
    words = shlex.split(visit.page.locator(".picked code").inner_text())
    assert words[:2] == ["motionsync", "run"]
    assert words[3::2] == ["--set"] * len(words[4::2])
    return dict(word.split("=", 1) for word in words[4::2])


def colour(visit: Visit, right: float, up: float) -> list[int]:
    """The colour of the map's picture at a place of the plot."""
    look = """async ([right, up]) => {
        const image = new Image();
        image.src = document.querySelector(".plot image").getAttribute("href");
        await image.decode();
        const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
        const pen = canvas.getContext("2d");
        pen.drawImage(image, 0, 0);
        return [...pen.getImageData(right * image.width, (1 - up) * image.height, 1, 1).data].slice(0, 3);
    }"""
    return list(visit.page.evaluate(look, [right, up]))


def test_a_cell_shows_its_runs_and_the_command_that_repeats_one(open_page: Open, sweep: Path) -> None:
    """In the middle of the map is velocity number 7 of 15, 800 mm/s, and length 15 of 30, 1600 mm: 6 runs. With 2000
    mm/s2 and 0.4 s it takes 800 (0.4 + 0.88) + 50 = 1074 mm: all of them pass."""
    visit = open_page(sweep / "plot.html")
    point(visit, MAP, 0.5, 0.51)
    assert shown_text(visit) == "master.velocity 800 mm/s, length 1600 mm: 6 runs, 100 % passed"
    values = given(visit)
    plan = SweepPlan.read(sweep)
    number = int("".join(c for c in visit.page.locator(".picked .good").inner_text() if c.isdigit()))
    assert {name: float(text) for name, text in values.items()} == {
        name: of_run[0] for name, of_run in plan.values(number, number + 1).items()
    }
    assert load(plan.file, set=values).start["length"] == 1600.0


def test_a_curve_shows_the_run_at_it(open_page: Open, sweep: Path) -> None:
    """Near the top on the right is the line of 2000 mm/s2: at 1500 mm/s it takes 3125 mm, more than any length; at
    1400 mm/s 1400 (0.4 + 1.54) + 50 = 2766 mm, so 2800 mm."""
    visit = open_page(sweep / "plot.html")
    point(visit, BOUNDARY, 0.93, 0.95)
    assert shown_text(visit).startswith("axis.max_acceleration 2000 mm/s², master.velocity 1400 mm/s: least length")
    assert "2800 mm" in shown_text(visit)
    assert float(given(visit)["length"]) == 2800.0
    assert visit.page.locator(f"{MAP} .chosen.column").is_visible()  # the same velocity in the other chart


def test_the_map_has_the_colours_of_the_screen(open_page: Open, sweep: Path) -> None:
    """Above the boundary all pass, far below it none does: the ends of the scale, also when the screen changes."""
    visit = open_page(sweep / "plot.html", color_scheme="light")
    visit.page.locator(f"{MAP} image").wait_for()
    assert (colour(visit, 0.5, 0.9), colour(visit, 0.9, 0.05)) == ([0x24, 0x74, 0xB0], [0xB8, 0x43, 0x1C])
    light = visit.page.locator(f"{MAP} image").get_attribute("href")
    visit.page.emulate_media(color_scheme="dark")
    visit.page.wait_for_function(
        f"light => document.querySelector(`{MAP} image`)?.getAttribute('href') !== light", arg=light
    )
    assert (colour(visit, 0.5, 0.9), colour(visit, 0.9, 0.05)) == ([0x4C, 0x9F, 0xE0], [0xE8, 0x68, 0x3A])


def test_a_click_holds_a_cell_so_that_its_command_can_be_copied(open_page: Open, sweep: Path) -> None:
    """Escape lets it go."""
    visit = open_page(sweep / "plot.html")
    visit.allow("clipboard-read", "clipboard-write")
    place = at(visit, MAP, 0.5, 0.51)
    visit.page.mouse.click(*place)
    held = shown_text(visit)
    assert "800 mm/s" in held
    point(visit, MAP, 0.8, 0.2)
    assert shown_text(visit) == held
    visit.page.get_by_role("button", name="copy").click()
    visit.page.get_by_role("button", name="copied").wait_for()
    assert visit.page.evaluate("navigator.clipboard.readText()") == visit.page.locator(".picked code").inner_text()
    visit.page.keyboard.press("Escape")
    assert shown_text(visit).startswith("Point at a cell")
    point(visit, MAP, 0.5, 0.3)
    assert shown_text(visit) != held


def test_keys_go_from_cell_to_cell(open_page: Open, sweep: Path) -> None:
    visit = open_page(sweep / "plot.html")
    point(visit, MAP, 0.5, 0.51)
    visit.page.locator(MAP).focus()
    for key, expected in (("ArrowRight", "900 mm/s, length 1600"), ("ArrowUp", "900 mm/s, length 1700")):
        visit.page.keyboard.press(key)
        assert expected in shown_text(visit)
    visit.page.locator(BOUNDARY).focus()
    visit.page.keyboard.press("ArrowRight")
    first = shown_text(visit)
    visit.page.keyboard.press("ArrowRight")
    assert shown_text(visit) != first
    visit.page.keyboard.press("ArrowDown")
    assert "6000 mm/s²" in shown_text(visit)


def test_a_run_of_the_front_is_chosen_in_its_table(open_page: Open, sweep: Path) -> None:
    visit = open_page(sweep / "front.html")
    button = visit.page.locator("[data-pick]").first
    button.focus()
    number = button.inner_text()
    result: Any = visit.page.locator(".picked .good").inner_text()
    assert "".join(c for c in result if c.isdigit()) == number
    plan = SweepPlan.read(sweep)
    assert float(given(visit)[V]) == plan.values(int(number), int(number) + 1)[V][0]


@pytest.mark.parametrize(("page", "scheme"), [("plot.html", "light"), ("front.html", "dark")])
def test_a_page_fits_a_narrow_window(open_page: Open, sweep: Path, page: str, scheme: str) -> None:
    visit = open_page(sweep / page, width=400, color_scheme=scheme)
    visit.page.locator(".plot .main-svg").last.wait_for()
    point(visit, ".plot >> nth=0", 0.5, 0.5)
    assert visit.overflow() <= 0.0
    text, ground = visit.colours(".picked .where")[0], visit.colours(".picked")[1]
    assert contrast(text, ground) >= 7.0


def test_a_bar_of_the_histogram_shows_a_run_with_such_a_product(open_page: Open, monte_carlo: Path) -> None:
    """The axis goes from -0.125 to 0.125 mm; the only product at -0.12 mm is of run 7."""
    visit = open_page(monte_carlo)
    point(visit, HISTOGRAM, 0.005 / 0.25, 0.5)
    assert shown_text(visit).startswith("true length error -0.12")
    assert shown_text(visit).endswith("products: 1 (1 run)")
    assert visit.page.locator(".picked .bad").inner_text().startswith("Run 7 did not pass: cuts within")
    assert given(visit) == {"encoder.seed": "7"}


def test_the_keys_go_from_bar_to_bar(open_page: Open, monte_carlo: Path) -> None:
    visit = open_page(monte_carlo)
    visit.page.locator(HISTOGRAM).focus()
    visit.page.keyboard.press("ArrowRight")
    assert shown_text(visit).endswith("products: 0 (0 runs)")
    assert not visit.page.locator(".picked code").count()
    visit.page.keyboard.press("ArrowLeft")
    assert shown_text(visit).startswith("true length error -0.12")
    assert given(visit) == {"encoder.seed": "7"}


def test_the_bars_have_the_colours_of_the_tolerance(open_page: Open, monte_carlo: Path) -> None:
    """Red is the one bar beyond -0.1 mm, green are all others that have products; the curve is in the legend."""
    visit = open_page(monte_carlo, color_scheme="light")
    visit.page.locator(f"{HISTOGRAM} .points path").first.wait_for()
    read = """all => all.map(e => [getComputedStyle(e).fill, e.getBoundingClientRect().height])"""
    drawn = [
        fill for fill, height in visit.page.locator(f"{HISTOGRAM} .points path").evaluate_all(read) if height > 0.5
    ]
    assert drawn[0] == "rgb(179, 38, 30)"
    assert set(drawn[1:]) == {"rgb(23, 113, 58)"}
    assert ChartView(visit, "Histogram").legend == ["normal distribution"]


@pytest.mark.parametrize(("width", "scheme"), [(390, "light"), (390, "dark"), (1280, "light")])
def test_the_page_of_a_monte_carlo_fits(open_page: Open, monte_carlo: Path, width: int, scheme: str) -> None:
    """No text of the chart is cut off, and none lies on another one."""
    visit = open_page(monte_carlo, width=width, color_scheme=scheme)
    visit.page.locator(f"{HISTOGRAM} .points path").first.wait_for()
    assert visit.overflow() <= 0.0
    chart = ChartView(visit, "Histogram")
    assert {"-0.1 mm", "0.1 mm", "products", "true length error in mm"} <= set(chart.texts)
    assert chart.hidden_texts() == []
    point(visit, HISTOGRAM, 0.5, 0.3)
    text, ground = visit.colours(".picked .where")[0], visit.colours(".picked")[1]
    assert contrast(text, ground) >= 7.0
