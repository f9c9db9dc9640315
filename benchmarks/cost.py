"""What the benchmarks share: subjects, which do steps, their measurement in turns, and the table of the results."""

import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from cases.measured import VELOCITY, H, MovingAxis, Steady, counted
from rich.table import Table

from motionsync_fmu.native.libraries import HEADERS
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance

ROUNDS = 7
OUTPUTS = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")

Subject = Callable[[int], float]  # does a number of steps, and answers nanoseconds a step


def timed(steps: Callable[[int], None]) -> Subject:
    """The subject that calls `steps` and measures the time."""

    def subject(n: int) -> float:
        start = time.perf_counter()
        steps(n)
        return (time.perf_counter() - start) / n * 1e9

    return subject


def start_case(host: FmuInstance, case: Steady, axis: MovingAxis) -> FmuInstance:
    """The host after it has been led to where the case starts."""
    host.initialize(case.start)
    host.step(case.first, {f"{axis.group}.velocity": VELOCITY, **case.begin})
    return host


def through_fmpy(host: FmuInstance, case: Steady, axis: MovingAxis) -> Callable[[int], None]:
    """Set three inputs, doStep, get four outputs: each a call into the FMU, as FMPy's own simulation does; one more
    call if the axis has a counter."""
    inputs, outputs = host.references(axis.motion), host.references(OUTPUTS)
    counter = host.references([axis.counter] if axis.counter else [])
    unit = host.unit

    def steps(n: int) -> None:
        for _ in range(n):
            unit.setReal(inputs, [VELOCITY * host.time, VELOCITY, 0.0])
            if counter:
                unit.setInteger(counter, [counted(case.counts, host.time)])
            unit.doStep(host.time, H)
            host.time += H
            unit.getReal(outputs)

    return steps


def compile_c(source: Path, target: Path) -> Path:
    """Compile a C library with zig; the FMI headers are in its include path."""
    flags = ["-O2", "-shared", "-fPIC", "-ffp-contract=off", "-I", str(HEADERS)]
    command = [sys.executable, "-m", "ziglang", "cc", *flags]
    subprocess.run([*command, str(source), "-o", str(target)], check=True)
    return target


def measure(subjects: Mapping[str, Subject], n: int) -> dict[str, list[float]]:
    """Nanoseconds a step of each subject, in several rounds; the subjects take turns in each round."""
    times_by_subject: dict[str, list[float]] = {name: [] for name in subjects}
    for subject in subjects.values():
        subject(max(n // 10, 1))
    for _ in range(ROUNDS):
        for name, subject in subjects.items():
            times_by_subject[name].append(subject(n))
    return times_by_subject


def ratio(times: list[float], base: list[float]) -> float:
    """The median over the rounds of how many times as long `times` are as `base`."""
    return statistics.median(t / b for t, b in zip(times, base, strict=True))


def cost_table(times_by_subject: Mapping[str, list[float]], base: str, title: str) -> Any:
    """The subjects' cost a step, and its ratio to the subject `base`."""
    table = Table("subject", "ns a step (median)", "fastest", "slowest", title, box=None)
    for name, times in times_by_subject.items():
        figures = (f"{f(times):,.0f}" for f in (statistics.median, min, max))
        table.add_row(name, *figures, f"{ratio(times, times_by_subject[base]):.2f}")
    return table
