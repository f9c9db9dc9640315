"""Every command that a help text or a page shows works, in the sequence in which it is shown.

Tutorials have tests of their own of what their commands print (tests/site/test_tutorials.py)."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.commands.app import COMMANDS
from motionsync_fmu.fmus.fmu import BuildOptions, Flavour, Fmi, start_build
from motionsync_fmu.interface.recipe import Recipe
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command
from tests.support.scenarios.examples import PAGES, help_of, shown_commands

SHOW_A_FAILURE = (  # what the page says of them
    ["run", "saw/scenario.toml", "--set", "length=300"],
    ["run", "tube/scenario.toml", "--set", "master.velocity=1500"],
)
A_SWEEP = """sweep CutToLength/measured_line --set length=600,800 --set master.velocity=0,1
    --set axis.max_acceleration=9000,10000 --measure slave.acceleration=max --workers 1 --output out"""
WITH_EXAMPLES = [page for page in PAGES if shown_commands((ROOT / page).read_text("utf-8"))]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, fmus: Fmus) -> None:
    """What takes minutes is left out, since other tests do it: the compiler, and pages for each browser. A native FMU
    of FMI 2.0 is built as one of the python flavour, which is refused for the same reasons."""

    def build_quickly(recipe: Recipe, _options: BuildOptions) -> Callable[..., object]:
        if recipe.fmi == Fmi.TWO:
            return start_build(recipe, BuildOptions(Flavour.PYTHON))
        recipe.block()
        return lambda target, notify: target.touch()

    monkeypatch.setattr("motionsync_fmu.api.build.start_build", build_quickly)
    monkeypatch.setattr("motionsync_fmu.api.explore.prepare_fmus", lambda *_: [Path()])
    monkeypatch.setattr("motionsync_fmu.api.explore.write_page", write_nothing)
    monkeypatch.setattr("webbrowser.open", lambda address: True)


def write_nothing(name: str, scenarios: Any, fmu: Path, target: Path, progress: Any) -> None:
    assert scenarios
    target.parent.mkdir(parents=True, exist_ok=True)
    target.touch()


def shortened(words: list[str]) -> list[str]:
    """The command with few values in place of many, in this process."""
    short = []
    for before, word in zip(["", *words], words, strict=False):
        if before == "--samples":
            word = "2"  # noqa: PLW2901
        elif before == "--set" and words[0] in ("sweep", "search"):
            word = re.sub(r"(:[\d.]+):\d+$", r"\1:2", word)  # noqa: PLW2901
            word = re.sub(r"=0:\d+$", "=0:1", word)  # noqa: PLW2901
            word = re.sub(r"=([\d.]+,[\d.]+),[\d.,]+$", r"=\1", word)  # noqa: PLW2901
        short.append(word)
    return [*short, "--workers", "1"] if words[0] in ("sweep", "search") else short


def run_all(motionsync: Command, commands: list[list[str]]) -> None:
    for words in commands:
        outcome = motionsync(*shortened(words))
        assert outcome.status == (words in SHOW_A_FAILURE), f"motionsync {' '.join(words)}: {outcome}"
        assert "Traceback" not in outcome.err


@pytest.mark.slow
@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_every_example_of_a_help_works(
    motionsync: Command, quick: None, fmus: Fmus, tmp_path: Path, command: str
) -> None:
    """In a folder with what they name: an FMU, scenarios, the machine's file of the help, rows."""
    text = help_of(command)
    commands = shown_commands(text)
    assert not command or commands
    if command == "describe":
        fmus.copied(Flavour.PYTHON, "Synchronizer", tmp_path / "build")
    elif command == "list":
        shutil.copytree(ROOT / "scenarios" / "Gearing", "my_scenarios")
    elif command == "plan-line":
        (file,) = re.findall(r"^ +(title = .*?)\n\n", text, re.M | re.S)
        Path("saw.toml").write_text(re.sub(r"^ +", "", file, flags=re.M))
    elif command == "sweep-plot":
        assert motionsync(*A_SWEEP.split()).status == 0
    for words in commands:
        run_all(motionsync, [words])
        if command == "sweep":
            shutil.rmtree("out")  # of another sweep


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_EXAMPLES)
def test_every_example_of_a_page_works(motionsync: Command, quick: None, page: str) -> None:
    """In a folder with the files that the page shows, and those of a checkout."""
    text = (ROOT / page).read_text("utf-8")
    commands = shown_commands(text)
    made = {words[2] for words in commands if words[0] == "new"}
    for words in commands:
        folder, _, name = words[-1].partition("/")
        if name == "scenario.toml" and folder not in made:
            made.add(folder)
            Path(folder).mkdir()
            Path(folder, name).write_text(re.findall(r"```toml\n(title.*?)```", text, re.S)[0])
    Path("model").symlink_to(ROOT / "model")
    if any("seeds" in words for words in commands) and page.startswith("docs/how_to"):
        sweep = "sweep CutToLength/measured_line --set encoder.seed=0:1 --workers 1 --output seeds"  # of the tutorial
        assert motionsync(*sweep.split()).status == 0
    run_all(motionsync, commands)
