"""FMUs with sources: any C99 compiler makes units of them that have the bits of the binaries, and several go into one
program; FMPy compiles them by itself."""

import platform
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import fmpy
import fmu_manipulation_toolbox
import pytest
from fmpy import fmi2, read_model_description
from fmpy.build import build_platform_binary
from fmpy.fmi1 import FMICallException

from motionsync.blocks import BLOCKS
from motionsync_fmu.fmus.fmu import BuildOptions, build
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native.instance_sources import c_names, c_sources, sources_folder
from motionsync_fmu.native.libraries import FREESTANDING
from motionsync_fmu.native.platforms import host_platform
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.linked import answer, header, runs
from tests.support.hosts.validation import faults_by_fmpy

HOST = ROOT / "tests" / "fmu"
# FMI's headers with the prefix of its functions; FMPy's do not have it any more.
HEADERS = Path(fmu_manipulation_toolbox.__file__).parent / "resources" / "fmi"
STRICT = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]
NEEDED = {"sqrt", "fmod", "floor", "rint", "fabs", "memcpy", "memset", "memcmp", "strlen", "strcmp", "calloc", "free"}
ZIG = [sys.executable, "-m", "ziglang", "cc", "-target"]
BARE = ["-DBARE", "-O1", "-fno-math-errno", "-fno-builtin-bcmp"]  # zig takes it for granted that musl's bcmp is there
# Two targets that no binary is for, and the emulator of each. A processor of 32 bits needs the compiler's own library,
# which zig compiles first: with -Os it takes least.
TARGETS = {
    "arm-linux-musleabihf": ("qemu-arm", ["-rtlib=compiler-rt", "-Os"]),
    "riscv64-linux-musl": ("qemu-riscv64", []),
}
FEW = ["Synchronizer", "RemoteSync"]  # compiled for these targets

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")


@cache
def files_of(name: str, fmi: Fmi = Fmi.TWO) -> dict[str, bytes]:
    """What lies in the folder `sources` of an FMU."""
    block = BLOCKS[name]()
    files = sources_folder(block, c_sources(block, compute_guid(Recipe(name, fmi=fmi)), fmi=fmi), fmi)
    return {path.removeprefix("sources/"): text for path, text in files.items()}


def objects(name: str, folder: Path, compiler: list[str]) -> None:
    """Compile the sources of a block's FMU, and its host; every name has a prefix."""
    folder.mkdir(parents=True)
    for file, text in files_of(name).items():
        (folder / file).write_bytes(text)
    (folder / "run.h").write_text(header(name, runs(name)))
    own = [file for file in c_names(files_of(name)) if "-DBARE" not in compiler or file != "memory.c"]
    names = [f"-DFMI2_FUNCTION_PREFIX={name}_", f"-DREPLAY=replay_{name}"]
    sources = [*own, str(HOST / "linked_run.c")]
    subprocess.run([*compiler, *names, "-c", "-I.", "-isystem", str(HEADERS), *sources], cwd=folder, check=True)


def linked(names: list[str], folder: Path, compiler: list[str], *others: str) -> Path:
    """A program that has the units of all these blocks, compiled in its folder."""
    for name in names:
        objects(name, folder / name, compiler)
    (folder / "linked.h").write_text("".join(f"REPLAY({name})\n" for name in names))
    units = map(str, folder.glob("*/*.o"))
    program = [*compiler, "-I.", str(HOST / "linked_program.c"), *units, *others, "-o", "program"]
    subprocess.run(program, cwd=folder, check=True)
    return folder / "program"


@pytest.fixture(scope="module")
def expected(fmus: Fmus) -> Callable[[str], str]:
    """What the host prints for a block, by the FMU's binary for this machine."""
    return cache(lambda name: answer(fmus.native(name), runs(name)))


# --- compilers ---


@pytest.fixture(scope="module")
def gcc(tmp_path_factory: pytest.TempPathFactory, blocks: list[str]) -> Path:
    """The folder of a program with the units of all blocks, compiled by gcc; it may fuse operations if it can."""
    folder = tmp_path_factory.mktemp("gcc")
    fused = ["-mfma", "-ffp-contract=fast"] if " fma " in Path("/proc/cpuinfo").read_text() else []
    linked(blocks, folder, ["gcc", *STRICT, "-O2", *fused, "-fcallgraph-info=su"], "-lm")
    return folder


