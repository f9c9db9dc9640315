"""The READMEs stay true: what they show to type does what they say, and what they name exists."""

import math
import re
import shlex
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.build import Flavour
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import cells, members
from motionsync_fmu.pages.readme import readme
from motionsync_fmu.pages.state_diagram import read
from tests import ROOT
from tests.support.fmus import Fmus

README = (ROOT / "README.md").read_text("utf-8")
WIRING = (ROOT / "docs" / "wiring.md").read_text("utf-8")
PYTHON = (ROOT / "docs" / "python.md").read_text("utf-8")
SOURCES = {"mv_follow2"}  # a source that is written like a variable
SECTIONS = ("How to use it", "Names in the source system", "Decisions where the source is silent", "States")


def code_with(page: str, text: str) -> str:
    """The one Python example of a page that holds a text."""
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", page, re.S) if text in code]
    return str(code)


def replaced(code: str, old: str, new: str) -> str:
    """The example with another text in one place."""
    assert code.count(old) == 1, old
    return code.replace(old, new)


def printed(line: str, word: str) -> tuple[float, float]:
    """The greatest value and its limit, from `word 683 of 1200 mm/s`."""
    ((value, limit),) = re.findall(rf"{word} (\d+) of (\d+) ", line)
    return float(value), float(limit)


def executed(code: str, capsys: pytest.CaptureFixture[str]) -> tuple[dict[str, Any], str]:
    """The names that an example leaves, and what it prints."""
    names: dict[str, Any] = {}
    exec(code, names)
    return names, capsys.readouterr().out


@pytest.mark.parametrize(("length", "line"), [(800.0, 500.0), (1000.0, 250.0), (800.0, 600.0), (300.0, 500.0)])
def test_the_fifteen_lines_tell_the_truth_of_other_lengths_and_speeds(
    fmus: Fmus,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    length: float,
    line: float,
) -> None:
    """In any folder into which the FMU was built. The slave is in sync for 0.2 length after each mark, so that n cuts
    are done where the material has come (n + 0.2) lengths. 300 mm are too short: (1.5 v / T) is 6250 mm/s2 on the way
    in, which takes the time T of 0.2 lengths."""
    fmus.copied(Flavour.NATIVE, "Follower", tmp_path / "build")
    monkeypatch.chdir(tmp_path)
    code = replaced(code_with(README, "simulate_fmu"), "= 800.0, 500.0,", f"= {length}, {line},")
    names, out = executed(code, capsys)
    run = names["run"]
    for what, variable in (("speed", "slave.velocity"), ("acceleration", "slave.acceleration")):
        value, limit = printed(out, what)
        assert value == round(float(np.abs(run[variable]).max()))
        assert limit == names[f"max_{what}"]
        assert value <= limit or run["error"][-1]
    if length == 300.0:
        assert re.search(r"0 cuts of 300 mm, error_id 1\d", out)
    else:
        assert f"{math.floor(10.0 * line / length - 0.2)} cuts of {length:g} mm, no error" in out
    if (length, line) == (800.0, 500.0):
        for text in re.findall(r"`(\d+ cuts .*?|speed .*?)`", README):
            assert text in out


@pytest.mark.parametrize(("length", "line"), [(1500.0, 1000.0), (400.0, 500.0), (3000.0, 1200.0), (1000.0, 1300.0)])
def test_the_plc_loop_tells_the_truth_of_other_lengths_and_speeds(
    fmus: Fmus, capsys: pytest.CaptureFixture[str], length: float, line: float
) -> None:
    """A cut is counted 0.2 s after its mark met the saw, `meet` beyond it; the first order can be met by mark 1. At
    1300 mm/s the saw comes home too late for the second mark of 1000 mm."""
    code = replaced(
        code_with(WIRING, "gear_in_pos"), "length, line = 1500.0, 1000.0", f"length, line = {length}, {line}"
    )
    code = replaced(code, "build/native/FlyingSaw.fmu", str(fmus.native("FlyingSaw")))
    names, out = executed(code, capsys)
    assert max(map(abs, names["cuts"])) < 1e-9
    for what in ("velocity", "acceleration"):
        value, limit = printed(out, what)
        assert 0.0 < value <= limit == names[f"max_{what}"]
    if line == 1300.0:
        assert "a command was refused 17118" in out
        assert "1 cuts, worst error" in out
    else:
        assert "stopped" not in out
        assert f"{math.floor((line * 14.8 - names['meet']) / length)} cuts, worst error" in out


