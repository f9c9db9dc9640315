"""The Python flavour: a block behind PythonFMU.

This module is part of the Python FMU. It must not import motionsync, which the FMU has under another name."""

import ctypes
import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from enum import StrEnum
from math import inf
from operator import attrgetter
from typing import Any, ClassVar, NoReturn

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from ..interface.variables import (
    QUIET_TIME,
    Cell,
    Variable,
    cells,
    computed,
    members,
    message_text,
    shown,
    step_size_refusal,
    variables,
    variables_in_message,
)

State = dict[str, Any]
Episode = list[Any]  # how often a code has come since it was logged first, from when to when, its first and worst value
COUNT, END, WORST = 0, 2, 4  # places in an episode
EPISODE_TYPES = [int, float, float, float, float]
CHECKSUM_LENGTH = 2 * hashlib.sha256().digest_size  # characters before the text of a serialized state
FINALIZED: set[int] = set()  # the base addresses of the libraries that finish in time


class SlaveMode(StrEnum):
    """The state of a unit (FMI 2.0, section 4.2.4), as messages name it."""

    INSTANTIATED = "is instantiated"
    INITIALIZING = "is in initialization mode"
    STEPPING = "is in step mode"
    TERMINATED = "has been terminated"


def add_references(*things: Any) -> None:
    """Add a reference to each of these objects, since PythonFMU 0.7 releases references that it does not own.

    At each instantiation PythonFMU runs the script anew and releases the dictionary of the script's names. At each
    exception it releases the class, the instance and the instance's log. All these objects are still in use."""
    for thing in things:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))


