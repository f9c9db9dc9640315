"""Scenario files, read from TOML and checked against the block.

Every mistake is one `UserError` that starts with file and line and names the key.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from motionsync.blocks import BLOCKS

from ...errors import UserError
from ...interface.causality import CausalityError, Interface
from ...interface.recipe import Recipe, check_slave_unit, default_slave_unit
from ...interface.roles import remote_axis
from ...interface.units import BASES
from ..computed_columns import computed_variables
from ..cutting import CutSpec, PieceSpec, usual_tolerance
from ..drive import Drive
from ..encoder import Encoder
from ..load import Load
from ..remote_view import RemoteView
from ..scenario import Expectation, Picture, Scenario
from ..script import Script, Segment
from ..servo import Servo
from ..settings import Reaction, Setting
from .axis_tables import read_load, read_servo
from .drive_table import DRIVE, read_drive
from .encoder_table import read_encoder, with_encoder
from .expect_tables import read_expectation
from .quantities import resolve_quantities
from .reaction_tables import read_reaction
from .remote_table import LISTS, REMOTE, read_remote
from .tables import CONSTANT, CUTS, INTERFACE, PICTURE, PIECES, SCRIPT, SEGMENT, TOP
from .toml_tables import TomlTable, read_text, read_toml
from .trace_file import KEY as RECORDED_KEY
from .trace_file import RECORDED, read_trace
from .variable_tables import FlagTable, OutputTable, SetTable, StartTable, Subject

REAL = ("encoder", "servo", "load")  # what a real line has, and an ideal one has not
TABLES = ("interface", "start", "master", "remote", *REAL, "set", "on", "expect", "cuts", "picture")
PERIOD = "master.period"
BRACED = ("segments", *LISTS)  # lists of tables in braces
MOST_STEPS = 1_000_000  # their results still fit into memory


def load_scenario(file: Path) -> Scenario:
    """Read and check a scenario file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    return read_scenario(resolved(read_file(file)))


def read_scenario_text(text: str, file: Path) -> Scenario:
    """Check a scenario file with this text.

    Raises:
        UserError: as `load_scenario`.
    """
    return read_scenario(read_tables(text, file))


def read_tables(text: str, file: Path) -> TomlTable:
    """The top level of a scenario file with this text, without units at its numbers.

    Raises:
        UserError: the text is not TOML, or a mistake in the block's name or in a unit.
    """
    return resolved(read_text(text, file, BRACED))


def resolved(top: TomlTable) -> TomlTable:
    """The top level of a scenario file with numbers in the scenario's units in place of numbers with a unit.

    Raises:
        UserError: a mistake in the block's name or in a unit.
    """
    name, unit, slave_unit = read_block(top)
    return resolve_quantities(top, Recipe(name).variables, unit, slave_unit)


def read_scenario(
    top: TomlTable, make_reader: "Callable[[TomlTable, str, float], BlockReader] | None" = None
) -> Scenario:
    """Check the top level of a scenario file.

    `make_reader`: makes the reader of the block's tables, as `BlockReader` does, from top level, block and stop time.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    top.allow_only(*TOP.names, *TABLES)
    name, unit, slave_unit = read_block(top)
    stop_time, step_size = read_times(top)
    reader = (make_reader or BlockReader)(top, name, stop_time)
    reader.check_axis()
    start, script, settings, encoder = reader.start(), reader.script(), reader.settings(), reader.encoder()
    return Scenario(
        file=top.file,
        text=top.text,
        title=TOP.value(top, "title"),
        source=TOP.value(top, "source"),
        recipe=reader.recipe,
        unit=unit,
        slave_unit=slave_unit,
        stop_time=stop_time,
        step_size=step_size,
        scan=step_size,
        tolerance=TOP.value(top, "tolerance"),
        start=with_encoder(start, encoder, reader.recipe.variables) if encoder else start,
        master=script,
        encoder=encoder,
        remote=reader.remote(script, start, settings) if reader.axis else None,
        settings=settings,
        expectations=reader.expectations(),
        cuts=reader.cuts(unit) if "cuts" in top and not reader.piece_variables else None,
        pieces=reader.pieces(unit) if "cuts" in top and reader.piece_variables else None,
        picture=reader.picture(),
        reactions=reader.reactions(),
        drive=None if reader.axis else reader.drive(),
        servo=reader.servo(),
        load=reader.load(slave_unit or unit),
        step_bound=TOP.value(top, "step_bound"),
    )


def read_file(file: Path) -> TomlTable:
    """The top level of a scenario file, or of a file with the same tables."""
    return read_toml(file, BRACED)


def read_block(top: TomlTable) -> tuple[str, str, str]:
    """The block's name, the unit of positions, and that of the slave's positions (empty: the same)."""
    name = TOP.value(top, "fmu")
    if name not in BLOCKS:
        top.fail("fmu", f"no block is named {name!r}; there is {', '.join(BLOCKS)}")
    unit = TOP.value(top, "unit")
    if unit not in BASES:
        top.fail("unit", f"{unit!r} is not one of {', '.join(BASES)}")
    if slave_unit := TOP.value(top, "slave_unit"):
        try:
            check_slave_unit(BLOCKS[name](), slave_unit)
        except UserError as error:
            top.fail("slave_unit", str(error))
    return name, unit, slave_unit or default_slave_unit(BLOCKS[name])


def read_times(top: TomlTable) -> tuple[float, float]:
    """stop_time and step_size, in s."""
    stop_time = TOP.value(top, "stop_time")
    step_size = TOP.value(top, "step_size", most=stop_time)
    if stop_time / step_size > MOST_STEPS:
        top.fail("step_size", f"{step_size:g} makes more than {MOST_STEPS:,} steps up to {stop_time:g}")
    return stop_time, step_size


def read_interface(top: TomlTable, name: str) -> Interface:
    """The variables whose causality is overridden; `name`: the block's name."""
    table = top.table("interface", required=False)
    INTERFACE.check(table)
    interface = Interface(**{key: table.strings(key) for key in INTERFACE.names})
    try:
        interface.causalities(BLOCKS[name]())
    except CausalityError as error:
        table.fail(error.causality, error.reason)
    return interface


