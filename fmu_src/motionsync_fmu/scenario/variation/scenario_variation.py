"""A scenario with other values than its file has, checked by the scenario's own reader.

A name is that of a variable of the block, or the path of a number in the scenario's file, with dots:
`master.velocity`, `master.segments.1.acceleration`, `cuts.length`, `stop_time`, `set.0.at`, `on.0.after`,
`expect.2.tolerance`. Tables of one name, and the entries of lists, are counted from 0. `length` is the block's variable
of this name, or else that of the table [cuts].

A variable of the block has its value where the scenario gives it one: in [start], in a [[set]], or in a reaction
[[on]]; without any of them it gets a start value. If several of them give it the same value, all of them change. If
its values differ, the name alone would overwrite what the scenario does, and is refused; the path of one of them
(`set.2.gear_in_pos.velocity`) is meant instead.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass
from functools import cached_property, wraps
from pathlib import Path
from typing import Any, Self, TypeVar, cast

from ...errors import UserError, choose
from ...interface.units import unit_name
from ...interface.variables import Variable
from ..files.quantities import KeyPath, measured_kind
from ..files.reader import BlockReader, read_scenario, read_tables
from ..files.toml_tables import TomlTable, read_file
from ..files.variable_tables import Subject
from ..scenario import Scenario
from .values import ValueKind

T = TypeVar("T")
NAMED = ("start", "set", "on", "expect")  # tables whose keys are names of variables


@dataclass(frozen=True)
class Target:
    """What a name means in a scenario.

    Attributes:
        name: the name in full: `cuts.length` where `length` is meant.
        paths: where its value is written, or will be.
        variable: the block's variable; None: a key of the script.
        present: the value in the scenario; None: it has none.
        unit: the name of the value's unit; None: it is no number that may have one.
    """

    name: str
    paths: tuple[KeyPath, ...]
    variable: Variable | None
    present: float | bool | str | None
    unit: str | None = None

    @property
    def kind(self) -> ValueKind:
        """What its values are."""
        v = self.variable
        if not v:
            return ValueKind(unit=self.unit)
        return ValueKind(v.kind, tuple((m.value, m.name) for m in v.choices), self.unit)

    def convert(self, value: Any) -> Any:
        """The value as the scenario's file would have it: a whole number without a point where one belongs."""
        whole = self.variable.kind in ("Integer", "Enumeration") if self.variable else type(self.present) is int
        return int(value) if whole and isinstance(value, float) and value.is_integer() else value


class ScenarioVariation:
    """A scenario file that is parsed once, and scenarios with other values.

    Attributes:
        text: what the file has in it.
        file: the file.
        scenario: the scenario as its file has it.
    """

    def __init__(self, text: str, file: Path) -> None:
        """`text`: what the file has in it.

        Raises:
            UserError: the first mistake in it, with file, line and key.
        """
        self.text, self.file = text, file
        self._top = read_tables(text, file)
        self._reader: _CachingReader | None = None
        self.scenario = self.with_values(())

    @classmethod
    def of_file(cls, file: Path) -> Self:
        """The scenario of a file.

        Raises:
            UserError: the file cannot be read, or the first mistake in it, with file, line and key.
        """
        return cls(read_file(file), file)

    def target(self, name: str) -> Target:
        """What a name means.

        Raises:
            UserError: the scenario has nothing of that name that can vary, or the name is ambiguous.
        """
        if name == "length" and name not in self._paths_by_name:
            name = "cuts.length"
        path = choose(self._paths_by_name, name, f"variable of {self._block.name} or number of the scenario")
        if not path:
            return self._target_of(self._block.variables[name])
        return Target(name, (path,), self._variable_at(path), _value_at(self._top.values, path), self._unit_at(path))

    def with_values(self, values: Iterable[tuple[Target, Any]]) -> Scenario:
        """The scenario with other values.

        Raises:
            UserError: the reader refuses it; the message has file, line and key.
        """
        changes = [(path, target.convert(value)) for target, value in values for path in target.paths]
        tables = _TrackedTable(_with_changes(self._top.values, changes))
        return read_scenario(self._top.with_values(tables), self._reader_of)

    def _reader_of(self, top: TomlTable, name: str, stop_time: float) -> BlockReader:
        """The same reader for every scenario: block and interface, which are texts, never vary."""
        if self._reader is None:
            self._reader = _CachingReader(top, name, stop_time)
        return self._reader.of(top, stop_time)

    @property
    def _block(self) -> Subject:
        assert self._reader
        return self._reader.block

    def _target_of(self, v: Variable) -> Target:
        """The meaning of a variable's name: all values that the scenario gives it."""
        top = self._top.values
        tables: list[KeyPath] = [("start",)]
        tables += [("set", i) for i in range(len(top.get("set", ())))]
        tables += [("on", i, "set") for i, on in enumerate(top.get("on", ())) if "set" in on]
        paths = [(*table, v.name) for table in tables if _value_at(top, (*table, v.name)) is not None]
        values_by_name = {_join_keys(path): _value_at(top, path) for path in paths}
        if len(set(values_by_name.values())) > 1:
            several = ", ".join(f"{value} in {name}" for name, value in values_by_name.items())
            raise UserError(f"{v.name} has several values in the scenario: {several}; name the one that is to vary")
        present = next(iter(values_by_name.values()), v.start)
        return Target(v.name, tuple(paths) or (("start", v.name),), v, present, self._unit_at(("start", v.name)))

    def _unit_at(self, path: KeyPath) -> str | None:
        """The name of the unit of a value; None: it is no number that may have one."""
        kind = measured_kind(path, self._block.variables)
        return unit_name(kind, self.scenario.unit, self.scenario.slave_unit) if kind else None

    @cached_property
    def _paths_by_name(self) -> dict[str, KeyPath]:
        """All names that may vary, with their paths; a variable of the block has several or none: ()."""
        settable = (v for v in self._block.variables.values() if v.settable and not self._block.scripts(v))
        names: dict[str, KeyPath] = {v.name: () for v in settable}
        values = _track_reads(self._top.values)
        read_scenario(self._top.with_values(values))
        for path, value in _find_values(values):
            v = self._variable_at(path)
            if not isinstance(value, str) or (v and v.choices):
                names.setdefault(_join_keys(path), path)
        return names

    def _variable_at(self, path: KeyPath) -> Variable | None:
        """The variable that is the key of a value; None: the key is one of the script's."""
        return self._block.variables.get(str(path[-1])) if path[0] in NAMED else None


