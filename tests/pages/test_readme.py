"""The READMEs stay true: what they show to type does what they say, and what they name exists."""

import re
import shlex
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import cells, members
from motionsync_fmu.pages.readme import readme
from motionsync_fmu.pages.state_diagram import read
from tests import ROOT
from tests.support.fmus import Fmus

README = (ROOT / "README.md").read_text("utf-8")
SOURCES = {"mv_follow2"}  # a source that is written like a variable
SECTIONS = ("How to use it", "Names in the source system", "Decisions where the source is silent", "States")


def code_with(text: str) -> str:
    """The one Python example that holds a text."""
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", README, re.S) if text in code]
    return str(code)


def test_the_saw_cuts_where_it_should(fmus: Fmus, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    exec(code_with("gear_in_pos").replace("build/native/FlyingSaw.fmu", str(fmus.native("FlyingSaw"))), names)
    assert len(names["cuts"]) == 9
    assert max(map(abs, names["cuts"])) < 1e-9
    assert "9 cuts, worst error" in capsys.readouterr().out


def test_the_batch_example_gives_what_its_comments_say() -> None:
    code = code_with("simulate_many")
    names: dict[str, Any] = {}
    exec(code, names)
    result = names["result"]
    assert result.values.shape == (1000, 5000, 2)
    assert not result.failures
    peaks = -result["slave.acceleration"].min(axis=1)  # of a stop: v^2 / (2 phasing) times 1.642
    assert peaks[-1] == pytest.approx(1.64224 * 90.0**2 / (2.0 * 90.0), rel=1e-4)


def test_the_line_for_fmpy_runs(native: Path, tmp_path: Path) -> None:
    (line,) = re.findall(r"fmpy simulate (?:.*\\\n)+.*", README)
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
    files = [ROOT / "README.md", ROOT / "scenarios" / "README.md", *(ROOT / "model").rglob("README.md")]
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
