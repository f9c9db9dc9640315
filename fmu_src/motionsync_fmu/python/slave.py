"""The Python flavour: a block behind PythonFMU.

This module is part of the Python FMU. It must not import motionsync, which the FMU has under another name."""

import ctypes
import json
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partialmethod
from operator import attrgetter
from typing import Any, ClassVar, NoReturn

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from ..interface.variables import Cell, Variable, cells, explained, members, spoken_of, step_size_refusal, variables

State = dict[str, Any]
FAILURES: tuple[type[Exception], ...] = (ValueError, ArithmeticError, LookupError)


def keep(*things: Any) -> None:
    """Add a reference to each of these objects, since PythonFMU 0.7 releases references that it does not own.

    At each instantiation PythonFMU runs the script anew and releases the dictionary of the script's names. At each
    exception it releases the class, the instance and the instance's log. All these objects are still in use."""
    for thing in things:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))


class BlockSlave(Fmi2Slave):  # type: ignore[misc]
    """One instance of a block.

    Attributes:
        block_type: the block.
        build: the content hash of this FMU; the state of another FMU is refused.
        starts: start values that were baked into this FMU.
        turned: the causality of each variable that has another one than the block declares.
    """

    block_type: ClassVar[type]
    build: ClassVar[str]
    starts: ClassVar[dict[str, Any]]
    turned: ClassVar[Mapping[str, str]] = {}

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.logger: int | None = kwargs.get("logger")
        self.switch_logging_on()
        self.block = self.block_type()
        self.variables = variables(self.block, self.turned)
        self.by_name = {v.name: v for v in self.variables}
        for name, value in self.starts.items():
            self.by_name[name].cell.set(value)
        self.settable = [v for v in self.variables if v.settable]
        self.inputs = [v for v in self.variables if v.judged]
        self.restricted = [v for v in self.inputs if v.restricted]
        self.limits = [(v.declaration.min, v.declaration.max) for v in self.inputs]
        self.read_inputs = reader(v.name for v in self.inputs)
        self.codes = [v for v in self.variables if v.declaration.codes]
        self.cells = list(cells(self.block))
        self.read_cells = reader(c.name for c in self.cells)
        self.lists = [i for i, c in enumerate(self.cells) if c.type is list]
        self.readers: dict[tuple[object, ...], Callable[[Any], tuple[Any, ...]]] = {}  # by value references
        self.writers: dict[tuple[object, ...], list[Cell]] = {}
        self.initializing = False
        self.stepping = False

    def enter_initialization_mode(self) -> None:
        self.initializing = True

    def exit_initialization_mode(self) -> None:
        try:
            self.initialize()
        except FAILURES as e:
            self.refuse(str(e))
        self.initializing = False
        self.stepping = True

    def initialize(self) -> None:
        """Check every parameter and input, then let the block derive its initial state from them."""
        self.judge(self.settable)
        self.attempt(self.block.initialize)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Step from the current time by `step_size`, and log each fault code that has changed.

        The answer is False (fmi2Discard) if the step fails: an exception would make PythonFMU give up the instance."""
        codes = [v.cell.get() for v in self.codes]
        try:
            if refusal := step_size_refusal(step_size):
                raise ValueError(refusal)
            for value, (low, high) in zip(self.read_inputs(self.block), self.limits, strict=True):
                if not low <= value <= high:  # NaN fails every comparison
                    self.judge(self.inputs)
            self.judge(self.restricted)
            self.attempt(self.block.step, step_size)
        except FAILURES as e:
            self.say(str(e), Fmi2Status.error)
            return False
        for v, before in zip(self.codes, codes, strict=True):
            if (code := v.cell.get()) != before:
                for fault in members(v.declaration.codes):
                    if fault == code != 0:
                        self.say(self.explained(fault, v.name), Fmi2Status.warning)
        return True

    def judge(self, settable: list[Variable]) -> None:
        """Raise ValueError for the first variable whose value is not allowed."""
        for v in settable:
            if refusal := v.refusal(v.cell.get()):
                raise ValueError(refusal)

    def attempt(self, action: Callable[..., Any], *arguments: Any) -> None:
        """Call the block; if it refuses or fails, restore its former state and raise."""
        before = self.values()
        try:
            if refusal := action(*arguments):
                raise ValueError(self.explained(refusal))
        except FAILURES:
            self.restore(before)
            raise

    def explained(self, choice: Any, coded: str = "") -> str:
        """A refusal in words, or a fault whose code is in the variable `coded`."""
        names, group = spoken_of(choice, self.by_name, coded), coded.rpartition(".")[0]
        text = explained(choice, names, lambda name: self.by_name[name].cell.get())
        return f"{group}: {text}" if group else text

    def refuse(self, text: str) -> NoReturn:
        """Fail the call: PythonFMU turns the exception into fmi2Fatal."""
        keep(type(self), self, self.log_queue)
        self.say(text, Fmi2Status.error)
        raise ValueError(text.replace("%", "percent"))

    def say(self, text: str, status: Fmi2Status) -> None:
        """Log a text without percent signs: PythonFMU passes the text on as a C format."""
        self.switch_logging_on()
        self.log(text.replace("%", "percent"), status)

    def switch_logging_on(self) -> None:
        """Let PythonFMU pass messages on to the importer, who may have switched logging off.

        There are no messages but warnings and errors, which nobody should miss. PythonFMU 0.7 gives a slave the address
        of its logger, an object of C++: for Linux and for Windows the table of its functions comes first, then the
        switch. A list of categories stays in force."""
        if self.logger is not None:
            ctypes.c_bool.from_address(self.logger + ctypes.sizeof(ctypes.c_void_p)).value = True

    def _get(self, kinds: tuple[str, ...], references: list[int]) -> list[Any]:
        if self.initializing:  # outputs follow parameters and inputs; the end of this mode reports mistakes
            with suppress(*FAILURES):
                self.initialize()
        key = (kinds, *references)
        if key not in self.readers:
            self.readers[key] = reader(self.variable(r, kinds).name for r in references)
        return list(self.readers[key](self.block))

    def _set(self, kinds: tuple[str, ...], references: list[int], values: list[Any]) -> None:
        key = (kinds, self.stepping, *references)
        if key not in self.writers:
            chosen = [self.variable(r, kinds) for r in references]
            for v in chosen:
                if not v.settable or (self.stepping and v.variability == "fixed"):
                    self.refuse(f"{v.name} ({v.variability} {v.causality}) cannot be set now")
            self.writers[key] = [v.cell for v in chosen]
        for cell, value in zip(self.writers[key], values, strict=True):
            cell.set(value)

    def variable(self, reference: int, kinds: tuple[str, ...]) -> Variable:
        """The variable with this value reference; the call fails if there is none, or if it is of another type."""
        v = self.variables[reference] if reference < len(self.variables) else None
        if v is None or v.kind not in kinds:
            self.refuse(f"no {' or '.join(kinds)} has the value reference {reference}")
        return v

    get_real = partialmethod(_get, ("Real",))
    get_integer = partialmethod(_get, ("Integer", "Enumeration"))
    get_boolean = partialmethod(_get, ("Boolean",))
    set_real = partialmethod(_set, ("Real",))
    set_integer = partialmethod(_set, ("Integer", "Enumeration"))
    set_boolean = partialmethod(_set, ("Boolean",))

    def values(self) -> list[Any]:
        """A copy of the whole state of the block."""
        values = list(self.read_cells(self.block))
        for i in self.lists:
            values[i] = values[i].copy()
        return values

    def restore(self, values: list[Any]) -> None:
        for cell, value in zip(self.cells, values, strict=True):
            if cell.type is list:
                cell.get()[:] = value
            else:
                cell.set(value)

    def _get_fmu_state(self) -> State:
        """The state of the whole block, not only of its declared variables."""
        return {
            "build": self.build,
            "initializing": self.initializing,
            "stepping": self.stepping,
            "cells": self.values(),
        }

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> State:
        """The state in these bytes. If they hold none, it is empty, and `_set_fmu_state` refuses it with a log line."""
        try:
            read = json.loads(state)
        except ValueError:
            read = None
        return read if isinstance(read, dict) else {}

    def _set_fmu_state(self, state: State) -> None:
        if state.get("build") != self.build:
            self.refuse("this FMU state belongs to another FMU")
        self.initializing = state["initializing"]
        self.stepping = state["stepping"]
        self.restore(state["cells"])


def reader(names: Iterable[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that reads the attributes at these paths of an object; it returns a tuple even for one path."""
    paths = list(names)
    if len(paths) > 1:
        return attrgetter(*paths)
    return lambda thing: tuple(attrgetter(path)(thing) for path in paths)
