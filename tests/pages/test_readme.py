"""The README stays true: what it shows to type does what it says."""

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from motionsync.blocks import BLOCKS
from tests import ROOT
from tests.support.fmus import Fmus

README = (ROOT / "README.md").read_text("utf-8")


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


@pytest.mark.parametrize("name", BLOCKS)
def test_it_tells_what_the_pages_of_the_blocks_tell(name: str) -> None:
    for step in BLOCKS[name].guide:
        assert step in README
    for there, here in BLOCKS[name].names:
        assert f"| {there} | {here} |" in README


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


def test_its_commands_and_links_exist() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.M))
    assert set(re.findall(r"make (run|test|benchmark|pictures)", README)) <= targets
    for link in re.findall(r"\]\((?!http|#)([^)]+)\)", README):
        assert (ROOT / link).exists(), link
    for file in re.findall(r"(?:scenarios|build)/[\w/]+\.csv", README):
        assert (ROOT / file).exists(), file
