"""The FMI functions of the native flavour: states of life, checks, log, derivatives, threads."""

import ctypes
import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy import fmi2
from fmpy.fmi1 import FMICallException
from hypothesis import assume, example, given
from hypothesis import strategies as st

from motionsync_fmu.interface.fmi2_xml import CATEGORIES
from motionsync_fmu.interface.variables import shown
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.hosts.importers import Logged
from tests.support.hosts.native_host import DISCARD, ERROR, OK, ROTARY, WARNING, refused, run_steps, saved

# --- states of life ---


def test_calls_in_the_wrong_state_are_refused(host: FmuInstance) -> None:
    unit, reference = host.unit, host.kinds["master.position"][0]
    with refused(host, "fmi2DoStep is not allowed now: the unit is instantiated"):
        unit.doStep(0.0, 0.1)
    with refused(host, "fmi2GetReal is not allowed now"):
        unit.getReal([reference])
    with refused(host):
        unit.exitInitializationMode()
    with refused(host):
        unit.terminate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    for call in (unit.enterInitializationMode, unit.terminate, unit.setupExperiment):
        with refused(host, "is in initialization mode"):
            call()
    with refused(host):
        unit.doStep(0.0, 0.1)
    unit.exitInitializationMode()
    for call in (unit.enterInitializationMode, unit.exitInitializationMode, unit.setupExperiment):
        with refused(host, "is in step mode"):
            call()
    with refused(host, "no step is under way"):
        unit.cancelStep()
    unit.doStep(0.0, 0.1)
    unit.terminate()
    with refused(host, "has been terminated"):
        unit.doStep(0.1, 0.1)
    with refused(host):
        unit.setReal([reference], [1.0])
    assert unit.getReal([reference]) == [0.0]
    unit.reset()
    host.initialize()
    host.step(0.1)


def test_a_reset_brings_back_the_start_values(host: FmuInstance) -> None:
    first = run_steps(host.initialize(ROTARY), 300, stop=True)
    host.unit.reset()
    assert saved(host) == saved(host)
    host.time = 0.0
    assert run_steps(host.initialize(ROTARY), 300, stop=True) == first
    host.unit.reset()
    host.initialize()
    assert host.get(["master.period", "output_phasing"]) == {"master.period": 0.0, "output_phasing": 90.0}


def test_what_cannot_be_instantiated_is_reported(native: Path, host: FmuInstance) -> None:
    def attempt(name: Any, kind: int, guid: Any) -> Any:
        instantiate = host.unit.dll.fmi2Instantiate
        return instantiate(name, kind, guid, b"file:///", byref(host.callbacks), 0, 1)

    guid = host.description.guid.encode()
    for arguments, message in (
        ((b"", 1, guid), "needs a name"),
        ((None, 1, guid), "needs a name"),
        ((b"a", 0, guid), "co-simulation only"),
        ((b"a", 1, b"{other}"), "the GUID is not that of this unit"),
        ((b"a", 1, None), "the GUID is not that of this unit"),
    ):
        assert not attempt(*arguments)
        assert message in host.messages.pop()
    assert not host.unit.dll.fmi2Instantiate(b"a", 1, guid, b"", None, 0, 1)


# --- values ---


def test_only_inputs_and_parameters_of_the_right_type_can_be_set(host: FmuInstance) -> None:
    unit = host.unit
    reference = {name: r for name, (r, _) in host.kinds.items()}
    host.initialize()
    with refused(host, "no Real has the value reference 10000"):
        unit.setReal([0, 10000], [1.0, 2.0])
    with refused(host, "no Real has the value reference 4294967295"):
        unit.getReal([0, 4294967295])
    with refused(host, "no Integer or Enumeration has the value reference 0"):
        unit.getInteger([0])
    with refused(host, "no Boolean has"):
        unit.setBoolean([reference["curve"]], [True])
    with refused(host, "slave.position (continuous output) cannot be set now"):
        unit.setReal([0, reference["slave.position"]], [1.0, 2.0])
    with refused(host, "curve (fixed parameter) cannot be set now"):
        unit.setInteger([reference["curve"]], [1])
    with refused(host, "no String has"):
        unit.getString([0])
    with refused(host, "no String has"):
        unit.setString([0], ["a"])
    host.set({"output_phasing": 30.0, "master.position": math.nan})
    assert host.get(["output_phasing"]) == {"output_phasing": 30.0}


