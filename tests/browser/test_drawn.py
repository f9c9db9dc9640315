"""What is drawn of a run, in its report and on the page of its block alike: while it plays, and in any order of times.

Everything is measured on the screen and compared with the recording alone.
"""

import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.scenario.recording import Recording
from tests.browser.conftest import OpenBlock, OpenReport
from tests.browser.drawn import Belt, read_belt, read_belts, watch_belt
from tests.browser.runs import run
from tests.browser.visit import Visit

BASIC_CUT, CYCLIC_CUT, KINDS = "CutToLength/basic_cut", "FlyingSaw/cyclic_cut", "CutToLength/sample_and_waste"
LOWERING = 0.06  # s, which the blade needs up and down
SPEED = {BASIC_CUT: 1, KINDS: 5, CYCLIC_CUT: 5}  # at which the run plays
PICTURE = 37  # ms from one look at the picture to the next, times the speed: no multiple of a picture's time

AXES = """(() => {
  const middle = (e) => { const b = e.getBoundingClientRect(); return (b.left + b.right) / 2; };
  const shown = (axis) => {
    const layer = document.querySelector(`.motionsync-machine g.${axis}`);
    const numbers = [...layer.querySelectorAll('text.soft[text-anchor=middle]')];
    const hands = [...layer.querySelectorAll('.hand rect')];
    if (hands.length !== 1) throw new Error(`${hands.length} hands`);
    return { numbers: numbers.map((e) => [e.textContent, middle(e)]), hand: middle(hands[0]) };
  };
  return { master: shown('master'), slave: shown('slave') };
})()"""
"""What is drawn of two axes: the numbers of the rulers with their middles, and those of the hands, in px."""

OpenPage = Callable[..., Visit]


@pytest.fixture(params=["report", "explore"])
def open_run(request: pytest.FixtureRequest, open_report: OpenReport, open_block: OpenBlock) -> OpenPage:
    """Opens a run, in its report or on its block's page: `open_run(name, ...)`, the rest as for `open_page`."""
    if request.param == "report":
        return open_report

    def opened(name: str, **options: Any) -> Visit:
        return open_block(*name.split("/"), **options)

    return opened


def cutting(name: str, recording: Recording) -> Any:
    """Where the recording says that the saw cuts."""
    if name.startswith("FlyingSaw"):
        return recording.values["in_sync"] != 0.0  # the scenario's table [cuts]
    return recording.values["tool.blade_down"] != 0.0


def cuts_of(name: str, recording: Recording) -> list[tuple[float, float]]:
    """The end of each cut, in s, and its place on the material: that of the saw while it cuts (ratio 1)."""
    on = cutting(name, recording)
    edges = np.flatnonzero(np.diff(on.astype(int), prepend=0, append=0))
    places = recording.master[:, 0] - recording.values["slave.position"]
    return [
        (float(recording.time[min(after, len(on) - 1)]), float(places[first:after].mean()))
        for first, after in zip(edges[::2], edges[1::2], strict=True)
    ]


def check(name: str, belt: Belt) -> set[str]:
    """Compare a picture with the recording; the result names what has been compared."""
    _, recording = run(name)
    seen = {"picture"}
    t, time = belt.time, recording.time
    position, master = (np.interp(t, time, x) for x in (recording.values["slave.position"], recording.master[:, 0]))
    step = float(np.diff(time).max())
    exact = 0.5 + 10000.0 * step**2 / 8.0 * abs(belt.x(1.0) - belt.x(0.0))  # px: between points, 10000 mm/s2
    assert belt.middle_of_saw == pytest.approx(belt.x(position), abs=exact)
    on, near = cutting(name, recording), (time >= t - LOWERING - step) & (time <= t + step)
    if on[near].all() or not on[near].any():
        assert belt.is_blade_in_the_material == on[near].any()
        seen.add("down" if on[near].any() else "up")
    assert belt.loose_grain == []
    assert len(belt.grain) >= belt.least_grain
    done = [(end, place) for end, place in cuts_of(name, recording) if end < t - 2 * step]
    # the material ends at the last cut
    if belt.bodies and done and (x := belt.x(master - done[-1][1])) < belt.bodies[-1][1]:
        assert belt.has_border(x)
        seen.add("cut")
        assert all(gap > 0.0 for gap in belt.gaps())
    for number, x in belt.marks:
        if name == CYCLIC_CUT:  # a mark each 1500 mm from 1000 on
            place = 1000.0 + 1500.0 * number
            shift = 14.0 * sum(cut > place + 1.0 for _, cut in done)  # pieces that were cut off run ahead
            assert belt.x(master - place) - 1.0 <= x <= belt.x(master - place) + shift + 1.0
        else:
            place = recording.values["next_cut.position"][np.searchsorted(time, t + 1e-9) - 1]
            assert x == pytest.approx(belt.x(master - place), abs=1.0)
        seen.add("mark")
    return seen


