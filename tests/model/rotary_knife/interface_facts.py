"""What the generic tests have to know of the RotaryKnife's interface, by hand."""

from motionsync_fmu.interface.causality import Interface

COMMANDS = {"start", "stop", "abort", "reset", "cut_now", "take_sample", "order.add", "mark.detected"}
"""The inputs whose edge starts something."""

OVERRIDES = Interface(
    input=("order.skip", "calibration.[emr]*", "clear_statistics", "sync.overspeed"),
    parameter=("length*", "order.length", "mark.position", "line.wanted_velocity"),
    local=("slave.jerk", "order.waiting", "statistics.skipped"),
    output=("batch_[cd]*", "piece.*", "peaks.velocity"),
)
"""Causality overrides: something of each kind that the block has."""
