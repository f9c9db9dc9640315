"""Many runs at once: independent instances of a block, stepped in this process by compiled code on all cores.

    result = simulate_many(
        "Synchronizer",
        1e-3,
        {"master.position": position, "master.velocity": 180.0, "stop": stop},  # position, stop: (steps,)
        ["slave.position", "state"],
        start={"master.period": 360.0, "output_phasing": np.linspace(30.0, 120.0, 10_000)},
    )
    result["slave.position"]  # (10000, steps)

Measures are figures over a whole run. They are updated while it runs, so that memory does not grow with the steps:

    reduce={"slave.velocity": ("max", "max_time"), "slave.acceleration": "above:500"}

An instance behaves as the block's FMU does, to the last bit, and fails where the FMU would; the other instances go on.
"""

from __future__ import annotations  # help() shows the types as they are written here

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from ctypes import addressof, byref
from dataclasses import dataclass
from itertools import islice
from math import inf, nextafter
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from motionsync.blocks import BLOCKS

from ..compiler.memory_layout import field, offset
from ..errors import UserError, choose
from ..interface.causality import Interface
from ..interface.recipe import declared_variables, variables_by_name
from ..interface.variables import (
    LONGEST_STEP,
    Variable,
    message_text,
    shown,
    step_size_refusal,
    variables_in_message,
)
from .batch_layout import CAUSE, BatchLayout, Cause
from .block_description import refusals_by_number, start_memory
from .library import library
from .reductions import Reduce, Reductions
from .result_arrays import new_array

Array = NDArray[Any]
Reals = NDArray[np.float64]
Integers = NDArray[np.int64]
Inputs = Mapping[Any, ArrayLike]  # keys: str or tuple[str, ...]; Mapping does not accept callers' narrower key types

TASK_STEPS = 1 << 18  # instance-steps of one task: about 10 ms
TASK_INSTANCES = 1 << 13  # their memory stays within a few megabytes
QUEUE = 4  # tasks that wait, for each thread
NUMBERS = "biuf"  # NumPy's kinds of the allowed types
LARGEST_INTEGER = 2**31 - 1  # of FMI
NO_RESULT = "an arithmetic error: these values lead to no result"


@dataclass(frozen=True)
class Failure:
    """Where and why an instance stopped; `step` is -1 if its initialization failed."""

    instance: int
    step: int
    message: str


@dataclass(frozen=True)
class BatchResult:
    """The outputs and measures of the instances.

    Attributes:
        names: the outputs.
        values: the outputs at the end of each step, of shape (instances, steps, names); Booleans, integers and
            enumerations as numbers. NaN, whatever the type, from the step on at which the instance failed.
        failures: one for each instance that failed, in the order of the instances.
        measures: by name, `slave.velocity.max` say, of shape (instances,), NaN for an instance that failed;
            `every:N` is of shape (instances, steps // N), NaN from the step on at which the instance failed.
    """

    names: tuple[str, ...]
    values: Reals
    failures: tuple[Failure, ...]
    measures: Mapping[str, Reals]

    def __repr__(self) -> str:
        instances, steps, _ = self.values.shape
        shown = [*self.names, *self.measures]
        return f"{instances} instances, {len(self.failures)} of them failed, {steps} steps: {', '.join(shown)}"

    def __getitem__(self, name: str) -> Reals:
        """One output, of shape (instances, steps): a view.

        Raises:
            UserError: the batch was run without this output.
        """
        index = choose({n: i for i, n in enumerate(self.names)}, name, "output of this batch")
        return self.values[:, :, index]