class _TrackedTable(dict[str, Any]):
    """A table of a file, and the keys for which the reader has asked: what it depends on, and what it may have."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self.keys_read: set[str] = set()

    def __contains__(self, key: object) -> bool:
        self.keys_read.add(str(key))
        return super().__contains__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self.keys_read.add(key)
        return super().get(key, default)


def _track_reads(value: Any) -> Any:
    """The value, with tables that record which of their keys are read."""
    if isinstance(value, list):
        return [_track_reads(inner) for inner in value]
    if isinstance(value, dict):
        return _TrackedTable({key: _track_reads(inner) for key, inner in value.items()})
    return value


@dataclass(frozen=True)
class _CachedRead:
    """A part of a scenario as it was read, and all that it depends on: tables, arguments and the stop time."""

    tables: Mapping[str, Any]
    arguments: tuple[Any, ...]
    stop_time: float
    result: Any


def _reused_while_unchanged(read: Callable[..., T]) -> Callable[..., T]:
    """A method of the reader that reads only if something has changed of what it asked for the last time."""

    @wraps(read)
    def read_unless_unchanged(reader: "_CachingReader", *arguments: Any) -> T:
        values = reader.top.values
        assert isinstance(values, _TrackedTable)
        cached = reader.cached_reads.get(read.__name__)
        if (
            cached is None
            or cached.stop_time != reader.stop_time
            or any(a is not b for a, b in zip(cached.arguments, arguments, strict=True))
            or any(dict.get(values, key) is not table for key, table in cached.tables.items())
        ):
            values.keys_read.clear()
            result = read(reader, *arguments)
            tables = {key: dict.get(values, key) for key in values.keys_read}
            cached = reader.cached_reads[read.__name__] = _CachedRead(tables, arguments, reader.stop_time, result)
        return cast("T", cached.result)

    return read_unless_unchanged


class _CachingReader(BlockReader):
    """Reads the same scenario again and again, with other values in some of its tables."""

    def __init__(self, top: TomlTable, name: str, stop_time: float) -> None:
        super().__init__(top, name, stop_time)
        self.cached_reads: dict[str, _CachedRead] = {}

    def of(self, top: TomlTable, stop_time: float) -> Self:
        """The reader of the same scenario with another top level; what was read is known to all of them."""
        other = copy(self)
        other.top, other.stop_time = top, stop_time
        return other

    start = _reused_while_unchanged(BlockReader.start)
    script = _reused_while_unchanged(BlockReader.script)
    remote = _reused_while_unchanged(BlockReader.remote)
    encoder = _reused_while_unchanged(BlockReader.encoder)
    drive = _reused_while_unchanged(BlockReader.drive)
    settings = _reused_while_unchanged(BlockReader.settings)
    reactions = _reused_while_unchanged(BlockReader.reactions)
    expectations = _reused_while_unchanged(BlockReader.expectations)
    cuts = _reused_while_unchanged(BlockReader.cuts)
    pieces = _reused_while_unchanged(BlockReader.pieces)
    servo = _reused_while_unchanged(BlockReader.servo)
    load = _reused_while_unchanged(BlockReader.load)
    picture = _reused_while_unchanged(BlockReader.picture)


def _find_values(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """All values of a tracked table that are no tables or lists; None for each key that was read and is missing."""
    if isinstance(value, _TrackedTable):
        for key, inner in value.items():
            yield from _find_values(inner, (*path, key))
        yield from (((*path, key), None) for key in sorted(value.keys_read - {*value}))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _find_values(inner, (*path, i))
    else:
        yield path, value


def _join_keys(path: KeyPath) -> str:
    return ".".join(map(str, path))


def _value_at(values: Any, path: KeyPath) -> Any:
    """The value at a path; None if there is none."""
    for key in path:
        inside = values if isinstance(values, dict) else dict(enumerate(values)) if isinstance(values, list) else {}
        values = inside.get(key)
    return values


def _with_changes(top: dict[str, Any], changes: Iterable[tuple[KeyPath, Any]]) -> dict[str, Any]:
    """The tables with other values at some paths. What holds none of these paths is not copied."""
    root = top.copy()
    copies: dict[KeyPath, Any] = {(): root}
    for path, value in changes:
        for n in range(1, len(path)):
            if path[:n] not in copies:
                inside = _value_at(copies[path[: n - 1]], path[n - 1 : n])
                copies[path[:n]] = copies[path[: n - 1]][path[n - 1]] = {} if inside is None else inside.copy()
        copies[path[:-1]][path[-1]] = value
    return root
