"""The machines of the tests, as options `--set` of the command line."""

from typing import TypeVar

from motionsync_fmu.plan.knife import Knife
from motionsync_fmu.plan.reader import read_machines
from motionsync_fmu.plan.saw import Saw
from tests.model.cut_to_length import machine_results

M = TypeVar("M", Saw, Knife)

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


KNIFE = {"sync.before": "30", "sync.after": "30"}  # of the specification's figures; all else has its start value
TORQUES = {
    "load.inertia": "0.5",
    "load.friction": "4",
    "load.continuous_force": "30",
    "load.peak_force": "100",
}


def variant(name: str) -> Saw:
    """One of the machines whose results are in the table."""
    return machine(REFERENCE | {name: f"{value:g}" for name, value in machine_results.MACHINES[name].items()})


def machine(values: dict[str, str], **more: str) -> Saw:
    """The saw with these values; `more`: further ones, with _ in place of the dot."""
    return _read(Saw, values, more)


def knife(values: dict[str, str], **more: str) -> Knife:
    """The knife with these values, as `machine`."""
    return _read(Knife, values, more)


def _read(kind: type[M], values: dict[str, str], more: dict[str, str]) -> M:
    given = values | {name.replace("_", ".", 1): text for name, text in more.items()}
    (read,), _, _ = read_machines([], kind.kind, given, "")
    assert isinstance(read, kind)
    return read
