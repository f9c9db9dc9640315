"""The compiled loop of a batch: it initializes each instance; then, step by step, it sets and checks the inputs, steps
the instance and reads the outputs.

One loop serves all blocks and every choice of variables: tables of addresses, strides and offsets say what is set and
what is read. So a process compiles the loop once, and each block once.
"""

import os
import platform
from contextlib import suppress
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any, Generic, NamedTuple, TypeVar

import llvmlite
import llvmlite.binding as llvm
import numba
import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from motionsync import var

from .. import places
from ..archive import compilers, digest, sources
from .llvm_text import llvm_text

T = TypeVar("T")
Whole = NDArray[np.int64]
UNKEPT = (OSError, ValueError, RuntimeError)  # the cache is not found, cannot be read or written, or holds no text


class Cause(IntEnum):
    """Why an instance stopped."""

    NONE = 0
    STEP_SIZE = 1  # the step size is not allowed
    INPUT = 2  # a Real input is not allowed
    REFUSED = 3  # the block refused the call
    RAISED = 4  # an arithmetic error in the block
    START = 5  # a value is not allowed at initialization; the block is not called


STEP_SIZE, INPUT, REFUSED, RAISED = (int(c) for c in (Cause.STEP_SIZE, Cause.INPUT, Cause.REFUSED, Cause.RAISED))

# Columns of the tables in a plan.
ADDRESS, PER_INSTANCE, PER_STEP, OFFSET = range(4)  # of a source; step sizes and target have the first three
SIZE, INSTANCES, STEPS = range(1, 4)  # of the blocks, after ADDRESS
FROM, TO = range(2)  # of a sink
LEAST, GREATEST, SMALLEST, ZERO = range(4)  # of a limit
CAUSE, STEP, NUMBER = range(3)  # of a report


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
        reports: a row for each instance: the cause for which it stopped, at which step (-1: at initialization), which
            input or refusal it was. An instance that must not begin has its cause already before the
            loop.
    """

    blocks: Whole
    step_sizes: Whole
    longest: float
    sources: Groups[Whole]
    limits: NDArray[np.float64]
    sinks: Groups[Whole]
    target: Whole
    reports: Whole


@dataclass(frozen=True)
class Code:
    """The addresses of a block's compiled functions; LLVM's engine keeps the functions in memory."""

    engine: llvm.ExecutionEngine
    initialize: int
    step: int


_codes: dict[type[Any], Code] = {}
_compiling = Lock()


def code(block_type: type[Any]) -> Code:
    """The code of a block, from the same LLVM text as the native FMU. The first call for a block compiles it."""
    with _compiling:
        if block_type not in _codes:
            llvm.initialize_native_target()
            llvm.initialize_native_asmprinter()
            machine = llvm.Target.from_default_triple().create_target_machine(opt=3)
            module = llvm.parse_assembly(_text(block_type))
            module.triple, module.data_layout = machine.triple, str(machine.target_data)
            engine = llvm.create_mcjit_compiler(module, machine)
            initialize, step = (engine.get_function_address(f"model_{name}") for name in ("initialize", "step"))
            _codes[block_type] = Code(engine, initialize, step)
        return _codes[block_type]


def _text(block_type: type[Any]) -> str:
    """The block's LLVM text. Numba takes long to make it, so the text of the project's own blocks is kept in the user's
    cache: one file a block, whose first line says what the text was made from, and by which compiler."""
    module = block_type.__module__
    if module.partition(".")[0] != var.__package__:
        return llvm_text(block_type())
    made_by = f"{platform.python_version()} numba {numba.__version__} llvmlite {llvmlite.__version__}"
    mark = f"; {digest(sources(module) | compilers())} Python {made_by} {platform.machine()}\n"
    with suppress(*UNKEPT):
        if (text := _kept(block_type).read_text("utf-8")).startswith(mark):
            return text
    text = mark + llvm_text(block_type())
    with suppress(*UNKEPT):
        kept = _kept(block_type)
        kept.parent.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(f".{os.getpid()}.part")
        part.write_text(text, "utf-8", newline="\n")
        part.replace(kept)
    return text


def _kept(block_type: type[Any]) -> Path:
    """The block's file in the user's cache."""
    return places.cache() / f"{block_type.__name__}.ll"


def run(block: Code, plan: Plan) -> None:
    """Initialize and step all instances, without the interpreter's lock."""
    with _compiling:
        loop = _loop()
    loop(np.array([block.initialize, block.step]), *(getattr(plan, field.name) for field in fields(Plan)))


