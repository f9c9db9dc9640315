"""The zip file of an FMU: other programs read it, whichever compressor packed it, and it is the same every time."""

import io
import random
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from motionsync_fmu.archive import Deflate, Files, quick, write
from motionsync_fmu.native.packing import smallest

NOISE = random.Random(0).randbytes(3000)
FILES: Files = {
    "modelDescription.xml": b"".join(b'<Real name="x%d" valueReference="%d"/>\n' % (i, i) for i in range(900)),
    "documentation/licenses/empty.txt": b"",
    "binaries/linux64/Säge.so": bytes(70_000) + NOISE,
    "noise": NOISE,
}
TIME = "1700000001"  # 2023-11-14 22:13:21 UTC; zip files have even seconds
both = pytest.mark.parametrize("deflate", [quick, smallest])


@pytest.fixture(autouse=True)
def time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", TIME)


def infos(file: Path) -> list[dict[str, object]]:
    """What a zip file says of each file, but for where it lies and how small it is."""
    said = "filename date_time compress_type create_system create_version extract_version flag_bits internal_attr"
    names = [*said.split(), "external_attr", "extra", "comment", "CRC", "file_size"]
    with zipfile.ZipFile(file) as z:
        return [{name: getattr(info, name) for name in names} for info in z.infolist()]


def test_it_is_the_file_that_pythons_zipfile_writes(tmp_path: Path) -> None:
    reference = io.BytesIO()
    with zipfile.ZipFile(reference, "w") as z:
        for name in sorted(FILES):
            info = zipfile.ZipInfo(name, (2023, 11, 14, 22, 13, 21))
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            z.writestr(info, FILES[name], compresslevel=9)
    write(tmp_path / "a.fmu", FILES)
    assert (tmp_path / "a.fmu").read_bytes() == reference.getvalue()


@both
def test_it_is_read_back_whole(tmp_path: Path, deflate: Deflate) -> None:
    write(tmp_path / "a.fmu", FILES, deflate)
    with zipfile.ZipFile(tmp_path / "a.fmu") as z:
        assert z.testzip() is None
        assert {name: z.read(name) for name in z.namelist()} == FILES
        assert z.namelist() == sorted(FILES)


def test_the_compressor_changes_the_size_alone(tmp_path: Path) -> None:
    write(tmp_path / "quick.fmu", FILES)
    write(tmp_path / "small.fmu", FILES, smallest)
    assert infos(tmp_path / "small.fmu") == infos(tmp_path / "quick.fmu")
    assert (tmp_path / "small.fmu").stat().st_size < (tmp_path / "quick.fmu").stat().st_size


@both
def test_it_is_the_same_every_time(tmp_path: Path, deflate: Deflate) -> None:
    write(tmp_path / "a.fmu", FILES, deflate)
    write(tmp_path / "b.fmu", dict(reversed(FILES.items())), deflate)
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


@both
def test_unzip_finds_no_fault(tmp_path: Path, deflate: Deflate) -> None:
    write(tmp_path / "a.fmu", FILES, deflate)
    if shutil.which("unzip") is None:
        pytest.skip("unzip is not installed")
    done = subprocess.run(["unzip", "-t", str(tmp_path / "a.fmu")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "No errors detected" in done.stdout


def test_what_fails_leaves_no_file(tmp_path: Path) -> None:
    def full(data: bytes) -> bytes:
        raise MemoryError

    with pytest.raises(MemoryError):
        write(tmp_path / "a.fmu", FILES, full)
    assert not list(tmp_path.iterdir())
