"""Steps per second and core of `simulate_many` on the Synchronizer, beside the plain Python block, in one run.

    python benchmarks/batch_throughput.py

Steady: the slave follows the master one to one. Mixed: every second turn a stop or a start is given, so that the slave
waits, ramps, rests and follows in turn; a command executes while the slave waits or ramps. The phasing differs between
the instances; three outputs are read at each step.

A core's rate is measured in processor time, so that it does not depend on other programs; `wall` is the rate of
all threads together by the clock. The best of several repetitions counts.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.synchronizer.block import Synchronizer
from motionsync_fmu.native.batch import simulate_many

INSTANCES, STEPS, H, VELOCITY, TURN = 64, 20_000, 1e-3, 180.0, 360.0
OUTPUTS = ["slave.position", "slave.velocity", "state"]
TARGET = 20e6  # steps per second and core


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


def shortest(repetitions: int, action: Callable[[], Any]) -> tuple[float, float]:
    """Processor time and time by the clock, in s, each the shortest of all repetitions."""
    processor, clock = [], []
    for _ in range(repetitions):
        begin = time.process_time(), time.perf_counter()
        action()
        processor.append(time.process_time() - begin[0])
        clock.append(time.perf_counter() - begin[1])
    return min(processor), min(clock)


def plain(case: Case) -> None:
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


def main() -> None:
    parser = argparse.ArgumentParser(description="Steps per second and core of simulate_many on the Synchronizer.")
    parser.add_argument("--repetitions", type=int, default=9)
    repetitions = parser.parse_args().repetitions
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
        python = shortest(3, partial(plain, case))[0] / STEPS
        for threads in (1, 2):
            batch = partial(
                simulate_many, "Synchronizer", H, case.inputs, OUTPUTS, start=case.start, threads=threads, out=out
            )
            processor, clock = (seconds / INSTANCES / STEPS for seconds in shortest(repetitions, batch))
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


if __name__ == "__main__":
    main()
