"""The packages of the scenarios' lines, built once in a test run."""

import shutil
from pathlib import Path

from motionsync_fmu.build import Flavour
from motionsync_fmu.line.package import write_package
from motionsync_fmu.line.reader import load_line
from tests import ROOT
from tests.support.fmus import Fmus, Shared

LINES = ROOT / "scenarios" / "line"
SAW, SYNCHRONIZER = LINES / "line.toml", LINES / "line_synchronizer.toml"


def copied(shared: Shared, fmus: Fmus, own: Path) -> Path:
    """A folder of this process with both lines' packages, whose FMUs are built once for all processes."""

    def fill(folder: Path) -> None:
        for name in ("FlyingSaw", "Synchronizer"):
            fmus.copied(Flavour.NATIVE, name, folder)
        for file in (SAW, SYNCHRONIZER):
            write_package(load_line(file), Flavour.NATIVE, folder, lambda text: None)

    return Path(shutil.copytree(shared.once("lines", fill), own, dirs_exist_ok=True))
