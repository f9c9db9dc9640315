"""A real browser: Debian's Chromium, without a screen and without a network, driven by Playwright."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.pages.machine.fragment import machine
from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.pages.style import TEMPLATES
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from tests.browser.runs import run
from tests.browser.visit import Visit, choose
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.explored import explored, opens_with

# The shell is the same browser without windows of its own; it opens a page with half the work.
PROGRAMS = ["chromium-headless-shell", "chromium", "chromium-browser"]
SWITCHES = ["--no-sandbox", "--disable-gpu", "--force-color-profile=srgb", "--font-render-hinting=none"]

Open = Callable[..., Visit]
"""Opens a page: `open_page(file, ...)`, the rest as for `Windows.open`."""

OpenReport = Callable[..., Visit]
"""Opens the report of a scenario: `open_report(name, ...)`, the rest as for `open_page`."""

OpenMachine = Callable[..., Visit]
"""Opens the machine of a run on a page of its own: `open_machine(scenario, recording, ...)`, the rest as for
`open_page`."""

AtRest = Callable[[str], Visit]
"""The report of a scenario in a page that tests share: `at_rest(name)`."""

Chosen = Callable[..., Visit]
"""A scenario on the page of its block, which tests share: `chosen(name, scenario)`; by default the page's first one."""

OpenBlock = Callable[..., Visit]
"""Opens the page of a block: `open_block(name, scenario, ...)`, the rest as for `open_page`."""


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        pytest.skip("there is no Chromium: apt-get install chromium-headless-shell")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=SWITCHES)
        yield browser
        browser.close()


class Windows:
    """The windows of a browser. A new one, with a process of its own, costs more than many a page: one that a test has
    left serves the next test."""

    def __init__(self, browser: Any) -> None:
        self.browser = browser
        self.free: list[Any] = []

    def open(
        self, file: Path, width: int = 1100, color_scheme: str = "light", reduced_motion: str = "no-preference"
    ) -> Visit:
        """Open a page in a window so wide, in px, of a user with these wishes."""
        page = self.free.pop() if self.free else self.browser.new_context(offline=True).new_page()
        page.set_viewport_size({"width": width, "height": 900})
        page.emulate_media(media="screen", color_scheme=color_scheme, reduced_motion=reduced_motion)
        page.mouse.move(0, 0)
        return Visit(page, file)

    def leave(self, visit: Visit) -> None:
        """Take the window of a page back."""
        if visit.is_spoilt:
            visit.page.context.close()
        else:
            visit.end()
            self.free.append(visit.page)


@pytest.fixture(scope="session")
def windows(chromium: Any) -> Windows:
    return Windows(chromium)


@contextmanager
def opened_pages(windows: Windows) -> Iterator[Open]:
    """Opens pages; at the end none of them has said anything, or asked for anything outside its own folder."""
    visits: list[Visit] = []

    def opened(file: Path, *arguments: Any, **options: Any) -> Visit:
        visits.append(windows.open(file, *arguments, **options))
        return visits[-1]

    yield opened
    messages = [visit.messages for visit in visits]
    strange = [uri for visit in visits for uri in visit.asked if not uri.startswith(visit.file.parent.as_uri())]
    for visit in visits:
        windows.leave(visit)
    assert messages == [[] for _ in visits]
    assert strange == []


@pytest.fixture
def open_page(windows: Windows) -> Iterator[Open]:
    with opened_pages(windows) as opened:
        yield opened


@pytest.fixture(scope="session")
def report_file(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Writes the report of a scenario, once."""
    folder = tmp_path_factory.mktemp("reports")

    @cache
    def write(name: str) -> Path:
        s, recording = run(name)
        file = folder / name.replace("/", "_") / "report.html"
        file.parent.mkdir()
        results = file.parent / "out.csv"
        write_report(file, s, recording, evaluate_run(s, recording), results=results)
        return file

    return write


@pytest.fixture
def open_report(open_page: Open, report_file: Callable[[str], Path]) -> OpenReport:
    def opened(name: str, **options: Any) -> Visit:
        return drawn(open_page(report_file(name), **options))

    return opened


@pytest.fixture
def open_machine(open_page: Open, tmp_path: Path) -> OpenMachine:
    def opened(scenario: Scenario, recording: Recording, **options: Any) -> Visit:
        return open_page(write_machine(tmp_path / "machine.html", scenario, recording), **options)

    return opened


def write_machine(file: Path, scenario: Scenario, recording: Recording) -> Path:
    """Write a page with the machine of a run alone."""
    colours = (TEMPLATES / "colours.css").read_text("utf-8")
    head = f"<!doctype html><html lang=en><meta charset=utf-8><title>machine</title><style>{colours}</style>"
    file.write_text(f"{head}<body style='margin: 1rem'>{machine(scenario, recording)}</body></html>", "utf-8")
    return file


def drawn(report: Visit) -> Visit:
    """A report whose charts are drawn."""
    report.page.locator(".plot .main-svg").last.wait_for()
    return report


@pytest.fixture(scope="module")
def at_rest(windows: Windows, report_file: Callable[[str], Path]) -> Iterator[AtRest]:
    """`at_rest(name)`: a scenario's report, in a page that a module's tests share, since opening it costs more than
    most of them do. A test leaves it as it was, but for the time that is shown and what the pointer is over."""
    with opened_pages(windows) as open_page:

        @cache
        def opened(name: str) -> Visit:
            return drawn(open_page(report_file(name)))

        def rest(name: str) -> Visit:
            visit = opened(name)
            visit.page.mouse.move(0, 0)
            visit.show(0.0)
            return visit

        yield rest


@pytest.fixture(scope="module")
def chosen(windows: Windows, fmus: Fmus) -> Iterator[Chosen]:
    """`chosen(name, scenario)`: a scenario that has just been chosen on its block's page, in a window that a module's
    tests share: to choose takes an eighth of opening the page. The choice undoes what a test has set; for what else
    it does to the page, it opens one of its own."""
    with opened_pages(windows) as open_page:

        @cache
        def opened(name: str) -> Visit:
            return ready(open_page(explored(fmus, name).file))

        def choose_again(name: str, scenario: str = "") -> Visit:
            visit = opened(name)
            visit.page.mouse.move(0, 0)
            visit.show(0.0)
            choose(visit, scenario or opens_with(name))
            return visit

        yield choose_again


def ready(page: Visit) -> Visit:
    """The page of a block that can be used."""
    page.page.wait_for_selector("html[data-ready]")
    page.show(0.0)  # it begins to play
    return page


@pytest.fixture
def open_block(open_page: Open, fmus: Fmus) -> OpenBlock:
    def opened(name: str, scenario: str = "", width: int = 1100, **options: Any) -> Visit:
        visit = ready(open_page(explored(fmus, name).file, width, **options))
        if scenario:
            choose(visit, scenario)
        return visit

    return opened
