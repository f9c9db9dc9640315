"""What is built once for all processes of a test run."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests import ROOT
from tests.support.hosts.fmus import Shared

DIES = """
import os, sys
from pathlib import Path
from tests.support.hosts.fmus import Shared
def fill(folder):
    (folder / "half").touch()
    os._exit(1)
Shared(Path(sys.argv[1])).once("made", fill)
"""


def test_a_folder_is_filled_once(tmp_path: Path) -> None:
    folder = Shared(tmp_path).once("a/made", lambda path: (path / "whole").touch())
    assert Shared(tmp_path).once("a/made", pytest.fail) == folder == tmp_path / "a" / "made"
    assert [file.name for file in folder.iterdir()] == ["whole"]


def test_what_a_process_that_died_has_left_is_made_anew(tmp_path: Path) -> None:
    assert subprocess.run([sys.executable, "-c", DIES, str(tmp_path)], cwd=ROOT, check=False).returncode == 1
    folder = Shared(tmp_path).once("made", lambda path: (path / "whole").touch())
    assert [file.name for file in folder.iterdir()] == ["whole"]


def test_what_could_not_be_made_is_tried_again(tmp_path: Path) -> None:
    shared = Shared(tmp_path)
    with pytest.raises(ZeroDivisionError):
        shared.once("made", lambda path: 1 / 0)
    assert shared.once("made", lambda path: None).is_dir()
