"""What the generic tests have to know of the Follower's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"position_to_park", "position_to_cycle", "end_synchronism", "reset"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("k_slave_master", "check_*", "max_*"),
    parameter=("sync_master", "sync_assumed"),
    local="master_to_*",
    output="local.p*",
)
"""Causality overrides: something of each kind that the block has."""
