"""The FMI functions of the native flavour under a fuzzing host, watched by gcc's address and behaviour sanitizers."""

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isinf
from pathlib import Path
from typing import Any

import pytest

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput
from motionsync.remote_sync.block import MOST_CYCLES
from motionsync_fmu.compiler.memory_layout import dtype, offset
from motionsync_fmu.compiler.translator import c_source
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.interface.variables import LONGEST_STEP, Variable, cells, refusals, variables
from motionsync_fmu.native import libraries
from motionsync_fmu.native.libraries import HEADERS
from motionsync_fmu.native.tables import model_header

FOLDER = Path(__file__).parent
UNIT = Path(libraries.__file__).parent
SEED = 2
CALLS = 60_000  # of each block: enough for all kinds of calls
LONG = 1_000_000  # in the long form
SEVERAL, OFTEN = 3, 15  # of how many calls each kind has to be, at least
MODES = {"nowhere", "instantiated", "initializing", "stepping", "terminated"}
SANITIZERS = [
    "-fsanitize=address,undefined,float-cast-overflow",
    "-fno-sanitize-recover=all",
    "-fno-omit-frame-pointer",
]
FLAGS = ["-std=c11", "-D_POSIX_C_SOURCE=200809L", "-g1", "-ffp-contract=off", "-fno-strict-aliasing"]
OPTIONS = {"ASAN_OPTIONS": "detect_leaks=1:abort_on_error=1", "UBSAN_OPTIONS": "print_stacktrace=1"}

# What cannot succeed, what cannot fail, and what may answer Discard or Warning.
NO_MODEL_EXCHANGE = {
    "fmi2EnterEventMode",
    "fmi2NewDiscreteStates",
    "fmi2EnterContinuousTimeMode",
    "fmi2CompletedIntegratorStep",
    "fmi2SetTime",
    "fmi2SetContinuousStates",
    "fmi2GetDerivatives",
    "fmi2GetEventIndicators",
    "fmi2GetContinuousStates",
    "fmi2GetNominalsOfContinuousStates",
}
UNKNOWN_STATUS = {"fmi2GetStatus", "fmi2GetIntegerStatus", "fmi2GetStringStatus"}
NOT_OFFERED = re.findall(r"NOT_OFFERED\((fmi3\w+)", (UNIT / "fmi3.c").read_text())


@dataclass(frozen=True)
class Answers:
    """Which functions of a version never answer OK or Error, and which sometimes answer Discard or Warning."""

    never_ok: set[str]
    never_error: set[str]
    discard: set[str]
    warning: set[str]


ANSWERS = {
    Fmi.TWO: Answers(
        NO_MODEL_EXCHANGE | UNKNOWN_STATUS | {"fmi2CancelStep", "fmi2GetDirectionalDerivative"},
        {"fmi2GetTypesPlatform", "fmi2GetVersion", "fmi2FreeInstance"},
        UNKNOWN_STATUS | {"fmi2GetRealStatus", "fmi2GetBooleanStatus"},
        {"fmi2SetRealInputDerivatives"},
    ),
    Fmi.THREE: Answers(
        {*NOT_OFFERED, "fmi3InstantiateModelExchange", "fmi3InstantiateScheduledExecution"},
        {"fmi3GetVersion", "fmi3FreeInstance"},
        {"fmi3DoStep"},
        set(),
    ),
}
RECIPES = [*map(Recipe, BLOCKS), Recipe("RemoteSync", fmi=Fmi.THREE)]

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc with its sanitizers is not installed")


@pytest.fixture(scope="module", params=RECIPES, ids=lambda recipe: f"{recipe.name}-{recipe.fmi}")
def recipe(request: pytest.FixtureRequest) -> Recipe:
    result: Recipe = request.param
    return result


