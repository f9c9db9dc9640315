"""The native FMU in a plain C host (the benchmark's), in fmuloader and in Ecos: the results of FMPy, bit for bit."""

import importlib
import platform
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.build.fmu import BuildOptions, build
from motionsync_fmu.build.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.native.libraries import HEADERS
from motionsync_fmu.native.platforms import PLATFORMS
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests import ROOT
from tests.support.fmus import Shared
from tests.support.importers import bits, through_fmpy
from tests.support.random_runs import draw_accepted_run
from tests.support.runs import BlockRun

H = 2.0**-7  # s; exact, however an importer adds up its steps
STEPS = 600
PLATFORM = PLATFORMS["linux64"]

linux = pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"), reason="needs Linux on x86-64"
)


def least_states(block: str) -> int:
    """How many states the run has to show: three, or both of a block that has two."""
    return min(3, len(Recipe(block).variables["state"].choices))


@pytest.fixture(scope="module")
def run(block: str) -> BlockRun:
    return draw_accepted_run(block, H, STEPS, states=least_states(block))


@pytest.fixture(scope="module")
def expected(block: str, block_native: Path, run: BlockRun) -> list[dict[str, Any]]:
    rows = through_fmpy(block_native, run)
    assert len({row["state_code"] for row in rows}) >= least_states(block)
    return rows


@pytest.fixture(scope="module")
def kinds(block_native: Path) -> dict[str, tuple[int, str]]:
    with FmuInstance(block_native) as host:
        return host.kinds


# --- the C host ---


@pytest.fixture
def c_host(block: str, block_native: Path, shared: Shared, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """The host with the FMU's library, in a process that no environment variable leads to a Python."""

    def fill(folder: Path) -> None:
        source = ROOT / "benchmarks" / "host.c"
        compiler = [sys.executable, "-m", "ziglang", "cc", "-O2", "-ffp-contract=off", "-I", str(HEADERS)]
        subprocess.run([*compiler, str(source), "-o", str(folder / "host")], check=True)

    program = shared.once("c_host", fill) / "host"
    with zipfile.ZipFile(block_native) as z:
        library = z.extract(PLATFORM.library(block), tmp_path)
    command = [str(program), library, compute_guid(Recipe(block))]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={}) as process:
        yield process


@linux
def test_a_c_host_without_python_gets_the_bits_of_fmpy(
    c_host: subprocess.Popen[str], run: BlockRun, expected: list[dict[str, Any]], kinds: dict[str, tuple[int, str]]
) -> None:
    lists = {
        kind: [name for name, (_, k) in kinds.items() if k == kind.capitalize()]
        for kind in ("real", "integer", "boolean")
    }

    def setting(values: dict[str, Any]) -> Iterator[str]:
        for name, value in values.items():
            reference, kind = kinds[name]
            yield f"{kind.lower()} {reference} {float(value).hex() if kind == 'Real' else int(value)}"

    getting = [f"{kind}s {' '.join(str(kinds[name][0]) for name in names)}" for kind, names in lists.items()]
    script = [*setting(run.start), "initialize", *getting]
    for _, values in run.steps:
        script += [*setting(values), f"step {H.hex()}", *getting]
    answer, _ = c_host.communicate("\n".join(script) + "\n")
    assert c_host.returncode == 0
    lines = iter(answer.splitlines())
    for row in expected:
        for kind, names in lists.items():
            result = [float.fromhex(w).hex() if kind == "real" else int(w) for w in next(lines).split()]
            assert dict(zip(names, result, strict=True)) == {name: row[name] for name in names}
    assert next(lines, None) is None


@linux
def test_the_unit_brings_no_python_into_its_host(
    block: str, c_host: subprocess.Popen[str], kinds: dict[str, tuple[int, str]]
) -> None:
    reference = next(reference for reference, kind in kinds.values() if kind == "Real")
    assert c_host.stdin
    assert c_host.stdout
    c_host.stdin.write(f"initialize\nstep {H.hex()}\nreals {reference}\n")
    c_host.stdin.flush()
    assert c_host.stdout.readline().strip() == "0x0p+0"
    loaded = {line.split()[-1] for line in Path(f"/proc/{c_host.pid}/maps").read_text().splitlines() if ".so" in line}
    assert any(name.endswith(PLATFORM.library(block)) for name in loaded)
    assert not [name for name in loaded if "python" in Path(name).name]