def test_missing_pointers_are_refused(host: FmuInstance) -> None:
    dll, c = host.unit.dll, c_void_p(host.unit.component)
    r, x, n, size, state = (c_uint * 1)(0), (c_double * 1)(0.0), (c_int * 1)(0), c_size_t(), c_void_p()
    host.initialize()
    calls: list[tuple[str, tuple[Any, ...]]] = [
        ("fmi2GetReal", (None, c_size_t(1), x)),
        ("fmi2GetReal", (r, c_size_t(1), None)),
        ("fmi2SetReal", (None, c_size_t(1), x)),
        ("fmi2SetReal", (r, c_size_t(1), None)),
        ("fmi2GetInteger", (r, c_size_t(1), None)),
        ("fmi2SetBoolean", (None, c_size_t(1), n)),
        ("fmi2SetDebugLogging", (1, c_size_t(1), None)),
        ("fmi2GetFMUstate", (None,)),
        ("fmi2SetFMUstate", (None,)),
        ("fmi2SerializedFMUstateSize", (None, byref(size))),
        ("fmi2SerializeFMUstate", (None, b"", c_size_t(0))),
        ("fmi2DeSerializeFMUstate", (None, c_size_t(0), byref(state))),
        ("fmi2DeSerializeFMUstate", (b"abc", c_size_t(3), None)),
        ("fmi2SetRealInputDerivatives", (r, c_size_t(1), None, x)),
        ("fmi2GetRealOutputDerivatives", (r, c_size_t(1), n, None)),
        ("fmi2GetRealStatus", (2, None)),
        ("fmi2GetBooleanStatus", (3, None)),
        ("fmi2GetStatus", (0, None)),
    ]
    plain = ctypes.CDLL(dll._name)
    for name, arguments in calls:
        messages = len(host.messages)
        assert plain[name](c, *arguments) == ERROR, name
        assert len(host.messages) == messages + 1
        assert plain[name](None, *arguments) == ERROR, name
    for name in ("fmi2GetReal", "fmi2SetReal", "fmi2GetString"):
        assert plain[name](c, None, c_size_t(0), None) == OK
    assert plain.fmi2FreeFMUstate(c, None) == OK
    assert plain.fmi2FreeFMUstate(c, byref(c_void_p())) == OK
    plain.fmi2FreeInstance(None)


def test_outputs_follow_inputs_while_initializing(host: FmuInstance) -> None:
    host.unit.setupExperiment(startTime=0.0)
    host.unit.enterInitializationMode()
    host.set({"master.position": 400.0, "master.velocity": 3.0, "master.period": 360.0})
    assert host.get(["slave.position", "slave.velocity"]) == {"slave.position": 40.0, "slave.velocity": 3.0}
    host.set({"master.position": math.nan})  # refused at the end of the initialization
    assert host.get(["slave.position"]) == {"slave.position": 40.0}
    assert not host.messages


