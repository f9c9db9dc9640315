"""Scenario files: a scripted master, commands and expectations, read from TOML and checked against the block.

Every mistake is one `UserError` that begins with file and line and names the key.
"""

import math
import operator
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from motionsync.blocks import BLOCKS

from .build import Recipe, check_slave_unit
from .description import BASES
from .errors import UserError
from .script import Script, Segment
from .variables import Variable, variables

FILE = "scenario.toml"
SCALARS = ("title", "source", "fmu", "unit", "slave_unit", "stop_time", "step_size", "tolerance")
COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {"==": operator.eq, "<": operator.lt, ">": operator.gt}
CONDITION = re.compile(r"\s*([\w.]+)\s*(?:(==|<|>)\s*(\S+)\s*)?")
MOST_STEPS = 1_000_000  # their results still fit into memory
USES: Mapping[str, tuple[Callable[[Variable], bool], str]] = {  # which variables a table may name
    "start": (lambda v: v.settable, "a parameter or input"),
    "set": (lambda v: v.causality == "input" or v.variability == "tunable", "an input or tunable parameter"),
    "expect": (lambda v: v.causality in ("output", "local"), "an output or local variable"),
    "cuts": (lambda v: v.kind == "Boolean" and not v.settable, "a Boolean output or local variable"),
}


@dataclass(frozen=True)
class Setting:
    """Variables that are set at a time, in s."""

    at: float
    values: Mapping[str, Any]


@dataclass(frozen=True)
class AtTime:
    """Values at a time, within a tolerance."""

    at: float
    values: Mapping[str, float]
    tolerance: float


@dataclass(frozen=True)
class When:
    """The first time at which a variable compares with a value as told; without a tolerance, to one step of the run."""

    text: str
    name: str
    comparison: str
    value: float
    time: float
    tolerance: float | None


@dataclass(frozen=True)
class Within:
    """Limits that hold at all communication points of an interval."""

    begin: float
    end: float
    limits: Mapping[str, tuple[float, float]]
    tolerance: float


Expectation = AtTime | When | Within


@dataclass(frozen=True)
class Cuts:
    """The slave is a saw that cuts the master's material while a Boolean is true.

    Attributes:
        name: the Boolean.
        length: distance of the marks on the material, in u; one of them lies at `offset`.
        ratio: the slave's travel over the master's.
        tolerance: the greatest allowed distance of a cut from its mark, in u; None: it is not judged.
        count: how many cuts there have to be; None: any number.
    """

    name: str
    length: float
    offset: float
    ratio: float
    tolerance: float | None
    count: int | None

    def nearest(self, place: float) -> float:
        """The mark that is nearest to a place on the material."""
        return self.offset + round((place - self.offset) / self.length) * self.length


@dataclass(frozen=True)
class Scenario:
    """A checked scenario: all names exist, all values fit their variables.

    `unit`: of positions, for the report; the FMU's numbers do not depend on it. `slave_unit`: of the slave's, where a
    block tells them apart; empty: the same.
    `tolerance`: of the reference, relative to the greatest magnitude of each variable in it.
    """

    file: Path
    title: str
    source: str
    recipe: Recipe
    unit: str
    slave_unit: str
    stop_time: float
    step_size: float
    tolerance: float
    start: Mapping[str, Any]
    master: Script
    settings: tuple[Setting, ...]
    expectations: tuple[Expectation, ...]
    cuts: Cuts | None

    @property
    def name(self) -> str:
        return self.file.resolve().parent.name

    @property
    def period(self) -> float:
        return float(self.start.get("master.period", 0.0))


def find(path: Path) -> list[Path]:
    """The scenario files at a path: a file, or all below a folder.

    Raises:
        UserError: there is none.
    """
    if path.is_file():
        return [path]
    found = sorted(path.rglob(FILE))
    if not found:
        raise UserError(f"{path}: {f'no {FILE} below it' if path.is_dir() else 'no such file or folder'}")
    return found


