"""Steps per second and core of `simulate_many` on the Synchronizer, compared with the plain Python block, in one run.

    python benchmarks/batch_throughput.py

Steady: the slave follows the master one to one. Mixed: every second turn a stop or a start is given, so that the slave
waits, ramps, rests and follows in turn; a command executes while the slave waits or ramps. The phasing differs between
the instances; three outputs are read at each step.

A core's rate is measured in processor time, so that it does not depend on other programs; `wall` is the rate of
all threads together by the clock. The best of several repetitions counts.

Measures: the same runs without outputs, and with measures of one and of four outputs instead; beside them, four outputs
into an array that keeps the last step alone. All take turns. `share` is the speed in shares of that without outputs.
Last, what a call costs beside the steps, and the memory of measures at n and 2 n steps.
"""

import argparse
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.synchronizer.block import Synchronizer
from motionsync_fmu.batch.simulation import simulate_many

INSTANCES, STEPS, H, VELOCITY, TURN = 64, 20_000, 1e-3, 180.0, 360.0
OUTPUTS = ["slave.position", "slave.velocity", "state"]
TARGET = 20e6  # steps per second and core
FOUR = ["slave.position", "slave.velocity", "slave.acceleration", "state"]
MEASURES: dict[str, dict[str, tuple[str, ...]]] = {
    "no outputs": {},
    "max, max_time of one output": {"slave.velocity": ("max", "max_time")},
    "max, mean, last of 4 outputs": dict.fromkeys(FOUR, ("max", "mean", "last")),
    "all extremes of 4 outputs": dict.fromkeys(FOUR, ("min", "max", "min_time", "max_time")),
}
SHARE = 0.9  # of the speed without outputs


@dataclass(frozen=True)
class Case:
    """A run over a master at constant velocity; `every`: the turns from command to command, 0: no commands."""

    name: str
    period: float
    every: int = 0

    @property
    def inputs(self) -> dict[str, Any]:
        travel = VELOCITY * H * np.arange(STEPS)
        inputs: dict[str, Any] = {"master.position": travel % self.period if self.period else travel}
        if self.every:
            number = np.floor(travel / TURN / self.every)
            inputs |= {"stop": number % 2 == 0.0, "start": number % 2 == 1.0}
        return inputs

    @property
    def start(self) -> dict[str, Any]:
        return {
            "master.period": self.period,
            "master.velocity": VELOCITY,
            "output_phasing": np.linspace(30.0, 90.0, INSTANCES),
            "rest_value": 270.0,
            "stop": False,  # so a stop that is true in the first step has its edge there
        }


CASES = [
    Case("steady, linear axis", 0.0),
    Case("steady, period", TURN),
    Case("mixed, period", TURN, every=2),
    Case("a ramp each turn", TURN, every=1),
]


def measure_shortest(repetitions: int, action: Callable[[], Any]) -> tuple[float, float]:
    """Processor time and time by the clock, in s, each the shortest of all repetitions."""
    processor, clock = [], []
    for _ in range(repetitions):
        start = time.process_time(), time.perf_counter()
        action()
        processor.append(time.process_time() - start[0])
        clock.append(time.perf_counter() - start[1])
    return min(processor), min(clock)


def step_python_block(case: Case) -> None:
    """Run one instance as a Python block, whose inputs and outputs are set and read one by one."""
    block = Synchronizer()
    block.master.period = case.period
    block.master.velocity = VELOCITY
    block.output_phasing = 60.0
    block.rest_value = 270.0
    block.initialize()
    none = np.zeros(STEPS, np.bool_)
    columns: list[NDArray[Any]] = [case.inputs.get(name, none) for name in ("master.position", "start", "stop")]
    for position, start, stop in zip(*(column.tolist() for column in columns), strict=True):
        block.master.position = position
        block.start = start
        block.stop = stop
        block.step(H)
        _ = block.slave.position, block.slave.velocity, block.state


