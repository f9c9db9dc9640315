"""A histogram with the normal distribution of the same mean and sigma, and the tolerance."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import erf, sqrt
from typing import Any

import numpy as np

from ...scenario.engineering import ROUNDING, engineering
from ...scenario.recording import Reals
from ..numbers import rounded
from ..style import with_unit
from .chart import BAD, INK, LIMIT, OK, SLAVE, Chart

MOST_BARS, LEAST_BARS = 40, 5
BEYOND = 0.25  # of the tolerance: so far behind it the histogram goes on where no value is
EQUAL = 0.02  # of the greatest magnitude: what the bars of equal values span
SPACE = 1.15  # of the highest bar: above it are the texts at the tolerance
REACH, CURVE = 5.0, 200  # how far the normal curve is drawn in detail, in sigma on both sides; by so many points


@dataclass(frozen=True)
class Histogram:
    """What a histogram shows.

    Attributes:
        what: the quantity on the horizontal axis.
        unit: its unit.
        counted: what is counted, in the plural: pieces.
        borders: those of the bars, of equal width; shape (bars + 1,).
        counts: how many there are in each bar.
        mean, sigma: of all values.
        tolerance: how far a value may be from 0; None: there is no tolerance.
    """

    what: str
    unit: str
    counted: str
    borders: Reals
    counts: Sequence[int]
    mean: float
    sigma: float
    tolerance: float | None = None

    def chart(self, name: str, height: int) -> Chart:
        """The chart; its first trace has the bars. `name`: what it shows; `height`: in px."""
        ends = (float(self.borders[0]), float(self.borders[-1]))
        if self.tolerance is not None:
            reach = max(*map(abs, ends), self.tolerance * (1.0 + BEYOND))
            ends = (-reach, reach)
        chart = Chart(name, [height], with_unit(self.what, self.unit), ends, hover="closest", timed=False)
        chart.write_title(1, self.counted)
        self._draw_bars(chart)
        if self.sigma > 0.0:
            self._draw_normal_curve(chart)
        if self.tolerance is not None:
            for limit in (-self.tolerance, self.tolerance):
                chart.draw_vertical_line(limit, engineering(limit, self.unit), LIMIT)
        chart.axis(1)["rangemode"] = "tozero"
        chart.include(1, SPACE * max(self.counts))
        return chart

    def _draw_bars(self, chart: Chart) -> None:
        middles = 0.5 * (self.borders[1:] + self.borders[:-1])
        texts = [
            f"{engineering(low, self.unit)} to {engineering(high, self.unit)}"
            for low, high in zip(self.borders[:-1].tolist(), self.borders[1:].tolist(), strict=True)
        ]
        width = float(self.borders[1] - self.borders[0])
        bars: dict[str, Any] = {"type": "bar", "x": rounded(middles, 9), "y": list(self.counts), "width": width}
        colours = [self._colour(middle) for middle in middles.tolist()]
        bars |= {"marker": {"color": colours}, "hovertext": texts}
        template = f"%{{y}} {self.counted}: %{{hovertext}}<extra></extra>"
        chart.add_trace(1, "", bars | {"hovertemplate": template, "meta": self.counted}, legend=False)

    def _colour(self, middle: float) -> str:
        if self.tolerance is None:
            return SLAVE
        return BAD if abs(middle) > self.tolerance else OK

    def _draw_normal_curve(self, chart: Chart) -> None:
        """Draw how many values a bar around each place would have on average."""
        around = np.clip(
            np.linspace(self.mean - REACH * self.sigma, self.mean + REACH * self.sigma, CURVE), *chart.span
        )
        x = np.concatenate([chart.span[:1], around, chart.span[1:]])
        half = 0.5 * float(self.borders[1] - self.borders[0])
        scaled = (np.stack([x - half, x + half]) - self.mean) / (sqrt(2.0) * self.sigma)
        below, until = (np.array([0.5 * (1.0 + erf(value)) for value in row]) for row in scaled.tolist())
        line = {"type": "scatter", "mode": "lines", "hoverinfo": "skip", "line": {"color": INK, "width": 1.4}}
        expected = sum(self.counts) * (until - below)
        chart.add_trace(1, "normal distribution", line | {"x": rounded(x), "y": rounded(expected, 4)})


def bar_borders(least: float, greatest: float, count: int, reach: float) -> Reals:
    """Those of bars of equal width, one of which has its middle at 0; about as many bars as the root of the count.

    `reach`: the magnitude that counts where all values are equal, to rounding."""
    spread = greatest - least
    if spread <= ROUNDING * max(abs(least), abs(greatest)):
        spread = EQUAL * reach or 1.0
    width = spread / min(max(LEAST_BARS, round(sqrt(count))), MOST_BARS)
    first, last = (int(np.floor(x / width + 0.5)) for x in (least, greatest))
    return np.asarray((np.arange(first, last + 2) - 0.5) * width, np.float64)
