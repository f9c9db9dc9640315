"""The built FMU, python flavour, as importers meet it: standard, state, refusals, reproducibility."""

import math
import os
import random
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from functools import cache, reduce
from operator import attrgetter
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring

import pytest
from fmpy import read_model_description

from motionsync.blocks import BLOCKS
from motionsync.remote_sync.block import RemoteSync
from motionsync_fmu import __version__
from motionsync_fmu.fmus.fmu import build_python
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import Variable, variables
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
from tests import ROOT
from tests.support.blocks.random_runs import draw_accepted_run, draw_runs
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.importers import bits, check_by_fmutool
from tests.support.hosts.validation import faults_by_fmpy

DISCARD, FATAL = 2, 4


@pytest.fixture
def host(fmu: Path) -> Iterator[FmuInstance]:
    with FmuInstance(fmu) as host:
        yield host


def drive(seed: int, steps: int) -> list[tuple[float, dict[str, Any]]]:
    """A random run: a wandering master of period 10, commands, changes of phasing and rest, uneven steps."""
    r = random.Random(seed)
    position, plan = 0.0, []
    flags = {"start": False, "stop": False, "active": True}
    for _ in range(steps):
        h = 10.0 ** r.uniform(-4.0, -1.0)
        v, a = r.gauss(3.0, 6.0), r.gauss(0.0, 5.0)
        for name, often in (("start", 0.1), ("stop", 0.1), ("active", 0.01)):
            if r.random() < often:
                flags[name] = not flags[name]
        inputs = {"master.position": position % 10.0, "master.velocity": v, "master.acceleration": a, **flags}
        if r.random() < 0.05:
            inputs |= {"rest_value": r.uniform(-20.0, 20.0), "output_phasing": r.choice((0.0, 0.5, 2.0, -3.0, 12.0))}
        plan.append((h, inputs))
        position += (v + 0.5 * a * h) * h
    return plan


START = {"master.period": 10.0, "output_phasing": 2.0, "rest_value": 4.0}


def description(fmu: Path) -> Any:
    with zipfile.ZipFile(fmu) as z:
        return fromstring(z.read("modelDescription.xml"))


# --- the standard ---


def test_fmpy_finds_no_fault(block_fmu: Path) -> None:
    assert faults_by_fmpy(block_fmu) == []


def test_fmpy_finds_a_fault_each_time(fmu: Path, tmp_path: Path) -> None:
    """Also in the name of a variable: FMPy parses each name once in these tests."""
    with zipfile.ZipFile(fmu) as z:
        text = z.read("modelDescription.xml")
    assert b'name="stop"' in text
    (tmp_path / "modelDescription.xml").write_bytes(text.replace(b'name="stop"', b'name="st?op"'))
    for _ in range(2):
        (fault,) = faults_by_fmpy(tmp_path)
        assert "st?op" in fault


