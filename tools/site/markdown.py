"""What the Markdown of a code host needs to become that of MkDocs."""

import re

from markupsafe import escape

from motionsync_fmu.pages.state_diagram import draw_diagram

DIAGRAM = re.compile(r"^```mermaid\n(.*?)^```$", re.M | re.S)
FENCE = re.compile(r"(^ *```.*?^ *```$)", re.M | re.S)
CONTINUED = re.compile(r"^ {2,3}(?=[^ ])", re.M)  # a line that goes on with a point of a list
FURTHER = re.compile(r"(\n\n    \S.*\n(?:    \S.*\n)*)(?=\d+\. |[-*] )")  # a further paragraph, before the next point
NODE = re.compile(r'(\w+)\["([^":]+): ([^"]+)"\]')
ARROW = re.compile(r"^(.*?) -+> (.*)$")


def indent_lists(text: str) -> str:
    """The text with the four spaces that MkDocs expects before the further paragraphs of a point in a list, and the
    empty line behind them."""
    parts = FENCE.split(text)  # code has an odd index
    parts[::2] = (FURTHER.sub(r"\1\n", CONTINUED.sub("    ", part)) for part in parts[::2])
    return "".join(parts)


def draw_diagrams(text: str) -> str:
    """The text with its diagrams as HTML: the library that draws them in a browser would come from the network."""
    return DIAGRAM.sub(lambda match: _draw(match[1]), text)


def _draw(diagram: str) -> str:
    html = draw_diagram(diagram) if diagram.startswith("stateDiagram") else draw_layers(diagram)
    return f'<div class="diagram">\n{html}\n</div>\n'


def draw_layers(diagram: str) -> str:
    """A flowchart of packages, `a["name: what it is"] --> b & c`, as a table: each with what it imports."""
    nodes: dict[str, tuple[str, str]] = {}
    imports: dict[str, list[str]] = {}
    for line in map(str.strip, diagram.splitlines()):
        if line.startswith("subgraph"):
            continue
        for key, name, meaning in NODE.findall(line):
            nodes[key] = name, meaning
        if arrow := ARROW.match(NODE.sub(r"\1", line)):
            sources, targets = (side.split(" & ") for side in arrow.groups())
            for source in sources:
                imports.setdefault(source.strip(), []).extend(target.strip() for target in targets)
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{escape(meaning)}</td><td>"
        f"{escape(', '.join(nodes[target][0] for target in imports.get(key, ()) if target in nodes))}</td></tr>\n"
        for key, (name, meaning) in nodes.items()
    )
    return f"<table>\n<tr><th>package</th><th>what it is</th><th>imports</th></tr>\n{rows}</table>"