@needs_gcc
def test_gcc_makes_of_the_sources_what_the_binaries_are(
    gcc: Path, expected: Callable[[str], str], blocks: list[str]
) -> None:
    """In C99 without a warning, with fused operations allowed, all units in one program. Each asks for memory once."""
    messages = subprocess.run([gcc / "program"], check=True, capture_output=True, text=True).stdout.split()
    assert dict(zip(blocks, messages, strict=True)) == {name: expected(name) for name in blocks}


@needs_gcc
def test_the_main_loop_of_the_page_prints_what_the_page_says(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "how_to" / "real_time.md").read_text("utf-8")
    (program,) = re.findall(r"^```c\n(.*?)^```", page, re.M | re.S)
    (command,) = re.findall(r"^    cc (.*) -o saw$", page, re.M)
    (printed,) = re.findall(r"^It prints `(.*)`\.$", page, re.M)
    for file, text in files_of("CutToLength").items():
        (tmp_path / file).write_bytes(text)
    (tmp_path / "main.c").write_text(program.replace("{...}", compute_guid(Recipe("CutToLength"))))
    (tmp_path / "headers").symlink_to(HEADERS)
    subprocess.run(["gcc", *STRICT, *command.split(), "-O0", "-o", "saw"], cwd=tmp_path, check=True)
    outcome = subprocess.run([tmp_path / "saw"], check=True, capture_output=True, text=True)
    assert (outcome.stdout, outcome.stderr) == (f"{printed}\n", "")


@needs_gcc
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the options are for x86-64")
def test_gcc_fuses_no_operations_of_a_block_whatever_it_may(tmp_path: Path) -> None:
    """Without the pragma in the text gcc fuses hundreds in this block, and with -ffp-contract=off alone still some."""
    for file, text in files_of("Follower").items():
        (tmp_path / file).write_bytes(text)
    command = ["gcc", "-O3", "-march=haswell", "-ffp-contract=fast", "-S", "block.c"]
    subprocess.run(command, cwd=tmp_path, check=True)
    operations = re.findall(r"^\tv(\w+)", (tmp_path / "block.s").read_text(), re.M)
    assert len(operations) > 1000
    assert [name for name in operations if re.match("fn?m(add|sub)", name)] == []


@pytest.mark.parametrize("target", TARGETS)
def test_the_sources_give_the_same_bits_on_processors_without_a_binary(
    target: str, expected: Callable[[str], str], tmp_path: Path
) -> None:
    """A program without any C library, on an emulated processor of 32 bits and on another of 64."""
    emulator, further = TARGETS[target]
    if not shutil.which(emulator):
        pytest.skip(f"{emulator} is not installed")
    bare = [str(FREESTANDING / "freestanding.c"), "-nostdlib", "-static", *further]
    program = linked(FEW, tmp_path / "made", [*ZIG, target, *BARE, "-isystem", str(FREESTANDING)], *bare)
    messages = subprocess.run([emulator, program], check=True, capture_output=True, text=True).stdout.split()
    assert dict(zip(FEW, messages, strict=True)) == {name: expected(name) for name in FEW}


@needs_gcc
def test_the_linker_sees_names_with_the_prefix_and_few_of_a_c_library(gcc: Path, blocks: list[str]) -> None:
    for name in blocks:
        units = [str(file) for file in (gcc / name).glob("*.o") if file.stem != "linked_run"]
        lines = subprocess.run(["nm", "-g", *units], check=True, capture_output=True, text=True).stdout.splitlines()
        result = [line.split()[-2:] for line in lines if line and not line.endswith(":")]
        defined = {symbol for kind, symbol in result if kind != "U"}
        assert all(symbol.startswith(f"{name}_") for symbol in defined)
        assert f"{name}_fmi2DoStep" in defined
        position_independent = {"_GLOBAL_OFFSET_TABLE_"}
        assert {symbol for kind, symbol in result if kind == "U"} - defined - position_independent <= NEEDED


