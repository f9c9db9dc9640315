"""The references that are stored in the user's cache: what they depend on, and that nothing is lost without them."""

import gzip
import sys
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu import paths
from tests import ROOT, regenerate
from tests.oracle.numerics import mp
from tests.support.scenarios import stored_references
from tests.support.scenarios.stored_references import SOURCES, keep

SCRIPT = {"stop_time": 0.1, "start": {"rest": True}, "set": [{"at": 0.05, "stop": True}]}
EXAMPLE = ROOT / "scenarios" / "RemoteSync" / "start_up_pt1" / "scenario.toml"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(paths, "cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache" / "references"


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file that takes part in each answer."""
    file = tmp_path / "oracle.py"
    file.write_text("x = 1\n")
    monkeypatch.setattr(stored_references, "SOURCES", [*SOURCES, file])
    return file


def answers(*questions: object) -> list[Any]:
    """The answer to each question; an answer that is found, and not stored, is the next number."""
    number = count()
    return [keep(question, lambda: next(number)) for question in questions]


@pytest.mark.usefixtures("cache")
def test_an_equal_question_gets_the_stored_answer_and_any_other_one_its_own() -> None:
    question = ("flying_saw", SCRIPT, [0.0, 0.1])
    others = [
        ("follower", SCRIPT, [0.0, 0.1]),
        ("flying_saw", {**SCRIPT, "stop_time": 0.10000000000000002}, [0.0, 0.1]),
        ("flying_saw", {**SCRIPT, "set": [{"at": 0.05, "stop": False}]}, [0.0, 0.1]),
        ("flying_saw", SCRIPT, [0.0, 0.10000000000000002]),
    ]
    assert answers(question, question, *others, question) == [0, 0, 1, 2, 3, 4, 0]


@pytest.mark.usefixtures("cache")
def test_another_source_or_version_has_answers_of_its_own(source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    results = [keep(SCRIPT, lambda: "first")]
    other = source.with_name("changed.py")
    other.write_text("x = 2\n")
    monkeypatch.setattr(stored_references, "SOURCES", [*SOURCES, other])
    results.append(keep(SCRIPT, lambda: "changed"))
    monkeypatch.setattr(stored_references, "SOURCES", [*SOURCES, source])
    results.append(keep(SCRIPT, lambda: "again"))
    stored_references._source_hash.cache_clear()
    monkeypatch.setattr(stored_references.metadata, "version", lambda name: "0")
    results.append(keep(SCRIPT, lambda: "other packages"))
    stored_references._source_hash.cache_clear()
    assert results == ["first", "changed", "first", "other packages"]


@pytest.mark.all_blocks
def test_the_sources_are_all_that_an_oracle_imports() -> None:
    for block in regenerate.BLOCKS:
        regenerate.oracle(block)
    tests = {Path(m.__file__) for name, m in sys.modules.items() if name.startswith("tests.oracle.") and m.__file__}
    assert len(tests) > 30
    assert tests <= set(SOURCES)


def test_numbers_of_the_oracles_are_stored_as_floats(cache: Path) -> None:
    third = [{"a": mp.mpf(1) / 3, "b": -0.0, "c": True, "d": 1e-300}]
    stored = [keep(SCRIPT, lambda: third) for _ in range(2)]
    assert [repr(answer) for answer in stored] == ["[{'a': 0.3333333333333333, 'b': -0.0, 'c': True, 'd': 1e-300}]"] * 2
    assert len(list(cache.iterdir())) == 1


@pytest.mark.parametrize("damage", ["", "cut", "changed"])
def test_a_damaged_answer_is_found_again(damage: str, cache: Path) -> None:
    keep(SCRIPT, lambda: [123.0, 456.0])
    (file,) = cache.iterdir()
    whole = file.read_bytes()
    file.write_bytes({"": b"", "cut": whole[:-3], "changed": whole[:12] + bytes([whole[12] ^ 1]) + whole[13:]}[damage])
    assert keep(SCRIPT, lambda: [123.0, 456.0]) == [123.0, 456.0]
    assert gzip.decompress(file.read_bytes()) == gzip.decompress(whole)


@pytest.mark.usefixtures("no_cache")
def test_it_works_without_a_cache() -> None:
    assert answers(SCRIPT, SCRIPT) == [0, 1]


def test_answers_that_nobody_has_read_for_a_month_are_deleted(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep("old", lambda: 1)
    stored_references._delete_old.cache_clear()
    now = stored_references.time.time()
    monkeypatch.setattr(stored_references.time, "time", lambda: now + stored_references.MONTH + 10.0)
    keep("new", lambda: 2)
    assert [gzip.decompress(file.read_bytes()) for file in cache.iterdir()] == [b"2"]


def test_references_are_the_same_with_and_without_the_cache_and_make_references_does_not_use_it(cache: Path) -> None:
    _, anew = regenerate.with_reference(EXAMPLE)
    assert not cache.exists()
    for _ in range(2):
        _, text = regenerate.with_reference(EXAMPLE, keep)
        assert text == anew
    assert len(list(cache.iterdir())) == 1
