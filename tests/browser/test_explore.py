"""The pages of `motionsync explore` in a real browser, as files and without a network."""

import csv
import hashlib
import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.explorer import page as explore_page
from motionsync_fmu.explorer.data import explored as shown
from motionsync_fmu.explorer.page import write_page
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.evaluate.remote_errors import remote_errors
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT
from tests.browser.conftest import Chosen, Open, OpenBlock, ready
from tests.browser.runs import record
from tests.browser.visit import Visit, choose, contrast, settle
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.explored import explored, opens_with
from tests.support.scenarios.recordings import output_names
from tests.support.scenarios.scenario_texts import ENCODED_SAW

TABLES_JS = Path(explore_page.__file__).with_name("tables.js")
CUTS = "[...document.querySelectorAll('.motionsync-machine .stock')].map(e => +e.dataset.cuts)[0]"


def slide(visit: Visit, name: str, value: float) -> None:
    """Move a slider, as a hand does: to the nearest of its places."""
    visit.page.get_by_label(f"{name}, slider", exact=True).first.fill(str(value))
    settle(visit)


def badge(visit: Visit, text: str) -> None:
    visit.page.locator("#badge", has_text=text).wait_for()


def write_down(visit: Visit) -> None:
    """Show the run as a file."""
    visit.page.get_by_role("button", name="As scenario.toml").click()
    visit.page.locator("#download[href]").wait_for()


def pieces_at_the_end(visit: Visit, stop_time: float) -> int:
    visit.show(stop_time)
    return int(visit.page.evaluate(CUTS))


def sum_of(scenario: Scenario) -> str:
    """SHA-256 of all outputs and locals at all points of a run in compiled code, which has the bits of Python."""
    values = record(scenario).values
    columns = [values[name] for name in output_names(scenario)]
    return hashlib.sha256(np.column_stack(columns).tobytes()).hexdigest()


# --- bits ---


@pytest.mark.slow
def test_scenarios_of_each_kind_have_the_native_bits_in_the_browser(
    chosen: Chosen, fmus: Fmus, block: str, soak: Callable[[int, int], int]
) -> None:
    """The page makes all inputs itself: the axis, the telegrams, what reactions set. The long form runs all scenarios;
    tests/explorer/test_bits.py runs all of them in the page's module, with inputs that Python makes."""
    page = explored(fmus, block)
    all_sums = {s["name"]: s["sha256"] for s in page.data["scenarios"]}
    native_sums = all_sums if soak(0, 1) else {name: all_sums[name] for name in page.varied_scenarios()}
    sums = """async (names) => {
      const found = {};
      for (const name of names) found[name] = await motionsyncExplore.fingerprint(motionsyncExplore.run(name));
      return found;
    }"""
    assert all(native_sums.values())
    assert chosen(block).page.evaluate(sums, list(native_sums)) == native_sums


MEASURED = """\
title = "A measured line"
fmu = "Gearing"
stop_time = 1.0
step_size = 0.01
[start]
"gear_in.start_mode" = "CW_CCW_DIRECT"
"gear_in.transition" = "NONE"
"gearing.denominator" = 2
"master.period" = 30.0
[[set]]
at = 0.1003
start = true
"""
LINES = {
    "sampled": """\
[master]
velocity = 300.0
acceleration = 100.0
segments = [{ duration = 0.1501, acceleration = 800.0 }, { duration = 0.1, jerk = -9000.0 }, { duration = 0.1 }]
[encoder]
resolution = 0.05
noise = 0.02
delay = 0.0135
scale = 1.0005
runout = { amplitude = 0.05, length = 500.0 }
sample_time = 0.004
seed = 4294967295
""",
    "fresh": "[master]\nposition = -7.0\nvelocity = 100.0\n[encoder]\nnoise = 0.02\nseed = 5\n",
    "driven": """\
[master]
velocity = 100.0
follows = "slave.velocity"
time_constant = 0.3
[encoder]
delay = 0.137
noise = 0.01
""",
    "recorded": '[master]\nfile = "trace.csv"\n',
}
TRACE = "time,position\n7.0,29\n7.1,3.5\n7.33,28\n7.9,8.25\n8.1,9\n"


def test_a_measured_line_has_the_native_bits_in_the_browser(open_page: Open, fmus: Fmus, tmp_path: Path) -> None:
    """Also in the file into which the page writes the run."""
    (tmp_path / "trace.csv").write_text(TRACE)
    for name, line in LINES.items():
        (tmp_path / f"{name}.toml").write_text(MEASURED + line)
    page = tmp_path / "Gearing.html"
    scenarios = [load_scenario(tmp_path / f"{name}.toml") for name in LINES]
    write_page("Gearing", scenarios, fmus.native("Gearing"), page)
    visit = open_page(page)
    visit.page.wait_for_selector("html[data-ready]")
    for name, scenario in zip(LINES, scenarios, strict=True):
        expected = sum_of(shown(scenario))
        run = f"motionsyncExplore.fingerprint(motionsyncExplore.run('{name}'))"
        assert visit.page.evaluate(f"async () => await {run}") == expected, name
    file, fingerprint = save_run(visit, tmp_path)
    loaded = load_scenario(file)
    assert loaded.encoder == scenarios[0].encoder
    assert sum_of(loaded) == fingerprint


def test_a_saw_on_a_measured_line_knows_the_resolution_in_the_browser(
    open_page: Open, fmus: Fmus, tmp_path: Path
) -> None:
    """Without it the command would be refused: the acceleration of the encoder would make the saw overshoot."""
    file, page = tmp_path / "saw.toml", tmp_path / "FlyingSaw.html"
    file.write_text(ENCODED_SAW)
    scenario = load_scenario(file)
    write_page("FlyingSaw", [scenario], fmus.native("FlyingSaw"), page)
    visit = open_page(page)
    visit.page.wait_for_selector("html[data-ready]")
    run = "motionsyncExplore.fingerprint(motionsyncExplore.run('saw'))"
    assert visit.page.evaluate(f"async () => await {run}") == sum_of(shown(scenario))


def test_the_badge_compares_what_is_shown(chosen: Chosen, fmus: Fmus) -> None:
    visit = chosen("Synchronizer", "polynomial")
    badge(visit, "same bits as the native FMU: " + explored(fmus, "Synchronizer").scenario("polynomial")["sha256"][:12])
    slide(visit, "output_phasing", 50.0)
    badge(visit, "changed")
    visit.page.get_by_role("button", name="As it was").click()
    badge(visit, "same bits")


