"""model.h: what the C files need to know of a block, the size of its memory and the tables of its variables."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from itertools import pairwise
from math import isinf
from pathlib import Path
from typing import Any

import jinja2

from motionsync.master import MasterInput
from motionsync.var import Report

from ..compiler.memory_layout import dtype, offset
from ..compiler.translator.text import literal
from ..interface.fmi3_xml import TIME
from ..interface.recipe import Fmi
from ..interface.variables import (
    COMPUTED_DIGITS,
    LONGEST_STEP,
    QUIET_TIME,
    SHOWN_DIGITS,
    Variable,
    cells,
    refusals,
    variables,
)

# The variables whose derivatives the importer may set and get, by order. A block that lacks one of them has no
# derivatives.
MASTER = ("master.position", "master.velocity", "master.acceleration")
INPUT_MODE = "master.input_mode"
SLAVE = ("slave.position", "slave.velocity", "slave.acceleration")
BEFORE_STEPS = "INSTANTIATED | INITIALIZING"
MISSING = -1  # in place of a variable's index

Row = tuple[Any, ...]  # the members of a C struct
LAST_MESSAGE: Row = (0, 0, 0)
LAST_CODED: Row = (-1, 0, 0, 0, "REPORT_CHANGES")
LAST_COUNT: Row = (-1, 0)


def model_header(block: Any, guid: str, overrides: Mapping[str, str] | None = None, fmi: Fmi = Fmi.TWO) -> str:
    """The text of model.h: the block's memory, its variables, what it refuses, and what its codes mean.

    `overrides`: as for `variables`; `fmi`: the version, of which the third has the time as one more variable."""
    layout, vs, pool = dtype(block), variables(block, overrides), Pool()
    names = [*(v.name for v in vs), *([TIME] if fmi == Fmi.THREE else [])]
    index = {name: i for i, name in enumerate(names)}
    ranges: dict[Row, int] = {}
    for name in names:
        pool.text(name)  # they come first, so that no table has to give their indices
    rows = []
    for v in vs:  # the range of a variable that is never set is not used
        allowed = ranges.setdefault(_range(v, pool), len(ranges)) if v.settable else 0
        rows.append(_variable(v, layout, pool, allowed))
    if fmi == Fmi.THREE:
        rows.append(_time(pool))
    messages, indices, coded, episodes = _messages(refusals(type(block)), index, pool), {}, [], 0
    for v in vs:
        if codes := v.declaration.codes:
            if codes not in indices:
                indices[codes] = len(messages)
                messages += _messages(codes, index, pool)
            group, report = pool.text(v.name.rpartition(".")[0]), v.declaration.report
            coded.append((offset(layout, v.name), group, indices[codes], episodes, f"REPORT_{report.name}"))
            episodes += sum(m != 0 for m in codes) if report == Report.EPISODES else 0
    return TEMPLATE.render(
        guid=guid,
        longest_step=repr(LONGEST_STEP),
        start_of_step=int(MasterInput.START_OF_STEP),
        position_only=int(MasterInput.POSITION_ONLY),
        master=_indices(index, MASTER, INPUT_MODE),
        slave=_indices(index, SLAVE),
        input_mode=index.get(INPUT_MODE, MISSING),
        size=layout.itemsize,
        texts=pool.texts,
        numbers=[n for numbers in pool.lists for n in numbers],
        ranges=list(ranges),
        variables=rows,
        messages=messages,
        coded=[*coded, LAST_CODED],
        episodes=episodes,
        shown_digits=SHOWN_DIGITS,
        computed_digits=COMPUTED_DIGITS,
        quiet_time=repr(QUIET_TIME),
        flags=_distances(offset(layout, c.name) for c in cells(block) if c.type is bool),
        integers=_distances(offset(layout, c.name) for c in cells(block) if c.type is int),
        counts=[*_counts(block, layout), LAST_COUNT],
    )


def abilities(block: Any) -> dict[str, str]:
    """What only this flavour can do, as attributes of the description's CoSimulation element."""
    index = {v.name: i for i, v in enumerate(variables(block))}
    output = {"maxOutputDerivativeOrder": "2"} if _has(index, *SLAVE) else {}
    return output | ({"canInterpolateInputs": "true"} if _has(index, *MASTER, INPUT_MODE) else {})


