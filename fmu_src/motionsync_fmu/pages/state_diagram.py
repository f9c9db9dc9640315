"""A state diagram in mermaid's notation, drawn as SVG: for a page that has neither JavaScript nor a network.

The states are drawn below one another in the sequence of their first mention, those of a group in a frame with its
name. A transition downwards is an arc on the right, one upwards is an arc on the left. Each transition has a number; a
table lists its source, its target and its condition.
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
LAYER = "<g {style}>\n{shapes}</g>\n"
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
class StateTransition:
    """A transition from one state to another, with its condition in Markdown (empty: no condition)."""

    source: str
    target: str
    condition: str


@dataclass(frozen=True)
class StateDiagram:
    """The states and transitions of a diagram.

    Attributes:
        rows: the names of the groups and of the states; the states of a group follow its name.
        groups: the states of each group.
    """

    rows: list[str]
    groups: dict[str, list[str]]
    transitions: list[StateTransition]

    @property
    def states(self) -> list[str]:
        """The names of the states without those of the groups."""
        return [name for name in self.rows if name not in self.groups]

    def add_state(self, name: str, group: str) -> None:
        """Add a state that has not been mentioned before; `group`: the group in which it is mentioned, empty: none."""
        if name not in (*self.rows, START):
            self.rows.append(name)
            self.groups.get(group, []).append(name)


def read_diagram(text: str) -> StateDiagram:
    """Read the lines `A --> B : when` of a mermaid diagram, and its groups of states; other lines are ignored."""
    diagram = StateDiagram([], {}, [])
    group = ""
    for line in text.splitlines():
        if opening := GROUP.match(line):
            group = opening[1]
            diagram.groups[group] = []
            diagram.rows.append(group)
        elif line.strip() == "}":
            group = ""
        elif arrow := TRANSITION.match(line):
            source, target, condition = arrow.groups("")
            diagram.transitions.append(StateTransition(source, target, condition))
            diagram.add_state(source, group)
            diagram.add_state(target, group)
    return diagram


def draw_diagram(text: str) -> Markup:
    """Draw a mermaid diagram, with the table of its transitions."""
    diagram = read_diagram(text)
    inner = [t for t in diagram.transitions if START not in (t.source, t.target)]
    starts = [t for t in diagram.transitions if t.source == START]
    table = _table(inner, [t for t in starts if t.condition])
    return _draw_states(diagram, inner, {t.target for t in starts}) + table


def _draw_states(diagram: StateDiagram, transitions: list[StateTransition], initial: set[str]) -> Markup:
    """Draw the states as boxes, the initial ones with a dot, and the transitions as numbered arcs."""
    row = {name: i for i, name in enumerate(diagram.rows)}
    numbers: dict[tuple[str, str], list[int]] = {}
    for number, t in enumerate(transitions, 1):
        numbers.setdefault((t.source, t.target), []).append(number)
    spans = [row[target] - row[source] for source, target in numbers]
    left = MARGIN + ARC * max([1, *(-span for span in spans)])
    width = 2.0 * round(LETTER / 2.0 * max(map(len, row), default=0)) + 3.0 * DISC
    middle = {name: GAP + i * (BOX + GAP) + BOX / 2.0 for name, i in row.items()}
    arcs = [(_arc_geometry(middle[a], middle[b], row[b] - row[a], left, width), ns) for (a, b), ns in numbers.items()]
    layers = (
        (GROUPS, [_frame(len(names), middle[group], left, width) for group, names in diagram.groups.items()]),
        (ARCS, [_arc(*geometry) for geometry, _ in arcs]),
        (STATES, [_labelled(left + width / 2.0, middle[name], width, BOX, name) for name in diagram.states]),
        (GROUPS, [_labelled(left + width / 2.0, middle[name], width, BOX, name) for name in diagram.groups]),
        (DOTS, [DOT.format(x=left + DISC, y=middle[name]) for name in row if name in initial]),
        (NUMBERS, [_numbers(*geometry, ns) for geometry, ns in arcs]),
    )
    total = left + width + ARC * max([1, *spans]) + 2.0 * MARGIN
    head = HEAD.format(width=total, height=len(row) * (BOX + GAP) + GAP)
    shown = (LAYER.format(style=style, shapes="".join(shapes)) for style, shapes in layers if shapes)
    return Markup(head + "".join(shown) + "</svg>\n")


def _frame(members: int, y: float, left: float, width: float) -> str:
    """The frame around the states of a group, with the name of the group above them."""
    height = members * (BOX + GAP) + BOX + 12.0
    return RECT.format(x=left - 8.0, y=y - BOX / 2.0 - 6.0, w=width + 16.0, h=height) + "\n"


def _labelled(x: float, y: float, width: float, height: float, text: str) -> str:
    """A text in a box, both centred at a point."""
    rect = RECT.format(x=-width / 2.0, y=-height / 2.0, w=width, h=height)
    return LABELLED.format(x=x, y=y, rect=rect, text=escape(text))


def _arc_geometry(begin: float, end: float, span: int, left: float, width: float) -> tuple[float, float, float, float]:
    """The geometry of an arc between the centres of two boxes: the edge of the boxes, where the arc is farthest from
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
    """The numbers of the transitions that an arc represents, where it is farthest from the boxes."""
    text = ", ".join(map(str, numbers))
    return _labelled(far, (a + b) / 2.0, 12.0 + 6.0 * len(text), 18.0, text)


def _table(transitions: list[StateTransition], starts: list[StateTransition]) -> Markup:
    """The table of the transitions by number, below the conditions for the initial states."""
    head = Markup("<table>\n<thead><tr><th></th><th>from</th><th>to</th><th>when</th></tr></thead>\n")
    row = Markup("<tr><td>{}</td><th>{}</th><th>{}</th><td>{}</td></tr>\n")
    markdown = MarkdownIt("commonmark", {"html": False})
    rows = [("", "the start", t.target, t.condition) for t in starts]
    rows += [(str(number), t.source, t.target, t.condition) for number, t in enumerate(transitions, 1)]
    texts = [row.format(n, a, b, Markup(markdown.renderInline(condition))) for n, a, b, condition in rows]
    return head + Markup("").join(texts) + Markup("</table>\n")
