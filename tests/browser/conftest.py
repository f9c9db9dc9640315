"""A real browser: Debian's Chromium, without a screen and without a network, driven by Playwright."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.browser.visit import Visit

SWITCHES = ["--no-sandbox", "--disable-gpu", "--force-color-profile=srgb", "--font-render-hinting=none"]

Open = Callable[..., Visit]
"""Opens a page: `open_page(file, width=1100, **options)`, the options being those of a Playwright context."""


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("there is no Chromium: apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=SWITCHES)
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium: Any) -> Iterator[Open]:
    """Opens pages; at the end none of them has said anything, or asked for anything outside its own folder."""
    visits: list[Visit] = []

    def opened(file: Path, width: int = 1100, **options: Any) -> Visit:
        context = chromium.new_context(viewport={"width": width, "height": 900}, offline=True, **options)
        visits.append(Visit(context, file))
        return visits[-1]

    yield opened
    messages = [visit.messages for visit in visits]
    strange = [uri for visit in visits for uri in visit.asked if not uri.startswith(visit.file.parent.as_uri())]
    for visit in visits:
        visit.context.close()
    assert messages == [[] for _ in visits]
    assert strange == []
