"""The picture of the machine on a page of its own: it shows what the recording has, and does what the user asks."""

import random
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.recording import Recording
from tests.browser.conftest import OpenMachine
from tests.browser.drawn import read_belt
from tests.browser.runs import run
from tests.browser.visit import READOUTS, Visit

CYCLIC_CUT = "FlyingSaw/cyclic_cut"
SMALL = "FlyingSaw/diagonal_saw"
KINDS = "CutToLength/sample_and_waste"

OpenRun = Callable[..., Visit]


@pytest.fixture
def open_run(open_machine: OpenMachine) -> OpenRun:
    """Opens the machine of a scenario's run: `open_run(name, ...)`, the rest as for `open_page`."""
    return lambda name, **options: open_machine(*run(name), **options)


def seen_at_points(visit: Visit, recording: Recording, look: str) -> list[tuple[int, Any]]:
    """What a JavaScript expression gives at some points of a recording: both ends, and 25 others at random."""
    inner = random.Random(1).sample(range(1, len(recording.time) - 1), 25)
    points = [0, *sorted(inner), len(recording.time) - 1]
    return list(zip(points, visit.seen(recording.time[points].tolist(), look), strict=True))


# --- what it shows ---


@pytest.mark.parametrize(
    "name",
    [
        CYCLIC_CUT,
        SMALL,
        "FlyingSaw/rotary_master",
        "Follower/linear_wait_in_park",
        "Follower/cyclic_park",
        "Gearing/rotary_axes",
        "Gearing/rotary_master_downwards",
        "Gearing/stop_position_master_based",
        "Synchronizer/polynomial",
        "RemoteSync/slow_sender",
    ],
)
def test_the_slave_is_where_the_recording_has_it(open_run: OpenRun, name: str) -> None:
    """A slave with a period is compared on the circle: just before and just after 0 are the same place."""
    scenario, recording = run(name)
    visit = open_run(name)
    period = scenario.period if name.startswith("Synchronizer") else 0.0
    period = float(scenario.start.get("slave.period", scenario.start.get("slave_cycle", period)))
    look = "+document.querySelector('.motionsync-machine [data-slave-position]').dataset.slavePosition"
    for i, shown in seen_at_points(visit, recording, look):
        away = shown - recording.values["slave.position"][i]
        assert abs(away - period * round(away / period) if period else away) <= 1e-3


def test_each_piece_has_the_colour_and_the_name_of_its_kind(open_run: OpenRun) -> None:
    """Shortly after its cut a piece is the body that is next to the material on the side to which that flows."""
    pieces = find_pieces(*run(KINDS))
    visit = open_run(KINDS)
    bodies = "[...document.querySelectorAll('.stock rect[visibility=visible]')]"
    looks = f"{bodies}.map(e => [+e.getAttribute('x'), e.getAttribute('fill')]).sort((a, b) => a[0] - b[0])"
    assert len({piece.name for piece in pieces}) >= 3
    seen = visit.seen([piece.reported_at + 0.02 for piece in pieces], f"[{looks}, {READOUTS}]")
    for piece, (bodies_seen, texts) in zip(pieces, seen, strict=True):
        assert bodies_seen[1][1] == f"var(--kind-{piece.kind})"
        assert texts["last piece"] == f"{piece.length:.2f} mm {piece.name}"
        assert texts["pieces"] == f"{piece.number} of {len(pieces)}"


def test_the_next_cut_is_the_one_that_the_block_knows(open_run: OpenRun) -> None:
    """While it cuts, and before it has a length, it has no next one."""
    _, recording = run(KINDS)
    visit = open_run(KINDS)
    for i, texts in seen_at_points(visit, recording, READOUTS):
        values = {name: recording.values[name][i] for name in ("next_cut.position", "next_cut.known", "tool.cutting")}
        text_shown = texts["saw to next cut"]
        if not values["next_cut.known"] or values["tool.cutting"]:
            assert text_shown in ("none", "0, cutting")
            continue
        away = recording.values["slave.position"][i] - recording.master[i, 0] + values["next_cut.position"]
        number, _, text = text_shown.partition(" mm ")
        assert float(number.replace("\N{MINUS SIGN}", "-")) == pytest.approx(away, abs=0.01)
        assert text == f"(cut {int(recording.values['statistics.cuts'][i]) + 1})"