def _has(index: dict[str, int], *names: str) -> bool:
    return index.keys() >= {*names}


def _indices(index: dict[str, int], names: Iterable[str], *others: str) -> list[int]:
    """The indices of these variables; all are MISSING if the block lacks one of them, or one of the others."""
    names = list(names)
    return [index[name] if _has(index, *names, *others) else MISSING for name in names]


class Pool:
    """Texts and lists of numbers: each is stored once, and is identified by the index in the array where it starts."""

    def __init__(self) -> None:
        self.texts: dict[str, int] = {}
        self.lists: dict[tuple[int, ...], int] = {}

    def text(self, text: str) -> int:
        clean = unformatted(text)
        return self.texts.setdefault(clean, sum(len(other.encode()) + 1 for other in self.texts))

    def numbers(self, *numbers: int) -> int:
        return self.lists.setdefault(numbers, sum(map(len, self.lists)))


def _variable(v: Variable, layout: Any, pool: Pool, allowed: int) -> Row:
    role = pool.text(f"{v.variability} {v.causality}")
    modes = "0" if not v.settable else BEFORE_STEPS if v.variability == "fixed" else f"{BEFORE_STEPS} | STEPPING"
    return (
        offset(layout, v.name),
        allowed,
        modes,
        literal(v.causality == "input"),
        role,
        literal(v.checked),
        v.kind.upper(),
    )


def _range(v: Variable, pool: Pool) -> Row:
    """The allowed values; a limit that is not allowed itself is replaced by the number next to it."""
    d = v.declaration
    low, high = d.ends
    choices = pool.numbers(len(v.choices), *(int(m) for m in v.choices))
    return number(low), number(high), number(d.least_magnitude), literal(d.zero), choices, pool.text(v.allowed_range)


def _time(pool: Pool) -> Row:
    """The row of the time, which is in the unit and not in the block; since it is never set, no range is its own."""
    return "TIME_OFFSET", 0, "0", "false", pool.text("continuous independent"), "false", "REAL"


def _distances(offsets: Iterable[int]) -> list[int]:
    """Offsets in memory, each by its distance from the one before, the first by that from -1; 0 comes last."""
    return [offset - before for before, offset in pairwise([-1, *sorted(offsets)])] + [0]


def _counts(block: Any, layout: Any) -> list[Row]:
    """The offset and the largest value of each field that is declared as a count."""
    cells_with_metadata = ((c, {f.name: f for f in fields(c.owner)}[c.attribute].metadata) for c in cells(block))
    return [(offset(layout, c.name), metadata["most"]) for c, metadata in cells_with_metadata if "most" in metadata]


def _messages(codes: Iterable[Any], index: dict[str, int], pool: Pool) -> list[Row]:
    """The message of each code except 0: its meaning in words, and the variables whose values the message shows.

    A variable is given by its number. One in the group of the variable that holds the code, such as `.velocity`, is
    given by the index of its text behind all numbers."""
    rows: list[Row] = []
    for m in codes:
        if m != 0:
            numbers = (len(index) + pool.text(name) if name.startswith(".") else index[name] for name in m.names)
            rows.append((int(m), pool.text(m.description), pool.numbers(*numbers, -1)))
    return [*rows, LAST_MESSAGE]


def number(x: float) -> str:
    """A number in C, with all its bits."""
    return ("-" if x < 0 else "") + "INFINITY" if isinf(x) else float(x).hex()


def quoted(text: str) -> str:
    """A text in C, without percent signs."""
    escaped = unformatted(text).replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def unformatted(text: str) -> str:
    """A text without percent signs, since many importers use the text as a C format."""
    return text.replace("%", "percent")


def _row(items: Iterable[Any]) -> str:
    """The initializer of a C struct or array."""
    return "{" + ", ".join(map(str, items)) + "}"


ENVIRONMENT = jinja2.Environment(
    loader=jinja2.FileSystemLoader(Path(__file__).parent),
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    keep_trailing_newline=True,
)
ENVIRONMENT.filters |= {"quoted": quoted, "row": _row}
TEMPLATE = ENVIRONMENT.get_template("model.h.j2")
