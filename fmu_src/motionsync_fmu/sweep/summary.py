"""What a sweep's rows come to, in a few numbers."""

from dataclasses import asdict, dataclass

import pyarrow.compute as pc

from .table import Rows

PASSED, REFUSED, LIMITS, FAULT = "passed", "refusal", "limits_broken", "fault"


@dataclass
class Summary:
    """How many runs there are, and of how many something is to be told.

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
        """What is told of the runs, in words, and of how many; without what does not apply."""
        words = {
            "as expected": self.passed,
            "NOT as expected": self.unexpected,
            "refused": self.refused,
            "with a limit broken": self.limits_broken,
            "with a fault": self.faults,
        }
        return {what: number for what, number in words.items() if number is not None}


def summary(rows: Rows) -> Summary:
    """What the rows of a sweep come to; a piece of them is in memory at a time.

    Raises:
        UserError: a part file is damaged.
    """
    there = [name for name in (PASSED, REFUSED, LIMITS, FAULT) if name in rows.schema.names]
    found = Summary(limits_broken=0 if LIMITS in there else None, faults=0 if FAULT in there else None)
    for batch in rows.batches(there):
        refused = pc.not_equal(batch[REFUSED], "")
        found.runs += batch.num_rows
        found.refused += _count(refused)
        found.passed += _count(batch[PASSED])
        if found.limits_broken is not None:
            found.limits_broken += _count(pc.not_equal(batch[LIMITS], ""))
        if found.faults is not None:
            found.faults += _count(pc.not_equal(batch[FAULT], 0))
    found.unexpected = found.runs - found.passed - found.refused
    return found


def _count(true: object) -> int:
    """How many are true; what is missing is not."""
    return int(pc.sum(true).as_py() or 0)
