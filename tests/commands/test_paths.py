"""Files that are written as a whole or not at all, on a disk that is full."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from motionsync_fmu.paths import replace_file, replace_files

resource = pytest.importorskip("resource", reason="Windows has no limit of the size of files")
LIMIT = 4096  # bytes of a file


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
        [(part / f"{size}.csv").write_bytes(bytes(size)) for size in (LIMIT, 2 * LIMIT)]
    assert error.value.filename == str(folder)
    assert list(tmp_path.iterdir()) == []


def test_an_error_that_names_its_file_keeps_the_name(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError) as error, replace_files(tmp_path / "results"):
        tmp_path.read_bytes()
    assert error.value.filename == str(tmp_path)
