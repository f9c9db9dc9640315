"""What the Follower shows: its states, the variables that its messages name, and the units of both axes."""

import numpy as np
import pytest

from motionsync.follower.block import Follower
from motionsync.follower.faults import Fault, Refusal
from motionsync.follower.interface import State
from motionsync.var import Unit
from motionsync_fmu.interface.units import unit_name
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.pages.report.page import run_charts
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from tests import ROOT


def test_refusals_and_faults_speak_of_variables_of_the_block() -> None:
    names = {v.name for v in variables(Follower())}
    refusals = [refusal for refusal in Refusal if refusal not in (Refusal.NONE, getattr(Refusal, "MASTER_TURNS", None))]
    assert refusals
    assert all({*choice.names} <= names for choice in (*refusals, *Fault))


@pytest.mark.parametrize(
    ("kind", "unit", "slave_unit", "name"),
    [
        (Unit.SLAVE_PER_MASTER, "mm", "m", "m/mm"),
        (Unit.SLAVE_PER_MASTER, "1", "deg", "deg"),
        (Unit.SLAVE_PER_MASTER, "rad", "1", "1/rad"),
        (Unit.SLAVE_PER_MASTER, "deg", "deg", "1"),
        (Unit.SLAVE_JERK, "deg", "mm", "mm/s3"),
        (Unit.SLAVE_JERK, "deg", "", "deg/s3"),
    ],
)
def test_names_of_units(kind: Unit, unit: str, slave_unit: str, name: str) -> None:
    assert unit_name(kind, unit, slave_unit) == name


def test_the_states_have_the_numbers_of_the_source() -> None:
    assert [int(state) for state in State] == [-1, 1, 2, 3, 4, 5, 8, 9, 10]


def test_the_report_shows_the_units_of_both_axes() -> None:
    scenario = load_scenario(ROOT / "scenarios" / "Follower" / "cyclic_through" / "scenario.toml")
    assert (scenario.unit, scenario.slave_unit) == ("mm", "deg")
    times = np.array([0.0, 1.0])
    by_name = {v.name: v for v in variables(Follower())}
    outputs = [v.name for v in by_name.values() if v.causality in ("output", "local")]
    course = Recording(times, {name: np.zeros(2) for name in outputs}, np.ones((2, 4)), [])
    heads = [note["text"] for note in run_charts(scenario, course)["motion"].layout["annotations"]]
    assert {"slave position in deg", "master in mm", "slave velocity in deg/s", "master in mm/s"} <= set(heads)
