"""What the generic tests have to know of the Synchronizer's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"start", "stop"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input="output_phasing", parameter=("active", "rest_value"), local=("slave.jerk", "ready"), output="local.*"
)
"""Causality overrides: something of each kind that the block has."""
