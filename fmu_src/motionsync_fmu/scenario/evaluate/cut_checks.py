"""Checks the cuts or pieces of a run: their number, which are missing or late, their lengths, and the tool in the cut.

What every run has to fulfil is among the checks only if it does not, or if the scenario's table [cuts] says something
of it.
"""

import math
from collections.abc import Iterator

from motionsync.var import Unit

from ...interface.units import unit_name
from ..engineering import engineering
from ..recording import greatest_position
from .cuts import uncut_text
from .cutting_results import CuttingResults
from .expectations import Check
from .production import Production
from .true_pieces import UNSEEN, allowed_movement


def check_number(results: CuttingResults) -> Iterator[Check]:
    """How many cuts or pieces there are, of which kinds, and how many orders are left."""
    scenario, production = results.scenario, results.production
    if (cuts := scenario.cuts) and cuts.count is not None:
        yield Check(f"number of cuts = {cuts.count}", f"{len(results.cuts)}", len(results.cuts) == cuts.count)
    spec = scenario.pieces
    if not spec or not production:
        return
    if spec.count is not None:
        yield Check(f"number of pieces = {spec.count}", f"{production.cuts}", production.cuts == spec.count)
    if spec.kinds is not None:
        kinds = tuple(piece.name for piece in production.pieces)
        yield Check(
            f"kinds of the pieces = {', '.join(spec.kinds)}", ", ".join(kinds) or "no piece", kinds == spec.kinds
        )
    if spec.orders_left is not None:
        left = orders_left(results)
        yield Check(f"number of orders left at the end = {spec.orders_left}", f"{left}", left == spec.orders_left)


def orders_left(results: CuttingResults) -> int:
    """How many orders are left at the end of a run; 0 for a block without orders."""
    names = results.scenario.recipe.piece_variables
    return int(results.recording.values[names.orders][-1]) if names else 0


def check_missed(results: CuttingResults) -> Iterator[Check]:
    """Whether a cut was skipped or late, or a mark passed uncut. Each piece of the kind MERGED lacks a cut at least."""
    scenario, production = results.scenario, results.production
    if production:
        skipped, late = (scenario.pieces.skipped, scenario.pieces.late) if scenario.pieces else (0, 0)
        yield Check(f"number of skipped cuts = {skipped}", f"{production.skipped}", production.skipped == skipped)
        if late or production.late:
            yield Check(f"number of late cuts = {late}", f"{production.late}", production.late == late)
    if (spec := scenario.cuts) and (spec.skipped or results.missed_marks):
        missed = results.missed_marks
        actual = uncut_text(missed, unit_name(Unit.POSITION, scenario.unit)) or "0"
        expected = f"number of marks that pass uncut after the first cut = {spec.skipped}"
        yield Check(expected, actual, len(missed) == spec.skipped)


def check_lengths(results: CuttingResults) -> Iterator[Check]:
    """How far cuts are from their marks, and pieces from their lengths: as reported, by the positions of slave and
    material, and as a tape measure finds them."""
    if results.scenario.cuts:
        yield from _check_marks(results)
    if production := results.production:
        yield from _check_products(results, production)
    if (true := results.true_pieces) and true.pieces:
        worst = abs(true.worst)
        off = f"at most {engineering(worst, true.unit, scale=greatest_position(results.recording), digits=3)} off"
        expected = f"true lengths of products as ordered, within {engineering(true.tolerance, true.unit)}"
        yield Check(expected, off, worst <= true.tolerance)


def _check_marks(results: CuttingResults) -> Iterator[Check]:
    spec, cuts, unit = results.scenario.cuts, results.cuts, unit_name(Unit.POSITION, results.scenario.unit)
    assert spec
    if cuts or spec.count != 0:
        worst = max((abs(c.error) for c in cuts), default=math.inf)
        allowed, length = engineering(spec.tolerance, unit), engineering(spec.length, unit)
        distance = f"at most {engineering(worst, unit, scale=greatest_position(results.recording), digits=3)} away"
        expected = f"cuts within {allowed} of a mark, one mark each {length}"
        yield Check(expected, distance if cuts else "no cut", worst <= spec.tolerance)


def _check_products(results: CuttingResults, production: Production) -> Iterator[Check]:
    spec, tolerance = results.scenario.pieces, production.tolerance
    allowed = engineering(tolerance, production.unit)
    if spec and spec.lengths is not None:
        yield _compare_lengths(spec.lengths, production)
    elif production.products or (spec and spec.count != 0 and not production.pieces):
        worst = max((abs(piece.error) for piece in production.products), default=math.inf)
        off = f"at most {production.worst_text} off" if production.products else "no piece"
        if spec or worst > tolerance:
            yield Check(f"products as long as ordered, within {allowed}", off, worst <= tolerance)
    measured = [abs(p.measured - p.length) for p in production.pieces if p.measured is not None]
    if measured and not results.true_pieces and (spec or max(measured) > tolerance):
        off = f"at most {engineering(max(measured), production.unit, scale=production.scale, digits=3)} off"
        expected = f"pieces as long as they are reported, within {allowed}, by the positions of slave and material"
        yield Check(expected, off, max(measured) <= tolerance)


def _compare_lengths(lengths: tuple[float, ...], production: Production) -> Check:
    """Whether there are pieces of these lengths, in this order."""
    expected = f"{len(lengths)} lengths, each within {engineering(production.tolerance, production.unit)}"
    if len(lengths) != len(production.pieces):
        return Check(expected, f"{len(production.pieces)} pieces", False)
    off = [abs(piece.length - length) for piece, length in zip(production.pieces, lengths, strict=True)]
    worst = max(off, default=0.0)
    text = f"at most {engineering(worst, production.unit, scale=production.scale, digits=3)} off"
    if worst > production.tolerance:
        piece, length = production.pieces[off.index(worst)], lengths[off.index(worst)]
        text = f"piece {piece.number} of {engineering(piece.length)} instead of {engineering(length, production.unit)}"
    return Check(expected, text, worst <= production.tolerance)


def check_movement(results: CuttingResults) -> Iterator[Check]:
    """How far the tool moves against the material while it cuts: truly, where that is known; else as the block sees it.

    Of a saw with marks the latter is part of the errors of the cuts."""
    production, true = results.production, results.true_pieces
    wander = [piece.wander for piece in production.pieces if piece.cut] if production else []
    if not true and not wander:
        return
    worst = true.movement if true else max(wander)
    tolerance = true.tolerance if true else production.tolerance if production else 0.0
    allowed, unit = allowed_movement(results.scenario, tolerance), unit_name(Unit.POSITION, results.scenario.unit)
    if results.scenario.pieces or results.scenario.cuts or worst > allowed:
        yield Check(
            f"the tool moves in the cut by at most {engineering(allowed, unit)}",
            UNSEEN
            if math.isnan(worst)
            else engineering(worst, unit, scale=greatest_position(results.recording), digits=3),
            worst <= allowed,
        )
