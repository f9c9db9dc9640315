"""Lines: a remote axis through RemoteSync into a follower, wired in an SSP package; libcosim gives the same."""

import math
import re
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv

from motionsync.remote_sync.interface import Estimator
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.production_line.line import REMOTE
from motionsync_fmu.production_line.package import PARAMETERS, write_package
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.production_line.variants import RAW, run_through_remote_sync
from motionsync_fmu.scenario.clocks import Rate
from tests.line.conftest import Examined, examined
from tests.support.hosts.cosim import run_cosim
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.scenarios.lines import LINES, SAW, copied, integrated

CYCLE, PPM, PHASE = 0.002, 300e-6, 0.665  # of line.toml

MATERIAL = [(0.5, 0.0), (2.0, 500.0), (6.5, 0.0), (1.5, -200.0), (4.5, 0.0), (2.0, 200.0), (6.0, 0.0), (1.0, -200.0)]
AXIS = [(0.5, 720.0), (11.5, 0.0), (1.0, -180.0), (4.0, 0.0), (2.0, 180.0)]


def test_the_example_of_the_page_is_as_expected(shared: Shared, fmus: Fmus, tmp_path: Path) -> None:
    """Copied unchanged: one cut, on its mark within what telegrams allow. Its FMUs are those of line.toml."""
    (example,) = re.findall(r"```toml\n(.*?)```", (LINES / "README.md").read_text(), re.DOTALL)
    file = tmp_path / SAW.name
    file.write_text(example)
    result = examined(file, copied(shared, fmus, tmp_path / "built")).result
    assert [c for c in result.checks if not c.passed] == []
    assert any(c.expected.startswith("cuts within 0.05") for c in result.checks)
    assert result.passed


# --- the package ---


@pytest.mark.parametrize("name", ["saw", "synchronizer", "machine"])
def test_the_package_is_valid(name: str, request: pytest.FixtureRequest) -> None:
    run: Examined = request.getfixturevalue(name)
    follower = run.line.follower.recipe.name
    ssd = read_ssd(str(run.package.ssp), validate=True)  # against the schemas of SSP 1.0
    read_ssv(str(run.package.ssp), PARAMETERS, validate=True)
    assert [(c.name, c.source) for c in ssd.system.elements] == [
        (component, f"resources/{component}.fmu") for component in ("RemoteSync", follower)
    ]
    wires = {
        (c.startElement, c.startConnector, c.endElement, c.endConnector)
        for c in ssd.system.connections
        if c.startElement and c.endElement
    }
    assert wires == {
        ("RemoteSync", f"slave.{n}", follower, f"master.{n}") for n in ("position", "velocity", "acceleration")
    }
    with zipfile.ZipFile(run.package.ssp) as z:
        members = {"SystemStructure.ssd", PARAMETERS, "resources/RemoteSync.fmu", f"resources/{follower}.fmu"}
        assert set(z.namelist()) == members
        assert z.read("resources/RemoteSync.fmu") == run.package.fmus["RemoteSync"].read_bytes()


def test_its_parameters_are_inside(saw: Examined) -> None:
    (binding,) = read_ssd(str(saw.package.ssp)).system.parameterBindings
    values = {p.name: (p.type, p.value) for p in binding.parameterValues[0].parameters}
    assert values["RemoteSync.delay_time_offset"] == ("Real", "0.002")
    assert values["FlyingSaw.axis.max_velocity"] == ("Real", "1500.0")
    assert values["FlyingSaw.sync_mode.check_max_velocity"] == ("Boolean", "true")
    assert not any("estimator" in name for name in values)  # an enumeration: baked in
    with zipfile.ZipFile(saw.package.fmus["RemoteSync"]) as z:
        description = fromstring(z.read("modelDescription.xml"))
    (start,) = description.iterfind("ModelVariables/ScalarVariable[@name='estimator']/Enumeration")
    assert start.get("start") == str(int(Estimator.PHASE))


def test_a_package_is_the_same_every_time(saw: Examined, output: Path) -> None:
    first, second = (write_package(saw.line, Flavour.NATIVE, output, pytest.fail).ssp.read_bytes() for _ in range(2))
    assert first == second


def test_the_example_for_fmpy_runs(saw: Examined) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", (LINES / "README.md").read_text(), re.DOTALL)
    exec(code.replace("build/line.ssp", str(saw.package.ssp)), {})


# --- both runs ---


