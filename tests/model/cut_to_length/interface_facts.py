"""What the generic tests have to know of the CutToLength's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"start", "stop", "abort", "reset", "cut_now", "take_sample", "order.add", "mark.detected", "tool.done"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("order.skip", "order.clear", "calibration.[emr]*", "clear_statistics", "kerf"),
    parameter=("length*", "order.length", "mark.position", "line.wanted_velocity"),
    local=("slave.jerk", "order.waiting", "statistics.skipped"),
    output=("batch_[cd]*", "piece.*", "tool.blade_down"),
)
"""Causality overrides: something of each kind that the block has."""
