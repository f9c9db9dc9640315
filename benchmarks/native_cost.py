"""What a step of the native flavour costs, beside a do-nothing C FMU of the same interface and the python flavour.

All in one run, in turns, so that the ratios hold on a busy machine. A plain C host, without any Python, drives the
native unit and the do-nothing one; FMPy, and bare ctypes, drive both flavours as well. The worst step is one at whose
beginning start and stop rise together: it plans a ramp, runs it to its end, plans the stacked one and ends that too.

    python benchmarks/native_cost.py [--steps 20000] [--cold]
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from cost import (
    MASTER,
    OUTPUTS,
    ROUNDS,
    VELOCITY,
    H,
    compile_c,
    cost_table,
    measure,
    ratio,
    through_ctypes,
    through_fmpy,
    timed,
)
from rich.console import Console
from rich.table import Table

from motionsync.master import MasterInput
from motionsync.transition import Curve
from motionsync_fmu.archive import write
from motionsync_fmu.build import Recipe, build_native, build_python
from motionsync_fmu.host import Host
from motionsync_fmu.variables import variables

HERE = Path(__file__).parent
BLOCK = "Synchronizer"
LIBRARY = f"binaries/linux64/{BLOCK}.so"
SHARED = ("-target", "x86_64-linux-gnu.2.17", "-fPIC", "-shared", "-fvisibility=hidden", "-s")
IN_C = 100  # a round of a C host takes so many times the steps: they are short
TURNS_A_STEP = 5.0  # of the worst step: enough for both ramps
PERIOD = 360.0
WORST = ("median_ns", "p999_ns", "slowest_ns", "undisturbed_ns")
NOTHING, NATIVE, RAMP, PYTHON = "do-nothing FMU", "native", "native, in a ramp", "python"
BUILD = "from pathlib import Path; from motionsync_fmu.build import *; build_{}(Recipe({!r}, starts={!r}), Path({!r}))"


class CHost:
    """The C host in a process of its own, told what to do line by line (host.c says how)."""

    def __init__(self, program: Path, library: Path, recipe: Recipe) -> None:
        self.index = {v.name: str(i) for i, v in enumerate(variables(recipe.block()))}
        command = [str(program), str(library), recipe.guid()]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        self.tell("master", *(self.index[n] for n in MASTER))
        self.tell("outputs", *(self.index[n] for n in OUTPUTS))
        self.tell("commands", self.index["start"], self.index["stop"])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()

    def tell(self, *words: object) -> None:
        assert self.process.stdin
        print(*words, file=self.process.stdin)

    def set(self, kind: str, name: str, value: object) -> None:
        self.tell(kind, self.index[name], value)

    def ask(self, *words: object) -> str:
        self.tell(*words)
        assert self.process.stdout
        return self.process.stdout.readline()

    def steady(self, n: int) -> float:
        took: float = json.loads(self.ask("steady", n * IN_C, H, VELOCITY))["ns"]
        return took

    def worst(self, n: int) -> dict[str, float]:
        found: dict[str, float] = json.loads(self.ask("worst", n, H, TURNS_A_STEP * PERIOD / H))
        done = self.ask("booleans", self.index["ready"], self.index["synchronized"]).split()
        assert done == ["1", "0"], "the last step has ended a start and the stop stacked on it"
        return found


def on_the_master(host: CHost) -> CHost:
    host.tell("initialize")
    return host


def in_a_ramp(host: CHost) -> CHost:
    """All the way along a ramp that no benchmark comes to the end of."""
    host.set("real", "output_phasing", 1e9)
    host.tell("initialize")
    host.set("real", "master.position", -2e9)
    host.set("boolean", "stop", 1)
    host.tell("step", H)
    return host


def planning(host: CHost, mode: MasterInput, curve: Curve) -> CHost:
    host.set("real", "master.period", PERIOD)
    host.set("integer", "master.input_mode", int(mode))
    host.set("integer", "curve", int(curve))
    host.tell("initialize")
    return host


def extracted(fmu: Path, folder: Path) -> Path:
    with zipfile.ZipFile(fmu) as z:
        return Path(z.extract(LIBRARY, folder))


def idle(native: Path, library: Path, target: Path) -> Path:
    """The native FMU with the do-nothing library alone."""
    with zipfile.ZipFile(native) as z:
        files = {n: z.read(n) for n in z.namelist() if not n.startswith("binaries/")}
    write(target, files | {LIBRARY: library.read_bytes()})
    return target


def build_seconds(flavour: str, target: Path, starts: Mapping[str, str], cache: Path | None = None) -> float:
    """How long a Python of its own takes to build a flavour, imports included."""
    folders = {f"ZIG_{kind}_CACHE_DIR": str(cache / kind) for kind in ("GLOBAL", "LOCAL")} if cache else {}
    begun = time.perf_counter()
    command = [sys.executable, "-c", BUILD.format(flavour, BLOCK, dict(starts), str(target))]
    subprocess.run(command, check=True, env=os.environ | folders)
    return time.perf_counter() - begun


def build_table(folder: Path, *, cold: bool) -> Any:
    target, never_seen = folder / "again.fmu", {"rest_value": repr(time.time())}
    table = Table("build", "s", box=None)
    if cold:
        table.add_row("native, zig's cache empty", f"{build_seconds('native', target, {}, folder / 'cache'):.1f}")
    table.add_row("native, start values never built before", f"{build_seconds('native', target, never_seen):.1f}")
    table.add_row("native, the same again", f"{build_seconds('native', target, never_seen):.1f}")
    table.add_row("python", f"{build_seconds('python', target, {}):.1f}")
    return table


def size_table(fmus: Mapping[str, Path]) -> Any:
    table = Table("file", "bytes", "packed", box=None)
    for name, fmu in fmus.items():
        table.add_row(f"{name} FMU", "", f"{fmu.stat().st_size:,}")
        with zipfile.ZipFile(fmu) as z:
            for entry in z.infolist():
                if entry.filename.startswith("binaries/"):
                    table.add_row(f"  {entry.filename}", f"{entry.file_size:,}", f"{entry.compress_size:,}")
    return table


def worst_table(found: Mapping[str, list[dict[str, float]]]) -> Any:
    table = Table("worst step, by a C host", "ns (median)", "99.9 %", "slowest", "slowest undisturbed", box=None)
    for name, rounds in found.items():
        table.add_row(name, *(f"{statistics.median(r[key] for r in rounds):,.0f}" for key in WORST))
    return table


def target_table(steady: Mapping[str, list[float]], worst: Mapping[str, list[dict[str, float]]]) -> Any:
    """The readings that a target can be given; in the quietest rounds least of them is due to other programs."""
    table = Table("target", "reading", "found", "quietest rounds", box=None)
    in_c, fmpy, bare = "C host: ", "FMPy: ", "ctypes: "
    rows = (
        ("at most 10", "native / do-nothing FMU, both by a C host, on the master", NATIVE, NOTHING, in_c, in_c),
        ("", "the same, in a ramp", RAMP, NOTHING, in_c, in_c),
        ("at least 50", "python through FMPy / native by a C host", PYTHON, NATIVE, fmpy, in_c),
        ("", "python through bare ctypes / native by a C host", PYTHON, NATIVE, bare, in_c),
        ("", "python / native, both through bare ctypes", PYTHON, NATIVE, bare, bare),
        ("", "python / native, both through FMPy", PYTHON, NATIVE, fmpy, fmpy),
    )
    for target, reading, above, below, by, of in rows:
        over, under = steady[by + above], steady[of + below]
        table.add_row(target, reading, f"{ratio(over, under):.1f}", f"{min(over) / min(under):.1f}")
    for target, reading, key in (
        ("below 20 µs", "worst step undisturbed: each the quickest of 5, the slowest of them all", "undisturbed_ns"),
        ("", "worst step, 99.9 % of them", "p999_ns"),
        ("", "the slowest of all, the machine's interruptions included", "slowest_ns"),
    ):
        longest = (
            max(choose(r[key] for r in rounds) for rounds in worst.values()) for choose in (statistics.median, min)
        )
        table.add_row(target, reading, *(f"{ns / 1e3:.2f} µs" for ns in longest))
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=20_000, help=f"steps a round; {IN_C} times that in C")
    parser.add_argument("--cold", action="store_true", help="also build with an empty zig cache: minutes")
    options = parser.parse_args()
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        parser.error("this benchmark is for Linux on x86-64")
    n = options.steps
    recipe = Recipe(BLOCK)
    console = Console(highlight=False, width=120)
    with tempfile.TemporaryDirectory() as root, ExitStack() as stack:
        folder = Path(root)
        fmus = {
            "native": build_native(recipe, folder / "native.fmu", console.print),
            "python": build_python(recipe, folder / "python.fmu"),
        }
        program = compile_c(HERE / "host.c", folder / "host")
        nothing = compile_c(HERE / "idle.c", folder / "idle.so", *SHARED)
        native = extracted(fmus["native"], folder)

        def by_c(library: Path, prepare: Callable[[CHost], CHost]) -> CHost:
            return prepare(stack.enter_context(CHost(program, library, recipe)))

        def host(fmu: Path) -> Host:
            return stack.enter_context(Host(fmu))

        idle_fmu = idle(fmus["native"], nothing, folder / "idle.fmu")
        flavours = {NOTHING: idle_fmu, NATIVE: fmus["native"], PYTHON: fmus["python"]}
        subjects = {
            f"C host: {NOTHING}": by_c(nothing, on_the_master).steady,
            f"C host: {NATIVE}": by_c(native, on_the_master).steady,
            f"C host: {RAMP}": by_c(native, in_a_ramp).steady,
            **{f"ctypes: {name}": timed(through_ctypes(host(fmu))) for name, fmu in flavours.items()},
            **{f"FMPy: {name}": timed(through_fmpy(host(fmu))) for name, fmu in flavours.items()},
        }
        planners = {
            f"{mode.name}, {curve.name}": by_c(native, partial(planning, mode=mode, curve=curve))
            for mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP)
            for curve in Curve
        }
        worst: dict[str, list[dict[str, float]]] = {name: [] for name in planners}
        steady = measure(subjects, n)
        for _ in range(ROUNDS):
            for case, planner in planners.items():
                worst[case].append(planner.worst(n))
        for table in (
            cost_table(steady, f"C host: {NOTHING}", f"of the {NOTHING}"),
            worst_table(worst),
            target_table(steady, worst),
            size_table(fmus),
            build_table(folder, cold=options.cold),
        ):
            console.print(table)
            console.print()


if __name__ == "__main__":
    main()
