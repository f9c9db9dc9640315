"""A scenario with other values than its file has, checked by the scenario's own reader.

A name is that of a variable of the block, or the path of a number in the scenario's file, with dots:
`master.velocity`, `master.segments.1.acceleration`, `cuts.length`, `stop_time`, `set.0.at`, `on.0.after`,
`expect.2.tolerance`. Tables of one name, and the entries of lists, are counted from 0. `length` is the block's variable
of this name, or else that of the table [cuts].

A variable of the block has its value where the scenario gives it one: in [start], in a [[set]], or in a reaction
[[on]]; without any of them it gets a start value. If it stands in several places with the same value, all of them
change. If its values differ, the name alone would overwrite what the scenario does, and is refused; the path of one
place (`set.2.gear_in_pos.velocity`) is meant instead.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass
from functools import cached_property, wraps
from pathlib import Path
from typing import Any, Self, TypeVar, cast

from ..errors import UserError, choose
from ..interface.variables import Variable
from ..scenario.reader import BRACED, Reader, read_scenario
from ..scenario.scenario import Scenario
from ..scenario.toml_tables import Table, read_text
from ..scenario.variable_tables import Subject
from .factors import Kind

T = TypeVar("T")
Place = tuple[str | int, ...]
"""Keys and indices that lead from the top of a scenario file to a value."""

NAMED = ("start", "set", "on", "expect")  # tables whose keys are names of variables


@dataclass(frozen=True)
class Target:
    """What a name means in a scenario.

    Attributes:
        name: the name in full: `cuts.length` where `length` is meant.
        places: where its value stands, or will stand.
        variable: the block's variable; None: a key of the script.
        present: the value in the scenario; None: it has none.
    """

    name: str
    places: tuple[Place, ...]
    variable: Variable | None
    present: float | bool | str | None

    @property
    def kind(self) -> Kind:
        """What its values are."""
        v = self.variable
        return Kind(v.kind, tuple((m.value, m.name) for m in v.choices)) if v else Kind()

    def fitted(self, value: Any) -> Any:
        """The value as the scenario's file would have it: a whole number without a point where one belongs."""
        whole = self.variable.kind in ("Integer", "Enumeration") if self.variable else type(self.present) is int
        return int(value) if whole and isinstance(value, float) and value.is_integer() else value


class Varied:
    """A scenario file that is parsed once, and scenarios with other values.

    Attributes:
        scenario: the scenario as its file has it.
    """

    def __init__(self, text: str, file: Path) -> None:
        """`text`: what the file has in it.

        Raises:
            UserError: the first mistake in it, with file, line and key.
        """
        self._top = read_text(text, file, BRACED)
        self._reader: _Rereader | None = None
        self.scenario = self.varied(())

    def target(self, name: str) -> Target:
        """What a name means.

        Raises:
            UserError: the scenario has nothing of that name that can vary, or its name alone does not tell which value
                is meant.
        """
        if name == "length" and name not in self._known:
            name = "cuts.length"
        place = choose(self._known, name, f"variable of {self._block.name} or number of the scenario")
        if not place:
            return self._variable(self._block.variables[name])
        return Target(name, (place,), self._named(place), _at(self._top.values, place))

    def varied(self, values: Iterable[tuple[Target, Any]]) -> Scenario:
        """The scenario with other values.

        Raises:
            UserError: the reader refuses it; the message has file, line and key.
        """
        changes = [(place, target.fitted(value)) for target, value in values for place in target.places]
        return read_scenario(self._top.with_values(_Asked(_changed(self._top.values, changes))), self._reader_of)

    def _reader_of(self, top: Table, name: str, stop_time: float) -> Reader:
        """The same reader for every scenario: block and interface, which are texts, never vary."""
        if self._reader is None:
            self._reader = _Rereader(top, name, stop_time)
        return self._reader.of(top, stop_time)

    @property
    def _block(self) -> Subject:
        assert self._reader
        return self._reader.block

    def _variable(self, v: Variable) -> Target:
        """A variable, at all places at which the scenario gives it a value."""
        top = self._top.values
        tables: list[Place] = [("start",)]
        tables += [("set", i) for i in range(len(top.get("set", ())))]
        tables += [("on", i, "set") for i, on in enumerate(top.get("on", ())) if "set" in on]
        places = [(*table, v.name) for table in tables if _at(top, (*table, v.name)) is not None]
        found = {_dotted(place): _at(top, place) for place in places}
        if len(set(found.values())) > 1:
            several = ", ".join(f"{value} in {name}" for name, value in found.items())
            raise UserError(f"{v.name} has several values in the scenario: {several}; name the one that is to vary")
        present = next(iter(found.values()), v.start)
        return Target(v.name, tuple(places) or (("start", v.name),), v, present)

    @cached_property
    def _known(self) -> dict[str, Place]:
        """All names that may vary, with their places; a variable of the block has several or none: ()."""
        settable = (v for v in self._block.variables.values() if v.settable and not self._block.scripts(v))
        names: dict[str, Place] = {v.name: () for v in settable}
        values = _watched(self._top.values)
        read_scenario(self._top.with_values(values))
        for place, value in _leaves(values):
            v = self._named(place)
            if not isinstance(value, str) or (v and v.choices):
                names.setdefault(_dotted(place), place)
        return names

    def _named(self, place: Place) -> Variable | None:
        """The variable that is the key of a value; None: the key is one of the script's."""
        return self._block.variables.get(str(place[-1])) if place[0] in NAMED else None