def test_the_batch_example_gives_what_its_comments_say() -> None:
    code = code_with(PYTHON, "simulate_many")
    names: dict[str, Any] = {}
    exec(code, names)
    result = names["result"]
    assert result.values.shape == (1000, 5000, 2)
    assert not result.failures
    peaks = -result["slave.acceleration"].min(axis=1)  # of a stop: v^2 / (2 phasing) times 1.642
    assert peaks[-1] == pytest.approx(1.64224 * 90.0**2 / (2.0 * 90.0), rel=1e-4)


def test_the_line_for_fmpy_runs(native: Path, tmp_path: Path) -> None:
    (line,) = re.findall(r"fmpy simulate (?:.*\\\n)+.*", WIRING)
    words = shlex.split(line.replace("\\\n", " "))
    words[words.index("build/native/Synchronizer.fmu")] = str(native)
    words[words.index("Synchronizer_out.csv")] = str(tmp_path / "out.csv")
    words[0] = str(Path(sys.executable).with_name("fmpy"))
    subprocess.run(words, cwd=ROOT, check=True)
    rows = (tmp_path / "out.csv").read_text().splitlines()
    assert len(rows) == 802


def test_its_commands_exist() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.M))
    assert set(re.findall(r"make (run|test|line|benchmark|pictures|quick|check|help)\b", README)) <= targets
    for file in re.findall(r"(?:scenarios|build)/[\w/]+\.csv", README):
        assert (ROOT / file).exists(), file


def test_links_lead_to_files_that_exist() -> None:
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]
    files = [*pages, *(ROOT / "scenarios").rglob("README.md"), *(ROOT / "model").rglob("README.md")]
    for file in files:
        for link in re.findall(r"\]\((?!http|#)([^)#]+)[^)]*\)", file.read_text("utf-8")):
            assert (file.parent / link).exists(), f"{file}: {link}"


# --- of the blocks ---


def folder(block: str) -> str:
    """The block's folder in the repository."""
    module = type(Recipe(block).block()).__module__
    return "/".join(["model", *module.split(".")[:-1]])


def test_the_root_readme_links_to_each_block(block: str) -> None:
    assert f"({folder(block)}/README.md)" in README


def test_a_block_s_readme_has_the_sections_that_all_have(block: str) -> None:
    text = readme(type(Recipe(block).block()))
    assert text.startswith(f"# {block}\n")
    headings = re.findall(r"^## (.*)", text, re.M)
    assert [heading for heading in headings if heading in SECTIONS] == list(SECTIONS)
    assert len(re.findall(rf"^!\[.+\]\(../../../docs/{block}.svg\)$", text, re.M)) == 1


def test_its_diagram_has_the_states_that_the_block_shows_or_its_stages(block: str) -> None:
    _, _, text = readme(type(Recipe(block).block())).partition("\n## States\n")
    (diagram,) = re.findall(r"```mermaid\nstateDiagram-v2\n(.*?)```", text, re.S)
    shown = {member.name for member in Recipe(block).variables["state"].choices}
    assert set(read(diagram).states) in (shown, set(stages(block)))
    assert all(re.search(rf"\b{name}\b", text) for name in shown)


def test_its_table_has_a_row_for_each_stage(block: str) -> None:
    _, _, text = readme(type(Recipe(block).block())).partition("\n## States\n")
    (table,) = re.findall(r"^\| [Ss]tage \|.*\n\|[- |]+\n((?:\|.*\n)+)", text, re.M)
    assert re.findall(r"^\| `?(\w+)`? \|", table, re.M) == list(stages(block))


def stages(block: str) -> dict[str, int]:
    """What drives the slave, by name."""
    (kind,) = {cell.type for cell in cells(Recipe(block).block()) if cell.type.__name__ == "Stage"}
    return {member.name: member.value for member in members(kind)}


def test_the_variables_that_it_names_exist(block: str) -> None:
    """All in backticks that is written as a variable: in full, the last part after a dot, a group, or a pattern."""
    recipe = Recipe(block)
    names = set(recipe.variables)
    known = {name.split(".", i)[-1] for name in names for i in range(name.count(".") + 1)}
    known |= {f".{last}" for last in known} | {name.partition(".")[0] for name in names} | {"true", "false"}
    prose = re.sub(r"```.*?```", "", readme(type(recipe.block())), flags=re.S)
    written = set(re.findall(r"`(\.?[a-z][a-z0-9_.*]*)`", prose))
    files = {name for name in written if name.endswith((".py", ".toml", ".md"))}
    unknown = {name for name in written - files - known - SOURCES if not any(fnmatchcase(full, name) for full in names)}
    assert not unknown
    assert written & names
