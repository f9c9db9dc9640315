"""The picture of a rotary knife in a browser: its edges, its material and its pieces are where the run has them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan2, cos, degrees, hypot, pi, sin

import numpy as np
import pytest

from motionsync_fmu.scenario.recording import Recording
from tests.browser.conftest import OpenMachine
from tests.browser.runs import record, run
from tests.browser.visit import Visit

FORMATS = "RotaryKnife/formats"
CUTS = [800.0, 1400.0, 2000.0, 2400.0, 3300.0, 4800.0, 5100.0]  # and so on, mm; on a line of 1000 mm/s
RADIUS = 600.0 / (2 * pi)
SHARP = 0.05  # px
TIPS = """[...document.querySelectorAll('.cylinder .blade')].map(blade => {
  const [, x, y] = blade.getAttribute('d').match(/L(\\S+) (\\S+)L/).map(Number);
  const tip = new DOMPoint(x, y).matrixTransform(blade.getCTM());
  return [tip.x, tip.y];
})"""
CIRCLE = "['cx', 'cy', 'r'].map(name => Number(document.querySelector('.cylinder circle').getAttribute(name)))"
BODIES = "[...document.querySelectorAll('.stock rect[visibility=visible]')]"

OpenKnife = Callable[..., "Picture"]


@dataclass
class Picture:
    """The page of a run, and that run."""

    visit: Visit
    recording: Recording

    def tips(self) -> list[tuple[float, float]]:
        """Of all blades, to the right of the lowest point of their circle and above it, in mm."""
        middle, centre, radius = self.visit.page.evaluate(CIRCLE)
        scale = radius / RADIUS
        return [((x - middle) / scale, (centre + radius - y) / scale) for x, y in self.visit.page.evaluate(TIPS)]

    def scale(self) -> float:
        """px per mm."""
        return float(self.visit.page.evaluate(CIRCLE)[2]) / RADIUS

    def bodies(self) -> list[tuple[float, float]]:
        """The ends of all pieces of material, in mm beyond the place of the cut, from the left."""
        middle = self.visit.page.evaluate(CIRCLE)[0]
        ends = self.visit.page.evaluate(f"{BODIES}.map(e => [+e.getAttribute('x'), +e.getAttribute('width')])")
        return sorted(((x - middle) / self.scale(), (x + width - middle) / self.scale()) for x, width in ends)


@pytest.fixture
def open_knife(open_machine: OpenMachine) -> OpenKnife:
    """Opens the machine of the formats' run, with other start values: `open_knife({"knife.blades": 2}, ...)`, the rest
    as for `open_page`."""

    def opened(start: dict[str, float] | None = None, **options: object) -> Picture:
        scenario, recording = run(FORMATS)
        if start:
            scenario = replace(scenario, start={**scenario.start, **start})
            recording = record(scenario)
        return Picture(open_machine(scenario, recording, **options), recording)

    return opened


# --- the edge ---


def test_the_edge_is_at_the_lowest_point_where_it_cuts(open_knife: OpenKnife) -> None:
    """There the material's place of the cut is, too: it is the end of the piece."""
    picture = open_knife()
    for n, place in enumerate(CUTS):
        picture.visit.show(place / 1000)
        assert picture.tips() == [pytest.approx((0.0, 0.0), abs=SHARP)]
        picture.visit.show(place / 1000 + 0.02)
        assert picture.visit.number(".stock", "cuts") == n + 1
        (_, end), *_ = picture.bodies()
        assert end == pytest.approx(20.0, abs=SHARP)


@pytest.mark.parametrize("away", [-29.0, -15.0, 12.0, 29.0])
def test_the_edge_goes_with_the_material_in_its_window(open_knife: OpenKnife, away: float) -> None:
    """TANGENTIAL: along the circle by as much as the material travels, whichever piece it is."""
    picture = open_knife()
    angle = away / RADIUS
    for place in CUTS:
        picture.visit.show((place + away) / 1000)
        assert picture.visit.page.locator(".cylinder").get_attribute("data-in-sync") == "true"
        assert picture.tips() == [pytest.approx((RADIUS * sin(angle), RADIUS * (1 - cos(angle))), abs=SHARP)]


@pytest.mark.parametrize("away", [-59.0, -30.0, 45.0, 59.0])
def test_horizontally_the_edge_stays_above_its_place_on_the_material(open_knife: OpenKnife, away: float) -> None:
    picture = open_knife({"sync.mode": 2, "sync.before": 60.0, "sync.after": 60.0})
    for place in CUTS[:4]:
        picture.visit.show((place + away) / 1000)
        assert picture.tips() == [pytest.approx((away, RADIUS - (RADIUS**2 - away**2) ** 0.5), abs=SHARP)]


