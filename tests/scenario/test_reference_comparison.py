"""References that are none are refused, rather than agreed with."""

from pathlib import Path

import pytest

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