def test_a_remainder_has_the_sign_of_the_divisor(open_page: Open, tmp_path: Path) -> None:
    visit = open_page(_blank(tmp_path))
    visit.page.add_script_tag(content=TABLES_JS.read_text("utf-8"))
    draw = random.Random(15)
    pairs = [(draw.uniform(-1e4, 1e4), draw.choice([360.0, 0.1, 1e-3, 777.7])) for _ in range(20000)]
    pairs += [(-0.1, 0.1), (-0.3, 0.1), (0.0, 5.0), (-5.0, 5.0)]
    assert visit.page.evaluate("pairs => pairs.map(([x, y]) => modulo(x, y))", pairs) == [x % y for x, y in pairs]


def _blank(folder: Path) -> Path:
    file = folder / "blank.html"
    file.write_text("<!doctype html><title>blank</title>", "utf-8")
    return file


# --- a slider, a command, a program ---


def test_other_lengths_give_other_cuts(chosen: Chosen) -> None:
    """The material runs some 29 m in 33 s: 20 cuts of 1500 mm. 2000 mm give about three quarters of them."""
    visit = chosen("FlyingSaw", "cyclic_cut")
    assert pieces_at_the_end(visit, 33.0) == 20
    slide(visit, "cuts.length", 2000.0)
    assert pieces_at_the_end(visit, 33.0) == 15
    assert visit.readout("cuts") == "15 of 15"


def test_a_command_acts_at_the_time_that_is_shown(chosen: Chosen) -> None:
    visit = chosen("CutToLength", "basic_cut")
    visit.show(2.5)
    visit.page.get_by_role("button", name="stop", exact=True).click()
    settle(visit)
    assert pieces_at_the_end(visit, 5.0) < 3
    assert visit.page.get_by_label("time of the setting, in s").last.input_value() == "2.5"
    visit.page.get_by_role("button", name="Remove").last.click()
    settle(visit)
    badge(visit, "same bits")


def test_a_program_drives_the_saw(chosen: Chosen) -> None:
    """Its own slider changes the pieces; its mistakes are shown in one line."""
    visit = chosen("FlyingSaw", "program")
    cuts = pieces_at_the_end(visit, 33.0)
    assert cuts > 10
    slide(visit, "piece", 3000.0)
    assert pieces_at_the_end(visit, 33.0) == pytest.approx(cuts / 2, abs=2)
    text = visit.page.get_by_label("Program", exact=True)
    text.fill("return 5;")
    settle(visit)
    assert "has to return the function" in visit.page.locator("#problem").inner_text()
    text.fill("return (t, saw) => saw.set({'axis.no': 1});")
    settle(visit)
    assert visit.page.locator("#problem").inner_text() == "there is no variable axis.no"


def test_what_the_block_refuses_is_shown_in_its_words(chosen: Chosen) -> None:
    visit = chosen("FlyingSaw", "cyclic_cut")
    visit.page.get_by_label("axis.max_position", exact=True).fill("-900")
    settle(visit)
    message = visit.page.locator("#problem").inner_text()
    assert message.startswith("Refused at 0.000 s: ")
    assert "axis.max_position = -900" in message
    visit.page.get_by_label("axis.max_position", exact=True).fill("700")
    settle(visit)
    assert visit.page.locator("#problem").inner_text() == ""


# --- the measured line ---

SMOOTHED_VELOCITY = """() => {
  const [velocity] = motionsyncExplore.plots().slice(1), [, , smoothed, line] = velocity.data;
  return [Array.from(smoothed), Array.from(line)];
}"""
LOWEST_PLOT = """() => {
  const plot = motionsyncExplore.plots().at(-1);
  return [plot.axes[1].label, Array.from(plot.data[2])];
}"""


def switch(visit: Visit, on: bool) -> None:
    """Move the switch *measured line*."""
    visit.page.get_by_label("measured line", exact=True).set_checked(on)
    settle(visit)


def is_on(visit: Visit) -> bool:
    return bool(visit.page.get_by_label("measured line", exact=True).is_checked())


def line_key(visit: Visit) -> str:
    """What the lines of the plots are, as the page has it above them."""
    return " ".join(visit.page.locator(".key").inner_text().split())


def off_by(visit: Visit) -> np.ndarray:
    """The lowest plot: how far the master that the block takes is off from the true one."""
    label, values = visit.page.evaluate(LOWEST_PLOT)
    assert label.startswith("master off by")
    return np.array(values, float)


def test_every_block_with_a_master_has_the_switch(open_block: OpenBlock, block: str) -> None:
    """On a telephone, too: the plots and the key change, the page does not get wider, and the machine plays."""
    visit = open_block(block, width=390)
    if "master.position" not in Recipe(block).variables:
        assert visit.page.get_by_label("measured line", exact=True).count() == 0
        assert visit.page.get_by_label("encoder.noise", exact=True).count() == 0
        return
    assert not is_on(visit)
    assert "true master" not in line_key(visit)
    plots = visit.page.locator(".plot").count()
    switch(visit, True)
    assert visit.page.locator("#problem").inner_text() == ""
    assert visit.page.locator(".plot").count() == plots + 1
    assert "true master" in line_key(visit)
    assert "smoothed master, as the block takes it" in line_key(visit)
    wide_open(visit)
    smoothed, true = map(np.array, visit.page.evaluate(SMOOTHED_VELOCITY))
    assert 0.0 < np.std(smoothed - true) < 0.1 * np.abs(true).max()
    assert abs(np.mean(smoothed - true)) < 0.02 * np.abs(true).max()
    if not visit.page.locator(".motionsync-machine[data-time]").count():
        return  # a block may have no picture of its machine
    visit.freeze()
    visit.page.locator(".motionsync-machine").focus()
    visit.page.keyboard.press(" ")
    visit.wait(1000)
    assert visit.time == pytest.approx(1.0, abs=0.2)


def test_the_saw_makes_all_cuts_on_a_measured_line(chosen: Chosen) -> None:
    """1000 mm/s for 5 s: two pieces of 1500 mm, as without the encoder. The blade is where the cut is due to within
    some 0.1 mm, of which half a count and the noise make most."""
    visit = chosen("CutToLength", "basic_cut")
    switch(visit, True)
    assert pieces_at_the_end(visit, 5.0) == 2
    assert visit.readout("last piece") == "1500.00 mm PRODUCT"
    assert "statistics.skipped 0" in lamps(visit)
    assert "statistics.late 0" in lamps(visit)
    assert log(visit) == "The block has logged nothing."
    assert 0.02 < np.abs(off_by(visit)).max() < 0.2


