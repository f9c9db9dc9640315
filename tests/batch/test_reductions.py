"""Measures of batches: the bits that reducing the values of all steps gives, without the memory for these values."""

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from motionsync.blocks import BLOCKS
from motionsync_fmu.batch import result_arrays
from motionsync_fmu.batch.reductions import Reductions
from motionsync_fmu.batch.simulation import BatchResult, simulate_many
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import variables
from tests.support.blocks.drawn import drawn
from tests.support.blocks.random_runs import draw_runs
from tests.support.fake_blocks.divider import Divider

Values = NDArray[np.float64]
KINDS = ["initial", "last", "min", "max", "min_time", "max_time", "first", "first_time", "mean", "rms", "rises"]
KINDS += ["above:0", "above:-3.5", "above:1e3", "every:1", "every:3", "every:300"]


def reduce_values(kind: str, x: Values, h: Values, initial: float) -> Any:
    """A measure of one instance by NumPy: of its values at the end of each step, and the value before the first one."""
    of, _, number = kind.partition(":")
    times, high, hits = np.cumsum(h), np.append(initial, x) > 0.5, np.flatnonzero(x)
    counted: dict[str, Any] = {
        "initial": initial,
        "every": x[int(number) - 1 :: int(number)] if of == "every" else None,
        "above": np.cumsum(np.append(0.0, np.where(x > float(number), h, 0.0)))[-1] if of == "above" else None,
        "first": x[hits[0]] if len(hits) else 0.0,
        "first_time": times[hits[0]] if len(hits) else math.nan,
        "rises": float(np.count_nonzero(high[1:] & ~high[:-1])),
    }
    if of in counted or not len(x):
        return counted.get(of, math.nan)
    sums = np.cumsum(x * x * h if of == "rms" else x * h)
    if of in ("mean", "rms"):
        return sums[-1] / times[-1] if of == "mean" else np.sqrt(sums[-1] / times[-1])
    at = {"last": -1, "min": np.argmin(x), "max": np.argmax(x)}[of.removesuffix("_time")]
    return (times if of.endswith("_time") else x)[at]


def bits(values: Any) -> bytes:
    """The bits of some numbers; all that is not a number has the same."""
    array = np.asarray(values, np.float64)
    return np.where(np.isnan(array), math.nan, array).tobytes()


def check(result: BatchResult, step_sizes: Values, initial: dict[str, list[float]]) -> None:
    """All measures are those of all values; those of an instance that failed are NaN.

    `initial`: the values of each variable after the initialization, for each instance."""
    h = np.broadcast_to(step_sizes, result.values.shape[:2])
    failed = {f.instance for f in result.failures}
    for name in result.names:
        for kind in KINDS:
            measure = result.measures[f"{name}.{kind}"]
            for i in range(len(result.values)):
                with np.errstate(all="ignore"):
                    expected = reduce_values(kind, result[name][i], h[i], initial[name][i])
                if i in failed and not kind.startswith("every"):
                    expected = math.nan
                assert bits(measure[i]) == bits(expected), (name, kind, i)


# --- the bits ---


@drawn(40, anew=True)
@given(st.data())
def test_measures_have_the_bits_of_all_values_reduced(data: st.DataObject) -> None:
    """Of each type; with equal extremes, zeros of both signs, numbers beyond all sums, what is no number, failures."""
    steps = data.draw(st.sampled_from([0, 1, 2, 3, 7, 255, 256, 257, 512, 600]))
    instances = data.draw(st.integers(1, 4))
    r = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    shape = (instances, steps)
    special = [
        [1.0, 2.0, 3.0],
        [0.0, -0.0],
        [-0.0],
        [0.5, 0.6, -3.5],
        [math.nan, 1.0, -1.0],
        [math.inf, -math.inf, 2.0],
    ]
    pool = data.draw(st.sampled_from([*special, [1e308, -1e308, 1e200], list(r.normal(0.0, 100.0, 50))]))
    h = data.draw(
        st.sampled_from([np.full(1, 0.01), 10.0 ** r.uniform(-6.0, 6.0, steps), 10.0 ** r.uniform(-3, 0, shape)])
    )
    gain = r.choice(pool, shape)
    divisor = r.choice([1.0, 3.0, -7.0], shape)
    divisor[r.random(shape) < data.draw(st.sampled_from([0.0, 0.2 / max(steps, 1), 0.5]))] = 0.0
    inputs = {"gain": gain, "divisor": divisor, "flag": r.random(shape) < 0.5, "count": r.integers(-3, 3, shape)}
    start = {"gain": np.ones(instances), "flag": r.random(instances) < 0.5, "count": r.integers(-2, 3, instances)}
    names = [v.name for v in variables(Divider())]
    result = simulate_many(
        Divider, h, inputs, names, start=start, reduce=dict.fromkeys(names, KINDS), steps=steps, instances=instances
    )
    initial = {v.name: [float(v.start)] * instances for v in variables(Divider())}
    initial |= {name: values.astype(float).tolist() for name, values in start.items()}
    if steps:
        initial["divisor"] = divisor[:, 0].tolist()
    check(result, h, initial)


