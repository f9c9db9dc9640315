"""One FMU instance, driven by variable names, on top of FMPy."""

import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import quote

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

from motionsync.blocks import BLOCKS

from ...errors import UserError
from ...interface.causality import IN_WORDS, Interface
from ...interface.recipe import Fmi, Recipe
from ...interface.variables import Variable

TYPES = {  # those of FMI's get and set functions, by those of the variables
    Fmi.TWO: {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"},
    Fmi.THREE: {"Float64": "Float64", "Int32": "Int32", "Enumeration": "Int64", "Boolean": "Boolean"},
}


def read_description(fmu: Path) -> Any:
    """FMPy's model description of an FMU, which nobody changes: it is checked against FMI's schema once for many runs.

    Raises:
        Exception: whatever FMPy meets in a file that is no FMU.
    """
    status = fmu.stat()
    return _read_description(str(fmu.absolute()), status.st_ino, status.st_size, status.st_mtime_ns)


@lru_cache(maxsize=32)
def _read_description(fmu: str, *_version: int) -> Any:
    return fmpy.read_model_description(fmu)


def read_recipe(fmu: Path) -> Recipe:
    """The recipe of a built FMU, with the start values of all its parameters and inputs, and its causality overrides.

    Raises:
        UserError: the file is not an FMU that can be read.
    """
    try:
        description = read_description(fmu)
    except Exception as error:  # FMPy raises whatever it meets in a file that is no FMU
        raise UserError(f"{fmu}: not an FMU that can be read: {str(error).strip().splitlines()[0]}") from None
    units = {t.name: t.unit for t in description.typeDefinitions}
    name = description.modelName
    declared = Recipe(name).variables if name in BLOCKS else {}
    starts = {v.name: _start(declared.get(v.name), v.start) for v in description.modelVariables if v.start is not None}
    interface, fmi = _interface(declared, description), fmi_version(description)
    return Recipe(name, units.get("Position") or "1", starts, units.get("SlavePosition") or "", interface, fmi)


def fmi_version(description: Any) -> Fmi:
    """The version of an FMU, from FMPy's description of it."""
    return Fmi.THREE if description.fmiVersion.startswith("3.") else Fmi.TWO


def _start(v: Variable | None, text: str) -> str:
    """A start value as people write it: that of an enumeration is a name."""
    return v.text(int(text)) if v and v.choices else text


def _interface(declared: Mapping[str, Variable], description: Any) -> Interface:
    """The variables whose causality is not the one that the block declares."""
    overrides: dict[str, list[str]] = {}
    for v in description.modelVariables:
        if v.name in declared and declared[v.name].causality != v.causality in IN_WORDS:
            overrides.setdefault(v.causality, []).append(v.name)
    return Interface(**overrides)


NEEDED = ("modelDescription.xml", "binaries/", "resources/")
"""What an importer takes out of an FMU: documentation and sources are for people and compilers."""


@dataclass(frozen=True)
class Group:
    """Variables of one type, with what FMI's functions for this type take.

    Attributes:
        getter, setter: the functions.
        names: of the variables.
        arguments: of both functions after the component; the last ones are `values`, and in FMI 3.0 their number.
        values: an array of C that both functions share, of shape (names,).
    """

    getter: Any
    setter: Any
    names: list[str]
    arguments: tuple[Any, ...]
    values: Any


class FmuError(Exception):
    """An FMI call failed. The text is what the FMU logged, or the name and status of the call."""


def unfit_characters(folder: Path) -> str:
    """The characters in a folder's path that keep an FMU of the python flavour from running there.

    An importer writes them as %XX in the URI that it hands to the FMU; PythonFMU 0.7 decodes none but the space."""
    characters = sorted(set(folder.relative_to(folder.anchor).as_posix()))
    return "".join(c for c in characters if c != " " and quote(c) != c)


class FmuInstance:
    """An instance of an FMU. As a context manager it frees the instance at the end and removes the extracted files.

    Raises:
        UserError: an FMU of the python flavour was extracted to a path with a character that PythonFMU does not read.

    Attributes:
        description: FMPy's model description.
        kinds: value reference and type of each variable, by name; the type is that of FMI's get and set functions.
        messages: what the FMU has logged.
        timed_messages: the same, each with its time: that of the end of the step in which the FMU logged it.
        time: the present communication point, in s.
    """

    def __init__(self, fmu: Path) -> None:
        self.description = read_description(fmu)
        self.fmi = fmi_version(self.description)
        types = TYPES[self.fmi]
        self.kinds = {v.name: (v.valueReference, types[v.type]) for v in self.description.modelVariables}
        self.messages: list[str] = []
        self.timed_messages: list[str] = []
        self.time = self._step_end = 0.0
        self._groups: dict[tuple[str, ...], list[Group]] = {}
        self.folder = fmpy.extract(str(fmu), include=lambda member: member.startswith(NEEDED))
        self._check_path(Path(self.folder))
        slave = fmi3.FMU3Slave if self.fmi == Fmi.THREE else fmi2.FMU2Slave
        self.unit = slave(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.description.modelName,
            unzipDirectory=self.folder,
        )
        if self.fmi == Fmi.THREE:
            self.unit.instantiate(loggingOn=True, logMessage=lambda host, *message: self._log(host, b"", *message))
            return
        self.callbacks = fmi2.fmi2CallbackFunctions()  # an attribute, since the unit holds a pointer to it
        self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        self.unit.instantiate(loggingOn=True, callbacks=self.callbacks)

    def _check_path(self, folder: Path) -> None:
        """Refuse a path in which PythonFMU would find no files: it ends the process then, without a message."""
        unfit = unfit_characters(folder)
        if unfit and (folder / "resources" / "slavemodule.txt").exists():
            shutil.rmtree(folder, ignore_errors=True)
            raise UserError(
                f"the python flavour does not run in {folder}: PythonFMU does not read {' '.join(unfit)} in a path; "
                "set TMPDIR (Windows: TEMP) to a folder without, or take the native flavour"
            )

    def _log(self, host: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        text = message.decode()
        self.messages.append(text)
        self.timed_messages.append(f"at {self._step_end:.10g} s: {text}")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        self.unit.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def initialize(self, values: Mapping[str, Any] | None = None) -> Self:
        """Lead the FMU from instantiation to step mode at time 0, with these start values and inputs."""
        if self.fmi == Fmi.TWO:
            self.call(self.unit.setupExperiment, startTime=0.0)
        self.call(self.unit.enterInitializationMode)
        self.set(values or {})
        self.call(self.unit.exitInitializationMode)
        return self

    def references(self, names: Iterable[str]) -> list[int]:
        """The value references of variables."""
        return [self.kinds[name][0] for name in names]

    def groups(self, names: tuple[str, ...]) -> list[Group]:
        """These variables by type, so that one call sets or gets all of a type; cached from step to step."""
        if names not in self._groups:
            by_kind: dict[str, list[str]] = {kind: [] for kind in TYPES[self.fmi].values()}
            for name in names:
                by_kind[self.kinds[name][1]].append(name)
            self._groups[names] = [self._group(kind, group) for kind, group in by_kind.items() if group]
        return self._groups[names]

    def _group(self, kind: str, names: list[str]) -> Group:
        module, prefix = (fmi3, "fmi3") if self.fmi == Fmi.THREE else (fmi2, "fmi2")
        getter, setter = (getattr(self.unit, f"{prefix}{verb}{kind}") for verb in ("Get", "Set"))
        count = len(names)
        references = (getattr(module, f"{prefix}ValueReference") * count)(*self.references(names))
        values = (getattr(module, f"{prefix}{kind}") * count)()
        sizes = (count,) if self.fmi == Fmi.THREE else ()
        return Group(getter, setter, names, (references, count, values, *sizes), values)

    def set(self, values: Mapping[str, Any]) -> None:
        for group in self.groups(tuple(values)):
            group.values[:] = [values[name] for name in group.names]
            self.call(group.setter, self.unit.component, *group.arguments)

    def step(self, h: float, values: Mapping[str, Any] | None = None) -> None:
        """Set the inputs that belong to the present time, then step on by h seconds."""
        self._step_end = self.time + h
        self.set(values or {})
        self.call(self.unit.doStep, self.time, h)
        self.time = self._step_end

    def terminate(self) -> None:
        """End the run: the FMU logs what has happened again and again."""
        self.call(self.unit.terminate)

    def get(self, names: Iterable[str] | None = None) -> dict[str, Any]:
        """The values of these variables, of all if none are named; Booleans and enumerations as numbers."""
        values: dict[str, Any] = {}
        for group in self.groups(tuple(self.kinds if names is None else names)):
            self.call(group.getter, self.unit.component, *group.arguments)
            values |= zip(group.names, group.values[:], strict=True)
        return values

    def values(self, names: tuple[str, ...]) -> tuple[Any, ...]:
        """The values of these variables, at least two, in this order; as `get` gives them."""
        values: tuple[Any, ...] = itemgetter(*names)(self.get(names))
        return values

    def call(self, function: Any, *arguments: Any, **options: Any) -> Any:
        """Call into the FMU.

        Raises:
            FmuError: the call failed; the text is what the FMU logged during the call.
        """
        before = len(self.messages)
        try:
            return function(*arguments, **options)
        except FMICallException as error:
            texts = self.messages[before:]
            own_texts = [t for t in texts if not t.startswith("Fatal py exception")]  # PythonFMU's, with no more in it
            raise FmuError("; ".join(own_texts or texts) or str(error)) from error