def simulate_many(
    block: str | type[Any],
    step_size: ArrayLike,
    inputs: Inputs,
    outputs: str | Sequence[str] = (),
    *,
    reduce: Reduce | None = None,
    start: Mapping[str, ArrayLike] | None = None,
    interface: Interface | None = None,
    steps: int | None = None,
    instances: int | None = None,
    threads: int | None = None,
    out: Reals | None = None,
    progress: Callable[[float], None] | None = None,
) -> BatchResult:
    """Step independent instances of a block over given inputs, with compiled code on all cores.

    Shapes: `step_size` and each value of `inputs` is broadcast to (instances, steps) by NumPy's rules: a scalar,
    (steps,) the same for all instances, (instances, 1) constant in time, or (instances, steps). A key of `inputs` may
    be a tuple of names; its array has one axis more, the last one, along these names. The numbers of instances and of
    steps are those of the arrays, or 1 where no array has that axis.

    Numbers: float64 for a Real, int64 for an Integer or enumeration and bool for a Boolean are read in place,
    with any strides; other numbers are converted in chunks while the batch runs. A Boolean may be 0 or 1 in an
    array of any type; an enumeration is given by its values, or by the names of its members.

    The function works in threads of its own, without the interpreter's lock; any number of threads may call it at the
    same time. The first call for a block compiles it, in a few seconds; its code is stored in the user's cache.

    Args:
        block: the name of a registered block, or a block's class.
        step_size: in s.
        inputs: inputs and tunable parameters by name. The values of a step are set before the step. Those of the first
            step are also set before the initialization, except for variables in `start`. So a command that is true in
            the first step has a rising edge there only if `start` sets it to false.
        outputs: the variables of the block, one name or several, whose values at the end of each step are returned.
        reduce: the requested measures: one kind or several for any variable of the block, as
            `{"slave.velocity": ("max", "max_time"), "state": "last"}`. The kinds are `last`, `min`, `max`, `min_time`,
            `max_time`, `mean`, `rms`, `rises`, `above:LIMIT` and `every:N`; `batch/reductions.py` explains them.
            They have the bits that reducing the values of all steps would have.
        start: start values by name, each a scalar or of shape (instances,), for parameters and inputs.
        interface: the variables with another causality than the block declares, as in the FMU.
        steps: the number of steps, where no array has that axis.
        instances: the number of instances, where no array has that axis.
        threads: the greatest number of threads; by default the number of cores.
        out: the array for the values: float64, of shape (instances, steps, outputs), with any strides. It may be in a
            file (`np.memmap`), for more values than fit into memory.
        progress: called with the share that is done, in the caller's thread.

    Returns:
        The outputs, and where and why instances failed. The checks are the FMU's, in the words of its log: all
        parameters and inputs at initialization, Real inputs and the step size at each step, and what the block refuses.

    Raises:
        UserError: before anything runs: an unknown block, variable or measure, a variable that cannot be set or have
            such a causality, a shape that does not fit, a value of the wrong kind (text that names no member; 0.5 for a
            Boolean), or an array that does not fit into memory; or there is no C compiler.
    """
    outputs = [outputs] if isinstance(outputs, str) else outputs
    batch = _Batch(block, step_size, inputs, start or {}, outputs, interface, steps, instances)
    reductions = Reductions(batch.type, reduce or {}, batch.instances, batch.steps)
    out = batch.target(out)
    failures = batch.run(out, reductions, count_workers(threads), progress or (lambda share: None))
    failures.sort(key=lambda f: f.instance)
    return BatchResult(tuple(outputs), out, tuple(failures), reductions.results(f.instance for f in failures))


@dataclass(frozen=True)
class _Column:
    """The values of one variable, of shape (instances or 1, steps or 1), and the shape that the caller's array had."""

    name: str
    values: Array
    original_shape: tuple[int, ...]

    def slice_instances(self, first: int, last: int, kind: Any) -> Array:
        """The values of some instances in the type of the block's memory: a view if they are of this type."""
        values = self.values[first:last] if len(self.values) > 1 else self.values
        return values if values.dtype == kind and values.flags.aligned else values.astype(kind)


_Columns = list[tuple[Variable, _Column]]