def test_measures_of_any_block_have_the_bits_of_all_values_reduced(block: str) -> None:
    """Runs as they are drawn, some of which fail; every variable is reduced in every way."""
    runs, steps = draw_runs(block, 270, 3), 270
    own = {v.name: v for v in variables(BLOCKS[block]())}
    start = {name: np.array([run.start.get(name, v.start) for run in runs]) for name, v in own.items() if v.settable}
    inputs = {name: np.repeat(values[:, None], steps, axis=1) for name, values in start.items() if own[name].checked}
    for i, run in enumerate(runs):
        for t, (_, values) in enumerate(run.steps):
            for name in inputs.keys() & values.keys():
                inputs[name][i, t:] = values[name]
    h = np.array([[h for h, _ in run.steps] for run in runs])
    result = simulate_many(block, h, inputs, list(own), start=start, reduce=dict.fromkeys(own, KINDS), threads=2)
    initial: dict[str, list[float]] = {name: [] for name in own}
    for i in range(len(runs)):
        stepper = Stepper(Recipe(block).block())
        if (i, -1) not in [(f.instance, f.step) for f in result.failures]:
            stepper.initialize({name: values[i].item() for name, values in start.items()})
        for name in own:
            initial[name].append(float(stepper[name]))
    check(result, h, initial)


def test_of_equal_extremes_the_first_counts_and_a_zero_keeps_its_sign() -> None:
    gain = np.array([[2.0, 5.0, 2.0, 5.0], [0.0, -0.0, 0.0, -0.0], [-0.0, 0.0, -0.0, 0.0]])
    kinds = ("min", "max", "min_time", "max_time", "mean", "first", "first_time")
    start = {"gain": 1.0}
    m = simulate_many(Divider, 0.5, {"gain": gain}, reduce={"quotient": kinds}, start=start).measures
    assert bits(m["quotient.min"]) == bits([2.0, 0.0, -0.0])
    assert bits(m["quotient.max"]) == bits([5.0, 0.0, -0.0])
    assert m["quotient.min_time"].tolist() == [0.5, 0.5, 0.5]
    assert m["quotient.max_time"].tolist() == [1.0, 0.5, 0.5]
    assert m["quotient.mean"].tolist() == [3.5, 0.0, 0.0]
    assert m["quotient.first"].tolist() == [2.0, 0.0, 0.0]
    assert bits(m["quotient.first_time"]) == bits([0.5, math.nan, math.nan])


def test_without_a_step_there_are_the_initial_values_and_nothing_is_counted() -> None:
    m = simulate_many(Divider, 0.5, {}, reduce={"flag": KINDS}, steps=0, start={"flag": True}).measures
    of = {name.removeprefix("flag."): values[0].tolist() for name, values in m.items()}
    assert {kind for kind, x in of.items() if x == []} == {"every:1", "every:3", "every:300"}
    counted = {kind: x for kind, x in of.items() if x != [] and not math.isnan(x)}
    assert counted == {"initial": 1.0, "rises": 0.0, "first": 0.0, "above:0": 0.0, "above:-3.5": 0.0, "above:1e3": 0.0}


# --- failures, threads ---


def test_an_instance_that_fails_has_no_measures_but_each_nth_value_until_then() -> None:
    divisor = np.ones((3, 7))
    divisor[0, 5] = 0.0
    start = {"gain": [1.0, 2.0, -1.0]}  # a gain must be above 0
    result = simulate_many(Divider, 1.0, {"divisor": divisor}, reduce={"quotient": ("max", "every:2")}, start=start)
    assert [(f.instance, f.step) for f in result.failures] == [(0, 5), (2, -1)]
    assert bits(result.measures["quotient.max"]) == bits([math.nan, 2.0, math.nan])
    assert bits(result.measures["quotient.every:2"]) == bits([[1.0, 1.0, math.nan], [2.0] * 3, [math.nan] * 3])


def test_measures_do_not_depend_on_threads_and_tasks() -> None:
    phasing = np.linspace(10.0, 90.0, 20_000)
    position = np.arange(40) * 7.2
    inputs = {"master.position": position, "master.velocity": 720.0, "stop": position > 20.0}
    start: dict[str, Any] = {"rest_value": 120.0, "output_phasing": phasing, "stop": False}
    reduce = {"slave.position": ("max", "rms", "every:10"), "state": ("last", "rises")}
    shares: list[float] = []
    many = simulate_many("Synchronizer", 0.01, inputs, reduce=reduce, start=start, threads=3, progress=shares.append)
    single = simulate_many("Synchronizer", 0.01, inputs, ["slave.position"], reduce=reduce, start=start, threads=1)
    assert shares[-1] == 1.0
    assert len(shares) >= 3
    assert many.values.shape == (20_000, 40, 0)
    assert {name: x.tobytes() for name, x in many.measures.items()} == {
        n: x.tobytes() for n, x in single.measures.items()
    }
    assert many.measures["slave.position.every:10"].tobytes() == single["slave.position"][:, 9::10].tobytes()
    assert len(np.unique(many.measures["slave.position.rms"])) > 1000


