"""The zip file of an FMU: other programs read it, and it is the same every time."""

import io
import random
import shutil
import subprocess
import zipfile
import zlib
from pathlib import Path

import pytest

from motionsync_fmu.fmus import zip as zip_file
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.fingerprint import Files

NOISE = random.Random(0).randbytes(3000)
FILES: Files = {
    "modelDescription.xml": b"".join(b'<Real name="x%d" valueReference="%d"/>\n' % (i, i) for i in range(900)),
    "documentation/licenses/empty.txt": b"",
    "binaries/linux64/Säge.so": bytes(70_000) + NOISE,
    "noise": NOISE,
}
TIME = "1700000001"  # 2023-11-14 22:13:21 UTC; zip files have even seconds


@pytest.fixture(autouse=True)
def time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", TIME)


def by_zlib(data: bytes) -> bytes:
    return zlib.compress(data, 9, -zlib.MAX_WBITS)


def test_packed_by_zlib_it_is_the_file_that_pythons_zipfile_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(zip_file, "deflated", by_zlib)
    reference = io.BytesIO()
    with zipfile.ZipFile(reference, "w") as z:
        for name in sorted(FILES):
            info = zipfile.ZipInfo(name, (2023, 11, 14, 22, 13, 21))
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            z.writestr(info, FILES[name], compresslevel=9)
    write_zip(tmp_path / "a.fmu", FILES)
    assert (tmp_path / "a.fmu").read_bytes() == reference.getvalue()


def test_it_is_read_back_whole(tmp_path: Path) -> None:
    write_zip(tmp_path / "a.fmu", FILES)
    with zipfile.ZipFile(tmp_path / "a.fmu") as z:
        assert z.testzip() is None
        assert {name: z.read(name) for name in z.namelist()} == FILES
        assert z.namelist() == sorted(FILES)


def test_it_is_the_same_every_time(tmp_path: Path) -> None:
    write_zip(tmp_path / "a.fmu", FILES)
    write_zip(tmp_path / "b.fmu", dict(reversed(FILES.items())))
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


def test_unzip_finds_no_fault(tmp_path: Path) -> None:
    write_zip(tmp_path / "a.fmu", FILES)
    if shutil.which("unzip") is None:
        pytest.skip("unzip is not installed")
    done = subprocess.run(["unzip", "-t", str(tmp_path / "a.fmu")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "No errors detected" in done.stdout


def test_what_fails_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(data: bytes) -> bytes:
        raise MemoryError

    monkeypatch.setattr(zip_file, "deflated", full)
    with pytest.raises(MemoryError):
        write_zip(tmp_path / "a.fmu", FILES)
    assert not list(tmp_path.iterdir())
