"""How fast sweeps are: runs a second on one and two processes, overhead of a chunk, a measured line beside an ideal
one, memory over steps, a warm start.

    python benchmarks/sweeps.py

Each ratio is one of figures of the same call. A machine that does other things makes all of it slower, and most of all
two processes beside one. The greatest memory is known on Linux alone.
"""

import argparse
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

from motionsync_fmu.scenario.files.shipped import find_scenario
from motionsync_fmu.sweeps.execution import execute
from motionsync_fmu.sweeps.rows import rows
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from motionsync_fmu.sweeps.worker_pool import cluster

SCENARIO = "FlyingSaw/cyclic_cut"
MACHINE = "CutToLength/cyclic_orders"
RATIO = 1.8  # of two processes to one: the target
FLAT = 1.1  # memory of twice the steps to that of the steps: the target
MEMORY = """
import re, sys
from pathlib import Path
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from motionsync_fmu.sweeps.rows import rows
plan = SweepPlan.of(Path(sys.argv[1]), sys.argv[2:], measures={"slave.velocity": ("max",)})
rows(plan, 0, plan.runs)
print(re.search(r"VmHWM:\\s*(\\d+) kB", Path("/proc/self/status").read_text())[1])
"""
START = """
import sys
from pathlib import Path
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from motionsync_fmu.sweeps.rows import rows
rows(SweepPlan.of(Path(sys.argv[1]), sys.argv[2:]), 0, 1)
"""
STEADY = """
title = "A saw that runs along"
fmu = "FlyingSaw"
stop_time = {stop_time}
step_size = 0.01
[start]
"move_velocity.velocity" = 100.0
[master]
velocity = 100.0
[[set]]
at = 0.1
"move_velocity.execute" = true
"""
"""A scenario whose evaluation needs no recording."""
LINE = """
title = "Pieces of 800 mm from a line that ramps, stops and goes on"
fmu = "CutToLength"
stop_time = 30.0
step_size = 0.002
[start]
length = 800.0
auto_start = true
"approach.reserve" = 0.2
[cuts]
tolerance = 0.1
[master]
segments = [
    {{ duration = 2.0, acceleration = 250.0 }},
    {{ duration = 9.0 }},
    {{ duration = 2.0, acceleration = -250.0 }},
    {{ duration = 2.0 }},
    {{ duration = 2.0, acceleration = 200.0 }},
    {{ duration = 13.0 }},
]
{more}
"""
MEASURED = """
[encoder]
resolution = 0.05
noise = 0.02
delay = 0.002
[servo]
position_gain = 50.0
velocity_time_constant = 0.003
dead_time = 0.002
"""
LEAST_SHARE = 0.6  # of the rate on the ideal line: the target
SPEED = "move_velocity.velocity"  # what varies in it


@dataclass
class Pace:
    """The progress of a sweep, from the first chunk that is done on: without the start of its processes."""

    points: list[tuple[float, int]] = field(default_factory=list)

    def __call__(self, finished: int, whole: int) -> None:
        if finished:
            self.points.append((perf_counter(), finished))

    @property
    def rate(self) -> float:
        """Runs a second."""
        (begin, before), (end, after) = self.points[0], self.points[-1]
        return (after - before) / (end - begin)


def swept(plan: SweepPlan, workers: int) -> tuple[float, float]:
    """Runs a second once all processes work; the seconds of the whole sweep."""
    pace, begin = Pace(), perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        execute(plan, Path(folder), rows, workers=workers, progress=pace)
    return pace.rate, perf_counter() - begin


def plan_of(scenario: str, runs: int, chunk: int) -> SweepPlan:
    """A sweep of so many runs over the line's velocity or the carriage's acceleration."""
    name, low, high = "axis.max_acceleration", 8000, 20000
    return SweepPlan.of(find_scenario(Path(scenario)), [f"{name}={low}:{high}:{runs}"], chunk=chunk)


def processes(runs: int, chunk: int) -> None:
    """Runs a second on one process and on two."""
    print(f"{'scenario':26}{'runs':>8}{'1 process':>14}{'2 processes':>14}{'ratio':>8}   target {RATIO:g}")
    for scenario in (SCENARIO, MACHINE):
        plan = plan_of(scenario, runs, chunk)
        single, double = (swept(plan, workers)[0] for workers in (1, 2))
        print(f"{scenario:26}{runs:8}{single:10.0f} /s{double:11.0f} /s{double / single:8.2f}")


