"""The documentation site in a real browser, from its folder: no page complains, none is wider than its window."""

import pytest

from tests.browser.conftest import Windows
from tests.support.hosts.fmus import Fmus
from tests.support.project.site import made_site

WIDTHS = (1280, 390)


@pytest.mark.slow
def test_every_page_opens_without_a_message_and_fits_its_window(windows: Windows, fmus: Fmus) -> None:
    """In one window, which becomes narrow on each page, as a telephone's: the theme arranges a page by its width."""
    site = made_site(fmus)
    assert len(site.pages) > 30
    visit = windows.open(site.folder / "index.html", WIDTHS[0])
    wide = []
    for path in site.pages:
        visit.page.set_viewport_size({"width": WIDTHS[0], "height": 900})
        visit.page.goto((site.folder / path).as_uri())
        assert visit.page.locator("h1").count() == 1, path
        for width in WIDTHS:
            visit.page.set_viewport_size({"width": width, "height": 900})
            wide += [(path, width)] if visit.overflow() > 0.0 else []
    windows.leave(visit)
    assert wide == []
    assert visit.messages == []
    assert [uri for uri in visit.asked if not uri.startswith((site.folder.as_uri(), "data:", "blob:"))] == []


@pytest.mark.parametrize("path", ["tutorial/measured_line.html", "how_to/sweeps.html"])
def test_a_number_and_its_unit_are_on_one_line_of_a_table(windows: Windows, fmus: Fmus, path: str) -> None:
    visit = windows.open(made_site(fmus).folder / path, WIDTHS[0])
    broken = """all => all.filter((cell) => /^[-0-9.]+ [a-z]+$/.test(cell.textContent)).map((cell) => {
        const range = document.createRange();
        range.selectNodeContents(cell);
        return [cell.textContent, new Set(Array.from(range.getClientRects(), ({top}) => top)).size];
    })"""
    cells = visit.page.locator("td").evaluate_all(broken)
    windows.leave(visit)
    assert len(cells) > 3
    assert [text for text, lines in cells if lines > 1] == []


@pytest.mark.parametrize("block", ["Gearing", "RotaryKnife"])
def test_what_a_variable_means_has_some_width_on_a_telephone(windows: Windows, fmus: Fmus, block: str) -> None:
    visit = windows.open(made_site(fmus).folder / "reference" / "blocks" / f"{block}.html", WIDTHS[1])
    widths = visit.page.locator("th.meaning").evaluate_all("all => all.map((e) => e.clientWidth)")
    windows.leave(visit)
    assert min(widths) > 190  # px


def test_the_search_finds_a_word_without_a_server(windows: Windows, fmus: Fmus) -> None:
    site = made_site(fmus)
    visit = windows.open(site.folder / "how_to" / "simulink.html", WIDTHS[0])
    visit.page.locator("input.md-search__input").fill("diagonal_angle")
    result = visit.page.locator(".md-search-result__link").first
    result.wait_for()
    assert "/reference/blocks/" in result.get_attribute("href")
    windows.leave(visit)
    assert visit.messages == []


def test_the_first_page_moves_the_machine(windows: Windows, fmus: Fmus) -> None:
    """From there a link leads to the same run on a page of its own, whose address holds it."""
    site = made_site(fmus)
    visit = windows.open(site.folder / "index.html", WIDTHS[0])
    frame = visit.page.locator("iframe.explore")
    frame.scroll_into_view_if_needed()
    frame.content_frame.locator("html[data-ready]").wait_for()
    assert frame.content_frame.locator(".motionsync-machine").count() == 1
    assert not frame.content_frame.get_by_text("in the address of this page").is_visible()
    frame.content_frame.get_by_label("Run", exact=True).select_option("basic_cut")
    frame.content_frame.get_by_role("link", name="on a page of its own").click()
    visit.page.wait_for_url("**/explore/CutToLength.html#run=basic_cut")
    visit.page.locator("html[data-ready]").wait_for()
    assert visit.page.get_by_text("in the address of this page").is_visible()
    assert visit.page.get_by_label("Run", exact=True).input_value() == "basic_cut"
    windows.leave(visit)
    assert visit.messages == []


LONGEST_LINE = """() => {
  const all = [...document.querySelectorAll('article :is(p, li)')].filter(e => !e.closest('.highlight, table'));
  const longest = (e) => {
    const range = document.createRange(), lines = new Map(), walk = document.createTreeWalker(e, NodeFilter.SHOW_TEXT);
    for (let node; node = walk.nextNode();) {
      for (let i = 0; i < node.length; i++) {
        range.setStart(node, i);
        range.setEnd(node, i + 1);
        const box = range.getBoundingClientRect(), line = Math.round(box.bottom / 12);
        if (box.width) lines.set(line, (lines.get(line) ?? 0) + 1);
      }
    }
    return Math.max(0, ...lines.values());
  };
  return all.map(e => [longest(e), e.textContent.slice(0, 40)]);
}"""


@pytest.mark.parametrize("width", WIDTHS)
def test_the_first_page_says_who_it_is_for_and_has_the_machine_and_three_ways_on(
    windows: Windows, fmus: Fmus, width: int
) -> None:
    """All that before anything is scrolled on a wide screen; no line of text is longer than 75 characters."""
    site = made_site(fmus)
    visit = windows.open(site.folder / "index.html", width)
    page = visit.page
    page.set_viewport_size({"width": width, "height": 900})
    assert page.locator("h1 + p").first.inner_text().startswith("motionsync is for engineers who ")
    picture = page.locator("img[src$='first_picture.svg']").bounding_box()
    assert picture["y"] + picture["height"] < 900.0
    assert picture["width"] > 0.9 * min(width, 560) - 30.0
    ways = page.locator("article a.md-button")
    assert ways.evaluate_all("all => all.map(e => e.getAttribute('href'))") == [
        "#move-it-by-hand",
        "tutorial/first_cut.html",
        "how_to/wiring.html",
    ]
    boxes = [way.bounding_box() for way in ways.all()]
    assert all(box["y"] + box["height"] < (900.0 if width > 1000 else 1000.0) for box in boxes)
    lengths = page.evaluate(LONGEST_LINE)
    assert max(lengths)[0] <= 75, max(lengths)
    assert max(lengths)[0] > (60 if width > 1000 else 30)
    windows.leave(visit)
    assert visit.messages == []
