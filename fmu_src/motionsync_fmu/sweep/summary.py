"""Counts the runs of a sweep by their results."""

from dataclasses import asdict, dataclass

import pyarrow.compute as pc

from .table import Rows

PASSED, REFUSED, LIMITS, FAULT = "passed", "refusal", "limits_broken", "fault"


@dataclass
class Summary:
    """How many runs there are, and how many of them failed in which way.

    Attributes:
        passed: all was as the scenario expects.
        unexpected: something was not.
        refused: a start value or a step was refused.
        limits_broken: the slave exceeded a limit of its axis; None: the block has none.
        faults: the block showed a fault; None: it shows none.
    """

    runs: int = 0
    passed: int = 0
    unexpected: int = 0
    refused: int = 0
    limits_broken: int | None = None
    faults: int | None = None

    def as_json(self) -> dict[str, int | None]:
        """All of it, by its names."""
        return asdict(self)

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
    names = [name for name in (PASSED, REFUSED, LIMITS, FAULT) if name in rows.schema.names]
    result = Summary(limits_broken=0 if LIMITS in names else None, faults=0 if FAULT in names else None)
    for batch in rows.batches(names):
        refused = pc.not_equal(batch[REFUSED], "")
        result.runs += batch.num_rows
        result.refused += _count(refused)
        result.passed += _count(batch[PASSED])
        if result.limits_broken is not None:
            result.limits_broken += _count(pc.not_equal(batch[LIMITS], ""))
        if result.faults is not None:
            result.faults += _count(pc.not_equal(batch[FAULT], 0))
    result.unexpected = result.runs - result.passed - result.refused
    return result


def _count(true: object) -> int:
    """How many are true; what is missing is not."""
    return int(pc.sum(true).as_py() or 0)
