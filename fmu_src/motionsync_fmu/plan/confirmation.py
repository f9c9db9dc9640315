"""Confirms predictions by runs of the block just below and just above them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from motionsync.cut_to_length.machine_limits import shortest_pitch
from motionsync.var import Unit

from ..interface.units import unit_name
from ..scenario.evaluate.expectations import Check
from .machine_data import MachineData
from .prediction import LENGTH, TOLERANCE, Prediction, compute_cycle
from .simulation import PIECES, CuttingRun, simulate, simulate_return_time

OFFSET = 1e-6  # relative: how far below and above a prediction the block is run
SLOW = 1e-3  # of the greatest line velocity
MANY_PIECES = 200  # within which a start that is late by OFFSET of a pitch becomes too late
SAME_TIME = 1e-9  # relative
LEAST_LENGTH = 1e-6  # u; the block takes nothing shorter as a length
GAP_SKIPPED = "the gap exceeds the axis's limits at this velocity: the block leaves it out, and its cycle is shorter"


def confirm(data: MachineData, prediction: Prediction) -> Prediction:
    """Run the block near a prediction; it is returned with what the runs were expected to do, and did."""
    if prediction.length is None:
        return replace(prediction, checks=[_check_no_cut(data, prediction.velocity)])
    if prediction.velocity <= 0.0:
        return replace(prediction, checks=[_check_always_too_fast(data, prediction.length)])
    if prediction.length <= LEAST_LENGTH:
        return prediction
    result = prediction.velocity if prediction.given == LENGTH else prediction.length
    runs = _NearbyRuns(data, prediction)
    below, title = runs.run(result, -OFFSET), runs.describe(result, -OFFSET)
    check = Check(f"{title}: every cut is made", below.text, below.has_made_all and not below.has_warned)
    if below.has_skipped_gap:
        return replace(prediction, checks=[check], note=GAP_SKIPPED)
    above = _check_above(runs, result, prediction.lost or 0.0)
    return replace(prediction, checks=[check, _check_return(data, prediction), *above])


@dataclass(frozen=True)
class _NearbyRuns:
    """Runs of the block near a prediction; a positive `offset` demands more: a faster line, or a shorter pitch."""

    data: MachineData
    prediction: Prediction

    def operating_point(self, result: float, offset: float) -> tuple[float, float]:
        """Length and line velocity of a run."""
        length, velocity = self.prediction.length, self.prediction.velocity
        assert length is not None
        if self.prediction.given == LENGTH:
            return length, result * (1.0 + offset)
        return self.data.length(self.data.pitch(result) / (1.0 + offset)), velocity * (1.0 - TOLERANCE)

    def run(self, result: float, offset: float, pieces: int = PIECES) -> CuttingRun:
        return simulate(self.data, *self.operating_point(result, offset), pieces)

    def describe(self, result: float, offset: float) -> str:
        """Length and line velocity of a run, in words."""
        length, velocity = self.operating_point(result, offset)
        names = (unit_name(kind, self.data.unit) for kind in (Unit.POSITION, Unit.VELOCITY))
        u, v = (f" {name}" if name else "" for name in names)
        return f"pieces of {length:.9g}{u} at {velocity:.9g}{v}"


def _check_above(runs: _NearbyRuns, result: float, lost: float) -> Iterator[Check]:
    """Check the runs above a prediction: a warning at once; missed cuts as soon as the reserve is used up."""
    has_reserve = abs(lost - result) > 3.0 * OFFSET * result
    warning = "line_too_fast is active before a cut is missed"
    if has_reserve:
        for value, offset in ((result, OFFSET), (lost, -OFFSET)):
            run, title = runs.run(value, offset), runs.describe(value, offset)
            yield Check(f"{title}: {warning}, and none is", run.text, run.has_made_all and run.has_warned)
    if lost > LEAST_LENGTH:
        run, title = runs.run(lost, OFFSET, MANY_PIECES), runs.describe(lost, OFFSET)
        yield Check(f"{title}: {warning}, and some are", run.text, run.has_warned and run.skipped > 0)


def _check_return(data: MachineData, prediction: Prediction) -> Check:
    """Check that the carriage reaches home as long after the start of its approach as predicted."""
    velocity = prediction.velocity * (1.0 - TOLERANCE)  # an admissible one, rounded or not
    cycle = compute_cycle(data.machine, velocity)
    expected, simulated = cycle.time - cycle.rest, simulate_return_time(data, velocity)
    return Check(
        f"the carriage is at home {expected:.9g} s after the start of its approach",
        f"{simulated:.9g} s",
        abs(simulated - expected) <= SAME_TIME * expected,
    )


def _check_always_too_fast(data: MachineData, length: float) -> Check:
    """Check that pieces shorter than the distances of a cycle are too short for a line of any velocity."""
    run = simulate(data, length, SLOW * data.greatest_velocity)
    return Check(f"pieces of {length:.9g} on a slow line: line_too_fast is active", run.text, run.has_warned)


def _check_no_cut(data: MachineData, velocity: float) -> Check:
    """Check that a line too fast for the carriage or its stroke has every cut skipped, however long the pieces are."""
    length = data.length(2.0 * shortest_pitch(data.machine, velocity))
    run = simulate(data, length, velocity)
    return Check(f"at {velocity:.9g}: no cut is made, however long the pieces", run.text, run.skipped > 0 == run.cuts)
