"""The C text of a block: the names and comments of the source, the same in every process, without warnings."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from ctypes import create_string_buffer
from functools import cache
from pathlib import Path

import pytest

from motionsync import Gearing
from motionsync.blocks import BLOCKS
from motionsync_fmu.batch.library import library
from motionsync_fmu.compiler.memory_layout import image
from motionsync_fmu.compiler.translator import c_source
from motionsync_fmu.errors import UserError
from motionsync_fmu.native.libraries import ZIG
from tests.support.compiler.modules import load_module

SAMPLE = '''"""A sample of the text."""

from dataclasses import dataclass

from motionsync import var
from motionsync.var import Enumeration

STEEP = 2.0 / 3.0  # of the ramp
LEAST = 1e-12  # u


class Refusal(Enumeration):
    """Why a call fails"""

    NONE = 0, "done"
    LONG = 1, "the step is too long"


@dataclass(slots=True)
class Ramp:
    """How far the slave is.

    It grows with each step."""

    travel: float = var.output(0.5, "what is covered")
    laps: list[float] = var.array(3)
    times: list[float] = var.array(3)
    rows: list[float] = var.array(6)

    def advance(self, h: float, gain: float) -> None:
        """Add what a step covers."""
        rate, lap = shares(h, gain)
        for i in range(3):
            self.laps[i] += rate  # each lap
        # The last lap counts twice.
        self.laps[lap] = self.laps[-1] + (self.travel - rate)
        self.rows[(lap + 1) % 6] = rate
        if rate != 0.0:
            self.times[lap] += self.laps[lap] / rate
            self.rows[2 * lap] = self.rows[2 * lap + 1] / gain - rate / gain
        self.travel += STEEP * rate


@dataclass(slots=True)
class Sampled:
    ramp: Ramp = var.part(Ramp)
    gain: float = var.input(1.0, "the gain")

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        if h > 1.0:
            return Refusal.LONG
        self.ramp.advance(h, self.gain)
        return Refusal.NONE


def shares(h: float, gain: float) -> tuple[float, int]:
    """The rate, u/s, and the lap in which it counts."""
    return h / gain, 1 if gain > LEAST else 0
'''
IN_C = """\
/* Add what a step covers. */
static void Ramp_advance(Ramp *self, double h, double gain, bool *failed) {
    const Tuple_di shares = sampled_of_this_run_shares(h, gain, failed);
    const double rate = shares.v0;
    const int64_t lap = shares.v1;
    for (int64_t i = 0; i < 3; i++) {
        self->laps[i] += rate; /* each lap */
    }
    /* The last lap counts twice. */
    self->laps[index_in(lap, 3, failed)] = self->laps[index_in(-1, 3, failed)] + (self->travel - rate);
    self->rows[py_mod_int(lap + 1, 6)] = rate;
    if (rate != 0.0) {
        self->times[index_in(lap, 3, failed)] += self->laps[index_in(lap, 3, failed)] / nonzero(rate, failed);
        self->rows[index_in(2 * lap, 6, failed)] = self->rows[index_in(2 * lap + 1, 6, failed)] / nonzero(gain, failed)
            - rate / nonzero(gain, failed);
    }
    self->travel += STEEP * rate;
}
"""
STRUCT_IN_C = """\
/* How far the slave is.
 *
 * It grows with each step. */
