"""The cache of blocks' libraries between processes: a library is loaded if it is undamaged and was made of the present
sources; else it is compiled anew."""

import os
import shutil
import subprocess
import sys
import time
from ctypes import byref, c_bool, c_double, c_int64
from pathlib import Path

import pytest

from motionsync.synchronizer.block import Synchronizer
from motionsync_fmu.batch import library
from motionsync_fmu.errors import UserError
from tests.support.fake_blocks.divider import Divider

BLOCK = b"""#include <stdbool.h>
#include <stdint.h>
typedef struct Block { double x; } Block;
int64_t block_initialize(Block *self, bool *failed) { return self && failed ? 0 : 1; }
int64_t block_step(Block *self, double h, bool *failed) { return self && failed ? (int64_t)h + 40 : 0; }
"""


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache; zig has one of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path_factory.getbasetemp() / "zig"))
    return tmp_path / "motionsync"


@pytest.fixture
def compilations(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A short C text for every block, and what has been compiled."""
    compiled: list[str] = []
    monkeypatch.setattr(library, "c_source", lambda block: compiled.append(type(block).__name__) or {"block.c": BLOCK})
    return compiled


def load_and_step(monkeypatch: pytest.MonkeyPatch, block_type: type = Synchronizer) -> None:
    """Load the library of a block as a new process would, and call it."""
    monkeypatch.setattr(library, "_libraries", {})
    step = library.library(block_type)["block_step"]
    step.restype = c_int64
    assert step(byref(c_double()), c_double(2.0), byref(c_bool())) == 42


def cached_file(cache: Path) -> Path:
    """The only library in the cache."""
    (file,) = (cache / "blocks").glob(f"*{library.SUFFIX}")
    return file


def test_a_block_is_compiled_once(compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    load_and_step(monkeypatch)
    file, contents = cached_file(cache), cached_file(cache).read_bytes()
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"]
    assert (cached_file(cache), file.read_bytes()) == (file, contents)


COMPILES_ONCE = """
import sys, time
from pathlib import Path
from motionsync.synchronizer.block import Synchronizer
from motionsync_fmu.batch import library

def slow(block):
    with Path(sys.argv[1]).open("a") as log:
        log.write("compiled\\n")
    time.sleep(float(sys.argv[2]))
    return {"block.c": sys.argv[3].encode()}

library.c_source = slow
print(library.library(Synchronizer).block_step(None, None))
"""


def process(log: Path, seconds: float) -> subprocess.Popen[str]:
    """A process that compiles a block, and takes so many seconds more for it."""
    command = [sys.executable, "-c", COMPILES_ONCE, str(log), str(seconds), BLOCK.decode()]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def test_of_processes_that_begin_together_one_compiles(cache: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    together = [process(log, 1.0) for _ in range(3)]
    assert [p.communicate(timeout=60)[0] for p in together] == ["0\n"] * 3
    assert log.read_text() == "compiled\n"
    assert cached_file(cache)


def test_a_process_that_dies_while_it_compiles_stops_nobody(cache: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    with process(log, 600.0) as dying:
        while not (log.exists() and log.read_text()):
            assert dying.poll() is None
            time.sleep(0.01)
        dying.kill()
    with process(log, 0.0) as next_one:
        assert next_one.communicate(timeout=60)[0] == "0\n"
    assert log.read_text() == "compiled\ncompiled\n"
    assert cached_file(cache)


def test_another_source_or_compiler_is_compiled_anew_and_replaces_the_old_library(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load_and_step(monkeypatch)
    files = {cached_file(cache)}
    law = cache.parent / "law.py"
    law.write_text("another")
    monkeypatch.setattr(library, "SOURCE_FOLDERS", (*library.SOURCE_FOLDERS, law.parent))
    load_and_step(monkeypatch)
    files.add(cached_file(cache))
    monkeypatch.setattr(library.metadata, "version", lambda name: "0.0")
    load_and_step(monkeypatch)
    files.add(cached_file(cache))
    assert compilations == ["Synchronizer"] * 3
    assert len(files) == 3


@pytest.mark.parametrize("damage", ["empty", "cut", "longer", "one bit"])
def test_a_damaged_library_is_not_loaded_but_made_anew(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch, damage: str
) -> None:
    load_and_step(monkeypatch)
    file, contents = cached_file(cache), cached_file(cache).read_bytes()
    half = len(contents) // 2
    bit = contents[:half] + bytes([contents[half] ^ 1]) + contents[half + 1 :]
    file.unlink()  # this process goes on with the old contents
    file.write_bytes({"empty": b"", "cut": contents[:-1], "longer": contents + b"0", "one bit": bit}[damage])
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2
    assert cached_file(cache).read_bytes() == contents


UNIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows gives a user's folders to the user alone")
ROOT = pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give files away")


@UNIX
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o755, 0o707])
@pytest.mark.parametrize("depth", ["motionsync", "motionsync/blocks"])
def test_the_cache_is_made_private(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch, mode: int, depth: str
) -> None:
    folder = cache.parent / depth
    folder.mkdir(parents=True)
    folder.chmod(mode)
    load_and_step(monkeypatch)
    assert [(each.stat().st_mode & 0o777) for each in (cache, cache / "blocks")] == [0o700, 0o700]
    assert cached_file(cache).stat().st_mode & 0o777 == 0o600


@UNIX
@pytest.mark.parametrize("mode", [0o622, 0o602, 0o620, 0o777])
def test_a_library_that_others_could_write_is_not_loaded_but_made_anew(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch, mode: int
) -> None:
    load_and_step(monkeypatch)
    cached_file(cache).chmod(mode)
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2


@UNIX
@ROOT
@pytest.mark.parametrize("linked", [False, True])
def test_a_library_of_another_user_is_not_loaded(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch, linked: bool
) -> None:
    load_and_step(monkeypatch)
    file = cached_file(cache)
    if linked:
        other = cache.parent / "planted"
        other.write_bytes(file.read_bytes())
        file.unlink()
        file.symlink_to(other)
    os.chown(file, 12345, 12345, follow_symlinks=False)
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2
    assert cached_file(cache).owner() == "root"


@UNIX
@ROOT
@pytest.mark.parametrize("depth", ["motionsync", "motionsync/blocks"])
def test_a_cache_of_another_user_is_not_used(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch, depth: str
) -> None:
    folder = cache.parent / depth
    folder.mkdir(parents=True)
    os.chown(folder, 12345, 12345)
    load_and_step(monkeypatch)
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2
    assert list(folder.iterdir()) == []


@pytest.mark.usefixtures("no_cache")
def test_it_works_without_a_cache(compilations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    load_and_step(monkeypatch)
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"] * 2


def test_blocks_of_other_packages_are_not_cached(
    compilations: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load_and_step(monkeypatch, Divider)
    assert not cache.exists()
    assert compilations == ["Divider"]


def test_the_next_process_starts_no_compiler() -> None:
    """A batch of a real block. The slave follows the master's position, extrapolated by 3 u/s * 0.01 s."""
    script = """
import sys
from motionsync_fmu.batch.simulation import simulate_many
sys.addaudithook(lambda event, _: print(event) if event == "subprocess.Popen" else None)
inputs = {"master.position": [0, 1], "master.velocity": 3}
print(simulate_many("Synchronizer", 0.01, inputs, "slave.position").values.tolist())
"""
    outputs = [subprocess.check_output([sys.executable, "-c", script], text=True).splitlines() for _ in range(2)]
    assert outputs[0][-1] == outputs[1][-1] == "[[[0.03], [1.03]]]"
    assert [len(lines) > 1 for lines in outputs] == [True, False]


# --- compilers ---


def test_without_zig_the_compiler_of_the_machine_does_it(
    compilations: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "find_spec", lambda name: None)
    if not any(map(shutil.which, library.COMPILERS)):
        pytest.skip("this machine has no C compiler of its own")
    monkeypatch.setattr(library.metadata, "version", None)  # of zig
    load_and_step(monkeypatch)
    load_and_step(monkeypatch)
    assert compilations == ["Synchronizer"]


def test_without_any_compiler_it_says_what_to_install(compilations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(UserError, match=r"^batches are compiled with ziglang, which is not installed: pip install "):
        load_and_step(monkeypatch)


def test_the_compilers_message_is_reported(compilations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "c_source", lambda block: {"block.c": b"int block_step(void) { return wrong; }"})
    with pytest.raises(UserError, match=r"^zig could not compile for (?s:.*)undeclared.*wrong"):
        load_and_step(monkeypatch)
