"""motionsync sweep"""

import json
import shlex
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from motionsync.var import Unit

from ..errors import UserError
from ..interface.units import unit_name
from ..optional_dependencies import require
from ..pages.console import out
from ..pages.progress import CountReport, report_count, report_progress
from ..scenario.files.shipped import find_scenario, scenario_name
from .options import Sampling, Scheduler, Seed, Workers, Yes, parse_factors

if TYPE_CHECKING:
    from ..sweeps.summary import Summary
    from ..sweeps.sweep_plan import SweepPlan


def command(
    path: Annotated[Path, typer.Argument(metavar="SCENARIO", help="A scenario's file or folder, or its short name.")],
    output: Annotated[Path, typer.Option(metavar="DIR", help="The folder for the rows and the plan.")],
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUES", help="A value to vary, and how; may be repeated."),
    ] = None,
    samples: Annotated[int | None, typer.Option(metavar="N", help="How many samples are drawn from ranges.")] = None,
    method: Sampling = "lhs",
    seed: Seed = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=KINDS", help="Figures of an output over a whole run; may be repeated."),
    ] = None,
    scheduler: Scheduler = "",
    workers: Workers = None,
    chunk: Annotated[
        int | None, typer.Option(metavar="RUNS", help="Runs in a part file; by default, as many as take some seconds.")
    ] = None,
    yes: Yes = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Run a scenario with many values, on all cores or many computers, and write a row about each run.

    Each --set varies a start value, an input, or a number of the scenario's script:

    \b
        --set master.velocity=200:400:11          11 values from 200 to 400
        --set encoder.seed=0:999                  the whole numbers from 0 to 999
        --set cuts.length=500,600,800             these values
        --set axis.max_jerk=1e5..1e6              a range, which is sampled; needs --samples
        --set axis.max_deceleration=axis.max_acceleration
                                                  a value that follows from others

    All combinations of values are run, each with every sample of the ranges. A row has the values, whether the
    expectations of the scenario are met, a refusal, the cuts and their worst error, limits that were broken, faults,
    and each --measure NAME=KINDS: last, min, max, min_time, max_time, mean, rms, rises, above:LIMIT.

    The rows are written to DIR as Parquet files, a chunk of runs each, together with the sweep's plan. After an
    interruption the same command does the missing runs. Workers on other computers (dask worker ADDRESS --nthreads 1)
    need only the same version of motionsync: rows that they cannot write to DIR they send back.

    The exit status is 0 when all runs have their rows, whatever the rows contain.

    Examples:

        motionsync sweep FlyingSaw/cyclic_cut --set master.velocity=100:500:41 --output out

        motionsync sweep CutToLength/any_length --set length=300..3000 --set axis.max_jerk=1e5..1e6 --samples 100000 \
--measure slave.acceleration=max --output out
    """
    require("sweep", "distributed", "pyarrow", "scipy")
    from ..api.sweep import sweep
    from ..sweeps.measures import parse_texts
    from ..sweeps.summary import summarize
    from ..sweeps.sweep_plan import SamplingOptions

    if chunk is not None and chunk < 1:
        raise UserError(f"--chunk {chunk} is not allowed: it must be >= 1")
    file = find_scenario(path)
    options: SamplingOptions = {"samples": samples, "method": method, "seed": seed, "yes": yes}
    options["measures"] = parse_texts(measure or ())
    factors = parse_factors(setting or [])
    with report_count(f"sweeping {scenario_name(file)}", "runs") as count:
        rate = _RunRate(count)
        rows = sweep(
            file,
            set=factors,
            output=output,
            workers=workers,
            scheduler=scheduler,
            chunk=chunk or 0,
            progress=rate,
            notify=count.notify,
            **options,
        )
        rate.stop()
    with report_progress("reading the rows", at_once=False):
        totals = summarize(rows)
    if as_json:
        speed = {"now": rate.runs, "runs_per_second": rate.runs_per_second}
        print(json.dumps({**totals.as_json(), **speed, "folder": str(output)}))
    else:
        _print_summary(totals, rows.plan, output, rate)


@dataclass
class _RunRate:
    """How many runs this command has done, and how fast.

    Attributes:
        runs: the runs of this command.
        earlier: the runs of earlier commands; None: not yet reported.
        start: the time of the start (s, of the monotonic clock).
        duration: the time that all runs of this command took (s).
    """

    count: CountReport
    runs: int = 0
    earlier: int | None = None
    start: float = field(default_factory=monotonic)
    duration: float = 0.0

    def __call__(self, done: int, total: int) -> None:
        if self.earlier is None:
            self.earlier = done
        self.runs = done - self.earlier
        self.count(done, total)

    def stop(self) -> None:
        self.duration = monotonic() - self.start

    @property
    def runs_per_second(self) -> float:
        return self.runs / self.duration


def _print_summary(totals: "Summary", plan: "SweepPlan", folder: Path, rate: _RunRate) -> None:
    """Print the summary, and the command that shows the rows."""
    out.print(f"{totals.runs:,} runs of {escape(scenario_name(plan.file))}")
    for name, number in totals.counts().items():
        out.print(f"  {name:24}{number:>14,}  {number / totals.runs:7.2%}")
    for line in totals.reason_lines:
        out.print(f"  first not met in {escape(line)}")
    for line in totals.true_length_lines(unit_name(Unit.POSITION, plan.variation.scenario.unit)):
        out.print(f"  {escape(line)}")
    if rate.runs:
        out.print(f"{rate.runs:,} of them now, {rate.runs_per_second:,.4g} runs/s")
    out.print(f"rows: {escape(str(folder))}")
    out.print(f"plot them: {escape(_plot_command(plan, folder))}")


def _plot_command(plan: "SweepPlan", folder: Path) -> str:
    """The command that plots the rows over the first two numbers that vary, or a result over the only one. If only the
    seeds of random numbers vary, it shows how the true lengths are distributed."""
    from ..scenario.variation.values import is_seed
    from ..sweeps.result_columns import TRUE_LENGTH_ERRORS, schema

    values, names = plan.values(0, 1), schema(plan).names
    numbers = [name for name in plan.independent if values[name].dtype.kind in "if"]
    varied = [name for name in numbers if not is_seed(name)]
    if numbers and not varied and TRUE_LENGTH_ERRORS in names:
        axes = ["--x", TRUE_LENGTH_ERRORS]
    else:
        results = (name for name in ("true_length_sigma", "cut_error", "passed") if name in names)
        x, y, *_ = *(varied or numbers or ["run"]), *results
        axes = ["--x", x, "--y", y]
    return shlex.join(["motionsync", "sweep-plot", str(folder), *axes, "--open"])
