"""The first picture of README and site, in a browser: its machine moves."""

from typing import Any

import pytest

from tests import ROOT
from tools.first_picture import FILE


def test_it_moves_in_a_browser_unless_a_reader_prefers_no_motion(chromium: Any) -> None:
    """In the middle of the first cut the blade is in the line, and the cursor there; the page shows that at rest."""
    at = "name => document.querySelector(name).getBoundingClientRect().x"
    to = "t => document.getAnimations().forEach(a => { a.pause(); a.currentTime = t; })"
    places: dict[str, list[float]] = {}
    for preference in ("no-preference", "reduce"):
        page = chromium.new_page(viewport={"width": 640, "height": 470}, reduced_motion=preference)
        page.goto((ROOT / "docs" / FILE).as_uri())
        count = page.evaluate("document.getAnimations().length")
        assert count == (6 if preference == "no-preference" else 0)
        for share in (0.0, 0.675, 0.9):
            page.evaluate(to, 2000.0 * share)
            places.setdefault(preference, []).append(page.evaluate(at, ".saw"))
        page.close()
    moving, still = places.values()
    assert moving[0] < moving[1] < moving[2]
    assert still == pytest.approx([moving[1]] * 3, abs=0.5)