INVALID_STARTS = [
    (
        {"master.input_mode": 5},
        "master.input_mode = 5 is not allowed: it must be 1 START_OF_STEP, 2 END_OF_STEP, 3 POSITION_ONLY, 4 MEASURED",
    ),
    ({"master.smoothing_time": 10.5}, "master.smoothing_time = 10.5 is not allowed: it must be 0 to 10"),
    ({"master.smoothing_time": math.nan}, "master.smoothing_time = nan is not allowed"),
    ({"master.delay": -1e-3}, "master.delay = -0.001 is not allowed: it must be 0 to 1"),
    ({"master.sample_time": 2.0}, "master.sample_time = 2 is not allowed: it must be 0, or 1e-09 to 1"),
    ({"master.sample_time": math.inf}, "master.sample_time = inf is not allowed"),
    ({"curve": -7}, "curve = -7 is not allowed: it must be 1 PARABOLA, 2 POLYNOMIAL_3_4_5"),
    ({"master.period": 1e-10}, "master.period = 1e-10 is not allowed: it must be 0, or >= 1e-09"),
    ({"master.period": -1.0}, "master.period = -1 is not allowed"),
    ({"output_phasing": 0.0}, "output_phasing = 0 is not allowed: it must be a magnitude of 1e-09 to 1e+12"),
    ({"output_phasing": math.nan}, "output_phasing = nan is not allowed"),
    ({"rest_value": -math.inf}, "rest_value = -inf is not allowed"),
    ({"master.period": 1e-9, "master.position": 1e9}, "(master.position = 1e+09, master.velocity = 0, master.accel"),
]


@pytest.mark.parametrize(("invalid", "message"), INVALID_STARTS)
def test_a_refused_parameter_is_reported_and_the_unit_can_be_used_again(
    host: FmuInstance, invalid: dict[str, Any], message: str
) -> None:
    host.unit.setupExperiment(startTime=0.0)
    host.unit.enterInitializationMode()
    host.set(invalid)
    with refused(host, message):
        host.unit.exitInitializationMode()
    host.unit.reset()
    host.initialize()
    host.step(0.1)


def test_a_refused_step_changes_nothing_and_the_next_valid_one_succeeds(native: Path, host: FmuInstance) -> None:
    with FmuInstance(native) as clean:
        host.initialize(ROTARY)
        clean.initialize(ROTARY)
        for i in range(300):
            valid = {"master.position": 90.0 * clean.time % 360.0, "stop": i > 20, "rest_value": 180.0}
            for name, value in (("master.position", math.nan), ("rest_value", math.inf), ("master.velocity", -2e12)):
                host.set(valid | {name: value})
                with refused(host, f"{name} = {shown(value)} is not allowed: it must be -1e+12 to 1e+12"):
                    host.unit.doStep(host.time, 0.01)
                host.set({"master.velocity": 90.0})
            for h in (0.0, -0.01, math.nan, math.inf, 1.1e6):
                host.set(valid)
                with refused(host, f"step size = {shown(h)} is not allowed: it must be > 0 and <= 1e+06"):
                    host.unit.doStep(host.time, h)
            host.step(0.01, valid)
            clean.step(0.01, valid)
            assert host.get() == clean.get()
        assert saved(host) == saved(clean)


# --- log ---


def test_a_fault_is_a_warning(host: Logged) -> None:
    host.initialize({"output_phasing": 45.0})
    host.step(0.1, {"output_phasing": 1e-10, "stop": True})
    text = "command refused: output_phasing must have a magnitude of 1e-9 to 1e12 (output_phasing = 1e-10)"
    assert host.lines == [(WARNING, "logStatusWarning", text)]
    host.step(0.1, {"stop": False})
    assert len(host.lines) == 1


@pytest.mark.parametrize(
    ("on", "categories", "warnings", "errors"),
    [
        (True, [], True, True),
        (True, ["logAll"], True, True),
        (True, ["logStatusWarning"], True, False),
        (True, ["logStatusError"], False, True),
        (True, ["logStatusError", "logStatusWarning"], True, True),
        (False, [], True, True),
        (False, ["logStatusError"], True, True),
    ],
)
def test_only_the_categories_asked_for_are_logged(
    host: Logged, on: bool, categories: list[str], warnings: bool, errors: bool
) -> None:
    assert set(categories) <= set(CATEGORIES)
    host.initialize()
    host.unit.setDebugLogging(on, categories)
    with pytest.raises(FMICallException):
        host.unit.doStep(0.0, -1.0)
    host.step(0.1, {"output_phasing": 0.0, "stop": True})
    assert [status for status, _, _ in host.lines] == [ERROR] * errors + [WARNING] * warnings
    with pytest.raises(FMICallException):
        host.unit.setDebugLogging(True, ["logEverything"])


