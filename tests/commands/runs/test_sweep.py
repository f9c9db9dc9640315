"""`motionsync sweep`: rows, summary, Ctrl-C, and its messages about mistakes."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import psutil
import pyarrow.parquet as pq
import pytest

from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.sweeps import worker_pool
from tests import ROOT
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import scenario
from tests.sweeps.test_execution import contents, table

SCENARIO = "Synchronizer/polynomial"  # a stop and a start at 90 deg/s; its expectations hold at that velocity alone
VELOCITIES = "master.velocity=80:100:21"
SWEEP = ("sweep", SCENARIO, "--set", VELOCITIES)


def test_the_summary_counts_what_the_rows_say(motionsync: Command) -> None:
    """Of 21 velocities from 80 to 100 one is 90. A phasing of 0 is refused, at each of them."""
    options = ("--set", "output_phasing=90,0", "--measure", "slave.velocity=max", "--chunk", "20", "--workers", "1")
    outcome = motionsync(*SWEEP, *options, "--output", "out")
    assert (outcome.status, outcome.err) == (0, "")
    lines = outcome.out.splitlines()
    assert lines[0] == "42 runs of Synchronizer/polynomial"
    assert [line.split()[-2:] for line in lines[1:4]] == [["1", "2.38%"], ["20", "47.62%"], ["21", "50.00%"]]
    reasons = [line.removeprefix("  first not met in ") for line in lines if "first not met" in line]
    unmet = Counter(text.partition(": found ")[0] for text in table(Path("out"))["first_broken"].to_pylist() if text)
    assert unmet.total() == 20
    assert reasons == [f"{n} run{'s' * (n > 1)}: {text}" for text, n in unmet.most_common(3)]
    assert lines[-3].startswith("42 of them now, ")
    assert lines[-2:] == [
        "rows: out",
        "plot them: motionsync sweep-plot out --x master.velocity --y output_phasing --open",
    ]
    rows = table(Path("out"))
    assert rows["run"].to_pylist() == list(range(42))
    assert rows["master.velocity"].to_pylist() == [80.0 + i // 2 for i in range(42)]
    assert [run for run, passed in enumerate(rows["passed"].to_pylist()) if passed] == [20]
    # master and slave run at the same velocity, which the ramps leave and never exceed
    assert rows["slave.velocity.max"].to_pylist()[::2] == pytest.approx([80.0 + i for i in range(21)], rel=1e-6)
    assert [pq.read_metadata(part).num_rows for part in sorted(Path("out").glob("part-*"))] == [20, 20, 2]


def test_a_monte_carlo_ends_with_what_its_true_lengths_say(motionsync: Command) -> None:
    """NumPy has the errors of all rows at once; the seeds alone vary, so that the plot is their histogram."""
    options = ("sweep", "CutToLength/measured_line", "--set", "encoder.seed=3:8", "--workers", "1", "--output", "out")
    lines = motionsync(*options).out.splitlines()
    errors = np.concatenate(table(Path("out"))["true_length_errors"].to_pylist())
    assert len(errors) == 72
    mean, sigma = errors.mean(), errors.std(ddof=1)
    worst = max(errors, key=abs)
    low, high = np.quantile(errors, (0.005, 0.995), method="inverted_cdf")
    at = lines.index(f"  true lengths of 72 products: mean error {mean:.5f} mm, sigma {sigma:.5f} mm")
    assert (
        lines[at + 1] == f"  99 % of them are between {low:.5f} mm and {high:.5f} mm off, the worst one {worst:.5f} mm"
    )
    start = f"  0 out of tolerance (+-0.1 mm): C_pk {(0.1 - abs(mean)) / (3.0 * sigma):.2f}, "
    assert lines[at + 2].startswith(start)
    assert lines[at + 2].endswith(" with 95 % confidence")
    assert lines[-1] == "plot them: motionsync sweep-plot out --x true_length_errors --open"
    shown = json.loads(motionsync(*options, "--json").out)["true_length_errors"]
    assert (shown["count"], shown["runs"]) == (72, 6)
    assert shown["mean"] == pytest.approx(mean, rel=1e-9)
    assert shown["capability"]["low"] < shown["capability"]["c_pk"] < shown["capability"]["high"]


def test_a_sweep_of_the_smoothing_time_is_plotted_over_it(motionsync: Command) -> None:
    options = ("--set", "encoder.seed=0:1", "--set", "master.smoothing_time=0.02,0.04", "--workers", "1")
    outcome = motionsync("sweep", "CutToLength/measured_line", *options, "--output", "out")
    assert outcome.out.splitlines()[-1] == (
        "plot them: motionsync sweep-plot out --x master.smoothing_time --y true_length_sigma --open"
    )


def test_what_is_there_is_reported_and_not_done_again(motionsync: Command) -> None:
    first = json.loads(motionsync(*SWEEP, "--workers", "1", "--chunk", "8", "--output", "out", "--json").out)
    counts = {"runs": 21, "passed": 1, "unexpected": 20, "refused": 0, "limits_broken": None, "faults": 0}
    assert {key: first[key] for key in counts} == counts
    assert first["now"] == 21
    before = contents(Path("out"))
    Path("out/part-000001.parquet").unlink()
    again = json.loads(motionsync(*SWEEP, "--workers", "1", "--output", "out", "--json").out)
    assert again["now"] == 8
    assert contents(Path("out")) == before
    outcome = motionsync(*SWEEP, "--output", "out")
    assert "now" not in outcome.out
    other = motionsync("sweep", SCENARIO, "--set", "master.velocity=80:100:11", "--output", "out")
    assert_one_line(other, "out has another sweep: master.velocity is 80:100:11, not 80:100:21")


@pytest.mark.parametrize("output", ["out", "."])
def test_a_sweep_of_the_scenario_in_this_folder_goes_on_and_is_no_second_scenario(
    motionsync: Command, output: str
) -> None:
    scenario(".")
    own_file = Path("scenario.toml").read_bytes()
    sweep = ("sweep", ".", "--set", "output_phasing=9:11:3", "--workers", "1", "--chunk", "2", "--json")
    assert json.loads(motionsync(*sweep, "--output", output).out)["now"] == 3
    assert Path("scenario.toml").read_bytes() == own_file
    (Path(output) / "part-000001.parquet").unlink()
    outcome = motionsync(*sweep, "--output", output)
    assert (outcome.status, outcome.err) == (0, "")
    assert json.loads(outcome.out)["now"] == 1
    assert find_files(Path()) == [Path("scenario.toml")]


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ((SCENARIO,), ("give --set NAME=VALUES",)),
        ((SCENARIO, "--set", "nonsense=1:2:3"), ("nonsense",)),
        ((SCENARIO, "--set", "master.velocity=2:2:3"), ("master.velocity=2:2:3", "empty")),
        ((SCENARIO, "--set", "master.velocity=3:2:3"), ("reversed",)),
        ((SCENARIO, "--set", "master.velocity=fast:2:3"), ("'fast' is no number",)),
        ((SCENARIO, "--set", "master.velocity=80..100"), ("master.velocity has a range", "--samples")),
        (
            (SCENARIO, "--set", "master.velocity=1:2:100000", "--set", "master.acceleration=1:2:100000"),
            ("10,000,000,000 runs", "--yes"),
        ),
        ((SCENARIO, "--set", VELOCITIES, "--measure", "slave.velocity"), ("--measure slave.velocity", "NAME=KIND")),
        ((SCENARIO, "--set", VELOCITIES, "--measure", "slave.velocity=most"), ("most",)),
        ((SCENARIO, "--set", VELOCITIES, "--method", "grid"), ("method", "lhs, sobol")),
        ((SCENARIO, "--set", VELOCITIES, "--chunk", "0"), ("--chunk 0 is not allowed: it must be >= 1",)),
        ((SCENARIO, "--set", VELOCITIES, "--workers", "0"), ("workers = 0 is not allowed: it must be >= 1",)),
        (
            (SCENARIO, "--set", VELOCITIES, "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"),
            ("workers = 2 is not allowed with a scheduler",),
        ),
        ((SCENARIO, "--set", VELOCITIES, "--scheduler", "tcp://127.0.0.1:1"), ("no scheduler answers", "127.0.0.1:1")),
        (("Synchronizer", "--set", VELOCITIES), ("Synchronizer: there are 16 scenarios: name one of them",)),
        (("Synchronizer/poly", "--set", VELOCITIES), ("did you mean Synchronizer/polynomial",)),
    ],
)
def test_a_mistake_is_one_line(
    motionsync: Command, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    monkeypatch.setattr(worker_pool, "REACH_TIME", 0.3)
    assert_one_line(motionsync("sweep", *arguments, "--output", "out"), *parts)
    assert not list(Path().glob("out/part-*"))


def test_an_output_that_is_no_folder_is_one_line(motionsync: Command) -> None:
    Path("file").touch()
    assert_one_line(motionsync(*SWEEP, "--output", "file"), "file cannot be made")
    assert_one_line(motionsync(*SWEEP, "--output", "file/out"), "file/out cannot be made: Not a directory")
    assert_one_line(motionsync(*SWEEP), "Missing option '--output'")


INTERRUPTIBLE = (  # a shell that runs the tests in its background has switched the signal off
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);from motionsync_fmu import cli; cli.main()"
)


@pytest.mark.slow
def test_ctrl_c_ends_at_once_and_the_same_command_goes_on(motionsync: Command, tmp_path: Path) -> None:
    """The signal goes to the whole group, as a terminal sends it; none of the processes is left."""
    sweep = ("sweep", SCENARIO, "--set", "master.velocity=80:100:41", "--set", "output_phasing=60:120:15")
    options = (*sweep, "--chunk", "10")
    command = [sys.executable, "-c", INTERRUPTIBLE, *options, "--workers", "2", "--output", "a"]
    path = os.pathsep.join([str(ROOT / "model"), str(ROOT / "fmu_src")])
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120.0
    while not list(tmp_path.glob("a/part-*.parquet")) and time.monotonic() < deadline:
        time.sleep(0.01)
    workers = psutil.Process(process.pid).children(recursive=True)
    begin = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    took = time.monotonic() - begin
    assert (process.returncode, out) == (130, "")
    last = err.splitlines()[-1]
    assert last.startswith("motionsync: interrupted: ")
    assert last.endswith(f" of 615 runs are in {tmp_path / 'a'}, and the same command goes on with the rest")
    assert "Traceback" not in err
    assert took < 10.0  # within 2 s, on a machine that does nothing else
    assert len(workers) >= 2  # and a compiler, if it is the first sweep
    assert not any(worker.is_running() and worker.status() != psutil.STATUS_ZOMBIE for worker in workers)
    parts = list(tmp_path.glob("a/part-*.parquet"))
    assert 0 < len(parts) < 62
    again = json.loads(motionsync(*sweep, "--workers", "1", "--output", "a", "--json").out)
    assert again["now"] == 615 - sum(pq.read_metadata(part).num_rows for part in parts)
    assert motionsync(*options, "--workers", "1", "--output", "b").status == 0
    assert contents(Path("a")) == contents(Path("b"))