class AddressInfo(ctypes.Structure):
    """What the C library reports about an address: `Dl_info` of dlfcn.h."""

    _fields_ = (
        ("file", ctypes.c_char_p),
        ("base", ctypes.c_void_p),
        ("symbol", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
    )


def finalize_python_at_exit(logger: int) -> None:
    """Let PythonFMU's library be done with Python before anything else happens at the exit of the process.

    For Linux, PythonFMU 0.7 is done with it in a destructor of its library, and there reads what the library's static
    objects have freed just before: the host may abort after a good simulation. What is registered for the exit last is
    called first. So the library's own function is registered now; when its turn comes again, nothing is left to do.
    `logger` is the address of an object of the library, in which the table of its functions comes first."""
    if sys.platform != "linux":
        return
    process, info = ctypes.CDLL(None), AddressInfo()
    table = ctypes.c_void_p.from_address(logger)
    with suppress(OSError, AttributeError):  # an unknown C library: it is as it would be without this function
        if process.dladdr(table, ctypes.byref(info)) and info.base not in FINALIZED:
            library = ctypes.CDLL(os.fsdecode(info.file), os.RTLD_NOLOAD)  # stays loaded from now on
            process.__cxa_atexit(library.finalizePythonInterpreter, None, None)
            FINALIZED.add(info.base)


class BlockSlave(Fmi2Slave):  # type: ignore[misc]
    """One instance of a block.

    Attributes:
        block_type: the block.
        build: the content hash of this FMU; the state of another FMU is refused.
        starts: start values that were baked into this FMU.
        causality_overrides: the causality of each variable that has another one than the block declares.
    """

    block_type: ClassVar[type]
    build: ClassVar[str]
    starts: ClassVar[dict[str, Any]]
    causality_overrides: ClassVar[Mapping[str, str]] = {}

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.logger: int | None = kwargs.get("logger")
        if self.logger is not None:
            finalize_python_at_exit(self.logger)
        self.switch_logging_on()
        while sys.path.count(self.resources) > 1:  # PythonFMU has added it for each instance
            sys.path.remove(self.resources)
        self.block = self.block_type()
        self.variables = variables(self.block, self.causality_overrides)
        self.by_name = {v.name: v for v in self.variables}
        for name, value in self.starts.items():
            self.by_name[name].cell.set(value)
        self.settable = [v for v in self.variables if v.settable]
        self.inputs = [v for v in self.variables if v.checked]
        self.restricted = [v for v in self.inputs if v.restricted]
        self.limits = [(v.declaration.min, v.declaration.max) for v in self.inputs]
        self.read_inputs = attribute_reader(v.name for v in self.inputs)
        self.codes = [v for v in self.variables if v.declaration.codes]
        self.read_codes = attribute_reader(v.name for v in self.codes)
        self.computed = {v.name for v in self.variables if not v.settable}
        self.repeated = {  # the codes that come again and again: what is reported of each, by its variable and number
            f"{v.name} {code.value}": (v, code)
            for v in self.codes
            if v.declaration.report.name == "EPISODES"
            for code in members(v.declaration.codes)
        }
        self.episodes: dict[str, Episode] = {}
        self.cells = list(cells(self.block))
        self.read_cells = attribute_reader(c.name for c in self.cells)
        self.lists = [i for i, c in enumerate(self.cells) if c.type is list]
        self.readers: dict[tuple[object, ...], Callable[[Any], tuple[Any, ...]]] = {}  # by value references
        self.writers: dict[tuple[object, ...], list[Cell]] = {}
        self.mode = SlaveMode.INSTANTIATED

    def enter_initialization_mode(self) -> None:
        self.mode = SlaveMode.INITIALIZING

    def exit_initialization_mode(self) -> None:
        if refusal := self.try_initialize():
            self.refuse(refusal)
        self.mode = SlaveMode.STEPPING

    def terminate(self) -> None:
        self.end_episodes(inf)
        self.mode = SlaveMode.TERMINATED

    def try_initialize(self) -> str:
        """Check every parameter and input, then let the block derive its initial state from them.

        The answer is empty, or says why not; then the block is as it was before."""
        if refusal := self.refusal(self.settable):
            return refusal
        before = self.values()
        try:
            refusal = self.block.initialize()
            text = self.message(refusal) if refusal else ""
        except Exception as e:  # whatever it is: PythonFMU must not see it
            text = f"an arithmetic error ({e}): these values lead to no result"
        if text:
            self.restore(before)
        return text

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Step from the current time by `step_size`, and log each fault code that has changed.

        The answer is False (fmi2Discard) if the step is refused, which changes nothing: the block guarantees that, so
        no copy is made. After an arithmetic error, which no block should have, the unit is over."""
        if self.mode is not SlaveMode.STEPPING:
            self.refuse(f"fmi2DoStep is not allowed now: the unit {self.mode}")
        before = self.read_codes(self.block)
        if refusal := self.step_refusal(step_size) or self.try_step(step_size):
            self.log_message(refusal, Fmi2Status.error)
            return False
        codes = self.read_codes(self.block)
        if any(codes) or self.episodes:
            self.log_codes(before, codes, current_time + step_size)
        return True

    def try_step(self, step_size: float) -> str:
        """Let the block step. The answer is empty, or says why the block refuses."""
        try:
            refusal = self.block.step(step_size)
        except Exception as e:  # whatever it is: PythonFMU must not see it
            self.mode = SlaveMode.TERMINATED
            self.refuse(f"an arithmetic error ({e}): these values lead to no result, and the unit must be reset")
        return self.message(refusal) if refusal else ""

    def step_refusal(self, step_size: float) -> str:
        """Why a step of this size cannot be made with the present inputs; empty if it can."""
        if refusal := step_size_refusal(step_size):
            return refusal
        for value, (low, high) in zip(self.read_inputs(self.block), self.limits, strict=True):
            if not low <= value <= high:  # NaN fails every comparison
                return self.refusal(self.inputs)
        return self.refusal(self.restricted)

    def refusal(self, checked: list[Variable]) -> str:
        """Why the first of these variables whose value is not allowed has a bad one; empty if there is none."""
        return next((refusal for v in checked if (refusal := v.refusal(v.cell.get()))), "")

    def log_codes(self, before: tuple[Any, ...], codes: tuple[Any, ...], time: float) -> None:
        """Log the codes of the variables after a step that has ended at a time, in s: see `Report`."""
        for v, former, code in zip(self.codes, before, codes, strict=True):
            fault = next((m for m in members(v.declaration.codes) if m == code != 0), None)
            if fault is None:
                continue
            report = v.declaration.report.name
            if report == "EPISODES":
                self.extend_episode(v, fault, time, is_new=code != former)
            elif report == "STEPS" or code != former:
                self.log_message(self.message(fault, v.name), Fmi2Status.warning)
        self.end_episodes(time - QUIET_TIME)

    def extend_episode(self, v: Variable, fault: Any, time: float, *, is_new: bool) -> None:
        """Log a code that comes again and again where it comes first, and remember the worst value."""
        value = self.by_name[fault.names[0]].cell.get()
        key = f"{v.name} {fault.value}"
        if key not in self.episodes:
            self.log_message(self.message(fault, v.name), Fmi2Status.warning)
            self.episodes[key] = [0, time, time, value, value]
            is_new = True
        episode = self.episodes[key]
        episode[COUNT] += is_new
        episode[END] = time
        limit = self.by_name[fault.names[1]].cell.get() if len(fault.names) > 1 else 0.0
        if abs(value - limit) > abs(episode[WORST] - limit):
            episode[WORST] = value

    def end_episodes(self, since: float) -> None:
        """Log the episodes whose code has not come since a time, unless their first message has said all."""
        for key, (v, fault) in self.repeated.items():
            if key in self.episodes and self.episodes[key][END] <= since:
                count, begin, end, first, worst = self.episodes.pop(key)
                if count == 1 and worst == first:
                    continue
                group, (name, *others) = v.name.rpartition(".")[0], fault.names
                values = [f"{name} = {computed(worst)}", *(f"{n} = {self.value_text(n)}" for n in others)]
                times = f"times: {count}, from {computed(begin)} s to {computed(end)} s"
                text = f"{group}: {fault.description} ({times}, worst: {', '.join(values)})"
                self.log_message(text, Fmi2Status.warning)

    def value_text(self, name: str) -> str:
        """The value of a variable in a message; what was set has all its digits, so that one finds it again."""
        text = computed if name in self.computed else shown
        return text(self.by_name[name].cell.get())

    def message(self, choice: Any, coded: str = "") -> str:
        """A refusal in words, or a fault whose code is in the variable `coded`."""
        names, group = variables_in_message(choice, self.by_name, coded), coded.rpartition(".")[0]
        text = message_text(choice, names, self.value_text, str)
        return f"{group}: {text}" if group else text

    def refuse(self, text: str) -> NoReturn:
        """Fail the call: PythonFMU turns the exception into fmi2Fatal."""
        add_references(type(self), self, self.log_queue)
        self.log_message(text, Fmi2Status.error)
        raise ValueError(text.replace("%", "percent"))

    def log_message(self, text: str, status: Fmi2Status) -> None:
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
        if self.mode is SlaveMode.INITIALIZING:  # outputs follow parameters and inputs
            self.try_initialize()  # the end of this mode reports mistakes
        key = (kinds, *references)
        if key not in self.readers:
            self.readers[key] = attribute_reader(self.variable(r, kinds).name for r in references)
        return list(self.readers[key](self.block))

    def _set(self, kinds: tuple[str, ...], references: list[int], values: list[Any]) -> None:
        if self.mode is SlaveMode.TERMINATED:
            self.refuse(f"fmi2Set{kinds[0]} is not allowed now: the unit {self.mode}")
        key = (kinds, self.mode, *references)
        if key not in self.writers:
            selected = [self.variable(r, kinds) for r in references]
            for v in selected:
                if not v.settable or (self.mode is SlaveMode.STEPPING and v.variability == "fixed"):
                    self.refuse(f"{v.name} ({v.variability} {v.causality}) cannot be set now")
            self.writers[key] = [v.cell for v in selected]
        for cell, value in zip(self.writers[key], values, strict=True):
            cell.set(value)

    def variable(self, reference: int, kinds: tuple[str, ...]) -> Variable:
        """The variable with this value reference; the call fails if there is none, or if it is of another type."""
        v = self.variables[reference] if 0 <= reference < len(self.variables) else None
        if v is None or v.kind not in kinds:  # PythonFMU gives references of 32 bits, as if they had a sign
            self.refuse(f"no {' or '.join(kinds)} has the value reference {reference % 2**32}")
        return v

    def get_real(self, references: list[int]) -> list[Any]:
        return self._get(("Real",), references)

    def get_integer(self, references: list[int]) -> list[Any]:
        return self._get(("Integer", "Enumeration"), references)

    def get_boolean(self, references: list[int]) -> list[Any]:
        return self._get(("Boolean",), references)

    def set_real(self, references: list[int], values: list[Any]) -> None:
        self._set(("Real",), references, values)

    def set_integer(self, references: list[int], values: list[Any]) -> None:
        self._set(("Integer", "Enumeration"), references, values)

    def set_boolean(self, references: list[int], values: list[Any]) -> None:
        self._set(("Boolean",), references, values)

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
        episodes = {key: episode.copy() for key, episode in self.episodes.items()}
        return {"build": self.build, "mode": self.mode, "cells": self.values(), "episodes": episodes}

    @staticmethod
    def _fmu_state_to_bytes(state: State) -> bytes:
        """The state as JSON, behind its SHA-256."""
        text = json.dumps(state).encode()
        return checksum(text) + text

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> State:
        """The state in these bytes. If they hold none, it is empty, and `_set_fmu_state` refuses it with a log line."""
        if checksum(state[CHECKSUM_LENGTH:]) != state[:CHECKSUM_LENGTH]:
            return {}
        try:
            content = json.loads(state[CHECKSUM_LENGTH:])
        except (ValueError, RecursionError):
            content = None
        return content if isinstance(content, dict) else {}

    def _set_fmu_state(self, state: State) -> None:
        if "build" not in state:
            self.refuse("these bytes are no FMU state, or a damaged one")
        if state["build"] != self.build:
            self.refuse("this FMU state belongs to another FMU")
        if not self.is_possible_state(state):
            self.refuse("this FMU state does not fit this FMU")
        self.mode = SlaveMode(state["mode"])
        self.restore(state["cells"])
        self.episodes = {key: episode.copy() for key, episode in state["episodes"].items()}

    def is_possible_state(self, state: State) -> bool:
        """Whether a state has a mode, possible episodes, and for each cell a value that the cell may have held."""
        episodes = state.get("episodes")
        if not isinstance(episodes, dict) or not all(key in self.repeated for key in episodes):
            return False
        if not all(isinstance(e, list) and list(map(type, e)) == EPISODE_TYPES for e in episodes.values()):
            return False
        values = state.get("cells")
        if state.get("mode") not in list(SlaveMode) or not isinstance(values, list) or len(values) != len(self.cells):
            return False
        return all(map(is_possible_value, self.cells, values))


def checksum(text: bytes) -> bytes:
    """A hash by which damage to the text of a state is found."""
    return hashlib.sha256(text).hexdigest().encode()


def is_possible_value(cell: Cell, value: Any) -> bool:
    """Whether a value is one that this cell may have held."""
    if cell.type is list:
        return isinstance(value, list) and len(value) == len(cell.get()) and all(type(x) is float for x in value)
    if cell.type in (float, bool):
        return type(value) is cell.type
    bits = 32 if cell.declaration else 64  # a variable is FMI's Integer; inside, a block counts as in compiled code
    return isinstance(value, int) and not isinstance(value, bool) and -(2 ** (bits - 1)) <= value < 2 ** (bits - 1)


def attribute_reader(names: Iterable[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that reads the attributes at these paths of an object; it returns a tuple even for one path."""
    paths = list(names)
    if len(paths) > 1:
        return attrgetter(*paths)
    return lambda thing: tuple(attrgetter(path)(thing) for path in paths)
