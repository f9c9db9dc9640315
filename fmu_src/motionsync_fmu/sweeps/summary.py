"""Counts the runs of a sweep by their results."""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import pyarrow.compute as pc

from ..scenario.engineering import engineering
from .database import Database
from .distribution import MOST, Distribution, find_distribution
from .result_columns import TRUE_LENGTH_ERRORS
from .table import Rows

PASSED, REFUSED, LIMITS, FAULT, UNMET = "passed", "refusal", "limits_broken", "fault", "first_broken"
SHOWN = 3  # reasons why runs are not as expected
MOST_REASONS = 1000  # that are counted; expectations with a number that varies are different ones


@dataclass
class Summary:
    """How many runs there are, and how many of them failed in which way.

    Attributes:
        passed: all was as the scenario expects.
        unexpected: something was not.
        refused: a start value or a step was refused.
        limits_broken: the slave exceeded a limit of its axis; None: the block has none.
        faults: the block showed a fault; None: it shows none.
        reasons: the expectations that were not met, each with the number of runs in which it was the first of them.
        true_length_errors: those of all pieces; None: none is known.
    """

    runs: int = 0
    passed: int = 0
    unexpected: int = 0
    refused: int = 0
    limits_broken: int | None = None
    faults: int | None = None
    reasons: dict[str, int] = field(default_factory=dict)
    true_length_errors: Distribution | None = None

    def as_json(self) -> dict[str, Any]:
        """All of it, by its names; true length errors only where there are any."""
        errors = self.true_length_errors
        others = asdict(replace(self, true_length_errors=None))
        del others[TRUE_LENGTH_ERRORS]
        return others | ({TRUE_LENGTH_ERRORS: errors.as_json()} if errors else {})

    @property
    def reason_lines(self) -> list[str]:
        """The most frequent reasons why runs are not as expected: `18 runs: number of pieces = 6`."""
        first = Counter(self.reasons).most_common(SHOWN)
        return [f"{number:,} run{'s' * (number != 1)}: {reason}" for reason, number in first]

    def true_length_lines(self, unit: str) -> Iterator[str]:
        """What the true lengths of all runs together say, a sentence each. `unit`: that of lengths."""
        if d := self.true_length_errors:
            low, high, worst, mean = (d.shown(x, unit) for x in (*map(d.quantile, MOST), d.worst, d.mean))
            sigma = f", sigma {d.shown(d.sigma, unit)}" if d.count > 1 else ""
            yield f"true lengths of {d.count:,} product{'s' * (d.count != 1)}: mean error {mean}{sigma}"
            yield f"99 % of them are between {low} and {high} off, the worst one {worst}"
            if c := d.capability:
                allowed = f"{c.outside:,} out of tolerance (+-{engineering(c.tolerance, unit)})"
                c_pk = f": C_pk {c.c_pk:.2f}" if math.isfinite(c.c_pk) else ""
                yield f"{allowed}{c_pk}{f', {c.interval}' if c.interval else ''}"

    def counts(self) -> dict[str, int]:
        """The numbers of runs by what happened to them, in words; without what does not apply."""
        words = {
            "as expected": self.passed,
            "NOT as expected": self.unexpected,
            "refused": self.refused,
            "with a limit broken": self.limits_broken,
            "with a fault": self.faults,
        }
        return {what: number for what, number in words.items() if number is not None}


def summarize(rows: Rows) -> Summary:
    """Count the runs in the rows of a sweep by their results; some rows are in memory at a time.

    Raises:
        UserError: a part file is damaged.
    """
    names = [name for name in (PASSED, REFUSED, LIMITS, FAULT, UNMET) if name in rows.schema.names]
    result = Summary(limits_broken=0 if LIMITS in names else None, faults=0 if FAULT in names else None)
    for batch in rows.batches(names):
        refused = pc.not_equal(batch[REFUSED], "")
        result.runs += batch.num_rows
        result.refused += _count(refused)
        result.passed += _count(batch[PASSED])
        for reason, number in _reasons(batch[UNMET]).items():
            if reason in result.reasons or len(result.reasons) < MOST_REASONS:
                result.reasons[reason] = result.reasons.get(reason, 0) + number
        if result.limits_broken is not None:
            result.limits_broken += _count(pc.not_equal(batch[LIMITS], ""))
        if result.faults is not None:
            result.faults += _count(pc.not_equal(batch[FAULT], 0))
    if TRUE_LENGTH_ERRORS in rows.schema.names:
        result.true_length_errors = find_distribution(Database(rows.folder, rows.files, ()), TRUE_LENGTH_ERRORS)
    result.unexpected = result.runs - result.passed - result.refused
    return result


def _reasons(unmet: object) -> dict[str, int]:
    """The expectations, without what was found, and how often each is there; without empty and missing texts."""
    expected = pc.replace_substring_regex(unmet, pattern=": found .*", replacement="")
    counted = pc.value_counts(expected).to_pylist()
    return {c["values"]: c["counts"] for c in counted if c["values"]}


def _count(true: object) -> int:
    """How many are true; what is missing is not."""
    return int(pc.sum(true).as_py() or 0)
