"""CONTRIBUTING is followed to the letter: its list of files, and nothing else, makes a block."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from tests import ROOT

NEW_BLOCK = ROOT / "tests" / "support" / "new_block"
LINE = "from .shifter.block import Shifter"
ENTRY = '"Shifter": Shifter,'
ROW = "| run a slave ahead of its master | [`Shifter`](model/motionsync/shifter/README.md) |"


def listed() -> list[str]:
    """The files that CONTRIBUTING lists for a new block."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    part = text[text.index("<!-- new block: files -->") : text.index("<!-- new block: end -->")]
    return re.findall(r"^\d+\. `([^`]+)`:", part, re.M)


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project in which CONTRIBUTING's list has been followed."""
    root = tmp_path_factory.mktemp("contributing")
    junk = shutil.ignore_patterns("__pycache__", "new_block", "scenarios")
    for folder in ("model", "fmu_src", "tests", "benchmarks"):
        shutil.copytree(ROOT / folder, root / folder, ignore=junk)
    (root / "docs").mkdir()
    for file in ("pyproject.toml", "README.md", "docs/wiring.md", "docs/python.md"):
        shutil.copy(ROOT / file, root / file)
    for file in listed():
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(NEW_BLOCK / file, root / file)
    registry = root / "model" / "motionsync" / "blocks.py"
    text = registry.read_text()
    text = text.replace("from .synchronizer", f"{LINE}\nfrom .synchronizer", 1)
    registry.write_text(text.replace('    "Synchronizer"', f'    {ENTRY}\n    "Synchronizer"', 1))
    front = (root / "README.md").read_text()
    (root / "README.md").write_text(front.replace("| switch a slave", f"{ROW}\n| switch a slave", 1))
    run(root, "-m", "tests.regenerate")  # make references
    run(root, "-m", "motionsync_fmu.pages.pictures", "docs")  # make pictures
    return root


def run(root: Path, *command: str) -> str:
    """What a Python process prints that has the model and fmu_src of `root`."""
    path = os.pathsep.join(str(root / part) for part in ("model", "fmu_src"))
    done = subprocess.run(
        [sys.executable, *command],
        cwd=root,
        check=False,
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": path},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_list_is_complete() -> None:
    held = {str(p.relative_to(NEW_BLOCK)) for p in NEW_BLOCK.rglob("*") if p.is_file() and p.suffix != ".pyc"}
    assert sorted(listed()) == sorted(held - {"conftest.py"})
    contributing = (ROOT / "CONTRIBUTING.md").read_text()
    assert LINE in contributing
    assert ENTRY in contributing


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_the_new_block_becomes_an_fmu(copy: Path, flavour: str) -> None:
    run(copy, "-m", "motionsync_fmu.cli", "build", "Shifter", "--flavour", flavour, "--folder", "built")
    (fmu,) = copy.glob(f"built/**/{flavour}/Shifter.fmu") or copy.glob("built/**/Shifter.fmu")
    assert validate_fmu(str(fmu)) == []
    told = run(copy, "-m", "motionsync_fmu.cli", "run", "scenarios/Shifter/shift", "--flavour", flavour)
    assert "Shifter" in told


def test_the_new_blocks_own_tests_and_the_generic_ones_take_it_up(copy: Path) -> None:
    tests = ("tests/model/shifter", "tests/native/test_same_bits.py", "tests/benchmarks")
    told = run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests, "-k", "shifter or Shifter")
    assert "passed" in told
    assert "failed" not in told


def test_what_is_asked_of_every_block_is_asked_of_the_new_one(copy: Path) -> None:
    """Of its pages, its example and its declarations; what needs an FMU is left out."""
    tests = ("tests/pages/test_readme.py", "tests/pages/test_block_page.py", "tests/fmu/test_fmu.py")
    told = run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--quick", *tests, "-k", "Shifter")
    assert "passed" in told
    assert "failed" not in told