def test_the_distance_from_the_saw_to_its_mark_is_shown(open_run: OpenRun) -> None:
    """Marks each 1500 mm from 1000 on: how far master - slave is from the nearest one; positive: the saw is ahead."""
    _, recording = run(CYCLIC_CUT)
    visit = open_run(CYCLIC_CUT)
    look = f"[+document.querySelector('.motionsync-machine').dataset.distance, {READOUTS}]"
    for i, (distance, texts) in seen_at_points(visit, recording, look):
        place = recording.master[i, 0] - recording.values["slave.position"][i]
        mark = round((place - 1000.0) / 1500.0)
        away = 1000.0 + 1500.0 * mark - place
        assert distance == pytest.approx(away, abs=3e-3) or abs(abs(away) - 750.0) < 3e-3
        number, _, text = texts["saw to mark"].partition(" mm ")
        assert float(number.replace("\N{MINUS SIGN}", "-")) == pytest.approx(away, abs=0.01)
        assert text == f"(mark {mark})"


def test_state_and_velocity_are_shown(open_run: OpenRun) -> None:
    """At first the saw is at rest; at 19.4 s it cuts mark 11 at 1100 mm/s; at 33 s all is cut."""
    visit = open_run(CYCLIC_CUT)
    visit.show(19.4)
    assert visit.readout("state") == "SYNCHRON \N{EN DASH} coupled, in sync"
    assert visit.readout("velocity") == "1100 mm/s"
    assert visit.readout("saw to mark") == "0.000 mm (mark 11)"
    visit.show(0.05)
    assert visit.readout("state") == "INACTIVE \N{EN DASH} it is at rest"
    visit.show(33.0)
    assert visit.readout("cuts") == "20 of 20"


def test_the_discs_turn_with_their_axes(open_run: OpenRun) -> None:
    """At 1 s master and slave are at 90 of 360 degrees; at 3 s the slave rests at 180, and the master is at 270."""
    visit = open_run("Synchronizer/polynomial")
    for t, angles in ((1.0, [90.0, 90.0]), (3.0, [270.0, 180.0])):
        visit.show(t)
        hands = visit.page.evaluate("[...document.querySelectorAll('.hand')].map(e => e.getAttribute('transform'))")
        assert [float(hand[len("rotate(") : -1]) for hand in hands] == pytest.approx(angles, abs=1e-3)


def test_the_window_shows_how_far_the_telegram_is_off(open_run: OpenRun) -> None:
    """slow_sender, steps of a cycle: an output belongs to the cycle before, and the slave describes that instant."""
    scenario, recording = run("RemoteSync/slow_sender")
    assert scenario.remote
    visit = open_run("RemoteSync/slow_sender")
    for i in (500, 1500, 2400):
        visit.show(float(recording.time[i]))
        truth = scenario.master.at(float(recording.time[i - 1])).position
        shown = visit.number(".slave", "error")
        behind = scenario.remote.accuracy.behind if scenario.remote.accuracy else 0.0
        allowed = abs(250.0 * behind * scenario.remote.data_cycle) + 1e-3
        assert shown == pytest.approx(recording.values["slave.position"][i] - truth, abs=allowed)


# --- what it does ---


@pytest.mark.parametrize("speed", ["0.1", "1", "5"])
def test_playing_takes_as_long_as_the_speed_says(open_run: OpenRun, speed: str) -> None:
    visit = open_run(CYCLIC_CUT)
    visit.freeze()
    visit.page.locator(".motionsync-machine select").select_option(speed)
    visit.page.get_by_role("button", name="Play").click()
    visit.wait(2000)
    assert visit.time == pytest.approx(2.0 * float(speed), rel=0.05)
    visit.page.get_by_role("button", name="Pause").click()
    paused = visit.time
    visit.wait(1000)
    assert visit.time == paused


def test_playing_stops_at_the_end_and_begins_again(open_run: OpenRun) -> None:
    visit = open_run(SMALL)
    stop = run(SMALL)[0].stop_time
    visit.freeze()
    visit.show(stop - 0.1)
    visit.page.get_by_role("button", name="Play").click()
    visit.wait(1000)
    assert visit.time == stop
    visit.page.get_by_role("button", name="Play").click()
    visit.wait(500)
    assert visit.time == pytest.approx(0.5, abs=0.05)