def test_the_noise_of_the_smoothed_line_is_that_of_the_filter(chosen: Chosen) -> None:
    """One sigma at 1 ms and 20 ms, by the Lyapunov equation of the filter: 0.266 of the encoder's for the position, and
    0.3193 mm/s with 0.02 mm for the velocity. The filter is linear: ten times the noise makes ten times of it."""
    visit = chosen("CutToLength", "basic_cut")
    visit.page.locator("summary", has_text="The run").click()
    fill(visit, "step_size", "0.001")
    switch(visit, True)
    slide(visit, "encoder.resolution", 0.0)
    slide(visit, "encoder.delay", 0.0)
    few = off_by(visit)
    velocity, _ = map(np.array, visit.page.evaluate(SMOOTHED_VELOCITY))
    assert few[500:].std() == pytest.approx(0.266 * 0.02, rel=0.2)
    assert velocity[500:].std() == pytest.approx(0.3193, rel=0.2)
    slide(visit, "encoder.noise", 0.2)
    assert off_by(visit)[500:] == pytest.approx(10.0 * few[500:], abs=1e-6)
    slide(visit, "encoder.noise", 0.02)
    slide(visit, "master.smoothing_time", 0.08)  # 1.187 sqrt(h / tau): half of it
    assert off_by(visit)[500:].std() == pytest.approx(0.133 * 0.02, rel=0.35)


def test_what_the_block_does_not_know_of_the_encoder_shows(chosen: Chosen) -> None:
    """Without noise and counts, at 1000 mm/s: the block carries the position on over a delay that it knows; in another
    mode it knows of none, and is 1000 mm/s times 5 ms late."""
    visit = chosen("CutToLength", "basic_cut")
    switch(visit, True)
    for name, x in {"encoder.resolution": 0.0, "encoder.noise": 0.0, "encoder.delay": 0.005}.items():
        slide(visit, name, x)
    taken = visit.page.locator("#taken")
    assert off_by(visit) == pytest.approx(0.0, abs=1e-6)
    assert taken.inner_text() == (
        "The block smooths it, and carries it on to the present: master.input_mode is MEASURED."
    )
    visit.page.get_by_label("Another one", exact=True).select_option("master.delay")
    settle(visit)
    fill(visit, "master.delay", "0.007")
    assert "It does so by master.delay = 0.007 s, as the start values have it." in taken.inner_text()
    assert off_by(visit)[100:] == pytest.approx(1000.0 * 0.002, abs=1e-6)
    visit.page.get_by_label("Another one", exact=True).select_option("master.input_mode")
    visit.page.get_by_label("master.input_mode", exact=True).select_option("START_OF_STEP")
    settle(visit)
    assert taken.inner_text() == "The block does not smooth it: the start value of master.input_mode is START_OF_STEP."
    assert "smoothed" not in line_key(visit)
    assert off_by(visit)[100:] == pytest.approx(-1000.0 * 0.005, abs=1e-6)


def test_the_switch_gives_back_what_was_there(chosen: Chosen) -> None:
    """Off, the line is ideal again; on, the encoder is as it was left. The keyboard stays on the switch."""
    visit = chosen("CutToLength", "basic_cut")
    switch(visit, True)
    badge(visit, "changed")
    slide(visit, "encoder.noise", 0.1)
    slide(visit, "master.smoothing_time", 0.05)
    visit.page.get_by_label("measured line", exact=True).focus()
    visit.page.keyboard.press(" ")
    settle(visit)
    badge(visit, "same bits")
    assert visit.page.get_by_label("encoder.noise", exact=True).count() == 0
    assert "smoothed" not in line_key(visit)
    visit.page.keyboard.press(" ")
    settle(visit)
    assert is_on(visit)
    assert visit.page.get_by_label("encoder.noise", exact=True).input_value() == "0.1"
    assert visit.page.get_by_label("master.smoothing_time", exact=True).input_value() == "0.05"
    visit.page.get_by_role("button", name="As it was").click()
    assert not is_on(visit)
    badge(visit, "same bits")


def test_a_scenario_with_an_encoder_begins_with_the_switch_on(chosen: Chosen) -> None:
    visit = chosen("CutToLength", "measured_line")
    badge(visit, "same bits")
    assert is_on(visit)
    assert visit.page.get_by_label("encoder.resolution", exact=True).input_value() == "0.05"
    assert "master.delay = 0.004 s" in visit.page.locator("#taken").inner_text()
    switch(visit, False)
    badge(visit, "changed")
    assert visit.page.locator("#problem").inner_text() == ""
    switch(visit, True)
    badge(visit, "same bits")


def test_a_recorded_line_has_been_measured(chosen: Chosen) -> None:
    """Nobody knows where it truly was: its smoothing time is all that can be chosen. While the line runs evenly, its
    velocity changes by noise alone, of which less than a third is left with five times the smoothing time."""
    visit = chosen("CutToLength", "recorded_line")
    badge(visit, "same bits")
    box = visit.page.get_by_label("measured line", exact=True)
    assert (box.is_checked(), box.is_enabled()) == (True, False)
    assert visit.page.get_by_label("encoder.noise", exact=True).count() == 0
    assert "recorded master" in line_key(visit)
    before = visit.page.evaluate(SMOOTHED_VELOCITY)
    slide(visit, "master.smoothing_time", 0.1)
    after = visit.page.evaluate(SMOOTHED_VELOCITY)
    assert after[1] == before[1]
    changes = [np.median(np.abs(np.diff(smoothed))) for smoothed, _ in (before, after)]
    assert changes[1] < changes[0] / 3.0