@given(st.floats(allow_nan=False, allow_infinity=False))
@example(2.0**-44)
@example(5e-324)
def test_numbers_are_shown_as_python_shows_them(same_host: FmuInstance, x: float) -> None:
    """Those of twelve digits; `tests/native/test_freestanding.py` has the others."""
    x = float(f"{x:.12g}")
    assume(math.isfinite(x))
    with pytest.raises(FMICallException):
        same_host.unit.doStep(0.0, -abs(x))
    assert same_host.messages.pop() == f"step size = {shown(-abs(x))} is not allowed: it must be > 0 and <= 1e+06"


@pytest.fixture(scope="module")
def same_host(native: Path) -> Iterator[FmuInstance]:
    with FmuInstance(native) as host:
        yield host.initialize()


# --- derivatives and status ---


def set_derivatives(host: FmuInstance, orders: dict[int, float], name: str = "master.position") -> int:
    """The status of fmi2SetRealInputDerivatives."""
    n = len(orders)
    function = ctypes.CDLL(host.unit.dll._name).fmi2SetRealInputDerivatives
    references = (c_uint * n)(*[host.kinds[name][0]] * n)
    component = c_void_p(host.unit.component)
    return int(function(component, references, c_size_t(n), (c_int * n)(*orders), (c_double * n)(*orders.values())))


@pytest.mark.parametrize("mode", [1, 3])
def test_derivatives_replace_velocity_and_acceleration_of_one_step(native: Path, host: FmuInstance, mode: int) -> None:
    """Each step with them equals a step of mode 1 with these inputs; a missing order keeps its input."""
    with FmuInstance(native) as other:
        host.initialize({"master.input_mode": mode})
        other.initialize()
        for orders in ({1: 5.0, 2: -3.0}, {1: 7.0}, {2: 2.0}):
            host.set({"master.position": 1.0, "master.velocity": 100.0, "master.acceleration": 10.0})
            assert set_derivatives(host, orders) == OK
            velocity, acceleration = orders.get(1, 100.0), orders.get(2, 10.0)
            other.step(0.5, {"master.position": 1.0, "master.velocity": velocity, "master.acceleration": acceleration})
            host.step(0.5)
            slave = [n for n in host.kinds if n.startswith("slave.")]
            assert host.get(slave) == other.get(slave)
            inputs = host.get(["master.velocity", "master.acceleration", "master.input_mode"])
            assert inputs == {"master.velocity": 100.0, "master.acceleration": 10.0, "master.input_mode": mode}
        before = host.get()
        host.step(0.5, {"master.position": 1.5})
        if mode == 1:
            assert host.get()["slave.velocity"] == 100.0 + 10.0 * 0.5
        assert host.get() != before


def test_estimates_go_on_after_a_step_with_derivatives(native: Path, host: FmuInstance) -> None:
    """In mode POSITION_ONLY the positions seen meanwhile count: a parabola is followed exactly after them."""
    host.initialize({"master.input_mode": 3})
    for i in range(8):
        if i in (3, 4):
            assert set_derivatives(host, {1: 2.0 * i, 2: 2.0}) == OK
        host.step(1.0, {"master.position": float(i * i)})
        if i >= 2:
            assert host.get(["slave.position", "slave.velocity", "slave.acceleration"]) == {
                "slave.position": (i + 1.0) ** 2,
                "slave.velocity": 2.0 * (i + 1),
                "slave.acceleration": 2.0,
            }


