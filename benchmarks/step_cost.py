"""What a step costs: the bare block, its FMU through FMPy, and a do-nothing PythonFMU slave of the same interface.

All in one run, in turns, so that the ratios hold on a busy machine: python benchmarks/step_cost.py [--steps 20000]
"""

import argparse
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

from cost import VELOCITY, H, cost_table, measure, through_fmpy, timed
from rich.console import Console

from motionsync.synchronizer import Synchronizer
from motionsync_fmu.archive import write
from motionsync_fmu.build import Recipe, build_python
from motionsync_fmu.host import Host

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


def idle(fmu: Path, target: Path) -> Path:
    """The same FMU with a slave that does nothing."""
    with zipfile.ZipFile(fmu) as z:
        files = {n: z.read(n) for n in z.namelist() if "/synchronizer_" not in n}
    files |= {"resources/slavemodule.txt": b"idle_slave", "resources/idle_slave.py": IDLE.encode()}
    write(target, files)
    return target


def bare(ramping: bool) -> Callable[[int], None]:
    """Steps of the block in plain Python: on the master, or all the way along a ramp."""
    block = Synchronizer()
    block.output_phasing = 1e9 if ramping else 90.0
    block.initialize()
    block.stop = ramping
    block.master.velocity = VELOCITY
    block.master.position = -2e9
    block.step(H)
    block.master.position = 0.0

    def steps(n: int) -> None:
        master, step = block.master, block.step
        for _ in range(n):
            master.position += VELOCITY * H
            step(H)

    return steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=20_000, help="steps a round")
    n = parser.parse_args().steps
    with tempfile.TemporaryDirectory() as folder:
        fmu = build_python(Recipe("Synchronizer"), Path(folder) / "Synchronizer.fmu")
        with Host(fmu) as whole, Host(idle(fmu, Path(folder) / "idle.fmu")) as nothing:
            subjects = {
                "bare block, on the master": timed(bare(False)),
                "bare block, in a ramp": timed(bare(True)),
                "FMU through FMPy": timed(through_fmpy(whole)),
                "do-nothing slave through FMPy": timed(through_fmpy(nothing)),
            }
            found = measure(subjects, n)
    base = "do-nothing slave through FMPy"
    Console(highlight=False).print(cost_table(found, base, "of the do-nothing slave"))


if __name__ == "__main__":
    main()
