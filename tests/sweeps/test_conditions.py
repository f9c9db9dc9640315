"""Conditions on the rows of a sweep: what they mean, and which texts are none."""

import math

import pyarrow as pa
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.sweeps.conditions import RowCondition

ROWS = pa.table(
    {
        "late": pa.array([0, 1, 2, None], pa.int64()),
        "passed": [True, False, True, True],
        "cut_error": [1e-9, 0.5, math.nan, -1.0],
        "refusal": ["", "no limit", "", ""],
        "slave.acceleration.above:500": [0.0, 0.25, 0.5, 0.0],
        "true_length_errors": [[0.1, 0.2], [], None, [0.3]],
    }
)


@pytest.mark.parametrize(
    ("text", "held"),
    [
        ("late == 0", [True, False, False, False]),  # what is missing is not equal
        ("late != 0", [False, True, True, False]),  # nor different
        ("late <= 1", [True, True, False, False]),
        ("late>=1", [False, True, True, False]),
        ("passed", [True, False, True, True]),
        ("not passed", [False, True, False, False]),
        ("passed == false", [False, True, False, False]),
        ("cut_error < 0.01", [True, False, False, True]),
        ("cut_error != 0.5", [True, False, False, True]),
        ("cut_error > -inf", [True, True, False, True]),
        ('refusal == ""', [True, False, True, True]),
        ('refusal == "no limit"', [False, True, False, False]),
        ('refusal != "this and that"', [True, True, True, True]),
        ("slave.acceleration.above:500 > 2.5e-1", [False, False, True, False]),
        ("passed and late < 2 and  cut_error < 1", [True, False, False, False]),
    ],
)
def test_a_condition_holds_for_these_rows(text: str, held: list[bool]) -> None:
    condition = RowCondition.read(text)
    condition.check(ROWS.schema)
    assert condition.holds(ROWS).to_pylist() == held


def test_its_columns_are_reported_once_each() -> None:
    assert RowCondition.read("a.max > 1 and b and a.max < 2").columns == ["a.max", "b"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "'' is no condition"),
        ("late = 0", "'late = 0' is neither COLUMN == VALUE"),
        ("late == ", "is neither COLUMN == VALUE"),
        ("late == 0 or passed", "is neither COLUMN == VALUE"),
        ("late == 0 and", "is neither COLUMN == VALUE"),
        ("late == none", "'none' is no number, true, false or text in quotes"),
        ("late == nan", "nothing is equal to nan"),
        ("not late == 0", "not is for the name of a column alone"),
    ],
)
def test_a_text_that_is_no_condition_is_reported(text: str, message: str) -> None:
    with pytest.raises(UserError) as e:
        RowCondition.read(text)
    assert message in str(e.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lat == 0", "no column of a row is named 'lat'; there is late"),
        ("late", "late == 1: compare late with a number"),
        ("late == true", "late == 1: compare late with a number"),
        ("passed == 1", "passed == 1: compare passed with true or false"),
        ("passed < true", "passed is true or false, which == and != compare"),
        ("refusal == 0", "refusal == 0: compare refusal with a text in quotes"),
        ("true_length_errors < 1", "true_length_errors has several numbers in a row: nothing is compared with them"),
        ('cut_error == "0"', 'cut_error == "0": compare cut_error with a number'),
    ],
)
def test_what_rows_cannot_be_asked_is_reported(text: str, message: str) -> None:
    with pytest.raises(UserError) as e:
        RowCondition.read(text).check(ROWS.schema)
    assert message in str(e.value)