class _Asked(dict[str, Any]):
    """A table of a file, and the keys for which the reader has asked: what it depends on, and what it may have."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self.asked: set[str] = set()

    def __contains__(self, key: object) -> bool:
        self.asked.add(str(key))
        return super().__contains__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self.asked.add(key)
        return super().get(key, default)


def _watched(value: Any) -> Any:
    """The value with all tables in it as tables that tell what is asked for."""
    if isinstance(value, list):
        return [_watched(inner) for inner in value]
    return _Asked({key: _watched(inner) for key, inner in value.items()}) if isinstance(value, dict) else value


@dataclass(frozen=True)
class _Part:
    """A part of a scenario as it was read, and all that it depends on: tables, arguments and the stop time."""

    tables: Mapping[str, Any]
    arguments: tuple[Any, ...]
    stop_time: float
    found: Any


def _kept(read: Callable[..., T]) -> Callable[..., T]:
    """A method of the reader that reads only if something has changed of what it asked for the last time."""

    @wraps(read)
    def kept(reader: "_Rereader", *arguments: Any) -> T:
        values = reader.top.values
        assert isinstance(values, _Asked)
        part = reader.parts.get(read.__name__)
        if (
            part is None
            or part.stop_time != reader.stop_time
            or any(a is not b for a, b in zip(part.arguments, arguments, strict=True))
            or any(dict.get(values, key) is not table for key, table in part.tables.items())
        ):
            values.asked.clear()
            found = read(reader, *arguments)
            tables = {key: dict.get(values, key) for key in values.asked}
            part = reader.parts[read.__name__] = _Part(tables, arguments, reader.stop_time, found)
        return cast("T", part.found)

    return kept


class _Rereader(Reader):
    """Reads the same scenario again and again, with other values in some of its tables."""

    def __init__(self, top: Table, name: str, stop_time: float) -> None:
        super().__init__(top, name, stop_time)
        self.parts: dict[str, _Part] = {}

    def of(self, top: Table, stop_time: float) -> Self:
        """The reader of the same scenario with another top level; what was read is known to all of them."""
        other = copy(self)
        other.top, other.stop_time = top, stop_time
        return other

    start = _kept(Reader.start)
    script = _kept(Reader.script)
    remote = _kept(Reader.remote)
    drive = _kept(Reader.drive)
    settings = _kept(Reader.settings)
    reactions = _kept(Reader.reactions)
    expectations = _kept(Reader.expectations)
    cuts = _kept(Reader.cuts)
    pieces = _kept(Reader.pieces)
    picture = _kept(Reader.picture)


def _leaves(value: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """All values of a watched table that are no tables or lists, and as None those that it may have and has not."""
    if isinstance(value, _Asked):
        for key, inner in value.items():
            yield from _leaves(inner, (*place, key))
        yield from (((*place, key), None) for key in sorted(value.asked - {*value}))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _leaves(inner, (*place, i))
    else:
        yield place, value


def _dotted(place: Place) -> str:
    return ".".join(map(str, place))


def _at(values: Any, place: Place) -> Any:
    """The value at a place; None if there is none."""
    for key in place:
        inside = values if isinstance(values, dict) else dict(enumerate(values)) if isinstance(values, list) else {}
        values = inside.get(key)
    return values


def _changed(top: dict[str, Any], changes: Iterable[tuple[Place, Any]]) -> dict[str, Any]:
    """The tables with other values at some places. What holds none of these places is not copied."""
    root = top.copy()
    copies: dict[Place, Any] = {(): root}
    for place, value in changes:
        for n in range(1, len(place)):
            if place[:n] not in copies:
                inside = _at(copies[place[: n - 1]], place[n - 1 : n])
                copies[place[:n]] = copies[place[: n - 1]][place[n - 1]] = {} if inside is None else inside.copy()
        copies[place[:-1]][place[-1]] = value
    return root
