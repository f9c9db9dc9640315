"""References that are none are refused, rather than agreed with."""

import os
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.evaluate.reference_comparison import ARCHIVE, read_reference
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.scenario import Scenario
from tests.support.blocks.drawn import drawn
from tests.support.scenarios.scenario_texts import VALID

HEADER = '"time","slave.position","slave.velocity"\n'
ROWS = "0.0,1.0,2.0\n1.0,2.0,3.0\n1.0,2.0,3.5\n2.0,4.0,4.0\n"
REVERSED = "2.0,4.0,4.0\n1.0,2.0,3.5\n1.0,2.0,3.0\n0.0,1.0,2.0\n"


def with_reference(folder: Path, table: str) -> Scenario:
    """A scenario of the Synchronizer with such a reference next to it."""
    (folder / "scenario.toml").write_text(VALID)
    (folder / "Synchronizer_ref.csv").write_text(table)
    return load_scenario(folder / "scenario.toml")


def test_a_reference_is_read(tmp_path: Path) -> None:
    reference = read_reference(with_reference(tmp_path, HEADER + ROWS))
    assert reference is not None
    names, table = reference
    assert (names, table[2].tolist()) == (["slave.position", "slave.velocity"], [1.0, 2.0, 3.5])


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (HEADER + ROWS.replace("3.5", "inf"), "slave.velocity is inf in row 3"),
        (HEADER + ROWS.replace("4.0,4.0", "nan,4.0"), "slave.position is nan in row 4"),
        (HEADER + "0.0,1.0,2.0\n2.0,4.0,4.0\n", "2 rows, fewer than 3"),
        (HEADER, "0 rows, fewer than 3"),
        ('"time"\n0.0\n1.0\n2.0\n', "no column but the time"),
        (
            HEADER + REVERSED,
            "the time falls from 2.0 to 1.0 s in row 2",
        ),
        ('"time","slave.position"\n' + ROWS, "rows of different lengths"),
    ],
)
def test_what_is_no_reference_is_refused(tmp_path: Path, table: str, message: str) -> None:
    with pytest.raises(UserError, match=rf"Synchronizer_ref\.csv: not a reference: {message}$"):
        read_reference(with_reference(tmp_path, table))


def with_archive(folder: Path, table: str) -> Scenario:
    """A scenario of the Synchronizer in the folder `own`, with such a reference in the archive beside it."""
    (folder / "own").mkdir()
    (folder / "own" / "scenario.toml").write_text(VALID)
    with zipfile.ZipFile(folder / ARCHIVE, "w") as z:
        z.writestr("own/Synchronizer_ref.csv", table)
        z.writestr("other/Synchronizer_ref.csv", HEADER)
    return load_scenario(folder / "own" / "scenario.toml")


def test_a_reference_next_to_the_file_counts_before_the_one_in_the_archive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the path is by which the scenario is found."""
    scenario = with_archive(tmp_path, HEADER + ROWS)
    monkeypatch.chdir(scenario.file.parent)
    for file in scenario.file, Path("scenario.toml"), Path("../own/../own/scenario.toml"):
        reference = read_reference(replace(scenario, file=file))
        assert reference is not None
        assert reference[1][:, 1].tolist() == [1.0, 2.0, 2.0, 4.0]
    with_reference(scenario.file.parent, HEADER + ROWS.replace("4.0,4.0", "5.0,4.0"))
    reference = read_reference(scenario)
    assert reference is not None
    assert reference[1][:, 1].tolist() == [1.0, 2.0, 2.0, 5.0]


def test_a_scenario_that_the_archive_does_not_have_has_no_reference(tmp_path: Path) -> None:
    scenario = with_archive(tmp_path, HEADER + ROWS)
    assert read_reference(replace(scenario, file=tmp_path / "another" / "scenario.toml")) is None
    assert read_reference(replace(scenario, file=tmp_path / "own" / "deeper" / "scenario.toml")) is None


def test_a_mistake_in_an_archive_names_it_and_the_member(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"references\.zip.own.Synchronizer_ref\.csv: not a reference: 0 rows, fewer"):
        read_reference(with_archive(tmp_path, HEADER))


@pytest.mark.parametrize(
    ("damaged", "message"),
    [
        (lambda whole: whole[:-3], r"references\.zip: File is not a zip file$"),
        (lambda whole: whole.replace(b",1.0,", b",1.1,", 1), r"_ref\.csv: not a reference: Bad CRC-32 for file"),
    ],
)
def test_a_damaged_archive_is_refused(tmp_path: Path, damaged: Callable[[bytes], bytes], message: str) -> None:
    """Else nothing would be compared, or something else."""
    scenario = with_archive(tmp_path, HEADER + ROWS)
    archive = tmp_path / ARCHIVE
    archive.write_bytes(damaged(archive.read_bytes()))
    with pytest.raises(UserError, match=message):
        read_reference(scenario)


@pytest.mark.parametrize("kind", ["a link to nothing", "a folder", "a pipe"])
def test_a_reference_that_is_no_file_is_refused(tmp_path: Path, kind: str) -> None:
    """Else nothing would be compared, or a pipe be waited for."""
    scenario = with_reference(tmp_path, HEADER + ROWS)
    file = tmp_path / "Synchronizer_ref.csv"
    file.unlink()
    if kind == "a folder":
        file.mkdir()
    elif kind == "a pipe":
        os.mkfifo(file)
    else:
        file.symlink_to("nothing")
    with pytest.raises(UserError, match=r"Synchronizer_ref\.csv: not a reference: it is no file"):
        read_reference(scenario)


CELLS = st.sampled_from(["time", "slave.position", "0", "1e308", "-1", "x", '"', "", "\0", "5" * 140_000])
TABLES = st.lists(st.lists(CELLS, max_size=3).map(",".join), max_size=5).map("\n".join)


@given(TABLES | st.text(max_size=30))
@drawn(anew=True)
def test_any_text_is_a_reference_or_refused(tmp_path_factory: pytest.TempPathFactory, table: str) -> None:
    folder = tmp_path_factory.getbasetemp()
    scenario = with_reference(folder, "")
    (folder / "Synchronizer_ref.csv").write_bytes(table.encode("utf-8", "surrogatepass"))
    with suppress(UserError):
        reference = read_reference(scenario)
        assert reference is None or np.isfinite(reference[1]).all()