# --- other importers ---


def test_fmuloader_gets_the_bits_of_fmpy(
    block: str, block_native: Path, run: BlockRun, expected: list[dict[str, Any]], kinds: dict[str, tuple[int, str]]
) -> None:
    fmi2 = pytest.importorskip("fmuloader.fmi2")
    with fmi2.Fmi2Slave(block_native, model_identifier=block) as unit:
        set_by = {"Real": unit.set_real, "Integer": unit.set_integer, "Boolean": unit.set_boolean}
        get_by = {"Real": unit.get_real, "Integer": unit.get_integer, "Boolean": unit.get_boolean}

        def put(values: dict[str, Any]) -> None:
            for name, value in values.items():
                reference, kind = kinds[name]
                set_by[kind]([reference], [value])

        def look() -> dict[str, Any]:
            return bits({name: get_by[kind]([reference])[0] for name, (reference, kind) in kinds.items()})

        unit.instantiate("unit", fmi2.Fmi2Type.CO_SIMULATION, guid=compute_guid(Recipe(block)))
        unit.setup_experiment(start_time=0.0)
        unit.enter_initialization_mode()
        put(run.start)
        unit.exit_initialization_mode()
        assert look() == expected[0]
        for i, (_, values) in enumerate(run.steps):
            put(values)
            unit.do_step(i * H, H)
            assert look() == expected[i + 1]
        unit.terminate()


@pytest.fixture(scope="module")
def ecospy() -> Any:
    """The Python package of Ecos; its library needs libtbb.so.12 (Debian: libtbb12)."""
    try:
        return importlib.import_module("ecospy")
    except ImportError as e:
        pytest.skip(f"ecospy is not installed: {e}")
    except OSError as e:
        pytest.skip(f"ecospy's library cannot be loaded: {e}")


@linux
def test_ecos_gets_the_bits_of_fmpy(
    ecospy: Any,
    block: str,
    block_native: Path,
    run: BlockRun,
    kinds: dict[str, tuple[int, str]],
    tmp_path: Path,
) -> None:
    """Start values are baked in; what is set acts with the next step. Ecos neither gets nor sets enumerations: one
    that the run sets has from the start the value that it is given first."""
    chosen = {v.name for v in variables(BLOCKS[block]()) if v.choices}
    run = enumerations_at_the_start(run, chosen)
    expected = through_fmpy(block_native, run)
    assert len({row["state_code"] for row in expected}) >= least_states(block)
    starts = {name: str(value) for name, value in run.start.items()}
    fmu = build(Recipe(block, starts=starts), tmp_path / f"{block}.fmu", BuildOptions(platforms=[PLATFORM]))
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("unit", str(fmu))
        with ecospy.EcosSimulation(structure=structure, step_size=H) as simulation:
            set_by = {"Real": simulation.set_real, "Integer": simulation.set_integer, "Boolean": simulation.set_bool}
            get_by = {"Real": simulation.get_real, "Integer": simulation.get_integer, "Boolean": simulation.get_bool}
            simulation.init()
            for i, (_, values) in enumerate(run.steps):
                for name, value in values.items():
                    set_by[kinds[name][1]](f"unit::{name}", value)
                simulation.step()
                result = {
                    name: get_by[kind](f"unit::{name}") for name, (_, kind) in kinds.items() if name not in chosen
                }
                assert bits(result) == {name: expected[i + 1][name] for name in result}
            simulation.terminate()


def enumerations_at_the_start(run: BlockRun, chosen: set[str]) -> BlockRun:
    start, steps = dict(run.start), []
    for h, values in run.steps:
        start = {name: x for name, x in values.items() if name in chosen} | start
        steps.append((h, {name: x for name, x in values.items() if name not in chosen}))
    return BlockRun(start, steps)
