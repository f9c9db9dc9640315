"""The console script: help, version, wrong usage, exit status and streams."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__
from motionsync_fmu.commands import app as command_line
from motionsync_fmu.pages.console import PlainConsole
from tests import ROOT
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import STOP, process, scenario, without_progress

COMMANDS = tuple(command_line.COMMANDS)


def test_an_unknown_command_is_one_line(motionsync: Command) -> None:
    assert_one_line(motionsync("runn"), "No such command 'runn'", "describe", "new")


def test_help_lists_the_commands() -> None:
    text = CliRunner().invoke(command_line.app, ["--help"]).output
    for command in COMMANDS:
        assert re.search(rf"^ +{command} .*\.$", text, re.MULTILINE)
    assert "..." not in text.partition("Commands:")[2]


OF_TYPER = {"annotated_doc", "click", "shellingham", "typer", "typing_extensions"}  # without pydantic
OF_RICH = {"rich", "markdown_it", "mdurl", "pygments"}


@pytest.mark.parametrize(
    ("arguments", "needed"),
    [
        (("list",), {"motionsync", "motionsync_fmu", "rich", "lazy_loader"}),
        (("--help",), {"motionsync_fmu", "lazy_loader"}),
        (("describe", "Gearing"), {"motionsync", "motionsync_fmu", "rich", "lazy_loader"}),
        (
            ("run", "--help"),
            {"motionsync", "motionsync_fmu", "rich", "lazy_loader", "deflate", "packaging", "platformdirs"},
        ),
    ],
)
@pytest.mark.all_blocks
def test_a_command_loads_no_library_that_it_does_not_need(arguments: tuple[str, ...], needed: set[str]) -> None:
    """Those of runs and pictures take a second to load, the console's a third of what the help takes, and pydantic, on
    which typer depends, a third of what the list takes; a fresh interpreter shows what a command has loaded. Only the
    block that is described is loaded, and the help needs none."""
    script = (
        "import sys\nbefore = {*sys.modules}\n"
        f"from motionsync_fmu import cli\nsys.argv = ['motionsync', *{arguments!r}]\n"
        "try:\n    cli.main()\nexcept SystemExit as exit_:\n    assert not exit_.code, exit_.code\n"
        "print('loaded:', *sorted({*sys.modules} - before))"
    )
    outcome = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    modules = outcome.stdout.splitlines()[-1].split()[1:]
    loaded = {name.partition(".")[0] for name in modules}
    blocks = [name for name in modules if re.fullmatch(r"motionsync\.\w+\.block", name)]
    assert blocks == [f"motionsync.{name.lower()}.block" for name in arguments[1:] if name in BLOCKS]
    packages = {name for name in loaded if name not in sys.stdlib_module_names and not name.startswith("_")}
    of_others = OF_TYPER | (OF_RICH if "rich" in needed else set())
    assert packages - of_others == needed - of_others
    assert needed <= packages


def test_the_console_script_passes_exit_status_and_streams_on(built: Path, tmp_path: Path) -> None:
    shutil.copytree(built, tmp_path / "build")
    scenario(str(tmp_path / "stop"))
    scenario(str(tmp_path / "wrong"), STOP.replace("= 27.5", "= 27.6"))
    passing = process(tmp_path, "run", "stop", "--no-report", "--json", **without_progress(tmp_path / "quiet"))
    assert (passing.status, passing.err) == (0, "")
    assert json.loads(passing.out)[0]["passed"] is True
    assert process(tmp_path, "run", "wrong", "--no-report").status == 1
    assert_one_line(process(tmp_path, "run", "nowhere"), "nowhere")


def test_a_terminal_that_cannot_show_a_sign_is_no_reason_to_fail(built: Path, tmp_path: Path) -> None:
    shutil.copytree(built, tmp_path / "build")
    scenario(str(tmp_path / "stop"), STOP.replace("A stop", "90° → a stop"))
    environment = without_progress(tmp_path / "quiet") | {"PYTHONIOENCODING": "ascii"}
    outcome = process(tmp_path, "run", "stop", "--no-report", **environment)
    assert (outcome.status, outcome.err) == (0, "")
    assert "as expected" in outcome.out


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["run"], "path"),
        (["run", "x", "--step-size", "abc"], "--step-size"),
        (["run", "x", "--flavour", "cobol"], "cobol"),
        (["build", "--start"], "--start"),
        (["bild"], "bild"),
        (["build", "--colour"], "--colour"),
    ],
)
def test_wrong_usage_is_one_line(arguments: list[str], part: str, motionsync: Command) -> None:
    assert_one_line(motionsync(*arguments), part)


def test_the_version_is_printed(motionsync: Command) -> None:
    outcome = motionsync("--version")
    assert (outcome.status, outcome.out, outcome.err) == (0, f"motionsync {__version__}\n", "")


def test_without_arguments_the_help_is_shown(tmp_path: Path) -> None:
    outcome = process(tmp_path)
    assert "Commands:" in outcome.out + outcome.err


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
@pytest.mark.parametrize("command", [("run", "--set", "rest_value=20"), ("sweep", "--set", "rest_value=1:2:2")])
def test_a_folder_whose_name_is_no_text_is_one_line(built: Path, command: tuple[str, ...], motionsync: Command) -> None:
    folder = os.fsdecode(b"latin\xe9")
    scenario(folder)
    shutil.copytree(built, "build")
    name, *options = command
    outcome = motionsync(name, folder, *options, "--output", "out")
    assert_one_line(outcome, r"latin\udce9", "is no text in UTF-8")


HOSTILE = "A \x1b[31mred\x1b[0m \x00 \u202e\u2028 stop °"
SHOWN = r"A \x1b[31mred\x1b[0m \x00 \u202e\u2028 stop °"


def test_characters_that_command_a_terminal_are_shown_as_escapes(
    motionsync: Command, built: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(built, "build")
    title = HOSTILE.encode("unicode_escape").decode().replace("\\x", "\\u00")
    scenario("esc\x1b[2J", STOP.replace("A stop", title))
    outcome = motionsync("run", "esc\x1b[2J", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert SHOWN in outcome.out
    assert r"(esc\x1b[2J)" in outcome.out
    assert_one_line(motionsync("run", "no\x1b\u202eway"), r"no\x1b\u202eway")
    terminal = PlainConsole(force_terminal=True, color_system="standard", highlight=False)
    terminal.print(f"[red]{HOSTILE}[/]")
    assert capsys.readouterr().out == f"\x1b[31m{SHOWN}\x1b[0m\n"  # its own colours remain


def test_a_long_value_is_shortened_in_a_message(motionsync: Command) -> None:
    outcome = motionsync("run", "x", "--set", "A" * 200_000)
    assert_one_line(outcome, "--set AAAA", "AAAA: write NAME=VALUE, as in: --set master.velocity=500")
    assert len(outcome.err) < 400
    outcome = motionsync("run", "x", "--set", "A " * 100_000)
    assert_one_line(outcome, "--set A A", "A : write NAME=VALUE, as in: --set master.velocity=500")
    assert len(outcome.err) < 8000
