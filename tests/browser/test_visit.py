"""A page that logs something, or asks for something, is noticed: without that the other tests would prove little."""

from pathlib import Path

import pytest

from tests.browser.conftest import Windows

LOUD = {
    "a message": "<script>console.debug('here')</script>",
    "an error": "<script>missing.there()</script>",
    "a file": "<img src=picture.png>",
    "an address": "<script src=https://example.com/library.js></script>",
}


@pytest.mark.parametrize("body", LOUD.values(), ids=LOUD)
def test_what_a_page_says_is_noticed(windows: Windows, tmp_path: Path, body: str) -> None:
    file = tmp_path / "page.html"
    file.write_text(f"<!doctype html><title>x</title>{body}", "utf-8")
    visit = windows.open(file)
    assert visit.messages
    windows.leave(visit)
