"""The batch runner against the python flavour's slave, one instance after the other: same bits, same failures."""

import math
import shutil
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync.remote_sync.block import RemoteSync
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.interface import Curve
from motionsync_fmu.batch import library, simulation
from motionsync_fmu.batch.simulation import BatchResult, Failure, simulate_many
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.python.slave import BlockSlave
from tests.support.blocks.random_runs import draw_runs
from tests.support.fake_blocks.divider import Divider

ALL = [v.name for v in variables(Synchronizer())]
POSITION = ["slave.position"]
BAD = [math.nan, math.inf, -math.inf, 2e12]


class Slave(BlockSlave):
    block_type = Synchronizer
    build = "0"
    starts: ClassVar[dict[str, Any]] = {}


def run_alone(
    start: Mapping[str, Any], inputs: Mapping[str, Any], steps: Any, outputs: list[str], kind: type[Slave] = Slave
) -> tuple[np.ndarray[Any, Any], int | None, str]:
    """Run one instance in the python flavour: outputs, NaN from the failed step on; that step; the last log line."""
    slave = kind(instance_name="reference")
    rows = np.full((len(steps), len(outputs)), math.nan)

    def fill(values: Mapping[str, Any]) -> None:
        for name, value in values.items():
            slave.by_name[name].cell.set(value)

    fill({name: values[0] for name, values in inputs.items()} | dict(start))
    slave.enter_initialization_mode()
    try:
        slave.exit_initialization_mode()
    except ValueError as e:
        return rows, -1, str(e)
    for t, h in enumerate(steps):
        fill({name: values[t] for name, values in inputs.items()})
        if not slave.do_step(0.0, float(h)):
            return rows, t, slave.log_queue[-1].msg
        rows[t] = [float(slave.by_name[name].cell.get()) for name in outputs]
    return rows, None, ""


def draw_inputs(seed: int, instances: int, steps: int) -> tuple[dict[str, Any], dict[str, Any], Any]:
    """Start values, inputs and step sizes of all sorts, a few of them bad."""
    r = np.random.default_rng(seed)
    shape = (instances, steps)
    start = {
        "master.period": r.choice([0.0, 0.0, 360.0, 7.3, 1e-9], instances),
        "master.input_mode": r.choice([1, 2, 3], instances),
        "curve": r.choice([1, 2], instances),
        "active": r.random(instances) > 0.1,
        "rest_value": r.uniform(-400.0, 400.0, instances),
        "output_phasing": r.choice([-1.0, 1.0], instances) * 10.0 ** r.uniform(-1.0, 2.5, instances),
    }
    h = 10.0 ** r.uniform(-4.0, -1.0, shape)
    velocity = np.cumsum(r.normal(0.0, 30.0, shape), axis=1) + r.normal(0.0, 200.0, (instances, 1))
    inputs = {
        "master.position": np.cumsum(velocity * h, axis=1) + r.normal(0.0, 1e-3, shape),
        "master.velocity": velocity,
        "master.acceleration": r.normal(0.0, 100.0, shape),
        "start": r.random(shape) < 0.1,
        "stop": r.random(shape) < 0.1,
        "active": r.random(shape) > 0.02,
        "output_phasing": start["output_phasing"][:, None] * r.choice([1.0, 1.0, 1.0, 0.0, -1.0], shape),
    }
    for name in ("master.position", "master.velocity", "master.acceleration"):
        bad = r.random(shape) < 0.1 / steps
        inputs[name][bad] = r.choice(BAD, bad.sum())
    far = r.random(shape) < 0.1 / steps
    inputs["master.position"][far] = 1e12
    h[r.random(shape) < 0.1 / steps] = r.choice([0.0, -1.0, math.nan, math.inf, 1e7])
    start["output_phasing"][r.random(instances) < 0.03] = 0.0
    start["curve"][r.random(instances) < 0.03] = 5
    start["rest_value"][r.random(instances) < 0.03] = math.nan
    return start, inputs, h


@pytest.mark.parametrize("seed", range(8))
def test_a_batch_has_the_bits_and_the_failures_of_instances_stepped_alone(seed: int) -> None:
    instances, steps = 30, 120
    start, inputs, h = draw_inputs(seed, instances, steps)
    result = simulate_many("Synchronizer", h, inputs, ALL, start=start, threads=2)
    failures = {f.instance: f for f in result.failures}
    assert list(failures) == sorted(failures)
    assert 0 < len(failures) < instances
    assert (result["syn_ramp_on"] == 1.0).any()
    for i in range(instances):
        rows, failed, message = run_alone(
            {n: x[i].item() for n, x in start.items()}, {n: x[i].tolist() for n, x in inputs.items()}, h[i], ALL
        )
        assert failures.get(i) == (None if failed is None else Failure(i, failed, message))
        assert rows.tobytes() == result.values[i].tobytes()


