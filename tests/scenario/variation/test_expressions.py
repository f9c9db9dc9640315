"""Expressions: read by Python's parser, calculated by NumPy; here by Python's own arithmetic."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.variation.expressions import parse, sort_by_need

NAMES = ("length", "master.velocity", "master.segments.1.acceleration", "cuts.while", "_0")
numbers = st.floats(-1e6, 1e6, allow_subnormal=False)
leaves = st.sampled_from(NAMES) | st.floats(0.0, 1e6, allow_subnormal=False).map(repr)
expressions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda t: f"{t[0]}{t[1]}{t[2]}"),
        inner.map(lambda t: f"-({t})"),
        inner.map(lambda t: f"abs({t})"),
        inner.map(lambda t: f"sqrt(abs({t}))"),
        st.tuples(st.sampled_from(("min", "max")), st.lists(inner, min_size=2, max_size=3)).map(
            lambda t: f"{t[0]}({', '.join(t[1])})"
        ),
    ),
    max_leaves=8,
)


def in_python(text: str, values: dict[str, float]) -> float:
    """What Python itself makes of the expression; NaN where it divides by 0."""
    for i, name in enumerate(NAMES):
        text = text.replace(name, f"v[{i}]")
    expected: dict[str, Any] = {"v": [values[name] for name in NAMES], "sqrt": math.sqrt, "min": min, "max": max}
    try:
        return float(eval(text, expected))
    except ZeroDivisionError:
        return math.nan


@given(expressions, st.lists(st.tuples(*[numbers] * len(NAMES)), min_size=1, max_size=3))
def test_an_expression_has_the_bits_of_pythons_arithmetic(text: str, rows: list[tuple[float, ...]]) -> None:
    columns = dict(zip(NAMES, np.array(rows).T, strict=True))
    result = np.broadcast_to(parse(text).values(columns), len(rows))
    for value, row in zip(result.tolist(), rows, strict=True):
        expected = in_python(text, dict(zip(NAMES, row, strict=True)))
        if math.isfinite(expected):
            assert value.hex() == expected.hex()


def test_an_expression_shows_the_names_in_it() -> None:
    assert parse("2*gear_in_pos.velocity - min(a.b, 3e2, gear_in_pos.velocity)/max.x").names == (
        "gear_in_pos.velocity",
        "a.b",
        "max.x",
    )


def test_a_name_alone_has_its_values_as_they_are() -> None:
    assert parse("mode").values({"mode": np.array(["TRIM", "CONTINUE"])}).tolist() == ["TRIM", "CONTINUE"]
    assert parse("flag").values({"flag": np.array([True, False])}).tolist() == [True, False]


def test_a_division_by_zero_and_a_root_of_a_negative_number_are_no_numbers() -> None:
    given = {"a": np.array([0.0, -4.0])}
    assert parse("1/a").values(given).tolist() == [math.inf, -0.25]
    assert np.isnan(parse("sqrt(a)").values(given)).tolist() == [False, True]


@pytest.mark.parametrize(
    "text",
    [
        "2**3", "a b", "(a", "a if b else c", "a[0]", "[a]", "'x'", "a < b", "a and b", "not a", "~a", "a // b",
        "a % b", "lambda: 1", "a.b = 3", "a; b", "2 @ 3", "1j", "", "*a", "min(*a, b)", "max(a, b, key=c)", "a . b",
        "µ$", "0x10", "(kerf)(2)", "(min)(1, 2)", "(2)(3)",
    ],
)  # fmt: skip
def test_what_is_more_than_arithmetic_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="is no expression"):
        parse(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("exp(a)", "there is no function exp; there is min, max, abs, sqrt"),
        ("__import__('os')", "there is no function __import__"),
        ("a.sqrt(2)", "there is no function a.sqrt"),
        ("min(a)", "min needs two values or more, not 1"),
        ("sqrt(a, b)", "sqrt needs one value, not 2"),
        ("1e999", "is too great"),
        ("-" * 500 + "a", "nested too deeply"),
    ],
)
def test_a_wrong_call_or_number_is_reported(text: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        parse(text)


def test_a_text_that_the_parser_gives_up_on_is_refused() -> None:
    with pytest.raises(UserError, match="is no expression"):
        parse("(" * 5000 + "a" + ")" * 5000)


def test_a_text_or_flag_cannot_be_calculated_with() -> None:
    with pytest.raises(UserError, match="2\\*mode: TRIM is no number"):
        parse("2*mode").values({"mode": np.array(["TRIM"])})
    with pytest.raises(UserError, match="True is no number"):
        parse("flag + 1").values({"flag": np.array([True])})


def test_names_come_after_those_that_they_need() -> None:
    assert sort_by_need({"c": ["b", "a"], "b": ["a"], "d": ["c"]}) == ["a", "b", "c", "d"]


def test_a_circle_is_reported() -> None:
    with pytest.raises(UserError, match="a value cannot follow from itself: a from b from c from a"):
        sort_by_need({"a": ["b"], "b": ["c"], "c": ["a"]})
