"""How Numba sees a block: its tree of objects is one NumPy record, each of its classes a Numba type with methods."""

import inspect
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from types import FunctionType
from typing import Any, get_type_hints

import numpy as np
from numba import from_dtype, types
from numba.core import config
from numba.extending import models, overload, overload_method, register_model

from motionsync import var

from .numba_target import text_of

# The generated code is for any processor. Numba reads these settings when it generates its first code.
config.CPU_NAME, config.CPU_FEATURES = "generic", ""

# Indices and divisors are checked as in Python. The code neither counts references nor can the interpreter call it.
OPTIONS = {
    "error_model": "python",
    "boundscheck": True,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "_nrt": False,
}
SCALARS = {float: np.float64, bool: np.bool_}  # int and every enumeration: np.int64


def dtype(block: Any) -> np.dtype[Any]:
    """The memory of one object, nested parts included, laid out as in C: a derived class begins with its whole base."""
    return _laid_out(type(block), block)


def _laid_out(cls: type, block: Any) -> np.dtype[Any]:
    """The fields of a class, and of those that it derives from, in one of its objects."""
    base = next((base for base in cls.__bases__ if is_dataclass(base)), None)
    inherited = _laid_out(base, block) if base else None
    columns: dict[str, tuple[Any, int]] = {n: inherited.fields[n][:2] for n in inherited.names} if inherited else {}
    size, widest = (inherited.itemsize, inherited.alignment) if inherited else (0, 1)
    hints = get_type_hints(cls)
    for f in fields(cls):
        if f.name not in columns:
            column = _column(getattr(block, f.name), hints[f.name])
            place = -(-size // column.alignment) * column.alignment
            columns[f.name] = column, place
            size, widest = place + column.itemsize, max(widest, column.alignment)
    formats, offsets = zip(*columns.values(), strict=True) if columns else ((), ())
    size = -(-size // widest) * widest
    return np.dtype(
        {"names": list(columns), "formats": list(formats), "offsets": list(offsets), "itemsize": size}, align=True
    )


def _column(value: Any, hint: Any) -> np.dtype[Any]:
    if is_dataclass(value):
        return dtype(value)
    if isinstance(value, list):
        return np.dtype((np.float64, (len(value),)))
    return np.dtype(SCALARS.get(hint, np.int64))


def offset(layout: Any, name: str) -> int:
    """Where the variable of that name lies in a memory of that layout: the distance from its start in bytes."""
    total = 0
    for part in name.split("."):
        layout, here = layout.fields[part][:2]
        total += here
    return total


def image(block: Any) -> np.ndarray[Any, Any]:
    """The block's present values in the memory of its `dtype`; the bytes between the fields are 0."""
    memory = np.zeros((), dtype(block))
    _fill(memory, block)
    return memory


def _fill(memory: Any, block: Any) -> None:
    for f in fields(block):
        value = getattr(block, f.name)
        if is_dataclass(value):
            _fill(memory[f.name], value)
        else:
            memory[f.name] = value


def record(block: Any) -> types.Record:
    """The Numba type of one object: a record that knows its class, and so its methods."""
    plain = from_dtype(dtype(block))
    columns = []
    for f in fields(block):
        value = getattr(block, f.name)
        kind = record(value) if is_dataclass(value) else plain.typeof(f.name)
        columns.append((f.name, {"type": kind, "offset": plain.offset(f.name)}))
    cls: Any = type(block)
    return _kind(cls)(columns, plain.size, plain.aligned)


@cache
def _kind(cls: Any) -> Any:
    """The class of Numba types for the objects of one Python class.

    Each Python class has its own, so that Numba does not mix up two classes with equal fields or equal names of
    methods."""
    kind = type(
        cls.__name__, (types.Record,), {"__repr__": lambda self: cls.__name__}
    )  # this replaces Numba's text, which lists all fields
    register_model(kind)(models.RecordModel)
    for name, method in methods(cls).items():
        overload_method(kind, name, jit_options=OPTIONS)(_overload(method))
    return kind


def methods(cls: type) -> dict[str, FunctionType]:
    """The methods written in a class and in those that it inherits from."""
    found = {name: thing for base in reversed(cls.__mro__) for name, thing in vars(base).items()}
    return {name: m for name, m in found.items() if isinstance(m, FunctionType) and not name.startswith("__")}


def _overload(method: FunctionType) -> Callable[..., Any]:
    """The function that Numba calls with argument types to get a method's implementation.

    The function and the implementation must have the same signature."""
    implementation = _rebased(method)

    def pick(*arguments: Any) -> Callable[..., Any]:
        return implementation

    pick.__signature__ = inspect.signature(implementation)  # type: ignore[attr-defined]
    return pick


@overload(var.copy, jit_options=OPTIONS)
def _copy(into, source):  # type: ignore[no-untyped-def] # Numba compares this signature with the implementation's
    """`var.copy` of two records: their fields one by one."""
    if not isinstance(into, types.Record) or type(into) is not type(source):
        return None
    lines = []
    for name, kind in into.members:
        if isinstance(kind, types.Record):
            lines.append(f"copy(into.{name}, source.{name})")
        elif isinstance(kind, types.NestedArray):
            lines.append(f"for i in range({kind.shape[0]}): into.{name}[i] = source.{name}[i]")
        else:
            lines.append(f"into.{name} = source.{name}")
    space: dict[str, Any] = {"copy": var.copy}
    exec("\n    ".join(["def implementation(into, source):", *lines]), space)
    return space["implementation"]


def entry(cls: type, name: str) -> Any:
    """A method as a function that can be compiled without the interpreter."""
    return text_of(**OPTIONS)(_rebased(methods(cls)[name]))


def _rebased(function: FunctionType) -> FunctionType:
    """The function with a copy of its module's names, in which the package's own functions are compiled ones."""
    return FunctionType(function.__code__, _namespace(function), function.__name__, function.__defaults__)


_namespaces: dict[str, dict[str, Any]] = {}


def _namespace(function: FunctionType) -> dict[str, Any]:
    module = function.__module__
    if module not in _namespaces:
        space = _namespaces[module] = dict(function.__globals__)
        package = module.partition(".")[0]
        for name, value in list(space.items()):
            if isinstance(value, FunctionType) and value.__module__.partition(".")[0] == package:
                space[name] = _compiled(value)
    return _namespaces[module]


def _compiled(function: FunctionType) -> Any:
    """The compiled function: the same object for all modules that use it, so that it is compiled once."""
    _namespace(function)  # making it compiles all functions of its module, this one too: that must be over before
    return _compiled_once(function)


@cache
def _compiled_once(function: FunctionType) -> Any:
    return text_of(**OPTIONS)(_rebased(function))
