"""The page in an FMU, in a real browser."""

from pathlib import Path

import pytest

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import PLATFORMS
from motionsync_fmu.pages.block_page import FmuContents, make_pages
from tests.browser.conftest import Open


@pytest.fixture
def file(block: str, tmp_path: Path) -> Path:
    """The page of each block in turn."""
    return page_of(block, tmp_path)


def page_of(block: str, folder: Path) -> Path:
    """A block's page with its picture."""
    contents = FmuContents(Recipe(block), "native", list(PLATFORMS))
    for name, content in make_pages(contents).items():
        (folder / name).write_bytes(content)
    return folder / "index.html"


def test_the_page_has_its_title_its_picture_and_the_width_of_its_window(
    open_page: Open, file: Path, block: str
) -> None:
    """It has no scripts, so a window that becomes narrower shows what one of that width would."""
    visit = open_page(file, 1152)
    page = visit.page
    assert page.locator("script").count() == 0
    assert page.locator("h1").first.inner_text() == block
    assert page.locator("figure img").evaluate_all("all => all.map(e => e.complete && e.naturalWidth > 0)") == [True]
    hidden = "[...document.querySelectorAll('table')].map(t => t.scrollWidth - t.clientWidth)"
    widths = page.evaluate(hidden)
    assert len(widths) >= 4
    assert max(widths) <= 0  # every table is seen whole
    for width in (1152, 800, 400):
        page.set_viewport_size({"width": width, "height": 900})
        assert visit.overflow() == 0.0


def test_a_plot_of_characters_has_its_lines(open_page: Open, tmp_path: Path) -> None:
    plot = open_page(page_of("FlyingSaw", tmp_path)).page.locator("pre")
    assert plot.inner_text().splitlines()[0] == "T_a + T_b"
    assert plot.bounding_box()["height"] > 12 * 14  # twelve lines
