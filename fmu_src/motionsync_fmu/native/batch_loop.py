"""The compiled loop that `batch` runs: each instance is initialized, then set, judged, stepped and read step by step.

One loop serves all blocks and every choice of variables: tables of addresses, strides and offsets tell what to set and
what to read. So a process compiles it once, and each block once.
"""

import os
import platform
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import Lock
from typing import Any

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

from ..archive import compilers, digest, sources
from .llvm_text import llvm_text

Whole = NDArray[np.int64]
STEP_SIZE, INPUT, REFUSED, RAISED, JUDGED = range(1, 6)  # why an instance stopped; 0: it did not
UNKEPT = (OSError, ValueError, RuntimeError)  # the cache cannot be read or written, holds no text, is not to be found


@dataclass(frozen=True)
class Plan:
    """What the loop does with its instances; strides and offsets are in bytes.

    Attributes:
        blocks: address of the first instance's memory, size of each, number of instances, number of steps.
        step_size: address, stride over instances, stride over steps.
        longest: the greatest allowed step size.
        sources: what to set: the Real inputs, which are judged; other words of 8 bytes; Booleans. A row for each:
            address, stride over instances, stride over steps, offset in the block.
        limits: least and greatest value of each Real input in `sources`.
        sinks: what to read: Reals; Integers and enumerations; Booleans. A row for each: offset in the block, offset in
            the target.
        target: where to put it: address, stride over instances, stride over steps.
        told: a row for each instance: why it stopped, at which step (-1: at initialization), which input or refusal it
            was. An instance that is not to begin has its reason already.
    """

    blocks: Whole
    step_size: Whole
    longest: float
    sources: tuple[Whole, Whole, Whole]
    limits: NDArray[np.float64]
    sinks: tuple[Whole, Whole, Whole]
    target: Whole
    told: Whole


@dataclass(frozen=True)
class Code:
    """A block's compiled functions, by their addresses; the engine keeps them in memory."""

    engine: llvm.ExecutionEngine
    initialize: int
    step: int


_codes: dict[type[Any], Code] = {}
_compiling = Lock()


def code(block_type: type[Any]) -> Code:
    """The code of a block, from the same LLVM text as the native FMU; compiled at the first call."""
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
    """The block's LLVM text: Numba needs long for it, so that of our own blocks is kept in the user's cache.

    One file a block; its first line tells what it was made from and by."""
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
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache, "motionsync", f"{block_type.__name__}.ll")


def run(block: Code, plan: Plan) -> None:
    """Initialize and step all instances, without the interpreter's lock."""
    with _compiling:
        loop = _loop()
    loop(np.array([block.initialize, block.step]), *(getattr(plan, name) for name in Plan.__dataclass_fields__))


@cache
def _loop() -> Any:
    initialize, step = _model()
    get_real, set_real = _access(types.float64)
    get_word, set_word = _access(types.int64)
    get_flag, set_flag = _access(types.uint8)

    @njit(error_model="numpy")
    def stepped(model, block, i, steps, step_size, longest, sources, limits, sinks, target):  # type: ignore[no-untyped-def]
        """One instance from start to end; why, where and at which input or refusal it stopped."""
        reals, words, flags = sources
        out_reals, out_words, out_flags = sinks
        refusal = initialize(model[0], block)
        if refusal != 0:
            return REFUSED if refusal > 0 else RAISED, -1, refusal
        for t in range(steps):
            h = get_real(step_size[0] + i * step_size[1] + t * step_size[2])
            if not 0.0 < h <= longest:
                return STEP_SIZE, t, 0
            for k in range(len(reals)):
                x = get_real(reals[k, 0] + i * reals[k, 1] + t * reals[k, 2])
                set_real(block + reals[k, 3], x)
                if not limits[k, 0] <= x <= limits[k, 1]:  # nor is NaN
                    return INPUT, t, k
            for k in range(len(words)):
                set_word(block + words[k, 3], get_word(words[k, 0] + i * words[k, 1] + t * words[k, 2]))
            for k in range(len(flags)):
                set_flag(block + flags[k, 3], get_flag(flags[k, 0] + i * flags[k, 1] + t * flags[k, 2]))
            refusal = step(model[1], block, h)
            if refusal != 0:
                return REFUSED if refusal > 0 else RAISED, t, refusal
            row = target[0] + i * target[1] + t * target[2]
            for k in range(len(out_reals)):
                set_real(row + out_reals[k, 1], get_real(block + out_reals[k, 0]))
            for k in range(len(out_words)):
                set_real(row + out_words[k, 1], float(get_word(block + out_words[k, 0])))
            for k in range(len(out_flags)):
                set_real(row + out_flags[k, 1], float(get_flag(block + out_flags[k, 0])))
        return 0, 0, 0

    vector, table, limits_table = types.int64[::1], types.int64[:, ::1], types.float64[:, ::1]
    tables = types.UniTuple(table, 3)

    @njit(
        types.void(vector, vector, vector, types.float64, tables, limits_table, tables, vector, table),
        nogil=True,
        error_model="numpy",
    )
    def all_stepped(model, blocks, step_size, longest, sources, limits, sinks, target, told):  # type: ignore[no-untyped-def]
        for i in range(blocks[2]):
            if told[i, 0] == 0:
                block = blocks[0] + i * blocks[1]
                told[i, 0], told[i, 1], told[i, 2] = stepped(
                    model, block, i, blocks[3], step_size, longest, sources, limits, sinks, target
                )

    return all_stepped


def _model() -> tuple[Any, Any]:
    """Calls of a block's functions for compiled code: the refusal, or -1 if there was an exception.

    Numba's convention: the result and the exception go to addresses, what is returned tells whether there was one."""
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