@pytest.fixture(scope="module")
def fuzzer(recipe: Recipe, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The unit's C files, the block and the fuzzing host, instrumented, as one program."""
    folder = tmp_path_factory.mktemp("fuzz")
    for name, text in c_source(recipe.block()).items():
        (folder / name).write_bytes(text)
    (folder / "model.h").write_text(model_header(recipe.block(), compute_guid(recipe), fmi=recipe.fmi))
    (folder / "expected.h").write_text(expected_header(recipe))
    sources = [
        *(str(UNIT / name) for name in (f"fmi{recipe.fmi}.c", "instance.c", "memory.c")),
        str(FOLDER / f"fuzz{recipe.fmi}.c"),
        "block.o",
        "-lm",
        "-Wl,--wrap=malloc,--wrap=calloc",
    ]
    command = ["gcc", *FLAGS, *SANITIZERS, "-I.", "-isystem", str(HEADERS)]
    subprocess.run([*command, "-O1", "-c", "block.c"], cwd=folder, check=True)  # it runs longer than it compiles
    subprocess.run([*command, "-O0", *sources, "-o", "fuzz"], cwd=folder, check=True)
    return folder / "fuzz"


def expected_header(recipe: Recipe) -> str:
    """What an importer expects of the unit, from the declarations and not from the unit's own tables."""
    vs = variables(recipe.block())
    index = {v.name: i for i, v in enumerate(vs)}
    names = {
        "POSITION": "master.position",
        "VELOCITY": "master.velocity",
        "ACCELERATION": "master.acceleration",
        "PERIOD": "master.period",
        "INPUT_MODE": "master.input_mode",
        "TASK_CYCLE": "task_cycle_time",
    }
    derivatives = ["slave.position", "slave.velocity", "slave.acceleration"]
    slave = [index[name] for name in derivatives] if index.keys() >= {*derivatives} else [-1] * 3
    rows = ",\n".join(f"    {row(v, recipe.fmi)}" for v in vs)
    # A step has those refusals that name inputs.
    others = {name for r in refusals(BLOCKS[recipe.name]) if r.name != "MASTER_TURNS" for name in r.names}
    inputs = {v.name for v in vs if v.causality == "input"}
    layout = dtype(recipe.block())
    integers = [offset(layout, c.name) for c in cells(recipe.block()) if issubclass(c.type, int) and c.type is not bool]
    return "\n".join(
        [
            f'#define GUID "{compute_guid(recipe)}"',
            f"#define LONGEST_STEP {LONGEST_STEP!r}",
            f"#define MOST_CYCLES {MOST_CYCLES!r}",
            f"enum {{ {', '.join(f'{mode.name} = {mode:d}' for mode in MasterInput)} }};",
            f"enum {{ {', '.join(f'{key} = {index.get(name, -1)}' for key, name in names.items())} }};",
            f"enum {{ REFUSES_STARTS = {int(bool(others))}, REFUSES_STEPS = {int(bool(others & inputs))} }};",
            f"static const Reference SLAVE[] = {{{', '.join(f'(Reference){i}' for i in slave)}}};",
            f"static const Variable VARIABLES[] = {{\n{rows}}};",
            f"static const int INTEGERS[] = {{{', '.join(map(str, integers))}, -1}};",
            "",
        ]
    )


def row(v: Variable, fmi: Fmi) -> str:
    d = v.declaration
    kind = "INTEGER" if v.choices and fmi == Fmi.TWO else v.kind.upper()
    access = {"input": "INPUT", "parameter": v.variability.upper()}.get(v.causality, "OUTPUT")
    limits = ", ".join(number(x) for x in (v.start, d.min, d.max, d.above, d.below, d.smallest))
    choices = [len(v.choices), *(int(member) for member in v.choices)]
    listed = f"(const int[]){{{', '.join(map(str, choices))}}}" if v.choices else "NULL"
    return f"{{{kind}, {access}, {limits}, {int(d.zero)}, {listed}}}"


def number(x: float) -> str:
    return f"{'-' if x == -inf else ''}INFINITY" if isinf(x) else float(x).hex()


def run(fuzzer: Path, seed: int, calls: int) -> dict[str, Any]:
    done = subprocess.run(
        [str(fuzzer), str(seed), str(calls)], capture_output=True, text=True, env=OPTIONS, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr[-5000:]
    assert not done.stderr
    report: dict[str, Any] = json.loads(done.stdout)
    return report


@needs_gcc
def test_random_calls_find_nothing(recipe: Recipe, fuzzer: Path, soak: Callable[[int, int], int]) -> None:
    """They meet all kinds of calls: each function in each mode, with each of its answers several times; and often there
    is no memory left, and states are copied, damaged and forged."""
    calls = soak(CALLS, LONG)
    report = run(fuzzer, SEED, calls)
    functions, answers = report["functions"], ANSWERS[recipe.fmi]
    assert report["calls"] >= 0.95 * calls  # a few actions call nothing
    header = (HEADERS / f"fmi{recipe.fmi}Functions.h").read_text()
    assert functions.keys() == set(re.findall(rf"FMI{recipe.fmi}_Export \w+\s+(fmi{recipe.fmi}\w+);", header))
    for name, modes in functions.items():
        called = {mode for mode, counts in modes.items() if sum(counts.values())}
        assert called == ({"nowhere"} if "Instantiate" in name else MODES), name
        counts = {status: sum(counts[status] for counts in modes.values()) for status in modes["nowhere"]}
        for status, times in counts.items():
            assert times == 0 or times >= SEVERAL, (name, status, times)
        assert (counts["OK"] > 0) == (name not in answers.never_ok), name
        assert (counts["Error"] > 0) == (name not in answers.never_error), name
        assert (counts["Discard"] > 0) == (name in answers.discard), name
        assert (counts["Warning"] > 0) == (name in answers.warning), name
        assert counts["Fatal"] == counts["Pending"] == 0, name
    for situation, times in report["situations"].items():
        assert times >= OFTEN, situation
    steps = functions[f"fmi{recipe.fmi}DoStep"]["stepping"]["OK"]
    assert steps > report["calls"] // 50, "most of the code is only reached in step mode"


@needs_gcc
@pytest.mark.parametrize("recipe", RECIPES[:1], indirect=True)
def test_the_same_seed_makes_the_same_calls(fuzzer: Path) -> None:
    """Chance is the host's, and so the same for all blocks."""
    first, second, other = (run(fuzzer, seed, 5000)["functions"] for seed in (2, 2, 3))
    assert first == second != other