class _VaryingColumns(NamedTuple):
    """What is set at each step; the values in a group are copied in the same way."""

    reals: _Columns
    words: _Columns  # other values of 8 bytes
    flags: _Columns  # Booleans


class _Batch:
    """All that the instances have in common. The constructor reports the mistakes that concern all of them."""

    def __init__(
        self,
        block: str | type[Any],
        step_size: ArrayLike,
        inputs: Inputs,
        start: Mapping[str, ArrayLike],
        outputs: Sequence[str],
        interface: Interface | None,
        steps: int | None,
        instances: int | None,
    ) -> None:
        self.type = cast("type", choose(BLOCKS, block, "block") if isinstance(block, str) else block)
        self.image = start_memory(self.type)
        overrides = interface.causalities(self.type()) if interface else {}
        self.variables = variables_by_name(self.type(), overrides) if overrides else declared_variables(self.type)
        self.outputs = [choose(self.variables, name, f"variable of {self.type.__name__}") for name in outputs]
        self.step_sizes = _column("step_size", step_size)
        running = [
            self.check_column(c, "inputs") for c in _split({n: self.to_numbers(n, x) for n, x in inputs.items()})
        ]
        starts = [
            self.check_column(_column(name, self.to_numbers(name, values), per_step=False), "start")
            for name, values in start.items()
        ]
        self.instances = _length("instances", instances, 0, [self.step_sizes, *running, *starts])
        self.steps = _length("steps", steps, 1, [self.step_sizes, *running])
        self.starts = starts + [c for c in running if c.name not in start]
        self.varying = self.group_varying(c for c in running if c.values.shape[1] > 1 or c.name in start)
        self.checked_at_start = self.variables_to_check({c.name for c in self.starts})
        self.refusals = refusals_by_number(self.type)
        self.library = library(self.type)

    def to_numbers(self, name: Any, values: ArrayLike) -> ArrayLike:
        """The values; for an enumeration whose members are given by name, their numbers."""
        v = self.variables.get(name) if isinstance(name, str) else None
        if v is None or not v.choices or (texts := _array(v.name, values)).dtype.kind != "U":
            return values
        members = {member.name: member.value for member in v.choices}
        names, indices = np.unique(texts, return_inverse=True)
        numbers = [choose(members, str(text), f"member of {name}") for text in names]
        return np.array(numbers)[indices].reshape(texts.shape)

    def check_column(self, column: _Column, where: str) -> _Column:
        """The column, if its variable can be set there and all its numbers are of the variable's kind."""
        v = choose(self.variables, column.name, f"variable of {self.type.__name__}")
        if not v.settable or (where == "inputs" and v.variability == "fixed"):
            allowed = "inputs and tunable parameters" if where == "inputs" else "parameters and inputs"
            raise UserError(f"{where}: {v.name} ({v.variability} {v.causality}) cannot be set: {allowed} can")
        if v.kind != "Real" and (position := _find_unfit(v, column.values)):
            i, t = position
            allowed = "true or false, 1 or 0" if v.kind == "Boolean" else "a whole number of 32 bits"
            value = shown(column.values[i, t].item())
            raise UserError(f"{where}: {v.name} = {value} at [{i}, {t}] is no {v.kind}: it must be {allowed}")
        return column

    def group_varying(self, columns: Iterable[_Column]) -> _VaryingColumns:
        """The columns that are set at each step, in the order of the variables; all others are set once."""
        by_name = {c.name: c for c in columns}
        varying = [(v, by_name[v.name]) for v in self.variables.values() if v.name in by_name]
        return _VaryingColumns(
            reals=[(v, c) for v, c in varying if v.checked],
            words=[(v, c) for v, c in varying if not v.checked and v.kind != "Boolean"],
            flags=[(v, c) for v, c in varying if v.kind == "Boolean"],
        )

    def variables_to_check(self, names: set[str]) -> list[Variable]:
        """The variables to check at initialization: those named, and those with an invalid start value."""
        settable = [v for v in self.variables.values() if v.settable]
        return [v for v in settable if v.name in names or not v.allows(v.start)]

    def target(self, out: Reals | None) -> Reals:
        """The array for the values: `out` if the caller gave one that fits, else a new one."""
        shape = (self.instances, self.steps, len(self.outputs))
        if out is None:
            advice = "request measures (reduce=...), or give a file (out=np.memmap(...))"
            return new_array("the array of all values", shape, advice)
        if out.dtype != np.float64 or out.shape != shape or not out.flags.behaved:
            required = f"float64 of shape {shape}, and writeable"
            raise UserError(f"out is {out.dtype} of shape {out.shape}: it must be {required}")
        return out

    def tasks(self, workers: int) -> Iterator[tuple[int, int]]:
        """First and last instance (exclusive) of each task: small, for progress and memory; enough for all workers."""
        size = max(1, min(TASK_INSTANCES, TASK_STEPS // max(1, self.steps), -(-self.instances // workers)))
        for first in range(0, self.instances, size):
            yield first, min(first + size, self.instances)

    def run(self, out: Reals, reductions: Reductions, workers: int, progress: Callable[[float], None]) -> list[Failure]:
        """Run all instances, in tasks for that many threads; the failures are in the order in which tasks end.

        A few tasks wait at a time, since a long batch has a million of them."""
        failures: list[Failure] = []
        done = 0
        tasks, waiting = self.tasks(workers), dict[Future[list[Failure]], int]()
        with ThreadPoolExecutor(workers, "motionsync") as pool:
            try:
                while done < self.instances:
                    for first, last in islice(tasks, QUEUE * workers - len(waiting)):
                        waiting[pool.submit(self.run_instances, first, last, out, reductions)] = last - first
                    for task in wait(waiting, return_when=FIRST_COMPLETED).done:
                        failures += task.result()
                        done += waiting.pop(task)
                        progress(done / self.instances)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return failures

    def run_instances(self, first: int, last: int, out: Reals, reductions: Reductions) -> list[Failure]:
        """Run some instances from start to end."""
        task = _Task(self, first, last, out[first:last], reductions)
        self.library.batch_run(byref(task.plan()))
        return task.failures()

    def memory(self, first: int, last: int) -> Array:
        """The memory of some instances, with their start values and the inputs of the first step."""
        memory = np.full(last - first, self.image)
        for c in self.starts:
            values = field(memory, c.name)
            if c.values.shape[1]:  # without steps there is no first step
                values[...] = c.slice_instances(first, last, values.dtype)[:, 0]
        return memory


class _Task:
    """Some instances of a batch, with the arrays whose addresses its plan has.

    Attributes:
        target: the array for these instances' values.
        reductions: the measures of all instances.
    """

    def __init__(self, batch: _Batch, first: int, last: int, target: Reals, reductions: Reductions) -> None:
        self.batch = batch
        self.first = first
        self.target = target
        self.reductions = reductions
        self.samples = reductions.samples()
        self.memory = batch.memory(first, last)
        self.step_sizes = batch.step_sizes.slice_instances(first, last, np.float64)
        self.values = [self.values_of(group, last) for group in batch.varying]
        self.sources = [self.source_table(group) for group in self.values]
        self.limits = np.array([limits(v) for v, _ in batch.varying.reals])
        self.sinks = [self.sink_table("Real"), self.sink_table("Integer", "Enumeration"), self.sink_table("Boolean")]
        self.refused = find_refused(batch.checked_at_start, self.memory)
        self.reports = np.zeros((len(self.memory), 3), np.int64)
        self.reports[list(self.refused)] = Cause.START, -1, 0

    def values_of(self, group: _Columns, last: int) -> list[tuple[str, Array]]:
        """These instances' values of each variable of a group, in the type of the block's memory."""
        return [(v.name, c.slice_instances(self.first, last, field(self.memory, v.name).dtype)) for v, c in group]

    def plan(self) -> BatchLayout:
        memory, target, c_tables = self.memory, self.target, self.reductions.c_tables
        return BatchLayout(
            blocks=(memory.ctypes.data, memory.itemsize, len(memory), self.batch.steps),
            step_sizes=_source(self.step_sizes),
            longest=LONGEST_STEP,
            sources=tuple((rows.ctypes.data, len(rows)) for rows in self.sources),
            limits=self.limits.ctypes.data,
            sinks=tuple((rows.ctypes.data, len(rows)) for rows in self.sinks),
            target=(target.ctypes.data, *target.strides[:2]),
            reductions=addressof(c_tables) if self.reductions.measures else None,
            samples=self.samples.ctypes.data,
            first=self.first,
            reports=self.reports.ctypes.data,
        )

    def source_table(self, group: list[tuple[str, Array]]) -> Integers:
        return np.array([(*_source(values), offset(self.memory.dtype, name)) for name, values in group], np.int64)

    def sink_table(self, *kinds: str) -> Integers:
        outputs = [(i, v) for i, v in enumerate(self.batch.outputs) if v.kind in kinds]
        rows = [(offset(self.memory.dtype, v.name), i * self.target.strides[2]) for i, v in outputs]
        return np.array(rows, np.int64)

    def failures(self) -> list[Failure]:
        """The failures of the instances that stopped; sets their values to NaN from the failed step on."""
        failures = []
        for i in np.flatnonzero(self.reports[:, CAUSE]).tolist():
            cause, step, number = self.reports[i].tolist()
            self.target[i, max(step, 0) :] = np.nan
            failures.append(Failure(self.first + i, step, self.message(i, Cause(cause), step, number)))
        return failures

    def message(self, i: int, cause: Cause, step: int, number: int) -> str:
        """The message, in the words of the FMU's log; `number`: the number of the input or of the refusal."""

        def value(name: str) -> Any:
            return field(self.memory[i], name).item()

        match cause:
            case Cause.START:
                return self.refused[i]
            case Cause.STEP_SIZE:
                h = np.broadcast_to(self.step_sizes, (len(self.memory), self.batch.steps))[i, step].item()
                return step_size_refusal(h)
            case Cause.INPUT:
                v, _ = self.batch.varying.reals[number]
                return v.refusal(value(v.name))
            case Cause.REFUSED:
                refusal = self.batch.refusals[number]
                return message_text(refusal, variables_in_message(refusal, self.batch.variables), value)
            case _:
                return NO_RESULT


def are_allowed(v: Variable, values: Array) -> NDArray[np.bool_]:
    """`Variable.allows` for many values at once."""
    if v.choices:
        return np.isin(values, [member.value for member in v.choices])
    if v.kind == "Boolean":
        return np.ones(values.shape, np.bool_)
    d = v.declaration
    in_range = np.isfinite(values) & (d.min <= values) & (values <= d.max)
    in_range &= (d.above < values) & (values < d.below)
    return in_range & np.where(values == 0.0, d.zero, np.abs(values) >= d.smallest)


def find_refused(variables: Iterable[Variable], memory: Array) -> dict[int, str]:
    """The blocks in an array of memories that cannot be initialized, each with the message for its first invalid one
    of these variables."""
    refused: dict[int, str] = {}
    for v in variables:
        values = field(memory, v.name)
        for i in np.flatnonzero(~are_allowed(v, values)).tolist():
            refused.setdefault(i, v.refusal(values[i].item()))
    return refused


def count_workers(threads: int | None) -> int:
    """The number of threads: by default the number of cores.

    Raises:
        UserError: it is below 1.
    """
    if threads is not None and threads < 1:
        raise UserError(f"threads = {threads} is not allowed: it must be >= 1")
    return threads or os.cpu_count() or 1


def limits(v: Variable) -> tuple[float, float, float, float]:
    """The range of a Real, as the plan's `limits` have it."""
    d = v.declaration
    least, greatest = max(d.min, nextafter(d.above, inf)), min(d.max, nextafter(d.below, -inf))
    return least, greatest, d.smallest or (0.0 if d.zero else nextafter(0.0, 1.0)), float(d.zero)


def _source(values: Array) -> tuple[int, ...]:
    """Address, stride over instances, stride over steps; 0 along an axis where all values are the same."""
    return values.ctypes.data, *(s if n > 1 else 0 for s, n in zip(values.strides, values.shape, strict=True))


def _split(inputs: Inputs) -> list[_Column]:
    """One column for each variable, also for variables that share an array."""
    columns: list[_Column] = []
    for names, values in inputs.items():
        if isinstance(names, str):
            columns.append(_column(names, values))
            continue
        array = _numbers(", ".join(names), values)
        if array.ndim == 0 or array.shape[-1] != len(names):
            raise UserError(
                f"{', '.join(names)} have the shape {array.shape}: the last axis must be of length {len(names)}, one "
                "for each name"
            )
        columns += [_column(name, array[..., i]) for i, name in enumerate(names)]
    column_names = [c.name for c in columns]
    for name in column_names:
        if column_names.count(name) > 1:
            raise UserError(f"inputs: {name} is given {column_names.count(name)} times: it must be given once")
    return columns


def _column(name: str, values: ArrayLike, per_step: bool = True) -> _Column:
    array = _numbers(name, values)
    if array.ndim > (2 if per_step else 1):
        shapes = "(), (steps,), (instances, 1) or (instances, steps)" if per_step else "() or (instances,)"
        raise UserError(f"{name} has the shape {array.shape}: it must be {shapes}")
    original_shape = array.shape
    array = np.atleast_2d(array)
    return _Column(name, array if per_step else array.T, original_shape)


def _array(name: str, values: ArrayLike) -> Array:
    try:
        return np.asarray(values)
    except ValueError as error:
        raise UserError(f"{name} is no array: {error}") from None


def _numbers(name: str, values: ArrayLike) -> Array:
    array = _array(name, values)
    if array.dtype.kind not in NUMBERS:
        raise UserError(f"{name} is of the type {array.dtype}: it must be real numbers or Booleans")
    return array


def _length(what: str, requested: int | None, axis: int, columns: list[_Column]) -> int:
    """The number of instances or steps on which all columns agree."""
    if requested is not None and requested < 0:
        raise UserError(f"{what} = {requested} is not allowed: it must be >= 0")
    long = [c for c in columns if c.values.shape[axis] != 1]
    length = requested if requested is not None else long[0].values.shape[axis] if long else 1
    for c in long:
        if c.values.shape[axis] != length:
            other = (
                f"{what} = {requested}"
                if requested is not None
                else f"{long[0].name} has the shape {long[0].original_shape}"
            )
            raise UserError(f"{c.name} has the shape {c.original_shape}, but {other}: {what} must agree, or be 1")
    return length


def _find_unfit(v: Variable, values: Array) -> tuple[int, int] | None:
    """Instance and step of the first number that is no Boolean or no 32-bit integer; None if all numbers fit."""
    if values.dtype == np.bool_:
        return None
    least, greatest = (0, 1) if v.kind == "Boolean" else (-LARGEST_INTEGER - 1, LARGEST_INTEGER)
    rows = max(1, TASK_STEPS // max(1, values.shape[1]))
    for i in range(0, values.shape[0], rows):
        for t in range(0, values.shape[1], TASK_STEPS):
            x = values[i : i + rows, t : t + TASK_STEPS]
            unfit = np.argwhere(~((least <= x) & (x <= greatest) & (x == np.rint(x))))
            if len(unfit):
                return i + int(unfit[0, 0]), t + int(unfit[0, 1])
    return None
