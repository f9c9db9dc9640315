"""A state diagram in mermaid's notation, drawn as SVG: for a page that has neither JavaScript nor a network.

The states stand below one another in the order of their first mention. Transitions downwards are arcs on the right,
those upwards on the left. Each transition has a number; a table tells from where it leads to where, and when.
"""

import re
from dataclasses import dataclass

from markdown_it import MarkdownIt
from markupsafe import Markup, escape

TRANSITION = re.compile(r"\s*(\S+)\s*-->\s*(\S+?)\s*(?::\s*(.*?)\s*)?$")
START = "[*]"  # the source of the transition that leads to the first state
BOX, GAP, LETTER, ARC, DISC, MARGIN = 30.0, 18.0, 8.2, 30.0, 11.0, 16.0  # px
ARROW = (
    '<defs><marker id="arrow" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7" '
    'orient="auto-start-reverse"><path d="M0 0.5 8 4 0 7.5z" fill="#53616e"/></marker></defs>'
)


@dataclass(frozen=True)
class Transition:
    """From which state a transition leads to which, and when: Markdown, empty for a transition without condition."""

    source: str
    target: str
    when: str


def transitions(text: str) -> list[Transition]:
    """The lines `A --> B : when` of a mermaid diagram; what else it holds is left out."""
    lines = (TRANSITION.match(line) for line in text.splitlines())
    return [Transition(line[1], line[2], line[3] or "") for line in lines if line]


def states(found: list[Transition]) -> list[str]:
    """The states that the transitions name, in the order of their first mention."""
    return list(dict.fromkeys(name for t in found for name in (t.source, t.target) if name != START))


def drawn(text: str) -> Markup:
    """The picture of a mermaid diagram and the table of its transitions."""
    found = transitions(text)
    inner = [t for t in found if START not in (t.source, t.target)]
    begins = {t.target for t in found if t.source == START}
    return _picture(states(found), inner, begins) + _table(inner)


def _picture(names: list[str], found: list[Transition], begins: set[str]) -> Markup:
    """The states as boxes, the transitions as numbered arcs."""
    row = {name: i for i, name in enumerate(names)}
    numbers: dict[tuple[str, str], list[int]] = {}
    for number, t in enumerate(found, 1):
        numbers.setdefault((t.source, t.target), []).append(number)
    spans = [row[target] - row[source] for source, target in numbers]
    left = MARGIN + ARC * max([1, *(-span for span in spans)]) + DISC
    width = LETTER * max(map(len, names), default=0) + 2.0 * DISC
    total = left + width + ARC * max([1, *spans]) + DISC * (1.0 + max(map(len, numbers.values()), default=0)) + MARGIN
    height = len(names) * (BOX + GAP) + GAP
    middles = {name: GAP + i * (BOX + GAP) + BOX / 2.0 for name, i in row.items()}
    parts = [_arc(middles[a], middles[b], row[b] - row[a], left, width, ns) for (a, b), ns in numbers.items()]
    parts += [_box(name, middles[name], left, width, name in begins) for name in names]
    return Markup(
        f'<svg class="states" viewBox="0 0 {total:g} {height:g}" width="{total:g}" role="img" '
        f'aria-label="state diagram">{ARROW}{"".join(parts)}</svg>\n'
    )


def _box(name: str, y: float, left: float, width: float, begins: bool) -> str:
    """A state; the one in which the block begins has a dot beside it."""
    dot = f'<circle cx="{left + 10.0:g}" cy="{y:g}" r="4" fill="#1d2730"/>' if begins else ""
    return (
        f'<rect x="{left:g}" y="{y - BOX / 2.0:g}" width="{width:g}" height="{BOX:g}" rx="9" fill="#e8edf2" '
        f'stroke="#7a8793"/>{dot}<text x="{left + width / 2.0:g}" y="{y + 4.5:g}" text-anchor="middle">'
        f"{escape(name)}</text>"
    )


def _arc(begin: float, end: float, span: int, left: float, width: float, numbers: list[int]) -> str:
    """A transition between the middles of two boxes, the wider the more rows it spans; its numbers at its farthest."""
    side = -1.0 if span < 0 else 1.0
    edge = left + width if span >= 0 else left
    far = edge + side * ARC * max(abs(span), 1)
    a, b = (begin + side * 6.0, end - side * 6.0) if span else (begin - 7.0, begin + 7.0)
    control = edge + (far - edge) * 4.0 / 3.0  # a cubic between two such points reaches 3/4 of the way to them
    text = " ".join(map(str, numbers))
    room = DISC * (1.0 + 0.75 * (len(text) - 1))
    x, y = far, (a + b) / 2.0
    return (
        f'<path d="M{edge:g} {a:g}C{control:g} {a:g} {control:g} {b:g} {edge:g} {b:g}" fill="none" stroke="#53616e" '
        f'marker-end="url(#arrow)"/><rect x="{x - room * 0.8:g}" y="{y - 9.0:g}" width="{room * 1.6:g}" height="18" '
        f'rx="9" fill="#fff" stroke="#c8451b"/><text x="{x:g}" y="{y + 4.0:g}" text-anchor="middle" font-size="11">'
        f"{text}</text>"
    )


def _table(found: list[Transition]) -> Markup:
    rows = [
        Markup('<tr><td>{}</td><td class="name">{}</td><td class="name">{}</td><td>{}</td></tr>\n').format(
            number, t.source, t.target, Markup(MarkdownIt().renderInline(t.when))
        )
        for number, t in enumerate(found, 1)
    ]
    head = Markup("<table>\n<tr><th></th><th>from</th><th>to</th><th>when</th></tr>\n")
    return head + Markup("").join(rows) + Markup("</table>\n")