@needs_gcc
@pytest.mark.parametrize("fmi", Fmi)
@pytest.mark.parametrize(
    ("option", "reason"),
    [
        ("-ffast-math", "-ffast-math is not allowed"),
        ("-ffinite-math-only", "-ffast-math is not allowed"),
        ("-D_M_FP_FAST", "-ffast-math is not allowed"),
        ("-D__DBL_MANT_DIG__=24", "double has to be the 64-bit double of IEEE 754"),
        ("-D__FLT_EVAL_METHOD__=2", "doubles have to be computed as doubles"),
    ],
)
def test_a_compiler_that_would_change_the_results_is_refused(
    fmi: Fmi, option: str, reason: str, tmp_path: Path
) -> None:
    """By every file on its own."""
    for file, text in files_of("RemoteSync", fmi).items():
        (tmp_path / file).write_bytes(text)
    for file in c_names(files_of("RemoteSync", fmi)):
        call = ["gcc", option, "-w", "-std=c99", "-fsyntax-only", "-isystem", str(HEADERS), file]
        done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode, file
        assert f'#error "{reason}' in done.stderr


# --- the stack ---


def graph(folder: Path) -> tuple[dict[str, int], dict[str, set[str]]]:
    """The stack that each function uses, in bytes, and the functions that it calls, as reported by gcc."""
    takes: dict[str, int] = {}
    calls: dict[str, set[str]] = {}
    for file in folder.glob("*.ci"):
        text = file.read_text()
        for name, size, kind in re.findall(r'node: \{ title: "(.*?)" label: ".*?(\d+) bytes \((.*?)\)', text):
            assert kind in ("static", "dynamic,bounded"), f"{name}: what it takes depends on what it is given"
            takes[name] = int(size)
        for caller, called in re.findall(r'edge: \{ sourcename: "(.*?)" targetname: "(.*?)"', text):
            calls.setdefault(caller, set()).add(called)
    return takes, calls


def depths(takes: dict[str, int], calls: dict[str, set[str]]) -> dict[str, int]:
    """What each function takes of the stack together with what it calls, in bytes. None may call itself."""
    result: dict[str, int] = {}

    def depth(function: str, callers: tuple[str, ...]) -> int:
        assert function not in callers, f"{function} calls itself: {callers}"
        if function not in result:
            below = [depth(called, (*callers, function)) for called in calls.get(function, ())]
            result[function] = takes.get(function, 0) + max(below, default=0)
        return result[function]

    for function in takes:
        depth(function, ())
    return result


@needs_gcc
def test_no_function_calls_itself_and_the_stack_is_as_documented(gcc: Path, blocks: list[str]) -> None:
    """The README of the sources states its depth."""
    for name in blocks:
        result = depths(*graph(gcc / name))
        text = files_of(name)["README.md"].decode()
        step, any_call = (1000 * int(kb) for kb in re.findall(r"(\d+) kB in (?:a step|any call)", text))
        assert 0.5 * step < result[f"{name}_fmi2DoStep"] <= step
        deepest = max(depth for function, depth in result.items() if function.startswith(f"{name}_fmi2"))
        assert 0.5 * any_call < deepest <= any_call


# --- the FMU ---


@pytest.fixture(scope="module", params=Fmi)
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Synchronizer's FMU with sources, for this machine alone, in both versions of FMI."""
    if (platform := host_platform(request.param)) is None:
        pytest.skip("no native FMU runs on this machine")
    target = tmp_path_factory.mktemp("sources") / "Synchronizer.fmu"
    return build(
        Recipe("Synchronizer", fmi=request.param), target, BuildOptions(platforms=[platform], with_sources=True)
    )


