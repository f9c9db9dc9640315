"""The files of the native flavour: what the libraries need and export, sizes, paths, the hash, and failing builds."""

import ctypes
import os
import re
import shutil
import struct
import subprocess
import sys
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave

from motionsync.blocks import BLOCKS
from motionsync_fmu import paths
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus import fmu
from motionsync_fmu.fmus.fmu import Flavour, build, build_python, check_kernel, fmu_path, why_outdated
from motionsync_fmu.fmus.guid import compute_guid, native_toolchain
from motionsync_fmu.interface import fingerprint
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.fingerprint import Files
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native import libraries
from motionsync_fmu.native.instance_sources import c_sources
from motionsync_fmu.native.libraries import FOLDER, HEADERS, locate_sources
from motionsync_fmu.native.macho import universal
from motionsync_fmu.native.platforms import PLATFORMS, ROWS
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests import ROOT
from tests.support.hosts.fmus import build_for_host
from tests.support.hosts.importers import check_by_fmutool
from tests.support.hosts.validation import faults_by_fmpy

RECIPE = Recipe("Synchronizer")
LARGEST = 256_000  # bytes of an FMU
MACHO_OWN = {"_mh_dylib_header", "__dso_handle"}  # zig's linker gives them to every library: where it starts
FUNCTIONS = set(re.findall(r"FMI2_Export \w+\s+(fmi2\w+);", (HEADERS / "fmi2Functions.h").read_text()))


