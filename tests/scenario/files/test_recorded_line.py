"""A line that was recorded: the file that [master] names, what the block gets of it, and mistakes in both."""

import io
import os
import tracemalloc
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync_fmu.errors import UserError
from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.scenario.evaluate.csv_files import write_outputs
from motionsync_fmu.scenario.evaluate.key_figures import compute_key_figures
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.toml_tables import read_file
from motionsync_fmu.scenario.run.simulation import run_in_process, scheduled_steps
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.variation.scenario_variation import ScenarioVariation
from tests.support.blocks.drawn import drawn
from tests.support.scenarios import recorded_line
from tests.support.scenarios.recordings import assert_as_in_python, run_compiled
from tests.support.scenarios.scenario_texts import write_scenario
from tests.support.scenarios.verdicts import checks_of

TEXT = """\
title = "A recorded line"
fmu = "Synchronizer"
stop_time = 0.3
step_size = 0.01

[start]
"master.period" = 0.0

[master]
file = "trace.csv"
"""
ROWS = "time,position\n5.0,10.0\n5.1,20.0\n5.25,20.0\n5.3,-5.0\n"
"""100 u/s for a tenth of a second, rest, and back with 500 u/s."""


def load(folder: Path, rows: str = ROWS, text: str = TEXT) -> Scenario:
    (folder / "trace.csv").write_text(rows, "utf-8")
    return load_scenario(write_scenario(text, folder))


def positions(scenario: Scenario) -> list[float]:
    return [values["master.position"] for _, _, values in scheduled_steps(scenario, scenario.step_size)]


def expected() -> list[float]:
    """At 0.00, 0.01 ... 0.29 s."""
    return [*np.linspace(10.0, 20.0, 11), *[20.0] * 15, *np.linspace(15.0, 0.0, 4)]


def test_the_block_smooths_the_line_between_its_rows_from_the_first_one_on(tmp_path: Path) -> None:
    scenario = load(tmp_path)
    assert scenario.start["master.input_mode"] == MasterInput.MEASURED
    assert scenario.is_recorded
    assert positions(scenario) == pytest.approx(expected(), abs=1e-9)
    first = next(scheduled_steps(scenario, scenario.step_size))[2]
    assert (first["master.velocity"], first["master.acceleration"]) == pytest.approx((100.0, 0.0))


def test_rows_make_no_communication_points(tmp_path: Path) -> None:
    """At a step of 0.04 s there are those of the steps, and the end."""
    times = run_in_process(load(tmp_path), 0.04).time
    assert times == pytest.approx([0.0, 0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.3])


@pytest.mark.parametrize(
    "rows",
    [
        ROWS.removeprefix("time,position\n"),
        ROWS.replace("time,position", '"t [s]", "x [mm]"'),
        "number,position,time\n1,10.0,5.0\n2,20,5.1\n3,2e1,5.25\n\n4,-5.0,5.3\n",
    ],
)
def test_other_forms_of_the_same_file(tmp_path: Path, rows: str) -> None:
    assert positions(load(tmp_path, rows)) == pytest.approx(expected(), abs=1e-9)


def test_a_parquet_file(tmp_path: Path) -> None:
    rows = np.genfromtxt(io.StringIO(ROWS), delimiter=",", names=True)
    pq.write_table(pa.table({name: rows[name] for name in ("position", "time")}), tmp_path / "trace.parquet")
    scenario = load_scenario(write_scenario(TEXT.replace(".csv", ".parquet"), tmp_path))
    assert positions(scenario) == pytest.approx(expected(), abs=1e-9)


def test_wrapped_positions_go_on_in_the_nearest_turn(tmp_path: Path) -> None:
    """A turn of 10: forwards by 4, by 4, back by 3; the block gets them wrapped."""
    text = TEXT.replace('period" = 0.0', 'period" = 10.0')
    scenario = load(tmp_path, "0,3\n0.1,7\n0.2,1\n0.3,8\n", text)
    assert [scenario.master.at(t).position for t in (0.0, 0.1, 0.2, 0.3)] == pytest.approx([3.0, 7.0, 11.0, 8.0])
    assert positions(scenario)[15] == pytest.approx(9.0)
    assert max(positions(scenario)) < 10.0


