"""CONTRIBUTING is followed to the letter: its list of files and its edits, and nothing else, make a block."""

import os
import re
import subprocess
import sys
from pathlib import Path
from shutil import copyfile, copytree, ignore_patterns

import pytest

from tests import ROOT
from tests.support.fmus import Shared
from tests.support.mypy_cache import copied_cache

NEW_BLOCK = ROOT / "tests" / "support" / "new_block"
LINE = "from .shifter.block import Shifter as Shifter"
ENTRY = '"Shifter": ".shifter.block",'
LEFT_OUT = ("install", "__pycache__")
OF_FMUS = ("fmi3", "fmu", "native")  # these folders take as long as all others
ROW = "| run a slave ahead of its master | [`Shifter`](model/motionsync/shifter/README.md) |"


def listed() -> list[str]:
    """The files that CONTRIBUTING lists for a new block."""
    text = (ROOT / "CONTRIBUTING.md").read_text()
    part = text[text.index("<!-- new block: files -->") : text.index("<!-- new block: end -->")]
    return re.findall(r"^\d+\. `([^`]+)`:", part, re.M)


@pytest.fixture(scope="module")
def copy(shared: Shared) -> Path:
    """A copy of the project in which CONTRIBUTING's list has been followed."""
    return shared.once("contributing", follow_the_list) / "motionsync"


def follow_the_list(folder: Path) -> None:
    root = folder / "motionsync"
    # Compiled modules are copied, too: they are valid, since the files keep their times.
    copytree(ROOT, root, ignore=ignore_patterns(".*", "new_block", "*.fmu"))
    for file in listed():
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        copyfile(NEW_BLOCK / file, root / file)
    registry = root / "model" / "motionsync" / "blocks.py"
    text = registry.read_text()
    text = text.replace("from .synchronizer", f"{LINE}\n    from .synchronizer", 1)
    registry.write_text(text.replace('        "Synchronizer"', f'        {ENTRY}\n        "Synchronizer"', 1))
    front = (root / "README.md").read_text()
    (root / "README.md").write_text(front.replace("| switch a slave", f"{ROW}\n| switch a slave", 1))
    run(root, "-m", "tests.regenerate", "shifter")  # make references
    run(root, "-m", "motionsync_fmu.pages.pictures", "docs", "Shifter")  # make pictures, which draws all blocks


def run(root: Path, *command: str) -> str:
    """The output of a Python process whose sources are those of `root`."""
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


def test_the_new_block_has_the_style_and_the_types_of_the_others(copy: Path, tmp_path: Path) -> None:
    """To the tool a block is of the type that `Blocks` gives: a new one changes no type there."""
    run(copy, "-m", "ruff", "check", "--no-cache", ".")
    run(copy, "-m", "ruff", "format", "--no-cache", "--check", ".")
    run(copy, "-m", "mypy", "--cache-dir", str(copied_cache(tmp_path)), "-p", "motionsync", "-p", "tests.oracle")


@pytest.mark.slow
@pytest.mark.parametrize("part", ["of FMUs", "others"])
def test_every_test_that_concerns_a_registered_block_passes(copy: Path, part: str, tmp_path: Path) -> None:
    """The rule is `concerns_block` in tests/conftest.py. tests/install is left out: a wheel runs one block."""
    of_fmus, left_out = ({copy / "tests" / name for name in names} for names in (OF_FMUS, LEFT_OUT))
    others = {*(copy / "tests").glob("*/"), *copy.glob("tests/test_*.py")} - of_fmus - left_out
    files = of_fmus if part == "of FMUs" else others
    options = ("-q", "-p", "no:cacheprovider", "--registered", "Shifter", "--basetemp", str(tmp_path))
    output = run(copy, "-m", "pytest", *options, *map(str, sorted(files)))
    summary = output.splitlines()[-1]
    assert re.search(r"\b[1-9]\d+ passed", summary), output
    assert not re.search(r"failed|error", summary), output
