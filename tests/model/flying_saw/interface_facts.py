"""What the generic tests have to know of the FlyingSaw's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

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
