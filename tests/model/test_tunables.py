"""Each tunable parameter of each block acts, and is refused, as its declaration says: the tests go over these.

The runs are those that the block's strategy draws, with one parameter fixed. One of them has to reach the parameter:
what is put out changes with its value. In that run the new value acts from the first step on, in which it is tuned, as
if the block had started with it. A parameter whose rising edge gives a command changes what is put out where it rises.
"""

from collections.abc import Iterator
from functools import cache
from math import inf, nan, nextafter
from typing import Any

import numpy as np
import pytest

from motionsync.blocks import BLOCKS
from motionsync.cutting.faults import PieceFault
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import Variable, shown
from tests.support.blocks.by_block import load_test_module
from tests.support.blocks.random_runs import draw_runs
from tests.support.blocks.runs import BlockRun
from tests.support.compiler.compiled import Compiled

STEPS, RUNS = 300, 60
RISING_AT = (20, 100, 200)  # steps in which a command is tried
REFUSED = "local.refused_parameter"
READ_BY_COMMAND = "calibration.measured_length"  # it is no setting: the command that reads it answers
TUNABLES = [(name, v.name) for name in BLOCKS for v in Recipe(name).variables.values() if v.variability == "tunable"]
each_tunable = pytest.mark.parametrize(("registered", "name"), TUNABLES)
each_refused_tunable = pytest.mark.parametrize(
    ("registered", "name"),
    [(b, name) for b, name in TUNABLES if REFUSED in Recipe(b).variables and name != READ_BY_COMMAND],
)


def variable(registered: str, name: str) -> Variable:
    return Recipe(registered).variables[name]


# --- a parameter acts -------------------------------------------------------------------------------------------------


@cache
def runs(registered: str) -> list[BlockRun]:
    """Random runs of a block, and those in which its facts reach the rest; each value that is set is allowed, and steps
    of no length are left out."""
    variables = Recipe(registered).variables
    reaching = getattr(load_test_module(registered, "interface_facts"), "REACHING_RUNS", [])
    return [
        BlockRun(
            run.start,
            [
                (h, {name: value for name, value in values.items() if variables[name].allows(value)})
                for h, values in run.steps
                if 0.0 < h <= 1e6
            ],
        )
        for run in (*reaching, *draw_runs(registered, STEPS, RUNS))
    ]


@cache
def places_of_outputs(registered: str) -> Any:
    """Where the bytes of what a block puts out are in its memory."""
    places = Compiled(Recipe(registered).block()).layout.places
    outputs = (places[v.name] for v in Recipe(registered).variables.values() if not v.settable)
    return np.array([at + byte for at, form in outputs for byte in range(form.size)])


def outputs(registered: str, run: BlockRun, name: str, value: Any, tuned: dict[int, Any]) -> list[bytes]:
    """What a block puts out after each step of a run in which that parameter has one value, but for what is tuned, by
    the step; none if its start values contradict one another. A refused step changes nothing."""
    block = Compiled(Recipe(registered).block())
    for other, start in (run.start | {name: value}).items():
        block.set(other, start)
    if block.initialize() != 0:
        return []
    rows, memory, places = [], block.memory.reshape(1).view(np.uint8), places_of_outputs(registered)
    for i, (h, values) in enumerate(run.steps):
        for other, x in values.items():
            if other != name:
                block.set(other, x)
        if i in tuned:
            block.set(name, tuned[i])
        block.step(h)
        rows.append(memory[places].tobytes())
    return rows


def other_values(registered: str, v: Variable, run: BlockRun, value: Any) -> list[Any]:
    """A few more allowed values of a parameter: of an enumeration all, of a number those that random runs set."""
    if v.kind == "Boolean":
        return [not value]
    if v.choices:
        return [choice for choice in v.choices if choice != value]
    own = (values[v.name] for values in (run.start, *(values for _, values in run.steps)) if v.name in values)
    of_others = (other.start[v.name] for other in runs(registered) if v.name in other.start)
    scaled = (0.5 * value, 2.0 * value) if v.kind == "Real" else ()
    return [x for x in dict.fromkeys((*scaled, *own, *of_others)) if x != value and v.allows(x)][:4]


def reaching_runs(registered: str, v: Variable) -> Iterator[tuple[BlockRun, Any, Any, list[bytes], list[bytes]]]:
    """The runs that reach a parameter: with its value, another one, and what is put out with each of the two."""
    for run in runs(registered):
        value = run.start.get(v.name, v.start)
        for other in other_values(registered, v, run, value):
            first, second = (outputs(registered, run, v.name, x, {}) for x in (value, other))
            if first and second and first != second:
                yield run, value, other, first, second


@each_tunable
def test_a_parameter_that_is_tuned_acts_as_if_the_block_had_started_with_it(registered: str, name: str) -> None:
    v = variable(registered, name)
    if v.declaration.description.startswith("rising edge"):
        still = ((run, outputs(registered, run, name, False, {})) for run in runs(registered))
        assert any(outputs(registered, run, name, False, {at: True}) != rows for run, rows in still for at in RISING_AT)
        return
    run, value, other, first, second = next(reaching_runs(registered, v))
    assert outputs(registered, run, name, value, {0: other}) == second != first


# --- a parameter is refused -------------------------------------------------------------------------------------------


def boundary(v: Variable) -> tuple[list[Any], list[Any]]:
    """The values of a parameter just inside its range, and those just outside."""
    if v.kind == "Boolean":
        return [False, True], []
    if v.choices:
        numbers = [int(choice) for choice in v.choices]
        return list(v.choices), [min(numbers) - 1, max(numbers) + 1]
    low, high = v.declaration.ends
    if v.kind == "Integer":
        return [int(x) for x in (low, high) if abs(x) < 2**31], [int(x) - 1 for x in (low,) if abs(x) < 2**31]
    least, zero = v.declaration.least_magnitude, v.declaration.zero
    inside, outside = [low, high, *([least] if least > 0.0 else [])], [nextafter(low, -inf), nextafter(high, inf), nan]
    if least > 0.0:
        inside, outside = (
            [x for x in inside if x != 0.0 or zero],
            [*outside, nextafter(least, 0.0), *([] if zero else [0.0])],
        )
    return inside, [x for x in outside if x != 0.0 or not zero]


@each_tunable
def test_a_start_value_is_refused_just_outside_the_range_and_the_reason_names_it(registered: str, name: str) -> None:
    v = variable(registered, name)
    inside, outside = boundary(v)
    assert [x for x in inside if v.refusal(x)] == []
    for x in outside:
        assert v.refusal(x) == f"{name} = {shown(x)} is not allowed: it must be {v.allowed_range}"


@each_refused_tunable
def test_a_tuned_value_just_outside_its_range_is_named_and_a_start_refused(registered: str, name: str) -> None:
    v = variable(registered, name)
    inside, outside = boundary(v)
    codes = variable(registered, REFUSED).declaration.codes
    assert codes is not None
    for x in (*inside, *outside):
        stepper = Stepper(Recipe(registered).block()).initialize().step(0.01).step(0.01, {name: x})
        named = [(code.description, code.names) for code in codes if code == stepper[REFUSED]]
        reason = (f"{name} must be {v.allowed_range}", (name,))
        assert (named == [reason]) == (x in outside), x
        is_refused = stepper[REFUSED] != 0
        assert (stepper.step(0.01, {"start": True})["error_id"] == PieceFault.TUNABLE) == is_refused, x
