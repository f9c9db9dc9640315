"""The first picture of README and site: its machine moves as line and saw do, and its end is like its beginning."""

import re

import numpy as np
import pytest

from motionsync_fmu.scenario.recording import Reals
from tests import ROOT
from tests.support.project.pictures import assert_same_picture
from tools.first_picture import FILE, draw, run_cycles

SECONDS = 3.2  # that are shown: two pieces of 800 mm at 500 mm/s
PIXELS = (626 - 62) / 860.0  # for each mm: the positions from -300 to 560 mm are between the borders of the plots
SPEED = 500.0 * PIXELS  # of the line, in px/s


@pytest.fixture(scope="module")
def picture() -> str:
    return draw(run_cycles()).decode()


def frames(picture: str, name: str, style: str) -> tuple[Reals, Reals]:
    """The times in s, and the values of a style at them."""
    (rule,) = re.findall(rf"@keyframes {name} {{ (.*?) }}$", picture, re.M)
    values = re.findall(rf"([\d.]+)%{{[^}}]*{style}(-?[\d.]+)", rule)
    times, numbers = np.array(values, float).T
    return 0.01 * SECONDS * times, numbers


def test_the_picture_is_that_of_the_repository(picture: str) -> None:
    assert_same_picture(picture.encode(), ROOT / "docs" / FILE)
    assert len(picture) < 16_000


def test_the_end_is_like_the_beginning(picture: str) -> None:
    _, saw = frames(picture, "saw", r"translate\(")
    assert saw[0] == saw[-1] == 0.0
    _, grain = frames(picture, "grain", "stroke-dashoffset:")
    (dash,) = re.findall(r"stroke-dasharray: ([\d.]+)", picture)
    assert -grain[-1] / (2.0 * float(dash)) == pytest.approx(40.0, abs=0.01)  # whole periods of dash and space
    assert -grain[-1] == pytest.approx(SPEED * SECONDS, abs=0.1)


def test_the_saw_moves_with_the_line_while_it_cuts(picture: str) -> None:
    """The blade is down for a cut; the gap that it leaves goes on with the line, from where the saw is."""
    times, saw = frames(picture, "saw", r"translate\(")
    blade_times, depth = frames(picture, "blade", r"translate\(0.0px,")
    downs = [
        pair for pair in zip(blade_times[:-1], blade_times[1:], depth[:-1], depth[1:], strict=True) if min(pair[2:])
    ]
    assert [end - begin for begin, end, *_ in downs] == pytest.approx([0.25, 0.25], abs=0.01)
    for i, (begin, end, *_) in enumerate(downs):
        inside = (times > begin) & (times < end)
        assert np.diff(saw[inside]) / np.diff(times[inside]) == pytest.approx(SPEED, rel=0.02)
        gap_times, gap = frames(picture, f"gap{i}", r"translate\(")
        assert gap[2] == pytest.approx(np.interp(end, times, saw), abs=0.5)
        assert (gap[3] - gap[2]) / (gap_times[3] - gap_times[2]) == pytest.approx(SPEED, rel=0.01)
