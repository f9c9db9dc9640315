"""What is different in FMI 3.0: discarded steps, the log, the time, the types of values, what is not offered."""

import ctypes
from collections.abc import Iterator
from ctypes import byref, c_bool, c_double, c_int32, c_int64, c_size_t, c_uint32, c_void_p
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException

from motionsync_fmu.scenario.run.fmu_instance import FmuError
from tests.support.hosts.importers import Logged
from tests.support.hosts.validation import faults_by_fmpy

OK, WARNING, DISCARD, ERROR = range(4)
LOGGED = {WARNING: "logStatusWarning", DISCARD: "logStatusDiscard", ERROR: "logStatusError"}


@pytest.fixture
def host(fmi3: Path) -> Iterator[Logged]:
    with Logged(fmi3) as host:
        host.lines = []
        yield host


def test_fmpy_finds_no_fault(block_fmi3: Path) -> None:
    assert faults_by_fmpy(block_fmi3) == []


def status_of(call: Any, *arguments: Any) -> int:
    try:
        call(*arguments)
    except FMICallException as e:
        return int(e.status)
    return OK


def test_a_refused_step_is_discarded_and_the_next_good_one_goes_on(host: Logged) -> None:
    host.initialize({"master.velocity": 90.0})
    host.step(0.5, {"master.position": 10.0})
    before = host.get()
    for name, value, h, text in (
        ("master.position", nan, 0.5, "master.position = nan is not allowed: it must be -1e+12 to 1e+12"),
        ("master.velocity", inf, 0.5, "master.velocity = inf is not allowed"),
        ("master.position", 10.0, 0.0, "step size = 0 is not allowed: it must be > 0 and <= 1e+06"),
        ("master.position", 10.0, nan, "step size = nan is not allowed"),
    ):
        host.set({name: value})
        assert status_of(host.unit.doStep, host.time, h) == DISCARD
        status, category, message = host.lines[-1]
        assert (status, category) == (DISCARD, LOGGED[DISCARD])
        assert text in message
        host.set({"master.position": 10.0, "master.velocity": 90.0})
        assert host.get() == before
    assert len(host.lines) == 4
    host.step(0.5, {"master.position": 55.0})
    assert host.get(["slave.position", "time"]) == {"slave.position": 100.0, "time": 1.0}


def test_a_refused_initialization_is_an_error(host: Logged) -> None:
    with pytest.raises(FmuError, match="output_phasing = 0 is not allowed"):
        host.initialize({"output_phasing": 0.0})
    assert [line[:2] for line in host.lines] == [(ERROR, LOGGED[ERROR])]


def test_the_last_successful_time_is_reported(host: Logged) -> None:
    host.initialize()
    assert host.unit.doStep(0.0, 0.25) == (False, False, False, 0.25)
    flags, reached = [c_bool(True) for _ in range(3)], c_double(7.0)
    step = ctypes.CDLL(host.unit.dll._name).fmi3DoStep
    component, pointers = c_void_p(host.unit.component), [byref(x) for x in (*flags, reached)]
    assert step(component, c_double(0.25), c_double(-1.0), True, *pointers) == DISCARD
    assert ([flag.value for flag in flags], reached.value) == ([False] * 3, 0.25)
    assert step(component, c_double(0.25), c_double(0.25), True, None, None, None, None) == OK
    assert host.get(["time"]) == {"time": 0.5}


def test_the_time_is_a_variable_that_cannot_be_set(host: Logged) -> None:
    unit, reference = host.unit, host.kinds["time"][0]
    assert reference == len(host.kinds) - 1
    unit.enterInitializationMode(startTime=3.0)
    assert unit.getFloat64([reference]) == [3.0]
    assert status_of(unit.setFloat64, [reference], [1.0]) == ERROR
    assert host.messages[-1] == "time (continuous independent) cannot be set now"
    unit.exitInitializationMode()
    unit.doStep(3.0, 0.5)
    assert unit.getFloat64([0, reference]) == [0.0, 3.5]
    assert status_of(unit.getFloat64, [reference + 1]) == ERROR


