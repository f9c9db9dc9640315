"""Where files go for which the user names no folder, and files that are written as a whole or not at all, on a disk
that is full."""

import json
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.fmus.prebuilt import prepare_fmus
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.paths import replace_file, replace_files
from tests.support.project.command_line import Command
from tests.support.project.workshop import PYTHON

resource = pytest.importorskip("resource", reason="Windows has no limit of the size of files")
LIMIT = 4096  # bytes of a file
UNWRITABLE = Path("/proc")  # even for root


@pytest.mark.skipif(not UNWRITABLE.is_dir(), reason="only Linux has such a folder")
def test_in_a_folder_that_cannot_be_written_all_goes_to_the_cache(
    motionsync: Command, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(UNWRITABLE)
    run = ("run", "Synchronizer/polynomial", *PYTHON, "--no-report", "--json")
    outcome = motionsync(*run)
    assert outcome.status == 0, outcome.err
    assert f"this folder cannot be written: all files go to {cache}" in outcome.err
    assert json.loads(outcome.out)[0]["result"].startswith(str(cache))
    outcome = motionsync(*run, "--output", tmp_path)
    assert outcome.status == 0, outcome.err
    assert "cannot be written" not in outcome.err
    assert (tmp_path / "Synchronizer/polynomial/Synchronizer_out.csv").is_file()
    outcome = motionsync("build", "Synchronizer", *PYTHON)
    assert outcome.status == 0, outcome.err
    assert outcome.out.startswith(str(cache))


@pytest.mark.parametrize("change", ["others may write it", "a link"])
def test_an_fmu_in_the_cache_that_others_could_write_is_built_anew(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (fmu,) = prepare_fmus([Recipe("Synchronizer")], Flavour.PYTHON)
    assert fmu.is_relative_to(cache)
    assert [path.stat().st_mode & 0o777 for path in (cache, fmu.parent, fmu)] == [0o700, 0o700, 0o600]
    if change == "a link":
        fmu.replace(tmp_path / fmu.name)
        fmu.symlink_to(tmp_path / fmu.name)
    else:
        fmu.chmod(0o666)
    before = fmu.lstat().st_ino
    prepare_fmus([Recipe("Synchronizer")], Flavour.PYTHON)
    assert fmu.lstat().st_ino != before
    assert fmu.lstat().st_mode & 0o777 == 0o600


@pytest.fixture
def full_disk() -> Iterator[None]:
    """No file may be larger than LIMIT: writing more fails as on a full disk, with an error that names no file."""
    before, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handler)


def test_a_file_that_cannot_be_written_is_named_and_nothing_of_it_left(full_disk: None, tmp_path: Path) -> None:
    target = tmp_path / "a.fmu"
    with replace_file(target) as part:
        part.write_bytes(b"old")
    with pytest.raises(OSError, match="File too large") as error, replace_file(target) as part:
        part.write_bytes(bytes(2 * LIMIT))
    assert error.value.filename == str(target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_folder_that_cannot_be_written_is_named_and_nothing_of_it_left(full_disk: None, tmp_path: Path) -> None:
    folder = tmp_path / "results"
    with pytest.raises(OSError, match="File too large") as error, replace_files(folder) as part:
        [part(f"{size}.csv").write_bytes(bytes(size)) for size in (LIMIT, 2 * LIMIT)]
    assert error.value.filename == str(folder)
    assert list(tmp_path.iterdir()) == []


def test_an_error_that_names_its_file_keeps_the_name(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError) as error, replace_files(tmp_path / "results"):
        tmp_path.read_bytes()
    assert error.value.filename == str(tmp_path)
