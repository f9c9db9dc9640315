"""The table [encoder]: what is measured of the master, in Python and in compiled code, as an oracle has it."""

import io
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync_fmu.batch.scripted_runs import run_scenarios
from motionsync_fmu.errors import UserError
from motionsync_fmu.runner import noise
from motionsync_fmu.runner.encoder import sine
from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.evaluate.csv_files import write_outputs
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process, scheduled_steps
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script, Segment
from motionsync_fmu.scenario.variation.scenario_variation import ScenarioVariation
from tests.oracle.measured_line import encoder as oracle
from tests.oracle.numerics import mp, splitmix64
from tests.support.scenarios.recordings import assert_as_in_python
from tests.support.scenarios.scenario_texts import COUPLED, ENCODED_SAW, write_scenario

LINE = """\
title = "A measured line"
fmu = "Gearing"
stop_time = 0.5
step_size = 0.004

[start]
"gear_in.start_mode" = "CW_CCW_DIRECT"
"gear_in.transition" = "NONE"

[master]
position = 12.0
velocity = 300.0
acceleration = 100.0
segments = [{ duration = 0.1501, acceleration = 800.0 }, { duration = 0.1, jerk = -9000.0 }, { duration = 0.1 }]

[encoder]
resolution = 0.05
noise = 0.02
delay = 0.0035
scale = 1.0005
runout = { amplitude = 0.05, length = 500.0 }
sample_time = 0.002
seed = 7

[[set]]
at = 0.1003
start = true
"""
EXACT = """\
[encoder]
delay = 0.0035
scale = 1.0005
runout = { amplitude = 0.05, length = 500.0 }
"""


def load(folder: Path, text: str = LINE) -> Scenario:
    return load_scenario(write_scenario(text, folder))


def without_noise() -> str:
    """The line with an encoder whose values are those of their own time at every step size."""
    return LINE[: LINE.index("[encoder]")] + EXACT + LINE[LINE.index("\n[[set]]") :]


# --- against the oracle ---

REALS = st.floats(-1e3, 1e3)
LINES = st.fixed_dictionaries(
    {
        **dict.fromkeys(("position", "velocity", "acceleration"), REALS),
        "segments": st.lists(
            st.builds(
                lambda duration, kind, value: {"duration": duration} | ({kind: value} if kind else {}),
                st.floats(0.01, 0.5),
                st.sampled_from(["velocity", "acceleration", "jerk", ""]),
                REALS,
            ),
            max_size=3,
        ),
    }
)
ENCODERS = st.builds(
    Encoder,
    st.sampled_from([0.0, 0.1, 1e-3, 7.3]),
    st.sampled_from([0.0, 0.02, 5.0]),
    st.sampled_from([0.0, 0.004, 0.3]) | st.floats(0.0, 1.0),
    st.sampled_from([1.0, 1.0005]) | st.floats(0.5, 2.0),
    st.sampled_from([0.0, 0.05]) | st.floats(0.0, 10.0),
    st.floats(1.0, 1e3),
    st.sampled_from([0.0, 0.002, 0.0037]),
    st.integers(0, 2**32 - 1),
)


def scripted(line: dict[str, Any]) -> Script:
    initial = (line["position"], line["velocity"], line["acceleration"])
    return Script(*initial, [Segment(**segment) for segment in line["segments"]])


def independent(e: Encoder) -> oracle.Encoder:
    runout = (e.runout_amplitude, e.runout_length)
    return oracle.Encoder(e.resolution, e.noise, e.delay, e.scale, *runout, e.sample_time, e.seed)


@given(encoder=ENCODERS, line=LINES, h=st.sampled_from([0.001, 0.0013]), k=st.integers(0, 2000), between=st.booleans())
def test_readings_are_those_of_the_oracle(
    encoder: Encoder, line: dict[str, Any], h: float, k: int, between: bool
) -> None:
    """At a communication point, or a third of a step after it, where the noise is still that of the point.

    Where the position is very near to a multiple of the resolution, either of two counts is right."""
    t = k * h + (h / 3.0 if between else 0.0)
    expected, true = independent(encoder), oracle.scripted_line(line, 10.0)
    interval = encoder.sample_time or h
    n = int(mp.floor(mp.mpf(t) / interval + mp.mpf("1e-9")))
    ((position, velocity, acceleration),) = encoder.readings(scripted(line), [t], h, 0.0)
    assert near(position, encoder, expected.continuous(t, n, true))
    if n == 0:
        return
    samples = [expected.continuous(mp.mpf(i) * interval, i, true) for i in (n - 1, n)]
    counts = [
        float(mp.floor(s / encoder.resolution) * encoder.resolution if encoder.resolution else s) for s in samples
    ]
    possible = encoder.resolution if any(is_edge(encoder, s) for s in samples) else 0.0
    assert abs(velocity - (counts[1] - counts[0]) / interval) <= (1e-9 + 1.001 * possible) / interval
    assert acceleration == 0.0


