"""A state diagram in mermaid's notation, drawn as SVG: for a page that has neither JavaScript nor a network.

The states stand below one another in the order of their first mention, those of a group in a frame with its name. A
transition downwards is an arc on the right, one upwards is an arc on the left. Each transition has a number; a table
says from where it leads to where, and when.
"""

import re
from dataclasses import dataclass

from markdown_it import MarkdownIt
from markupsafe import Markup, escape

TRANSITION = re.compile(r"\s*(\S+)\s*-->\s*(\S+)\s*(?::\s*(.*?)\s*)?$")
GROUP = re.compile(r'\s*state\s+(?:".*"\s+as\s+)?(\w+)\s*\{')
START = "[*]"  # the source of the transition that leads to the first state
BOX, GAP, LETTER, ARC, DISC, MARGIN = 30.0, 20.0, 8.6, 30.0, 12.0, 24.0  # px
HEAD = (
    '<svg class="states" viewBox="0 0 {width:g} {height:g}" width="{width:g}" role="img" aria-label="state diagram">'
    '<defs><marker id="arrow" viewBox="0 0 8 8" refX="7.5" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
    '<path d="M0 0.5 8 4 0 7.5z" fill="#53616e"/></marker></defs>\n'
)
LAYER = "<g {look}>\n{shapes}</g>\n"
STATES = 'fill="#e8edf2" stroke="#7a8793"'
GROUPS = 'fill="#fff" stroke="#7a8793" stroke-dasharray="5 4"'
ARCS = 'fill="none" stroke="#53616e" marker-end="url(#arrow)"'
NUMBERS = 'fill="#fff" stroke="#c8451b"'
DOTS = 'fill="#1d2730"'
RECT = '<rect rx="9" x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}"/>'
PATH = '<path d="M{edge:g} {a:g}c{control:g} 0 {control:g} {down:g} 0 {down:g}"/>\n'
DOT = '<circle r="4" cx="{x:g}" cy="{y:g}"/>\n'
LABELLED = '<g transform="translate({x:g} {y:g})">{rect}<text y="4.5">{text}</text></g>\n'


@dataclass(frozen=True)
class Transition:
    """A transition: its first state, its next state, and its condition in Markdown (empty: no condition)."""

    source: str
    target: str
    when: str


@dataclass(frozen=True)
class Diagram:
    """What a diagram shows.

    Attributes:
        rows: the names of the groups and of the states; the states of a group follow its name.
        groups: the states of each group.
    """

    rows: list[str]
    groups: dict[str, list[str]]
    transitions: list[Transition]

    @property
    def states(self) -> list[str]:
        """The names of the states without those of the groups."""
        return [name for name in self.rows if name not in self.groups]


def read(text: str) -> Diagram:
    """The lines `A --> B : when` of a mermaid diagram, and its groups of states; all other lines are ignored."""
    diagram = Diagram([], {}, [])
    group = ""
    for line in text.splitlines():
        if begins := GROUP.match(line):
            group = begins[1]
            diagram.groups[group] = []
            diagram.rows.append(group)
        elif line.strip() == "}":
            group = ""
        elif found := TRANSITION.match(line):
            diagram.transitions.append(Transition(found[1], found[2], found[3] or ""))
            for name in found[1], found[2]:
                if name not in (*diagram.rows, START):
                    diagram.rows.append(name)
                    diagram.groups.get(group, []).append(name)
    return diagram


def drawn(text: str) -> Markup:
    """The picture of a mermaid diagram and the table of its transitions."""
    diagram = read(text)
    inner = [t for t in diagram.transitions if START not in (t.source, t.target)]
    starts = [t for t in diagram.transitions if t.source == START]
    return _picture(diagram, inner, {t.target for t in starts}) + _table(inner, [t for t in starts if t.when])


