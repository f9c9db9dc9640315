"""The wheel in a fresh environment, used in an empty folder: without extras, and then with the compilers.

One block serves for all: that each of them is built and runs in both flavours is proved in the checkout.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from tests import ROOT
from tests.install.resolver import environment

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="they need Linux"),
]

SHORT_LINE = """
title = "A synchronizer behind a fieldbus, for two seconds: too short for RemoteSync to be in sync"
source = "motionsync"
fmu = "Synchronizer"
stop_time = 2.0
step_size = 0.01

[remote]
segments = [{ duration = 0.5, acceleration = 720.0 }]
sender_cycle = 0.01

[[expect]]
from = 1.0
to = 2.0
"slave.velocity" = { min = 359.0, max = 361.0 } # 720 u/s2 * 0.5 s
"""
Done = subprocess.CompletedProcess[str]


class Installation:
    """A virtual environment with the wheel, and an empty folder to work in."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "work"
        self.folder.mkdir()
        self.cache = folder / "cache"
        self.bin = folder / "env" / "bin"
        self.uv("venv", folder / "env", "--python", sys.executable)
        self.uv("build", "--wheel", "--out-dir", folder / "wheel", "--python", sys.executable, ROOT)
        (self.wheel,) = (folder / "wheel").glob("*.whl")
        self.pip("install", "--quiet", "--no-compile", "--no-deps", self.wheel)
        self.install("")

    def install(self, extra: str) -> None:
        """Install what the wheel needs with an extra, by uv, which links the files of its cache."""
        self.uv("pip", "install", "--python", self.bin / "python", f"{self.wheel}{extra}")

    def pip(self, *arguments: str | Path) -> None:
        """This process's pip: one of the environment's own would take longer."""
        self.call(sys.executable, "-m", "pip", "--python", self.bin / "python", *arguments)

    def uv(self, *arguments: str | Path) -> None:
        command = [sys.executable, "-m", "uv", *map(str, arguments)]
        done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    def forget(self) -> None:
        """Empty the folder to work in, and the cache."""
        for folder in (self.folder, self.cache):
            shutil.rmtree(folder)
            folder.mkdir()

    def motionsync(self, *arguments: str | Path) -> Done:
        return self.call(self.bin / "motionsync", *arguments, check=False)

    def call(self, *command: str | Path, check: bool = True) -> Done:
        """Run a command in the empty folder; it sees neither the checkout nor what other runs have kept."""
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        environment["XDG_CACHE_HOME"] = str(self.cache)
        environment.setdefault("ZIG_GLOBAL_CACHE_DIR", str(Path.home() / ".cache" / "zig"))
        done = subprocess.run(
            [*map(str, command)],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0 or not check, done.stderr
        return done


@pytest.mark.all_blocks
def test_without_extras_and_then_with_the_compilers(tmp_path: Path) -> None:
    """In one environment, since to make it takes longest. pip has to agree with what uv has installed."""
    installation = Installation(tmp_path)
    without_extras(installation)
    installation.forget()
    installation.install("[native]")
    installation.pip("check")
    with_the_compilers(installation)


def without_extras(plain: Installation) -> None:
    the_wheel_brings_the_scenarios_and_lines(plain)
    assert not list(plain.folder.iterdir())
    a_run_takes_the_python_flavour(plain)
    a_build_takes_the_python_flavour(plain)
    the_native_flavour_is_refused(plain)
    a_line_runs(plain)
    a_batch_is_compiled(plain)


def with_the_compilers(native: Installation) -> None:
    a_run_takes_the_native_flavour(native)
    a_batch_is_compiled(native)


def outcome(done: Done) -> dict[str, object]:
    """The one outcome that a command printed as JSON."""
    (result,) = json.loads(done.stdout)
    assert isinstance(result, dict)
    return result


def the_wheel_brings_the_scenarios_and_lines(plain: Installation) -> None:
    done = plain.motionsync("list")
    assert done.returncode == 0, done.stderr
    for name in BLOCKS:
        there = len(list((ROOT / "scenarios" / name).glob("*/scenario.toml")))
        assert re.search(rf"^ *{name} +{there} ", done.stdout, re.M)
    assert "line/line.toml" in done.stdout


def a_run_takes_the_python_flavour(plain: Installation) -> None:
    done = plain.motionsync("run", "Synchronizer/polynomial", "--json")
    assert done.returncode == 0, done.stderr
    messages, building, *_ = done.stderr.splitlines()
    assert messages.startswith("ziglang is not installed, ")
    assert "the python flavour is taken" in messages
    assert "motionsync[" not in messages  # in an index of packages this might be a stranger's
    assert re.search(r"pip install 'ziglang==[\w.]+'\)$", messages)
    assert building.startswith(f"building {plain.cache}")
    assert outcome(done)["passed"]
    assert outcome(done)["reference"]
    assert (plain.folder / "build/reports/Synchronizer/polynomial/report.html").is_file()


def a_build_takes_the_python_flavour(plain: Installation) -> None:
    done = plain.motionsync("build", "Synchronizer")
    assert done.returncode == 0, done.stderr
    assert done.stderr.startswith("ziglang is not installed, ")
    assert [fmu.parent.name for fmu in plain.folder.rglob("Synchronizer.fmu")] == ["python"]


def the_native_flavour_is_refused(plain: Installation) -> None:
    for command in (("run", "Synchronizer/polynomial"), ("build", "Synchronizer")):
        done = plain.motionsync(*command, "--flavour", "native")
        assert done.returncode == 2
        requested = r"with \w+, which is not installed: pip install 'ziglang==[^']+'"
        assert re.search(requested, done.stderr)


def a_run_takes_the_native_flavour(native: Installation) -> None:
    done = native.motionsync("run", "Synchronizer/polynomial", "--json")
    assert done.returncode == 0, done.stderr
    assert "for this machine alone" in done.stderr
    assert outcome(done)["passed"]
    (fmu,) = native.cache.rglob("native-*/*/Synchronizer.fmu")
    with zipfile.ZipFile(fmu) as z:
        assert len([name for name in z.namelist() if name.startswith("binaries/")]) == 1


def a_line_runs(installation: Installation) -> None:
    (installation.folder / "short.toml").write_text(SHORT_LINE)
    done = installation.motionsync("line", "short.toml", "--json", "--no-report")
    assert done.returncode == 1, done.stderr
    result = outcome(done)
    expectations = result["expectations"]
    assert isinstance(expectations, list)
    assert [(check["expected"], check["passed"]) for check in expectations[:1]] == [("RemoteSync in sync", False)]
    assert [check["passed"] for check in expectations[1:]] == [True]


def a_batch_is_compiled(installation: Installation) -> None:
    """By zig, or where zig is missing by the machine's C compiler. The slave is at 3 u/s * 1 s, with its master."""
    script = "from motionsync_fmu.batch.simulation import simulate_many as many\n"
    script += "print(many('Synchronizer', 1.0, {'master.velocity': 3.0}, 'slave.position').values)"
    done = installation.call(installation.bin / "python", "-c", script)
    assert done.stdout == "[[[3.]]]\n"