def is_edge(encoder: Encoder, continuous: Any) -> bool:
    """Whether rounding decides how many multiples of the resolution this is."""
    return (
        bool(encoder.resolution)
        and abs(continuous / encoder.resolution - mp.nint(continuous / encoder.resolution)) < 1e-6
    )


def near(position: float, encoder: Encoder, continuous: Any) -> bool:
    if not encoder.resolution:
        return abs(position - continuous) < 1e-9
    count = mp.floor(continuous / encoder.resolution)
    right = [count + i for i in ((-1, 0, 1) if is_edge(encoder, continuous) else (0,))]
    return any(abs(position - c * encoder.resolution) < 1e-9 for c in right)


@pytest.mark.parametrize("seed", [0, 1, 2**32 - 1])
@pytest.mark.parametrize("n", [0, 1, 1023, 1024, 715827882, 2**33])
def test_noise_is_that_of_the_oracle_to_the_last_bit(seed: int, n: int) -> None:
    assert [noise.sample(seed, i) for i in range(n, n + 9)] == [
        splitmix64.noise_sample(seed, i) for i in range(n, n + 9)
    ]


def test_the_sine_is_exact_where_it_is_a_simple_number_and_near_it_elsewhere() -> None:
    """sin(2 pi x) at twelfths of a turn, in any turn; elsewhere within 3e-16."""
    twelfths = [sine(turn + x) for turn in (-3.0, 0.0, 7.0) for x in (0.0, 0.25, 0.5, 0.75)]
    assert twelfths == [0.0, 1.0, 0.0, -1.0] * 3
    for i in range(-1000, 1000):
        x = i / 730.0
        assert abs(sine(x) - mp.sin(2 * mp.pi * mp.mpf(x))) < 4e-16


def test_a_position_just_below_zero_is_wrapped_to_zero() -> None:
    encoder = Encoder()
    for start, shown in ((-1e-20, 0.0), (-1.0, 359.0)):
        ((position, _, _),) = encoder.readings(Script(start, 0.0, 0.0, []), [0.0], 0.01, 360.0)
        assert position == shown


def test_a_line_that_runs_at_the_start_is_measured_with_its_motion_of_the_delay_before() -> None:
    """At -0.1 s it was at 10 - 20 * 0.1 + 5 * 0.01 = 8.05 mm with 20 - 1 = 19 mm/s; measured twice as much."""
    encoder = Encoder(delay=0.1, scale=2.0)
    (measured,) = encoder.readings(Script(10.0, 20.0, 10.0, [Segment(1.0, velocity=500.0)]), [0.0], 0.01, 0.0)
    assert measured == pytest.approx((16.1, 38.0, 20.0), abs=1e-12)


# --- what the block is given ---


def test_without_an_input_mode_the_block_smooths_and_makes_up_for_the_delay(tmp_path: Path) -> None:
    start = load(tmp_path).start
    assert [*start.items()][:3] == [
        ("master.input_mode", MasterInput.MEASURED),
        ("master.delay", 0.0035),
        ("master.sample_time", 0.002),
    ]


def test_start_values_of_the_file_are_taken(tmp_path: Path) -> None:
    own = load(tmp_path, LINE.replace("[start]\n", '[start]\n"master.delay" = 0.01\n')).start
    assert (own["master.input_mode"], own["master.delay"], own["master.sample_time"]) == (4, 0.01, 0.002)
    other = load(tmp_path, LINE.replace("[start]\n", '[start]\n"master.input_mode" = "POSITION_ONLY"\n')).start
    assert other["master.input_mode"] == MasterInput.POSITION_ONLY
    assert not {"master.delay", "master.sample_time"} & {*other}


@pytest.mark.parametrize("mode", ["", '"master.input_mode" = "POSITION_ONLY"\n'])
@pytest.mark.parametrize("resolution", [0.1, 0.05])
def test_a_block_that_can_know_the_resolution_does(tmp_path: Path, mode: str, resolution: float) -> None:
    """In every mode: the profile that does not overshoot is only planned if the master has no acceleration, and with
    437.7 mm/s the second difference of the position at 0.2 s is one count. Other blocks have no place for it."""
    text = ENCODED_SAW.replace("[start]\n", "[start]\n" + mode).replace(
        "resolution = 0.1", f"resolution = {resolution}"
    )
    scenario = load(tmp_path, text)
    assert scenario.start["master.encoder_scaling"] == resolution
    assert "master.encoder_scaling" not in load(tmp_path).start
    assert run_in_process(scenario, scenario.step_size).values["error_id"][-1] == 0
    own = load(tmp_path, text.replace("[start]\n", '[start]\n"master.encoder_scaling" = 0.0\n'))
    assert own.start["master.encoder_scaling"] == 0.0
    assert run_in_process(own, own.step_size).values["error_id"][-1] == 0x42DF