@pytest.mark.parametrize("mode", [2, 4])
def test_derivatives_that_are_of_no_use_are_ignored_with_a_warning(host: Logged, mode: int) -> None:
    host.initialize({"master.input_mode": mode})
    before = saved(host)
    assert set_derivatives(host, {1: 5.0}) == WARNING
    assert host.lines[-1][:2] == (WARNING, "logStatusWarning")
    assert saved(host) == before
    host.unit.reset()
    host.initialize()
    before = saved(host)
    for orders, name in (({3: 1.0}, "master.position"), ({1: 1.0}, "master.velocity"), ({1: 1.0}, "rest_value")):
        assert set_derivatives(host, orders, name) == WARNING
    assert saved(host) == before
    assert set_derivatives(host, {}) == OK
    assert set_derivatives(host, {1: 2.0, 3: 1.0}) == WARNING  # the first counts
    host.step(0.1)
    assert host.get(["slave.velocity"]) == {"slave.velocity": 2.0}


def test_wrong_derivatives_are_refused(host: FmuInstance) -> None:
    host.initialize()
    for orders, name, message in (
        ({1: 1.0, 0: 1.0}, "master.position", "order = 0 is not allowed"),
        ({-1: 1.0}, "master.position", "order = -1 is not allowed"),
        ({1: 1.0}, "slave.position", "slave.position (continuous output) is no input"),
        ({1: 1.0}, "stop", "no Real has the value reference"),
    ):
        before = saved(host)
        assert set_derivatives(host, orders, name) == ERROR
        assert message in host.messages.pop()
        assert saved(host) == before
    assert set_derivatives(host, {1: math.nan}) == OK
    with refused(host, "master.velocity = nan is not allowed"):
        host.unit.doStep(0.0, 0.1)
    assert set_derivatives(host, {1: 1.0}) == OK
    host.step(0.1)


def test_output_derivatives_are_those_of_the_slave(host: FmuInstance) -> None:
    result = run_steps(host.initialize(ROTARY), 150, stop=True)[-1]
    position = host.kinds["slave.position"][0]
    derivatives = host.unit.getRealOutputDerivatives([position, position], [1, 2])
    assert list(derivatives) == [result["slave.velocity"], result["slave.acceleration"]]
    assert derivatives[1] != 0.0
    for reference, order in ((position, 3), (position, 0), (host.kinds["slave.velocity"][0], 1), (10000, 1)):
        with refused(host):
            host.unit.getRealOutputDerivatives([reference], [order])


def test_the_description_offers_them(native: Path, fmu: Path) -> None:
    a, b = (fmpy.read_model_description(str(path)) for path in (native, fmu))
    assert a.guid == b.guid
    assert a.coSimulation.canInterpolateInputs
    assert a.coSimulation.maxOutputDerivativeOrder == 2
    assert not b.coSimulation.canInterpolateInputs
    assert [(v.name, v.valueReference, v.type) for v in a.modelVariables] == [
        (v.name, v.valueReference, v.type) for v in b.modelVariables
    ]


def test_status(host: FmuInstance) -> None:
    host.initialize()
    status = ctypes.CDLL(host.unit.dll._name)
    component = c_void_p(host.unit.component)
    last, flag, other = c_double(), c_int(7), c_int(7)
    assert status.fmi2GetRealStatus(component, fmi2.fmi2LastSuccessfulTime, byref(last)) == OK
    assert last.value == 0.0
    host.step(0.25)
    with pytest.raises(FMICallException):
        host.unit.doStep(0.25, -1.0)
    assert status.fmi2GetRealStatus(component, fmi2.fmi2LastSuccessfulTime, byref(last)) == OK
    assert last.value == 0.25
    assert status.fmi2GetBooleanStatus(component, fmi2.fmi2Terminated, byref(flag)) == OK
    assert flag.value == 0
    host.unit.terminate()
    assert status.fmi2GetBooleanStatus(component, fmi2.fmi2Terminated, byref(flag)) == OK
    assert flag.value == 1
    for call in (status.fmi2GetStatus, status.fmi2GetIntegerStatus, status.fmi2GetRealStatus):
        assert call(component, 0, byref(other)) == DISCARD
    assert other.value == 7
    with refused(host, "is not offered"):
        host.unit.getDirectionalDerivative([host.kinds["slave.position"][0]], [0], [1.0])


# --- many at once ---