@pytest.mark.parametrize("period", [0.0, 12.0])
def test_a_counter_that_wraps_jumps_in_no_time(tmp_path: Path, period: float) -> None:
    """0.3 a row of 0.1 s, and a counter of 12. The rows 40 and 80 are after a wrap: up to there the line goes on."""
    rows = "".join(f"{n / 10},{round(0.3 * n % 12.0, 9)}\n" for n in range(100))
    line = load(tmp_path, rows, TEXT.replace('period" = 0.0', f'period" = {period}')).master
    for n in (40, 80):
        start = 0.3 * n if period else 0.0
        near = [line.at(n / 10 + t).position for t in (-0.05, -0.001, 0.0, 0.05)]
        before = 0.3 * n if period else 12.0
        assert near == pytest.approx([before - 0.15, before - 0.003, start, start + 0.15])


def test_a_line_that_starts_stops_or_turns_at_once_does_not_jump(tmp_path: Path) -> None:
    """From 0.01 a row to 0.3, and back with 5 for two rows; and at last one row of 1, no more than it ever did."""
    steps = [*[0.01] * 40, *[0.3] * 10, *[0.0] * 10, -5.0, -5.0, *[0.0] * 10, 1.0, *[0.0] * 5]
    places = np.concatenate([[0.0], np.cumsum(steps)])
    line = load(tmp_path, "".join(f"{n / 10},{p:.9f}\n" for n, p in enumerate(places))).master
    middle = [line.at((n + 0.5) / 10).position for n in range(len(steps))]
    assert middle == pytest.approx((0.5 * (places[1:] + places[:-1])).tolist(), abs=1e-8)


def test_the_velocity_at_the_start_is_the_mean_of_a_tenth_of_a_second(tmp_path: Path) -> None:
    """Neighbouring rows alone say 0 or 100 u/s: they are rounded."""
    rows = "".join(f"{i / 100},{i // 2}\n" for i in range(40))
    first = next(scheduled_steps(load(tmp_path, rows), 0.01))[2]
    assert first["master.velocity"] == pytest.approx(50.0)


def test_another_input_mode_gets_differences(tmp_path: Path) -> None:
    scenario = load(tmp_path, text=TEXT.replace('"master.period" = 0.0', '"master.input_mode" = "START_OF_STEP"'))
    velocities = [values["master.velocity"] for _, _, values in scheduled_steps(scenario, 0.01)]
    assert velocities == pytest.approx([100.0] * 11 + [0.0] * 15 + [-500.0] * 4, abs=1e-6)


@pytest.mark.parametrize("period", [0.0, 10.0])
def test_compiled_code_has_the_bits_of_python(tmp_path: Path, period: float) -> None:
    scenario = load(tmp_path, text=TEXT.replace('period" = 0.0', f'period" = {period}'))
    assert not assert_as_in_python(scenario).failure


def test_results_and_report_do_not_claim_a_true_line(tmp_path: Path) -> None:
    scenario = load(tmp_path)
    recording = run_in_process(scenario, scenario.step_size)
    out = io.StringIO()
    write_outputs(out, scenario, recording)
    assert out.getvalue().startswith('"time","master.position","master.velocity"')
    assert "true.master" not in out.getvalue()
    write_report(tmp_path / "report.html", scenario, recording, evaluate_run(scenario, recording))
    assert "where it truly was is not known" in (tmp_path / "report.html").read_text("utf-8")


def test_pieces_are_those_that_the_block_reports() -> None:
    """Nothing is said of their true lengths, and no check compares them with the positions of the recording."""
    scenario = load_scenario(recorded_line.FILE.with_name("scenario.toml"))
    (run,) = run_compiled(scenario)
    assert run.recording
    figures = compute_key_figures(scenario, run.recording)
    assert figures.true_pieces is None
    assert figures.production
    assert len(figures.production.pieces) == 26
    assert {(piece.measured, piece.wander) for piece in figures.production.pieces} == {(None, 0.0)}
    expected = [check.expected for check in checks_of(scenario, run.recording)]
    assert not [text for text in expected if "true" in text or "positions of slave" in text]