def test_a_resolution_that_is_varied_is_known(tmp_path: Path) -> None:
    variation = ScenarioVariation(ENCODED_SAW, write_scenario(ENCODED_SAW, tmp_path))
    target = variation.target("encoder.resolution")
    for resolution in (0.2, 0.0, 1e-9):
        assert variation.with_values([(target, resolution)]).start["master.encoder_scaling"] == resolution


def test_the_line_is_followed_without_a_transient(tmp_path: Path) -> None:
    """An exact encoder, of a line with constant acceleration, which the file states: the block has the true motion."""
    text = without_noise().replace("scale = 1.0005\nrunout = { amplitude = 0.05, length = 500.0 }\n", "")
    text = (
        text[: text.index("segments")] + "segments = [{ duration = 1.0, jerk = 0.0 }]\n" + text[text.index("\n[enc") :]
    )
    scenario = load(tmp_path, text)
    recording = run_in_process(scenario, scenario.step_size)
    np.testing.assert_allclose(recording.values["master.smoothed_position"], recording.master[:, 0], atol=1e-9)
    np.testing.assert_allclose(recording.values["master.smoothed_velocity"], recording.master[:, 1], atol=1e-7)


def test_readings_without_noise_do_not_depend_on_the_step_size(tmp_path: Path) -> None:
    scenario = load(tmp_path, without_noise())
    readings = []
    for h in (0.004, 0.002, 0.0005):
        steps = scheduled_steps(scenario, h)
        readings.append({round(t, 9): values["master.position"] for t, _, values in steps})
    common = readings[0].keys() & readings[1].keys() & readings[2].keys()
    assert len(common) > 100
    for t in common:
        assert max(abs(r[t] - readings[0][t]) for r in readings) < 1e-9


def test_a_run_with_noise_and_a_sample_time_is_the_same_at_every_step_size(tmp_path: Path) -> None:
    text = LINE.replace("sample_time = 0.002", "sample_time = 0.004")
    scenario = load(tmp_path, text)
    runs = [run_in_process(scenario, h) for h in (0.004, 0.002, 0.001)]
    for name in ("slave.position", "master.smoothed_position", "slave.velocity"):
        at = [dict(zip(np.round(r.time, 9).tolist(), r.values[name].tolist(), strict=True)) for r in runs]
        times = [t for t in at[0] if t in at[1] and t in at[2] and round(t / 0.004, 6).is_integer()]
        assert len(times) > 100
        for t in times:
            assert max(abs(values[t] - at[0][t]) for values in at) < 1e-7, (name, t)


def test_results_have_the_true_master_and_the_measured_one(tmp_path: Path) -> None:
    scenario = load(tmp_path)
    recording = run_in_process(scenario, scenario.step_size)
    out = io.StringIO()
    write_outputs(out, scenario, recording)
    head, *rows = out.getvalue().splitlines()
    names = [name.strip('"') for name in head.split(",")]
    assert names[:7] == [
        "time",
        *(f"true.master.{name}" for name in ("position", "velocity", "acceleration", "jerk")),
        "master.position",
        "master.velocity",
    ]
    given_to_block = {t: values for t, _, values in scheduled_steps(scenario, scenario.step_size)}
    assert len(rows) == len(given_to_block) + 1
    for row in rows[:-1]:
        time, true, *_, position, velocity = map(float, row.split(",")[:7])
        assert (position, velocity) == tuple(given_to_block[time][f"master.{n}"] for n in ("position", "velocity"))
        assert true == scenario.master.until(time).position or time == 0.0
        assert abs(position - true) < 6.0


# --- a line that follows its slave ---

DRIVEN = COUPLED.replace(
    "[[set]]\nat = 0.1", "[encoder]\ndelay = 0.137\nnoise = 0.01\nsample_time = 0.004\n\n[[set]]\nat = 0.2"
)


def test_a_line_that_follows_the_block_is_remembered(tmp_path: Path) -> None:
    """Also without a recording, where compiled code keeps no more of the line than the encoder still measures."""
    scenario = load(tmp_path, DRIVEN)
    recorded = assert_as_in_python(scenario).recording
    assert recorded
    outputs = ("slave.position", "master.smoothed_position")
    (run,) = run_scenarios([scenario], [], dict.fromkeys(outputs, ("last", "max", "mean")))
    (again,) = run_scenarios([scenario], outputs, dict.fromkeys(outputs, ("last", "max", "mean")))
    assert run.measures == again.measures
    for name in outputs:
        assert run.measures[f"{name}.last"] == recorded.values[name][-1]


