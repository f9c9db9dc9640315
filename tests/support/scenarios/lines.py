"""The packages of the scenarios' lines, built once in a test run."""

import math
import pickle
import shutil
from pathlib import Path

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.production_line.evaluation import LineResult, evaluate_line
from motionsync_fmu.production_line.line import REMOTE, ProductionLine
from motionsync_fmu.production_line.package import LinePackage, write_package
from motionsync_fmu.production_line.reader import load_line
from tests import ROOT
from tests.support.hosts.fmus import Fmus, Shared

LINES = ROOT / "scenarios" / "line"
SAW, SYNCHRONIZER = LINES / "line.toml", LINES / "line_synchronizer.toml"
MACHINE = LINES / "line_cut_to_length.toml"


def copied(shared: Shared, fmus: Fmus, own: Path) -> Path:
    """A folder of this process with all lines' packages, whose FMUs are built once for all processes."""

    def fill(folder: Path) -> None:
        for name in ("FlyingSaw", "Synchronizer", "CutToLength"):
            fmus.copied(Flavour.NATIVE, name, folder)
        saw = load_line(SAW)
        remote = write_package(saw, Flavour.NATIVE, folder, lambda text: None).fmus[REMOTE]
        for line in map(load_line, (SYNCHRONIZER, MACHINE)):
            if line.recipes[REMOTE] == saw.recipes[REMOTE]:  # no second build of it
                (folder / line.name).mkdir()
                shutil.copyfile(remote, folder / line.name / remote.name)
            write_package(line, Flavour.NATIVE, folder, lambda text: None)

    return Path(shutil.copytree(shared.once("lines", fill), own, dirs_exist_ok=True))


def evaluated(shared: Shared, line: ProductionLine, package: LinePackage) -> LineResult:
    """The result of a line of the scenarios with its own package: its runs take seconds, and are made once for all
    processes."""

    def fill(folder: Path) -> None:
        (folder / "result.pickle").write_bytes(pickle.dumps(evaluate_line(line, package)))

    name = line.follower.file.stem
    result: LineResult = pickle.loads((shared.once(f"results/{name}", fill) / "result.pickle").read_bytes())
    return result


def integrated(phases: list[tuple[float, float]], t: float) -> float:
    """Position at t of an axis that starts at rest, from durations and accelerations."""
    position, velocity = 0.0, 0.0
    for duration, acceleration in [*phases, (math.inf, 0.0)]:
        elapsed = min(duration, t)
        position += velocity * elapsed + 0.5 * acceleration * elapsed * elapsed
        velocity += acceleration * elapsed
        if (t := t - elapsed) <= 0.0:
            break
    return position


def replaced(text: str, *changes: tuple[str, str]) -> str:
    """A text in which each of these texts, which is there once, is replaced."""
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text
