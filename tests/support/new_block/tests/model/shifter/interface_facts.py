"""What the generic tests have to know of the Shifter's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"apply"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(parameter="offset", local="slave.jerk")
"""Causality overrides: something of each kind that the block has."""
