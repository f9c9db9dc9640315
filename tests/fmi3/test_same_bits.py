"""An FMU of FMI 3.0 gives the bits and the messages of that of FMI 2.0: in FMPy, in other importers, in a host in C."""

import importlib
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest

from motionsync_fmu.build.fmu import BuildOptions, build
from motionsync_fmu.build.guid import compute_guid
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native.platforms import host_platform
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from motionsync_fmu.scenario.run.simulation import simulate
from tests.support.fmus import Fmus, Shared
from tests.support.importers import bits, through_fmpy
from tests.support.random_runs import draw_accepted_run, draw_runs
from tests.support.replay import TARGETS, double, orders, replayed, tried
from tests.support.runs import BlockRun

H = 2.0**-7  # s; exact, however an importer adds up its steps


def saved(host: FmuInstance) -> bytes:
    """The unit's whole state, as bytes."""
    if host.fmi == Fmi.TWO:
        state = host.unit.getFMUstate()
        result = bytes(host.unit.serializeFMUstate(state))
        host.unit.freeFMUstate(state)
    else:
        state = host.unit.getFMUState()
        result = bytes(host.unit.serializeFMUState(state))
        host.unit.freeFMUState(state)
    return result


def restore(host: FmuInstance, packed: bytes) -> None:
    if host.fmi == Fmi.TWO:
        state = host.unit.deSerializeFMUstate(packed)
        host.unit.setFMUstate(state)
        host.unit.freeFMUstate(state)
    else:
        state = host.unit.deserializeFMUState(packed)
        host.unit.setFMUState(state)
        host.unit.freeFMUState(state)


def test_random_runs_give_the_same_states_and_messages(block: str, block_native: Path, block_fmi3: Path) -> None:
    """Runs with refused values, step sizes and commands: after each step the whole states are equal, byte by byte."""
    steps = failed = 0
    with FmuInstance(block_native) as two, FmuInstance(block_fmi3) as three:
        for run in draw_runs(block, 150, 6):
            for host in (two, three):
                host.unit.reset()
                host.time = 0.0
            why = tried(two.initialize, run.start)
            assert tried(three.initialize, run.start) == why
            for h, values in [] if why else run.steps:
                why = tried(two.step, h, values)
                assert tried(three.step, h, values) == why
                assert saved(two) == saved(three)
                steps, failed = steps + 1, failed + bool(why)
            if not why:
                assert bits(two.get()) == bits(three.get())
        assert two.messages == three.messages
    assert steps > 200
    assert failed > 0


def test_the_example_gives_the_same_results(block: str, block_native: Path, block_fmi3: Path) -> None:
    example = load_example(block)
    two, three = (simulate(example, fmu, example.step_size) for fmu in (block_native, block_fmi3))
    assert two.values.keys() == three.values.keys()
    assert [n for n in two.values if two.values[n].tobytes() != three.values[n].tobytes()] == []
    assert two.messages == three.messages


def test_a_state_goes_from_one_version_to_the_other(block: str, block_native: Path, block_fmi3: Path) -> None:
    run = draw_accepted_run(block, H, 300)
    with FmuInstance(block_native) as two, FmuInstance(block_fmi3) as three:
        two.initialize(run.start)
        three.initialize()
        for i, (h, values) in enumerate(run.steps):
            ahead, behind = (two, three) if i < 150 else (three, two)
            ahead.step(h, values)
            if i in (149, 299):
                restore(behind, saved(ahead))
                behind.time = ahead.time
                assert bits(behind.get()) == bits(ahead.get())


# --- other importers ---


@pytest.fixture(scope="module")
def run(block: str) -> BlockRun:
    return draw_accepted_run(block, H, 300)


@pytest.mark.parametrize("block", ["Synchronizer", "CutToLength"], indirect=True)
def test_fmuloader_gets_the_bits_of_fmi_2(block: str, block_native: Path, block_fmi3: Path, run: BlockRun) -> None:
    loader = pytest.importorskip("fmuloader.fmi3")
    with FmuInstance(block_fmi3) as host:
        kinds = {name: kind for name, kind in host.kinds.items() if name != "time"}
    rows = through_fmpy(block_native, run)
    with loader.Fmi3Slave(block_fmi3, model_identifier=block) as unit:

        def put(values: dict[str, Any]) -> None:
            for name, value in values.items():
                reference, kind = kinds[name]
                getattr(unit, f"set_{kind.lower()}")([reference], [value])

        def look() -> dict[str, Any]:
            return bits({n: getattr(unit, f"get_{kind.lower()}")([r])[0] for n, (r, kind) in kinds.items()})

        unit.instantiate_co_simulation("unit", instantiation_token=compute_guid(Recipe(block)))
        unit.enter_initialization_mode(start_time=0.0)
        put(run.start)
        unit.exit_initialization_mode()
        assert look() == rows[0]
        for i, (h, values) in enumerate(run.steps):
            put(values)
            unit.do_step(i * h, h)
            assert look() == rows[i + 1]
        unit.terminate()


