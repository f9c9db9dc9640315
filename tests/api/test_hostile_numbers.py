"""Numbers of any form and size, wherever values are given: they are read, or refused by one message at once.

`1e99999999` is 28 MB as an integer and takes minutes as a decimal, 5000 digits are more than Python reads, 2^31 is no
Integer of FMI."""

import math
import tomllib
from copy import deepcopy
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync_fmu.api.error import error
from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.batch.reductions import parse_measures
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.block_folder import block_file
from motionsync_fmu.interface.build_time import build_time
from motionsync_fmu.interface.quantities import UNITS, convert
from motionsync_fmu.interface.recipe import Recipe, parse
from motionsync_fmu.interface.variables import Variable, variables
from motionsync_fmu.plan.reader import read_machines, read_numbers
from motionsync_fmu.scenario.files.example import FILE as EXAMPLE
from motionsync_fmu.scenario.files.new_scenario import figures, new_scenario
from motionsync_fmu.scenario.files.reader import read_scenario_text
from motionsync_fmu.scenario.variation.values import ValueKind, read_values
from motionsync_fmu.sweeps.conditions import RowCondition
from tests.support.blocks.drawn import drawn

PLACE = 8_191_524.25  # a number that no scenario has
FILE = Path("scenario.toml")
NO_DEADLINE = drawn(anew=True)  # the first example imports

DIGITS = st.integers(0, 10**20).map(str) | st.sampled_from(["", "00", "1" * 4000, "9" * 5000, "1" + "0" * 400, "٣"])
EXPONENTS = st.integers(-400, 400).map(str) | st.sampled_from(
    ["", "9999", "-9999", "99999999", "-99999999", "9" * 30, "-" + "9" * 30, "1" * 5000]
)
DECIMALS = st.builds(
    lambda sign, whole, point, part, e, exponent: f"{sign}{whole}{point}{part}{e}{exponent}",
    *(st.sampled_from(["", "-", "+", "--"]), DIGITS, st.sampled_from([".", "", ","]), DIGITS),
    *(st.sampled_from(["e", "E", "", "x"]), EXPONENTS),
)
WORDS = st.sampled_from(["nan", "-inf", "1e", "0x1F", "1_000", "0b1", "true", ".", "", "1/3", "1..2", "5:7", "5 6"])
NUMBERS = DECIMALS | WORDS | st.sampled_from([f"{2**n + d}" for n in (31, 32, 53, 63, 64, 1024) for d in (-1, 0, 1)])
NAMES = st.sampled_from(
    [*UNITS, "mm/s", "m/min", "m/s2", "m/s^3", "1/s", "kg", "m/", "mm" + "/mm" * 3000, "ft 6 in", "µm"]
)
QUANTITIES = st.builds(lambda number, space, unit: f"{number}{space}{unit}", NUMBERS, st.sampled_from(["", " "]), NAMES)
TEXTS = NUMBERS | QUANTITIES


def is_read_or_refused(read: Any, *arguments: Any, **others: Any) -> Any:
    """What is read; None: it is refused by a message."""
    try:
        return read(*arguments, **others)
    except UserError:
        return None


@NO_DEADLINE
@given(
    st.sampled_from([("m", 1000), ("cm", 10), ("in", Fraction(254, 10)), ("ft", Fraction(3048, 10))]),
    st.integers(-(10**18), 10**18),
    st.integers(-500, 500),
)  # fmt: skip
def test_a_quantity_is_the_real_next_to_it_or_refused_where_there_is_none(
    unit: tuple[str, Fraction | int], digits: int, exponent: int
) -> None:
    """A number that is 0 as a Real stays 0; else the product with the unit's size is rounded once."""
    name, millimetres = unit
    text = f"{digits}e{exponent} {name}"
    number = digits * Fraction(10) ** exponent
    try:
        as_real, expected = float(number), float(number * millimetres)
    except OverflowError:
        with pytest.raises(UserError, match="is not allowed: it must be finite"):
            convert(text, "mm")
        return
    assert convert(text, "mm") == (expected if as_real else 0.0)