@pytest.mark.parametrize(
    ("name", "resolution", "noise"),
    [("mm", 0.05, 0.02), ("m", 0.00005, 0.00002), ("deg", 0.02, 0.008), ("turns", 0.05, 0.02)],
)
def test_the_encoder_suits_the_unit(
    open_page: Open, fmus: Fmus, tmp_path: Path, name: str, resolution: float, noise: float
) -> None:
    """A wheel counts 0.05 mm. Else a turn has 7200 counts, or a count is the travel in 0.1 ms at the greatest velocity:
    300 deg/s make 0.03, of which 0.02 is the next round number. The sliders go up to ten times that."""
    unit, period = {"m": ("m", 0.0), "deg": ("deg", 0.0), "turns": ("deg", 360.0)}.get(name, ("mm", 0.0))
    start = f'[start]\n"master.period" = {period}\n' if period else ""
    file = tmp_path / f"{name}.toml"
    head = f'title = "A line"\nfmu = "Gearing"\nunit = "{unit}"\nstop_time = 1.0\nstep_size = 0.01\n'
    line = "[master]\nvelocity = 50.0\nsegments = [{ duration = 0.5, acceleration = 500.0 }]\n"
    file.write_text(f"{head}{start}{line}")
    page = tmp_path / "Gearing.html"
    write_page("Gearing", [load_scenario(file)], fmus.native("Gearing"), page)
    visit = open_page(page)
    visit.page.wait_for_selector("html[data-ready]")
    switch(visit, True)
    for key, x in {"resolution": resolution, "noise": noise, "delay": 0.002}.items():
        assert float(visit.page.get_by_label(f"encoder.{key}", exact=True).input_value()) == x
        slider = visit.page.get_by_label(f"encoder.{key}, slider", exact=True)
        assert float(slider.get_attribute("max")) == pytest.approx(10.0 * x)
        assert float(slider.input_value()) == pytest.approx(x)
    units = visit.page.locator('[data-name="encoder.noise"] .unit').inner_text()
    assert units == unit


# --- what the saw cannot do, and what is refused ---


def lamps(visit: Visit) -> str:
    return str(visit.page.locator("#present").inner_text())


def log(visit: Visit) -> str:
    return str(visit.page.locator("#log").inner_text())


def fill(visit: Visit, name: str, value: str) -> None:
    """Type into a field."""
    visit.page.get_by_label(name, exact=True).fill(value)
    settle(visit)


def test_a_saw_that_cannot_keep_up_is_shown(chosen: Chosen) -> None:
    """Started at 0.2 s, at 1450 mm/s until 20 s, and a cut due each 1504 mm: 28710 / 1504 = 19.1, all are skipped."""
    visit = chosen("CutToLength", "basic_cut")
    assert log(visit) == "The block has logged nothing."
    visit.page.locator("summary", has_text="The run").click()
    fill(visit, "stop_time", "20")
    fill(visit, "master.velocity", "1450")
    visit.show(0.0)
    assert "statistics.skipped 0" in lamps(visit)
    assert "line_too_fast" not in lamps(visit)
    visit.show(20.0)
    assert "warning.any: line_too_fast, " in lamps(visit)
    assert "statistics.skipped 19" in lamps(visit)
    assert "statistics.late 0" in lamps(visit)
    assert "warning.line_too_fast: the line is faster than limits.max_line_velocity" in log(visit)
    assert "statistics.skipped: cuts left out because they could not be reached: 19 in all" in log(visit)
    assert "nothing" not in log(visit)
    fill(visit, "master.velocity", "1000")
    assert log(visit) == "The block has logged nothing."


def test_a_warning_leads_to_its_time(chosen: Chosen) -> None:
    visit = chosen("CutToLength", "late_skip")
    line = visit.page.get_by_role("button", name="statistics.skipped: cuts left")
    at = float(line.inner_text().split()[0])
    line.click()
    assert visit.time == pytest.approx(at, abs=1e-3)
    assert "statistics.skipped 1" in lamps(visit)
    visit.show(at - 0.02)
    assert "statistics.skipped 0" in lamps(visit)


REFUSED = [
    ("axis.max_velocity", "-1", "Refused at 0.000 s: axis.max_velocity = -1 is not allowed: it must be 1e-12 to 1e+12"),
    ("kerf", "", "kerf = nothing is not allowed: it must be a number"),
    ("stop_time", "-1", "stop_time = -1 is not allowed: it must be > 0"),
    ("step_size", "1e-6", "step_size = 0.000001 is not allowed: it must be >= 0.000025, for at most 200000 steps"),
    ("time of the setting, in s", "7", "time of the setting = 7 is not allowed: it must be > 0 and < 5"),
]
REFUSED_WITH_AN_ENCODER = [
    ("encoder.resolution", "1e-10", "encoder.resolution = 1e-10 is not allowed: it must be 0, or >= 1e-9 and <= 1"),
    ("encoder.noise", "-0.01", "encoder.noise = -0.01 is not allowed: it must be >= 0 and <= 1000000000000"),
    ("encoder.delay", "1.5", "encoder.delay = 1.5 is not allowed: it must be >= 0 and <= 1"),
    (
        "master.smoothing_time",
        "11",
        "Refused at 0.000 s: master.smoothing_time = 11 is not allowed: it must be 0 to 10",
    ),
]


@pytest.mark.parametrize("is_measured", [False, True])
def test_what_is_refused_is_shown_and_the_run_before_marked(chosen: Chosen, is_measured: bool) -> None:
    visit = chosen("CutToLength", "basic_cut")
    visit.page.locator("summary", has_text="The run").click()
    badge(visit, "same bits")
    switch(visit, is_measured)
    write_down(visit)
    stale, saved = visit.page.locator("#stale"), visit.page.locator("#download")
    for name, value, message in REFUSED_WITH_AN_ENCODER if is_measured else REFUSED:
        field = visit.page.get_by_label(name, exact=True)
        before = field.input_value()
        field.fill(value)
        field.blur()
        settle(visit)
        assert visit.page.locator("#problem").inner_text().startswith(message)
        assert (visit.page.locator("#badge").inner_text(), visit.page.locator("#cost").inner_text()) == ("refused", "")
        assert visit.colours("#badge")[0] == visit.colours("#problem")[0]
        assert stale.is_visible()
        assert float(visit.page.locator("#plots").evaluate("e => getComputedStyle(e).opacity")) < 0.5
        assert saved.is_hidden()
        assert saved.get_attribute("href") is None
        assert field.evaluate("e => getComputedStyle(e).borderColor") == visit.colours("#badge")[0]
        visit.show(5.0)  # the run before is still whole
        assert visit.readout("last piece") == "1500.00 mm PRODUCT"
        field.fill(before)
        field.blur()
        settle(visit)
        badge(visit, "changed" if is_measured else "same bits")
        assert stale.is_hidden()
        assert saved.is_visible()
        assert visit.page.locator("#problem").inner_text() == ""


def test_another_scenario_is_no_longer_refused(chosen: Chosen) -> None:
    visit = chosen("CutToLength", "basic_cut")
    fill(visit, "kerf", "-1")
    assert visit.page.locator("#stale").is_visible()
    choose(visit, "gap")
    assert visit.page.locator("#stale").is_hidden()
    badge(visit, "same bits")


