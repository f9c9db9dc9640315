"""Sweeps from Python, and the table of a sweep's folder."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest

from motionsync_fmu import sweep
from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.sweeps.rows import rows
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from motionsync_fmu.sweeps.table import Rows

SAW = load_example("FlyingSaw").file
JERKS = np.linspace(1e4, 5e4, 5)


def swept(folder: Path, **options: Any) -> Rows:
    """Ten runs in parts of four."""
    factors = {"axis.max_jerk": JERKS, "axis.max_acceleration": "1000,2500"}
    return sweep(SAW, set=factors, output=folder, workers=1, **{"chunk": 4, **options})


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    return swept(tmp_path_factory.mktemp("sweep"), measures={"slave.velocity": ("max", "max_time"), "state": "last"})


def copied(of: Rows, folder: Path) -> Path:
    for file in of.folder.iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    return folder


# --- from Python ---


def test_a_sweep_gives_the_rows_of_its_plan(done: Rows) -> None:
    jerks = ",".join(str(jerk) for jerk in JERKS.tolist())
    measures = {"slave.velocity": ("max", "max_time"), "state": ("last",)}
    plan = SweepPlan.of(SAW, [f"axis.max_jerk={jerks}", "axis.max_acceleration=1000,2500"], measures=measures)
    assert (len(done), done.missing) == (10, [])
    assert done.to_frame() == rows(plan, 0, 10)
    assert done.plan.differs(plan) == ""


def test_what_follows_is_derived(tmp_path: Path) -> None:
    result = sweep(
        SAW,
        set={
            "master.velocity": "200..300",
            "axis.max_acceleration": 2000,
            "axis.max_deceleration": "2*axis.max_acceleration",
        },
        samples=3,
        method="sobol",
        seed=7,
        output=tmp_path,
        workers=1,
    )
    assert result.column("axis.max_deceleration").to_pylist() == [4000.0] * 3
    assert len(set(result.column("master.velocity").to_pylist())) == 3


def test_flags_members_and_whole_numbers_are_values(tmp_path: Path) -> None:
    factors = {
        "sync_mode.time_based": [True, False],
        "master.input_mode": np.array(["END_OF_STEP"]),
        "gear_in_pos.ratio_denominator": range(1, 3),
    }
    rows = (
        sweep("FlyingSaw/start_distance", set=factors, output=str(tmp_path), workers=1).to_frame([*factors]).to_pylist()
    )
    assert [tuple(row.values()) for row in rows] == [
        (True, "END_OF_STEP", 1), (True, "END_OF_STEP", 2), (False, "END_OF_STEP", 1), (False, "END_OF_STEP", 2)
    ]  # fmt: skip


def test_the_same_sweep_goes_on_and_another_one_is_refused(tmp_path: Path) -> None:
    whole = swept(tmp_path).to_frame()
    (tmp_path / "part-000001.parquet").unlink()
    reported: list[tuple[int, int]] = []
    assert swept(tmp_path, progress=lambda *done: reported.append(done)).to_frame() == whole
    assert reported == [(6, 10), (10, 10)]
    with pytest.raises(UserError, match="has another sweep"):
        swept(tmp_path, measures={"state": "last"})


@pytest.mark.parametrize(
    ("factors", "options", "message"),
    [
        ({"axis.max_jerk": np.ones((2, 2))}, {}, r"axis.max_jerk is an array of shape \(2, 2\) of float64: it must be"),
        ({"axis.max_jerk": []}, {}, r"of shape \(0,\)"),
        ({"axis.max_jerk": [None]}, {}, "of object: it must be a list of values"),
        ({"axis.max_jerks": [1.0]}, {}, "axis.max_jerks"),
        ({"axis.max_jerk": "5e4..1e4"}, {"samples": 3}, "reversed"),
        ({"axis.max_jerk": [1e4, np.nan]}, {}, "nan"),
        ({"axis.max_jerk": [1e4]}, {"method": "random"}, "no method is named 'random'; there is lhs, sobol"),
        ({"axis.max_jerk": [1e4]}, {"measures": {"state": "most"}}, "no measure is named 'most'"),
        ({}, {}, "a sweep varies something"),
    ],
)
def test_what_is_no_sweep_is_reported(tmp_path: Path, factors: Any, options: Any, message: str) -> None:
    with pytest.raises(UserError, match=message):
        sweep(SAW, set=factors, output=tmp_path / "out", workers=1, **options)
    assert not (tmp_path / "out").exists()


# --- the table ---


def test_a_column_is_read_alone(done: Rows) -> None:
    assert done.column("run").to_pylist() == list(range(10))
    assert done.column("axis.max_jerk").to_numpy().tolist() == np.repeat(JERKS, 2).tolist()
    assert done.to_frame(["passed", "run"]).column_names == ["passed", "run"]
    assert done.schema.names == done.to_frame().column_names


def test_rows_come_by_batches_in_the_order_of_the_runs(done: Rows) -> None:
    assert [run for batch in done for run in batch["run"].to_pylist()] == list(range(10))
    assert pa.Table.from_batches(done.batches(["cuts"])) == done.to_frame(["cuts"])


def test_others_read_the_dataset(done: Rows) -> None:
    few = done.dataset.to_table(columns=["run"], filter=pc.field("axis.max_jerk") > 4.5e4)
    assert few["run"].to_pylist() == [8, 9]


@pytest.mark.parametrize(
    ("gone", "missing"),
    [
        ([0], [range(4)]),
        ([1], [range(4, 8)]),
        ([2], [range(8, 10)]),
        ([0, 2], [range(4), range(8, 10)]),
        ([1, 2], [range(4, 10)]),
        ([0, 1, 2], [range(10)]),
    ],
)
def test_the_runs_without_rows_are_known(done: Rows, tmp_path: Path, gone: list[int], missing: list[range]) -> None:
    for part in gone:
        (copied(done, tmp_path) if part == gone[0] else tmp_path).joinpath(f"part-{part:06}.parquet").unlink()
    result = Rows(tmp_path)
    assert result.missing == missing
    assert len(result) == 10 - sum(map(len, missing))
    assert set(result.column("run").to_pylist()) == set(range(10)) - {run for runs in missing for run in runs}


@pytest.mark.parametrize("damage", [lambda b: b[:-10], lambda b: b"", lambda b: b[:40] + bytes(8) + b[48:]])
def test_a_damaged_part_is_reported_by_its_name(done: Rows, tmp_path: Path, damage: Any) -> None:
    part = copied(done, tmp_path) / "part-000001.parquet"
    part.write_bytes(damage(part.read_bytes()))
    for read in (Rows.to_frame, list):
        with pytest.raises(UserError) as error:
            read(Rows(tmp_path))
        assert f"{part} is damaged" in str(error.value)
        assert "\n" not in str(error.value)


def test_an_unknown_column_is_reported(done: Rows) -> None:
    with pytest.raises(UserError, match="no column is named 'cut'; there is"):
        done.column("cut")


def test_of_a_plan_that_was_only_written_all_runs_are_missing(tmp_path: Path) -> None:
    SweepPlan.of(SAW, ["axis.max_jerk=1e4,2e4"]).write(tmp_path)
    assert (len(Rows(tmp_path)), Rows(tmp_path).missing) == (0, [range(2)])
    assert Rows(tmp_path).to_frame().num_rows == 0


def test_a_folder_without_a_plan_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"plan\.toml"):
        Rows(tmp_path)
    with pytest.raises(UserError, match=r"plan\.toml"):
        Rows(tmp_path / "nowhere")
