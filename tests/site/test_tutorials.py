"""The tutorials are followed to the letter: their commands, as printed, do what the pages say."""

import re
import shlex
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.fmus.fmu import Flavour
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command, Outcome

TUTORIAL = ROOT / "docs" / "tutorial"
FILE = re.compile(r"Make a folder `(\w+)`, and in it a file `scenario.toml`[^`]*```toml\n(.*?)```", re.S)
PRINTED = re.compile(r"^```text\n(.*?)^```", re.M | re.S)
COMMAND = re.compile(r"^    motionsync (.*)$", re.M)
SLOW = ("explore", "build")  # other tests write pages and build FMUs
STEPS = {  # of each page: the exit status of each command; what it prints, and what the page says of that
    "first_cut.md": [
        (
            0,
            [
                ("): as expected, with 1 note ! the line was for 1.92 s faster", "is a note"),
                ("made 17 pieces", "17 pieces"),
            ],
        ),
        (0, [("(saw): as expected made 6 pieces: 6 PRODUCT; 6 good", "6 pieces"), ("500 of 775.6 mm/s", "776 mm/s")]),
        (1, [("! the line was above its limit for 10 s, most at 0.01 s: 500 of 377.1 mm/s", "377.1 mm/s")]),
    ],
    "my_machine.md": [
        (
            0,
            [
                ("6000 1241.08 74.47", "1241 mm/s, which is 74 m/min"),
                ("667 40 2474.15", "2474 mm"),
                ("2.35 3000 yes", "3000 mm"),
            ],
        ),
        (0, [("as expected made 6 pieces: 6 PRODUCT; 6 good", "6 pieces in a minute"), ("at least 58.8 %", "58.8 %")]),
        (1, [("skipped cuts = 0: found 7", "7 skipped"), ("for 60 s, most at 0.01 s: 1500 of 1241 mm/s", "1241 mm/s")]),
    ],
}


@pytest.mark.parametrize("page", STEPS)
def test_the_commands_print_what_the_page_says(page: str, fmus: Fmus, tmp_path: Path, motionsync: Command) -> None:
    fmus.copied(Flavour.NATIVE, "CutToLength", tmp_path / "build")
    text = (TUTORIAL / page).read_text("utf-8")
    prose = " ".join(text.split())
    ((folder, content),) = FILE.findall(text)
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "scenario.toml").write_text(content)
    outputs: list[str] = []
    commands = [line for line in COMMAND.findall(text) if not line.startswith(SLOW)]
    for command, (status, pairs) in zip(commands, STEPS[page], strict=True):
        outcome = motionsync(*shlex.split(command))
        assert outcome.status == status, outcome
        outputs.append(as_shown(outcome))
        for printed, written in pairs:
            assert printed in " ".join(outcome.out.split())
            assert written in prose
    assert set(PRINTED.findall(text)) <= set(outputs)


def as_shown(outcome: Outcome) -> str:
    """What a command has printed, as a page shows it: without the address of the report."""
    return re.sub(r"^report: .*\n", "", outcome.out, flags=re.M)


def test_the_reference_shows_what_a_run_prints(fmus: Fmus, tmp_path: Path, motionsync: Command) -> None:
    fmus.copied(Flavour.NATIVE, "CutToLength", tmp_path / "build")
    text = (ROOT / "docs" / "reference" / "run_output.md").read_text("utf-8")
    commands = re.findall(r"`motionsync (run .*?)`\s+prints", text)
    shown = PRINTED.findall(text)
    assert len(commands) == len(shown) == 2
    for command, output in zip(commands, shown, strict=True):
        assert as_shown(motionsync(*shlex.split(command), "--no-report")) == output


@pytest.mark.all_blocks
def test_the_check_of_an_installation_lists_all_blocks(motionsync: Command) -> None:
    assert "prints a table of all blocks, CutToLength among them" in (TUTORIAL / "install.md").read_text("utf-8")
    listed = motionsync("list").out
    assert [name for name in BLOCKS if not re.search(rf"^ {name} +\d", listed, re.M)] == []


def test_the_commands_that_take_long_name_what_there_is() -> None:
    """The start values of the FMU are those of the scenario on the page."""
    text = (TUTORIAL / "my_machine.md").read_text("utf-8")
    (build,) = [line for line in COMMAND.findall(text) if line.startswith("build")]
    starts = dict(re.findall(r"--start (\S+)=(\S+)", build))
    scenario = re.findall(r'^"([\w.]+)" = "?([\d.]+)( m)?', FILE.findall(text)[0][1], re.M)
    in_mm = {name: float(value) * (1000.0 if metres else 1.0) for name, value, metres in scenario}
    assert {name: float(value) for name, value in starts.items()} == in_mm
