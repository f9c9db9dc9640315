"""A scenario with known results, and helpers for tests of the commands that build and run its FMU."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

from tests.support.project.command_line import Outcome

FLAVOURS = ("native", "python")
PYTHON = ("--flavour", "python")  # the quicker one to build, for tests that need any flavour

# A master at 100 mm/s. Along the parabola the slave leaves it at rest_value - phasing. Half way to the end the master
# is at rest_value, and the slave has moved 3/4 of the phasing and has half the master's velocity.
STOP = """\
title = "A stop along a parabola"
source = "By hand"
fmu = "Synchronizer"
stop_time = 0.5
step_size = 0.01

[start]
curve = "PARABOLA"
output_phasing = 10.0
rest_value = 30.0

[master]
velocity = 100.0

[[set]]
at = 0.1
stop = true

[[expect]]
at = 0.3
"slave.position" = 27.5
"slave.velocity" = 50.0
tolerance = 1e-9

[[expect]]
when = "synchronized == false"
time = 0.4

[[expect]]
from = 0.0
to = 0.5
"slave.velocity" = { min = 0.0, max = 100.0 }
"""


def process(folder: Path, *arguments: str, **environment: str) -> Outcome:
    """The console script itself, in a process of its own."""
    script = Path(sys.executable).with_name("motionsync")
    finished = subprocess.run(
        [script, *arguments], cwd=folder, env=os.environ | environment, capture_output=True, check=False
    )
    return Outcome(
        finished.returncode, finished.stdout.decode(errors="replace"), finished.stderr.decode(errors="replace")
    )


def without_progress(folder: Path) -> dict[str, str]:
    """An environment in which a process shows no progress, however long a busy machine takes; it needs a folder."""
    folder.mkdir()
    (folder / "sitecustomize.py").write_text("from motionsync_fmu.pages import progress\n\nprogress.PATIENCE = 1e3\n")
    path = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {"PYTHONPATH": os.pathsep.join(path)}


def scenario(folder: str, text: str = STOP) -> Path:
    file = Path(folder, "scenario.toml")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    return file


def description(fmu: Path) -> Element:
    with zipfile.ZipFile(fmu) as z:
        return fromstring(z.read("modelDescription.xml"))


def start_value(fmu: Path, name: str) -> str | None:
    (variable,) = description(fmu).iterfind(f"ModelVariables/ScalarVariable[@name='{name}']/*")
    return variable.get("start")


def the_fmu(folder: str) -> Path:
    (file,) = Path(folder).rglob("*.fmu")
    return file
