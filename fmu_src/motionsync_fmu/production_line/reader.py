"""Reads line files. The follower is described like a scenario whose master is the true axis, with the same messages."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..interface.recipe import Recipe
from ..scenario.cutting import PieceSpec
from ..scenario.files.reader import BlockReader, read_block, read_file, read_times
from ..scenario.files.tables import TOP
from ..scenario.files.toml_tables import TomlTable
from ..scenario.remote_view import RemoteView
from ..scenario.scenario import Expectation, Scenario
from .line import ENABLE, RAMP, REMOTE, ProductionLine

TABLES = ("remote", "remote_sync", "start", "set", "expect", "cuts", "switches")


def load_line(file: Path) -> ProductionLine:
    """Read and check a line file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    top = read_file(file)
    if "on" in top:
        top.fail("on", "a line cannot react: its importers get all inputs before the run; give times in [[set]]")
    top.allow_only(*TOP.without("tolerance", "step_bound").names, *TABLES)
    name, unit, slave_unit = read_block(top)
    stop_time, step_size = read_times(top)
    reader = BlockReader(top, name, stop_time, REMOTE)
    if reader.axis:
        top.fail("fmu", f"{name} sees telegrams itself: name the block that follows it")
    start, settings, expectations = reader.start(), reader.settings(), _read_expectations(reader)
    cuts = reader.cuts(unit) if "cuts" in top and not reader.piece_variables else None
    pieces = _read_pieces(reader, unit) if "cuts" in top and reader.piece_variables else None
    switch_tolerance = _read_switch_tolerance(top, reader.recipe)
    remote, remote_start = _read_remote(BlockReader(top, REMOTE, stop_time), step_size)
    follower = Scenario(
        file=file,
        text=top.text,
        title=TOP.value(top, "title"),
        source=TOP.value(top, "source"),
        recipe=reader.recipe,
        unit=unit,
        slave_unit=slave_unit,
        stop_time=stop_time,
        step_size=step_size,
        scan=step_size,
        start=start,
        master=remote.axis,
        settings=settings,
        expectations=expectations,
        cuts=cuts,
        pieces=pieces,
    )
    return ProductionLine(follower, remote, remote_start, switch_tolerance)


def _read_expectations(reader: BlockReader) -> tuple[Expectation, ...]:
    """The expectations of the follower. Enumerations other than `state` are refused: libcosim cannot read them."""
    expectations = reader.expectations()
    for table, e in zip(reader.top.tables("expect"), expectations, strict=True):
        for name in e.names:
            if reader.recipe.variables[name].choices and name != "state":
                table.fail(name, "is an enumeration: in a line, expect its code or something else")
    return expectations


def _read_pieces(reader: BlockReader, unit: str) -> PieceSpec:
    """How the pieces of the follower are checked."""
    spec, table = reader.pieces(unit), reader.top.table("cuts")
    if refused := [key for key in ("lengths", "kinds") if key in table]:
        table.fail(refused[0], "in a line each product is compared with its ordered length: give tolerance and count")
    if spec.skipped:
        table.fail("skipped", f"{spec.skipped} is not allowed: in a line no cut may be skipped")
    return spec


def _read_switch_tolerance(top: TomlTable, recipe: Recipe) -> float | None:
    """How far a transition of the follower may be from its position; None: this is not checked."""
    if "switches" not in top:
        return None
    table = top.table("switches")
    table.allow_only("tolerance")
    if missing := [name for name in RAMP if name not in recipe.variables]:
        table.fail("", f"{recipe.name} is not switched on and off: it has no {missing[0]}")
    return table.number("tolerance", above=0.0)


def _read_remote(reader: BlockReader, step_size: float) -> tuple[RemoteView, Mapping[str, Any]]:
    """The remote axis, and RemoteSync's start values.

    RemoteSync's cycle is the step of the line, and the follower sees RemoteSync's outputs one step later."""
    assert reader.axis
    if "accuracy" in reader.axis_table:
        reader.axis_table.fail("accuracy", "a line is checked by [cuts], [switches] and [[expect]]")
    start = reader.start("remote_sync")
    cycle, delay = reader.axis.task_cycle, reader.axis.delay
    for name, reason in ((cycle, "is the line's step_size"), (ENABLE, "is set by the line itself")):
        if name in start:
            reader.top.table("remote_sync").fail(name, reason)
    start = {cycle: step_size, delay: step_size} | start
    return reader.remote(reader.script(), start, ()), start
