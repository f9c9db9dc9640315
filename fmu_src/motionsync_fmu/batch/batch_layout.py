"""The plan of a batch's loop: the addresses, strides and offsets of what is set and read in its instances.

One loop (`loop.c`) serves every choice of variables. The structures here have the layout of those in C."""

from ctypes import Structure, c_double, c_int64, c_void_p
from enum import IntEnum

from .reductions import Table


class Cause(IntEnum):
    """Why an instance stopped; in C the numbers are named CAUSE_NONE and so on."""

    NONE = 0
    STEP_SIZE = 1  # the step size is not allowed
    INPUT = 2  # a Real input is not allowed
    REFUSED = 3  # the block refused the call
    RAISED = 4  # an arithmetic error in the block
    START = 5  # a value is not allowed at initialization; the block is not called


CAUSE = 0  # the column of a report that has the cause


class BatchLayout(Structure):
    """What the loop sets and reads in its instances; strides and offsets are in bytes. Its arrays have to outlive it.

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
        reductions: the tables of what is reduced, if anything is.
        samples: memory for the samples of the reductions.
        first: the number of the first instance there.
        reports: a row for each instance: the cause for which it stopped, at which step (-1: at initialization), which
            input or refusal it was. An instance that must not start has its cause already before the loop.
    """

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
