"""What `motionsync run` does with a scenario."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError, choose
from ..fmus.fmu import Flavour, ignore
from ..fmus.prebuilt import prepare_fmus, select_flavours
from ..interface.recipe import Fmi
from ..optional_dependencies import require
from ..pages.report.page import write_report
from ..pages.results import write_results
from ..pages.run_view import view_run
from ..pages.summary import figure_rows
from ..paths import replace_file
from ..scenario.evaluate.axis_figures import LoadFigures
from ..scenario.evaluate.csv_files import csv_text, output_columns
from ..scenario.evaluate.find_pieces import Piece
from ..scenario.evaluate.outcome import ScenarioOutcome, evaluate_run
from ..scenario.evaluate.reference_comparison import reference_file
from ..scenario.evaluate.true_pieces import TruePieces
from ..scenario.recording import Reals, Recording
from ..scenario.run.simulation import simulate
from ..scenario.scenario import Scenario
from .frame import frame
from .scenario_source import Source, Value, load
from .shown import shown

if TYPE_CHECKING:
    import pyarrow as pa


def run(
    scenario: Source,
    *,
    set: Mapping[str, Value] | None = None,
    step_size: float | None = None,
    flavour: str | None = None,
    fmi: str = "2",
) -> RunResult:
    """Run a scenario through its FMU, and compare it with its expectations and its reference.

    An FMU that is missing or stale is built first, in the user's cache.

    Args:
        scenario: its file or folder, its short name (`"CutToLength/basic_cut"`), a mapping with the keys of a
            scenario's file, or a loaded scenario.
        set: variables of the block, or numbers of the scenario, in place of what the scenario has, by name:
            `{"master.velocity": 400.0}`. The reference is not compared then.
        step_size: in s, in place of the scenario's own.
        flavour: `"native"` or `"python"`; by default the native one, if it can be compiled here.
        fmi: the version of FMI, `"2"` or `"3"`.

    Raises:
        UserError: there is no such scenario, something in it or in an argument is not allowed, or the FMU refused a
            value; the text is what the command line prints.
    """
    version = choose({str(v): v for v in Fmi}, fmi, "version of FMI")
    chosen = [choose({str(f): f for f in Flavour}, flavour, "flavour")] if flavour else []
    loaded = load(scenario, set=set, step_size=step_size)
    flavours = select_flavours(version, chosen, ignore)
    (fmu,) = prepare_fmus([replace(loaded.recipe, fmi=version)], flavours[0], shown())
    recording = simulate(loaded, fmu, loaded.step_size)
    return RunResult(loaded, recording, fmu, evaluate_run(loaded, recording))


@dataclass(frozen=True, repr=False)
class RunResult:
    """The outputs of a run, and how they compare with what is expected.

    `result[name]` has a column over time, of shape (points,): an output or local variable of the block, a column that
    is computed after the run (`actual.slave.position`), or the scripted axis (`master.position`). Its unit is that of
    the variable.

    Attributes:
        scenario: what was run.
        recording: the outputs at the communication points.
        fmu: the FMU that ran it.
        outcome: the figures of the run, and each expectation with what was found.
    """

    scenario: Scenario
    recording: Recording
    fmu: Path
    outcome: ScenarioOutcome

    @property
    def passed(self) -> bool:
        """Whether everything is as expected."""
        return self.outcome.passed

    @property
    def notes(self) -> list[str]:
        """What a reader should know although no check fails by it, a sentence each."""
        return self.outcome.notes

    @property
    def messages(self) -> list[str]:
        """What the FMU logged."""
        return self.recording.messages

    @property
    def pieces(self) -> list[Piece]:
        """The pieces that the block reported, in the sequence of their cuts; empty for a block that reports none."""
        production = self.outcome.figures.production
        return [*production.pieces] if production else []

    @property
    def true_pieces(self) -> TruePieces | None:
        """The pieces as a tape measure finds them (`.pieces`), and the spread of their lengths; None: the scenario's
        line is exact, or nothing is cut."""
        return self.outcome.figures.true_pieces

    @property
    def load(self) -> LoadFigures | None:
        """What the motor has to give; None: the scenario has no table [load]."""
        return self.outcome.figures.load

    @property
    def time(self) -> Reals:
        """The communication points, of shape (points,), in s."""
        return self.recording.time

    @cached_property
    def columns(self) -> dict[str, Reals]:
        """All columns by name, as in the CSV file of `motionsync run`, each of shape (points,)."""
        return output_columns(self.scenario, self.recording)

    def __getitem__(self, name: str) -> Reals:
        """The column of this name.

        Raises:
            UserError: there is none; the message has similar names.
        """
        return choose(self.columns, name, "column")

    def to_frame(self) -> pa.Table:
        """All columns as a table of pyarrow, which pandas and polars take; Booleans are Booleans.

        Raises:
            UserError: pyarrow is not installed.
        """
        require("sweep", "pyarrow")
        import pyarrow as pa  # noqa: PLC0415 (part of an extra)

        declared = self.scenario.columns
        types = {"Real": "float64", "Boolean": "bool"}
        kinds = {name: declared[name].kind if name in declared else "Real" for name in self.columns}
        return pa.table({name: c.astype(types.get(kinds[name], "int64")) for name, c in self.columns.items()})

    def report(self, file: str | Path) -> Path:
        """Write the run's HTML page, which needs no network, and return its path."""
        page = Path(file)
        with replace_file(page) as part:
            write_report(part, self.scenario, self.recording, self.outcome, self.fmu)
        return page

    def write(self, folder: str | Path, *, report: bool = True) -> ScenarioOutcome:
        """Write the outputs as CSV, the inputs for FMPy and the page into a folder, as `motionsync run` does.

        The outcome that is returned names the files.
        """
        return write_results(self.outcome, self.scenario, self.recording, self.fmu, Path(folder), report=report)

    def write_reference(self, *names: str) -> Path:
        """Write columns beside the scenario's file, as the reference of its later runs; return the file.

        `run` compares each later run with it, and fails a variable that is further off than the file's `tolerance`
        allows. Look at the run first.

        Args:
            names: outputs or local variables; by default the slave's position and velocity.

        Raises:
            UserError: there is no such variable, or the run is not that of a scenario's file with its own values.
        """
        scenario = self.scenario
        if scenario.overrides or scenario.step_size != scenario.scan or not scenario.file.is_file():
            raise UserError(f"{scenario.label}: only a run of a scenario's file as it is can be its reference")
        listed = names or ("slave.position", "slave.velocity")
        columns = [choose(self.recording.columns, name, "variable with values over time") for name in listed]
        rows = zip(self.time.tolist(), *(column.tolist() for column in columns), strict=True)
        file = reference_file(scenario)
        with replace_file(file) as part:
            part.write_text(csv_text(["time", *listed], rows), "utf-8")
        return file

    def __repr__(self) -> str:
        """The figures of the run, a line each."""
        head = f"{self.scenario.label}: {'as expected' if self.passed else 'NOT as expected'}"
        rows = [f"  {name:<12}  {text}" for name, text in figure_rows(self.outcome)]
        return "\n".join([head, *(f"  ! {note}" for note in self.notes), *rows])

    def _repr_html_(self) -> str:
        """The verdict, the machine's picture, which moves, and the figures, in a frame of their own."""
        page = view_run(self.scenario, self.recording, self.outcome)
        return frame(page, self.scenario.title)