def test_the_recorded_inputs_of_such_a_run_are_those_of_the_run(tmp_path: Path) -> None:
    """What is written for other tools: the master's motion of the run takes the place of its drive."""
    scenario = load(tmp_path, DRIVEN)
    recording = run_in_process(scenario, scenario.step_size)
    assert recording.script
    settled = scenario.with_recorded_inputs(recording.settings, recording.script)
    again = run_in_process(settled, scenario.step_size)
    at = np.isin(again.time, recording.time)
    assert np.count_nonzero(at) > 200
    assert math.isclose(again.values["slave.position"][-1], recording.values["slave.position"][-1], abs_tol=1.0)


# --- values by their names ---


@pytest.mark.parametrize(
    ("name", "value"),
    [("seed", 3.0), ("noise", 0.5), ("resolution", 0.1), ("delay", 0.1), ("scale", 1.1), ("sample_time", 0.1)],
)
def test_each_number_can_be_varied(tmp_path: Path, name: str, value: float) -> None:
    variation = ScenarioVariation(LINE, write_scenario(LINE, tmp_path))
    varied = variation.with_values([(variation.target(f"encoder.{name}"), value)])
    assert varied.encoder == replace(load(tmp_path).encoder or Encoder(), **{name: value})
    if name in ("delay", "sample_time"):
        assert varied.start[f"master.{name}"] == value


def test_the_runout_and_what_is_left_out_can_be_varied(tmp_path: Path) -> None:
    text = LINE.replace("noise = 0.02\n", "")
    variation = ScenarioVariation(text, write_scenario(text, tmp_path))
    names = ("encoder.runout.amplitude", "encoder.noise")
    varied = variation.with_values([(variation.target(name), 0.25) for name in names])
    assert varied.encoder
    assert (varied.encoder.runout_amplitude, varied.encoder.noise) == (0.25, 0.25)


# --- mistakes ---


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("resolution = 0.05", "resolutoin = 0.05", 17, "resolutoin: unknown key; there is resolution, noise, delay, "),
        ("resolution = 0.05", "resolution = -1", 17, "resolution: -1 is not allowed: it must be >= 0 and <= 1e+12"),
        (
            "resolution = 0.05",
            "resolution = 1e-10",
            17,
            "resolution: 1e-10 is not allowed: it must be 0, or 1e-09 to 1e+12",
        ),
        ("noise = 0.02", "noise = nan", 18, "noise: nan is not allowed: it must be finite"),
        ("noise = 0.02", "noise = -0.1", 18, "noise: -0.1 is not allowed: it must be >= 0 and <= 1e+12"),
        ("delay = 0.0035", "delay = 1.1", 19, "delay: 1.1 is not allowed: it must be >= 0 and <= 1"),
        ("scale = 1.0005", "scale = 0", 20, "scale: 0 is not allowed: it must be > 0 and <= 1e+12"),
        ("amplitude = 0.05, ", "", 21, "amplitude: is missing"),
        ("amplitude = 0.05, ", "amplitude = -1, ", 21, "amplitude: -1 is not allowed: it must be >= 0 and <= 1e+12"),
        ("length = 500.0", "length = 0.0", 21, "length: 0 is not allowed: it must be >= 1e-09 and <= 1e+12"),
        ("length = 500.0", "phase = 0.0", 21, "phase: unknown key; there is amplitude, length"),
        ("{ amplitude = 0.05, length = 500.0 }", "0.05", 21, "runout: must be a table"),
        ("sample_time = 0.002", "sample_time = 2", 22, "sample_time: 2 is not allowed: it must be >= 0 and <= 1"),
        ("seed = 7", "seed = -1", 23, "seed: -1 is not allowed: it must be 0 to 4294967295"),
        ("seed = 7", "seed = 4294967296", 23, "seed: 4294967296 is not allowed: it must be 0 to 4294967295"),
        ("seed = 7", "seed = 0.5", 23, "seed: 0.5 is not a whole number"),
    ],
)
def test_a_mistake_is_one_line_with_its_place(tmp_path: Path, old: str, new: str, line: int, message: str) -> None:
    file = write_scenario(LINE.replace(old, new), tmp_path)
    with pytest.raises(UserError) as error:
        load_scenario(file)
    assert str(error.value).startswith(f"{file}:{line}: {message}")
    assert "\n" not in str(error.value)


def test_a_block_without_a_master_has_no_encoder(tmp_path: Path) -> None:
    text = (
        'title = "x"\nfmu = "RemoteSync"\nstop_time = 1.0\nstep_size = 0.01\n[remote]\nsender_cycle = 0.01\n[encoder]\n'
    )
    with pytest.raises(UserError, match=r":7: encoder: RemoteSync has no inputs master\.\*"):
        load(tmp_path, text)
