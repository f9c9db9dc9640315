"""Tells on the error stream what is being done: before it is done, and again and again while it lasts."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

from .console import err

BEAT = 1.5  # s between two signs of life
PATIENCE = 1.0  # s; what takes less need not be told


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
