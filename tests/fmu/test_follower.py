"""The FMU of the Follower: what its log says, and the slave's own unit."""

from pathlib import Path

import pytest
from fmpy import read_model_description

from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import build_python
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
from tests.support.hosts.fmus import Fmus


def test_the_log_names_variables_and_values(fmus: Fmus) -> None:
    fmu = fmus.python("Follower")
    with (
        FmuInstance(fmu) as host,
        pytest.raises(FmuError, match=r"master_cycle must be greater .*master_cycle = 500, .*"),
    ):
        host.initialize({"master_cycle": 500.0})
    with FmuInstance(fmu) as host, pytest.raises(FmuError, match="k_slave_master = 0 is not allowed"):
        host.initialize({"k_slave_master": 0.0})
    with FmuInstance(fmu) as host:
        host.initialize({"slave.initial_position": 10.0})
        host.step(0.1, {"position_to_park": True, "positioning.jerk": 0.0})
        assert any("positioning refused" in text and "positioning.jerk = 0" in text for text in host.messages)


UNITS = {
    "master_cycle": "mm",
    "sync_master": "mm",
    "space_wait_in_park": "mm",
    "master_to_sync": "mm",
    "master.velocity": "mm/s",
    "slave_cycle": "deg",
    "sync_out": "deg",
    "max_speed": "deg/s",
    "positioning.jerk": "deg/s3",
    "slave.initial_position": "deg",
    "slave.position": "deg",
    "slave.acceleration": "deg/s2",
    "k_slave_master": "deg/mm",
    "local.meeting_position": "mm",
    "local.progress": None,
}


def units_of(fmu: Path) -> dict[str, str | None]:
    description = read_model_description(str(fmu))
    return {
        v.name: v.declaredType.unit if v.declaredType else None for v in description.modelVariables if v.type == "Real"
    }


def test_the_slave_may_be_in_a_unit_of_its_own(tmp_path: Path) -> None:
    own = Recipe("Follower", "mm", {}, "deg")
    units = units_of(build_python(own, tmp_path / "own.fmu"))
    assert {name: units[name] for name in UNITS} == UNITS
    assert compute_guid(own) != compute_guid(Recipe("Follower", "mm"))
    same = units_of(build_python(Recipe("Follower", "m"), tmp_path / "same.fmu"))
    assert (same["slave.position"], same["positioning.velocity"], same["k_slave_master"]) == ("m", "m/s", "1")
    with pytest.raises(UserError, match="the slave of Synchronizer is in its master's unit"):
        Recipe("Synchronizer", "mm", {}, "deg").block()
    with pytest.raises(UserError, match="slave unit"):
        Recipe("Follower", "mm", {}, "km").block()
