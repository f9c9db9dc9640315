"""CONTRIBUTING is followed to the letter: its list of files and its edits, and nothing else, make a block."""

import os
import re
import subprocess
import sys
from pathlib import Path
from shutil import copyfile, copytree, ignore_patterns

import pytest

from tests import ROOT
from tests.support.hosts.fmus import Shared
from tests.support.project.mypy_cache import copied_cache
from tools.new_block import write_block

LEFT_OUT = ("install", "__pycache__")
OF_FMUS = ("fmi3", "fmu", "native")  # these folders take as long as all others


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
    copytree(ROOT, root, ignore=ignore_patterns(".*", "*.fmu"))
    run(root, "-m", "tools.new_block", "Clamper")
    (root / "benchmarks" / "cases" / "clamper.py").unlink()  # which is no duty
    run(root, "-m", "tests.regenerate", "clamper")  # make references
    run(root, "-m", "motionsync_fmu.pages.pictures", "docs", "Clamper")  # make pictures, which draws all blocks


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


def test_the_files_of_a_new_block_are_those_of_the_list(tmp_path: Path) -> None:
    for file in ("model/motionsync/blocks.py", "README.md"):
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        copyfile(ROOT / file, tmp_path / file)
    *files, registry, front = write_block("WebGuide", tmp_path)
    assert sorted(map(str, files)) == sorted(
        file.replace("clamper", "web_guide").replace("Clamper", "WebGuide") for file in listed()
    )
    assert all((tmp_path / file).is_file() for file in files)
    assert not [file for file in files if "shifter" in (tmp_path / file).read_text("utf-8").lower()]
    before, after = ((root / registry).read_text().splitlines() for root in (ROOT, tmp_path))
    assert [line.strip() for line in after if line not in before] == [
        "from .web_guide.block import WebGuide as WebGuide",
        '"WebGuide": ".web_guide.block",',
    ]
    assert "[`WebGuide`](model/motionsync/web_guide/README.md)" in (tmp_path / front).read_text("utf-8")
    with pytest.raises(ValueError, match=r"NAME = WebGuide is not allowed: benchmarks/cases/web_guide\.py"):
        write_block("WebGuide", tmp_path)  # what somebody has written is not written over


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("web guide", "it must be a word or several"),
        ("webGuide", "it must be a word or several"),
        ("", "it must be a word or several"),
        ("Gearing", "there is such a block"),
    ],
)
def test_a_name_that_a_block_cannot_have_is_refused(name: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"NAME = {name} is not allowed: {why}"):
        write_block(name, tmp_path)
    assert list(tmp_path.iterdir()) == []


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
    options = ("-q", "-p", "no:cacheprovider", "--registered", "Clamper", "--basetemp", str(tmp_path))
    output = run(copy, "-m", "pytest", *options, *map(str, sorted(files)))
    summary = output.splitlines()[-1]
    assert re.search(r"\b[1-9]\d+ passed", summary), output
    assert not re.search(r"failed|error", summary), output