@NO_DEADLINE
@given(TEXTS, st.sampled_from(["mm", "mm/s", "s", "deg", ""]))
def test_every_text_is_a_finite_number_or_refused(text: str, unit: str) -> None:
    value = is_read_or_refused(convert, text, unit)
    assert value is None or math.isfinite(value)


def declared(kind: str) -> list[Variable]:
    return [v for block in BLOCKS.values() for v in variables(block()) if v.settable and v.kind == kind]


SETTABLE = {kind: declared(kind) for kind in ("Real", "Integer", "Boolean", "Enumeration")}


@NO_DEADLINE
@given(st.sampled_from(list(SETTABLE)).flatmap(lambda kind: st.sampled_from(SETTABLE[kind])), TEXTS)
def test_a_start_value_is_one_that_its_variable_allows_or_refused(v: Variable, text: str) -> None:
    value = is_read_or_refused(parse, v, text, "mm")
    assert value is None or v.allows(value)


@NO_DEADLINE
@given(
    st.sampled_from(SETTABLE["Integer"]),
    st.floats(-1e9, 1e9).filter(lambda x: not x.is_integer()) | st.sampled_from(["x", "1.5"]),
)
def test_a_start_value_of_an_integer_must_be_a_whole_number(v: Variable, value: float | str) -> None:
    with pytest.raises(UserError, match=f"{v.name}.*must be a whole number without a point, -?[0-9]+ to [0-9]+"):
        parse(v, str(value), "mm")


@NO_DEADLINE
@given(
    st.sampled_from(SETTABLE["Integer"]),
    st.integers(2**31, 2**80) | st.integers(-(2**80), -(2**31) - 1) | st.just(5955911680),
)
def test_a_start_value_of_an_integer_has_32_bits(v: Variable, value: int) -> None:
    with pytest.raises(UserError, match=f"{v.name} = {value} is not allowed: it must be -?[0-9]+ to [0-9]+"):
        parse(v, str(value), "mm")


@NO_DEADLINE
@given(st.sampled_from(SETTABLE["Boolean"]), NUMBERS.filter(lambda text: text not in ("0", "1", "true")))
def test_a_start_value_of_a_boolean_must_be_true_or_false(v: Variable, text: str) -> None:
    with pytest.raises(UserError, match="it must be true or false"):
        parse(v, text, "mm")


@cache
def scenario(block: str) -> tuple[dict[str, Any], list[tuple[str | int, ...]]]:
    """The block's example, and the paths of all values in it."""
    top = tomllib.loads(block_file(BLOCKS[block], EXAMPLE).read_text("utf-8"))
    paths: list[tuple[str | int, ...]] = []

    def visit(value: Any, path: tuple[str | int, ...]) -> None:
        if isinstance(value, dict | list):
            for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
                visit(inner, (*path, key))
        else:
            paths.append(path)

    visit(top, ())
    return top, paths


def with_literal(block: str, path: tuple[str | int, ...], literal: str) -> str:
    """The text of the example with another value."""
    top = deepcopy(scenario(block)[0])
    table: Any = top
    for part in path[:-1]:
        table = table[part]
    table[path[-1]] = PLACE
    return tomli_w.dumps(top).replace(str(PLACE), literal)


@NO_DEADLINE
@given(st.data(), st.sampled_from(list(BLOCKS)), TEXTS, st.booleans())
def test_every_value_of_a_scenario_is_read_or_refused(data: st.DataObject, block: str, text: str, quoted: bool) -> None:
    path = data.draw(st.sampled_from(scenario(block)[1]))
    literal = f"'{text}'" if quoted else text
    is_read_or_refused(read_scenario_text, with_literal(block, path, literal), FILE)