def test_ecos_gets_the_bits_of_fmi_2(native: Path, tmp_path: Path) -> None:
    """Start values are baked in; Ecos neither gets nor sets enumerations."""
    try:
        ecospy = importlib.import_module("ecospy")
    except (ImportError, OSError) as e:
        pytest.skip(f"ecospy cannot be loaded: {e}")
    starts = {"master.period": 360.0, "output_phasing": 45.0, "rest_value": 200.0, "master.velocity": 300.0}
    steps = [(H, {"master.position": 300.0 * i * H % 360.0, "stop": i > 40, "start": i > 200}) for i in range(300)]
    rows = through_fmpy(native, BlockRun(starts, steps))
    recipe = Recipe("Synchronizer", "mm", {name: str(value) for name, value in starts.items()}, fmi=Fmi.THREE)
    options = BuildOptions(platforms=[host_platform(Fmi.THREE)])
    fmu = build(recipe, tmp_path / "Synchronizer.fmu", options)
    with FmuInstance(fmu) as host:
        kinds = {name: kind for name, (_, kind) in host.kinds.items() if kind != "Int64" and name != "time"}
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("unit", str(fmu))
        with ecospy.EcosSimulation(structure=structure, step_size=H) as simulation:
            get_by = {"Float64": simulation.get_real, "Int32": simulation.get_integer, "Boolean": simulation.get_bool}
            set_by = {"Float64": simulation.set_real, "Boolean": simulation.set_bool}
            simulation.init()
            for i, (_, values) in enumerate(steps):
                for name, value in values.items():
                    set_by[kinds[name]](f"unit::{name}", value)
                simulation.step()
                result = bits({name: get_by[kind](f"unit::{name}") for name, kind in kinds.items()})
                assert result == {name: rows[i + 1][name] for name in result}
            simulation.terminate()
    assert {row["state_code"] for row in rows} == {0, 1}


# --- a host in C, without any Python ---


@pytest.fixture(scope="module")
def recorded_calls(native: Path) -> list[tuple[str, str]]:
    """A few runs of the Synchronizer as calls, each with the answer of FMI 3.0: that of FMI 2.0, translated."""
    with FmuInstance(native) as host:
        kinds = {str(v.valueReference): v.type for v in host.description.modelVariables}
    result: list[tuple[str, str]] = []
    for run in draw_runs("Synchronizer", 200, 6):
        with FmuInstance(native) as host:
            result.extend(translate_to_fmi_3(orders(host, run), kinds))
    return result


def translate_to_fmi_3(orders: Iterator[tuple[str, str]], kinds: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Enumerations have functions of their own, a refused step is discarded, and the time is one more variable."""
    time = 0.0
    for order, answer in orders:
        what, *arguments = order.split()
        if what == "n":
            time = 0.0
        if what == "s" and answer == "0":
            t, h = (struct.unpack(">d", bytes.fromhex(bits))[0] for bits in arguments)
            time = t + h
        is_enumeration = what == "I" and kinds[arguments[0]] == "Enumeration"
        status = {"3": "2"}.get(answer, answer) if what == "s" else answer
        yield ("E" + order[1:] if is_enumeration else order), f"{answer} {double(time)}" if what == "g" else status


@pytest.mark.parametrize("target", TARGETS)
def test_a_host_in_c_gets_the_bits_of_fmi_2(
    target: str, fmus: Fmus, shared: Shared, recorded_calls: list[tuple[str, str]], tmp_path: Path
) -> None:
    extracted = Path(fmpy.extract(str(fmus.fmi3_everywhere("Synchronizer")), unzipdir=str(tmp_path / "fmu")))
    answers = replayed(target, extracted, [order for order, _ in recorded_calls], tmp_path, shared)
    for (order, answer), result in zip(recorded_calls, answers, strict=True):
        assert result == answer, order
    assert {answer for order, answer in recorded_calls if order.startswith("s")} == {"0", "2"}
    assert any(order.startswith("E") for order, _ in recorded_calls)