def test_a_batch_of_any_block_has_the_bits_and_the_failures_of_instances_stepped_alone(block: str) -> None:
    """Runs as they are drawn; what a run does not set in a step stays as it was."""
    runs, steps = draw_runs(block, 200, 12), 200
    own = {v.name: v for v in variables(BLOCKS[block]())}
    varied = {name for run in runs for _, values in run.steps for name in values}
    start = {name: np.array([run.start.get(name, own[name].start) for run in runs]) for name in runs[0].start | own}
    start = {name: values for name, values in start.items() if own[name].settable}
    inputs = {name: np.repeat(values[:, None], steps, axis=1) for name, values in start.items() if name in varied}
    for i, run in enumerate(runs):
        for t, (_, values) in enumerate(run.steps):
            for name, value in values.items():
                inputs[name][i, t:] = value
    h = np.array([[h for h, _ in run.steps] for run in runs])
    names = list(own)
    result = simulate_many(block, h, inputs, names, start=start, threads=2)
    failures = {f.instance: f for f in result.failures}
    kind = type("AnySlave", (Slave,), {"block_type": BLOCKS[block]})
    for i in range(len(runs)):
        rows, failed, message = run_alone(
            {n: x[i].item() for n, x in start.items()}, {n: x[i].tolist() for n, x in inputs.items()}, h[i], names, kind
        )
        assert failures.get(i) == (None if failed is None else Failure(i, failed, message))
        assert rows.tobytes() == result.values[i].tobytes()


def test_every_kind_of_failure_is_reported_where_it_happens_and_nowhere_else() -> None:
    valid = simulate_many("Synchronizer", 0.01, {"master.velocity": 100.0}, ALL, steps=5).values[0]
    velocity = np.full((7, 5), 100.0)
    velocity[1, 3] = math.nan
    velocity[2, 0] = -3e12
    position = np.zeros((7, 5))
    position[3, 4] = 1e12
    period = np.array([0.0, 0.0, 0.0, 1e-9, -1.0, 0.0, 0.0])
    h = np.full((7, 5), 0.01)
    h[5, 2] = 0.0
    inputs = {"master.velocity": velocity, "master.position": position}
    result = simulate_many("Synchronizer", h, inputs, ALL, start={"master.period": period})
    turns = "the master's position and its prediction must be at most 1e15 periods"
    values = "master.position = 1e+12, master.velocity = 100, master.acceleration = 0, master.period = 1e-09"
    assert result.failures == (
        Failure(1, 3, "master.velocity = nan is not allowed: it must be -1e+12 to 1e+12"),
        Failure(2, -1, "master.velocity = -3e+12 is not allowed: it must be -1e+12 to 1e+12"),
        Failure(3, 4, f"{turns} ({values})"),
        Failure(4, -1, "master.period = -1 is not allowed: it must be 0, or >= 1e-09"),
        Failure(5, 2, "step size = 0 is not allowed: it must be > 0 and <= 1e+06"),
    )
    for i, failed in enumerate([5, 3, 0, 4, 0, 2, 5]):
        assert np.isnan(result.values[i, failed:]).all()
        if i != 3:  # that one has a period
            assert result.values[i, :failed].tobytes() == valid[:failed].tobytes()


def test_a_refusal_at_initialization_is_a_failure_before_the_first_step() -> None:
    result = simulate_many(
        "Synchronizer", 0.01, {"master.position": [[1e12], [0.0]]}, POSITION, start={"master.period": 1e-9}
    )
    assert [(f.instance, f.step) for f in result.failures] == [(0, -1)]
    assert result.failures[0].message.startswith(
        "the master's position and its prediction must be at most 1e15 periods ("
    )