# --- the log ---


@pytest.mark.parametrize(
    ("on", "categories", "logged"),
    [
        (True, [], {WARNING, DISCARD, ERROR}),
        (True, ["logAll"], {WARNING, DISCARD, ERROR}),
        (True, ["logStatusWarning"], {WARNING, ERROR}),
        (True, ["logStatusDiscard"], {DISCARD, ERROR}),
        (False, [], {ERROR}),
        (False, ["logAll"], {ERROR}),
    ],
)
def test_errors_are_logged_always_and_the_rest_if_wanted(
    host: Logged, on: bool, categories: list[str], logged: set[int]
) -> None:
    """Errors also if logging is off, as FMI 3.0.3 (2.2.4) demands; nothing else then."""
    host.initialize()
    host.unit.setDebugLogging(on, categories)
    assert status_of(host.unit.doStep, 0.0, -1.0) == DISCARD
    host.step(0.1, {"output_phasing": 0.0, "stop": True})
    assert status_of(host.unit.getFloat64, [10000]) == ERROR
    assert [line[:2] for line in host.lines] == [(s, LOGGED[s]) for s in (DISCARD, WARNING, ERROR) if s in logged]


def test_an_unknown_category_is_refused(host: Logged) -> None:
    assert status_of(host.unit.setDebugLogging, True, ["logEvents"]) == ERROR
    assert "logStatusWarning, logStatusDiscard, logStatusError, logAll" in host.messages[-1]


def test_logging_off_from_the_beginning_leaves_errors(host: Logged) -> None:
    unit = host.unit
    unit.freeInstance = lambda: None  # the library stays
    unit.fmi3FreeInstance(unit.component)
    unit.instantiate(loggingOn=False, logMessage=lambda e, *message: host._log(e, b"", *message))
    host.initialize()
    assert status_of(unit.doStep, 0.0, -1.0) == DISCARD
    assert status_of(unit.getFloat64, [10000]) == ERROR
    assert [line[0] for line in host.lines] == [ERROR]
    unit.fmi3FreeInstance(unit.component)


# --- values ---


def test_each_type_has_functions_of_its_own(host: Logged) -> None:
    unit, reference = host.unit, {name: r for name, (r, _) in host.kinds.items()}
    unit.enterInitializationMode()
    for get, name, text in (
        (unit.getInt32, "curve", "no Integer has the value reference"),
        (unit.getInt64, "state_code", "no Enumeration has the value reference"),
        (unit.getFloat64, "curve", "no Real has the value reference"),
        (unit.getBoolean, "curve", "no Boolean has the value reference"),
        (unit.getFloat32, "master.position", "no Float32 has the value reference"),
        (unit.getString, "curve", "no String has the value reference"),
        (unit.getUInt64, "curve", "no UInt64 has the value reference"),
    ):
        assert status_of(get, [reference[name]]) == ERROR
        assert host.messages[-1].startswith(text)
    unit.setInt64([reference["curve"]], [1])
    assert unit.getInt64([reference["curve"]]) == [1]
    unit.setInt64([reference["curve"]], [2**40])  # beyond what an Int32 holds
    assert status_of(unit.exitInitializationMode) == ERROR
    assert "curve = 1099511627776 is not allowed: it must be 1 PARABOLA" in host.messages[-1]
    unit.setInt64([reference["curve"]], [2])
    unit.exitInitializationMode()
    assert unit.getInt32([reference["state_code"]]) == [0]


def test_there_must_be_as_many_values_as_references(host: Logged) -> None:
    host.initialize()
    plain, c = ctypes.CDLL(host.unit.dll._name), c_void_p(host.unit.component)
    r, two, none = (c_uint32 * 2)(0, 1), c_size_t(2), c_size_t(0)
    for name, values in (
        ("Float64", (c_double * 3)()),
        ("Int32", (c_int32 * 3)()),
        ("Int64", (c_int64 * 3)()),
        ("Boolean", (c_bool * 3)()),
    ):
        for function in (f"fmi3Get{name}", f"fmi3Set{name}"):
            assert plain[function](c, r, two, values, c_size_t(3)) == ERROR
            assert host.messages[-1] == f"{function}: there must be as many values as value references"
            assert plain[function](c, None, none, None, none) == OK
            assert plain[function](None, r, two, values, two) == ERROR
            assert plain[function](None, r, two, values, c_size_t(3)) == ERROR


