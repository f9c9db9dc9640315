"""What a step of the native flavour costs, beside a do-nothing FMU and the python flavour.

The do-nothing FMU is the block's own, which takes, checks and answers the same variables, but its block does nothing.
All are measured in one run, in turns, so that the ratios hold on a busy machine. A plain C host, without any Python,
drives the native unit and the do-nothing one; FMPy drives both flavours as well. The worst steps are
those at whose beginning commands are given: the modules in cases/ say which these are for each block, and which outputs
show that the commands were planned. A block with a master is also measured in each input mode of the master.

    python benchmarks/native_cost.py [--block FlyingSaw] [--steps 20000]
"""

import argparse
import json
import math
import platform
import statistics
import subprocess
import tempfile
import zipfile
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from cases import MEASURED, cases_of
from cases.measured import VELOCITY, Cases, H, MovingAxis, Steady, Worst
from cost import (
    OUTPUTS,
    ROUNDS,
    compile_c,
    cost_table,
    measure,
    ratio,
    start_case,
    through_fmpy,
    timed,
)
from rich.console import Console
from rich.table import Table

from motionsync_fmu.fmus.fmu import build, build_python
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.native.libraries import Compilation
from motionsync_fmu.native.platforms import PLATFORMS
from motionsync_fmu.native.unit_sources import c_sources
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance

FOLDER = Path(__file__).parent
PLATFORM = PLATFORMS["linux64"]
IN_C = 100  # a round of a C host has so many times the steps, since they are short
WORST = ("median_ns", "p999_ns", "slowest_ns", "undisturbed_ns")
IDLE, NATIVE, PYTHON = "do-nothing FMU", "native", "python"
IDLE_BLOCK = """
int64_t block_initialize(Block *self, bool *failed) { return 0; }
int64_t block_step(Block *self, double h, bool *failed) { return 0; }
"""
IN_C_HOST, FMPY = "C host: ", "FMPy: "


