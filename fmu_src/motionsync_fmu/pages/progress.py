"""Reports what a command does, before it is done and repeatedly while it lasts: on the error stream, or below the cell
of a notebook."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from threading import Event, Thread
from time import monotonic
from typing import Any

from rich.progress import BarColumn, Progress, TextColumn

from .console import err

DOT_INTERVAL = 1.5  # s between two signs of life
PATIENCE = 1.0  # s; what takes less need not be reported
LINE_INTERVAL = 10.0  # s between two lines of a count
CELL_INTERVAL = 0.5  # s between two counts in a cell, where each takes the place of the one before


def in_notebook() -> bool:
    """Whether this process runs the cells of a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


@contextmanager
def report_progress(task: str, *, at_once: bool = True) -> Iterator[Callable[[str], None]]:
    """Report the task that is done inside; the function that is yielded reports a part of it.

    On a terminal and in a notebook this is a line that moves, and vanishes at the end. Elsewhere (a pipe, a log) it is
    a line that gains a dot each DOT_INTERVAL; unless it is to appear `at_once`, it is left out if the task is done
    within PATIENCE."""
    if err.is_terminal:
        with err.status(task) as status:
            yield lambda text: status.update(f"{task}: {text}")
        return
    line = _CellLine(task) if in_notebook() else _DottedLine(task)
    if at_once:
        line.start()
    stop = Event()
    dots = Thread(target=_add_dots, args=(line, stop), daemon=True)
    dots.start()
    try:
        yield line.add_part
    finally:
        stop.set()
        dots.join()
        line.end()


@dataclass
class CountReport:
    """Reports how many of something are done, how fast that goes, and how long the rest takes.

    Attributes:
        unit: what is counted.
        notify: reports a line of text in between.
        show: shows how many are done, of how many, and the same as a text with rate and time left.
    """

    unit: str
    notify: Callable[[str], None]
    show: Callable[[int, int, str], None]
    first_call: tuple[float, int] | None = field(default=None, init=False)  # s, and how many were done then

    def __call__(self, done: int, total: int) -> None:
        """Report how many are done; those of the first call were done before."""
        now = monotonic()
        start, done_before = self.first_call = self.first_call or (now, done)
        text = f"{done:,} of {total:,} {self.unit}"
        if done > done_before and now > start:
            rate = (done - done_before) / (now - start)
            text += f", {rate:,.3g} {self.unit}/s, {duration((total - done) / rate)} left"
        self.show(done, total, text)


def duration(time: float) -> str:
    """A time (s) in everyday units: 12 s, 3 min 20 s, 5 h 7 min."""
    minutes, seconds = divmod(round(time), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours:,} h {minutes} min"
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


@contextmanager
def report_count(task: str, unit: str) -> Iterator[CountReport]:
    """Report how many of something are done inside: call what is yielded with the number done and the total.

    On a terminal this is a bar and in a notebook a line, which vanish at the end. Elsewhere it is a line each
    LINE_INTERVAL, with dots."""
    interval = CELL_INTERVAL if in_notebook() else LINE_INTERVAL
    if err.is_terminal:
        with Progress(TextColumn("{task.description}"), BarColumn(), console=err, transient=True) as bars:
            bar = bars.add_task(task, total=None)

            def update_bar(done: int, total: int, text: str) -> None:
                bars.update(bar, total=total, completed=done, description=text)

            yield CountReport(unit, err.print, update_bar)
        return
    with report_progress(task, at_once=False) as notify:
        last_line = monotonic()

        def show(_done: int, _total: int, text: str) -> None:
            nonlocal last_line
            if monotonic() - last_line >= interval:
                last_line = monotonic()
                notify(text)

        yield CountReport(unit, notify, show)


class _DottedLine:
    """A line of text that starts once and then gains dots."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.has_started = False

    def start(self) -> None:
        if not self.has_started:
            self.has_started = True
            err.print(f"{self.text} ..", end="")

    def add_dot(self) -> None:
        self.start()
        err.print(".", end="")

    def add_part(self, text: str) -> None:
        """Report a part of the task on a line of its own."""
        self.start()
        err.print(f"\n  {text} ..", end="")

    def end(self) -> None:
        if self.has_started:
            err.print()


class _CellLine:
    """The same as a line of text in the output of a notebook's cell; it vanishes at the end."""

    def __init__(self, task: str) -> None:
        self.task = self.text = task
        self.dots = 0
        self.handle: Any = None

    @property
    def has_started(self) -> bool:
        return self.handle is not None

    def start(self) -> None:
        if not self.has_started:
            display: Any = import_module("IPython.display").display  # a notebook has it
            self.handle = display(self._shown(self.text), raw=True, display_id=True)

    def add_dot(self) -> None:
        self.start()
        self.dots = self.dots % 3 + 1
        self.handle.update(self._shown(self.text + " " + "." * self.dots), raw=True)

    def add_part(self, text: str) -> None:
        """Show a part of the task in place of the one before."""
        self.start()
        self.text = f"{self.task}: {text}"
        self.handle.update(self._shown(self.text), raw=True)

    def end(self) -> None:
        if self.has_started:
            self.handle.update(self._shown(""), raw=True)

    @staticmethod
    def _shown(text: str) -> dict[str, str]:
        return {"text/plain": text}


def _add_dots(line: _DottedLine | _CellLine, stop: Event) -> None:
    if not line.has_started and not stop.wait(PATIENCE):
        line.start()
    while not stop.wait(DOT_INTERVAL):
        line.add_dot()