def test_the_file_follows_what_is_changed(chosen: Chosen) -> None:
    visit = chosen("CutToLength", "basic_cut")
    write_down(visit)
    file, link = visit.page.locator("#toml"), visit.page.locator("#download")
    assert "velocity = 1000.0" in file.input_value()
    slide(visit, "master.velocity", 650.0)
    visit.page.wait_for_function("document.getElementById('toml').value.includes('velocity = 650.0')")
    assert link.get_attribute("href") == "data:text/plain;charset=utf-8," + str(
        file.evaluate("e => encodeURIComponent(e.value)")
    )


LEGEND = """() => {
  const root = document.querySelector('.motionsync-machine'), svg = root.querySelector('svg');
  const colours = [...root.querySelectorAll('.legend i')].map(e => e.style.getPropertyValue('--colour'));
  const stop = +root.querySelector('input').max, drawn = new Set();
  for (let k = 0; k <= 40; k++) {
    motionsyncMachine.show(k / 40 * stop);
    colours.filter(colour => svg.innerHTML.includes(colour)).forEach(colour => drawn.add(colour));
  }
  return [colours, [...drawn]];
}"""


def test_a_page_opens_on_a_telephone_with_a_run_that_plays_and_a_legend(
    open_page: Open, fmus: Fmus, block: str
) -> None:
    """Its most telling scenario, or else the example. Each colour of the legend is one that is drawn. Between
    machine and plots are only the values that are shown, the key and the buttons; what can be changed comes next."""
    visit = open_page(explored(fmus, block).file, width=390)
    visit.page.wait_for_selector("html[data-ready]")
    assert visit.page.get_by_label("Run", exact=True).input_value() == opens_with(block)
    badge(visit, "same bits")
    boxes = [visit.page.locator(f"#{i}").bounding_box() for i in ("stage", "plots", "knobs", "log")]
    assert boxes == sorted(boxes, key=lambda box: box["y"])
    assert 0.0 < boxes[1]["y"] - (boxes[0]["y"] + boxes[0]["height"]) < 360.0
    wide_open(visit)
    if visit.page.locator(".motionsync-machine").is_hidden():
        return  # a block may have no picture
    assert visit.page.locator(".motionsync-machine").get_attribute("data-playing") == "true"
    visit.page.wait_for_function("+document.querySelector('.motionsync-machine').dataset.time > 0.1")
    colours, drawn = visit.page.evaluate(LEGEND)
    assert len(colours) >= 3
    assert set(colours) == set(drawn)


def test_the_main_values_are_at_the_top(chosen: Chosen) -> None:
    """Of the flagship those that are set during its run, too: 4 battens of 1500 are the first of 17."""
    visit = chosen("CutToLength", "cyclic_orders")
    names = visit.page.locator("#groups .knob").evaluate_all("all => all.map(e => e.dataset.name)")
    assert names[:7] == ["line.wanted_velocity", *["order.length"] * 4, *["order.quantity"] * 2]
    assert (names.count("order.length"), names.count("order.quantity")) == (4, 4)  # they are nowhere else
    slide(visit, "order.quantity at 0.1 s", 1.0)
    assert pieces_at_the_end(visit, 27.0) == 14
    fill(visit, "axis.min_position", "0")
    labels = visit.page.locator(".motionsync-machine .ground text[y='13']").all_text_contents()
    assert labels == ["home, end", "in sync", "end"]  # which are one place


@pytest.mark.parametrize(("block", "name"), [("CutToLength", "basic_cut"), ("CutToLength", "any_length")])
def test_a_value_that_limits_nothing_has_no_slider_and_widens_no_other(chosen: Chosen, block: str, name: str) -> None:
    """A line along a script asks for nothing: what it would like to run is 1e9."""
    visit = chosen(block, name)
    velocity = visit.page.locator(".knob[data-name='line.wanted_velocity']")
    assert velocity.locator("input").input_value() == "1000000000"
    assert velocity.locator("input[type=range]").count() == 0
    ranges = visit.page.locator("input[type=range]").evaluate_all("all => all.map(e => Math.max(-e.min, +e.max))")
    assert len(ranges) > 10
    assert max(ranges) < 1e8


