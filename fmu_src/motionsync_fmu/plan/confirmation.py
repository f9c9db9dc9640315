"""Confirms predictions by runs of the block just below and just above them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from motionsync.var import Unit

from ..scenario.evaluate.expectations import Check
from .machine import Machine
from .prediction import LENGTH, NOT_TAKEN, TOLERANCE, CuttingRun, Prediction
from .simulation import PIECES, simulate

OFFSET = 1e-6  # relative: how far below and above a prediction the block is run
SLOW = 1e-3  # of the greatest line velocity
LONG = 2.0  # of the longest pitch that limits the line
MANY_PIECES = 200  # within which a start that is late by OFFSET of a pitch becomes too late
LEAST_LENGTH = 1e-6  # u; the block takes nothing shorter as a length
GAP_SKIPPED = "the gap exceeds the axis's limits at this velocity: the block leaves it out, and its cycle is shorter"


def confirm(machine: Machine, prediction: Prediction) -> Prediction:
    """Run the block near a prediction; it is returned with what the runs were expected to do, and did."""
    if prediction.length is None:
        return replace(prediction, checks=[_check_no_cut(machine, prediction.velocity)])
    if prediction.velocity <= 0.0:
        return replace(prediction, checks=[_check_no_velocity(machine, prediction.length, prediction.bound)])
    if prediction.length <= LEAST_LENGTH:
        return prediction
    result = prediction.velocity if prediction.given == LENGTH else prediction.length
    runs = _NearbyRuns(machine, prediction)
    below, title = runs.run(result, -OFFSET), runs.describe(result, -OFFSET)
    check = Check(f"{title}: every cut is made", below.text, below.has_made_all and not below.has_warned)
    if below.has_skipped_gap:
        return replace(prediction, checks=[check], note=GAP_SKIPPED)
    above = _check_above(runs, result, prediction.lost or 0.0)
    return replace(prediction, checks=[check, machine.check_cycle(prediction, below), *above])


@dataclass(frozen=True)
class _NearbyRuns:
    """Runs of the block near a prediction; a positive `offset` demands more: a faster line, or a shorter pitch."""

    machine: Machine
    prediction: Prediction

    def operating_point(self, result: float, offset: float) -> tuple[float, float]:
        """Length and line velocity of a run."""
        length, velocity = self.prediction.length, self.prediction.velocity
        assert length is not None
        if self.prediction.given == LENGTH:
            return length, result * (1.0 + offset)
        return self.machine.length(self.machine.pitch(result) / (1.0 + offset)), velocity * (1.0 - TOLERANCE)

    def run(self, result: float, offset: float, pieces: int = PIECES) -> CuttingRun:
        return simulate(self.machine, *self.operating_point(result, offset), pieces)

    def describe(self, result: float, offset: float) -> str:
        """Length and line velocity of a run, in words."""
        length, velocity = self.operating_point(result, offset)
        u, v = (self.machine.unit_of(kind) for kind in (Unit.POSITION, Unit.VELOCITY))
        return f"pieces of {f'{length:.9g} {u}'.rstrip()} at {f'{velocity:.9g} {v}'.rstrip()}"


def _check_above(runs: _NearbyRuns, result: float, lost: float) -> Iterator[Check]:
    """Check the runs above a prediction: a warning at once; missed cuts as soon as the reserve is used up.

    Where a knife can come out of rest in time, but cannot come to rest within its limits, it exceeds them instead."""
    has_reserve = abs(lost - result) > 3.0 * OFFSET * result
    warning = "line_too_fast is active before a cut is missed"
    if has_reserve:
        for value, offset in ((result, OFFSET), (lost, -OFFSET)):
            run, title = runs.run(value, offset), runs.describe(value, offset)
            yield Check(f"{title}: {warning}, and none is", run.text, run.has_made_all and run.has_warned)
    if lost > LEAST_LENGTH:
        run, title = runs.run(lost, OFFSET, MANY_PIECES), runs.describe(lost, OFFSET)
        is_lost = run.skipped > 0 or run.has_exceeded_limit
        yield Check(f"{title}: {warning}, and some are, or a limit is exceeded", run.text, run.has_warned and is_lost)


def _check_no_velocity(machine: Machine, length: float, bound: str) -> Check:
    """Check that pieces of a length that no line velocity admits are not cut, or too short for a slow line."""
    run = simulate(machine, length, SLOW * machine.greatest_velocity)
    title = f"pieces of {length:.9g} on a slow line"
    if bound == NOT_TAKEN:
        return Check(f"{title}: none is cut", run.text, run.cuts == 0)
    return Check(f"{title}: line_too_fast is active", run.text, run.has_warned)


def _check_no_cut(machine: Machine, velocity: float) -> Check:
    """Check that a line which is too fast for any length has every cut skipped, however long the pieces are."""
    _, longest = machine.pitch_range(velocity)
    run = simulate(machine, machine.length(LONG * longest), velocity, first_velocity=velocity)
    return Check(f"at {velocity:.9g}: no cut is made, however long the pieces", run.text, run.skipped > 0 == run.cuts)