@NO_DEADLINE
@given(st.data(), st.sampled_from(list(BLOCKS)), TEXTS)
def test_every_value_that_is_set_is_read_or_refused(data: st.DataObject, block: str, text: str) -> None:
    """As by `--set` and `run(set=...)`, which takes numbers, too."""
    top, paths = scenario(block)
    names = [".".join(map(str, path[1:] if path[0] == "start" else path)) for path in paths]
    name = data.draw(st.sampled_from([*names, *Recipe(block).variables]))
    is_read_or_refused(load, top, set={name: text})
    number = data.draw(st.floats() | st.integers(-(10**20), 10**20) | st.just(10**5000))
    is_read_or_refused(load, top, set={name: number})


@NO_DEADLINE
@given(st.data(), st.sampled_from(list(BLOCKS)), st.just(10**5000) | st.floats() | st.integers())
def test_every_number_of_a_scenario_from_python_is_read_or_refused(
    data: st.DataObject, block: str, number: float
) -> None:
    top = deepcopy(scenario(block)[0])
    table: Any = top
    path = data.draw(st.sampled_from(scenario(block)[1]))
    for part in path[:-1]:
        table = table[part]
    table[path[-1]] = number
    is_read_or_refused(load, top)


KINDS = [
    *(ValueKind("Real", unit=unit) for unit in ("mm", "mm/s", "", None)),
    *(ValueKind(name) for name in ("Integer", "Boolean", "")),
    ValueKind("Enumeration", ((0, "TRIM"), (1, "CONTINUE"))),
]


@NO_DEADLINE
@given(st.lists(TEXTS, min_size=1, max_size=3), st.sampled_from([":", "..", ","]), st.sampled_from(KINDS))
def test_the_values_of_a_sweep_are_read_or_refused(parts: list[str], separator: str, kind: ValueKind) -> None:
    is_read_or_refused(read_values, separator.join(parts), kind)


@NO_DEADLINE
@given(st.lists(TEXTS, min_size=1, max_size=2), st.sampled_from(["..", ","]), st.sampled_from(["mm", "mm/s"]))
def test_the_lengths_of_a_plan_are_read_or_refused(parts: list[str], separator: str, unit: str) -> None:
    numbers = is_read_or_refused(read_numbers, separator.join(parts), unit)
    assert numbers is None or all(0.0 < number <= 1e12 for number in numbers)


@NO_DEADLINE
@given(st.lists(st.just(10**400) | st.floats() | st.integers(), max_size=2))
def test_the_numbers_of_a_plan_are_read_or_refused(numbers: list[float]) -> None:
    is_read_or_refused(read_numbers, numbers, "mm")


@NO_DEADLINE
@given(
    st.sampled_from(["saw", "knife"]),
    st.sampled_from(["axis.max_velocity", "load.mass", "load.inertia", "batch_size", "knife.blades", "kerf"]),
    TEXTS,
)
def test_the_settings_of_a_plan_are_read_or_refused(kind: str, name: str, text: str) -> None:
    is_read_or_refused(read_machines, [], kind, {name: text}, "")


@NO_DEADLINE
@given(st.data(), st.sampled_from(["CutToLength", "RotaryKnife", "Gearing"]), TEXTS | st.just(10**5000))
def test_the_figures_of_a_new_scenario_are_read_or_refused(data: st.DataObject, block: str, value: str | int) -> None:
    name = data.draw(st.sampled_from([figure.name for figure in figures(block)]))
    is_read_or_refused(new_scenario, block, {name: value}, FILE)


@NO_DEADLINE
@given(TEXTS)
def test_numbers_elsewhere_are_read_or_refused(text: str) -> None:
    """In a condition on rows, a measure, a fault code."""
    is_read_or_refused(RowCondition.read, f"late < {text}")
    is_read_or_refused(parse_measures, Recipe("Gearing").variables, {"slave.position": f"above:{text}"}, "Gearing")
    is_read_or_refused(error, text)


@pytest.mark.parametrize("text", ["9" * 5000, "4354819199", "-1", "1e3"])
def test_a_build_time_that_is_none_is_refused(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", text)
    with pytest.raises(UserError, match="from 0 to 4354819198"):
        build_time()
