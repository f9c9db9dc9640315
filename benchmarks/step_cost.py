"""What a step costs: the bare block, its FMU through FMPy, and a do-nothing PythonFMU slave of the same interface.

All are measured in one run, in turns, so that the ratios hold on a busy machine:

    python benchmarks/step_cost.py [--block FlyingSaw] [--steps 20000]
"""

import argparse
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cases import MEASURED, cases_of
from cases.measured import VELOCITY, H, MovingAxis, Steady, counted
from cost import cost_table, measure, start_case, through_fmpy, timed
from rich.console import Console

from motionsync_fmu.fmus.fmu import build_python
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance

LEAD = 2000  # steps until a remote axis is in sync; nothing is checked before
NOTHING = "do-nothing slave through FMPy"

IDLE = """
from pythonfmu import Fmi2Slave
import ctypes


class IdleSlave(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

    def do_step(self, current_time, step_size):
        return True

    def get_real(self, references):
        return [0.0] * len(references)

    def get_integer(self, references):
        return [0] * len(references)

    def get_boolean(self, references):
        return [False] * len(references)

    def set_real(self, references, values):
        pass

    set_integer = set_boolean = set_real
"""


def idle(fmu: Path, block: str, target: Path) -> Path:
    """A copy of the FMU with a slave that does nothing."""
    with zipfile.ZipFile(fmu) as z:
        files = {n: z.read(n) for n in z.namelist() if f"/{block.lower()}_" not in n}
    files |= {"resources/slavemodule.txt": b"idle_slave", "resources/idle_slave.py": IDLE.encode()}
    write_zip(target, files)
    return target


def bare(block: Any, case: Steady, axis: MovingAxis) -> Callable[[int], None]:
    """A function that does a number of steps of the block in plain Python."""
    stepper = Stepper(block).initialize(case.start)
    stepper.step(case.first, {f"{axis.group}.velocity": VELOCITY, **case.begin})
    moving, counter = getattr(block, axis.group), axis.counter.rpartition(".")[2]
    moving.position = 0.0
    steps_done = 0

    def steps(n: int) -> None:
        nonlocal steps_done
        step = block.step
        for i in range(steps_done, steps_done + n):
            moving.position += moving.velocity * H
            if case.change:
                moving.velocity = VELOCITY * (1.0 + case.change * (i % 2))
            if counter:
                setattr(moving, counter, counted(case.counts, i * H))
            step(H)
        steps_done += n
        if steps_done < LEAD:
            return
        for name, value in case.holds.items():
            assert stepper[name] == value, f"{case.name}: {name} is {stepper[name]}, it should be {value}"

    return steps


def report(block: str, n: int, folder: Path) -> Any:
    cases, axis = cases_of(block).steady, cases_of(block).axis
    fmu = build_python(Recipe(block), folder / f"{block}.fmu")
    with FmuInstance(fmu) as whole, FmuInstance(idle(fmu, block, folder / f"{block} idle.fmu")) as nothing:

        def steps(host: FmuInstance) -> Callable[[int], None]:
            return through_fmpy(start_case(host, cases[0], axis), cases[0], axis)

        subjects = {
            **{f"{block} bare, {case.name}": timed(bare(Recipe(block).block(), case, axis)) for case in cases},
            f"its FMU through FMPy, {cases[0].name}": timed(steps(whole)),
            NOTHING: timed(steps(nothing)),
        }
        return cost_table(measure(subjects, n), NOTHING, "of the do-nothing slave")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--block", choices=MEASURED, help="all of them, if none is named")
    parser.add_argument("--steps", type=int, default=20_000, help="steps a round")
    options = parser.parse_args()
    console = Console(highlight=False, width=120)
    with tempfile.TemporaryDirectory() as folder:
        for block in [options.block] if options.block else MEASURED:
            console.print(report(block, options.steps, Path(folder)))
            console.print()


if __name__ == "__main__":
    main()
