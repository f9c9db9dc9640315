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


def with_reference(folder: Path, table: str, tolerance: str = "1e-9") -> Scenario:
    """A scenario of the Synchronizer with such a reference next to it."""
    (folder / "scenario.toml").write_text(VALID)
    (folder / "Synchronizer_ref.csv").write_text(table)
    (folder / "Synchronizer_ref.opt").write_text(f"StartTime, 0.0\nStopTime, 2.0\nStepSize, 1.0\nRelTol, {tolerance}\n")
    return load_scenario(folder / "scenario.toml")


def test_a_reference_is_read(tmp_path: Path) -> None:
    reference = read_reference(with_reference(tmp_path, HEADER + ROWS))
    assert reference is not None
    names, table, tolerance = reference
    assert (names, table[2].tolist(), tolerance) == (["slave.position", "slave.velocity"], [1.0, 2.0, 3.5], 1e-9)


@pytest.mark.parametrize(
    ("table", "tolerance", "message"),
    [
        (HEADER + ROWS.replace("3.5", "inf"), "1e-9", "slave.velocity is inf in row 3"),
        (HEADER + ROWS.replace("4.0,4.0", "nan,4.0"), "1e-9", "slave.position is nan in row 4"),
        (HEADER + ROWS, "inf", "the relative tolerance is inf"),
        (HEADER + ROWS, "nan", "the relative tolerance is nan"),
        (HEADER + ROWS, "0", "the relative tolerance is 0.0"),
        (HEADER + "0.0,1.0,2.0\n2.0,4.0,4.0\n", "1e-9", "2 rows, fewer than 3"),
        (HEADER, "1e-9", "0 rows, fewer than 3"),
        ('"time"\n0.0\n1.0\n2.0\n', "1e-9", "no column but the time"),
        (
            HEADER + REVERSED,
            "1e-9",
            "the time falls from 2.0 to 1.0 s in row 2",
        ),
        ('"time","slave.position"\n' + ROWS, "1e-9", "rows of different lengths"),
    ],
)
def test_what_is_no_reference_is_refused(tmp_path: Path, table: str, tolerance: str, message: str) -> None:
    with pytest.raises(UserError, match=rf"Synchronizer_ref\.csv: not a reference: {message}$"):
        read_reference(with_reference(tmp_path, table, tolerance))


@pytest.mark.parametrize("end", ["csv", "opt"])
@pytest.mark.parametrize("kind", ["a link to nothing", "a folder", "a pipe"])
def test_a_reference_that_is_no_file_is_refused(tmp_path: Path, end: str, kind: str) -> None:
    """Else nothing would be compared, or a pipe be waited for."""
    scenario = with_reference(tmp_path, HEADER + ROWS)
    file = tmp_path / f"Synchronizer_ref.{end}"
    file.unlink()
    if kind == "a folder":
        file.mkdir()
    elif kind == "a pipe":
        os.mkfifo(file)
    else:
        file.symlink_to("nothing")
    with pytest.raises(UserError, match=rf"not a reference: Synchronizer_ref\.{end} is no file"):
        read_reference(scenario)


CELLS = st.sampled_from(["time", "slave.position", "0", "1e308", "-1", "x", '"', "", "RelTol", "\0", "5" * 140_000])
TABLES = st.lists(st.lists(CELLS, max_size=3).map(",".join), max_size=5).map("\n".join)


@given(TABLES | st.text(max_size=30), TABLES | st.sampled_from(["RelTol,1e-9", "RelTol,-1", "RelTol"]))
@settings(deadline=None)
def test_any_text_is_a_reference_or_refused(tmp_path_factory: pytest.TempPathFactory, table: str, options: str) -> None:
    folder = tmp_path_factory.getbasetemp()
    scenario = with_reference(folder, "")
    (folder / "Synchronizer_ref.csv").write_bytes(table.encode("utf-8", "surrogatepass"))
    (folder / "Synchronizer_ref.opt").write_bytes(options.encode("utf-8", "surrogatepass"))
    with suppress(UserError):
        reference = read_reference(scenario)
        assert reference is None or np.isfinite(reference[1]).all()