def test_an_arithmetic_error_and_a_refusal_of_any_block() -> None:
    inputs: dict[str, Any] = {
        "divisor": [[2.0, 4.0, 5.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]],
        "mode": [[1, 1, 1], [1, 1, 1], [1, 1, -2]],
    }
    inputs |= {"gain": [3.0, -1.0, 6.0], "flag": [False, True, False], "count": np.array([1, 2, -3], np.int8)}
    result = simulate_many(Divider, 1.0, inputs, ["quotient", "counted", "flag", "mode"])
    assert result["quotient"].tolist()[0] == [1.5, -0.25, 1.2]
    assert result["counted"].tolist()[0] == [1.0, -2.0, -3.0]
    assert result["flag"].tolist()[0] == [0.0, 1.0, 0.0]
    assert result["quotient"][2, :2].tolist() == [3.0, -1.0]
    assert result.failures == (
        Failure(1, 1, "an arithmetic error: these values lead to no result"),
        Failure(2, 2, "asked to refuse (mode = -2, flag = False, count = -3)"),
    )


def test_an_integer_beyond_its_limits_is_a_failure_before_the_first_step() -> None:
    start = {"periods_for_mean_drift": [1, 0, 64, 65, 2, 1], "end_of_transition_limit": [1, 1, 90, 1, 0, 2**31 - 1]}
    result = simulate_many("RemoteSync", 0.01, {}, POSITION, start=start)
    assert result.failures == (
        Failure(1, -1, "periods_for_mean_drift = 0 is not allowed: it must be 1 to 64"),
        Failure(3, -1, "periods_for_mean_drift = 65 is not allowed: it must be 1 to 64"),
        Failure(4, -1, "end_of_transition_limit = 0 is not allowed: it must be 1 to 2147483647"),
    )


@given(st.sampled_from([v for kind in (Synchronizer, RemoteSync, Divider) for v in variables(kind())]), st.data())
def test_many_values_are_checked_as_one_is(v: Any, data: st.DataObject) -> None:
    d = v.declaration
    edges = [
        x
        for e in (d.min, d.max, d.above, d.below, d.smallest, 0.0)
        for x in (e, -e, math.nextafter(e, 1), math.nextafter(e, -1))
    ]
    kinds = {"Real": st.sampled_from([*edges, math.nan]) | st.floats(), "Boolean": st.booleans()}
    whole = st.integers(-5, 9) | st.sampled_from([64, 65, 2**31 - 1, -(2**31)])
    values = data.draw(st.lists(kinds.get(v.kind, whole), min_size=1))
    assert simulation.are_allowed(v, np.array(values)).tolist() == [v.allows(x) for x in values]


def ramp() -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    position = np.arange(300) * 1.8
    return position, position > 60.0


def reference() -> BatchResult:
    position, stop = ramp()
    inputs = {"master.position": np.tile(position, (3, 1)), "stop": np.tile(stop, (3, 1))}
    inputs["master.velocity"] = np.full((3, 300), 180.0)
    result = simulate_many("Synchronizer", np.full((3, 300), 0.01), inputs, ALL, start={"master.period": [360.0] * 3})
    assert not result.failures
    assert (result["state"] == 1.0).any()
    return result


@pytest.mark.parametrize(
    ("position", "stop", "velocity", "h"),
    [
        (lambda p: p, lambda s: s, 180.0, 0.01),
        (lambda p: p[None, :], lambda s: s.astype(float), [[180.0]] * 3, [0.01] * 300),
        (lambda p: p.tolist(), lambda s: s.tolist(), [180] * 300, [[0.01]] * 3),
        (lambda p: np.repeat(p, 2)[::2], lambda s: s.astype(np.uint8), np.float32(180.0), np.full((1, 300), 0.01)),
        (lambda p: p[::-1].copy()[::-1], lambda s: s.astype(">i4"), np.array([180], np.int16), np.float64(0.01)),
        (lambda p: np.asfortranarray(np.tile(p, (3, 1))), lambda s: np.tile(s, (3, 1)).astype("f4"), 180.0, 0.01),
        (lambda p: p.astype(">f8"), lambda s: np.frombuffer(b"\0" + s.tobytes(), bool)[1:], 180.0, 0.01),
    ],
)
def test_shapes_and_types_of_numbers_do_not_matter(position: Any, stop: Any, velocity: Any, h: Any) -> None:
    p, s = ramp()
    inputs = {"master.position": position(p), "stop": stop(s), "master.velocity": velocity}
    start: dict[str, Any] = {"master.period": np.float32(360.0), "curve": Curve.POLYNOMIAL_3_4_5}
    result = simulate_many("Synchronizer", h, inputs, ALL, start=start, instances=3)
    assert result.values.tobytes() == reference().values.tobytes()


