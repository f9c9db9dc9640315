"""What the functions show of what they do: in a notebook a line below the cell, which vanishes; elsewhere nothing."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ..fmus.prebuilt import Report, silent
from ..pages.progress import in_notebook, report_count, report_progress

Count = Callable[[int, int], None]
"""Called with the number of what is done, and of all."""


def shown(report: Report | None = None) -> Report:
    """What reports tasks: what the caller has given, or else what is shown here."""
    return report or (report_progress if in_notebook() else silent)


@contextmanager
def counted(progress: Count | None, task: str, unit: str) -> Iterator[Count]:
    """What is called with counts of a unit while a task is done inside: as for `shown`."""
    if progress or not in_notebook():
        yield progress or (lambda done, total: None)
        return
    with report_count(task, unit) as count:
        yield count