@pytest.mark.parametrize("name", ["saw", "synchronizer", "machine"])
def test_fmpy_and_libcosim_agree_after_two_steps(name: str, request: pytest.FixtureRequest) -> None:
    """In the first step FMPy's inputs are zero. The tolerance is relative to each output's greatest magnitude."""
    run: Examined = request.getfixturevalue(name)
    follower = run.line.follower.recipe.name
    of_fmpy = {REMOTE: run.result.remote, follower: run.result.wired.recording.values}
    compared = 0
    for component, outputs in run_cosim(run.line, run.package).items():
        for output, values in outputs.items():
            expected = of_fmpy[component][output]
            is_sharp = component == REMOTE or output == "slave.position"
            tolerance = 1e-11 if is_sharp else 1e-9 * max(1.0, float(np.abs(expected).max()))
            np.testing.assert_allclose(values[2:], expected[2:], rtol=0.0, atol=tolerance, err_msg=output)
            compared += 1
    assert compared > 15


def test_an_fmu_alone_after_the_other_gives_the_wired_line(saw: Examined) -> None:
    """A parallel co-simulation hands values over one step later; nothing else is between the FMUs."""
    remote, follower = run_through_remote_sync(saw.line, saw.package)
    for name, values in remote.items():
        assert np.array_equal(values[2:], saw.result.remote[name][2:]), name
    for name, values in follower.items():
        wired = saw.result.wired.recording.values[name]
        assert values == pytest.approx(wired, rel=1e-9, abs=1e-9), name


def test_without_drift_and_jitter_nothing_lags(saw: Examined) -> None:
    clocks = replace(saw.line.remote.clocks, rates=[Rate(0.0, CYCLE)], phase=0.0, jitter=0.0)
    line = replace(saw.line, remote=replace(saw.line.remote, clocks=clocks))
    _, follower = run_through_remote_sync(line, saw.package, {"estimator": Estimator.BEAT})
    synced = follower["in_sync"] > 0.0
    material = np.array([integrated(MATERIAL, t) for t in line.times.tolist()])
    positions = material[synced] - follower["slave.position"][synced]
    marks = np.round(positions / 1500.0)
    assert set(marks) == set(range(1, 15))
    errors = np.abs(positions - 1500.0 * marks)
    smooth = np.ones(len(positions), bool)
    for t in np.cumsum(
        [duration for duration, _ in MATERIAL]
    ):  # where the acceleration jumps: this cannot be predicted
        smooth &= np.abs(line.times[synced] - t) > 2.5 * CYCLE
    assert errors[smooth].max() < 1e-10
    assert errors.max() < 1.01 * 200.0 * CYCLE**2 / 2.0


# --- errors with and without RemoteSync ---


def test_the_cuts_are_on_their_marks_with_remote_sync(saw: Examined) -> None:
    """Computed independently, from the script and the results alone."""
    result, wired = saw.result, saw.result.wired.recording
    material = np.array([integrated(MATERIAL, t) for t in wired.time.tolist()])
    assert np.abs(material - wired.master[:, 0]).max() < 1e-8
    assert len(result.wired.cuts) == 14
    late = [c for c in result.wired.cuts if c.begin > result.settled]
    assert len(late) == 9
    for number, c in enumerate(result.wired.cuts, 1):
        inside = (wired.time >= c.begin) & (wired.time <= c.end)
        assert wired.values["in_sync"][inside].all()
        errors = material[inside] - wired.values["slave.position"][inside] - 1500.0 * number
        assert (c.place, np.abs(errors).max()) == pytest.approx((1500.0 * number, abs(c.error)), abs=1e-8)
    assert max(abs(c.error) for c in late) < 0.01
    assert result.passed


def test_without_remote_sync_they_are_off_by_the_age_of_the_telegram(saw: Examined) -> None:
    """At 66 m/min, cuts 10 to 12: the telegram in use was sent a share of a cycle ago, that of its index."""
    raw = saw.variant(RAW)
    for c in raw.cuts[9:12]:
        index = PHASE + (c.end - CYCLE) / CYCLE * (1.0 + PPM)  # at the beginning of the cut's last step
        age = index % 1.0 * CYCLE / (1.0 + PPM)
        assert c.error == pytest.approx(1100.0 * age, abs=1e-6)
    late = [c.error for c in raw.cuts if c.begin > saw.result.settled]
    assert max(late) > 1.5
    assert max(late) - min(late) > 1.5  # so no constant dead time would help


def test_a_skipped_telegram_within_a_cut_is_a_jump_without_remote_sync(saw: Examined) -> None:
    after = {f.name: f for f in saw.result.after}
    jumps = {name: f.jump for name, f in after.items()}
    assert jumps[RAW] == pytest.approx(2.0, abs=0.1)  # a cycle of 2 ms at 1 m/s
    assert (jumps["RemoteSync, PHASE"] or math.inf) < 0.005