def test_start_values_vary_in_a_sweep_of_a_recorded_line(tmp_path: Path) -> None:
    load(tmp_path)
    file = tmp_path / "scenario.toml"
    variation = ScenarioVariation(read_file(file), file)
    varied = variation.with_values([(variation.target("master.smoothing_time"), 0.5)])
    assert varied.start["master.smoothing_time"] == 0.5
    assert varied.is_recorded


def test_the_shipped_recording_is_the_one_that_is_made() -> None:
    assert recorded_line.FILE.read_text("utf-8") == recorded_line.recording()


# --- mistakes ---


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("", "trace.csv: a recorded line has at least two rows, not 0"),
        ("time,position\n0.0,1.0\n", "trace.csv: a recorded line has at least two rows, not 1"),
        (
            ROWS.replace("5.25", "5.1"),
            "trace.csv:4: time = 5.1 is not allowed: it must be > 5.1, the time of the row before",
        ),
        (ROWS.replace("-5.0", "nan"), "trace.csv:5: position = nan is not allowed: it must be finite"),
        (ROWS.replace("-5.0", "-1e13"), "trace.csv:5: position = -1e+13 is not allowed: it must be -1e+12 to 1e+12"),
        (ROWS.replace("5.1", "inf"), "trace.csv:3: time = inf is not allowed: it must be finite"),
        (ROWS.replace("-5.0", "far"), "trace.csv:5: position: 'far' is not a number"),
        (ROWS.replace("5.1", ""), "trace.csv:3: time: '' is not a number"),
        (ROWS.replace(",-5.0", ""), "trace.csv:5: position: '' is not a number"),
        ("t,x,y\n0,0,0\n", "trace.csv:1: there must be the columns time and position, not the columns t, x, y"),
        ("0,0,0\n1,0,0\n", "trace.csv:1: there must be the columns time and position, not 3 columns without names"),
        (
            "0,0\n5e-324,1\n",
            "trace.csv:2: time = 4.940656458e-324 is not allowed: it must be > 0 + 1e-09, the time of the row before",
        ),
        (ROWS.replace("\n5.0", "\n-1e308"), "trace.csv:2: time = -1e+308 is not allowed: it must be -1e+12 to 1e+12"),
        ("time,time,position\n0,0,0\n", "trace.csv:1: there are several columns 'time'"),
        (
            "time;position\n0,5;1.000\n",
            "trace.csv:2: position: '1.000' is not a number; a comma is the decimal sign in this file",
        ),
        (
            "time,position\n0,0\n0,1,10,5\n0,2,11,0\n",
            "trace.csv:3: 4 cells, where the first line has 2; with a comma as the decimal sign there are semicolons "
            "between the cells",
        ),
        (ROWS.replace("5.0", '"' + "5" * 200_000), "trace.csv:2: field larger than field limit (131072)"),
        (ROWS.replace("5.3,", "5.29,"), "scenario.toml:10: file: trace.csv has 0.29 s, and stop_time = 0.3 is later"),
    ],
)
def test_a_mistake_in_the_file_is_one_line_with_its_place(tmp_path: Path, rows: str, message: str) -> None:
    with pytest.raises(UserError) as error:
        load(tmp_path, rows)
    assert str(error.value) == f"{tmp_path}/{message}"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"trace.csv"', '"no.csv"', "10: file: 'no.csv' cannot be read: No such file or directory"),
        ('"trace.csv"', '"."', "10: file: '.' cannot be read: it is no file"),
        ('"trace.csv"', "3", "10: file: 3 is not a text"),
        (
            '"trace.csv"',
            '"trace.csv"\nvelocity = 3.0',
            "11: velocity: a line that is recorded in a file has nothing else",
        ),
        (
            '"trace.csv"',
            '"trace.csv"\nfollows = "x"',
            "11: follows: a line that is recorded in a file has nothing else",
        ),
        (
            '"trace.csv"',
            '"trace.csv"\n[encoder]\nnoise = 0.1',
            "11: encoder: a recorded line has been measured already: leave out [encoder]",
        ),
    ],
)
def test_a_mistake_in_the_table_is_one_line_with_its_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(UserError) as error:
        load(tmp_path, text=TEXT.replace(old, new))
    assert str(error.value) == f"{tmp_path}/scenario.toml:{message}"


