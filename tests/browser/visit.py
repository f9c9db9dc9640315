"""One page in the browser, and what a test asks of it."""

from pathlib import Path
from typing import Any

ABORTED = "net::ERR_ABORTED"
MACHINE_IS_SHOWN = "() => !document.querySelector('.motionsync-machine:not([hidden]):not([data-time])')"
"""A JavaScript expression: the page has drawn the machine that it has, if it has one."""

READOUTS = """Object.fromEntries([...document.querySelectorAll('.motionsync-machine .readouts div')]
  .map((row) => [...row.children].map((part) => part.innerText)))"""
"""A JavaScript expression: what the machine shows, by name."""


class Visit:
    """A page that has been opened.

    Attributes:
        page: Playwright's page, which is a window of the browser.
        messages: the page's console messages of any level, its errors and its failed requests, as texts.
        asked: the addresses that it has asked for.
        is_spoilt: whether the window is not as a new one for the next page.
    """

    def __init__(self, page: Any, file: Path) -> None:
        self.page, self.file, self.is_spoilt = page, file, False
        self.messages: list[str] = []
        self.asked: list[str] = []
        self._listeners = {
            "console": lambda message: self.messages.append(f"{message.type}: {message.text}"),
            "pageerror": lambda error: self.messages.append(f"error: {error}"),
            "requestfailed": self._note_failure,
            "request": lambda request: self.asked.append(request.url),
        }
        for event, listener in self._listeners.items():
            page.on(event, listener)
        self.load()

    def load(self) -> None:
        """Load the file, for the first time or anew."""
        self.page.goto(self.file.as_uri())
        self.page.wait_for_function(MACHINE_IS_SHOWN)

    def end(self) -> None:
        """Leave an empty window."""
        for event, listener in self._listeners.items():
            self.page.remove_listener(event, listener)
        self.page.goto("about:blank")

    def _note_failure(self, request: Any) -> None:
        if request.failure != ABORTED:  # as a request is that the next page has overtaken
            self.messages.append(f"failed: {request.url}")

    def show(self, t: float) -> None:
        """Stop the machine, and show it at a time, in s."""
        self.page.evaluate("t => window.motionsyncMachine.show(t)", t)

    def seen(self, times: list[float], look: str) -> list[Any]:
        """What a JavaScript expression gives at each of these times of the machine, in s, one after the other: in one
        call, since each takes longer than the picture."""
        show = f"times => times.map((t) => {{ window.motionsyncMachine.show(t); return {look}; }})"
        return list(self.page.evaluate(show, times))

    def freeze(self) -> None:
        """From now on the browser's own time goes on by `wait` alone."""
        self.is_spoilt = True
        self.page.clock.install(time=0)
        self.page.clock.pause_at(1000)

    def wait(self, milliseconds: int) -> None:
        """Let the browser's own time go on."""
        self.page.clock.run_for(milliseconds)

    @property
    def time(self) -> float:
        """The time of the machine that is shown, in s."""
        return float(self.page.locator(".motionsync-machine").get_attribute("data-time"))

    def number(self, selector: str, name: str) -> float:
        """A number in the data attributes of an element of the machine."""
        return float(self.page.locator(f".motionsync-machine {selector}").get_attribute(f"data-{name}"))

    def readout(self, name: str) -> str:
        """What the machine shows under a name."""
        return str(self.page.evaluate(READOUTS)[name])

    def allow(self, *permissions: str) -> None:
        """Let the page do what a browser asks its user about."""
        self.is_spoilt = True
        self.page.context.grant_permissions(permissions)

    def listen(self) -> None:
        """Store the notifications of time in `window.notifiedTimes`, as pairs of source and time."""
        self.page.evaluate(
            "() => { window.notifiedTimes = [];"
            " document.addEventListener('motionsync:time', e =>"
            " notifiedTimes.push([e.detail.source, e.detail.time])); }"
        )

    def notified_times(self) -> list[list[Any]]:
        """The notifications of time since `listen`."""
        return list(self.page.evaluate("notifiedTimes"))

    def colours(self, selector: str) -> tuple[str, str]:
        """The colour of an element's text and of its background."""
        look = "e => [getComputedStyle(e).color, getComputedStyle(e).backgroundColor]"
        text, ground = self.page.locator(selector).first.evaluate(look)
        return text, ground

    def overflow(self) -> float:
        """By how many px the page is wider than its window."""
        return float(self.page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))


def choose(visit: Visit, scenario: str) -> None:
    """Choose a scenario on the page of a block."""
    visit.page.get_by_label("Run", exact=True).select_option(scenario)
    settle(visit)


def settle(visit: Visit) -> None:
    """Wait until what was changed on the page of a block has been run and drawn."""
    visit.page.evaluate("new Promise(done => requestAnimationFrame(() => setTimeout(done, 0)))")


def contrast(text: str, ground: str) -> float:
    """The contrast of two colours, 1 to 21, as WCAG 2 has it."""

    def luminance(colour: str) -> float:
        parts = [float(c) / 255.0 for c in colour.removeprefix("rgb(").rstrip(")").split(",")[:3]]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(text), luminance(ground)))
    return (high + 0.05) / (low + 0.05)
