"""References that are none are refused, rather than agreed with."""

import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.evaluate.reference_comparison import read_reference
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.scenario import Scenario
from tests.support.scenario_texts import VALID

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
@settings(deadline=None)
def test_any_text_is_a_reference_or_refused(tmp_path_factory: pytest.TempPathFactory, table: str) -> None:
    folder = tmp_path_factory.getbasetemp()
    scenario = with_reference(folder, "")
    (folder / "Synchronizer_ref.csv").write_bytes(table.encode("utf-8", "surrogatepass"))
    with suppress(UserError):
        reference = read_reference(scenario)
        assert reference is None or np.isfinite(reference[1]).all()