def test_variables_may_come_in_one_array() -> None:
    p, s = ramp()
    together = np.stack([p, np.full(300, 180.0), s], axis=-1)
    names = ("master.position", "master.velocity", "stop")
    for array in (together, np.tile(together, (3, 1, 1))):
        result = simulate_many("Synchronizer", 0.01, {names: array}, ALL, start={"master.period": [360.0] * 3})
        assert result.values.tobytes() == reference().values.tobytes()


def test_results_may_go_to_an_array_with_any_strides() -> None:
    p, s = ramp()
    inputs: dict[str, Any] = {"master.position": p, "stop": s, "master.velocity": 180.0}
    out = np.zeros((300, 4, len(ALL)))[:, ::2].transpose(1, 0, 2)
    result = simulate_many("Synchronizer", 0.01, inputs, ALL, start={"master.period": [360.0] * 2}, out=out)
    assert result.values is out
    assert np.array_equal(out, reference().values[:2])


def test_an_input_is_there_at_initialization_unless_it_has_a_start_value() -> None:
    inputs: dict[str, Any] = {"active": False, "stop": True, "rest_value": 5.0}
    assert simulate_many("Synchronizer", 0.01, inputs, POSITION, steps=2).values.ravel().tolist() == [0.0, 0.0]
    result = simulate_many("Synchronizer", 0.01, inputs, POSITION, start={"stop": [False, True]}, steps=2)
    assert result.values[:, :, 0].tolist() == [[5.0, 5.0], [0.0, 0.0]]


def test_nothing_to_do_is_done() -> None:
    assert simulate_many("Synchronizer", 0.01, {}, ALL, instances=0, steps=4).values.shape == (0, 4, len(ALL))
    assert simulate_many("Synchronizer", np.zeros(0), {"stop": []}, ALL).values.shape == (1, 0, len(ALL))
    assert simulate_many("Synchronizer", 0.01, {"stop": True}, []).values.shape == (1, 1, 0)
    assert simulate_many("Synchronizer", 0.01, {}, [], steps=0, start={"master.period": -1.0}).failures[0].step == -1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"block": "Sinchronizer"}, "no block is named 'Sinchronizer'; there is Synchronizer"),
        ({"inputs": {"stopp": True}}, "no variable of Synchronizer is named 'stopp'; there is stop"),
        ({"outputs": ["slave.speed"]}, "no variable of Synchronizer is named 'slave.speed'"),
        (
            {"inputs": {"curve": 1}},
            "inputs: curve (fixed parameter) cannot be set: inputs and tunable parameters can",
        ),
        (
            {"start": {"slave.position": 1.0}},
            "start: slave.position (continuous output) cannot be set: parameters and inputs can",
        ),
        (
            {"inputs": {"master.position": np.zeros((2, 3)), "stop": np.zeros((2, 4), bool)}},
            "stop has the shape (2, 4), but master.position has the shape (2, 3): steps must agree, or be 1",
        ),
        (
            {"inputs": {"master.position": np.zeros((2, 3))}, "start": {"rest_value": np.zeros(3)}},
            "rest_value has the shape (3,), but master.position has the shape (2, 3): instances must agree, or be 1",
        ),
        (
            {"step_size": [0.1, 0.2], "steps": 3},
            "step_size has the shape (2,), but steps = 3: steps must agree, or be 1",
        ),
        (
            {"inputs": {"stop": np.zeros((1, 1, 1))}},
            "stop has the shape (1, 1, 1): it must be (), (steps,), (instances, 1) or (instances, steps)",
        ),
        ({"start": {"curve": [[1]]}}, "curve has the shape (1, 1): it must be () or (instances,)"),
        (
            {"inputs": {("start", "stop"): np.zeros((2, 3))}},
            "start, stop have the shape (2, 3): the last axis must be of length 2, one for each name",
        ),
        (
            {"inputs": {"stop": True, ("start", "stop"): [True, False]}},
            "inputs: stop is given 2 times: it must be given once",
        ),
        (
            {"inputs": {"stop": [[0.0, 1.0], [1.0, 0.5]]}},
            "inputs: stop = 0.5 at [1, 1] is no Boolean: it must be true or false, 1 or 0",
        ),
        (
            {"inputs": {"start": [0.0, math.nan]}},
            "inputs: start = nan at [0, 1] is no Boolean: it must be true or false, 1 or 0",
        ),
        (
            {"start": {"curve": [1.0, 1.5]}},
            "start: curve = 1.5 at [1, 0] is no Enumeration: it must be a whole number of 32 bits",
        ),
        (
            {"start": {"curve": 2**31}},
            "start: curve = 2147483648 at [0, 0] is no Enumeration: it must be a whole number of 32 bits",
        ),
        (
            {"start": {"curve": ["PARABOLA", "PARABEL"]}},
            "no member of curve is named 'PARABEL'; there is PARABOLA, POLYNOMIAL_3_4_5",
        ),
        ({"start": {"rest_value": "PARABOLA"}}, "rest_value is of the type <U8: it must be real numbers or Booleans"),
        ({"start": {"rest_value": 1j}}, "rest_value is of the type complex128: it must be real numbers or Booleans"),
        ({"inputs": {"stop": [[True], [True, False]]}}, "stop is no array: "),
        ({"step_size": None}, "step_size is of the type object: it must be real numbers or Booleans"),
        ({"steps": -1}, "steps = -1 is not allowed: it must be >= 0"),
        ({"instances": -2}, "instances = -2 is not allowed: it must be >= 0"),
        ({"threads": 0}, "threads = 0 is not allowed: it must be >= 1"),
        ({"out": np.zeros((1, 2, 1))}, "out is float64 of shape (1, 2, 1): it must be float64 of shape (1, 1, 1)"),
        (
            {"out": np.zeros((1, 1, 1), "f4")},
            "out is float32 of shape (1, 1, 1): it must be float64 of shape (1, 1, 1)",
        ),
    ],
)
def test_what_is_wrong_for_all_is_reported_before_anything_runs(arguments: dict[str, Any], message: str) -> None:
    whole: dict[str, Any] = {"block": "Synchronizer", "step_size": 0.01, "inputs": {}, "outputs": POSITION}
    with pytest.raises(UserError) as error:
        simulate_many(**whole | arguments)
    assert str(error.value).startswith(message)


