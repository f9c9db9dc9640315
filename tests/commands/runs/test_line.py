"""`motionsync line`: what it prints and writes, and its messages."""

import json
import re
import sys
from pathlib import Path

import pytest

from motionsync_fmu import cli
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.production_line.variants import RAW
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.project.command_line import Command
from tests.support.scenarios.lines import LINES, MACHINE, SAW, SYNCHRONIZER, copied, replaced

SHORT = (  # a clock that is 3000 ppm fast: a beat each 0.67 s
    ("stop_time = 25.0", "stop_time = 5.1"),
    ("sender_cycle = 0.00199940017994602 # 2 ms / 1.0003", "sender_cycle = 0.001994017946161515"),
    ("to = 25.0", "to = 5.1"),
    ("count = 14", "count = 2"),
)


def short(file: Path, *changes: tuple[str, str]) -> Path:
    """The first two cuts of line.toml, with these changes."""
    text = SAW.read_text()
    head, *settings = text.split("[[set]]")
    tail = settings[-1][settings[-1].index("[cuts]") :]
    early = [s for s in settings if float(re.findall(r"at = ([\d.]+)", s)[0]) < 5.1]
    file.write_text(replaced("[[set]]".join([head, *early]) + tail, *SHORT, *changes))
    return file


@pytest.fixture
def target(shared: Shared, fmus: Fmus, tmp_path: Path) -> Path:
    """The output folder of `run_line`: one of this test, with FMUs that are up to date."""
    return copied(shared, fmus, tmp_path / "target")


@pytest.fixture
def run_line(target: Path, motionsync: Command) -> Command:
    """`motionsync line`."""
    return lambda *arguments: motionsync("line", *arguments, "--output", target)


def test_the_command_prints_errors_and_writes_package_and_report(
    run_line: Command, target: Path, tmp_path: Path
) -> None:
    file = short(tmp_path / "line.toml")
    outcome = run_line(file)
    assert outcome.status == 0
    messages = [line for line in outcome.err.splitlines() if not line.startswith("  ")]
    assert {line.rstrip(".") for line in messages} <= {"line: its FMUs ", "line: its runs "}
    for text in ("as expected", "RemoteSync, PHASE", RAW, "worst", "line.ssp"):
        assert text in outcome.out
    page = (target / "reports" / "line" / "line" / "report.html").read_text("utf-8")
    for text in (
        "Errors before",
        "RemoteSync, BEAT, uniform",
    ):
        assert text in page
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", page)
    result = (target / "reports" / "line" / "line" / "line_out.csv").read_text().splitlines()
    assert len(result) == 1 + 2550
    assert result[0].startswith('"time","RemoteSync.slave.position",')


def test_what_is_not_as_expected_is_reported(run_line: Command, tmp_path: Path) -> None:
    """With a clock that does not drift RemoteSync is never in sync, and no cut is as near to its mark."""
    narrow, even = (
        ("tolerance = 0.05", "tolerance = 1e-6"),
        ("sender_cycle = 0.001994017946161515", "sender_cycle = 0.0020"),
    )
    outcome = run_line(short(tmp_path / "line.toml", narrow, even), "--json", "--no-report")
    assert outcome.status == 1
    (result,) = json.loads(outcome.out)
    texts = [f"{c['expected']}: found {c['actual']}" for c in result["expectations"] if not c["passed"]]
    for broken in ("cuts within 0.000001 mm", "RemoteSync in sync: found never"):
        assert any(broken in text for text in texts)
    assert result["report"] is None


def test_contradictory_start_values_are_reported_with_the_fmu_s_message(run_line: Command, tmp_path: Path) -> None:
    outcome = run_line(
        short(tmp_path / "line.toml", ('estimator = "PHASE"', 'estimator = "PHASE"\ndata_cycle_time = 0.004'))
    )
    assert outcome.status == 2
    assert "RemoteSync refused its start values" in outcome.err
    assert len([line for line in outcome.err.splitlines() if line.startswith("motionsync: ")]) == 1


def test_a_path_without_lines_is_reported(run_line: Command, tmp_path: Path) -> None:
    for path, message in ((tmp_path, "no line*.toml below it"), (tmp_path / "nowhere", "no such file or folder")):
        outcome = run_line(path)
        assert (outcome.status, outcome.err.count("\n")) == (2, 1)
        assert message in outcome.err


def test_lines_are_listed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["motionsync", "list", "--scenarios", str(LINES)])
    with pytest.raises(SystemExit):
        cli.main()
    text = capsys.readouterr().out
    for file in (SAW, SYNCHRONIZER, MACHINE):
        assert f"line/{file.name}" in text  # the name by which it is run
        assert load_line(file).follower.title in text


def test_two_lines_of_a_name_are_refused(run_line: Command, tmp_path: Path) -> None:
    for folder in ("one", "other"):
        (tmp_path / folder).mkdir()
        short(tmp_path / folder / "line.toml")
    outcome = run_line(tmp_path)
    assert outcome.status == 2
    assert "would write to the same package line.ssp" in outcome.err
