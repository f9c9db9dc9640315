"""What a reader sees of a chart: its legend, its scale, the texts next to the pointer, its cursor."""

import re
from typing import Any

from tests.browser.visit import Visit

FRAME = ".plot[aria-label^='{}']"


class ChartView:
    """A chart of a page, located by the beginning of its label for screen readers."""

    def __init__(self, visit: Visit, name: str) -> None:
        self.visit = visit
        self.frame = visit.page.locator(FRAME.format(name))
        self.frame.locator(".main-svg").first.wait_for()

    @property
    def traces(self) -> int:
        """The number of lines and bars that are drawn."""
        return int(self.frame.locator(".trace").count())

    @property
    def legend(self) -> list[str]:
        """The names in the legend."""
        return list(self.frame.locator(".legend .legendtext").evaluate_all("all => all.map(e => e.textContent)"))

    @property
    def texts(self) -> list[str]:
        """All texts of the chart: title, legend, numbers at the axes, notes."""
        return [text for text, *_ in self._boxes()]

    def hidden_texts(self) -> list[str]:
        """The texts that are cut off at the chart's border, and those that lie on another one."""
        frame = self.frame.bounding_box()
        boxes = self._boxes()
        hidden = [
            text
            for text, left, right, top, bottom in boxes
            if left < frame["x"] - 0.5
            or right > frame["x"] + frame["width"] + 0.5
            or top < frame["y"] - 0.5
            or bottom > frame["y"] + frame["height"] + 0.5
        ]
        for i, (text, left, right, top, bottom) in enumerate(boxes):
            for other, other_left, other_right, other_top, other_bottom in boxes[:i]:
                if left < other_right and other_left < right and top < other_bottom and other_top < bottom:
                    hidden.append(f"{text} on {other}")
        return hidden

    def _boxes(self) -> list[tuple[str, float, float, float, float]]:
        """Each text that is drawn, with left, right, top and bottom in px of the window; without the margins above and
        below the letters of a line."""
        shown = "e => e.textContent && e.getClientRects().length && !e.closest('.hoverlayer')"
        read = f"""all => all.filter({shown}).map(e => {{
            const b = e.getBoundingClientRect(), margin = 0.2 * b.height;
            return [e.textContent, b.left, b.right, b.top + margin, b.bottom - margin];
        }})"""
        return [tuple(box) for box in self.frame.locator(".main-svg text").evaluate_all(read)]

    def scale(self) -> tuple[float, float]:
        """Where 0 s is, in px of the window, and how many px a second has: from two numbers below the chart."""
        read = "all => all.map(e => [e.textContent, e.getBoundingClientRect().x + e.getBoundingClientRect().width / 2])"
        ticks = self.frame.locator(".xtick text").evaluate_all(read)
        (first, left), (last, right) = ticks[0], ticks[-1]
        pixels = (right - left) / (float(last) - float(first))
        return left - pixels * float(first), pixels

    def point(self, time: float) -> list[str]:
        """Move the pointer to a time; return the texts next to it, the time first."""
        self.frame.scroll_into_view_if_needed()
        zero, pixels = self.scale()
        box = self.frame.locator(".nsewdrag").first.bounding_box()
        self.visit.page.mouse.move(zero + pixels * time + 3, box["y"] + 0.5 * box["height"])
        self.visit.page.mouse.move(zero + pixels * time, box["y"] + 0.5 * box["height"], steps=3)
        texts = self.frame.locator(".hoverlayer text")
        texts.first.wait_for()
        return list(texts.evaluate_all("all => all.map(e => e.textContent)"))

    def hover_values(self, time: float) -> tuple[float, dict[str, float]]:
        """What the pointer shows at a time: the time in s, and values by their names."""
        title, *texts = self.point(time)
        pairs = [
            re.fullmatch(r"(.+?) : (-?[\d.e+-]+|-?[\d.]+[kMGmµun]?).*", t.replace("\N{MINUS SIGN}", "-")) for t in texts
        ]
        return float(title.removesuffix(" s")), {p[1]: float(p[2]) for p in pairs if p}

    @property
    def cursor(self) -> float | None:
        """The time at which the cursor is, in s; None: it is invisible."""
        line = self.frame.locator(".cursor")
        if not line.count() or not line.is_visible():
            return None
        zero, pixels = self.scale()
        box: Any = line.bounding_box()
        return float((box["x"] + box["width"] / 2 - zero) / pixels)