def test_fmutool_finds_no_error_or_warning(fmu: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Of all blocks it checks the native flavour (tests/native/test_libraries.py); the description of this one has the
    same variables, units and types."""
    check_by_fmutool(fmu, caplog)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [('causality="input"', 'causality="entry"'), ('name="stop"', 'name="start"')],
    ids=["not in the schema", "a name twice"],
)
def test_fmutool_finds_a_fault(
    fmu: Path, right: str, wrong: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Otherwise the test above would prove nothing."""
    faulty = tmp_path / fmu.name
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(faulty, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                assert right.encode() in content
                content = content.replace(right.encode(), wrong.encode(), 1)
            target.writestr(name, content)
    with pytest.raises(AssertionError):
        check_by_fmutool(faulty, caplog)


def test_capabilities(block_fmu: Path) -> None:
    unit = read_model_description(str(block_fmu)).coSimulation
    assert unit.canHandleVariableCommunicationStepSize
    assert unit.canGetAndSetFMUstate
    assert unit.canSerializeFMUstate
    assert not unit.needsExecutionTool
    assert not unit.canBeInstantiatedOnlyOncePerProcess


def test_the_interface_is_the_specified_one(fmu: Path) -> None:
    """Written out by hand: users wire against these names."""
    names = {
        v.name: (v.causality, v.variability, v.type, v.start) for v in read_model_description(str(fmu)).modelVariables
    }
    real_in = ("input", "continuous", "Real", "0.0")
    out_real, out_int, out_bool = (
        ("output", k, t, None) for k, t in (("continuous", "Real"), ("discrete", "Integer"), ("discrete", "Boolean"))
    )
    assert names == {
        "master.position": real_in,
        "master.velocity": real_in,
        "master.acceleration": real_in,
        "master.input_mode": ("parameter", "fixed", "Enumeration", "1"),
        "master.period": ("parameter", "fixed", "Real", "0.0"),
        "master.smoothing_time": ("parameter", "fixed", "Real", "0.02"),
        "master.delay": ("parameter", "fixed", "Real", "0.0"),
        "master.sample_time": ("parameter", "fixed", "Real", "0.0"),
        "master.smoothed_position": ("local", "continuous", "Real", None),
        "master.smoothed_velocity": ("local", "continuous", "Real", None),
        "master.smoothed_acceleration": ("local", "continuous", "Real", None),
        "master.input_warning": ("local", "discrete", "Integer", None),
        "master.likely_period": ("local", "discrete", "Real", None),
        "master.velocity_ratio": ("local", "discrete", "Real", None),
        "curve": ("parameter", "fixed", "Enumeration", "2"),
        "output_phasing": ("parameter", "tunable", "Real", "90.0"),
        "active": ("input", "discrete", "Boolean", "true"),
        "start": ("input", "discrete", "Boolean", "false"),
        "stop": ("input", "discrete", "Boolean", "false"),
        "rest_value": ("input", "discrete", "Real", "0.0"),
        "slave.position": out_real,
        "slave.velocity": out_real,
        "slave.acceleration": out_real,
        "slave.jerk": out_real,
        "state": ("output", "discrete", "Enumeration", None),
        "state_code": out_int,
        "ready": out_bool,
        "synchronized": out_bool,
        "status": out_int,
        "syn_synchronized": out_bool,
        "syn_ramp_on": out_bool,
        "error": out_bool,
        "error_id": out_int,
        "local.ramp_begin": ("local", "discrete", "Real", None),
        "local.ramp_end": ("local", "discrete", "Real", None),
        "local.progress": ("local", "continuous", "Real", None),
        "local.distance_to_begin": ("local", "continuous", "Real", None),
        "local.distance_to_end": ("local", "continuous", "Real", None),
        "local.transition_distance": ("local", "discrete", "Real", None),
        "local.peak_acceleration_per_v2": ("local", "discrete", "Real", None),
        "local.peak_jerk_per_v3": ("local", "discrete", "Real", None),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "bases"),
    [
        (
            "mm",
            {
                "mm/s": {"m": "1", "s": "-1", "factor": "0.001"},
                "mm/s2": {"m": "1", "s": "-2", "factor": "0.001"},
                "1/mm2": {"m": "-2", "factor": "1000000.0"},
            },
        ),
        ("m", {"m/s": {"m": "1", "s": "-1"}, "m/s3": {"m": "1", "s": "-3"}}),
        (
            "deg",
            {
                "deg/s": {"rad": "1", "s": "-1", "factor": "0.017453292519943295"},
                "1/deg": {"rad": "-1", "factor": "57.29577951308232"},
            },
        ),
        ("rad", {"rad/s": {"rad": "1", "s": "-1"}}),
        ("1", {"1/s": {"s": "-1"}, "1/s2": {"s": "-2"}, "1": {}}),
    ],
)
def test_units_have_si_factors(tmp_path: Path, unit: str, bases: dict[str, dict[str, str]]) -> None:
    root = description(build_python(Recipe("Synchronizer", unit), tmp_path / "Synchronizer.fmu"))
    units = {u.get("name"): u.find("BaseUnit").attrib for u in root.findall("UnitDefinitions/Unit")}
    assert {name: units[name] for name in bases} == bases
    used = {t.get("name"): t.find("Real").get("unit") for t in root.iterfind("TypeDefinitions/SimpleType[Real]")}
    assert set(used.values()) <= set(units)
    quantities = {"Position": unit, "Velocity": f"{unit}/s", "Acceleration": f"{unit}/s2"}
    assert {name: used[name] for name in quantities} == quantities
    assert faults_by_fmpy(tmp_path / "Synchronizer.fmu") == []


def test_the_default_step_is_a_cycle_of_a_block_that_has_cycles(tmp_path: Path) -> None:
    for recipe, step in (
        (Recipe("Synchronizer"), "0.001"),
        (Recipe("RemoteSync"), "0.002"),
        (Recipe("RemoteSync", "mm", {"task_cycle_time": "0.0005"}), "0.0005"),
    ):
        root = description(build_python(recipe, tmp_path / f"{step}.fmu"))
        assert root.find("DefaultExperiment").get("stepSize") == step


def test_everything_is_described(block_fmu: Path) -> None:
    root = description(block_fmu)
    for tag in ("ScalarVariable", "SimpleType/Enumeration/Item", "Category"):
        for element in root.iter(tag.rpartition("/")[2]):
            assert element.get("description"), element.attrib


def test_the_project_is_named_and_no_date_is_made_up(block_fmu: Path) -> None:
    root = description(block_fmu)
    copyright_ = next(line for line in (ROOT / "LICENSE").read_text().splitlines() if line.startswith("Copyright"))
    assert copyright_ == "Copyright (c) 2026 The motionsync authors"
    named = {name: root.get(name) for name in ("author", "copyright", "license", "version", "generationTool")}
    assert named == {
        "author": "The motionsync authors",
        "copyright": copyright_,
        "license": "MIT",
        "version": __version__,
        "generationTool": f"motionsync {__version__} (https://github.com/motionsync/motionsync)",
    }
    assert root.get("generationDateAndTime") is None


def test_the_limits_are_described(block: str, block_fmu: Path) -> None:
    """As numbers of the variable's type; a limit that is itself refused is written there as well."""
    result = {v.name: v for v in read_model_description(str(block_fmu)).modelVariables}
    for v in variables(BLOCKS[block]()):
        d, messages = v.declaration, result[v.name]
        number = {"Real": float, "Integer": int}.get(v.kind, str)
        limits = [x if math.isfinite(x) else None for x in (max(d.min, d.above), min(d.max, d.below))]
        assert [number(x) if x else None for x in (messages.min, messages.max)] == limits, v.name
        assert limits == [None, None] or v.kind in ("Real", "Integer")


def test_the_limits_of_integers_are_described(fmus: Fmus) -> None:
    result = {v.name: v for v in read_model_description(str(fmus.python("RemoteSync"))).modelVariables}
    limits = {name: (v.min, v.max) for name, v in result.items() if v.type == "Integer" and (v.min or v.max)}
    assert limits == {
        "max_cycle_index_difference": ("0", None),
        "age_of_data_limit": ("0", None),
        "periods_for_mean_drift": ("1", "64"),
        "end_of_transition_limit": ("1", None),
        "new_drift_blending_cycles": ("1", None),
        "time_mode_blending_cycles": ("1", None),
    }


def test_inside_the_fmu(block: str, block_fmu: Path) -> None:
    with zipfile.ZipFile(block_fmu) as z:
        names = set(z.namelist())
        page = z.read("documentation/index.html").decode()
        assert z.read("model.png").startswith(b"\x89PNG")
        assert b"<svg" in z.read("documentation/example.svg")
        assert all(i.compress_type == zipfile.ZIP_DEFLATED and "\\" not in i.filename for i in z.infolist())
        licence = z.read("documentation/licenses/license.txt").decode()
    assert "documentation/externalDependencies.html" in names
    assert re.findall(r"^(.*)\n=+\n\n(.*)\n\nCopyright \(c\)", licence, re.M) == [
        ("motionsync", "MIT License"),
        ("pythonfmu", "MIT License"),
    ]
    assert f"binaries/linux64/{block}.so" in names
    listed: list[str] = []
    for group in re.findall(r'<tr id="variables-(\w*)">(.*?)(?=<tr id="variables-|</table>)', page, re.S):
        prefix = f"{group[0]}." if group[0] else ""
        listed += [prefix + name for name in re.findall(r"<tr><th>(.*?)</th><td>", group[1])]
    assert sorted(listed) == sorted(v.name for v in variables(BLOCKS[block]()))


def test_dependencies_after_initialization_are_the_declared_ones(block: str) -> None:
    """Moving an input or parameter changes exactly the outputs and local variables that say so, for at least one start.
    After 30 starts only those are moved on which something is said to depend that has not been found yet."""
    declared = {(v.name, source) for v in variables(BLOCKS[block]()) for source in v.depends}
    result: set[tuple[str, str]] = set()
    for number, run in enumerate(draw_runs(block, 0, 200)):
        missing = {source for _, source in declared - result}
        before = outputs(block, run.start)
        for v in declared_by(block)[0].values():
            if not v.settable or before is None or (number >= 30 and v.name not in missing):
                continue
            for value in moved(v, run.start.get(v.name, v.start)):
                after = outputs(block, run.start | {v.name: value}) or before
                result |= {(name, v.name) for name in before if before[name] != after[name]}
        if number >= 29 and result == declared:
            break
    assert result == declared


def moved(v: Variable, value: Any) -> list[Any]:
    """Other values that a variable may have."""
    if v.kind == "Boolean":
        return [not value]
    others = v.choices or ([value + 1] if v.kind == "Integer" else [value + 1.0, 0.7 * value])
    return [x for x in others if x != value and v.allows(x)]


def outputs(block: str, start: dict[str, Any]) -> dict[str, Any] | None:
    """The outputs and local variables after initialization; None if it is refused."""
    instance, (own, messages) = BLOCKS[block](), declared_by(block)
    for name, value in start.items():
        *groups, _ = name.split(".")
        replace(own[name].cell, owner=reduce(getattr, groups, instance)).set(value)
    if instance.initialize():
        return None
    return dict(zip(messages, attrgetter(*messages)(instance), strict=True))


@cache
def declared_by(block: str) -> tuple[dict[str, Variable], list[str]]:
    """A block's variables by name, and the names of outputs and local variables."""
    own = {v.name: v for v in variables(BLOCKS[block]())}
    return own, [name for name, v in own.items() if not v.settable]


# --- reproducible ---


def rebuilt(folder: Path, root: Path = ROOT, **environment: str) -> Path:
    """Built in a process of its own, from sources that may be a changed copy."""
    code = (
        "from pathlib import Path; from motionsync_fmu.fmus.fmu import *;"
        f"build_python(Recipe('Synchronizer'), Path({str(folder / 'Synchronizer.fmu')!r}))"
    )
    path = os.pathsep.join(str(root / part) for part in ("model", "fmu_src"))
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ | {"PYTHONPATH": path} | environment)
    return folder / "Synchronizer.fmu"