def test_the_description_names_all_c_files_and_fmis_headers_stay_with_the_importer(fmu: Path) -> None:
    assert faults_by_fmpy(fmu) == []
    description = read_model_description(str(fmu))
    (configuration,) = description.buildConfigurations
    (sources,) = configuration.sourceFileSets
    three = description.fmiVersion != "2.0"
    assert configuration.modelIdentifier == "Synchronizer"
    assert sources.language == ("C99" if three else None)
    with zipfile.ZipFile(fmu) as z:
        held = {name.removeprefix("sources/") for name in z.namelist() if name.startswith("sources/")}
        assert sources.sourceFiles == sorted(name for name in held if name.endswith(".c"))
        assert sources.sourceFiles == ["block.c", f"fmi{3 if three else 2}.c", "instance.c", "memory.c"]
        included = {
            header
            for name in held
            if name.endswith((".c", ".h"))
            for header in re.findall(r'#include "(.*?)"', z.read(f"sources/{name}").decode())
        }
        assert included - held == {"fmi3Functions.h" if three else "fmi2Functions.h"}
        messages = z.read("sources/README.md").decode()
        assert held - {"README.md", "buildDescription.xml"} <= set(re.findall(r"`([\w.]+\.[ch])`", messages))
        assert "<code>sources</code>" in z.read("documentation/index.html").decode()
    assert ("buildDescription.xml" in held) == three


def test_fmpy_compiles_the_sources_by_itself(
    fmu: Path, expected: Callable[[str], str], fmus: Fmus, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """As any importer: with its own headers and options of CMake. Of FMI 3.0 the binary says what is right."""
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=":")  # CMake's package lies there
    folder = Path(fmpy.extract(str(fmu), unzipdir=str(tmp_path / "unzipped")))
    shutil.rmtree(folder / "binaries")
    build_platform_binary(folder, all_warnings=True)
    (library,) = (file for file in (folder / "binaries").rglob("*") if file.is_file())
    assert library.stem == "Synchronizer"
    held = {file.relative_to(folder).as_posix(): file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    write_zip(tmp_path / "Synchronizer.fmu", held)
    two = read_model_description(str(fmu)).fmiVersion == "2.0"
    right = expected("Synchronizer") if two else answer(fmus.fmi3("Synchronizer"), runs("Synchronizer"))
    assert answer(tmp_path / "Synchronizer.fmu", runs("Synchronizer")) == right


@needs_gcc
@pytest.mark.skipif(host_platform() is None, reason="no native FMU runs on this machine")
def test_the_importers_memory_is_used_for_the_instance_and_its_states_and_for_nothing_else(
    fmus: Fmus, tmp_path: Path
) -> None:
    for file, text in files_of("Gearing").items():
        (tmp_path / file).write_bytes(text)
    headers = Path(fmpy.__file__).parent / "c-code"
    command = ["gcc", "-shared", "-fPIC", "-I", str(headers), *c_names(files_of("Gearing")), "-lm", "-o", "unit.so"]
    subprocess.run(command, cwd=tmp_path, check=True)
    blocks_in_use: dict[int, int] = {}

    def allocate(n: int, size: int) -> int | None:
        if len(blocks_in_use) == 2:
            return None
        address = int(fmi2.calloc(n, size))
        blocks_in_use[address] = n * size
        return address

    def release(address: int) -> None:
        del blocks_in_use[address]
        fmi2.free(address)

    with FmuInstance(fmus.native("Gearing")) as host:
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = host.callbacks.logger
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(allocate)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(release)
        unit = fmi2.FMU2Slave(
            guid=host.description.guid, modelIdentifier="Gearing", unzipDirectory=host.folder,
            libraryPath=str(tmp_path / "unit.so"), instanceName="unit",
        )  # fmt: skip
        unit.instantiate(callbacks=callbacks)
        assert len(blocks_in_use) == 1
        unit.setupExperiment()
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        for step in range(100):
            unit.doStep(step * 0.01, 0.01)
        assert len(blocks_in_use) == 1
        state = unit.getFMUState()
        assert len(blocks_in_use) == 2
        with pytest.raises(FMICallException):
            unit.getFMUState()
        unit.freeFMUState(state)
        unit.freeInstance()
        assert blocks_in_use == {}


def test_without_being_asked_for_there_are_no_sources(native: Path) -> None:
    with zipfile.ZipFile(native) as z:
        assert not [name for name in z.namelist() if name.startswith("sources/")]
        assert "<code>sources</code>" not in z.read("documentation/index.html").decode()
    assert read_model_description(str(native)).buildConfigurations == []