# --- memory ---


PEAKS = """
import tracemalloc
from motionsync_fmu.batch.simulation import simulate_many
for steps in (1000, 100_000, 200_000):
    tracemalloc.start()
    simulate_many("Synchronizer", 1e-3, {}, reduce={"slave.position": KINDS}, steps=steps, instances=20, threads=1)
    print(tracemalloc.get_traced_memory()[1])
    tracemalloc.stop()
"""


def test_memory_does_not_grow_with_the_steps() -> None:
    """In one thread, since each has a task of its own, and in a process of its own, where no other test has threads."""
    script = PEAKS.replace("KINDS", repr(KINDS[:-3]))
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    _, short, long = map(int, done.stdout.split())
    assert long < 300_000  # bytes; the values of all steps would take 32 million
    assert abs(long - short) < 10_000


def test_values_of_all_steps_may_go_to_a_file(tmp_path: Path) -> None:
    names, shape = ["slave.position", "state"], (50, 300, 2)
    position = np.random.default_rng(5).normal(0.0, 100.0, shape[:2])
    arguments: dict[str, Any] = {"inputs": {"master.position": position}}
    file = np.memmap(tmp_path / "values", np.float64, "w+", shape=shape)
    result = simulate_many("Synchronizer", 0.01, outputs=names, out=file, threads=2, **arguments)
    assert result.values is file
    file.flush()
    expected = simulate_many("Synchronizer", 0.01, outputs=names, **arguments).values
    assert (tmp_path / "values").read_bytes() == expected.tobytes()
    assert len(np.unique(expected)) > 1000


def test_an_array_that_does_not_fit_into_memory_is_refused_with_its_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(result_arrays, "memory_of_machine", lambda: 64 * 2.0**30)
    large: dict[str, Any] = {"step_size": 1e-3, "inputs": {}, "instances": 100_000, "steps": 100_000}
    with pytest.raises(UserError) as error:
        simulate_many("Synchronizer", outputs="slave.position", **large)
    instead = "does not fit into memory: request measures (reduce=...), or give a file (out=np.memmap(...))"
    assert str(error.value) == (
        f"the array of all values of shape (100000, 100000, 1) would take 74.5 GiB, which {instead}"
    )
    with pytest.raises(
        UserError, match=r"^state\.every:1 of shape \(100000, 100000\) would take 74\.5 GiB, which does"
    ):
        simulate_many("Synchronizer", reduce={"state": "every:1"}, **large)


@pytest.mark.parametrize("shape", [(10**8, 10**8), (10**12, 10**12)])
def test_what_the_system_refuses_is_reported_in_the_same_way(
    shape: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(result_arrays, "memory_of_machine", lambda: math.inf)
    with pytest.raises(UserError, match=r"would take [\d.]+ (PiB|EiB), which does not fit into memory: wait"):
        result_arrays.new_array("it", shape, "wait")


# --- mistakes ---

REFUSED = "state: the measure "
FINITE = " is not allowed: after the colon it must have a finite number, as in above:500"
WHOLE = " is not allowed: after the colon it must have a whole number of 1 to 1e15, as in every:10"


@pytest.mark.parametrize(
    ("reduce", "message"),
    [
        ({"slave.speed": "max"}, "no variable of Synchronizer is named 'slave.speed'; there is "),
        (
            {"state": "maximum"},
            f"state: no measure is named 'maximum'; there is {', '.join(KINDS[:11])}, above:LIMIT, every:N",
        ),
        ({"state": ("max", "max:3")}, "state: no measure is named 'max:3'; there is "),
        *(({"state": f"above{n}"}, f"{REFUSED}'above{n}'{FINITE}") for n in ("", ":", ":nan", ":inf", ":much")),
        *(
            ({"state": f"every{n}"}, f"{REFUSED}'every{n}'{WHOLE}")
            for n in ("", ":", ":0", ":-1", ":1.5", ":nan", ":all", ":1e16")
        ),
        ({"state": ("max", "last", "max")}, "state: the measure max is given 2 times: it must be given once"),
    ],
)
def test_a_measure_that_is_not_allowed_is_reported_before_anything_runs(reduce: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError) as error:
        simulate_many("Synchronizer", 0.01, {}, reduce=reduce)
    assert str(error.value).startswith(message)


@pytest.mark.all_blocks
def test_each_nth_value_needs_runs_of_equal_steps() -> None:
    with pytest.raises(
        UserError, match=r"^state: the measure 'every:3' is not allowed: the runs differ in their steps$"
    ):
        Reductions(BLOCKS["Synchronizer"], {"state": "every:3"}, 5)
