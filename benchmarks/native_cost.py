"""What a step of the native flavour costs, beside a do-nothing FMU and the python flavour.

The do-nothing FMU is the block's own, which takes, checks and answers the same variables, but its block does nothing.
All are measured in one run, in turns, so that the ratios hold on a busy machine. Loops in C (host.c), without any
Python and with nothing logged, drive the native unit and the do-nothing one; FMPy drives both flavours as well. The
worst steps are those at whose beginning commands are given: the modules in cases/ say which these are for each block,
and which outputs show that the commands were planned. A block with a master is also measured in each input mode of
the master.

    python benchmarks/native_cost.py [--block FlyingSaw] [--steps 20000]
"""

import argparse
import ctypes
import math
import platform
import statistics
import tempfile
import zipfile
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
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
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.instance_sources import c_sources
from motionsync_fmu.native.libraries import Compilation
from motionsync_fmu.native.platforms import PLATFORMS
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
TIMES = 5  # that the steps of a worst case are repeated
CALLS = {  # the functions of FMI that host.c calls
    **{f"{way}_{kind.lower()}": f"fmi2{way.title()}{kind}" for kind in ("Real", "Integer") for way in ("set", "get")},
    "set_boolean": "fmi2SetBoolean",
    "do_step": "fmi2DoStep",
}
LISTS = ("master", "counter", "outputs", "commands", "between", "draws", "aheads", "bases", "watched")


class References(ctypes.Structure):
    """Some variables, by their value references."""

    _fields_ = (("r", ctypes.POINTER(ctypes.c_uint)), ("n", ctypes.c_size_t))


class CHost(ctypes.Structure):
    """A unit and what the loops of host.c set and get at each step; the fields are explained there."""

    _fields_ = (
        *((name, ctypes.c_void_p) for name in ("unit", *CALLS)),
        *((name, References) for name in LISTS),
        *((name, ctypes.c_double) for name in ("counts", "now", "place")),
    )

    def __init__(self, library: ctypes.CDLL, fmu: FmuInstance, axis: MovingAxis, case: Steady | Worst, **lists: Any):
        """A host whose unit is initialized for a case; `lists`: names of variables, by the fields of host.c."""
        self.library, self.fmu, self.axis = library, fmu, axis
        fmu.initialize(case.start)
        fmu.unit.setDebugLogging(False, [])
        calls = {name: ctypes.cast(getattr(fmu.unit.dll, call), ctypes.c_void_p) for name, call in CALLS.items()}
        super().__init__(unit=fmu.unit.component, counts=case.counts, now=fmu.time, **calls)
        lists |= {"master": axis.motion, "counter": filter(None, [axis.counter]), "outputs": OUTPUTS}
        for name in LISTS:
            references = fmu.references(lists.get(name, ()))
            setattr(self, name, References((ctypes.c_uint * len(references))(*references), len(references)))

    def measure(self, loop: str, n: int, *arguments: Any) -> None:
        status = getattr(self.library, loop)(ctypes.byref(self), ctypes.c_long(n), *arguments)
        assert status == 0, f"a step of {self.fmu.description.modelName} had the status {status}"


class SteadySteps:
    """A steady case in a C host: nanoseconds a step, as `measure` asks for them.

    `undisturbed` is the mean of the quickest steps on end: what a step takes when no other program is in the way.
    """

    def __init__(self, library: ctypes.CDLL, fmu: FmuInstance, case: Steady, axis: MovingAxis) -> None:
        self.host, self.case = CHost(library, fmu, axis, case), case
        self.times = (ctypes.c_double * 2)(0.0, math.inf)
        fmu.step(case.first, {f"{axis.group}.velocity": VELOCITY, **case.begin})
        self.host.now = fmu.time

    def __call__(self, n: int) -> float:
        self.host.measure("steady", n * IN_C, *map(ctypes.c_double, (H, VELOCITY, self.case.change)), self.times)
        return self.times[0]

    @property
    def undisturbed(self) -> float:
        return self.times[1]

    def check(self) -> None:
        """The case has held what it promises, up to the end."""
        for name, value in self.host.fmu.get(self.case.holds).items():
            expected = self.case.holds[name]
            assert value == expected, f"{self.case.name}: {name} is {value}, it should be {expected}"