class CHost:
    """The C host in a process of its own, which gets its commands line by line (host.c lists them)."""

    def __init__(self, program: Path, library: Path, recipe: Recipe, axis: MovingAxis) -> None:
        self.variables = {v.name: (i, v.kind) for i, v in enumerate(variables(recipe.block()))}
        command = [str(program), str(library), compute_guid(recipe)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        self.axis = axis
        self.send("master", *self.index(*axis.motion))
        self.send("outputs", *self.index(*OUTPUTS))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()

    def index(self, *names: str) -> list[int]:
        return [self.variables[name][0] for name in names]

    def send(self, *words: object) -> None:
        assert self.process.stdin
        print(*words, file=self.process.stdin)

    def count(self, counts: float) -> None:
        """Let the axis' counter gain `counts` a second, if the axis has a counter."""
        if self.axis.counter:
            self.send("counter", *self.index(self.axis.counter), counts)

    def set(self, values: Mapping[str, Any]) -> None:
        for name, value in values.items():
            index, kind = self.variables[name]
            if kind == "Real":
                self.send("real", index, float(value).hex())
            else:
                self.send("boolean" if kind == "Boolean" else "integer", index, int(value))

    def query(self, *words: object) -> str:
        self.send(*words)
        assert self.process.stdout
        return self.process.stdout.readline()

    def get(self, name: str) -> int:
        """The value of an Integer, enumeration or Boolean."""
        index, kind = self.variables[name]
        return int(self.query("booleans" if kind == "Boolean" else "integers", index))


class SteadySteps:
    """A steady case in a C host: nanoseconds a step, as `measure` asks for them.

    `undisturbed` is the mean of the quickest steps on end: what a step takes when no other program is in the way.
    """

    def __init__(self, host: CHost, case: Steady) -> None:
        self.host, self.case = host, case
        self.undisturbed = math.inf
        host.set(case.start)
        host.send("initialize")
        host.set({f"{host.axis.group}.velocity": VELOCITY, **case.begin})
        host.send("step", case.first)
        host.count(case.counts)

    def __call__(self, n: int) -> float:
        times: dict[str, float] = json.loads(self.host.query("steady", n * IN_C, H, VELOCITY, self.case.change))
        self.undisturbed = min(self.undisturbed, times["undisturbed_ns"])
        return times["ns"]

    def check(self) -> None:
        """The case has held what it promises, up to the end."""
        for name, value in self.case.holds.items():
            actual = self.host.get(name)
            assert actual == int(value), f"{self.case.name}: {name} is {actual}, it should be {int(value)}"


class WorstSteps:
    """A worst case in a C host: what its steps took, and whether they planned what they should."""

    def __init__(self, host: CHost, case: Worst) -> None:
        self.host, self.case = host, case
        self.rounds: list[dict[str, float]] = []
        self.met: Counter[tuple[int, ...]] = Counter()
        host.set(case.start)
        host.send("initialize")
        host.send("commands", *host.index(*case.commands))
        host.send("between", *host.index(*case.between))
        host.send("watch", *host.index(*case.watch))
        host.count(case.counts)
        for name, bounds in case.draws.items():
            host.send("draw", *host.index(name), *bounds)
        for name, (base, bounds) in case.ahead.items():
            host.send("ahead", *host.index(name, base), *bounds)

    def measure(self, n: int) -> None:
        worst = json.loads(self.host.query("worst", n, H, self.case.velocity, self.case.pause))
        self.met.update({tuple(map(int, key.split())): times for key, times in worst.pop("met").items()})
        self.rounds.append(worst)

    @property
    def planned(self) -> float:
        """The share of the steps that planned their command."""
        return sum(self.met[values] for values in self.case.planned) / self.met.total()

    def check(self) -> None:
        met = ", ".join(f"{key}: {times}" for key, times in self.met.items())
        assert self.planned > 0.3, f"{self.case.name}: {self.planned:.0%} planned; {self.case.watch} were {met}"


def extracted(fmu: Path, block: str, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as z:
        return Path(z.extract(PLATFORM.library(block), folder))


def worst_table(planners: Iterable[WorstSteps]) -> Any:
    figures = ("ns (median)", "99.9 %", "slowest", "slowest undisturbed", "planned")
    table = Table("worst step, by a C host", *figures, box=None)
    for planner in planners:
        medians = (f"{statistics.median(r[key] for r in planner.rounds):,.0f}" for key in WORST)
        table.add_row(planner.case.name, *medians, f"{planner.planned:.0%}")
    return table


def mode_table(steady: Mapping[str, list[float]], undisturbed: Mapping[str, float], names: Mapping[str, str]) -> Any:
    """The cost of a step in each input mode; `names`: of the subjects, by the mode's name, the base first."""
    figures = ("ns a step (median)", "ratio", "undisturbed", "ratio", "more than the first")
    table = Table("input mode of the master, by a C host", *figures, box=None)
    base = next(iter(names.values()))
    for mode, name in names.items():
        quickest, least = undisturbed[name], undisturbed[base]
        times = (f"{statistics.median(steady[name]):,.0f}", f"{ratio(steady[name], steady[base]):.2f}")
        table.add_row(mode, *times, f"{quickest:.1f}", f"{quickest / least:.2f}", f"{quickest - least:.1f} ns")
    return table


def target_table(
    cases: Cases,
    steady: Mapping[str, list[float]],
    undisturbed: Mapping[str, float],
    planners: Iterable[WorstSteps],
) -> Any:
    """Each target with the figures that can be compared with it; `undisturbed`: when no other program runs."""
    table = Table("target", "reading", "found", "undisturbed", box=None)
    natives = [f"{IN_C_HOST}{NATIVE}, {case.name}" for case in cases.steady]
    # A step is not steady in which an input changes.
    limits = ["" if case.change else "at most 10" for case in cases.steady]
    rows = [
        *((limit, f"{x} / {IDLE}", x, IN_C_HOST + IDLE) for limit, x in zip(limits, natives, strict=True)),
        ("at least 50", "python through FMPy / native by a C host", FMPY + PYTHON, natives[0]),
        ("", "python / native, both through FMPy", FMPY + PYTHON, FMPY + NATIVE),
    ]
    for target, reading, over, under in rows:
        speedup = ratio(steady[over], steady[under])
        table.add_row(target, reading, f"{speedup:.1f}", f"{undisturbed[over] / undisturbed[under]:.1f}")
    longest = f"below {cases.longest_us:.0f} µs"
    for target, reading, key in (
        (longest, "worst step undisturbed: each the quickest of 5, the slowest of them all", "undisturbed_ns"),
        ("", "worst step, 99.9 % of them", "p999_ns"),
        ("", "the slowest of all, the machine's interruptions included", "slowest_ns"),
    ):
        times = (max(choose(r[key] for r in p.rounds) for p in planners) for choose in (statistics.median, min))
        table.add_row(target, reading, *(f"{ns / 1e3:.2f} µs" for ns in times))
    return table


def idle_block(recipe: Recipe, folder: Path) -> Path:
    """The library of the block's FMU, compiled as the FMU's own, but its block does nothing."""
    files = c_sources(recipe.block(), compute_guid(recipe))
    functions = ("block_initialize", "block_step")
    rename_functions = "".join(f"#define {name} {name}_of_the_block\n" for name in functions).encode()
    restore_names = "".join(f"#undef {name}\n" for name in functions).encode()
    files["block.c"] = rename_functions + files["block.c"] + restore_names + IDLE_BLOCK.encode()
    library = folder / "idle_block.so"
    library.write_bytes(Compilation(recipe.name, files, [PLATFORM]).libraries()[PLATFORM.library(recipe.name)])
    return library


def report(block: str, n: int, program: Path, folder: Path, console: Console) -> None:
    """Build a block's FMUs, measure them, print the tables."""
    recipe, cases = Recipe(block), cases_of(block)
    first, axis = cases.steady[0], cases.axis
    fmus = {
        NATIVE: build(recipe, folder / "native.fmu", progress=console.print),
        PYTHON: build_python(recipe, folder / "python.fmu"),
    }
    native = extracted(fmus[NATIVE], block, folder)
    with ExitStack() as stack:

        def by_c(library: Path) -> CHost:
            return stack.enter_context(CHost(program, library, recipe, axis))

        def host(fmu: Path) -> FmuInstance:
            return start_case(stack.enter_context(FmuInstance(fmu)), first, axis)

        in_c = {f"{IN_C_HOST}{NATIVE}, {case.name}": SteadySteps(by_c(native), case) for case in cases.steady}
        doing_nothing = {IN_C_HOST + IDLE: SteadySteps(by_c(idle_block(recipe, folder)), first)}
        in_modes = {IN_C_HOST + case.name: SteadySteps(by_c(native), case) for case in cases.by_mode.values()}
        subjects = {
            **doing_nothing,
            **in_c,
            **in_modes,
            **{FMPY + name: timed(through_fmpy(host(fmu), first, axis)) for name, fmu in fmus.items()},
        }
        planners = [WorstSteps(by_c(native), case) for case in cases.worst]
        steady = measure(subjects, n)
        for _ in range(ROUNDS):
            for planner in planners:
                planner.measure(n)
        for checked in (*in_c.values(), *in_modes.values(), *planners):
            checked.check()
    quietest = {name: min(times) for name, times in steady.items()}
    quietest |= {name: steps.undisturbed for name, steps in (in_c | in_modes | doing_nothing).items()}
    names_by_mode = {mode: IN_C_HOST + case.name for mode, case in cases.by_mode.items()}
    for table in (
        cost_table(steady, IN_C_HOST + IDLE, f"of the {IDLE}"),
        *([mode_table(steady, quietest, names_by_mode)] if names_by_mode else []),
        worst_table(planners),
        target_table(cases, steady, quietest, planners),
    ):
        console.print(table)
        console.print()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--block", choices=MEASURED, help="all of them, if none is named")
    parser.add_argument("--steps", type=int, default=20_000, help=f"steps a round; {IN_C} times that in C")
    options = parser.parse_args()
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        parser.error("this benchmark is for Linux on x86-64")
    console = Console(highlight=False, width=120)
    with tempfile.TemporaryDirectory() as root:
        program = compile_c(FOLDER / "host.c", Path(root) / "host")
        for block in [options.block] if options.block else MEASURED:
            console.rule(block)
            folder = Path(root) / block
            folder.mkdir()
            report(block, options.steps, program, folder, console)


if __name__ == "__main__":
    main()
