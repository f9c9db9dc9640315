"""Runs the block at a constant line velocity, to see whether it does what was predicted."""

from ..interface.stepper import RefusedError, Stepper
from .machine import Machine
from .prediction import CuttingRun

PIECES = 6  # of a run, by default
STEPS_PER_PIECE = 9.7  # so that no event is at the same fraction of each step


def simulate(
    machine: Machine, length: float, velocity: float, pieces: int = PIECES, first_velocity: float = 0.0
) -> CuttingRun:
    """Run the block while so many pieces of this length pass at this line velocity, or until cuts are skipped.

    `first_velocity`: of the line up to the first cut; 0: as the machine has it."""
    travel = machine.pitch(length) / STEPS_PER_PIECE
    first = first_velocity or machine.first_velocity(velocity)
    stepper = Stepper(machine.recipe.block())
    counts_gaps = "warning.gap_skipped" in stepper.cells
    has_warned = has_skipped_gap = has_exceeded_limit = False
    skipped, refusal = 0, ""
    try:
        stepper.initialize(machine.start_values(length))
        for i in range(round((pieces + 0.9) * STEPS_PER_PIECE + machine.lead_in / travel)):
            v = velocity if stepper["statistics.cuts"] else first
            stepper.step(travel / v, {"master.position": i * travel, "master.velocity": v})
            skipped = stepper["statistics.skipped"]
            if skipped:
                break
            has_warned |= stepper["warning.line_too_fast"]
            has_exceeded_limit |= stepper["warning.limit_exceeded"]
            has_skipped_gap |= counts_gaps and stepper["warning.gap_skipped"]
    except RefusedError as error:
        refusal = str(error)
    return CuttingRun(
        pieces,
        stepper["statistics.cuts"],
        skipped,
        has_warned,
        has_exceeded_limit,
        has_skipped_gap,
        stepper["last.reserve"],
        refusal,
    )
