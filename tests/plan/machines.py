"""The machines of the tests, as options `--set` of the command line."""

from motionsync_fmu.plan.machine_data import MachineData
from motionsync_fmu.plan.reader import read_machine

REFERENCE = {  # axis 1500 / 10000 / 10000 / 200000, ends -250 ... 650, home 0, a cut of 0.25 s, no reserve
    "axis.max_velocity": "1500",
    "axis.max_jerk": "200000",
    "axis.min_position": "-250",
    "axis.max_position": "650",
    "approach.reserve": "0",
}
JERKLESS = {  # so great a jerk that it limits nothing, no time but that of the motion: T_c goes with v/a
    "axis.max_velocity": "1e6",
    "axis.max_jerk": "1e12",
    "approach.reserve": "0",
    "tool.cut_time": "0",
}


def machine(values: dict[str, str], **more: str) -> MachineData:
    """The machine with these values; `more`: further ones, with _ in place of the dot."""
    data, _, _ = read_machine(None, values | {name.replace("_", ".", 1): text for name, text in more.items()}, "")
    return data