def test_the_plots_are_saved_as_csv(chosen: Chosen, tmp_path: Path) -> None:
    """All points of the run, with all digits: 1000 mm/s for 5 s."""
    visit = chosen("CutToLength", "basic_cut")
    with visit.page.expect_download() as download:
        visit.page.get_by_role("button", name="Plots as CSV").click()
    download.value.save_as(tmp_path / "plots.csv")
    scenario = shown(load_scenario(ROOT / "scenarios" / "CutToLength" / "basic_cut" / "scenario.toml"))
    recording = record(scenario)
    with (tmp_path / "plots.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["time s"]) for row in rows] == recording.time.tolist()
    for name, unit in (("position", "mm"), ("velocity", "mm/s"), ("acceleration", "mm/s²")):
        column = [float(row[f"{name} slave {unit}"]) for row in rows]
        assert column == recording.values[f"slave.{name}"].tolist()
    assert {row["velocity master mm/s"] for row in rows} == {"1000"}


def test_a_master_in_another_unit_than_the_slave_has_an_axis_of_its_own(chosen: Chosen) -> None:
    """The line's 1000 mm/s are not drawn where the knife has 1000 deg/s. All plots are as wide as each other."""
    visit = chosen("RotaryKnife", "formats")
    labels = visit.page.evaluate("motionsyncExplore.plots().map(({axes}) => axes.slice(1).map(({label}) => label))")
    assert labels[0] == ["position deg"]  # the next cut is where the knife has to be then
    assert labels[1:3] == [["velocity deg/s", "master mm/s"], ["acceleration deg/s²", "master mm/s²"]]
    look = """() => {
      const plots = motionsyncExplore.plots(), [, velocity] = plots, [, slave, , master] = velocity.series;
      const heights = [slave, master].map(({scale}) => velocity.valToPos(1000, scale));
      return {heights, widths: plots.map(({over}) => over.clientWidth)};
    }"""
    drawn = visit.page.evaluate(look)
    slave, master = drawn["heights"]
    assert abs(slave - master) > 5.0  # px
    assert len(set(drawn["widths"])) == 1
    with visit.page.expect_download() as download:
        visit.page.get_by_role("button", name="Plots as CSV").click()
    heading = download.value.path().read_text().splitlines()[0].split(",")
    assert heading[:5] == [
        "time s", "position slave deg", "position next cut deg", "velocity slave deg/s", "velocity master mm/s"
    ]  # fmt: skip


def test_the_next_cut_is_plotted_in_each_turn_of_a_master_with_a_period(chosen: Chosen) -> None:
    """The last point before each of its three cuts: the saw of the example is almost at the line of the next one."""
    example = shown(load_example("CutToLength"))
    recording = record(example)
    before = np.flatnonzero(np.diff(recording.values["tool.cutting"]) > 0.0)
    visit = chosen("CutToLength", "example")
    line = """() => {
      const [times, slave, , other] = motionsyncExplore.plots()[0].data;
      return Array.from(times, (t, k) => [t, slave[k], other[k]]);
    }"""
    rows = visit.page.evaluate(line)
    assert [rows[k][0] for k in before] == recording.time[before].tolist()
    assert [rows[k][2] for k in before] == pytest.approx([rows[k][1] for k in before], abs=2.0)
    assert len(before) == 3


@pytest.mark.parametrize(("block", "scenario"), [("CutToLength", "cyclic_orders"), ("RotaryKnife", "formats")])
def test_the_numbers_at_an_axis_do_not_reach_its_label(chosen: Chosen, block: str, scenario: str) -> None:
    """With a jerk of 200000 mm/s3 and of 1000000 deg/s3."""
    beyond = """() => motionsyncExplore.plots().flatMap((plot) => plot.axes.slice(1).flatMap((axis, i) => {
      plot.ctx.font = axis.font[0];
      const space = axis.size(plot, axis._values, i + 1, 0) - axis.ticks.size - axis.gap;
      return axis._values.filter((text) => text && plot.ctx.measureText(text).width / uPlot.pxRatio > space);
    }))"""
    assert chosen(block, scenario).page.evaluate(beyond) == []


def test_a_line_is_drawn_where_its_values_are_and_not_at_the_next_pixels(chosen: Chosen) -> None:
    """The position of Gearing's master, which goes 800 mm at one velocity: the middle of its line in each column of
    pixels, away from the slave's line and from the grid, in the mean of nine columns."""
    off = """() => {
      const [plot] = motionsyncExplore.plots(), [times, slave, , master] = plot.data, {bbox} = plot, offsets = [];
      const {data, width} = plot.ctx.getImageData(0, 0, plot.ctx.canvas.width, plot.ctx.canvas.height);
      const high = (y) => plot.valToPos(y, "y", true), lines = plot.axes[1]._splits.map(high);
      for (let x = Math.ceil(bbox.left) + 9; x < bbox.left + bbox.width - 9; x++) {
        const t = plot.posToVal((x + 0.5 - bbox.left) / uPlot.pxRatio, "x"), k = times.findLastIndex((u) => u <= t);
        const share = (t - times[k]) / (times[k + 1] - times[k]);
        const y = high(master[k] + share * (master[k + 1] - master[k]));
        if ([...lines, high(slave[k])].some((other) => Math.abs(other - y) < 9)) continue;
        const rows = Array.from({length: 11}, (_, i) => Math.floor(y) - 5 + i);
        const red = (row) => data[4 * (row * width + x)];
        const dark = rows.map((row) => Math.abs(red(row) - red(rows[0]))), sum = dark.reduce((a, b) => a + b, 0);
        if (sum) offsets.push(dark.reduce((a, d, i) => a + d * (rows[i] + 0.5), 0) / sum - y);
      }
      return offsets;
    }"""
    offsets = chosen("Gearing", "example").page.evaluate(off)
    assert len(offsets) > 100
    assert np.abs(np.convolve(offsets, np.full(9, 1 / 9), "valid")).max() < 0.4  # px


# --- the run as a file ---


def save_run(visit: Visit, folder: Path) -> tuple[Path, str]:
    """The run as a file, and the sum in it."""
    write_down(visit)
    area = visit.page.get_by_label("The run as scenario.toml")
    file = folder / "mine" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(area.input_value(), "utf-8")
    (line,) = [line for line in file.read_text("utf-8").splitlines() if line.startswith("# SHA-256")]
    return file, line.rpartition(" ")[2]


def nothing(visit: Visit) -> None:
    """As it was."""


def shorter_cuts(visit: Visit) -> None:
    slide(visit, "cuts.length", 1200.0)
    slide(visit, "axis.max_jerk", 150000.0)


def stop_in_between(visit: Visit) -> None:
    visit.show(7.3)
    visit.page.get_by_role("button", name="stop", exact=True).click()
    settle(visit)


def other_telegrams(visit: Visit) -> None:
    slide(visit, "phase", 0.2)
    slide(visit, "jitter", 0.05)
    slide(visit, "velocity", 300.0)


def measured(visit: Visit) -> None:
    switch(visit, True)
    slide(visit, "master.smoothing_time", 0.05)


def coarse_encoder(visit: Visit) -> None:
    switch(visit, True)
    slide(visit, "encoder.resolution", 0.1)
    slide(visit, "encoder.noise", 0.05)
    slide(visit, "encoder.delay", 0.0137)
    slide(visit, "master.smoothing_time", 0.004)


def other_delay(visit: Visit) -> None:
    slide(visit, "encoder.delay", 0.011)
    slide(visit, "master.delay", 0.02)


def exact_line(visit: Visit) -> None:
    switch(visit, False)


def own_program(visit: Visit) -> None:
    text = "return (t, b) => { if (t > 1) b.set({rest_value: 10 * Math.floor(t)}); };"
    visit.page.locator("#editor summary").click()
    visit.page.get_by_label("Program", exact=True).fill(text)
    settle(visit)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("FlyingSaw/cyclic_cut", shorter_cuts),
        ("FlyingSaw/program", nothing),
        ("CutToLength/cyclic_orders", stop_in_between),
        ("RemoteSync/drift_changes", nothing),
        ("RemoteSync/fast_sender_jitter", other_telegrams),
        ("Follower/cyclic_park", nothing),
        ("Synchronizer/polynomial", own_program),
        ("Synchronizer/changing_master", measured),
        ("Gearing/rotary_axes_many_turns", coarse_encoder),
        ("Follower/end_of_step_inputs", coarse_encoder),
        ("Follower/position_to_cycle", measured),
        ("FlyingSaw/cyclic_cut", coarse_encoder),
        ("FlyingSaw/program", measured),
        ("CutToLength/cyclic_orders", coarse_encoder),
        ("CutToLength/measured_line", other_delay),
        ("CutToLength/measured_line", exact_line),
    ],
    ids=lambda value: getattr(value, "__name__", value),
)
def test_a_run_written_down_has_the_same_bits(
    chosen: Chosen, tmp_path: Path, name: str, change: Callable[[Visit], None]
) -> None:
    block, scenario = name.split("/")
    visit = chosen(block, scenario)
    change(visit)
    assert visit.page.locator("#problem").inner_text() == ""
    file, fingerprint = save_run(visit, tmp_path)
    loaded = load_scenario(file)
    assert loaded.recipe.name == block
    assert sum_of(loaded) == fingerprint