def measure_step_times(case: Case, repetitions: int) -> dict[str, float]:
    """Processor time of a step in s: without outputs, with measures, and with the last step's outputs alone."""
    last = np.lib.stride_tricks.as_strided(np.zeros(len(FOUR)), (INSTANCES, STEPS, len(FOUR)), (0, 0, 8))
    run = partial(simulate_many, "Synchronizer", H, case.inputs, start=case.start, threads=1)
    actions: dict[str, Callable[[], Any]] = {name: partial(run, reduce=reduce) for name, reduce in MEASURES.items()}
    actions["4 outputs of the last step"] = partial(run, FOUR, out=last)
    times: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(repetitions):
        for name, action in actions.items():
            times[name].append(measure_shortest(1, action)[0])
    return {name: min(seconds) / INSTANCES / STEPS for name, seconds in times.items()}


def print_measures(repetitions: int) -> None:
    print(f"\nMeasures. Target: {SHARE:g} of the speed without outputs.\n")
    for case in CASES:
        step_times = measure_step_times(case, repetitions)
        for name, seconds in step_times.items():
            share = step_times["no outputs"] / seconds
            print(f"{case.name:20}  {name:30}{seconds * 1e9:>8.1f} ns a step  share {share:.2f}")
    print()
    for block in ("Synchronizer", "FlyingSaw", "CutToLength"):
        simulate_many(block, H, {})
        call = partial(simulate_many, block, H, {}, reduce={"slave.position": "max"}, threads=1)
        print(f"A call for one step of {block}: {measure_shortest(50, call)[1] * 1e3:.2f} ms.")


def peak_memory(steps: int) -> int:
    """The greatest number of bytes that Python and NumPy have while 100 instances are measured."""
    tracemalloc.start()
    simulate_many("Synchronizer", H, {}, reduce=MEASURES["max, mean, last of 4 outputs"], steps=steps, instances=100)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


def print_memory() -> None:
    for steps in (STEPS, 2 * STEPS):
        values = 8 * 100 * steps * len(FOUR)
        print(f"Memory of 100 instances, {steps} steps: {peak_memory(steps)} bytes; their values take {values}.")


def print_throughput(repetitions: int) -> None:
    begin = time.perf_counter()
    simulate_many("Synchronizer", H, {}, OUTPUTS)
    print(f"The first call, which loads the code or compiles it, took {time.perf_counter() - begin:.1f} s.")
    print(f"{INSTANCES} instances, {STEPS} steps. Target: {TARGET / 1e6:g} million steps per second and core.\n")
    columns = (
        "executing",
        "ramping",
        "threads",
        "ns a step",
        "million/s/core",
        "wall million/s",
        "Python ns",
        "ratio",
    )
    print(" " * 20 + "".join(f"{c:>{len(c) + 2}}" for c in columns))
    out = np.zeros((INSTANCES, STEPS, len(OUTPUTS)))
    for case in CASES:
        states = simulate_many("Synchronizer", H, case.inputs, ["state", "syn_ramp_on"], start=case.start)
        assert not states.failures
        executing, ramping = float((states["state"] > 0.0).mean()), float(states["syn_ramp_on"].mean())
        python = measure_shortest(3, partial(step_python_block, case))[0] / STEPS
        for threads in (1, 2):
            batch = partial(
                simulate_many, "Synchronizer", H, case.inputs, OUTPUTS, start=case.start, threads=threads, out=out
            )
            processor, clock = (seconds / INSTANCES / STEPS for seconds in measure_shortest(repetitions, batch))
            values = (
                f"{executing:.0%}",
                f"{ramping:.0%}",
                f"{threads}",
                f"{processor * 1e9:.1f}",
                f"{1e-6 / processor:.1f}",
                f"{1e-6 / clock:.1f}",
                f"{python * 1e9:.0f} ns",
                f"{python / processor:.0f}",
            )
            print(f"{case.name:20}" + "".join(f"{v:>{len(c) + 2}}" for v, c in zip(values, columns, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description="Steps per second and core of simulate_many on the Synchronizer.")
    parser.add_argument("--repetitions", type=int, default=9)
    repetitions = parser.parse_args().repetitions
    print_throughput(repetitions)
    print_measures(repetitions)
    print_memory()


if __name__ == "__main__":
    main()
