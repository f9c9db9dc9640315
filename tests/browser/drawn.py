"""What is drawn of a machine, measured on the screen: px of the window, read from the elements themselves."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.browser.visit import Visit

READ = """() => {
  const root = document.querySelector('.motionsync-machine');
  const boxes = (selector) => [...root.querySelectorAll(selector)]
    .filter((e) => e.getAttribute('visibility') !== 'hidden')
    .map((e) => { const b = e.getBoundingClientRect(); return [b.left, b.right, b.top, b.bottom]; });
  const number = (text) => Number(text.replace('\\u2212', '-'));
  const labels = '.ground text.soft[text-anchor=middle]', places = boxes(labels);
  const ruler = [...root.querySelectorAll(labels)].map((e, i) => [number(e.textContent), places[i]]);
  return {
    time: +root.dataset.time,
    blade: boxes('.tool path')[0],
    saw: boxes(".carriage rect[rx='5']")[0],
    bodies: boxes('.stock rect').sort((a, b) => a[0] - b[0]),
    grain: boxes(".stock path[stroke='var(--grain)']"),
    marks: [...root.querySelectorAll('.stock path[data-mark]')].filter((e) => e.getAttribute('visibility') !== 'hidden')
      .map((e) => [+e.dataset.mark, e.getBoundingClientRect().left]),
    ruler: ruler.map(([value, [left, right]]) => [value, (left + right) / 2]),
  };
}"""


@dataclass(frozen=True)
class Belt:
    """A saw over moving material. A box is left, right, top and bottom, in px; y goes down.

    Attributes:
        time: that is shown, in s.
        blade, saw: boxes of the blade's tip and of the carriage.
        bodies: boxes of the material and of the pieces, from left to right.
        grain: boxes of the lines on the material.
        marks: numbers and places, in px.
        ruler: its numbers, in u, and their places, in px.
    """

    time: float
    blade: list[float]
    saw: list[float]
    bodies: list[list[float]]
    grain: list[list[float]]
    marks: list[tuple[int, float]]
    ruler: list[tuple[float, float]]

    def x(self, position: Any) -> Any:
        """Where a position of the slave is drawn, by the first and the last number of the ruler, in px."""
        (first, left), (last, right) = self.ruler[0], self.ruler[-1]
        return left + (position - first) * (right - left) / (last - first)

    @property
    def middle_of_saw(self) -> float:
        return 0.5 * (self.saw[0] + self.saw[1])

    @property
    def is_blade_in_the_material(self) -> bool:
        """Whether the blade's tip has passed the whole material; else it has to be above its surface.

        Raises:
            AssertionError: it is neither.
        """
        if not self.bodies:
            return False  # the material has not come yet
        surface, underside, tip = self.bodies[0][2], self.bodies[0][3], self.blade[3]
        assert tip < surface - 5.0 or tip > underside
        return tip > underside

    @property
    def loose_grain(self) -> list[list[float]]:
        """Lines that are not on one of the bodies, with a tolerance of a rounding of px."""

        def within(line: list[float], body: list[float]) -> bool:
            return line[0] >= body[0] - 0.01 and line[1] <= body[1] + 0.01 and body[2] <= line[2] <= line[3] <= body[3]

        return [line for line in self.grain if not any(within(line, body) for body in self.bodies)]

    @property
    def least_grain(self) -> float:
        """As many lines are there at least: one each 46 px, but for those at the ends, and beside the window."""
        return sum(max((body[1] - body[0] - 44.0) / 46.0 - 1.0, 0.0) for body in self.bodies)

    def has_border(self, x: float) -> bool:
        """Whether the material, or a piece, ends there, to half a px."""
        return any(abs(end - x) <= 0.5 for body in self.bodies for end in body[:2])

    def gaps(self) -> list[float]:
        """The widths between the bodies, in px."""
        return [float(gap) for gap in np.subtract([b[0] for b in self.bodies[1:]], [b[1] for b in self.bodies[:-1]])]


def read_belt(visit: Visit) -> Belt:
    """What is drawn now."""
    return Belt(**visit.page.evaluate(READ))


def read_belts(visit: Visit, times: list[float]) -> list[Belt]:
    """What is drawn when these times are shown, in s, one after the other."""
    return [Belt(**belt) for belt in visit.seen(times, f"({READ})()")]


def watch_belt(visit: Visit, interval: int, duration: int) -> list[Belt]:
    """What is drawn each `interval` ms while the browser's own time, which has to be frozen, goes on so many ms."""
    visit.page.evaluate(
        f"interval => {{ window.seenBelts = []; setInterval(() => seenBelts.push(({READ})()), interval); }}", interval
    )
    visit.wait(duration)
    return [Belt(**belt) for belt in visit.page.evaluate("seenBelts")]
