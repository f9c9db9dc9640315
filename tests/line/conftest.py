"""The lines of the scenarios, each run once."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.production_line.evaluation import LineResult, evaluate_line
from motionsync_fmu.production_line.line import ProductionLine
from motionsync_fmu.production_line.package import LinePackage, write_package
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.production_line.variants import Variant
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.scenarios.lines import MACHINE, SAW, SYNCHRONIZER, copied, evaluated, replaced

FEW = (  # seven cuts; a clock that is 3000 ppm fast: a beat each 1.33 s
    ("stop_time = 149.7", "stop_time = 8.0"),
    ("sender_cycle = 0.00399880035989204 # 4 ms / 1.0003", "sender_cycle = 0.003988035892323031"),
    ("at = 20.0", "at = 3.2"),
    ("count = 200", "count = 7"),
    ("to = 149.7", "to = 8.0"),
)

Evaluate = Callable[[ProductionLine, LinePackage], LineResult]


@dataclass(frozen=True)
class Examined:
    line: ProductionLine
    package: LinePackage
    result: LineResult

    def variant(self, name: str) -> Variant:
        return next(v for v in self.result.variants if v.name == name)


@pytest.fixture(scope="session")
def output(shared: Shared, fmus: Fmus, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of this process with all lines' packages."""
    return copied(shared, fmus, tmp_path_factory.mktemp("lines"))


def examined(file: Path, output: Path, evaluate: Evaluate = evaluate_line) -> Examined:
    line = load_line(file)
    package = write_package(line, Flavour.NATIVE, output, pytest.fail)
    return Examined(line, package, evaluate(line, package))


@pytest.fixture(scope="session")
def saw(output: Path, shared: Shared) -> Examined:
    return examined(SAW, output, partial(evaluated, shared))


@pytest.fixture(scope="session")
def synchronizer(output: Path, shared: Shared) -> Examined:
    return examined(SYNCHRONIZER, output, partial(evaluated, shared))


@pytest.fixture(scope="session")
def machine(output: Path, tmp_path_factory: pytest.TempPathFactory) -> Examined:
    """The first seven cuts of line_cut_to_length.toml."""
    file = tmp_path_factory.mktemp("few") / MACHINE.name
    file.write_text(replaced(MACHINE.read_text(), *FEW))
    return examined(file, output)