class BlockReader:
    """Reads the tables of a file that concern one block.

    Attributes:
        recipe: the block's FMU.
        axis: the block's remote axis; None: the block has a master.
        piece_variables: the variables by which the block reports its pieces; None: it does not.
        columns: what may be expected: the block's variables, and the columns that are computed after the run.
    """

    def __init__(self, top: TomlTable, name: str, stop_time: float, origin: str = "") -> None:
        """`origin`: where the inputs of the scripted axis come from, in words; empty: from the script of the axis."""
        self.top = top
        self.stop_time = stop_time
        self.recipe = Recipe(name, interface=read_interface(top, name))
        self.axis = remote_axis(self.recipe.variables.values())
        self.piece_variables = self.recipe.piece_variables
        self.scripted = "remote" if self.axis else "master"
        part = self.axis.part if self.axis else "master"
        self.block = Subject(name, self.recipe.variables, part, origin or f"the script in [{self.scripted}]")
        self.columns = {**self.recipe.variables, **computed_variables(servo="servo" in top, load="load" in top)}

    def check_axis(self) -> None:
        """Refuse the script of an axis that the block does not have."""
        other = "master" if self.axis else "remote"
        for key in (other, "encoder") if self.axis else (other,):
            if key in self.top:
                inputs = f"{self.block.name} has no inputs {other}.*"
                self.top.fail(key, f"{inputs}: its axis is scripted in [{self.scripted}]")

    def start(self, key: str = "start") -> dict[str, Any]:
        """The start values in the table of this name."""
        return StartTable(self.top.table(key, required=False), self.block).values()

    @property
    def axis_table(self) -> TomlTable:
        """The table that scripts the axis."""
        return self.top.table(self.scripted)

    def script(self) -> Script:
        table = self.axis_table
        table.allow_only(*SCRIPT.names, *(REMOTE.names if self.axis else (*DRIVE.names, *RECORDED.names)))
        if RECORDED_KEY in table:
            return read_trace(table, self.top.table("start", required=False).values.get(PERIOD, 0.0), self.stop_time)
        p, v, a = (SCRIPT.value(table, key) for key in ("position", "velocity", "acceleration"))
        return Script(p, v, a, [_read_segment(t) for t in table.tables("segments", "{ duration = ..., ... }")])

    def remote(self, script: Script, start: dict[str, Any], settings: tuple[Setting, ...]) -> RemoteView:
        """How the block sees the scripted axis; `start`: the block's start values."""
        assert self.axis
        values = {name: v.start for name, v in self.recipe.variables.items()} | start
        return read_remote(self.axis_table, script, self.axis, values, settings, self.stop_time)

    def drive(self) -> Drive | None:
        """What moves the master; None: it is scripted."""
        return read_drive(self.axis_table, self.block)

    def encoder(self) -> Encoder | None:
        """What is between the true master and the inputs; None: the inputs are the true motion."""
        if not self.axis and RECORDED_KEY in self.axis_table:
            if "encoder" in self.top:
                self.top.fail("encoder", "a recorded line has been measured already: leave out [encoder]")
            return Encoder()
        return read_encoder(self.top.table("encoder")) if "encoder" in self.top else None

    def settings(self) -> tuple[Setting, ...]:
        return tuple(map(self._read_setting, self.top.tables("set")))

    def _read_setting(self, table: TomlTable) -> Setting:
        at = table.number("at")
        if at <= 0.0:
            table.fail("at", f"{at:g}: what is set at 0 is a start value (no edge); write it in [start]")
        if at >= self.stop_time:
            table.fail("at", f"{at:g} is not before stop_time = {self.stop_time:g}: no step would show it")
        values = SetTable(table, self.block).values("at")
        if not values:
            table.fail("at", "sets nothing")
        return Setting(at, values)

    def reactions(self) -> tuple[Reaction, ...]:
        length = self.top.table("cuts", required=False).values.get("length")
        return tuple(self._read_reaction(table, length) for table in self.top.tables("on"))

    def _read_reaction(self, table: TomlTable, length: Any) -> Reaction:
        reaction = read_reaction(table, self.block, self.stop_time, length)
        if self.axis and self.axis.delay in {*reaction.set, *reaction.add}:
            table.fail("when", f"{self.axis.delay} changes at given times only: set it in [[set]]")
        return reaction

    def expectations(self) -> tuple[Expectation, ...]:
        expected = replace(self.block, variables=self.columns)
        return tuple(read_expectation(table, expected, self.stop_time) for table in self.top.tables("expect"))

    def servo(self) -> Servo | None:
        """What is between the setpoint and the tool."""
        return read_servo(self.top.table("servo")) if "servo" in self.top else None

    def load(self, unit: str) -> Load | None:
        """What the slave's axis moves; `unit`: that of its positions."""
        return read_load(self.top.table("load"), unit) if "load" in self.top else None

    def cuts(self, unit: str) -> CutSpec:
        """How cuts are detected and checked; `unit`: the unit of positions."""
        table = self.top.table("cuts")
        CUTS.check(table)
        name = CUTS.value(table, "while")
        FlagTable(table, self.block).variable(name, "while")
        if period := self.top.table("start", required=False).values.get("master.period"):
            table.fail("", f"the material is a linear axis, but master.period is {period:g}")
        values = CUTS.read(table)
        if values["ratio"] == 0.0:
            table.fail("ratio", "0 is not allowed: the saw moves along with the material")
        del values["while"]
        if values["tolerance"] is None:
            values["tolerance"] = usual_tolerance(unit, values["length"])
        return CutSpec(name, **values)

    def pieces(self, unit: str) -> PieceSpec:
        """How the pieces are checked that the block reports; `unit`: the unit of positions."""
        assert self.piece_variables
        table = self.top.table("cuts")
        if needless := [key for key in ("while", "length", "offset", "ratio") if key in table]:
            table.fail(
                needless[0],
                f"is not needed: {self.block.name} itself reports where it cuts, and how long each piece is",
            )
        values = PIECES.read(table)
        if BASES[unit][0] != "m" and "tolerance" not in table:
            table.fail("tolerance", f"is missing: in {unit} there is no usual one")
        available = [str(member.name) for member in self.recipe.variables[self.piece_variables.kind].choices]
        kinds = table.strings("kinds") if "kinds" in table else None
        if unknown := [kind for kind in kinds or () if kind not in available]:
            table.fail("kinds", f"{unknown[0]!r} is no kind of piece; there is {', '.join(available)}")
        if values["tolerance"] is None:
            values["tolerance"] = usual_tolerance(unit, 0.0)
        lengths = table.numbers("lengths") if "lengths" in table else None
        return PieceSpec(lengths=lengths, kinds=kinds, **values)

    def picture(self) -> Picture:
        table = self.top.table("picture", required=False)
        PICTURE.check(table)
        if shaded := PICTURE.value(table, "shaded"):
            FlagTable(table, self.block).variable(shaded, "shaded")
        labels = table.table("curves", required=False)
        curves = {OutputTable(labels, self.block).variable(name).name: labels.string(name) for name in labels.values}
        variants = table.table("variants", required=False)
        starts = {name: StartTable(variants.table(name), self.block).values() for name in variants.values}
        return Picture(shaded, curves, starts)


def _read_segment(table: TomlTable) -> Segment:
    SEGMENT.check(table)
    duration = SEGMENT.value(table, "duration")
    given = [key for key in CONSTANT if key in table]
    if len(given) > 1:
        table.fail(given[1], f"a segment holds at most one of {', '.join(CONSTANT)}, not {given}")
    return Segment(duration, **{key: SEGMENT.value(table, key) for key in given})
