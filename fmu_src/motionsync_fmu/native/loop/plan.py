"""What the loop of a batch does with its instances: addresses, strides and offsets say what is set and what is read.

One loop (`loop.c`) serves every choice of variables. The structures here have the layout of those in C."""

from ctypes import CDLL, Structure, addressof, byref, c_double, c_int64, c_void_p
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from .reductions import Reductions, Table

T = TypeVar("T")
Whole = NDArray[np.int64]


class Cause(IntEnum):
    """Why an instance stopped; in C the numbers are named CAUSE_NONE and so on."""

    NONE = 0
    STEP_SIZE = 1  # the step size is not allowed
    INPUT = 2  # a Real input is not allowed
    REFUSED = 3  # the block refused the call
    RAISED = 4  # an arithmetic error in the block
    START = 5  # a value is not allowed at initialization; the block is not called


CAUSE = 0  # the column of a report that has the cause


class Groups(NamedTuple, Generic[T]):
    """One entry for each group of variables; the values in a group are copied in the same way."""

    reals: T
    words: T  # other values of 8 bytes
    flags: T  # Booleans


@dataclass(frozen=True)
class Plan:
    """What the loop does with its instances; strides and offsets are in bytes.

    Attributes:
        blocks: address of the first instance's memory, size of each, number of instances, number of steps.
        step_sizes: address, stride over instances, stride over steps.
        longest: the greatest allowed step size.
        sources: the values to set: Real inputs, which are checked at each step; all else of 8 bytes; Booleans. A row
            for each variable: address, stride over instances, stride over steps, offset in the block.
        limits: of each Real input in `sources` the least and greatest value, the least magnitude of a value other than
            0, and 1 where 0 is allowed, else 0.
        sinks: the values to read: Reals; Integers and enumerations; Booleans. A row for each variable: offset in the
            block, offset in the target.
        target: the array for the values that are read: address, stride over instances, stride over steps.
        reductions: what is reduced, if anything is.
        samples: room for the samples of the reductions.
        first: the number of the first instance there.
        reports: a row for each instance: the cause for which it stopped, at which step (-1: at initialization), which
            input or refusal it was. An instance that must not begin has its cause already before the loop.
    """

    blocks: Whole
    step_sizes: Whole
    longest: float
    sources: Groups[Whole]
    limits: NDArray[np.float64]
    sinks: Groups[Whole]
    target: Whole
    reductions: Reductions | None
    samples: NDArray[np.float64]
    first: int
    reports: Whole


class _Plan(Structure):
    _fields_ = (
        ("blocks", c_int64 * 4),
        ("step_sizes", c_int64 * 3),
        ("longest", c_double),
        ("sources", Table * 3),
        ("limits", c_void_p),
        ("sinks", Table * 3),
        ("target", c_int64 * 3),
        ("reductions", c_void_p),
        ("samples", c_void_p),
        ("first", c_int64),
        ("reports", c_void_p),
    )


def run(library: CDLL, plan: Plan) -> None:
    """Initialize and step all instances with a block's library, without the interpreter's lock."""
    library.batch_run(byref(_in_c(plan)))


def _in_c(plan: Plan) -> Any:
    """The plan as the loop reads it; its addresses are those of the plan's arrays."""
    return _Plan(
        blocks=tuple(plan.blocks.tolist()),
        step_sizes=tuple(plan.step_sizes.tolist()),
        longest=plan.longest,
        sources=_tables(plan.sources),
        limits=plan.limits.ctypes.data,
        sinks=_tables(plan.sinks),
        target=tuple(plan.target.tolist()),
        reductions=addressof(plan.reductions.in_c) if plan.reductions else None,
        samples=plan.samples.ctypes.data,
        first=plan.first,
        reports=plan.reports.ctypes.data,
    )


def _tables(groups: Groups[Whole]) -> tuple[tuple[int, int], ...]:
    return tuple((rows.ctypes.data, len(rows)) for rows in groups)