def test_an_output_that_was_not_requested_is_named() -> None:
    with pytest.raises(UserError, match=r"no output of this batch is named 'state'; there is slave\.position"):
        simulate_many("Synchronizer", 0.01, {}, POSITION)["state"]


def test_a_million_steps_with_progress() -> None:
    shares: list[float] = []
    position = np.arange(1000) * 0.18
    phasing = np.linspace(10.0, 90.0, 1000)
    result = simulate_many(
        "Synchronizer",
        1e-3,
        {"master.position": position, "master.velocity": 180.0, "stop": position > 1.0},
        ["slave.position", "state"],
        start={"rest_value": 120.0, "output_phasing": phasing},
        progress=shares.append,
    )
    assert result.values.shape == (1000, 1000, 2)
    assert not result.failures
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) >= 4
    law_ends = 120.0 + 7.0 / 8.0 * phasing < 180.0
    assert (result["state"][:, -1] == np.where(law_ends, 0.0, 1.0)).all()
    assert (result["slave.position"][law_ends, -1] == 120.0).all()


def test_what_the_progress_raises_ends_the_batch() -> None:
    def stop(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_many("Synchronizer", 1e-3, {}, POSITION, instances=100, steps=100_000, progress=stop)


def test_several_python_threads_may_call_it_at_the_same_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "_libraries", {})  # so that all of them want it loaded
    start, inputs, h = draw_inputs(1, 50, 200)

    def one(_: int) -> BatchResult:
        return simulate_many("Synchronizer", h, inputs, ALL, start=start, threads=3)

    with ThreadPoolExecutor(8) as pool:
        result = list(pool.map(one, range(24)))
    assert all(f.failures == result[0].failures for f in result)
    assert all(f.values.tobytes() == result[0].values.tobytes() for f in result)


def test_the_compiler_of_the_machine_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    if not any(map(shutil.which, library.COMPILERS)):
        pytest.skip("this machine has no C compiler of its own")
    start, inputs, h = draw_inputs(9, 30, 120)
    by_zig = simulate_many("Synchronizer", h, inputs, ALL, start=start)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(library, "_libraries", {})
    monkeypatch.setattr(library, "find_spec", lambda name: None)
    result = simulate_many("Synchronizer", h, inputs, ALL, start=start)
    assert result.failures == by_zig.failures
    assert result.values.tobytes() == by_zig.values.tobytes()