typedef struct {
    double travel; /* output: what is covered */
    double laps[3];
    double times[3];
    double rows[6];
} Ramp;
"""


def test_the_text_keeps_the_names_the_comments_and_the_docstrings(tmp_path: Path) -> None:
    block = load_module(tmp_path, "sampled_of_this_run", SAMPLE).Sampled()
    files = {name: text.decode() for name, text in c_source(block).items()}
    assert IN_C in files["block.c"]
    assert "static const double STEEP = 0.6666666666666666; /* 2.0 / 3.0; of the ramp */" in files["block.c"]
    assert "    .ramp = {\n        .travel = 0.5,\n    },\n    .gain = 1.0,\n" in files["block.c"]
    assert STRUCT_IN_C in files["block.h"]
    assert "    Refusal_LONG = 1, /* the step is too long */" in files["block.h"]
    assert all(len(line) <= 120 for text in files.values() for line in text.splitlines())


def test_a_block_outside_the_subset_is_refused_with_file_and_line(tmp_path: Path) -> None:
    text = SAMPLE.replace("h / gain, 1 if", "h ** gain, 1 if").replace("class Sampled", "class Wrong")
    block = load_module(tmp_path, "wrong_of_this_run", text).Wrong()
    line = text[: text.index("h ** gain")].count("\n") + 1
    with pytest.raises(UserError, match=rf"wrong_of_this_run\.py:{line}: no `\*\*`"):
        c_source(block)


@pytest.mark.slow
def test_the_text_is_the_same_in_another_process_with_another_seed_for_hashes(blocks: list[str]) -> None:
    script = "import hashlib; from motionsync.blocks import BLOCKS\n"
    script += "from motionsync_fmu.compiler.translator import c_source\n"
    script += f"for name in {blocks}: "
    script += "print(*(hashlib.sha256(t).hexdigest() for t in c_source(BLOCKS[name]()).values()))"
    seed = os.environ | {"PYTHONHASHSEED": "7"}
    done = subprocess.run([sys.executable, "-c", script], env=seed, capture_output=True, text=True, check=True)
    texts = [" ".join(hashlib.sha256(text).hexdigest() for text in c_source_of(name).values()) for name in blocks]
    assert done.stdout.splitlines() == texts


def test_blocks_with_other_start_values_differ_in_these_alone() -> None:
    """The functions of a class are translated once in a process."""
    a, b = Gearing(), Gearing()
    b.start = True
    texts = [c_source(block)["block.c"].partition(b"static const Block START") for block in (a, b, a)]
    assert texts[0] == texts[2]
    assert texts[0][0] == texts[1][0]
    assert texts[0][2] != texts[1][2]


@cache
def c_source_of(name: str) -> dict[str, bytes]:
    return c_source(BLOCKS[name]())


@pytest.mark.slow
def test_the_start_image_has_each_field_where_python_and_numpy_see_it(block: str) -> None:
    memory = image(BLOCKS[block]())
    start_image = create_string_buffer(memory.nbytes)
    library(BLOCKS[block]).block_start(start_image)
    assert start_image.raw == memory.tobytes()


# --- C compilers ---

WARNINGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]
LARGEST_STACK = 2048  # bytes of stack: what a step needs at most, on x86-64 by gcc


@pytest.fixture
def folder(block: str, tmp_path: Path) -> Path:
    """The C of a block."""
    for name, text in c_source_of(block).items():
        (tmp_path / name).write_bytes(text)
    return tmp_path


def gcc(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    return subprocess.run(["gcc", *arguments, "-c", "block.c"], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["x86_64-linux-gnu", "x86_64-windows-gnu"])
def test_clang_finds_nothing_to_warn_of(folder: Path, target: str) -> None:
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *WARNINGS, "-c"]
    command += ["-Wno-unused-command-line-argument", "block.c", "-o", "block.o"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert ZIG.exists()


@pytest.mark.slow
def test_gcc_finds_nothing_to_warn_of_and_a_step_needs_little_stack(block: str, folder: Path) -> None:
    done = gcc("-O2", *WARNINGS, "-fcallgraph-info=su", folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    own, calls = call_graph((folder / "block.ci").read_text())
    assert {"block_start", "block_initialize", "block_step"} <= own.keys()
    external = {callee for callees in calls.values() for callee in callees} - own.keys()
    assert external <= {"sqrt", "floor", "rint", "fmod", "fabs", "memcpy", "memset"}
    needs = {entry: stack_need(entry, own, calls, ()) for entry in ("block_initialize", "block_step")}

    assert max(needs.values()) <= LARGEST_STACK


def call_graph(text: str) -> tuple[dict[str, int], dict[str, list[str]]]:
    """Of gcc's call graph: the stack that each function needs itself, bytes, and what it calls."""
    calls: dict[str, list[str]] = {}
    name_in_file = r'"(?:block\.c:)?([\w.]+)"'
    own = {name: int(size) for name, size in re.findall(rf'title: {name_in_file} label: "[^"]*?(\d+) bytes', text)}
    for caller, callee in re.findall(rf"sourcename: {name_in_file} targetname: {name_in_file}", text):
        calls.setdefault(caller, []).append(callee)
    return own, calls


def stack_need(name: str, own: dict[str, int], calls: dict[str, list[str]], callers: tuple[str, ...]) -> int:
    """The stack that a function needs with all that it calls; it never calls itself."""
    assert name not in callers, f"{name} calls itself"
    callees = [stack_need(callee, own, calls, (*callers, name)) for callee in calls.get(name, [])]
    return own.get(name, 0) + max(callees, default=0)


@pytest.mark.parametrize(
    "flag",
    [
        "-ffast-math",
        "-ffinite-math-only",
        "-freciprocal-math",
        "-fno-signed-zeros",
        "-funsafe-math-optimizations",
        "-mfpmath=387",
    ],
)
def test_a_compiler_that_may_change_results_is_refused(tmp_path: Path, flag: str) -> None:
    for name, text in c_source_of("Synchronizer").items():
        (tmp_path / name).write_bytes(text)
    done = gcc("-fsyntax-only", flag, folder=tmp_path)
    assert "#error" in done.stderr, done.stderr
    assert gcc("-fsyntax-only", "-O3", folder=tmp_path).returncode == 0


@pytest.mark.slow
def test_no_fused_operation_is_made_even_where_the_processor_has_it(tmp_path: Path) -> None:
    for name, text in c_source_of("Synchronizer").items():
        (tmp_path / name).write_bytes(text)
    for pragmas, fused in ((True, False), (False, True)):
        text = (tmp_path / "block.c").read_text()
        (tmp_path / "block.c").write_text(text if pragmas else re.sub("^#pragma.*$", "", text, flags=re.M))
        done = gcc("-std=gnu99", "-O3", "-march=haswell", "-S", "-o", "block.s", folder=tmp_path)
        assert done.returncode == 0, done.stderr
        assert ("vfmadd" in (tmp_path / "block.s").read_text()) == fused