@pytest.fixture(scope="module")
def folder(block_native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The extracted FMU."""
    return Path(fmpy.extract(str(block_native), unzipdir=str(tmp_path_factory.mktemp("native"))))


def tool(name: str, *arguments: object) -> str:
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed (binutils)")
    return subprocess.run([name, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("platform", [p.folder for p in ROWS if p.suffix == "so"])
def test_a_linux_library_needs_memory_of_the_c_library_and_nothing_else(
    block: str, folder: Path, platform: str
) -> None:
    """Its names have no versions, so that any C library of that name serves."""
    library = folder / PLATFORMS[platform].library(block)
    assert re.findall(r"\(NEEDED\).*\[(.*)\]", tool("readelf", "-d", library)) == ["libc.so.6"]
    assert "No version information found" in tool("readelf", "-V", library)
    lines = tool("readelf", "-W", "--dyn-syms", library).splitlines()
    symbols = [line.split()[4:] for line in lines if "GLOBAL" in line]
    assert {name for _, _, section, name, *_ in symbols if section != "UND"} == FUNCTIONS
    assert {name for _, _, section, name, *_ in symbols if section == "UND"} == {"calloc", "free"}


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has name spaces for libraries")
def test_a_linux_library_runs_in_a_name_space_of_its_own(folder: Path, block: str) -> None:
    """There nothing has loaded a C library before, as in an importer that is linked statically."""
    process = ctypes.CDLL(None)
    process.dlmopen.restype = process.dlerror.restype = ctypes.c_void_p
    path = str(folder / PLATFORMS["linux64"].library(block)).encode()
    handle = process.dlmopen(ctypes.c_long(-1), path, os.RTLD_NOW)
    assert handle, ctypes.string_at(process.dlerror())
    library = ctypes.CDLL(None, handle=handle)
    library.fmi2Instantiate.restype = ctypes.c_void_p
    guid = fmpy.read_model_description(str(folder)).guid.encode()
    callbacks = (ctypes.c_void_p * 5)()
    unit = ctypes.c_void_p(library.fmi2Instantiate(b"unit", 1, guid, None, callbacks, 0, 0))
    assert unit
    nothing, zero = ctypes.c_double(0.0), 0
    assert library.fmi2SetupExperiment(unit, zero, nothing, nothing, zero, nothing) == 0
    assert library.fmi2EnterInitializationMode(unit) == library.fmi2ExitInitializationMode(unit) == 0
    for i in range(10):
        assert library.fmi2DoStep(unit, ctypes.c_double(0.1 * i), ctypes.c_double(0.1), 1) == 0
    library.fmi2FreeInstance(unit)


def test_a_linux_library_finds_its_memory_in_musl(folder: Path, block: str) -> None:
    loader = next(Path("/lib").glob("ld-musl-x86_64.so*"), None)
    if loader is None:
        pytest.skip("musl is not installed")
    listed = tool(str(loader), "--list", folder / PLATFORMS["linux64"].library(block))
    assert re.findall(r"(\S+) =>", listed) == ["libc.so.6"]


def test_the_windows_library_needs_memory_of_the_system_and_nothing_else(block: str, folder: Path) -> None:
    text = tool("objdump", "-p", folder / PLATFORMS["win64"].library(block))
    assert re.findall(r"DLL Name: (\S+)", text) == ["KERNEL32.dll"]
    imported = text[text.index("DLL Name") :].split("\n\n")[0]
    assert set(re.findall(r"\d  (\w+)$", imported, re.M)) == {"GetProcessHeap", "HeapAlloc", "HeapFree"}
    names = text[text.index("[Ordinal/Name Pointer] Table") :].split("\n\n")[0]
    assert set(re.findall(r"\d\] (\w+)$", names, re.M)) == FUNCTIONS


def slices(library: bytes) -> Iterator[bytes]:
    """The thin libraries in a universal one."""
    magic, count = struct.unpack(">II", library[:8])
    assert magic == 0xCAFEBABE
    for i in range(count):
        cpu, _, offset, size, align = struct.unpack(">5I", library[8 + 20 * i : 28 + 20 * i])
        thin = library[offset : offset + size]
        assert offset % (1 << align) == 0
        assert struct.unpack("<2I", thin[:8]) == (0xFEEDFACF, cpu)
        yield thin


def commands(thin: bytes) -> Iterator[tuple[int, bytes]]:
    """The load commands of a Mach-O library, by their numbers."""
    at = 32
    for _ in range(struct.unpack_from("<I", thin, 16)[0]):
        kind, size = struct.unpack_from("<2I", thin, at)
        yield kind, thin[at : at + size]
        at += size


def number(text: bytes, at: int) -> tuple[int, int]:
    """A number of seven bits a byte, and where it ends."""
    value = shift = 0
    while True:
        value |= (text[at] & 0x7F) << shift
        shift, at = shift + 7, at + 1
        if text[at - 1] < 0x80:
            return value, at


def exported(thin: bytes) -> set[str]:
    """The names in the tree of exports (LC_DYLD_INFO_ONLY), each shared prefix once."""
    where, size = struct.unpack_from("<2I", dict(commands(thin))[0x80000022], 40)
    tree = thin[where : where + size]

    def names(at: int, name: bytes) -> Iterator[str]:
        own, at = number(tree, at)
        if own:
            yield name.decode().removeprefix("_")
        at += own
        count, at = tree[at], at + 1
        for _ in range(count):
            end = tree.index(b"\0", at)
            child, following = number(tree, end + 1)
            yield from names(child, name + tree[at:end])
            at = following

    return set(names(0, b""))


def test_the_macos_library_is_for_both_processors_and_needs_only_the_system(block: str, folder: Path) -> None:
    thin = list(slices((folder / PLATFORMS["darwin64"].library(block)).read_bytes()))
    assert [struct.unpack_from("<I", t, 4)[0] for t in thin] == [0x01000007, 0x0100000C]  # x86-64, arm64
    for library in thin:
        needed = {text[24:].rstrip(b"\0") for kind, text in commands(library) if kind in (0xC, 0x80000018)}
        assert needed == {b"/usr/lib/libSystem.B.dylib"}
        assert exported(library) == FUNCTIONS | MACHO_OWN
    assert any(kind == 0x1D for kind, _ in commands(thin[1]))  # signed, for arm64 loads nothing else


def test_a_universal_file_holds_its_parts() -> None:
    thin = [struct.pack("<4I", 0xFEEDFACF, cpu, 3, 0) + bytes(n) for cpu, n in ((0x01000007, 5), (0x0100000C, 1 << 15))]
    assert list(slices(universal(*thin))) == thin


def test_an_fmu_is_as_small_as_the_readme_says(block_native: Path) -> None:
    (most,) = re.findall(r"in one FMU below (\d+) kB", (ROOT / "README.md").read_text("utf-8"))
    assert block_native.stat().st_size < 1000 * int(most)


def test_the_fmu_is_small_and_says_what_it_holds(block: str, block_native: Path, folder: Path) -> None:
    assert block_native.stat().st_size <= LARGEST
    assert {p.name for p in (folder / "binaries").iterdir()} == set(PLATFORMS)
    page = (folder / "documentation" / "index.html").read_text()
    assert all(text in page for platform in ROWS for text in (platform.folder, platform.title))
    assert {p.name for p in (folder / "documentation").iterdir()} == {
        "index.html",
        "example.svg",
        "licenses",
    }
    (licence,) = (folder / "documentation" / "licenses").iterdir()
    assert re.findall(r"^(.*)\n=+$", licence.read_text(), re.M) == ["motionsync", "FMI's headers"]
    assert (folder / "model.png").stat().st_size < 20_000
    assert not (folder / "resources").exists()


def test_it_is_packed_smaller_than_zlib_would(block_native: Path) -> None:
    with zipfile.ZipFile(block_native) as z:
        usual = sum(len(zlib.compress(z.read(info), 9, -15)) for info in z.infolist())
        assert sum(info.compress_size for info in z.infolist()) < 0.97 * usual


def test_the_fmu_is_valid(block_native: Path, caplog: pytest.LogCaptureFixture) -> None:
    assert faults_by_fmpy(block_native) == []
    check_by_fmutool(block_native, caplog)


def test_nothing_of_this_machine_is_in_the_libraries(folder: Path) -> None:
    for file in (folder / "binaries").glob("*/*"):
        for trace in (str(Path.home()), "/tmp/", str(ROOT), "site-packages"):
            assert trace.encode() not in file.read_bytes(), (file, trace)


@pytest.mark.parametrize("name", ["a b", "#1", "100%", "a+b", "Vorschübe", "同步", "%20%s%n"])
def test_it_loads_from_any_path(native: Path, tmp_path: Path, name: str) -> None:
    folder = tmp_path / name
    with zipfile.ZipFile(native) as z:
        z.extractall(folder)
    description = fmpy.read_model_description(str(folder))
    unit = FMU2Slave(
        guid=description.guid, modelIdentifier="Synchronizer", instanceName=name, unzipDirectory=str(folder)
    )
    unit.instantiate()
    unit.setupExperiment()
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.doStep(0.0, 0.1)
    unit.freeInstance()


def test_a_build_gives_the_same_bytes_every_time(native: Path, tmp_path: Path) -> None:
    """Also in a process of its own, with another seed for hashes, from another folder and with nothing in a cache. Of
    all blocks the C is the same every time (tests/compiler/test_c_source.py)."""
    script = "from motionsync_fmu.fmus.fmu import *; build(Recipe('Synchronizer'), Path('a.fmu'))"
    caches = {"XDG_CACHE_HOME": str(tmp_path / "cache"), "ZIG_GLOBAL_CACHE_DIR": str(tmp_path / "zig")}
    environment = os.environ | caches | {"PYTHONHASHSEED": "42"}
    subprocess.run([sys.executable, "-c", script], check=True, cwd=tmp_path, env=environment)
    assert (tmp_path / "a.fmu").read_bytes() == native.read_bytes()


# --- what is compiled once ---


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache in place of the user's."""
    monkeypatch.setattr(paths, "cache_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache"


def located(recipe: Recipe, work: Path) -> dict[str, Path]:
    """Where the C files of a unit are compiled, by their names."""
    unit = c_sources(recipe.block(), compute_guid(recipe), recipe.causality_overrides, recipe.fmi)
    names = [name for name in unit if name.endswith(".c")]
    result = dict(zip(names, map(Path, locate_sources(unit, names, work)), strict=True))
    assert all(file.name == name and file.read_bytes() == unit[name] for name, file in result.items())
    return result


def test_zig_finds_the_same_block_and_the_same_unit_again(cache: Path, tmp_path: Path) -> None:
    """At the same path with the same time: else it compiles them anew."""
    first = located(RECIPE, tmp_path)
    times = [file.stat().st_mtime_ns for file in first.values()]
    interface = Interface(input="rest_value")
    others = [Recipe("Synchronizer", fmi=Fmi.THREE), Recipe("Synchronizer", "deg", interface=interface)]
    units = [located(recipe, tmp_path) for recipe in (RECIPE, *others)]
    assert units[0] == first
    assert [file.stat().st_mtime_ns for file in first.values()] == times
    assert {unit["block.c"] for unit in units} == {first["block.c"]}
    assert {unit["memory.c"] for unit in units} == {FOLDER / "memory.c"}
    assert len({unit["instance.c"] for unit in units}) == 3
    assert located(Recipe("Gearing"), tmp_path)["block.c"] != first["block.c"]
    for name, header in (("block.c", "block.h"), ("instance.c", "model.h"), ("instance.c", "instance_memory.h")):
        assert first[name].is_relative_to(cache)
        assert first[name].with_name(header).is_file()


def test_what_was_changed_in_the_cache_is_not_compiled(cache: Path, tmp_path: Path) -> None:
    first = located(RECIPE, tmp_path)
    first["block.c"].write_text("damaged")
    first["instance.c"].unlink()
    assert located(RECIPE, tmp_path) == first


@pytest.mark.usefixtures("no_cache")
def test_a_block_is_compiled_without_a_cache(tmp_path: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    assert {located(RECIPE, work)[name].parent for name in ("block.c", "instance.c")} == {work}


def test_what_determines_the_code_changes_the_guid_of_both_flavours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = compute_guid(RECIPE)
    target = build_python(RECIPE, tmp_path / "Synchronizer.fmu")
    assert why_outdated(target, RECIPE) == ""
    modules = ("compiler_process", "libraries", "macho", "platforms", "tables", "instance_sources")
    own = {
        "heat.h",
        "decimal.h",
        "fmi.h",
        "fmi2.c",
        "fmi3.c",
        "memory.c",
        "model.h.j2",
        "portable.h",
        "sources.md.j2",
        "instance.c",
        "instance.h",
        "instance_access.h",
        "instance_memory.h",
        "instance_messages.h",
        "instance_ranges.h",
        "instance_states.h",
    }
    others = own | {f"freestanding/{name}" for name in ("freestanding.c", "libc.c", "math.h", "stdlib.h", "string.h")}
    names = {f"native/{name}" for name in (*others, *(f"{module}.py" for module in modules))}
    compiler = FOLDER.with_name("compiler")
    names |= {file.relative_to(FOLDER.parent).as_posix() for file in compiler.rglob("*.py")}
    assert native_toolchain().keys() == names | {"native/__init__.py"}
    for name in names:
        with monkeypatch.context() as changed:
            files = native_toolchain()
            more = files | {name: files[name] + b"\n"}
            changed.setattr("motionsync_fmu.fmus.guid.native_toolchain", lambda more=more: more)
            assert compute_guid(RECIPE) != before
            assert why_outdated(target, RECIPE) == "stale"


def test_the_compiler_and_batches_need_neither_pythonfmu_nor_the_pages() -> None:
    script = "import sys, motionsync_fmu.native.libraries, motionsync_fmu.batch.simulation; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert "motionsync_fmu.batch.simulation" in loaded
    assert [
        name for name in loaded if name.startswith(("pythonfmu", "motionsync_fmu.pages", "motionsync_fmu.python"))
    ] == []


def test_the_table_of_platforms_is_read_without_a_compiler() -> None:
    script = "import sys, motionsync_fmu.native.platforms; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert "motionsync_fmu.native.platforms" in loaded
    assert not {"numpy", "ziglang"} & {*loaded}


def test_baked_start_values_and_units_reach_the_library(tmp_path: Path) -> None:
    recipe = Recipe("Synchronizer", "deg", {"output_phasing": "30", "curve": "PARABOLA", "rest_value": "180"})
    target = build_for_host(Flavour.NATIVE, recipe, tmp_path / "Synchronizer.fmu")
    with FmuInstance(target) as host:
        host.initialize()
        result = host.get(["output_phasing", "curve", "rest_value"])
    assert result == {"output_phasing": 30.0, "curve": 1, "rest_value": 180.0}
    assert fmu_path(recipe, tmp_path, Flavour.NATIVE) == tmp_path / "native" / "Synchronizer.fmu"


# --- builds that fail ---


def test_a_missing_compiler_is_reported_with_the_remedy(tmp_path: Path) -> None:
    script = (
        f"import sys; sys.modules['ziglang'] = None; from motionsync_fmu.cli import main; "
        f"sys.argv = ['motionsync', 'build', '--flavour', 'native', '--output', {str(tmp_path)!r}]; main()"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "built with ziglang" in done.stderr
    assert "pip install --editable '.[native]'" in done.stderr
    assert "--flavour python" in done.stderr


def test_a_failing_compiler_is_reported_with_the_remedy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(libraries, "FLAGS", "--no-such-flag")
    with pytest.raises(UserError, match=r"(?s)zig could not compile for .*ZIG_GLOBAL_CACHE_DIR.*no-such-flag"):
        build(RECIPE, tmp_path / "Synchronizer.fmu")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform != "linux", reason="zig loops below /proc, which other systems do not have")
def test_a_cache_that_zig_tries_to_make_for_ever_is_an_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(libraries, "CACHE_TIME", 2.0)
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", "/proc/motionsync")
    with pytest.raises(UserError, match=r"^zig cannot make its cache: .*ZIG_GLOBAL_CACHE_DIR.* not ended after 2 s$"):
        build(RECIPE, tmp_path / "Synchronizer.fmu")
    assert not list(tmp_path.iterdir())


def test_a_slow_compilation_is_reported_target_by_target(monkeypatch: pytest.MonkeyPatch) -> None:
    messages: list[str] = []
    monkeypatch.setattr(libraries, "PATIENCE", 0.0)
    with libraries.Compilation(RECIPE.name, c_sources(RECIPE.block(), compute_guid(RECIPE))) as compilation:
        compilation.libraries(messages.append)
    assert messages[0] == libraries.SLOW
    assert sorted(messages[1:]) == sorted(f"compiled for {target}" for row in ROWS for target in row.targets)


def test_a_block_outside_the_kernel_subset_is_reported_with_file_line_and_rule(
    block: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = BLOCKS[block].__module__
    files: Files = fingerprint.collect_sources(module)
    file = module.partition(".")[2].replace(".", "/") + ".py"
    text = files[file].decode() + "\n\ndef square(x: float) -> float:\n    return x ** 2.0\n"
    line = text[: text.index("x ** 2.0")].count("\n") + 1
    monkeypatch.setattr(fmu, "collect_sources", lambda module: files | {file: text.encode()})
    with pytest.raises(UserError, match=rf"^motionsync/{re.escape(file)}:{line}: no `\*\*`"):
        check_kernel(module)