def test_64_instances_in_8_threads_do_what_one_does_alone(native: Path, tmp_path: Path) -> None:
    folder = fmpy.extract(str(native), unzipdir=str(tmp_path))
    description = fmpy.read_model_description(folder)
    names = {v.name: v.valueReference for v in description.modelVariables}
    reals = [v.valueReference for v in description.modelVariables if v.type == "Real"]

    def run_alone(seed: int) -> list[tuple[float, ...]]:
        unit = fmi2.FMU2Slave(
            guid=description.guid, modelIdentifier="Synchronizer", instanceName=f"unit{seed}", unzipDirectory=folder
        )
        unit.instantiate()
        unit.setupExperiment()
        unit.enterInitializationMode()
        unit.setReal([names["master.period"], names["output_phasing"]], [360.0, 20.0 + seed])
        unit.exitInitializationMode()
        result, h = [], 0.01
        for i in range(500):
            unit.setReal([names["master.position"], names["master.velocity"]], [(1.8 + seed) * i % 360.0, 180.0])
            unit.setBoolean([names["stop"], names["start"]], [i > 50, i > 200])
            unit.doStep(i * h, h)
            result.append(tuple(unit.getReal(reals)))
        unit.fmi2FreeInstance(unit.component)
        return result

    alone = [run_alone(seed) for seed in range(8)]
    assert len({rows[-1] for rows in alone}) > 1
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(run_alone, [i % 8 for i in range(64)]))
    assert all(result == alone[i % 8] for i, result in enumerate(together))


# --- times ---


@pytest.mark.parametrize(
    ("start", "stop", "message"),
    [
        (math.nan, None, "start time = nan is not allowed: it must be finite"),
        (-math.inf, None, "start time = -inf is not allowed: it must be finite"),
        (2.0, 1.5, "stop time = 1.5 is not allowed: it must be >= the start time 2"),
        (0.0, math.nan, "stop time = nan is not allowed"),
    ],
)
def test_impossible_times_are_refused(host: FmuInstance, start: float, stop: float | None, message: str) -> None:
    with refused(host, f"fmi2SetupExperiment: {message}"):
        host.unit.setupExperiment(startTime=start, stopTime=stop)
    host.initialize()
    host.step(0.1)


def test_a_step_from_no_time_is_refused(host: FmuInstance) -> None:
    host.initialize()
    for now in (math.nan, math.inf):
        with refused(host, f"a step at the time {now} is not allowed: it must be finite"):
            host.unit.doStep(now, 0.1)


def test_no_step_goes_past_the_stop_time(host: FmuInstance) -> None:
    host.unit.setupExperiment(startTime=0.5, stopTime=1.0)
    host.unit.enterInitializationMode()
    host.unit.exitInitializationMode()
    now = 0.5
    for _ in range(5):
        host.unit.doStep(now, 0.1)
        now += 0.1  # in the end 1 or somewhat more, by rounding
    for step, size in ((1.0, 0.1), (0.9, 0.2), (0.95, 0.06), (7.0, 1e-3)):
        messages = f"a step of {size} at the time {shown(step)} is not allowed: it would end past the stop time 1"
        with refused(host, messages):
            host.unit.doStep(step, size)
    host.unit.doStep(0.95, 0.05)
    host.unit.reset()
    host.initialize()
    host.step(5.0)


# --- memory ---


def test_the_importers_functions_for_memory_are_not_called(native: Path) -> None:
    """Those of some importers are faulty; the description states that none are used."""
    called = []

    def allocate(n: int, size: int) -> int:
        called.append((n, size))
        return int(fmi2.calloc(n, size))

    with Logged(native) as host:
        assert host.description.coSimulation.canNotUseMemoryManagementFunctions
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = host.callbacks.logger
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(allocate)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(called.append)
        guid = host.description.guid.encode()
        other = host.unit.dll.fmi2Instantiate(b"unit", 1, guid, None, byref(callbacks), 0, 1)
        assert other
        host.unit.fmi2FreeInstance(other)
        assert called == []