SHORT = TEXT.replace("stop_time = 0.3", "stop_time = 1e-9").replace("step_size = 0.01", "step_size = 1e-9")


@given(
    rows=st.lists(st.tuples(st.floats(1e-6, 1e6), st.floats(-1e12, 1e12)), min_size=2, max_size=8),
    order=st.permutations(["time", "position", "load"]),
    separator=st.sampled_from([",", ";", "\t"]),
    comma=st.booleans(),
    quote=st.sampled_from(["", '"']),
    end=st.sampled_from(["\n", "\r\n", "\n\n", "\n \n"]),
    mark=st.sampled_from(["", "\ufeff"]),
)
@drawn(anew=True)
def test_every_form_of_a_file_has_the_numbers_that_were_written(
    tmp_path_factory: pytest.TempPathFactory,
    rows: list[tuple[float, float]],
    order: list[str],
    separator: str,
    comma: bool,
    quote: str,
    end: str,
    mark: str,
) -> None:
    """The digits of `repr` are those of one number alone. Between semicolons a comma may be the decimal sign."""
    times = np.cumsum([step for step, _ in rows]).tolist()
    cells = {"time": times, "position": [position for _, position in rows], "load": [0.5] * len(rows)}
    lines = [separator.join(f"{quote}{name}{quote}" for name in order)]
    for i in range(len(rows)):
        texts = [repr(cells[name][i]) for name in order]
        if comma and separator == ";":
            texts = [text.replace(".", ",") for text in texts]
        lines.append(separator.join(f"{quote}{text}{quote}" for text in texts))
    folder = tmp_path_factory.mktemp("form")
    (folder / "trace.csv").write_text(mark + end.join(lines) + end, "utf-8", newline="")
    scenario = load_scenario(write_scenario(SHORT, folder))
    assert [scenario.master.at(t - times[0]).position for t in times] == cells["position"]


@given(
    st.permutations(["time", "position", "load"]) | st.just(["time", "position"]),
    st.integers(0, 5),
    st.sampled_from([",", ";", "\t"]),
)
@drawn(anew=True)
def test_a_row_that_is_wider_than_the_first_line_is_refused(
    tmp_path_factory: pytest.TempPathFactory, names: list[str], wide: int, separator: str
) -> None:
    """What is in which column is unknown then. Cells that are empty say nothing."""
    rows = [[str(i) if name == "time" else "0" for name in names] + [""] for i in range(6)]
    folder = tmp_path_factory.getbasetemp()

    def line() -> Scenario:
        return load(folder, "\n".join(separator.join(cells) for cells in [names, *rows]))

    assert line().master.at(4.5).position == 0.0
    rows[wide][-1] = "5"
    with pytest.raises(UserError, match=rf"trace.csv:{wide + 2}: {len(names) + 1} cells, where .* has {len(names)}"):
        line()


WORDS = st.sampled_from(
    ["time", "position", "0", "0.1", "0,2", "1.5", "5e-324", "1e308", "-1e308", "nan", "inf", "1e13", "", " ", '"', "x"]
)
LINES = st.lists(st.tuples(st.lists(WORDS, max_size=4), st.sampled_from([",", ";", "\t"])), max_size=8)
BYTES = st.binary(max_size=60) | LINES.map(
    lambda lines: "\n".join(separator.join(cells) for cells, separator in lines).encode()
)