def test_output_derivatives_are_those_of_the_slave(host: Logged) -> None:
    host.initialize({"master.velocity": 4.0, "master.acceleration": 2.0})
    host.step(0.5)
    position = host.kinds["slave.position"][0]
    assert host.unit.getOutputDerivatives([position, position], [1, 2]) == [5.0, 2.0]
    assert status_of(host.unit.getOutputDerivatives, [position], [3]) == ERROR


# --- life ---


def test_what_cannot_be_instantiated_is_reported(host: Logged) -> None:
    library, token = ctypes.CDLL(host.unit.dll._name), host.description.guid.encode()

    def attempt(kind: str, name: Any, token: Any, between: tuple[Any, ...] = (), after: tuple[Any, ...] = ()) -> Any:
        instantiate = library[f"fmi3Instantiate{kind}"]
        instantiate.restype = c_void_p
        return instantiate(name, token, None, False, False, *between, None, host.unit.logMessage, *after)

    def co_simulation(name: Any, token: Any, *, events: bool = False) -> Any:
        return attempt("CoSimulation", name, token, (events, False, None, c_size_t(0)), (None,))

    for wrong, text in (
        (lambda: co_simulation(b"", token), "the instance needs a name"),
        (lambda: co_simulation(None, token), "the instance needs a name"),
        (lambda: co_simulation(b"a", b"{other}"), "the GUID is not that of this unit"),
        (lambda: co_simulation(b"a", None), "the GUID is not that of this unit"),
        (lambda: co_simulation(b"a", token, events=True), "the unit has no event mode"),
        (lambda: attempt("ModelExchange", b"a", token), "the unit is for co-simulation only"),
        (lambda: attempt("ScheduledExecution", b"a", token, (), (None,) * 3), "the unit is for co-simulation only"),
    ):
        assert wrong() is None
        assert text in host.messages.pop()
        assert host.lines[-1][:2] == (ERROR, LOGGED[ERROR])
    assert len(host.lines) == 7


def test_calls_in_the_wrong_state_are_refused(host: Logged) -> None:
    unit = host.unit
    for call in (unit.exitInitializationMode, unit.terminate, lambda: unit.doStep(0.0, 0.1)):
        assert status_of(call) == ERROR
        assert "is not allowed now: the unit is instantiated" in host.messages[-1]
    host.initialize()
    for call in (unit.enterInitializationMode, unit.exitInitializationMode):
        assert status_of(call) == ERROR
        assert "is in step mode" in host.messages[-1]
    for call in (unit.enterEventMode, unit.enterStepMode):
        assert status_of(call) == ERROR
        assert "is not offered by this co-simulation unit" in host.messages[-1]
    unit.terminate()
    assert status_of(unit.doStep, 0.0, 0.1) == ERROR
    unit.reset()
    host.initialize()
    host.step(0.1)


def test_a_step_past_the_stop_time_is_an_error_that_changes_nothing(host: Logged) -> None:
    host.unit.enterInitializationMode(startTime=1.0, stopTime=2.0)
    host.unit.exitInitializationMode()
    host.unit.doStep(1.0, 0.75)
    before = host.get()
    for now, h in ((1.75, 0.5), (1.75, 0.253), (2.0, 1e-3), (1.9, 0.2), (30.0, 1.0)):
        assert status_of(host.unit.doStep, now, h) == ERROR
        status, category, message = host.lines[-1]
        assert (status, category) == (ERROR, LOGGED[ERROR])
        assert message.endswith("it would end past the stop time 2")
        assert host.get() == before
    assert status_of(host.unit.doStep, 1.75, 0.0) == DISCARD  # as any other step that is refused
    host.unit.doStep(1.75, 0.25)
    assert status_of(host.unit.doStep, 2.0, 0.25) == ERROR