def test_two_builds_are_byte_identical(fmu: Path, tmp_path: Path) -> None:
    assert rebuilt(tmp_path, PYTHONHASHSEED="42", TZ="Asia/Tokyo").read_bytes() == fmu.read_bytes()


def test_source_date_epoch_is_honoured(fmu: Path, tmp_path: Path) -> None:
    dated = rebuilt(tmp_path, SOURCE_DATE_EPOCH="1700000000")
    assert description(dated).get("generationDateAndTime") == "2023-11-14T22:13:20Z"
    with zipfile.ZipFile(dated) as z:
        assert {i.date_time[:5] for i in z.infolist()} == {(2023, 11, 14, 22, 13)}
    assert description(dated).get("guid") == description(fmu).get("guid")


@pytest.fixture(scope="session")
def other(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Another version of the block: it rests one unit beside the rest value, and fails at a rest value of 77."""
    root = tmp_path_factory.mktemp("other")
    for folder in ("model", "fmu_src"):
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__"))
    source = root / "model" / "motionsync" / "synchronizer" / "block.py"
    old = "self.slave.set(self.rest, 0.0, 0.0, 0.0)"
    assert old in source.read_text()
    new = "self.slave.set(self.rest + 1.0, 0.0 / (self.rest - 77.0), 0.0, 0.0)"
    source.write_text(source.read_text().replace(old, new))
    return rebuilt(root, root)


def test_two_versions_in_one_process_do_not_mix(fmu: Path, other: Path) -> None:
    with ExitStack() as stack:
        hosts = [stack.enter_context(FmuInstance(f)).initialize({"active": False}) for f in (fmu, other, fmu)]
        for host in hosts:
            host.step(0.1)
            host.step(0.1, {"stop": True, "rest_value": 5.0})
        assert [host.get()["slave.position"] for host in hosts] == [5.0, 6.0, 5.0]


# --- the FMU state ---


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_a_state_of_any_block_brings_back_the_same_bits(fmus: Fmus, block: str, flavour: str) -> None:
    """In its own instance and in another one, also through bytes; each twentieth step is looked at."""
    fmu = getattr(fmus, flavour)(block)
    run = draw_accepted_run(block, 2.0**-7, 300)

    def stretch(host: FmuInstance) -> list[dict[str, Any]]:
        rows = []
        for number, (h, values) in enumerate(run.steps[100:]):
            host.step(h, values)
            if number % 20 == 19:
                rows.append(bits(host.get()))
        return rows

    with FmuInstance(fmu) as host, FmuInstance(fmu) as second:
        host.initialize(run.start)
        second.initialize()
        for h, values in run.steps[:100]:
            host.step(h, values)
        state = host.unit.getFMUstate()
        saved = host.unit.serializeFMUstate(state)
        first = stretch(host)
        assert first[0] != first[-1]
        host.unit.setFMUstate(state)
        assert stretch(host) == first
        second.unit.setFMUstate(second.unit.deSerializeFMUstate(saved))
        assert stretch(second) == first


# --- refusals ---


@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("output_phasing", 0.0, "output_phasing = 0 is not allowed: it must be a magnitude of 1e-09 to 1e+12"),
        ("output_phasing", 1e-10, "output_phasing = 1e-10 is not allowed"),
        ("output_phasing", -2e12, "output_phasing = -2e+12 is not allowed"),
        ("output_phasing", math.nan, "output_phasing = nan is not allowed"),
        ("output_phasing", math.inf, "output_phasing = inf is not allowed"),
        ("master.period", -1.0, "master.period = -1 is not allowed: it must be 0, or >= 1e-09"),
        ("master.period", 1e-10, "master.period = 1e-10 is not allowed"),
        ("master.period", math.nan, "master.period = nan is not allowed"),
        ("master.period", math.inf, "master.period = inf is not allowed"),
        ("curve", 3, "curve = 3 is not allowed: it must be 1 PARABOLA, 2 POLYNOMIAL_3_4_5"),
        ("master.input_mode", 0, "master.input_mode = 0 is not allowed: it must be 1 START_OF_STEP"),
        ("master.position", math.nan, "master.position = nan is not allowed: it must be -1e+12 to 1e+12"),
    ],
)
def test_a_bad_start_value_fails_the_initialization(
    fmu: Path, host: FmuInstance, name: str, value: Any, shown: str
) -> None:
    with pytest.raises(FmuError) as e:
        host.initialize({name: value})
    assert e.value.__cause__.status == FATAL
    assert shown in str(e.value)
    with FmuInstance(fmu) as new:  # the way on: a new instance
        new.initialize().step(0.1)


@pytest.mark.parametrize("flavour", ["python", "native"])
@pytest.mark.parametrize(
    ("name", "value", "shown"),
    [
        ("periods_for_mean_drift", 0, "periods_for_mean_drift = 0 is not allowed: it must be 1 to 64"),
        ("periods_for_mean_drift", 65, "periods_for_mean_drift = 65 is not allowed: it must be 1 to 64"),
        ("periods_for_mean_drift", 2**31 - 1, "periods_for_mean_drift = 2147483647 is not allowed"),
        ("age_of_data_limit", -1, "age_of_data_limit = -1 is not allowed: it must be 0 to 2147483647"),
        ("end_of_transition_limit", 0, "end_of_transition_limit = 0 is not allowed: it must be 1 to 2147483647"),
        ("end_of_transition_limit", -(2**31), "end_of_transition_limit = -2147483648 is not allowed"),
    ],
)
def test_an_integer_beyond_its_limits_fails_the_initialization(
    fmus: Fmus, flavour: str, name: str, value: int, shown: str
) -> None:
    fmu = getattr(fmus, flavour)("RemoteSync")
    with FmuInstance(fmu) as host, pytest.raises(FmuError) as e:
        host.initialize({name: value})
    assert shown in str(e.value)
    assert [text for text in host.messages if shown in text] == [host.messages[0]]


@pytest.mark.parametrize("flavour", ["python", "native"])
def test_an_integer_at_its_limits_is_taken(fmus: Fmus, flavour: str) -> None:
    limits = {"age_of_data_limit": 0, "max_cycle_index_difference": 0, "end_of_transition_limit": 2**31 - 1}
    for periods in (1, 64):
        with FmuInstance(getattr(fmus, flavour)("RemoteSync")) as host:
            host.initialize(limits | {"periods_for_mean_drift": periods}).step(0.1)
            assert not host.messages


def test_contradictory_start_values_fail_the_initialization(host: FmuInstance) -> None:
    with pytest.raises(FmuError, match=r"at most 1e15 periods \(master.position = 1e\+12, .*master.period = 1e-09\)"):
        host.initialize({"master.position": 1e12, "master.period": 1e-9})


def test_a_bad_value_at_run_time_refuses_the_command(host: FmuInstance) -> None:
    host.initialize({"output_phasing": 10.0, "master.velocity": 1.0})
    for phasing in (0.0, math.nan, math.inf, 1e-10):
        host.step(0.5, {"output_phasing": phasing, "stop": False, "master.position": host.time})
        assert not host.get()["error"]
        host.step(0.5, {"stop": True, "master.position": host.time})
        now = host.get()
        assert (now["error"], now["error_id"], now["state_code"], now["synchronized"]) == (1, 1, 0, 1)
        assert now["slave.position"] == pytest.approx(host.time, abs=1e-12)
        assert "command refused: output_phasing must have a magnitude of 1e-9 to 1e12" in host.messages[-1]
        host.step(0.5, {"start": True, "master.position": host.time})  # ignored, and clears the fault
        host.step(0.5, {"start": False, "master.position": host.time})
        assert not host.get()["error"]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1.1e12])
@pytest.mark.parametrize("name", ["master.position", "master.velocity", "master.acceleration", "rest_value"])
def test_a_bad_input_fails_the_step_and_changes_nothing(fmu: Path, host: FmuInstance, name: str, value: float) -> None:
    with FmuInstance(fmu) as clean:
        for h in (host, clean):
            h.initialize(START)
        for h, inputs in drive(5, 60):
            host.set(inputs | {name: value})
            before = bits(host.get())
            with pytest.raises(FmuError, match="is not allowed: it must be") as e:
                host.call(host.unit.doStep, host.time, h)
            assert e.value.__cause__.status == DISCARD
            assert f"{name} = " in str(e.value)
            assert bits(host.get()) == before
            host.step(h, {"rest_value": 4.0} | inputs)
            clean.step(h, {"rest_value": 4.0} | inputs)
            assert bits(host.get()) == bits(clean.get())


def test_a_bad_step_size_fails_the_step_and_changes_nothing(fmu: Path, host: FmuInstance) -> None:
    with FmuInstance(fmu) as clean:
        for h in (host, clean):
            h.initialize(START)
        for h, inputs in drive(6, 100):
            host.set(inputs)
            for bad in (0.0, -h, math.nan, math.inf, 1.1e6):
                with pytest.raises(FmuError, match=r"step size = .* is not allowed: it must be > 0 and <= 1e\+06"):
                    host.call(host.unit.doStep, host.time, bad)
            host.step(h, inputs)
            clean.step(h, inputs)
            assert bits(host.get()) == bits(clean.get())


def test_a_position_of_too_many_turns_fails_the_step(host: FmuInstance) -> None:
    host.initialize({"master.period": 1e-9})
    before = host.unit.serializeFMUstate(host.unit.getFMUstate())
    with pytest.raises(FmuError, match=r"at most 1e15 periods \(.*master.velocity = 1e\+12"):
        host.step(1e3, {"master.velocity": 1e12})
    host.set({"master.velocity": 0.0})
    assert host.unit.serializeFMUstate(host.unit.getFMUstate()) == before


def test_an_exception_in_the_block_ends_the_unit(other: Path) -> None:
    """As an arithmetic error does in the native flavour: no copy is made before a step to go back to."""
    with FmuInstance(other) as host:
        host.initialize({"active": False})
        host.step(0.1)
        saved = host.unit.getFMUstate()
        with pytest.raises(FmuError, match=r"an arithmetic error \(float division by zero\).*must be reset") as e:
            host.step(0.1, {"stop": True, "rest_value": 77.0})
        assert e.value.__cause__.status == FATAL
        for call in (lambda: host.set({"rest_value": 7.0}), lambda: host.step(0.1)):
            with pytest.raises(FmuError, match="is not allowed now: the unit has been terminated"):
                call()
        host.unit.setFMUstate(saved)
        host.step(0.1, {"stop": True, "rest_value": 7.0})
        assert host.get()["slave.position"] == 8.0


@pytest.mark.parametrize("name", ["master.period", "slave.position", "local.progress", "curve"])
def test_what_is_not_settable_now_is_refused(host: FmuInstance, name: str) -> None:
    host.initialize()
    host.step(0.1)
    with pytest.raises(FmuError, match=f"{name} .*cannot be set now"):
        host.set({name: 1})


def test_a_log_text_has_no_percent_sign(host: FmuInstance) -> None:
    """PythonFMU would read a conversion from it, and memory that is not there."""
    with pytest.raises(FmuError):
        host.initialize({"output_phasing": 0.0})
    assert all("%" not in text for text in host.messages)


def test_many_instances_come_and_go(fmu: Path) -> None:
    for _ in range(20):
        with ExitStack() as stack:
            hosts = [stack.enter_context(FmuInstance(fmu)) for _ in range(3)]
            hosts[0].initialize({"output_phasing": 5.0}).step(0.1)
            with pytest.raises(FmuError):
                hosts[1].initialize({"output_phasing": 0.0})
            hosts[2].initialize().step(0.1)


def test_counts_of_cycles_stay_integers_of_32_bits() -> None:
    """In a run of weeks, of which only the end is stepped: no index has come for ever so long."""
    block = RemoteSync(age_of_data_limit=0, max_cycle_index_difference=0)
    block.initialize()
    block.step(block.task_cycle_time)
    most = 2**31 - 1
    block.cycle = block.equal_data_total = block.equal_data_consecutive = most - 2
    for _ in range(5):
        block.step(block.task_cycle_time)
    assert block.cycle > most
    assert block.zone.difference < -most
    assert (block.local.cycles, block.local.difference) == (most, -most)
    assert (block.equal_data_total, block.equal_data_consecutive) == (most, most)
