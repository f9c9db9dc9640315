"""What `--set NAME=VALUES` means."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.variation.expressions import Expression
from motionsync_fmu.scenario.variation.values import Linear, Listed, Range, ValueKind, read_values, split_setting

REAL, INTEGER, BOOLEAN = ValueKind("Real"), ValueKind("Integer"), ValueKind("Boolean")
VELOCITY = ValueKind("Real", unit="mm/s")
MODE = ValueKind("Enumeration", ((0, "TRIM"), (1, "CONTINUE")))


@given(
    st.floats(-1e9, 1e9), st.floats(-1e9, 1e9), st.integers(2, 50),
)  # fmt: skip
def test_a_grid_is_equally_spaced_from_the_first_to_the_last_number(a: float, b: float, count: int) -> None:
    if a == b:
        return
    start, stop = min(a, b), max(a, b)
    values = read_values(f"{start!r}:{stop!r}:{count}", REAL)
    assert isinstance(values, Linear)
    result = values.at(np.arange(count))
    assert (result[0], result[-1]) == (start, stop)
    tolerance = (stop - start) * 1e-12 + 5e-324  # two neighbouring numbers, the least apart, have none between them
    assert np.allclose(result, np.linspace(start, stop, count), rtol=1e-12, atol=tolerance)


def test_a_grid_of_an_integer_has_whole_numbers() -> None:
    values = read_values("1:10:4", INTEGER)
    assert isinstance(values, Linear)
    result = values.at(np.arange(4))
    assert (result.dtype, result.tolist()) == (np.int64, [1, 4, 7, 10])


@pytest.mark.parametrize(
    ("text", "kind", "values"),
    [
        ("0:3", ValueKind(), [0.0, 1.0, 2.0, 3.0]),
        ("-1:1", INTEGER, [-1, 0, 1]),
        ("100:102", REAL, [100.0, 101.0, 102.0]),
    ],
)
def test_the_whole_numbers_from_the_first_to_the_last(text: str, kind: ValueKind, values: list[object]) -> None:
    result = read_values(text, kind)
    assert isinstance(result, Linear)
    assert result.count == len(values)
    at = result.at(np.arange(result.count)).tolist()
    assert at == values
    assert type(at[0]) is type(values[0])


@pytest.mark.parametrize(
    ("text", "kind", "values"),
    [
        ("100, 2e2,3", REAL, [100.0, 200.0, 3.0]),
        ("7", REAL, [7.0]),
        ("-7", INTEGER, [-7]),
        ("3,1,2", INTEGER, [3, 1, 2]),
        ("true,false", BOOLEAN, [True, False]),
        ("false", BOOLEAN, [False]),
        ("true", ValueKind(), [True]),
        ("TRIM,CONTINUE", MODE, ["TRIM", "CONTINUE"]),
        ("continue", MODE, ["CONTINUE"]),
        ("1,TRIM", MODE, ["CONTINUE", "TRIM"]),
        ("5,6.5", ValueKind(), [5.0, 6.5]),
    ],
)
def test_listed_values(text: str, kind: ValueKind, values: list[object]) -> None:
    result = read_values(text, kind)
    assert isinstance(result, Listed)
    assert result.values.tolist() == values
    assert result.at(np.array([0, 0, result.count - 1])).tolist() == [values[0], values[0], values[-1]]
    assert type(result.values.tolist()[0]) is type(values[0])


def test_a_range_is_what_is_sampled() -> None:
    assert read_values("200 .. 400", REAL) == Range(200.0, 400.0)
    assert read_values("-1..1e3", REAL) == Range(-1.0, 1000.0)
    assert Range(200.0, 400.0).at(np.array([0.0, 0.25, 0.999999999999])).tolist() == [200.0, 250.0, 399.9999999998]


def test_a_range_of_an_integer_has_each_whole_number_as_often() -> None:
    values = read_values("-1..2", INTEGER)
    assert isinstance(values, Range)
    result = values.at((np.arange(400) + 0.5) / 400)
    assert np.unique(result, return_counts=True)[0].tolist() == [-1, 0, 1, 2]
    assert np.unique(result, return_counts=True)[1].tolist() == [100, 100, 100, 100]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("30 m/min", Listed(np.array([500.0]))),
        ("12m/min, 250", Listed(np.array([200.0, 250.0]))),
        ("0.3 m/s..60 m/min", Range(300.0, 1000.0)),
        ("12 m/min:1 m/s:5", Linear(200.0, 1000.0, 5)),
    ],
)
def test_a_number_may_have_a_unit_of_its_own(text: str, expected: Listed | Range | Linear) -> None:
    result = read_values(text, VELOCITY)
    assert type(result) is type(expected)
    if isinstance(result, Listed) and isinstance(expected, Listed):
        assert result.values.tolist() == expected.values.tolist()
    else:
        assert result == expected


@pytest.mark.parametrize("text", ["axis.max_acceleration", "2*length", "max(a, b)", "max(min(a, (b)), c)", "-a", "a/2"])
def test_what_is_no_value_is_an_expression(text: str) -> None:
    result = read_values(text, REAL)
    assert isinstance(result, Expression)
    assert result.text == text


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("1,abc", REAL, "'abc' is no number"),
        ("1,,2", REAL, "'' is no number"),
        ("abc..5", REAL, "'abc' is no number"),
        ("1:x:3", REAL, "'x' is no number"),
        ("1:2:x", REAL, "'x' is no count"),
        ("1:2:2.5", REAL, "'2.5' is no count"),
        ("1:2:0", REAL, "a count of 0 is not allowed: it must be >= 2"),
        ("1:2:-3", REAL, "a count of -3 is not allowed"),
        ("1:2:9007199254740992", REAL, "a count of 9007199254740992 is not allowed"),
        ("1:2:1", REAL, "a count of 1 is not allowed: it must be >= 2; for one value write NAME=value"),
        ("2:1:5", REAL, "the range is reversed: write the lesser number first"),
        ("2:2:5", REAL, "the range is empty"),
        ("2..1", REAL, "the range is reversed"),
        ("2..2", REAL, "the range is empty"),
        ("-1e308..1e308", REAL, "the range is too great"),
        ("1:2.5", REAL, "first:last is for whole numbers; write start:stop:count for others"),
        ("0.5:2", INTEGER, "0.5 is no Integer"),
        ("3:3", REAL, "the range is empty"),
        ("0:9007199254740992", REAL, "first:last is for whole numbers"),
        ("0:1", MODE, "it must be 0 TRIM, 1 CONTINUE, one by one with commas"),
        ("1:2:3:4", REAL, "write NAME=start:stop:count"),
        ("1..2..3", REAL, "write NAME=start:stop:count"),
        ("nan", REAL, "nan is not allowed: it must be finite"),
        ("1,inf", REAL, "inf is not allowed: it must be finite"),
        ("1..inf", REAL, "inf is not allowed: it must be finite"),
        ("true", REAL, "'true' is no number"),
        ("1.5", INTEGER, "1.5 is no Integer"),
        ("1:10:3", INTEGER, "5.5 is no Integer"),
        ("0.5..2", INTEGER, "0.5 is no Integer"),
        ("1", BOOLEAN, "'1' is not allowed: it must be true or false"),
        ("0..1", BOOLEAN, "it must be true or false"),
        ("TRIM,CUT", MODE, "'CUT' is not allowed: it must be 0 TRIM, 1 CONTINUE"),
        ("CUT", MODE, "'CUT' is not allowed: it must be 0 TRIM, 1 CONTINUE"),
        ("0:1:2", MODE, "it must be 0 TRIM, 1 CONTINUE, one by one with commas"),
        ("30 m/min..500", VELOCITY, "one end has a unit and the other none"),
        ("30:40 m/min:3", VELOCITY, "one end has a unit and the other none"),
        ("30 m", VELOCITY, "'30 m' is in m: it must be in mm/s"),
        ("30 furlongs..40 furlongs", VELOCITY, "'furlongs' is no unit"),
        ("1,true", ValueKind(), "numbers and true or false cannot be mixed"),
    ],
)
def test_wrong_values_are_reported(text: str, kind: ValueKind, message: str) -> None:
    with pytest.raises(UserError) as e:
        read_values(text, kind)
    assert message in str(e.value)


@pytest.mark.parametrize("setting", ["length", "=5", "length=", " = "])
def test_a_setting_has_a_name_and_values(setting: str) -> None:
    with pytest.raises(UserError, match="write NAME=start:stop:count"):
        split_setting(setting)


def test_a_name_and_its_values_may_have_spaces_around() -> None:
    assert split_setting(" length = 1, 2 ") == ("length", "1, 2")