def load(file: Path) -> Scenario:
    """Read and check a scenario file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    return _Reader(file).scenario()


class _Reader:
    """One file being read; knows how to tell on which line a mistake stands."""

    def __init__(self, file: Path) -> None:
        self.file = file
        try:
            self.text = file.read_text("utf-8-sig")
            self.root: dict[str, Any] = tomllib.loads(self.text)
        except (OSError, UnicodeDecodeError) as e:
            raise UserError(f"{file}: cannot be read: {e}") from None
        except tomllib.TOMLDecodeError as e:
            line = re.search(r"line (\d+)", str(e))
            at = int(line[1]) if line else self.text.count("\n") + 1
            raise UserError(f"{file}:{at}: not TOML: {e}") from None
        except RecursionError:
            raise UserError(f"{file}:1: not TOML: nested too deeply") from None
        self.lines = _lines(self.text)
        self.variables: dict[str, Variable] = {}

    def scenario(self) -> Scenario:
        self.keys(self.root, (*SCALARS, "start", "master", "set", "expect", "cuts"), "")
        name = self.string("fmu")
        if name not in BLOCKS:
            self.fail("", 0, "fmu", f"no block is named {name!r}; there is {', '.join(BLOCKS)}")
        unit = self.string("unit", "mm")
        if unit not in BASES:
            self.fail("", 0, "unit", f"{unit!r} is not one of {', '.join(BASES)}")
        block = BLOCKS[name].type()
        slave_unit = self.string("slave_unit", "")
        try:
            check_slave_unit(block, slave_unit)
        except UserError as e:
            self.fail("", 0, "slave_unit", str(e))
        self.variables = {v.name: v for v in variables(block)}
        stop_time = self.number(self.root, "stop_time", "", above=0.0)
        step_size = self.number(self.root, "step_size", "", above=0.0, most=stop_time)
        if stop_time / step_size > MOST_STEPS:
            self.fail("", 0, "step_size", f"{step_size:g} makes more than {MOST_STEPS:,} steps up to {stop_time:g}")
        return Scenario(
            self.file,
            self.string("title"),
            self.string("source"),
            Recipe(name),
            unit,
            slave_unit,
            stop_time,
            step_size,
            self.number(self.root, "tolerance", "", default=1e-9, above=0.0),
            self.start(),
            self.master(),
            tuple(self.settings(stop_time)),
            tuple(self.expectations(stop_time)),
            self.cuts() if "cuts" in self.root else None,
        )

    def start(self) -> dict[str, Any]:
        table = self.table("start", required=False)
        return {name: self.value(name, value, "start", 0) for name, value in table.items()}

    def master(self) -> Script:
        table = self.table("master")
        self.keys(table, ("position", "velocity", "acceleration", "segments"), "master")
        p, v, a = (self.number(table, key, "master", default=0.0) for key in ("position", "velocity", "acceleration"))
        segments = table.get("segments", [])
        if not isinstance(segments, list) or not all(isinstance(s, dict) for s in segments):
            self.fail("master", 0, "segments", "must be a list of tables { duration = ..., ... }")
        return Script(p, v, a, [self.segment(s, i) for i, s in enumerate(segments)])

    def segment(self, table: dict[str, Any], i: int) -> Segment:
        where = "master.segments"
        self.keys(table, ("duration", "velocity", "acceleration", "jerk"), where, i)
        duration = self.number(table, "duration", where, i, above=0.0)
        held = [key for key in ("velocity", "acceleration", "jerk") if key in table]
        if len(held) > 1:
            self.fail(where, i, held[1], f"a segment holds at most one of velocity, acceleration, jerk, not {held}")
        return Segment(duration, **{key: self.number(table, key, where, i) for key in held})

    def settings(self, stop_time: float) -> Iterator[Setting]:
        for i, table in enumerate(self.tables("set")):
            at = self.number(table, "at", "set", i)
            if at <= 0.0:
                self.fail("set", i, "at", f"{at:g}: what is set at 0 is a start value (no edge); write it in [start]")
            if at >= stop_time:
                self.fail("set", i, "at", f"{at:g} is not before stop_time = {stop_time:g}: no step would show it")
            values = {name: self.value(name, value, "set", i) for name, value in table.items() if name != "at"}
            if not values:
                self.fail("set", i, "at", "sets nothing")
            yield Setting(at, values)

    def expectations(self, stop_time: float) -> Iterator[Expectation]:
        for i, table in enumerate(self.tables("expect")):
            kinds = [key for key in ("at", "when", "from") if key in table]
            if len(kinds) != 1:
                self.fail("expect", i, "", "needs exactly one of at, when, from")
            match kinds[0]:
                case "at":
                    yield self.at_time(table, i, stop_time)
                case "when":
                    yield self.when(table, i, stop_time)
                case _:
                    yield self.within(table, i, stop_time)

    def at_time(self, table: dict[str, Any], i: int, stop_time: float) -> AtTime:
        at = self.number(table, "at", "expect", i, least=0.0, most=stop_time)
        values = {
            name: float(self.value(name, value, "expect", i))
            for name, value in table.items()
            if name not in ("at", "tolerance")
        }
        if not values:
            self.fail("expect", i, "at", "expects nothing")
        return AtTime(at, values, self.number(table, "tolerance", "expect", i, default=1e-6, least=0.0))

    def when(self, table: dict[str, Any], i: int, stop_time: float) -> When:
        self.keys(table, ("when", "time", "tolerance"), "expect", i)
        text = table["when"]
        match = CONDITION.fullmatch(text) if isinstance(text, str) else None
        if not match:
            self.fail("expect", i, "when", f"{text!r} is not NAME, NAME == VALUE, NAME < VALUE or NAME > VALUE")
        name, comparison, value = match[1], match[2] or "==", match[3]
        v = self.variable(name, "expect", i, "when")
        if value is None and v.kind != "Boolean":
            self.fail("expect", i, "when", f"{name} is a {v.kind}: compare it, as in {name!r} == VALUE")
        wanted = 1.0 if value is None else float(self.value(name, _literal(value), "expect", i, "when"))
        time = self.number(table, "time", "expect", i, least=0.0, most=stop_time)
        tolerance = self.number(table, "tolerance", "expect", i, least=0.0) if "tolerance" in table else None
        return When(text, name, comparison, wanted, time, tolerance)

    def within(self, table: dict[str, Any], i: int, stop_time: float) -> Within:
        begin = self.number(table, "from", "expect", i, least=0.0, most=stop_time)
        end = self.number(table, "to", "expect", i, least=begin, most=stop_time)
        limits: dict[str, tuple[float, float]] = {}
        for name, bounds in table.items():
            if name in ("from", "to", "tolerance"):
                continue
            self.variable(name, "expect", i, name)
            if not isinstance(bounds, dict) or not bounds:
                self.fail("expect", i, name, "must be { min = ..., max = ... }, or one of them")
            self.keys(bounds, ("min", "max"), "expect", i, name)
            low = self.number(bounds, "min", "expect", i, default=-math.inf, within=name)
            limits[name] = (low, self.number(bounds, "max", "expect", i, default=math.inf, least=low, within=name))
        if not limits:
            self.fail("expect", i, "from", "expects nothing")
        return Within(begin, end, limits, self.number(table, "tolerance", "expect", i, default=1e-9, least=0.0))

    def cuts(self) -> Cuts:
        table = self.table("cuts")
        self.keys(table, ("while", "length", "offset", "ratio", "tolerance", "count"), "cuts")
        name = self.string("while", within="cuts")
        self.variable(name, "cuts", 0, "while")
        if period := self.root.get("start", {}).get("master.period"):
            self.fail("cuts", 0, "", f"the material is a linear axis, but master.period is {period:g}")
        count = self.number(table, "count", "cuts", least=0.0) if "count" in table else None
        if count is not None and not count.is_integer():
            self.fail("cuts", 0, "count", f"{count:g} is not a whole number")
        if (ratio := self.number(table, "ratio", "cuts", default=1.0)) == 0.0:
            self.fail("cuts", 0, "ratio", "0 is not allowed: the saw goes along with the material")
        return Cuts(
            name,
            self.number(table, "length", "cuts", above=0.0),
            self.number(table, "offset", "cuts", default=0.0),
            ratio,
            self.number(table, "tolerance", "cuts", least=0.0) if "tolerance" in table else None,
            None if count is None else int(count),
        )

    # --- single values ---

    def variable(self, name: str, table: str, i: int, key: str) -> Variable:
        v = self.variables.get(name)
        if v is None:
            near = get_close_matches(name, self.variables, 1)
            hint = f"; do you mean {near[0]!r}?" if near else ""
            self.fail(table, i, key, f"{self.root['fmu']} has no variable {name!r}{hint}")
        if table in ("expect", "cuts") and not USES[table][0](v):
            kind = f" {v.kind}" if table == "cuts" else ""
            self.fail(table, i, key, f"{name} is a {v.variability}{kind} {v.causality}, not {USES[table][1]}")
        return v

    def value(self, name: str, value: Any, table: str, i: int, key: str = "") -> Any:
        """A value of a variable, as a number or Boolean; an enumeration's member may be given by name."""
        key = key or name
        if isinstance(value, dict) and name not in self.variables:
            for part, inner in value.items():
                if f"{name}.{part}" in self.variables and not isinstance(inner, dict):
                    self.fail(table, i, name, f'a name with a dot needs quotes: "{name}.{part}"')
        v = self.variable(name, table, i, key)
        fits, what = USES[table]
        if not fits(v):
            self.fail(table, i, key, f"is a {v.variability} {v.causality}, not {what}")
        if table != "expect" and v.causality == "input" and name.startswith("master."):
            self.fail(table, i, key, "comes from the script in [master]")
        names = {member.name: member.value for member in v.choices}
        value = names.get(value, value) if isinstance(value, str) else value
        kinds: Any = {"Boolean": bool, "Real": (int, float)}.get(v.kind, int)
        if not isinstance(value, kinds) or (isinstance(value, bool) and v.kind != "Boolean"):
            self.fail(table, i, key, f"{value!r} is no {v.kind}" + (f": it must be {v.range}" if v.choices else ""))
        value = _real(value) if v.kind == "Real" else value
        if (table == "start" or v.choices) and (refusal := v.refusal(value)):
            self.fail(table, i, key, refusal)
        if table == "expect" and not math.isfinite(value):
            self.fail(table, i, key, f"{value} is not allowed: it must be finite")
        return value

    def number(
        self,
        table: dict[str, Any],
        key: str,
        where: str,
        i: int = 0,
        *,
        default: float | None = None,
        above: float = -math.inf,
        least: float = -math.inf,
        most: float = math.inf,
        within: str = "",
    ) -> float:
        value, given = table.get(key, default), key in table
        key, told = (within, f"{key}: ") if within else (key, "")
        if value is None:
            self.fail(where, i, key, f"{told}is missing")
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fail(where, i, key, f"{told}{value!r} is not a number")
        value = _real(value)
        if given and not math.isfinite(value):
            self.fail(where, i, key, f"{told}{value} is not allowed: it must be finite")
        if not (value > above and least <= value <= most) and given:
            limits = (f"> {above:g}", above), (f">= {least:g}", least), (f"<= {most:g}", -most)
            text = " and ".join(t for t, limit in limits if limit > -math.inf)
            self.fail(where, i, key, f"{told}{value:g} is not allowed: it must be {text}")
        return value

    def string(self, key: str, default: str | None = None, within: str = "") -> str:
        table = self.root[within] if within else self.root
        value = table.get(key, default)
        if value is None:
            self.fail(within, 0, key, "is missing")
        if not isinstance(value, str):
            self.fail(within, 0, key, f"{value!r} is not a text")
        return value

    def table(self, key: str, *, required: bool = True) -> dict[str, Any]:
        value = self.root.get(key, None if required else {})
        if not isinstance(value, dict):
            self.fail("", 0, key, "is missing" if value is None else f"must be a table: [{key}]")
        return value

    def tables(self, key: str) -> list[dict[str, Any]]:
        value = self.root.get(key, [])
        if not isinstance(value, list) or not all(isinstance(t, dict) for t in value):
            self.fail("", 0, key, f"must be a list of tables: [[{key}]]")
        return value

    def keys(self, table: dict[str, Any], known: tuple[str, ...], where: str, i: int = 0, within: str = "") -> None:
        for key in table:
            if key not in known:
                at = within or key
                self.fail(where, i, at, f"{'' if not within else key + ': '}unknown key; there is {', '.join(known)}")

    def fail(self, table: str, i: int, key: str, message: str) -> NoReturn:
        places = [(table, i, key), (table, i, "")] if table else [("", 0, key), (key, 0, "")]
        line = next((self.lines[place] for place in places if place in self.lines), 1)
        raise UserError(f"{self.file}:{line}: {key or table}: {message}")


def _lines(text: str) -> dict[tuple[str, int, str], int]:
    """On which line each key of the i-th table of a name stands, "" for the table itself; tomllib does not tell."""
    found: dict[tuple[str, int, str], int] = {}
    tables: Counter[str] = Counter()
    table, i, segments = "", 0, 0
    listing = False
    for n, line in enumerate(text.split("\n"), 1):
        if header := re.match(r"\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$", line):
            table, listing = header[1], False
            i = tables[table]
            tables[table] += 1
            found[table, i, ""] = n
        elif key := re.match(r"""\s*(["']?)([\w.-]+)\1\s*=""", line):
            found.setdefault((table, i, key[2]), n)
            if not key[1]:  # a.b = ... is a table a to TOML
                found.setdefault((table, i, key[2].partition(".")[0]), n)
            listing = key[2] == "segments"
        for _ in range(line.count("{") if listing else 0):
            found["master.segments", segments, ""] = n
            segments += 1
    return found


def _real(value: float) -> float:
    """As a float; infinite where an integer is beyond all floats."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _literal(text: str) -> Any:
    """A value in a condition: true, false, a number, or a member's name."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
