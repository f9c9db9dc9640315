"""Evaluates a line: the follower's errors with RemoteSync, without it, and with other estimators."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from motionsync.var import Unit

from ..interface.units import unit_name
from ..scenario.cutting import PieceSpec
from ..scenario.engineering import engineering
from ..scenario.evaluate.expectations import Check, check_expectations
from ..scenario.evaluate.key_figures import find_peaks
from ..scenario.evaluate.verdict import ALARM, check_alarms, check_limits, find_events
from ..scenario.recording import Reals
from .line import REMOTE, ProductionLine
from .package import LinePackage
from .runs import Values, run_ssp
from .variants import (
    RAW,
    Variant,
    other_estimators,
    raw_axis,
    run_follower,
    run_through_remote_sync,
    true_axis,
    variant_of,
    wired_name,
)

BLENDING = ("new_drift_blending_cycles", "blending_time")  # RemoteSync's times until it uses a new drift in full


@dataclass(frozen=True)
class VariantErrors:
    """A variant's errors in a part of the run, in u; None: there is nothing of the kind in this part.

    Attributes:
        name: the variant's name.
        cuts: the number of cuts.
        missed: how many further cuts were left out or made late; None: the follower does not record its pieces.
        worst: the greatest magnitude of the errors of the cuts, or of the recorded pieces' lengths.
        mean: the mean of these errors.
        spread: the greatest of these errors minus the least.
        recorded: the greatest magnitude of the length errors, as recorded by the follower.
        switches: the greatest magnitude of the errors of the switches.
        deviation: the greatest magnitude of `Variant.deviation`.
        jump: the greatest change of `Variant.deviation` in a step: a jump of the setpoint that the motion of the axis
            does not cause.
        index: the greatest index error minus the least, in cycles.
    """

    name: str
    cuts: int
    missed: int | None
    worst: float | None
    mean: float | None
    spread: float | None
    recorded: float | None
    switches: float | None
    deviation: float | None
    jump: float | None
    index: float | None


@dataclass(frozen=True)
class LineResult:
    """The results of `evaluate_line`.

    Attributes:
        synced: the time at which RemoteSync is in sync for the first time, in s; infinite: never.
        settled: the time from which RemoteSync uses its drift in full, in s; the errors in sync are those from then on.
        remote: RemoteSync's outputs.
        wired: the variant through the SSP package.
        variants: all variants: the wired one first, then the raw telegrams, then other estimators.
        before, after: the errors of all variants, before `settled` and from then on.
        checks: the expectations, each with its result.
    """

    synced: float
    settled: float
    remote: Values
    variants: list[Variant]
    before: list[VariantErrors]
    after: list[VariantErrors]
    checks: list[Check]

    @property
    def wired(self) -> Variant:
        return self.variants[0]

    @property
    def passed(self) -> bool:
        return all(c.passed for c in self.checks)


def evaluate_line(
    line: ProductionLine, package: LinePackage, progress: Callable[[str], None] = lambda text: None
) -> LineResult:
    """Run the line in FMPy, and the follower alone for the other variants.

    `progress` is called with the name of each run before it starts.

    Raises:
        UserError: an FMU refused a value or a step.
    """
    progress("the follower on the true axis and on the raw telegrams")
    truth = run_follower(line, package, true_axis(line))
    raw = run_follower(line, package, raw_axis(line))
    progress("FMPy's SSP simulation")
    outputs = run_ssp(line, package)
    remote, follower = outputs[REMOTE], line.follower.recipe.name
    variants = [
        variant_of(line, wired_name(line), outputs[follower], truth, remote),
        variant_of(line, RAW, raw, truth, None),
    ]
    for name, start in other_estimators(line).items():
        progress(f"estimator {name}")
        other, values = run_through_remote_sync(line, package, start)
        variants.append(variant_of(line, name, values, truth, other))
    synced, settled = _find_sync_times(line, remote)
    return LineResult(
        synced,
        settled,
        remote,
        variants,
        [_compute_errors(line, variant, line.times < settled) for variant in variants],
        [_compute_errors(line, variant, line.times >= settled) for variant in variants],
        list(_check_line(line, variants[0], synced, settled)),
    )


# --- errors ---


def _find_sync_times(line: ProductionLine, remote: Values) -> tuple[float, float]:
    """When RemoteSync is in sync first, and from when on it uses its drift in full, in s; infinite: never."""
    on = remote["synced"] > 0.0
    if not on.any():
        return math.inf, math.inf
    synced = float(line.times[int(np.argmax(on))])
    declared = line.recipes[REMOTE].variables
    cycles, time = (line.start.get(name, declared[name].start) for name in BLENDING)
    return synced, synced + max(cycles * line.step_size, time)


def _compute_errors(line: ProductionLine, variant: Variant, inside: Any) -> VariantErrors:
    times = variant.recording.time[inside]
    begin, end = (times[0], times[-1]) if len(times) else (math.inf, math.inf)
    cuts, switches = ([e for e in events if begin <= e.begin <= end] for events in (variant.cuts, variant.switches))
    products = [x for x in variant.products if begin <= x.begin and x.end <= end]
    errors = np.array([x.error for x in (*cuts, *products)])
    deviation = variant.deviation[inside]
    return VariantErrors(
        variant.name,
        len(cuts) + sum(bool(begin <= piece.reported_at <= end) for piece in variant.pieces),
        int(variant.missed[inside].sum()) if line.piece_variables else None,
        _greatest(errors),
        float(errors.mean()) if len(errors) else None,
        _spread(errors),
        _greatest([x.recorded or 0.0 for x in products]),
        _greatest([x.error for x in switches]),
        _greatest(deviation),
        _greatest(np.diff(deviation)),
        _spread(variant.index[inside]),
    )


def _greatest(values: Reals | list[float]) -> float | None:
    return float(np.abs(values).max()) if len(values) else None


def _spread(values: Reals) -> float | None:
    return float(np.ptp(values)) if len(values) else None


# --- checks ---


def _check_line(line: ProductionLine, wired: Variant, synced: float, settled: float) -> Iterator[Check]:
    s, unit = line.follower, unit_name(Unit.POSITION, line.unit)
    yield Check("RemoteSync in sync", f"from {synced:.10g} s on" if synced < math.inf else "never", synced < math.inf)
    yield from check_expectations(s, wired.recording)
    yield from check_limits(s, find_peaks(s, wired.recording), [])
    yield from check_alarms(s, find_events(wired.recording, ALARM))
    if s.recipe.piece_variables:
        missed = int(wired.missed.sum())
        yield Check("no cut left out or late", f"{missed}", missed == 0)
    if s.pieces:
        yield from _check_lengths(s.pieces, wired, settled, unit)
    if s.cuts and s.cuts.count is not None:
        yield Check(f"number of cuts = {s.cuts.count}", f"{len(wired.cuts)}", len(wired.cuts) == s.cuts.count)
    if s.cuts:
        expected = f"cuts within {engineering(s.cuts.tolerance, unit)} of a mark on the true axis, once in sync"
        yield _check_worst(expected, [c.error for c in wired.cuts if c.begin >= settled], s.cuts.tolerance, unit, "cut")
    if line.switch_tolerance is not None:
        errors = [x.error for x in wired.switches if x.begin >= settled]
        tolerance = engineering(line.switch_tolerance, unit)
        expected = f"transitions within {tolerance} of their position on the true axis, once in sync"
        yield _check_worst(expected, errors, line.switch_tolerance, unit, "transition")


def _check_lengths(spec: PieceSpec, wired: Variant, settled: float, unit: str) -> Iterator[Check]:
    """The follower's pieces: their number and their lengths."""
    if spec.count is not None:
        yield Check(f"number of cuts = {spec.count}", f"{len(wired.pieces)}", len(wired.pieces) == spec.count)
    tolerance = engineering(spec.tolerance, unit)
    products = [x for x in wired.products if x.begin >= settled]
    for whose, errors in (
        ("on the true axis", [x.error for x in products]),
        ("as recorded", [x.recorded or 0.0 for x in products]),
    ):
        expected = f"products within {tolerance} of their ordered length {whose}, once in sync"
        yield _check_worst(expected, errors, spec.tolerance, unit, "product")


def _check_worst(expected: str, errors: list[float], tolerance: float, unit: str, what: str) -> Check:
    if not errors:
        return Check(expected, f"no {what}", False)
    worst = max(map(abs, errors))
    return Check(
        expected, f"at most {engineering(worst, unit, digits=3)} away in {len(errors)} {what}s", worst <= tolerance
    )
