"""Reads line files. The follower is described like a scenario whose master is the true axis, with the same messages."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..interface.recipe import Recipe
from ..interface.roles import remote_axis
from ..scenario.cutting import PieceSpec
from ..scenario.files.reader import BlockReader, read_block, read_file, read_scenario, read_times
from ..scenario.files.tables import TOP
from ..scenario.files.toml_tables import TomlTable
from ..scenario.remote_view import RemoteView
from ..scenario.scenario import Scenario
from .line import ENABLE, RAMP, REMOTE, ProductionLine

OWN = ("remote", "remote_sync", "switches")  # the tables of a line that a scenario of the follower does not have
TABLES = ("start", "set", "expect", "cuts")


def load_line(file: Path) -> ProductionLine:
    """Read and check a line file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    top = read_file(file)
    if "on" in top:
        top.fail("on", "a line cannot react: its importers get all inputs before the run; give times in [[set]]")
    top.allow_only(*TOP.without("tolerance", "step_bound").names, *TABLES, *OWN)
    name, _, _ = read_block(top)
    stop_time, step_size = read_times(top)
    if remote_axis(Recipe(name).variables.values()):
        top.fail("fmu", f"{name} sees telegrams itself: name the block that follows it")
    of_follower = {key: value for key, value in top.values.items() if key not in OWN} | {"master": {}}
    follower = read_scenario(top.with_values(of_follower), partial(BlockReader, origin=REMOTE))
    _check_expectations(top, follower)
    _check_pieces(top, follower.pieces)
    switch_tolerance = _read_switch_tolerance(top, follower.recipe)
    remote, start = _read_remote(BlockReader(top, REMOTE, stop_time), step_size)
    return ProductionLine(replace(follower, master=remote.axis), remote, start, switch_tolerance)


def _check_expectations(top: TomlTable, follower: Scenario) -> None:
    """Refuse enumerations other than `state`: libcosim cannot read them."""
    for table, e in zip(top.tables("expect"), follower.expectations, strict=True):
        for name in e.names:
            if follower.recipe.variables[name].choices and name != "state":
                table.fail(name, "is an enumeration: in a line, expect its code or something else")


def _check_pieces(top: TomlTable, spec: PieceSpec | None) -> None:
    """Refuse what a line does not check of the follower's pieces."""
    table = top.table("cuts", required=False)
    if spec and (refused := [key for key in ("lengths", "kinds") if key in table]):
        table.fail(refused[0], "in a line each product is compared with its ordered length: give tolerance and count")
    if spec and spec.skipped:
        table.fail("skipped", f"{spec.skipped} is not allowed: in a line no cut may be skipped")


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