def test_two_blades_take_turns(open_knife: OpenKnife) -> None:
    """They are opposite to each other, and every second cut is made by the same one."""
    picture = open_knife({"knife.blades": 2, "knife.park_angle": 90.0})
    cutting = []
    for place in CUTS[:4]:
        picture.visit.show(place / 1000)
        heights = [height for _, height in picture.tips()]
        assert sorted(heights) == pytest.approx([0.0, 2 * RADIUS], abs=SHARP)
        cutting.append(heights.index(min(heights)))
    assert cutting == [1, 0, 1, 0]


def test_the_edge_moves_along_its_circle_while_the_run_plays(open_knife: OpenKnife) -> None:
    """Each picture of the motion has the edge at the angle that the slave has at its time; within a step of 10 ms the
    recording is 20 000 degrees/s2 (0.01 s)2 / 8 = 0.25 degrees beside a straight line."""
    picture = open_knife()
    visit, recording = picture.visit, picture.recording
    angles = np.unwrap(recording.values["slave.position"], period=360.0)
    visit.freeze()
    visit.show(1.9)
    visit.page.get_by_role("button", name="Play").click()
    seen = []
    for _ in range(12):
        visit.wait(100)
        ((x, height),) = picture.tips()
        assert hypot(x, RADIUS - height) == pytest.approx(RADIUS, abs=SHARP)
        away = degrees(atan2(x, RADIUS - height)) - np.interp(visit.time, recording.time, angles)
        assert abs(away - 360.0 * round(away / 360.0)) < 0.3
        seen.append(visit.time)
    assert seen == sorted(seen)
    assert seen[-1] - seen[0] == pytest.approx(1.1, abs=0.1)


# --- the rest of the picture ---


def test_the_zone_of_sync_is_as_wide_as_its_window(open_knife: OpenKnife) -> None:
    """On the material from 30 before to 50 after the cut; on the circle from -30/r to 50/r."""
    picture = open_knife({"sync.after": 50.0})
    picture.visit.show(1.0)
    middle, _, radius = picture.visit.page.evaluate(CIRCLE)
    band = picture.visit.page.locator(".ground rect").first
    x, width = (float(band.get_attribute(name)) for name in ("x", "width"))
    scale = picture.scale()
    assert ((x - middle) / scale, width / scale) == pytest.approx((-30.0, 80.0), abs=SHARP)
    arc = picture.visit.page.locator(".cylinder path").first.get_attribute("d")
    first, last = float(arc[1:].split(",")[0]), float(arc.split(" ")[-1].split(",")[0])
    assert (first - middle) / radius == pytest.approx(sin(-30.0 / RADIUS), abs=1e-3)
    assert (last - middle) / radius == pytest.approx(sin(50.0 / RADIUS), abs=1e-3)


def test_a_piece_that_leaves_the_table_falls(open_knife: OpenKnife) -> None:
    """The table ends about 95 mm beyond the cut; the piece that is cut off at 2.4 s has its end there 0.1 s later."""
    picture = open_knife()
    heights = []
    for t in (2.42, 2.53, 2.57):
        picture.visit.show(t)
        box = f"{BODIES}.map(e => e.getBoundingClientRect()).map(b => [b.left, b.bottom]).sort((a, b) => a[0] - b[0])"
        heights.append(picture.visit.page.evaluate(box)[1][1])
    assert heights[0] < heights[1] < heights[2]
    assert heights[2] > heights[0] + 10.0


def test_what_the_readouts_say(open_knife: OpenKnife) -> None:
    """In the middle of the piece of 400 the edge is 2.1029 times as fast; 2000 and 200 mm are between two cuts."""
    picture = open_knife()
    picture.visit.show(2.2)
    for name, text in {
        "state": "TURNING \N{EN DASH} between the windows of two cuts",
        "material": "1000 mm/s (60.0\N{NO-BREAK SPACE}m/min)",
        "edge": "2103 mm/s",
        "next cut in": "200.0 mm",
        "pieces": "3 of 16",
        "last piece": "600.00 mm PRODUCT",
    }.items():
        assert picture.visit.readout(name) == text
    picture.visit.show(0.1)
    assert picture.visit.readout("next cut in") == "none"


@pytest.mark.parametrize("width", [320, 390, 1600])
def test_the_picture_fits_its_window(open_knife: OpenKnife, width: int) -> None:
    """Nothing is wider than the page, and no text sticks out of the picture at the left or the right."""
    picture = open_knife(width=width)
    for t in (0.1, 0.8, 2.2, 4.0):
        picture.visit.show(t)
        assert picture.visit.overflow() <= 0.0
        texts = "[...document.querySelectorAll('.motionsync-machine svg text')].filter(e => e.textContent)"
        shown = f"{texts}.filter(e => getComputedStyle(e).visibility === 'visible').map(e => e.getBoundingClientRect())"
        left, right = picture.visit.page.evaluate(
            f"[Math.min(...{shown}.map(b => b.left)), Math.max(...{shown}.map(b => b.right))]"
        )
        assert left >= 0.0
        assert right <= width