def nothing(number: int) -> bytes:
    """A chunk of no runs."""
    return b""


def chunks(runs: int) -> None:
    """What a chunk costs beside its runs: short ones, in one chunk and in many; and a task that does nothing."""
    parts = runs // 10
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "steady.toml"
        file.write_text(STEADY.format(stop_time=0.5))
        plans = [SweepPlan.of(file, [f"{SPEED}=100:900:{runs}"], chunk=chunk) for chunk in (runs, runs // parts)]
    one_chunk, many_chunks = (median(sweep_in_this_process(plan) for _ in range(3)) for plan in plans)
    print(f"\na chunk costs {(many_chunks - one_chunk) / (parts - 1) * 1e3:.1f} ms of processor time beside its runs")
    count = 3000
    with cluster(nothing, "", 2, lambda line: None) as pool:
        while pool.capacity < 4:
            pool.try_take_finished()
        begin = perf_counter()
        pool.client.gather(pool.client.map(nothing, range(count), pure=False))
        took = perf_counter() - begin
    print(f"Dask: {count / took:.0f} tasks a second that do nothing, on 2 workers")


def sweep_in_this_process(plan: SweepPlan) -> float:
    """The seconds of processor time of a sweep in this process."""
    begin = process_time()
    with tempfile.TemporaryDirectory() as folder:
        execute(plan, Path(folder), rows, workers=1)
    return process_time() - begin


def measured_line(runs: int) -> None:
    """Runs a second of a CutToLength on an ideal line, and of a Monte Carlo with encoder and servo on the same line."""
    with tempfile.TemporaryDirectory() as folder:
        plans = {}
        for name, more, values in (
            ("ideal line", "", f"kerf=0:1:{runs}"),
            ("encoder and servo", MEASURED, f"encoder.seed=0:{runs - 1}:{runs}"),
        ):
            file = Path(folder) / f"{name}.toml"
            file.write_text(LINE.format(more=more))
            plans[name] = SweepPlan.of(file, [values])
        rounds = [{name: runs / sweep_in_this_process(plan) for name, plan in plans.items()} for _ in range(16)]
    ideal, measured = (max(rates[name] for rates in rounds[1:]) for name in plans)
    print(f"\n{'ideal line':>12}{'encoder and servo':>20}{'share':>8}   target {LEAST_SHARE:g}, of {runs} runs each")
    print(f"{ideal:10.0f} /s{measured:17.0f} /s{measured / ideal:9.2f}")


def memory(runs: int) -> None:
    """The greatest memory of a process with so many runs, over the number of steps."""
    print(f"\n{'steps a run':>12}{'memory':>10}{'ratio':>8}   target {FLAT:g}, {runs} runs")
    first = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for stop_time in (50.0, 100.0, 200.0):
            file = Path(folder) / "steady.toml"
            file.write_text(STEADY.format(stop_time=stop_time))
            kilobytes = float(output(MEMORY, file, f"{SPEED}=100:900:{runs}"))
            first = first or kilobytes
            print(f"{stop_time / 0.01:12.0f}{kilobytes / 1e3:7.0f} MB{kilobytes / first:8.2f}")


def start(repetitions: int) -> None:
    """From the start of a process to its first row, with what is compiled in the cache."""
    file = find_scenario(Path(SCENARIO))
    rows(SweepPlan.of(file, ["axis.max_jerk=2e5"]), 0, 1)
    taken = []
    for _ in range(repetitions):
        begin = perf_counter()
        output(START, file, "axis.max_jerk=2e5")
        taken.append(perf_counter() - begin)
    print(f"\na warm process has its first row after {min(taken):.2f} s")


def output(code: str, *arguments: object) -> str:
    """What a program prints, in a Python of its own."""
    finished = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], stdout=subprocess.PIPE, text=True, check=True
    )
    return finished.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description="How fast sweeps are.")
    parser.add_argument("--runs", type=int, default=8000, help="of a sweep")
    parser.add_argument("--chunk", type=int, default=250, help="runs of a chunk")
    parser.add_argument("--repetitions", type=int, default=5)
    options = parser.parse_args()
    processes(options.runs, options.chunk)
    chunks(options.runs // 4)
    measured_line(options.runs // 200)
    memory(1000)
    start(options.repetitions)


if __name__ == "__main__":
    main()