# --- the run in the address ---

SHOWN = "async () => await motionsyncExplore.fingerprint(motionsyncExplore.shown())"


def address(visit: Visit) -> str:
    """The address of the page, once it has followed what was set."""
    visit.page.wait_for_function("motionsyncExplore.address() === location.hash")
    return str(visit.page.url)


def without_the_second_order(visit: Visit) -> None:
    visit.page.get_by_role("button", name="Remove").nth(2).click()
    settle(visit)
    slide(visit, "order.length at 0.1 s", 1200.0)


def piece_of_3000(visit: Visit) -> None:
    slide(visit, "piece", 3000.0)


@pytest.mark.parametrize(
    ("block", "changes"),
    [
        (
            "CutToLength",
            {
                "cyclic_orders": [stop_in_between, without_the_second_order],
                "basic_cut": [coarse_encoder],
                "measured_line": [other_delay, exact_line],
            },
        ),
        ("FlyingSaw", {"cyclic_cut": [shorter_cuts], "program": [piece_of_3000]}),
        ("RemoteSync", {"fast_sender_jitter": [other_telegrams]}),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_the_address_brings_the_same_run_to_another_page(
    chosen: Chosen, open_block: OpenBlock, block: str, changes: dict[str, list[Callable[[Visit], None]]]
) -> None:
    """Opened with it, or while the page is open. Each change gives a run of its own."""
    visit, other, seen = chosen(block), open_block(block), set()
    for scenario, all_of_it in changes.items():
        choose(visit, scenario)
        for change in all_of_it:
            change(visit)
            other.page.goto(address(visit))
            if not seen:
                other.page.reload()
                other.page.wait_for_selector("html[data-ready]")
                other.show(0.0)
            settle(other)
            fingerprints = {one.page.evaluate(SHOWN) for one in (visit, other)}
            assert len(fingerprints) == 1, (scenario, change)
            assert not fingerprints & seen
            seen |= fingerprints
            assert other.page.get_by_label("Run", exact=True).input_value() == scenario
            assert address(other) == address(visit)
    other.page.get_by_role("button", name="As it was").click()
    assert address(other).endswith(f"#run={scenario}")


def test_an_address_that_cannot_be_followed_says_why(open_block: OpenBlock) -> None:
    """A program in it runs once somebody has looked at it: it might be anybody's."""
    visit = open_block("Synchronizer", "polynomial")
    base, unread, problem = address(visit), visit.page.locator("#unread"), visit.page.locator("#problem")
    visit.page.goto(base.replace("polynomial", "missing"))
    assert unread.inner_text() == "The address asks for missing, which this page does not have."
    visit.page.goto(f"{base}&start/__proto__=1")
    assert unread.inner_text() == (
        "Not the run of the address: the address has the place start/__proto__, which there is not."
    )
    visit.page.goto(f"{base}&start/speed=1")
    assert unread.inner_text() == "Not the run of the address: there is no variable speed."
    visit.page.goto(f"{base}&program=document.title%20%3D%20'run'%3B%20return%20()%20%3D%3E%20%7B%7D%3B")
    settle(visit)
    assert "which has not run" in problem.inner_text()
    assert visit.page.get_by_label("Program", exact=True).input_value() == "document.title = 'run'; return () => {};"
    assert visit.page.title() != "run"
    visit.page.get_by_role("button", name="Run the program").click()
    settle(visit)
    assert (problem.inner_text(), visit.page.title()) == ("", "run")


def test_a_line_that_follows_is_the_same_with_another_scan(chosen: Chosen, tmp_path: Path) -> None:
    """The lag's gain for another cycle is the page's own: `expm1` may differ in the last bit, and the pieces do not."""
    visit = chosen("CutToLength", "cyclic_orders")
    visit.page.locator("summary", has_text="The run").click()
    visit.page.get_by_label("step_size", exact=True).fill("0.008")
    settle(visit)
    file, _ = save_run(visit, tmp_path)
    loaded = load_scenario(file)
    assert loaded.scan == 0.008
    recording = record(loaded)
    assert pieces_at_the_end(visit, loaded.stop_time) == recording.values["statistics.cuts"][-1]
    shown_position = visit.number(".carriage", "slave-position")
    assert shown_position == pytest.approx(recording.values["slave.position"][-1], abs=1e-6)
    assert visit.number(".stock", "master-position") == pytest.approx(recording.master[-1, 0], abs=1e-6)


def test_the_errors_of_a_remote_axis_are_those_of_the_report(chosen: Chosen, fmus: Fmus) -> None:
    """The page makes them of its own telegrams, of which the clocks, the delay and lost ones are in these scenarios."""
    page, visit = explored(fmus, "RemoteSync"), chosen("RemoteSync")
    names = ["index", "corrected_index", "position", "corrected_position"]
    errors = """([name, all]) => {
      const {errors} = motionsyncExplore.run(name);
      return all.map((of) => [...errors[of]]);
    }"""
    for name in page.varied_scenarios():
        file = ROOT / "scenarios" / "RemoteSync" / name / "scenario.toml"
        scenario = shown(load_scenario(file) if file.is_file() else load_example("RemoteSync"))
        assert scenario.remote
        expected = remote_errors(scenario.remote, record(scenario))
        for of, result in zip(names, visit.page.evaluate(errors, [name, names]), strict=True):
            assert np.abs(getattr(expected, of) - result).max() < 1e-6, (name, of)


# --- everybody can use it ---


def test_a_page_is_small_and_whole(fmus: Fmus, block: str) -> None:
    page = explored(fmus, block)
    assert page.file.stat().st_size < 400_000
    assert page.data["name"] == block


@pytest.mark.parametrize("width", [1400, 800])
def test_the_page_is_no_wider_than_its_window(open_block: OpenBlock, width: int) -> None:
    wide_open(open_block("CutToLength", width=width))


def wide_open(visit: Visit) -> None:
    """All that can be opened on the page is open, and still the page is no wider than its window."""
    visit.page.evaluate("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
    settle(visit)
    assert visit.overflow() == 0.0


REACHED = """() => {
  const all = [...document.querySelectorAll('button, input, select, textarea, summary, a[href], [tabindex="0"]')];
  return all.filter((e) => e.checkVisibility()).length;
}"""
FOCUSED = """() => {
  document.activeElement.dataset.reached = "yes";
  return document.querySelectorAll("[data-reached]").length;
}"""


def test_the_keyboard_reaches_everything(open_block: OpenBlock) -> None:
    visit = open_block("FlyingSaw", "cyclic_cut")
    keyboard, count = visit.page.keyboard, visit.page.evaluate(REACHED)
    visit.page.evaluate("document.activeElement.blur()")
    reached = 0
    for _ in range(count + 5):
        keyboard.press("Tab")
        reached = visit.page.evaluate(FOCUSED)
    assert count > 50
    assert reached - visit.page.evaluate("+(document.body.dataset.reached === 'yes')") == count


def test_arrows_move_a_slider_and_space_plays(open_block: OpenBlock) -> None:
    visit = open_block("FlyingSaw", "cyclic_cut")
    slider = visit.page.get_by_label("cuts.length, slider", exact=True)
    slider.focus()
    visit.page.keyboard.press("ArrowRight")
    settle(visit)
    assert visit.page.get_by_label("cuts.length", exact=True).input_value() == "1505"
    badge(visit, "changed")
    visit.page.locator(".motionsync-machine").focus()
    visit.page.keyboard.press("End")
    assert visit.time == 33.0
    visit.page.keyboard.press("Home")
    visit.freeze()
    visit.page.keyboard.press(" ")
    visit.wait(1000)
    assert visit.time == pytest.approx(1.0, abs=0.2)


def test_a_time_in_a_plot_is_a_time_of_the_machine(chosen: Chosen) -> None:
    """10 s over the width of the plot: its middle is at 5 s."""
    visit = chosen("Synchronizer", "changing_master")
    box = visit.page.locator(".plot .u-over").first.bounding_box()
    visit.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert visit.time == pytest.approx(5.0, abs=0.05)


def test_the_line_of_the_time_that_is_shown_follows_the_zoom(open_block: OpenBlock) -> None:
    """3 s of 10 s; zoomed, the plots have that time in the middle, and 6 s is beyond them."""
    visit = open_block("Synchronizer", "changing_master")
    places = """() => motionsyncExplore.plots().map(({over}) => {
      const line = over.querySelector(".now"), box = over.getBoundingClientRect();
      return line.hidden ? null : (line.getBoundingClientRect().x - box.x) / box.width;
    })"""
    visit.show(3.0)
    for button, share in (("Zoom in", 0.5), ("Zoom in", 0.5), ("Whole run", 0.3), ("Zoom in", 0.5)):
        visit.page.get_by_role("button", name=button, exact=True).click()
        assert visit.page.evaluate(places) == [pytest.approx(share, abs=0.005)] * 4
    visit.show(6.0)
    assert visit.page.evaluate(places) == [None] * 4
    visit.page.set_viewport_size({"width": 700, "height": 900})
    settle(visit)
    visit.show(3.0)
    visit.page.get_by_role("button", name="Whole run").click()
    assert visit.page.evaluate(places) == [pytest.approx(0.3, abs=0.005)] * 4


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_stand_out_from_their_ground(open_block: OpenBlock, scheme: str) -> None:
    """WCAG 2.2, 1.4.3: 4.5 to 1."""
    visit = open_block("Synchronizer", color_scheme=scheme)
    ground = visit.colours("body")[1]
    badge(visit, "same bits")
    seen = [
        "body",
        ".lead",
        "#badge",
        "#title",
        ".knob .name",
        ".knob .unit",
        ".knob input",
        ".key",
        "footer",
    ]
    for selector in seen:
        assert contrast(visit.colours(selector)[0], ground) >= 4.5, selector
    assert (ground == "rgb(255, 255, 255)") == (scheme == "light")


RAMP = """\
title = "A line that ramps up, runs, and stops"
fmu = "CutToLength"
stop_time = 5.0
step_size = 0.01
[start]
"axis.max_position" = 2000.0
length = 900.0
[master]
segments = [{segments}]
[[set]]
at = 0.1
start = true
"""
RAMPS = {  # segments; when the first ramp ends, and with which velocity, by hand; when the line stops
    "at_once": (
        "{duration = 1.0, acceleration = 400.0}, {duration = 2.0}, {duration = 2.0, acceleration = -200.0}",
        1.0,
        400.0,
    ),
    "after_a_while": ("{duration = 0.5}, {duration = 2.5, acceleration = 100.0}, {duration = 2.0}", 3.0, 250.0),
    "with_jerk": ("{duration = 1.0, jerk = 300.0}, {duration = 1.0, jerk = -300.0}, {duration = 1.0}", 2.0, 300.0),
}


def test_the_first_slider_of_a_line_that_ramps_is_the_velocity_to_which_it_ramps(
    open_page: Open, fmus: Fmus, tmp_path: Path
) -> None:
    """Its ramps keep their times, so a line that stops still stops; a line that starts with a velocity has that."""
    for name, (segments, *_) in RAMPS.items():
        (tmp_path / f"{name}.toml").write_text(RAMP.format(segments=segments))
    page = tmp_path / "CutToLength.html"
    write_page("CutToLength", [load_scenario(tmp_path / f"{n}.toml") for n in RAMPS], fmus.native("CutToLength"), page)
    visit = ready(open_page(page))
    for (name, (_, end, velocity)), chosen_velocity in zip(RAMPS.items(), (700.0, 130.0, 210.0), strict=True):
        choose(visit, name)
        row = visit.page.locator("#groups .knob").first
        assert row.inner_text().split() == ["master.velocity", "from", f"{end:g}", "s", "on", "mm/s"]
        assert float(row.locator("input[type=number]").input_value()) == velocity
        slide(visit, f"master.velocity from {end:g} s on", chosen_velocity)
        (tmp_path / name).mkdir()
        script = load_scenario(save_run(visit, tmp_path / name)[0]).master
        original = load_scenario(tmp_path / f"{name}.toml").master
        for t in (0.3, 0.9, end, 4.0, 5.0):
            expected = original.at(t).velocity * chosen_velocity / velocity
            assert script.at(t).velocity == pytest.approx(expected, abs=1e-9 * velocity)
        assert script.at(end).velocity == pytest.approx(chosen_velocity)
        if name == "at_once":
            visit.page.get_by_text("Segments", exact=True).click()
        fill(visit, "1: acceleration" if name == "at_once" else "velocity", "50")
        shown_velocity = float(row.locator("input[type=number]").input_value())
        assert shown_velocity == pytest.approx(50.0 if name == "at_once" else chosen_velocity + 50.0)
        visit.page.get_by_role("button", name="As scenario.toml").click()
