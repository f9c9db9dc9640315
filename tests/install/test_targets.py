"""Each make target does its work in a fresh clone, where nothing but its own extras is installed."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import ROOT
from tests.support.project.extras import dry_run

HELP = re.findall(r"^([a-z]+):.*## ", (ROOT / "Makefile").read_text("utf-8"), re.M)
ELSEWHERE = {"docs", "release"}  # tests/site and tests/release make these with their extras alone
SHORT = {"build": ["Synchronizer"], "line": ["line/line_synchronizer.toml"]}  # arguments that make a target quicker
IN_DOCS = {"motionsync_fmu.pages.pictures", "tools.shortest_length_picture", "tools.measured_line_pictures"}


def targets_with_few_packages() -> list[str]:
    """The targets that install something, but not what tests need."""
    return [target for target in HELP if (extras := dry_run(target)[0]) and "test" not in extras]


def test_the_targets_are_these() -> None:
    assert {*targets_with_few_packages()} == {"run", "line", "build", "pictures"} | ELSEWHERE


@pytest.mark.slow
@pytest.mark.parametrize("target", ["run", "line", "build", "pictures"])
def test_a_target_needs_no_more_than_its_extras(target: str, tmp_path: Path) -> None:
    """Where a target writes is another folder here."""
    extras, commands = dry_run(target)
    path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    assert commands
    for command in commands:
        words = command.replace("motionsync ", "-m motionsync_fmu.cli ", 1).removeprefix("python ").split()[1:]
        module, *arguments = words
        if module in IN_DOCS:
            assert arguments == ["docs"]
            arguments = [str(shutil.copytree(ROOT / "docs", tmp_path / "docs", dirs_exist_ok=True))]
        else:
            arguments += [*SHORT.get(target, ()), "--output", str(tmp_path)]
        call = [sys.executable, "-m", "tests.support.project.extras", ",".join(extras), module, *arguments]
        done = subprocess.run(
            call, cwd=tmp_path, check=False, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": path}
        )
        assert done.returncode == 0, done.stderr
    assert any(tmp_path.iterdir())
