"""What the generic tests have to know of the FlyingSaw's interface, by hand."""

from motionsync_fmu.interface.causality import Interface
from tests.support.blocks.runs import BlockRun

COMMANDS = {
    "gear_in_velo.execute",
    "gear_in_pos.execute",
    "gear_out.execute",
    "halt.execute",
    "stop.execute",
    "move_velocity.execute",
    "move_absolute.execute",
    "reset.execute",
}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("gear_in_pos.ratio_*", "sync_mode.*", "axis.max_*"),
    parameter=("gear_in_pos.master_start_distance", "move_absolute.position"),
    local=("slave.jerk", "coupled"),
    output=("characteristics.*", "local.progress"),
)
"""Causality overrides: something of each kind that the block has."""

REACHING_RUNS = [
    BlockRun(
        {
            "axis.initial_velocity": 500.0,
            "axis.initial_position": -250.0,
            "axis.max_jerk": 200000.0,
            "sync_mode.prefer_constant_velocity": True,
            "sync_mode.check_max_jerk": True,
            "master.position": -250.0,
            "master.velocity": 500.0,
            "gear_in_pos.master_sync_position": 1500.0,
            "gear_in_pos.slave_sync_position": 1200.0,
            "gear_in_pos.acceleration": 1000.0,
            "gear_in_pos.deceleration": 2000.0,
            "gear_in_pos.jerk": 200000.0,
        },
        [(0.05, {"master.position": -250.0 + 25.0 * i, "gear_in_pos.execute": i >= 10}) for i in range(90)],
    )
]
"""What the random runs do not reach: a profile with a constant velocity, whose jerk is checked."""
