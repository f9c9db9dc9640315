"""What the generic tests have to know of the Gearing's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"start", "reset", "set_master.execute", "set_slave.execute"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("gearing.*", "gear_in.[!o]*", "gear_out.time"),
    parameter=("activate", "gear_in.offset", "set_master.value"),
    local="slave.velocity",
    output="local.*",
)
"""Causality overrides: something of each kind that the block has."""
