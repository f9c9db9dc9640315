"""motionsync sweep"""

import json
import shlex
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from ..errors import UserError
from ..extras import need
from ..pages.console import out
from ..pages.progress import Count, counting, doing
from ..scenario.shipped import called, find_one
from .options import Sampling, Scheduler, Seed, Workers, Yes

if TYPE_CHECKING:
    from ..sweep.plan import SweepPlan
    from ..sweep.summary import Summary


def sweep(
    path: Annotated[Path, typer.Argument(metavar="SCENARIO", help="A scenario's file or folder, or its short name.")],
    output: Annotated[Path, typer.Option(metavar="DIR", help="The folder for the rows and the plan.")],
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUES", help="What varies, and how; may be repeated."),
    ] = None,
    samples: Annotated[int | None, typer.Option(metavar="N", help="How many samples ranges have.")] = None,
    method: Sampling = "lhs",
    seed: Seed = 0,
    measure: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=KINDS", help="Figures of an output over a whole run; may be repeated."),
    ] = None,
    scheduler: Scheduler = "",
    workers: Workers = None,
    chunk: Annotated[
        int | None, typer.Option(metavar="RUNS", help="Runs in a part file; by default, those of some seconds.")
    ] = None,
    yes: Yes = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Run a scenario with many values, on all cores or many computers, and write a row about each run.

    Each --set varies a start value, an input, or a number of the scenario's script:

    \b
        --set master.velocity=200:400:11          11 values from 200 to 400
        --set cuts.length=500,600,800             these values
        --set axis.max_jerk=1e5..1e6              a range, which is sampled; needs --samples
        --set axis.max_deceleration=axis.max_acceleration
                                                  what follows from others

    All combinations of values are run, each with every sample of the ranges. A row has the values, whether all was as
    the scenario expects, a refusal, the cuts and their worst error, limits that were broken, faults, and each
    --measure NAME=KINDS: last, min, max, min_time, max_time, mean, rms, rises, above:LIMIT.

    The rows go to DIR as Parquet files, a chunk of runs each, beside the sweep's plan. After an interruption the same
    command goes on with what is missing. Workers of other computers (dask worker ADDRESS --nthreads 1) need the same
    version of motionsync, and nothing else: what they cannot write to DIR they send back.

    The exit status is 0 when all runs have their rows, whatever stands in these.

    Examples:

        motionsync sweep FlyingSaw/cyclic_cut --set master.velocity=100:500:41 --output out

        motionsync sweep CutToLength/basic_cut --set length=300..3000 --set axis.max_jerk=1e5..1e6 --samples 100000 \
--measure slave.acceleration=max --output out
    """
    need("sweep", "distributed", "pyarrow", "scipy")
    from ..sweep.rows import rows
    from ..sweep.spread import go
    from ..sweep.summary import summary
    from ..sweep.table import Rows

    plan = _plan(path, setting or [], samples, method, seed, measure or [], chunk, yes)
    with counting(f"sweeping {called(plan.file)}", "runs") as count:
        pace = _Pace(count)
        plan = go(plan, output, rows, scheduler=scheduler, workers=workers, progress=pace, tell=count.tell)
        pace.stop()
    with doing("reading the rows", at_once=False):
        told = summary(Rows(output))
    if as_json:
        print(json.dumps({**told.as_json(), "now": pace.runs, "runs_per_second": pace.rate, "folder": str(output)}))
    else:
        _print(told, plan, output, pace)


@dataclass
class _Pace:
    """How many runs this command has done, and how fast: those that were there before do not count.

    Attributes:
        runs: done by this command.
        begin: when it began (s, of the monotonic clock).
        took: how long all of it took (s).
    """

    count: Count
    runs: int = 0
    before: int | None = None
    begin: float = field(default_factory=monotonic)
    took: float = 0.0

    def __call__(self, done: int, whole: int) -> None:
        if self.before is None:
            self.before = done
        self.runs = done - self.before
        self.count(done, whole)

    def stop(self) -> None:
        """Take the time: all is done."""
        self.took = monotonic() - self.begin

    @property
    def rate(self) -> float:
        """Runs per second."""
        return self.runs / self.took


def _plan(
    path: Path,
    settings: list[str],
    samples: int | None,
    method: str,
    seed: int,
    measures: list[str],
    chunk: int | None,
    yes: bool,
) -> "SweepPlan":
    """The plan that the options make.

    Raises:
        UserError: an option, or what they make together, is refused.
    """
    from ..errors import choose
    from ..scenario.reader import load
    from ..sweep.measures import parsed
    from ..sweep.plan import SweepPlan
    from ..sweep.samples import Method

    if chunk is not None and chunk < 1:
        raise UserError(f"--chunk {chunk} is not allowed: it must be >= 1")
    file = find_one(path)
    return SweepPlan.of(
        file,
        settings,
        samples=samples,
        method=choose({str(m): m for m in Method}, method, "method"),
        seed=seed,
        measures=parsed(measures, load(file).recipe) if measures else {},
        chunk=chunk or 0,
        yes=yes,
    )


def _print(told: "Summary", plan: "SweepPlan", folder: Path, pace: _Pace) -> None:
    """Print the summary, and the command that shows the rows."""
    out.print(f"{told.runs:,} runs of {escape(called(plan.file))}")
    for what, number in told.counts().items():
        out.print(f"  {what:24}{number:>14,}  {number / told.runs:7.2%}")
    if pace.runs:
        out.print(f"{pace.runs:,} of them now, {pace.rate:,.4g} runs/s")
    out.print(f"rows: {escape(str(folder))}")
    out.print(f"see them: {escape(_plot_command(plan, folder))}")


def _plot_command(plan: "SweepPlan", folder: Path) -> str:
    """The command that shows the rows: over the first two numbers that vary, or what came out over the only one."""
    from ..sweep.rows import schema

    values = plan.values(0, 1)
    x, *more = [name for name in plan.independent if values[name].dtype.kind in "if"] or ["run"]
    y = next(iter(more), "cut_error" if "cut_error" in schema(plan).names else "passed")
    return shlex.join(["motionsync", "sweep-plot", str(folder), "--x", x, "--y", y, "--open"])
