"""Scenario files: a scripted axis, commands and expectations, read from TOML and checked against the block.

Every mistake is one `UserError` that begins with file and line and names the key.
"""

import math
import operator
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from motionsync.blocks import BLOCKS
from motionsync.remote_sync.interface import INDICES

from ..build import Recipe, check_slave_unit
from ..errors import UserError
from ..interface.fmi2_xml import BASES
from ..interface.variables import Variable, variables
from .clocks import Clocks, Rate
from .cuts import Cuts
from .script import Script, Segment
from .telegrams import Accuracy, Remote

FILE = "scenario.toml"
SCALARS = ("title", "source", "fmu", "unit", "slave_unit", "stop_time", "step_size", "tolerance")
MOTION = ("position", "velocity", "acceleration", "segments")
TELEGRAMS = ("sender_cycle", "phase", "jitter", "seed", "lost", "first_index", "accuracy")
DELAY = "delay_time_offset"  # shifts what the outputs of a block with a remote axis describe
LISTS = ("segments", "sender_cycle")  # of tables, each on a line of its own or not
COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {"==": operator.eq, "<": operator.lt, ">": operator.gt}
CONDITION = re.compile(r"\s*([\w.]+)\s*(?:(==|<|>)\s*(\S+)\s*)?")
MOST_STEPS = 1_000_000  # their results still fit into memory
MOST_JITTER = 0.15  # of a cycle: nearly all of it is then less than what keeps the order of cycles
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
    """The first time at which a variable compares with a value as told.

    Without a tolerance it is known to one step of the run, or to one cycle of a cyclic block if that is longer.
    """

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
class Scenario:
    """A checked scenario: all names exist, all values fit their variables.

    `unit`: of positions, for the report; the FMU's numbers do not depend on it. `slave_unit`: of the slave's, where a
    block tells them apart; empty: the same.
    `tolerance`: of the reference, relative to the greatest magnitude of each variable in it.
    `master`: the scripted axis; also that of a remote one.
    `remote`: how that axis is seen, by a block that has no master; else None.
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
    remote: Remote | None
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
    return Reader(file).scenario()


class Reader:
    """One file being read; knows how to tell on which line a mistake stands.

    Attributes:
        name: the block whose variables the file's tables name at present.
        variables: these variables.
        group: which of its inputs come from a script, and so the name of the script's table.
        origin: where these inputs come from, in words.
    """

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
        self.name = ""
        self.variables: dict[str, Variable] = {}
        self.group = ""
        self.origin = ""

    def scenario(self) -> Scenario:
        self.keys(self.root, (*SCALARS, "start", "master", "remote", "set", "expect", "cuts"), "")
        unit, slave_unit = self.block()
        other = "master" if self.group == "remote" else "remote"
        if other in self.root:
            self.fail("", 0, other, f"{self.name} has no inputs {other}.*: its axis is scripted in [{self.group}]")
        stop_time, step_size = self.times()
        start, script, settings = self.start(), self.script(), tuple(self.settings(stop_time))
        return Scenario(
            self.file,
            self.string("title"),
            self.string("source"),
            Recipe(self.name),
            unit,
            slave_unit,
            stop_time,
            step_size,
            self.number(self.root, "tolerance", "", default=1e-9, above=0.0),
            start,
            script,
            self.remote(script, start, settings, stop_time) if self.group == "remote" else None,
            settings,
            tuple(self.expectations(stop_time)),
            self.cuts() if "cuts" in self.root else None,
        )

    def block(self) -> tuple[str, str]:
        """The units of positions and of the slave's; from here on the file's tables name the block's variables."""
        name = self.string("fmu")
        if name not in BLOCKS:
            self.fail("", 0, "fmu", f"no block is named {name!r}; there is {', '.join(BLOCKS)}")
        unit = self.string("unit", "mm")
        if unit not in BASES:
            self.fail("", 0, "unit", f"{unit!r} is not one of {', '.join(BASES)}")
        slave_unit = self.string("slave_unit", "")
        try:
            check_slave_unit(BLOCKS[name].type(), slave_unit)
        except UserError as e:
            self.fail("", 0, "slave_unit", str(e))
        self.turn_to(name)
        return unit, slave_unit

    def turn_to(self, name: str) -> None:
        """The tables that are read next name this block's variables."""
        self.name = name
        self.variables = {v.name: v for v in variables(BLOCKS[name].type())}
        self.group = "remote" if "remote.cycle_index" in self.variables else "master"
        self.origin = f"the script in [{self.group}]"

    def times(self) -> tuple[float, float]:
        """stop_time and step_size."""
        stop_time = self.number(self.root, "stop_time", "", above=0.0)
        step_size = self.number(self.root, "step_size", "", above=0.0, most=stop_time)
        if stop_time / step_size > MOST_STEPS:
            self.fail("", 0, "step_size", f"{step_size:g} makes more than {MOST_STEPS:,} steps up to {stop_time:g}")
        return stop_time, step_size

    def start(self, key: str = "start") -> dict[str, Any]:
        """The start values in the table of this name."""
        table = self.table(key, required=False)
        return {name: self.value(name, value, key, 0) for name, value in table.items()}

    def script(self) -> Script:
        table = self.table(self.group)
        self.keys(table, MOTION + (TELEGRAMS if self.group == "remote" else ()), self.group)
        p, v, a = (self.number(table, key, self.group, default=0.0) for key in ("position", "velocity", "acceleration"))
        segments = self.listed(table.get("segments", []), "segments", "{ duration = ..., ... }")
        return Script(p, v, a, [self.segment(s, i) for i, s in enumerate(segments)])

    def listed(self, value: Any, key: str, form: str) -> list[dict[str, Any]]:
        """A list of tables in the script's table."""
        if not isinstance(value, list) or not all(isinstance(t, dict) for t in value):
            self.fail(self.group, 0, key, f"must be a list of tables {form}")
        return value

    def segment(self, table: dict[str, Any], i: int) -> Segment:
        where = f"{self.group}.segments"
        self.keys(table, ("duration", "velocity", "acceleration", "jerk"), where, i)
        duration = self.number(table, "duration", where, i, above=0.0)
        held = [key for key in ("velocity", "acceleration", "jerk") if key in table]
        if len(held) > 1:
            self.fail(where, i, held[1], f"a segment holds at most one of velocity, acceleration, jerk, not {held}")
        return Segment(duration, **{key: self.number(table, key, where, i) for key in held})

    def remote(self, axis: Script, start: Mapping[str, Any], settings: Iterable[Setting], stop_time: float) -> Remote:
        """How the block sees the scripted axis; its own settings tell its cycles and what its outputs describe."""
        table = self.table("remote")
        cycle, data_cycle, delay = (
            start.get(name, self.variables[name].start) for name in ("task_cycle_time", "data_cycle_time", DELAY)
        )
        rates = list(self.rates(table))
        if max(stop_time / cycle, *(stop_time / rate.cycle for rate in rates)) > MOST_STEPS:
            self.fail("remote", 0, "", f"makes more than {MOST_STEPS:,} cycles up to {stop_time:g}")
        first_index = self.whole(table, "first_index", "remote", default=0, most=INDICES - 1)
        clocks = Clocks(
            cycle,
            rates,
            self.number(table, "phase", "remote", default=0.0, least=0.0, below=1.0),
            self.number(table, "jitter", "remote", default=0.0, least=0.0, most=MOST_JITTER),
            self.whole(table, "seed", "remote", default=0),
            list(self.lost(table.get("lost", []), first_index)),
            first_index,
        )
        later = ((s.at, s.values[DELAY]) for s in settings if DELAY in s.values)
        accuracy = self.accuracy(table["accuracy"], stop_time) if "accuracy" in table else None
        delays = [(0.0, delay), *sorted(later)]
        return Remote(axis, clocks, clocks.acted(stop_time), data_cycle or cycle, delays, accuracy)

    def rates(self, table: dict[str, Any]) -> Iterator[Rate]:
        """The sender's cycles: one for ever, or each from a time on."""
        if not isinstance(table.get("sender_cycle"), list):
            yield Rate(0.0, self.number(table, "sender_cycle", "remote", above=0.0))
            return
        where, before = "remote.sender_cycle", -math.inf
        rates = self.listed(table["sender_cycle"], "sender_cycle", "{ at = ..., cycle = ... }")
        if not rates:
            self.fail("remote", 0, "sender_cycle", "is empty")
        for i, rate in enumerate(rates):
            self.keys(rate, ("at", "cycle"), where, i)
            at = self.number(rate, "at", where, i, above=before)
            if i == 0 and at != 0.0:
                self.fail(where, i, "at", f"{at:g}: the first cycle is that from 0 on")
            yield Rate(at, self.number(rate, "cycle", where, i, above=0.0))
            before = at

    def lost(self, ranges: Any, first_index: int) -> Iterator[tuple[int, int]]:
        """Ranges of lost telegrams; the first one that is sent may be among them."""
        if not isinstance(ranges, list):
            self.fail("remote", 0, "lost", "must be a list of ranges [first, last]")
        for pair in ranges:
            if not isinstance(pair, list) or [type(x) for x in pair] != [int, int]:
                self.fail("remote", 0, "lost", f"{pair!r} is not a range [first, last] of whole numbers")
            first, last = pair
            if last < first:
                self.fail("remote", 0, "lost", f"[{first}, {last}] is backwards: the last is at least the first")
            if first < first_index:
                self.fail("remote", 0, "lost", f"[{first}, {last}] is before the first telegram, {first_index}")
            yield first, last

    def accuracy(self, table: Any, stop_time: float) -> Accuracy:
        where = "remote.accuracy"
        if not isinstance(table, dict):
            self.fail("remote", 0, "accuracy", f"must be a table: [{where}]")
        self.keys(table, ("from", "index", "position", "behind"), where)
        if not table.keys() & {"index", "position"}:
            self.fail(where, 0, "", "expects nothing: it needs index, position or both")
        index, position = (
            self.number(table, key, where, least=0.0) if key in table else None for key in ("index", "position")
        )
        begin = self.number(table, "from", where, least=0.0, most=stop_time)
        return Accuracy(begin, index, position, self.number(table, "behind", where, default=0.0, least=0.0))

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
        count = self.whole(table, "count", "cuts") if "count" in table else None
        if (ratio := self.number(table, "ratio", "cuts", default=1.0)) == 0.0:
            self.fail("cuts", 0, "ratio", "0 is not allowed: the saw goes along with the material")
        return Cuts(
            name,
            self.number(table, "length", "cuts", above=0.0),
            self.number(table, "offset", "cuts", default=0.0),
            ratio,
            self.number(table, "tolerance", "cuts", least=0.0) if "tolerance" in table else None,
            count,
        )

    # --- single values ---

    def variable(self, name: str, table: str, i: int, key: str) -> Variable:
        v = self.variables.get(name)
        if v is None:
            near = get_close_matches(name, self.variables, 1)
            hint = f"; do you mean {near[0]!r}?" if near else ""
            self.fail(table, i, key, f"{self.name} has no variable {name!r}{hint}")
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
        fits, what = USES.get(table, USES["start"])
        if not fits(v):
            self.fail(table, i, key, f"is a {v.variability} {v.causality}, not {what}")
        if table != "expect" and v.causality == "input" and name.startswith(f"{self.group}."):
            self.fail(table, i, key, f"comes from {self.origin}")
        names = {member.name: member.value for member in v.choices}
        value = names.get(value, value) if isinstance(value, str) else value
        kinds: Any = {"Boolean": bool, "Real": (int, float)}.get(v.kind, int)
        if not isinstance(value, kinds) or (isinstance(value, bool) and v.kind != "Boolean"):
            self.fail(table, i, key, f"{value!r} is no {v.kind}" + (f": it must be {v.range}" if v.choices else ""))
        value = _real(value) if v.kind == "Real" else value
        if (table not in ("set", "expect") or v.choices) and (refusal := v.refusal(value)):
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
        below: float = math.inf,
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
        if not (value > above and least <= value <= most and value < below) and given:
            limits = (
                *((f"> {above:g}", above), (f">= {least:g}", least)),
                *((f"<= {most:g}", -most), (f"< {below:g}", -below)),
            )
            text = " and ".join(t for t, limit in limits if limit > -math.inf)
            self.fail(where, i, key, f"{told}{value:g} is not allowed: it must be {text}")
        return value

    def whole(
        self, table: dict[str, Any], key: str, where: str, *, default: int | None = None, most: float = math.inf
    ) -> int:
        """A number >= 0 without a fraction."""
        value = self.number(table, key, where, default=default, least=0.0, most=most)
        if not value.is_integer():
            self.fail(where, 0, key, f"{value:g} is not a whole number")
        return int(value)

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
        outer, _, last = table.rpartition(".")
        inner = f"{table}.{key}".strip(".")
        places = [(table, i, key), (inner, 0, ""), (table, i, ""), (outer, 0, last)]
        line = next((self.lines[place] for place in places if place in self.lines), 1)
        raise UserError(f"{self.file}:{line}: {key or table}: {message}")


def _lines(text: str) -> dict[tuple[str, int, str], int]:
    """On which line each key of the i-th table of a name stands, "" for the table itself; tomllib does not tell."""
    found: dict[tuple[str, int, str], int] = {}
    tables: Counter[str] = Counter()
    table, i, listing = "", 0, ""
    for n, line in enumerate(text.split("\n"), 1):
        if header := re.match(r"\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$", line):
            table, listing = header[1], ""
            i = tables[table]
            tables[table] += 1
            found[table, i, ""] = n
        elif key := re.match(r"""\s*(["']?)([\w.-]+)\1\s*=""", line):
            found.setdefault((table, i, key[2]), n)
            if not key[1]:  # a.b = ... is a table a to TOML
                found.setdefault((table, i, key[2].partition(".")[0]), n)
            listing = f"{table}.{key[2]}" if key[2] in LISTS else ""
        for _ in range(line.count("{") if listing else 0):
            found[listing, tables[listing], ""] = n
            tables[listing] += 1
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