def test_keys_play_and_step(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT)
    visit.freeze()
    visit.page.locator(".motionsync-machine").focus()
    keyboard = visit.page.keyboard
    times = []
    for key in ("End", "ArrowLeft", "Home", "ArrowRight", "ArrowRight", "Shift+ArrowRight"):
        keyboard.press(key)
        times.append(visit.time)
    assert times == pytest.approx([33.0, 32.98, 0.0, 0.02, 0.04, 0.24])
    keyboard.press(" ")
    visit.wait(1000)
    keyboard.press(" ")
    assert visit.time == pytest.approx(1.24, abs=0.05)
    assert visit.page.locator(".motionsync-machine").get_attribute("data-playing") == "false"


def test_space_on_the_button_plays_once(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT)
    visit.freeze()
    visit.page.get_by_role("button", name="Play").focus()
    visit.page.keyboard.press(" ")
    visit.wait(500)
    assert visit.time == pytest.approx(0.5, abs=0.05)


def test_the_machine_follows_the_plots_and_gives_them_its_time(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT)
    visit.listen()
    event = "new CustomEvent('motionsync:time', {detail: {time: 12.5, source: 'plots'}})"
    visit.page.evaluate(f"document.dispatchEvent({event})")
    assert visit.time == 12.5
    assert visit.notified_times() == [["plots", 12.5]]
    visit.show(3.25)
    assert visit.notified_times() == [["plots", 12.5], ["machine", 3.25]]


def test_who_wants_less_motion_sees_a_few_pictures_a_second(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT, reduced_motion="reduce")
    visit.freeze()
    visit.listen()
    visit.page.get_by_role("button", name="Play").click()
    visit.wait(2000)
    times = [time for _, time in visit.notified_times()]
    assert len(times) in (7, 8)
    assert all(0.25 <= after - before < 0.3 for before, after in pairwise(times))


# --- how it looks ---


def test_the_colours_of_the_page_are_taken(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT)
    visit.page.add_style_tag(content=":root { --slave: rgb(1, 2, 3); }")
    assert visit.page.locator(".carriage rect[rx='5']").evaluate("e => getComputedStyle(e).fill") == "rgb(1, 2, 3)"


@pytest.mark.parametrize(
    "name", [CYCLIC_CUT, "Synchronizer/polynomial", "Gearing/ccw_direct", "RemoteSync/slow_sender"]
)
def test_the_picture_fits_its_window(open_run: OpenRun, name: str) -> None:
    visit = open_run(name)
    for width in (320, 500, 1600):
        visit.page.set_viewport_size({"width": width, "height": 900})
        visit.show(1.0)
        assert visit.overflow() <= 0.0
        box = visit.page.locator(".motionsync-machine svg").bounding_box()
        assert box["width"] == pytest.approx(width - 32, abs=1.0)


def test_the_picture_follows_the_size_of_its_window(open_run: OpenRun) -> None:
    """The saw stays over its position: 400 mm at 1.4 s, in sync since 1.25 s at 250 mm."""
    visit = open_run(CYCLIC_CUT)
    visit.show(1.4)
    wide = visit.number(".carriage", "x")
    visit.page.set_viewport_size({"width": 500, "height": 800})
    visit.page.wait_for_function("x => +document.querySelector('.carriage').dataset.x < x", arg=wide - 1.0)
    belt = read_belt(visit)
    assert belt.middle_of_saw == pytest.approx(belt.x(400.0), abs=0.5)


def test_a_screen_reader_learns_what_there_is(open_run: OpenRun) -> None:
    visit = open_run(CYCLIC_CUT)
    group = visit.page.get_by_role("group", name="Animated picture of the machine")
    assert group.get_by_role("slider", name="Time").count() == 1
    assert group.get_by_role("img").count() == 1
    assert group.get_by_role("combobox", name="Speed").count() == 1
    visit.show(3.25)
    assert group.get_by_role("slider").get_attribute("aria-valuetext") == "3.250 s"


@pytest.mark.parametrize("name", ["CutToLength/basic_cut", CYCLIC_CUT])
def test_the_labels_above_a_narrow_machine_do_not_touch(open_run: OpenRun, name: str) -> None:
    labels = "[...document.querySelectorAll('.ground text[y=\"13\"]')].map(e => e.getBoundingClientRect())"
    boxes = sorted(open_run(name, width=390).page.evaluate(f"{labels}.map(r => [r.left, r.right])"))
    assert len(boxes) == 4  # both ends, home, in sync
    assert all(before[1] + 5.0 <= after[0] for before, after in pairwise(boxes))