def _picture(diagram: Diagram, found: list[Transition], begins: set[str]) -> Markup:
    """The states as boxes, the transitions as numbered arcs."""
    row = {name: i for i, name in enumerate(diagram.rows)}
    numbers: dict[tuple[str, str], list[int]] = {}
    for number, t in enumerate(found, 1):
        numbers.setdefault((t.source, t.target), []).append(number)
    spans = [row[target] - row[source] for source, target in numbers]
    left = MARGIN + ARC * max([1, *(-span for span in spans)])
    width = 2.0 * round(LETTER / 2.0 * max(map(len, row), default=0)) + 3.0 * DISC
    middle = {name: GAP + i * (BOX + GAP) + BOX / 2.0 for name, i in row.items()}
    arcs = [(_place(middle[a], middle[b], row[b] - row[a], left, width), ns) for (a, b), ns in numbers.items()]
    layers = (
        (GROUPS, [_frame(len(names), middle[group], left, width) for group, names in diagram.groups.items()]),
        (ARCS, [_arc(*place) for place, _ in arcs]),
        (STATES, [_labelled(left + width / 2.0, middle[name], width, BOX, name) for name in diagram.states]),
        (GROUPS, [_labelled(left + width / 2.0, middle[name], width, BOX, name) for name in diagram.groups]),
        (DOTS, [DOT.format(x=left + DISC, y=middle[name]) for name in row if name in begins]),
        (NUMBERS, [_numbers(*place, ns) for place, ns in arcs]),
    )
    total = left + width + ARC * max([1, *spans]) + 2.0 * MARGIN
    head = HEAD.format(width=total, height=len(row) * (BOX + GAP) + GAP)
    shown = (LAYER.format(look=look, shapes="".join(shapes)) for look, shapes in layers if shapes)
    return Markup(head + "".join(shown) + "</svg>\n")


def _frame(members: int, y: float, left: float, width: float) -> str:
    """The frame around the states of a group, with the name of the group above them."""
    height = members * (BOX + GAP) + BOX + 12.0
    return RECT.format(x=left - 8.0, y=y - BOX / 2.0 - 6.0, w=width + 16.0, h=height) + "\n"


def _labelled(x: float, y: float, width: float, height: float, text: str) -> str:
    """A text in a box; both have their middle at a place."""
    rect = RECT.format(x=-width / 2.0, y=-height / 2.0, w=width, h=height)
    return LABELLED.format(x=x, y=y, rect=rect, text=escape(text))


def _place(begin: float, end: float, span: int, left: float, width: float) -> tuple[float, float, float, float]:
    """The geometry of an arc between the middles of two boxes: the edge of the boxes, where the arc is farthest from
    them, and the heights of both its ends. The more rows the arc spans, the farther it reaches."""
    side = -1.0 if span < 0 else 1.0
    edge = left if span < 0 else left + width
    a, b = (begin + side * 6.0, end - side * 6.0) if span else (begin - 7.0, begin + 7.0)
    return edge, edge + side * ARC * max(abs(span), 1), a, b


def _arc(edge: float, far: float, a: float, b: float) -> str:
    """A transition."""
    control = (far - edge) * 4.0 / 3.0  # a cubic reaches 3/4 of the distance to its two control points
    return PATH.format(edge=edge, control=control, a=a, down=b - a)


def _numbers(_: float, far: float, a: float, b: float, numbers: list[int]) -> str:
    """The numbers of the transitions that an arc stands for, where it is farthest from the boxes."""
    text = ", ".join(map(str, numbers))
    return _labelled(far, (a + b) / 2.0, 12.0 + 6.0 * len(text), 18.0, text)


def _table(found: list[Transition], starts: list[Transition]) -> Markup:
    """The table of the transitions by number; a condition for the state in which the block begins comes first."""
    head = Markup("<table>\n<thead><tr><th></th><th>from</th><th>to</th><th>when</th></tr></thead>\n")
    row = Markup("<tr><td>{}</td><th>{}</th><th>{}</th><td>{}</td></tr>\n")
    markdown = MarkdownIt("commonmark", {"html": False})
    rows = [("", "the start", t.target, t.when) for t in starts]
    rows += [(str(number), t.source, t.target, t.when) for number, t in enumerate(found, 1)]
    texts = [row.format(n, a, b, Markup(markdown.renderInline(when))) for n, a, b, when in rows]
    return head + Markup("").join(texts) + Markup("</table>\n")