def test_the_estimators_are_compared(saw: Examined) -> None:
    worst = {f.name: f.worst for f in saw.result.after}
    assert list(worst) == ["RemoteSync, PHASE", RAW, "RemoteSync, BEAT", "RemoteSync, BEAT, uniform"]
    phase, raw, beat, uniform = (w or math.nan for w in worst.values())
    assert phase < uniform / 5.0 < beat / 20.0 < raw / 20.0


def test_until_the_drift_is_determined_the_cuts_are_worse(saw: Examined) -> None:
    before, after = saw.result.before[0], saw.result.after[0]
    assert 9.0 < saw.result.synced < saw.result.settled < 9.6
    assert before.cuts == 5
    assert 0.1 < (before.worst or 0.0) < 1.0
    assert (after.worst or math.inf) < 0.05 * (before.worst or 0.0)


def test_a_synchronizer_switches_at_its_positions(synchronizer: Examined) -> None:
    result, wired = synchronizer.result, synchronizer.result.wired
    assert result.passed
    assert [s.place for s in wired.switches] == [90.0, 101.25] * 7
    for s in wired.switches:
        angle = integrated(AXIS, s.begin)  # at the first point of the ramp: it began less than a step ago
        before = integrated(AXIS, s.begin - CYCLE)
        beyond = (angle - s.place + 180.0) % 360.0 - 180.0
        assert -1e-9 <= beyond - s.error <= angle - before + 1e-9
    late = [abs(s.error) for s in wired.switches if s.begin > result.settled]
    assert len(late) == 9
    assert max(late) < 0.01
    raw = [abs(s.error) for s in synchronizer.variant(RAW).switches if s.begin > result.settled]
    assert max(raw) > 0.9
    slave = {f.name: f.deviation for f in result.after}
    assert (slave["RemoteSync, PHASE"] or math.inf) < 0.01
    assert (slave[RAW] or 0.0) > 1.0


WIRED = 'estimator = "PHASE"'
MISTAKES = {  # the old text, the new text, the message, a part of the line that it names
    "who follows": ('fmu = "FlyingSaw"', 'fmu = "RemoteSync"', "fmu: RemoteSync sees telegrams itself", "fmu ="),
    "no such block": ('fmu = "FlyingSaw"', 'fmu = "Saw"', "fmu: no block is named 'Saw'", "fmu ="),
    "the receiver's cycle": (WIRED, "task_cycle_time = 1.0", "task_cycle_time: is the line's step_size", "task_cycle"),
    "enable": (WIRED, "enable = true", "enable: is set by the line itself", "enable ="),
    "unknown parameter": (WIRED, "estimater = 1", "RemoteSync has no variable 'estimater'", "estimater"),
    "no such estimator": (WIRED, 'estimator = "GUESS"', "estimator: 'GUESS' is no Enumeration", "GUESS"),
    "out of its range": (WIRED, "threshold_for_sync = 0.0", "threshold_for_sync = 0 is not allowed", "threshold"),
    "unknown start value": ("axis.max_jerk", "axis.max_jrk", "FlyingSaw has no variable 'axis.max_jrk'", "max_jrk"),
    "the master is wired": ("axis.max_jerk", "master.velocity", "master.velocity: comes from RemoteSync", "master."),
    "no sender's cycle": ("sender_cycle = 0.0", "#", "sender_cycle: is missing", "[remote]"),
    "accuracy": ("seed = 1", "seed = 1\naccuracy = {}", "accuracy: a line is checked by", "accuracy ="),
    "no ramps": ("[cuts]", "[switches]\n[cuts]", "switches: FlyingSaw is not switched on and off", "[switches]"),
    "an enumeration": ('"slave.velocity" = {', "plcopen_state = {", "plcopen_state: is an enumeration", "plcopen"),
    "a scenario's key": ("step_size =", "tolerance = 1.0\nstep_size =", "tolerance: unknown key", "tolerance ="),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, message, line_text = MISTAKES[name]
    text = SAW.read_text()
    assert text.count(old) == 1
    file = tmp_path / "line.toml"
    file.write_text(text.replace(old, new))
    with pytest.raises(UserError) as e:
        load_line(file)
    match = re.fullmatch(rf"{re.escape(str(file))}:(\d+): (.*)", str(e.value))
    assert match, str(e.value)
    assert message in match[2]
    assert line_text in file.read_text().splitlines()[int(match[1]) - 1]
