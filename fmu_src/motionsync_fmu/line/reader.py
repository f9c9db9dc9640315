"""Reads line files. The follower is described like a scenario whose master is the true axis, with the same messages."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..interface.recipe import Recipe
from ..scenario.cuts import PieceSpec
from ..scenario.reader import SCALARS, Reader, read_block, read_file, read_times
from ..scenario.scenario import Expectation, Scenario
from ..scenario.telegrams import Remote
from ..scenario.toml_tables import Table
from .line import ENABLE, RAMP, REMOTE, Line, expected_names

TABLES = ("remote", "remote_sync", "start", "set", "expect", "cuts", "switches")
TOLERANCE = 1e-9  # of the reference that each scenario may have; a line has none, so this number has no effect


def load_line(file: Path) -> Line:
    """Read and check a line file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    top = read_file(file)
    if "on" in top:
        top.fail("on", "a line cannot react: its importers get all inputs before the run; give times in [[set]]")
    top.allow_only(*(key for key in SCALARS if key not in ("tolerance", "step_bound")), *TABLES)
    name, unit, slave_unit = read_block(top)
    stop_time, step_size = read_times(top)
    reader = Reader(top, name, stop_time, REMOTE)
    if reader.axis:
        top.fail("fmu", f"{name} sees telegrams itself: name the block that follows it")
    start, settings, expectations = reader.start(), reader.settings(), _expectations(reader)
    cuts = reader.cuts(unit) if "cuts" in top and not reader.books else None
    pieces = _pieces(reader, unit) if "cuts" in top and reader.books else None
    places = _places(top, reader.recipe)
    remote, remote_start = _remote(Reader(top, REMOTE, stop_time), step_size)
    follower = Scenario(
        file,
        top.string("title"),
        top.string("source", ""),
        reader.recipe,
        unit,
        slave_unit,
        stop_time,
        step_size,
        step_size,
        TOLERANCE,
        start,
        remote.axis,
        None,
        settings,
        expectations,
        cuts,
        pieces=pieces,
    )
    return Line(follower, remote, remote_start, places)


def _expectations(reader: Reader) -> tuple[Expectation, ...]:
    """The expectations of the follower. Enumerations other than `state` are refused: libcosim cannot read them."""
    found = reader.expectations()
    for table, e in zip(reader.top.tables("expect"), found, strict=True):
        for name in expected_names(e):
            if reader.recipe.variables[name].choices and name != "state":
                table.fail(name, "is an enumeration: in a line, expect its code or something else")
    return found


def _pieces(reader: Reader, unit: str) -> PieceSpec:
    """How the pieces of the follower are checked."""
    spec, table = reader.pieces(unit), reader.top.table("cuts")
    if given := [key for key in ("lengths", "kinds") if key in table]:
        table.fail(given[0], "in a line each product is compared with its ordered length: give tolerance and count")
    return spec


def _places(top: Table, recipe: Recipe) -> float | None:
    """How far a transition of the follower may be from its place; None: this is not checked."""
    if "switches" not in top:
        return None
    table = top.table("switches")
    table.allow_only("tolerance")
    if missing := [name for name in RAMP if name not in recipe.variables]:
        table.fail("", f"{recipe.name} is not switched on and off: it has no {missing[0]}")
    return table.number("tolerance", above=0.0)


def _remote(reader: Reader, step_size: float) -> tuple[Remote, Mapping[str, Any]]:
    """The remote axis, and RemoteSync's start values.

    RemoteSync's cycle is the step of the line, and the follower sees RemoteSync's outputs one step later."""
    assert reader.axis
    if "accuracy" in reader.axis_table:
        reader.axis_table.fail("accuracy", "a line is judged by [cuts], [switches] and [[expect]]")
    given = reader.start("remote_sync")
    cycle, delay = reader.axis.task_cycle, reader.axis.delay
    for name, reason in ((cycle, "is the line's step_size"), (ENABLE, "is set by the line itself")):
        if name in given:
            reader.top.table("remote_sync").fail(name, reason)
    start = {cycle: step_size, delay: step_size} | given
    return reader.remote(reader.script(), start, ()), start
