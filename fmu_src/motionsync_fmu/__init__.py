"""From a block to an FMU: variables, modelDescription, documentation, both flavours, and the command line."""

__version__ = "0.1.0"
