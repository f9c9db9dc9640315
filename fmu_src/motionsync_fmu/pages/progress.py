"""Tells on the error stream what is being done: before it is done, and again and again while it lasts."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Event, Thread
from time import monotonic

from rich.progress import BarColumn, Progress, TextColumn

from .console import err

BEAT = 1.5  # s between two signs of life
PATIENCE = 1.0  # s; what takes less need not be told
LINE = 10.0  # s between two lines of a count


@contextmanager
def doing(what: str, *, at_once: bool = True) -> Iterator[Callable[[str], None]]:
    """Tell what is done inside; the function that is given tells a part of it.

    On a terminal this is a line that moves, and vanishes at the end. Elsewhere (a pipe, a log) it is a line that gains
    a dot with each BEAT; unless it is to come `at_once`, it is left out if all is done within PATIENCE."""
    if err.is_terminal:
        with err.status(what) as status:
            yield lambda text: status.update(f"{what}: {text}")
        return
    line = _Line(what)
    if at_once:
        line.begin()
    stop = Event()
    beats = Thread(target=_beat, args=(line, stop), daemon=True)
    beats.start()
    try:
        yield line.tell
    finally:
        stop.set()
        beats.join()
        line.end()


@dataclass
class Count:
    """How many of something are done, how fast that goes, and how long the rest takes.

    Attributes:
        unit: what is counted.
        tell: tells a line between.
        show: shows how many are done, of how many, and the same as a text with rate and time left.
    """

    unit: str
    tell: Callable[[str], None]
    show: Callable[[int, int, str], None]
    begun: tuple[float, int] | None = field(default=None, init=False)  # s, and how many were done then

    def __call__(self, done: int, whole: int) -> None:
        """Tell that so many are done; those of the first call were done before."""
        now = monotonic()
        begin, before = self.begun = self.begun or (now, done)
        text = f"{done:,} of {whole:,} {self.unit}"
        if done > before and now > begin:
            rate = (done - before) / (now - begin)
            text += f", {rate:,.3g} {self.unit}/s, {duration((whole - done) / rate)} left"
        self.show(done, whole, text)


def duration(time: float) -> str:
    """A time (s) as people say it: 12 s, 3 min 20 s, 5 h 7 min."""
    minutes, seconds = divmod(round(time), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours:,} h {minutes} min"
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


@contextmanager
def counting(what: str, unit: str) -> Iterator[Count]:
    """Tell how many of something are done inside: call what is given with the number, and with that of all.

    On a terminal this is a bar, which vanishes at the end. Elsewhere it is a line every LINE seconds, with dots."""
    if err.is_terminal:
        with Progress(TextColumn("{task.description}"), BarColumn(), console=err, transient=True) as bars:
            bar = bars.add_task(what, total=None)

            def move(done: int, whole: int, text: str) -> None:
                bars.update(bar, total=whole, completed=done, description=text)

            yield Count(unit, err.print, move)
        return
    with doing(what, at_once=False) as tell:
        told = monotonic()

        def show(done: int, whole: int, text: str) -> None:
            nonlocal told
            if monotonic() - told >= LINE:
                told = monotonic()
                tell(text)

        yield Count(unit, tell, show)


class _Line:
    """A line that is begun once and gains dots."""

    def __init__(self, what: str) -> None:
        self.what = what
        self.begun = False

    def begin(self) -> None:
        if not self.begun:
            self.begun = True
            err.print(f"{self.what} ..", end="")

    def dot(self) -> None:
        self.begin()
        err.print(".", end="")

    def tell(self, text: str) -> None:
        """Tell a part on a line of its own."""
        self.begin()
        err.print(f"\n  {text} ..", end="")

    def end(self) -> None:
        if self.begun:
            err.print()


def _beat(line: _Line, stop: Event) -> None:
    if not line.begun and not stop.wait(PATIENCE):
        line.begin()
    while not stop.wait(BEAT):
        line.dot()