@cache
def _loop() -> Any:
    """The loop over all instances of a plan, compiled."""
    stepped = _stepped()
    vector, table, limits_table = types.int64[::1], types.int64[:, ::1], types.float64[:, ::1]
    tables = types.NamedUniTuple(table, 3, Groups)

    @njit(
        types.void(vector, vector, vector, types.float64, tables, limits_table, tables, vector, table),
        nogil=True,
        error_model="numpy",
    )
    def all_stepped(model, blocks, step_sizes, longest, sources, limits, sinks, target, reports):  # type: ignore[no-untyped-def]
        for i in range(blocks[INSTANCES]):
            if reports[i, CAUSE] == 0:
                block = blocks[ADDRESS] + i * blocks[SIZE]
                reports[i, CAUSE], reports[i, STEP], reports[i, NUMBER] = stepped(
                    model, block, i, blocks[STEPS], step_sizes, longest, sources, limits, sinks, target
                )

    return all_stepped


def _stepped() -> Any:
    """A function for compiled code that does all steps of one instance.

    It is one long function, since calls of smaller ones would add half the time that a step of a small block takes."""
    initialize, step = _model()
    get_real, set_real = _access(types.float64)
    get_word, set_word = _access(types.int64)
    get_flag, set_flag = _access(types.uint8)

    @njit(error_model="numpy")
    def stepped(model, block, i, steps, step_sizes, longest, sources, limits, sinks, target):  # type: ignore[no-untyped-def]
        """Why, where and at which input or refusal the instance stopped."""
        reals, words, flags = sources
        out_reals, out_words, out_flags = sinks
        refusal = initialize(model[0], block)
        if refusal != 0:
            return REFUSED if refusal > 0 else RAISED, -1, refusal
        for t in range(steps):
            h = get_real(step_sizes[ADDRESS] + i * step_sizes[PER_INSTANCE] + t * step_sizes[PER_STEP])
            if not 0.0 < h <= longest:
                return STEP_SIZE, t, 0
            for k in range(len(reals)):
                x = get_real(reals[k, ADDRESS] + i * reals[k, PER_INSTANCE] + t * reals[k, PER_STEP])
                set_real(block + reals[k, OFFSET], x)
                if not limits[k, LEAST] <= x <= limits[k, GREATEST]:  # NaN is not allowed either
                    return INPUT, t, k
                if abs(x) < limits[k, SMALLEST] and (x != 0.0 or limits[k, ZERO] == 0.0):
                    return INPUT, t, k
            for k in range(len(words)):
                word = get_word(words[k, ADDRESS] + i * words[k, PER_INSTANCE] + t * words[k, PER_STEP])
                set_word(block + words[k, OFFSET], word)
            for k in range(len(flags)):
                flag = get_flag(flags[k, ADDRESS] + i * flags[k, PER_INSTANCE] + t * flags[k, PER_STEP])
                set_flag(block + flags[k, OFFSET], flag)
            refusal = step(model[1], block, h)
            if refusal != 0:
                return REFUSED if refusal > 0 else RAISED, t, refusal
            row = target[ADDRESS] + i * target[PER_INSTANCE] + t * target[PER_STEP]
            for k in range(len(out_reals)):
                set_real(row + out_reals[k, TO], get_real(block + out_reals[k, FROM]))
            for k in range(len(out_words)):
                set_real(row + out_words[k, TO], float(get_word(block + out_words[k, FROM])))
            for k in range(len(out_flags)):
                set_real(row + out_flags[k, TO], float(get_flag(block + out_flags[k, FROM])))
        return 0, 0, 0

    return stepped


def _model() -> tuple[Any, Any]:
    """Functions for compiled code that call a block's functions: they return the refusal, or -1 after an exception.

    Numba's calling convention: the function writes its result and an exception to the first two addresses, and returns
    0 unless there was an exception."""
    word = ir.IntType(64)
    status, pointer, real = ir.IntType(32), word.as_pointer(), ir.DoubleType()

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        function, block, *rest = values
        kind = ir.FunctionType(status, [pointer] * 3 + [real] * len(rest))
        refusal, exception = cgutils.alloca_once(builder, word), cgutils.alloca_once(builder, word)
        places = [refusal, exception, builder.inttoptr(block, pointer)]
        failed = builder.call(builder.inttoptr(function, kind.as_pointer()), [*places, *rest])
        return builder.select(builder.icmp_unsigned("!=", failed, status(0)), word(-1), builder.load(refusal))

    initialize = intrinsic(lambda typing, function, block: (types.int64(types.int64, types.int64), call))
    step = intrinsic(lambda typing, function, block, h: (types.int64(types.int64, types.int64, types.float64), call))
    return initialize, step


def _access(kind: types.Type) -> tuple[Any, Any]:
    """Functions for compiled code that read and write a value of this type at an address."""

    def place(context: Any, builder: Any, address: Any) -> Any:
        return builder.inttoptr(address, context.get_data_type(kind).as_pointer())

    def read(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.load(place(context, builder, values[0]))

    def write(context: Any, builder: Any, signature: Any, values: Any) -> None:
        builder.store(values[1], place(context, builder, values[0]))

    get = intrinsic(lambda typing, address: (kind(types.int64), read))
    put = intrinsic(lambda typing, address, value: (types.void(types.int64, kind), write))
    return get, put