class WorstSteps:
    """A worst case in a C host: what its steps took, and whether they planned what they should.

    The machine interrupts some steps. Therefore the whole is repeated 5 times with the same random numbers, and the
    quickest of its 5 times counts for each step: the slowest of these is undisturbed_ns."""

    def __init__(self, library: ctypes.CDLL, fmu: FmuInstance, case: Worst, axis: MovingAxis) -> None:
        bases, ahead = [base for base, _ in case.ahead.values()], [bounds for _, bounds in case.ahead.values()]
        names = {"commands": case.commands, "between": case.between, "draws": case.draws, "watched": case.watch}
        self.host, self.case = CHost(library, fmu, axis, case, **names, aheads=case.ahead, bases=bases), case
        self.bounds = [*case.draws.values()], ahead
        self.rounds: list[dict[str, float]] = []
        self.met: Counter[tuple[int, ...]] = Counter()

    def measure(self, n: int) -> None:
        random = np.random.default_rng(1)
        given = [random.uniform(*np.reshape(bounds, (-1, 2)).T, (n, len(bounds))) for bounds in self.bounds]
        took, seen = np.empty((TIMES, n)), np.empty((TIMES, n, len(self.case.watch)), np.int32)
        for times, values in zip(took, seen, strict=True):
            arrays = (array.ctypes for array in (*given, times, values))
            self.host.measure("worst", n, *map(ctypes.c_double, (H, self.case.velocity, self.case.pause)), *arrays)
        self.met.update(map(tuple, seen.reshape(TIMES * n, -1).tolist()))
        figures = (np.median(took), np.quantile(took, 0.999), took.max(), took.min(axis=0).max())
        self.rounds.append(dict(zip(WORST, map(float, figures), strict=True)))

    @property
    def planned(self) -> float:
        """The share of the steps that planned their command."""
        return sum(self.met[values] for values in self.case.planned) / self.met.total()

    def check(self) -> None:
        met = ", ".join(f"{key}: {times}" for key, times in self.met.items())
        assert self.planned > 0.3, f"{self.case.name}: {self.planned:.0%} planned; {self.case.watch} were {met}"


def idle(native: Path, block: str, library: Path, target: Path) -> Path:
    """The native FMU with the do-nothing library as its only one."""
    with zipfile.ZipFile(native) as z:
        files = {n: z.read(n) for n in z.namelist() if not n.startswith("binaries/")}
    write_zip(target, files | {PLATFORM.library(block): library.read_bytes()})
    return target


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


def report(block: str, n: int, library: ctypes.CDLL, folder: Path, console: Console) -> None:
    """Build a block's FMUs, measure them, print the tables."""
    recipe, cases = Recipe(block), cases_of(block)
    first, axis = cases.steady[0], cases.axis
    fmus = {
        NATIVE: build(recipe, folder / "native.fmu", progress=console.print),
        PYTHON: build_python(recipe, folder / "python.fmu"),
    }
    nothing = idle(fmus[NATIVE], block, idle_block(recipe, folder), folder / "idle.fmu")
    with ExitStack() as stack:

        def steady_in_c(case: Steady, fmu: Path = fmus[NATIVE]) -> SteadySteps:
            return SteadySteps(library, stack.enter_context(FmuInstance(fmu)), case, axis)

        def host(fmu: Path) -> FmuInstance:
            return start_case(stack.enter_context(FmuInstance(fmu)), first, axis)

        in_c = {f"{IN_C_HOST}{NATIVE}, {case.name}": steady_in_c(case) for case in cases.steady}
        doing_nothing = {IN_C_HOST + IDLE: steady_in_c(first, nothing)}
        in_modes = {IN_C_HOST + case.name: steady_in_c(case) for case in cases.by_mode.values()}
        subjects = {
            **doing_nothing,
            **in_c,
            **in_modes,
            **{FMPY + name: timed(through_fmpy(host(fmu), first, axis)) for name, fmu in fmus.items()},
        }
        planners = [
            WorstSteps(library, stack.enter_context(FmuInstance(fmus[NATIVE])), case, axis) for case in cases.worst
        ]
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
        library = ctypes.CDLL(str(compile_c(FOLDER / "host.c", Path(root) / "host.so")))
        for block in [options.block] if options.block else MEASURED:
            console.rule(block)
            folder = Path(root) / block
            folder.mkdir()
            report(block, options.steps, library, folder, console)


if __name__ == "__main__":
    main()