@pytest.mark.parametrize("name", [BASIC_CUT, KINDS, CYCLIC_CUT])
def test_the_picture_is_the_recording_while_it_plays_and_backwards(open_run: OpenPage, name: str) -> None:
    stop, speed = run(name)[0].stop_time, SPEED[name]
    visit = open_run(name)
    visit.show(0.0)
    visit.freeze()
    visit.page.locator(".motionsync-machine select").select_option(str(speed))
    visit.page.get_by_role("button", name="Play").click()
    played = watch_belt(visit, PICTURE, math.ceil(1000.0 * stop / speed) + 2 * PICTURE)
    assert played[-1].time == stop
    assert len(played) > stop / (speed * 0.05)
    assert set().union(*(check(name, belt) for belt in played)) == {"picture", "down", "up", "cut", "mark"}
    again = random.Random(1).sample(played, 25)
    assert read_belts(visit, [belt.time for belt in again]) == again


@pytest.mark.parametrize("name", [BASIC_CUT, CYCLIC_CUT])
def test_the_first_picture_has_its_blade_up_and_its_grain_on_the_material(open_run: OpenPage, name: str) -> None:
    for width in (1280, 390):
        belt = read_belt(open_run(name, width=width))
        assert check(name, belt) >= {"picture", "up"}


def test_two_axes_are_drawn_where_the_recording_has_them(open_run: OpenPage) -> None:
    """Gearing on two rails, each with its own ruler."""
    name = "Gearing/ccw_direct"
    _, recording = run(name)
    visit = open_run(name)
    times = [float(t) for t in recording.time[:: len(recording.time) // 12]]
    order = [*times, *reversed(times)]
    for t, shown in zip(order, visit.seen(order, AXES), strict=True):
        for axis, recorded in (("master", recording.master[:, 0]), ("slave", recording.values["slave.position"])):
            texts = [(text.replace("\N{MINUS SIGN}", "-"), at) for text, at in shown[axis]["numbers"]]
            ruler = [(float(text), at) for text, at in texts if text[-1].isdigit()]
            (first, left), (last, right) = ruler[0], ruler[-1]
            expected = left + (np.interp(t, recording.time, recorded) - first) * (right - left) / (last - first)
            assert shown[axis]["hand"] == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize("name", ["CutToLength/late_skip", "CutToLength/orders_spoilt_piece", CYCLIC_CUT])
def test_no_readout_is_cut_off(open_run: OpenPage, name: str) -> None:
    visit = open_run(name, width=1280)
    read = """async (times) => {
      const seen = [];
      for (const t of times) {
        window.motionsyncMachine.show(t);
        await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));  // what observes sizes has acted
        const readouts = [...document.querySelectorAll('.motionsync-machine dd')];
        const top = document.querySelector('.motionsync-machine svg').getBoundingClientRect().top;
        seen.push([readouts.map((e) => [e.textContent, e.scrollWidth - e.clientWidth]), top]);
      }
      return seen;
    }"""
    times = 2 * np.linspace(0.0, run(name)[0].stop_time, 40).tolist()
    for width in (1280, 390):
        visit.page.set_viewport_size({"width": width, "height": 900})
        shown = visit.page.evaluate(read, times)
        seen, tops = [row for readouts, _ in shown for row in readouts], [top for _, top in shown]
        assert len(seen) >= 80 * 6
        assert [text for text, missing in seen if missing > 0] == []
        assert len(set(tops[40:])) == 1  # the picture stays in place once all texts have been seen
