"""Writes the cross-check files of every scenario: inputs from its script, the reference from the oracle.

python -m tests.regenerate
"""

import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from motionsync.master import MasterInput
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.scenario.crosscheck import csv_text, inputs_csv, options_text
from motionsync_fmu.scenario.reader import find, load
from motionsync_fmu.scenario.run import inputs, schedule
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT
from tests.oracle import flying_saw, follower, gearing, synchronizer
from tests.oracle.remote_sync import RemoteSyncOracle

SCENARIOS = ROOT / "scenarios"
ORACLES = {
    "Synchronizer": synchronizer.reference,
    "FlyingSaw": flying_saw.reference,
    "Gearing": gearing.reference,
    "Follower": follower.reference,
}
STEPPED: dict[str, Callable[[dict[str, Any], dict[str, Any]], Any]] = {"RemoteSync": RemoteSyncOracle}
"""Oracles of blocks with a remote axis: made from parameters and first inputs, then stepped with all inputs."""

COLUMNS = {
    "Synchronizer": (
        "slave.position",
        "slave.velocity",
        "slave.acceleration",
        "slave.jerk",
        "state_code",
        "synchronized",
        "syn_ramp_on",
        "error_id",
        "local.progress",
        "local.distance_to_begin",
        "local.distance_to_end",
    ),
    "FlyingSaw": (
        "slave.position",
        "slave.velocity",
        "slave.acceleration",
        "slave.jerk",
        "state_code",
        "plcopen_state",
        "in_sync",
        "coupled",
        "error_id",
        "characteristics.profile",
        "characteristics.master_position_end",
        "characteristics.slave_position_end",
        "characteristics.slave_velocity_min",
        "characteristics.slave_velocity_max",
        "characteristics.slave_acceleration_min",
        "characteristics.slave_acceleration_max",
        "characteristics.slave_jerk_max",
        "characteristics.slave_velocity_mean",
        "characteristics.slave_acceleration_effective",
    ),
    "Gearing": (
        "slave.position",
        "slave.velocity",
        "slave.acceleration",
        "slave.jerk",
        "state_code",
        "in_gear",
        "error_id",
        "local.progress",
    ),
    "Follower": (
        "slave.position",
        "slave.velocity",
        "slave.acceleration",
        "slave.jerk",
        "state_code",
        "master_to_start",
        "master_to_sync",
        "master_to_out",
        "cycle",
        "error_id",
    ),
    "RemoteSync": (
        "slave.position",
        "slave.velocity",
        "slave.acceleration",
        "corrected_cycle_index",
        "correction_time",
        "drift",
        "state_code",
        "synced",
        "start_up",
        "warning",
        "beats",
        "cycle_index_difference",
        "equal_data_total",
        "equal_data_consecutive",
        "error_id",
    ),
}
POINTS = 200  # of a reference, about


def files(scenario_file: Path) -> dict[Path, str]:
    """The cross-check files that belong beside a scenario, with their text."""
    scenario = load(scenario_file)
    name = scenario.recipe.name
    steps = round(scenario.stop_time / scenario.step_size)
    stride = max(steps // POINTS, 1)
    times = [i * scenario.step_size for i in range(0, steps + 1, stride)]
    if scenario.remote:
        rows = stepped(STEPPED[name], scenario, times[1:])
    else:
        script = tomllib.loads(scenario_file.read_text()) | {"start": scenario.start}  # members' names as numbers
        rows = ORACLES[name](script, times)
    estimated = scenario.start.get("master.input_mode") == MasterInput.POSITION_ONLY  # lags where the master jumps
    columns = ("time", *(("slave.position",) if estimated else COLUMNS[name]))
    beside = scenario_file.parent
    return {
        beside / f"{name}_in.csv": inputs_csv(scenario),
        beside / f"{name}_ref.csv": csv_text(columns, [[row[c] for c in columns] for row in rows]),
        beside / f"{name}_ref.opt": options_text(scenario),
    }


def stepped(oracle: Callable[..., Any], scenario: Scenario, times: Sequence[float]) -> list[dict[str, float]]:
    """The outputs of an oracle that sees at each step what the FMU sees, at some of the steps' ends."""
    settable = {v.name: v.causality for v in variables(scenario.recipe.block())}
    parameters = {name: value for name, value in scenario.start.items() if settable[name] == "parameter"}
    seen = {name: value for name, value in scenario.start.items() if settable[name] == "input"}
    seen |= inputs(scenario, 0.0, 0.0)
    running = oracle(parameters, seen)
    wanted = {round(t / scenario.step_size, 6): t for t in times}
    rows = []
    for begin, end, changed in schedule(scenario, scenario.step_size):
        seen |= changed
        found = running.step(dict(seen), end - begin)
        if (place := round(end / scenario.step_size, 6)) in wanted:
            rows.append({"time": wanted[place], **{name: float(value) for name, value in found.items()}})
    return rows


if __name__ == "__main__":
    for scenario_file in find(SCENARIOS):
        for file, text in files(scenario_file).items():
            file.write_text(text)
        print(scenario_file.parent)