@pytest.mark.parametrize("compiler", ["gcc", "zig"])
def test_compilers_give_no_warnings_for_the_loop(compiler: str, tmp_path: Path) -> None:
    files = library.batch_sources()
    for name, text in files.items():
        (tmp_path / name).write_bytes(text)
    command = ["gcc"] if compiler == "gcc" else [sys.executable, "-m", "ziglang", "cc"]
    if not shutil.which(command[0]):
        pytest.skip(f"{compiler} is not installed")
    command += [
        "-std=c99",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Wconversion",
        "-Wshadow",
        "-Werror",
        "-c",
        "-o",
        "loop.o",
    ]
    command += ["-Wno-unused-command-line-argument"] if compiler == "zig" else []
    sources = [name for name in files if name.endswith(".c")]
    assert {"loop.c", "reduce.c"} <= {*sources}
    for source in sources:
        done = subprocess.run([*command, source], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


# --- names, and variables with another causality ---


def test_members_are_given_by_name_and_a_single_output_too() -> None:
    position = np.linspace(0.0, 360.0, 73)[:-1]
    inputs = {"master.position": position, "master.velocity": 500.0, "stop": position >= 10.0}
    start = {"rest_value": 180.0, "stop": False}
    by_name = simulate_many(
        "Synchronizer", 0.01, inputs, "slave.position", start=start | {"curve": ["PARABOLA", "POLYNOMIAL_3_4_5"]}
    )
    by_value = simulate_many("Synchronizer", 0.01, inputs, POSITION, start=start | {"curve": [1, 2]})
    assert by_name.names == ("slave.position",)
    assert by_name.values.tobytes() == by_value.values.tobytes()
    assert (by_name["slave.position"][0] != by_name["slave.position"][1]).any()
    assert simulate_many("Synchronizer", 0.01, inputs, "state", start={"curve": "PARABOLA"}).failures == ()


def test_names_of_members_vary_from_step_to_step_as_their_numbers_do() -> None:
    """A Gearing is started with a mode that is given by name: through both positions, or at the reference position."""
    names = np.array([["CW_DIRECT"] * 20, ["WITH_CW_REFERENCE_POSITION"] * 20])
    inputs = {"master.position": np.arange(20) * 1.0, "master.velocity": 100.0, "start": np.arange(20) > 1}
    inputs |= {"gear_in.reference_position": 10.0, "gear_in.distance": 2.0}
    outputs = ["state", "slave.position"]
    by_name = simulate_many("Gearing", 0.01, inputs | {"gear_in.start_mode": names}, outputs)
    by_value = simulate_many("Gearing", 0.01, inputs | {"gear_in.start_mode": [[1] * 20, [4] * 20]}, outputs)
    assert by_name.values.tobytes() == by_value.values.tobytes()
    assert by_name["state"][:, 5].tolist() == [3.0, 1.0]


def test_a_real_parameter_that_is_an_input_is_checked_at_each_step_with_its_own_range() -> None:
    """k_slave_master may be 1e-12 to 1e12: 0, a tiny number, a negative one, NaN and 2e12 are refused at their steps.
    As a tunable parameter none of them is: the block itself checks it where it reads it."""
    bad = [0.0, 1e-13, -1.0, math.nan, 2e12]
    ratio = np.ones((len(bad) + 1, 4))
    ratio[range(len(bad)), 2] = bad
    result, tunable = (
        simulate_many("Follower", 0.01, {"k_slave_master": ratio}, "state", interface=interface)
        for interface in (Interface(input="k_slave_master"), None)
    )
    allowed = "is not allowed: it must be 1e-12 to 1e+12"
    refused = ["0", "1e-13", "-1", "nan", "2e+12"]
    unwired = "; an unwired input gives 0"
    assert result.failures == tuple(
        Failure(i, 2, f"k_slave_master = {x} {allowed}{unwired if x == '0' else ''}") for i, x in enumerate(refused)
    )
    assert np.isnan(result["state"][:-1, 2:]).all()
    assert not np.isnan(result["state"][:, :2]).any()
    assert tunable.failures == ()


def test_variables_with_another_causality_are_set_as_in_the_fmu() -> None:
    with pytest.raises(UserError, match="parameter: start cannot become a parameter"):
        simulate_many("Gearing", 0.01, {}, "state", interface=Interface(parameter="start"))
    fixed = Interface(parameter="gear_in.offset")
    result = simulate_many("Gearing", 0.01, {"gear_in.offset": [0.0, math.nan]}, "state", interface=fixed)
    assert result.failures == (Failure(0, 1, "gear_in.offset = nan is not allowed: it must be -1e+12 to 1e+12"),)
