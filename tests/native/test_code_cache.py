"""The text of a block's code that is kept between processes: used as long as nothing that it depends on has changed."""

from pathlib import Path

import pytest

from motionsync.synchronizer.block import Synchronizer
from motionsync_fmu import archive
from motionsync_fmu.native import batch_loop
from tests.native.test_memory_layout import Sample


@pytest.fixture
def compilations(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """An empty cache, a compiler that is not one, and what has been compiled."""
    made: list[str] = []
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(batch_loop, "llvm_text", lambda block: made.append(type(block).__name__) or "text")
    return made


def test_a_block_is_compiled_once(compilations: list[str]) -> None:
    first = batch_loop._text(Synchronizer)
    assert batch_loop._text(Synchronizer) == first
    assert first.endswith("\ntext")
    assert compilations == ["Synchronizer"]


def test_another_source_is_compiled_anew(compilations: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    batch_loop._text(Synchronizer)
    files = archive.sources("motionsync.synchronizer.block")
    monkeypatch.setattr(batch_loop, "sources", lambda module: files | {"slave.py": b"changed"})
    batch_loop._text(Synchronizer)
    assert compilations == ["Synchronizer"] * 2


@pytest.mark.parametrize("damage", [b"", b"; another\ntext", b"\xff\xfe"])
def test_a_damaged_cache_is_made_anew(compilations: list[str], tmp_path: Path, damage: bytes) -> None:
    first = batch_loop._text(Synchronizer)
    (kept,) = (tmp_path / "motionsync").iterdir()
    kept.write_bytes(damage)
    assert batch_loop._text(Synchronizer) == first
    assert kept.read_text() == first


def test_it_works_without_a_cache(compilations: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    batch_loop._text(Synchronizer)
    batch_loop._text(Synchronizer)
    assert compilations == ["Synchronizer"] * 2


def test_other_blocks_than_our_own_are_not_kept(compilations: list[str], tmp_path: Path) -> None:
    batch_loop._text(Sample)
    assert not list(tmp_path.iterdir())
    assert compilations == ["Sample"]
