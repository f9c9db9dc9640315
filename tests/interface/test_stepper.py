"""A block in this process, driven by the names of its variables."""

import pytest

from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.faults import Refusal
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from tests.support.blocks.harness import copy_stepper


def coupled() -> Stepper:
    return Stepper(Synchronizer()).initialize({"master.velocity": 90.0})


def test_a_synchronized_slave_goes_along_with_the_master_that_is_set_by_name() -> None:
    stepper = coupled()
    assert stepper.step(0.5, {"master.position": 0.0})["slave.position"] == 45.0
    assert stepper.step(0.5, {"master.position": 45.0}).get(["slave.velocity", "state_code"]) == {
        "slave.velocity": 90.0,
        "state_code": 0,
    }


def test_a_copy_goes_on_from_the_same_state_and_leaves_the_first_one_alone() -> None:
    first = coupled().step(1.0)
    second = copy_stepper(first)
    assert second["slave.position"] == 90.0
    second.step(1.0, {"master.position": 90.0})
    assert (first["slave.position"], second["slave.position"]) == (90.0, 180.0)
    assert first["master.position"] == 0.0
    assert first.step(1.0, {"master.position": 90.0})["slave.position"] == 180.0


def test_a_refused_call_names_block_call_reason_and_values() -> None:
    with pytest.raises(RefusedError) as refused:
        coupled().step(0.5, {"master.period": 1e-9, "master.velocity": 1e12, "master.position": 0.0})
    assert refused.value.refusal == Refusal.MASTER_TURNS
    text = str(refused.value)
    assert text.startswith(f"Synchronizer refuses step(0.5): {Refusal.MASTER_TURNS.description}")
    assert "master.period = 1e-09" in text


def test_an_unknown_name_is_reported_with_its_neighbours() -> None:
    with pytest.raises(UserError, match=r"no variable of Synchronizer is named 'master.positon'.*'?master.position"):
        coupled().set({"master.positon": 1.0})
    with pytest.raises(UserError, match=r"slave\.velocity"):
        _ = coupled()["slave.velocty"]