@given(BYTES, st.sampled_from(["csv", "parquet"]))
@drawn(300, anew=True)
def test_any_file_is_a_finite_line_or_refused(
    tmp_path_factory: pytest.TempPathFactory, contents: bytes, kind: str
) -> None:
    folder = tmp_path_factory.getbasetemp()
    (folder / f"trace.{kind}").write_bytes(contents)
    file = write_scenario(SHORT.replace("csv", kind), folder)
    try:
        line = load_scenario(file).master
    except UserError:
        return
    assert np.isfinite(line.table()).all()


@given(
    names=st.lists(st.sampled_from(["time", "position", "x"]), min_size=1, max_size=4),
    rows=st.lists(st.floats() | st.none(), min_size=1, max_size=4),
    kind=st.sampled_from(["float64", "float32", "string", "timestamp", "list", "bool"]),
)
@drawn(anew=True)
def test_any_parquet_file_is_a_finite_line_or_refused(
    tmp_path_factory: pytest.TempPathFactory, names: list[str], rows: list[float | None], kind: str
) -> None:
    """Of one type, also none of numbers; names may be there twice."""
    numbers = pa.array(rows, pa.float64())
    columns = {
        "float64": lambda: numbers,
        "float32": lambda: numbers.cast(pa.float32(), safe=False),
        "string": lambda: pa.array([str(row) for row in rows]),
        "timestamp": lambda: pa.array(range(len(rows)), pa.timestamp("us")),
        "list": lambda: pa.array([[row] for row in rows]),
        "bool": lambda: pa.array([True] * len(rows)),
    }
    folder = tmp_path_factory.getbasetemp()
    pq.write_table(pa.table([columns[kind]()] * len(names), names=names), folder / "trace.parquet")
    try:
        line = load_scenario(write_scenario(SHORT.replace("csv", "parquet"), folder)).master
    except UserError:
        return
    assert np.isfinite(line.table()).all()


@pytest.mark.parametrize("kind", ["csv", "parquet"])
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no pipes with a name")
def test_what_is_no_file_is_refused_at_once(tmp_path: Path, kind: str) -> None:
    """A pipe into which nobody writes would be waited for, for ever."""
    os.mkfifo(tmp_path / f"trace.{kind}")
    with pytest.raises(UserError, match=rf"file: 'trace\.{kind}' cannot be read: it is no file"):
        load_scenario(write_scenario(TEXT.replace("csv", kind), tmp_path))


@pytest.mark.parametrize("name", ["a\\u0000.csv", "\\u0000"])
def test_a_name_that_no_file_can_have_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=r"scenario\.toml:10: file: .* cannot be read: embedded null byte"):
        load_scenario(write_scenario(TEXT.replace("trace.csv", name), tmp_path))


def test_a_long_file_takes_the_memory_of_its_columns(tmp_path: Path) -> None:
    """Time, position and the table of motions, which has four columns, are 8 bytes a row each; a Python number is 24,
    and a row of a line's text is more. Half of that is allowed in addition, and 4 MB."""
    count = 200_000
    rows = "".join(f"{i / 1000},{i}\n" for i in range(count))
    (tmp_path / "trace.csv").write_text(rows, "utf-8")
    file = write_scenario(TEXT, tmp_path)
    load_scenario(file)
    os.utime(tmp_path / "trace.csv")  # it is read again
    del rows
    tracemalloc.start()
    try:
        scenario = load_scenario(file)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert scenario.master.at(150.0).position == pytest.approx(150_000.0)
    assert peak < 1.5 * (2 + 4) * 8 * count + 4e6


def test_a_file_that_is_no_text_or_no_parquet(tmp_path: Path) -> None:
    load(tmp_path)
    (tmp_path / "trace.csv").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "trace.parquet").write_bytes(b"nonsense")
    for name, message in (("trace.csv", "not a text in UTF-8"), ("trace.parquet", "not a Parquet file of numbers: ")):
        with pytest.raises(UserError) as error:
            load_scenario(write_scenario(TEXT.replace("trace.csv", name), tmp_path))
        assert str(error.value).startswith(f"{tmp_path / name}: {message}")
