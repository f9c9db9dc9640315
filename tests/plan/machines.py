"""The machines of the tests, as options `--set` of the command line."""

from motionsync_fmu.plan.machine_data import MachineData
from motionsync_fmu.plan.reader import read_machine
from tests.model.cut_to_length import machine_results

REFERENCE = {name: f"{value:g}" for name, value in machine_results.REFERENCE.items()}
LOADED = REFERENCE | {
    "load.mass": "120",
    "load.friction": "150",
    "load.continuous_force": "900",
    "load.peak_force": "3000",
}
JERKLESS = {  # so great a jerk that it limits nothing, no time but that of the motion: T_c goes with v/a
    "axis.max_velocity": "1e6",
    "axis.max_jerk": "1e12",
    "approach.reserve": "0",
    "tool.cut_time": "0",
}


def variant(name: str) -> MachineData:
    """One of the machines whose results are in the table."""
    return machine(REFERENCE | {name: f"{value:g}" for name, value in machine_results.MACHINES[name].items()})


def machine(values: dict[str, str], **more: str) -> MachineData:
    """The machine with these values; `more`: further ones, with _ in place of the dot."""
    data, _, _ = read_machine(None, values | {name.replace("_", ".", 1): text for name, text in more.items()}, "")
    return data
