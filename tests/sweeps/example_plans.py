"""Part files with made-up rows, as a sweep writes them: how short a piece can be over velocity and acceleration."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from motionsync_fmu.sweeps.sweep_plan import SweepPlan

EXAMPLE = Path(__file__).parents[2] / "model/motionsync/cut_to_length/example.toml"
MEASURED = Path(__file__).parents[2] / "scenarios/CutToLength/measured_line/scenario.toml"
MARK = "cuts within 0.1 mm of a mark, one mark each 500 mm"
FACTORS = ("master.velocity", "axis.max_acceleration", "length", "tool.cut_time")
REFUSED = "axis.max_acceleration must be less than 9000, but is 10000"


def settings(velocities: int, accelerations: int, lengths: int, times: int) -> list[str]:
    return [
        f"master.velocity=100:1500:{velocities}",
        f"axis.max_acceleration=2000:10000:{accelerations}",
        f"length=100:3000:{lengths}",
        f"tool.cut_time=0.1:0.4:{times}",
    ]


def rows(plan: SweepPlan) -> dict[str, NDArray[Any]]:
    """A row for each run. A piece can be cut from v (t + 2.2 v/a) + 50 on; of the quickest machines with the slowest
    line the runs are refused."""
    values = plan.values(0, plan.runs)
    v, a, length, t = (values[name] for name in FACTORS)
    need = v * (t + 2.2 * v / a) + 50.0
    refused = (a > 9000.0) & (v < 200.0)
    passed = (length >= need) & ~refused
    run = np.arange(plan.runs)
    error = np.where(passed, 1e-10 * (1.0 + run % 7), need - length)
    acceleration = np.minimum(a, 1.8 * a * v / length)
    return {"run": run} | values | {
        "passed": passed,
        "refusal": np.where(refused, REFUSED, ""),
        "refused_at": np.where(refused, 0.0, np.nan),
        "broken": np.where(passed | refused, 0, 1),
        "first_broken": np.where(passed | refused, "", MARK),
        "cuts": np.where(refused, 0, 5),
        "cut_error": np.where(refused, np.nan, np.abs(error)),
        "slave.velocity.max": np.where(refused, np.nan, 1.3 * v + 0.01 * a * t),
        "slave.acceleration.max": np.where(refused, np.nan, acceleration),
        "limits.min_length.last": need,
    }  # fmt: skip


def write(folder: Path, columns: dict[str, NDArray[Any]], part: int) -> None:
    """Write the rows in parts of so many."""
    folder.mkdir(parents=True, exist_ok=True)
    table = pa.table(columns)
    for i, first in enumerate(range(0, table.num_rows, part)):
        pq.write_table(table.slice(first, part), folder / f"part-{i:06}.parquet")


def sweep(folder: Path, *counts: int, part: int = 500) -> SweepPlan:
    """A finished sweep of the example over velocities, accelerations, lengths and times of a cut."""
    folder.mkdir(parents=True, exist_ok=True)
    measures = {"slave.velocity": ["max"], "slave.acceleration": ["max"], "limits.min_length": ["last"]}
    plan = SweepPlan.of(EXAMPLE, settings(*counts), measures=measures)
    plan.write(folder)
    write(folder, rows(plan), part)
    return plan


def seeds(folder: Path, runs: int, *more: str) -> NDArray[np.float64]:
    """A finished sweep of the measured line over seeds, with made-up rows; the true length errors, shape (runs, 12).

    Run 7 alone has a product out of tolerance: its third is 0.12 mm too short. `more`: further settings."""
    folder.mkdir(parents=True, exist_ok=True)
    plan = SweepPlan.of(MEASURED, [f"encoder.seed=0:{runs - 1}", *more])
    plan.write(folder)
    errors = np.random.default_rng(8).normal(0.01, 0.012, (runs, 12))
    errors[7, 2] = -0.12
    passed = np.arange(runs) != 7
    sigma, worst = errors.std(axis=1, ddof=1), np.abs(errors).max(axis=1)
    columns = {"run": np.arange(runs)} | plan.values(0, runs)
    columns |= {"passed": passed, "refusal": np.full(runs, ""), "first_broken": np.where(passed, "", MARK)}
    columns |= {"true_length_mean": 800.0 + errors.mean(axis=1), "true_length_sigma": sigma}
    columns |= {"true_length_worst": worst, "c_pk": (0.1 - np.abs(errors.mean(axis=1))) / (3.0 * sigma)}
    columns |= {"cut_movement": np.full(runs, 0.1), "tolerance": np.full(runs, 0.1)}
    table = pa.table(columns | {"true_length_errors": pa.array(errors.tolist())})
    pq.write_table(table, folder / "part-000000.parquet")
    return errors


def unpacked(column: Any) -> list[Any]:
    """The values of a column that is packed for a page's script."""
    if "data" in column:
        return list(np.frombuffer(base64.b64decode(column["data"]["bytes"]), "<f8").tolist())
    places = np.frombuffer(base64.b64decode(column["places"]["bytes"]), "<u2")
    return [column["list"][place] for place in places]
