"""What the generic tests have to know of the RemoteSync's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS: set[str] = set()
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("delay_time_offset", "max_position_difference"),
    parameter="enable",
    local=("drift", "slave.j*"),
    output=("beats", "cycle_index_difference"),
)
"""Causality overrides: something of each kind that the block has."""
