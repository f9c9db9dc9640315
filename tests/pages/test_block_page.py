"""The page in an FMU and its pictures: the block's README, its example and its variables."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages import pictures
from motionsync_fmu.pages.block_page import FmuContents, make_pages
from motionsync_fmu.pages.pictures import draw_example, draw_icon, make_panels
from motionsync_fmu.pages.readme import read_readme, render_readme
from motionsync_fmu.pages.state_diagram import draw_diagram, read_diagram
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process
from tests import ROOT
from tests.support.scenarios.verdicts import checks_of

MARKS = "marks on the master"
ENDS = "ends of the pieces"
README = """# Block

A [block](../other/README.md) of [its maker](https://example.com/maker), with a | pipe.

![What it does](../../../docs/Block.svg)

## How to use it

1. Set `ratio`.

| there | here |
| --- | --- |
| a | `b` |

## States

```mermaid
stateDiagram-v2
    [*] --> REST
    REST --> MOVING : a rising edge of `start`
    state "in motion" as motion {
        MOVING --> FAST
        FAST --> MOVING : it brakes
    }
    motion --> REST : <stop>
    [*] --> FAST : at speed
```
"""


class Unwritten:
    """A block in whose folder there is no README.md."""


class Balanced(HTMLParser):
    """Fails where an element ends that has not begun last."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_readme_becomes_a_part_of_the_page() -> None:
    html = render_readme(README, "example.svg", "An example")
    assert "<h1>" not in html
    assert html.startswith("<p>A block of")
    assert '<a href="https://example.com/maker">its maker</a>' in html
    assert "README.md" not in html
    assert '<img src="example.svg" alt="An example">\n<figcaption>What it does</figcaption>' in html
    assert html.count("<img") == 1
    assert "<h2>How to use it</h2>\n<ol>\n<li>Set <code>ratio</code>.</li>" in html
    assert "<td><code>b</code></td>" in html
    assert "mermaid" not in html
    parser = Balanced()
    parser.feed(html)
    assert not parser.open


def test_a_block_without_a_readme_has_no_page() -> None:
    with pytest.raises(UserError, match=r"README.md: cannot be read: .*: a block's README.md is part of its page"):
        read_readme(Unwritten)


def test_a_state_diagram_is_read_with_its_groups() -> None:
    diagram = read_diagram(README)
    assert diagram.states == ["REST", "MOVING", "FAST"]
    assert diagram.groups == {"motion": ["FAST"]}  # MOVING has been named before the group
    assert [(t.source, t.target, t.condition) for t in diagram.transitions] == [
        ("[*]", "REST", ""),
        ("REST", "MOVING", "a rising edge of `start`"),
        ("MOVING", "FAST", ""),
        ("FAST", "MOVING", "it brakes"),
        ("motion", "REST", "<stop>"),
        ("[*]", "FAST", "at speed"),
    ]


def test_a_state_diagram_is_drawn_with_a_table_of_its_transitions() -> None:
    html = draw_diagram(README)
    assert html.count("<path d=") == 1 + 4  # the arrow's head, and an arc each
    assert html.count("<circle") == 2
    assert "<td>a rising edge of <code>start</code></td>" in html
    assert "&lt;stop&gt;" in html
    assert html.count("<tr>") == 1 + 1 + 4  # the head, the start with a condition, the transitions


def test_the_example_does_what_its_block_s_readme_states(block: str) -> None:
    example = load_example(block)
    checks = checks_of(example, run_in_process(example, example.step_size))
    assert checks
    assert not [c for c in checks if not c.passed]


def test_a_picture_shows_the_motion_of_the_example(block: str) -> None:
    example = load_example(block)
    shown = make_panels(example, example.unit)
    assert len(shown) == 3 + len(example.picture.curves) * (example.remote is None)
    for panel in shown:
        assert panel.curves
        for curve in panel.curves:
            assert curve.values.shape == panel.time.shape
            if curve.label not in (MARKS, ENDS):
                assert np.isfinite(curve.values).mean() > 0.95  # the others are gaps where a period wraps
    assert np.nanmax(shown[0].curves[-1].values) > np.nanmin(shown[0].curves[-1].values)


def test_a_saw_is_drawn_with_the_marks_that_pass_it() -> None:
    """The material comes at 250 mm/s, a mark at 150 and one each 500 mm: at t they are at 250 t - 150 - 500 n."""
    example = load_example("FlyingSaw")
    position = make_panels(example, example.unit)[0]
    (marks,) = [line.values for line in position.curves if line.label == MARKS]
    seen = np.isfinite(marks)
    passing = 250.0 * position.time[seen] - 150.0
    assert np.abs(marks[seen] - np.where(passing > 400.0, passing - 500.0, passing)).max() < 1e-9
    saw = position.curves[-1].values
    assert position.shaded is not None
    in_sync = position.shaded > 0.0
    assert in_sync.sum() > 20
    assert np.abs(marks[in_sync] - saw[in_sync]).max() < 1e-9


@pytest.mark.parametrize("name", ["CutToLength", "RotaryKnife"])
def test_no_line_joins_the_end_of_one_piece_to_that_of_the_next(name: str) -> None:
    """The ends move with the material, which does not turn back."""
    example = load_example(name)
    (ends,) = [line.values for line in make_panels(example, example.unit)[0].curves if line.label == ENDS]
    steps = np.diff(ends)
    assert (steps[np.isfinite(steps)] > 0.0).all()
    assert np.isfinite(ends).sum() > 20


def test_a_picture_has_the_units_of_its_example() -> None:
    example = load_example("RotaryKnife")
    labels = [panel.label for panel in make_panels(example, example.unit, example.slave_unit)]
    assert labels == ["position\ndeg", "velocity\ndeg/s", "master\nmm/s", "acceleration\ndeg/s²", "piece\nmm"]


@pytest.mark.parametrize(
    ("slave_unit", "is_apart"), [("", False), ("mm", False), ("deg", True), ("m", True), ("1", True)]
)
def test_no_plot_has_two_units(block: str, slave_unit: str, is_apart: bool) -> None:
    """The master has a plot of its own, if its unit is not the slave's; its curve is drawn either way."""
    example = load_example(block)
    shown = make_panels(example, "mm", slave_unit)
    together = [panel for panel in shown if {curve.label for curve in panel.curves} > {"master"}]
    alone = [panel for panel in shown if [curve.label for curve in panel.curves] == ["master"]]
    if not example.remote:
        assert bool(alone) == is_apart != bool(together)
    assert not [panel for panel in shown if panel.label.count("\n") > 1]


def test_the_pictures_of_the_readmes_are_those_of_the_examples(block: str) -> None:
    """But for rounding: two processors may differ in the last digit that is written."""
    number = r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?"
    example = load_example(block)
    made = draw_example(block, example.unit, example.slave_unit).decode()
    file = ROOT / "docs" / f"{block}.svg"
    shipped = file.read_text("utf-8") if file.is_file() else ""
    assert re.sub(number, "#", made) == re.sub(number, "#", shipped), f"{file.name} is not what `make pictures` draws"
    a, b = (np.array([float(x) for x in re.findall(number, text)]) for text in (made, shipped))
    assert np.abs(a - b).max() < 0.02


@pytest.mark.parametrize(("named", "drawn"), [((), tuple(BLOCKS)), (("Gearing", "Follower"), ("Follower", "Gearing"))])
def test_the_pictures_of_all_blocks_are_written_or_of_those_that_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: tuple[str, ...], drawn: tuple[str, ...]
) -> None:
    monkeypatch.setattr(pictures, "draw_example", lambda name, *_units: name.encode())
    monkeypatch.setattr("sys.argv", ["pictures", str(tmp_path / "made"), *named])
    pictures.main()
    assert {file.name: file.read_text() for file in (tmp_path / "made").iterdir()} == {f"{n}.svg": n for n in drawn}


def test_the_icon_is_a_small_png(block: str) -> None:
    image = draw_icon(block)
    assert image.startswith(b"\x89PNG")
    assert len(image) < 20_000


def test_the_page_is_well_formed_and_lists_every_variable_and_state(block: str) -> None:
    recipe = Recipe(block)
    files = make_pages(FmuContents(recipe, "python", ["linux64"]))
    assert files.keys() == {"index.html", "externalDependencies.html", "example.svg"}
    page = files["index.html"].decode()
    parser = Balanced()
    parser.feed(page)
    assert not parser.open
    for name in recipe.variables:
        group, _, rest = name.partition(".")
        table = page[page.index(f'<tr id="variables-{group if rest else ""}">') :]
        assert f"<tr><th>{rest or group}</th><td>" in table
    assert 'class="states"' in page
    assert not set(re.findall(r'(?:href|src)="(?!http|#)([^"]*)"', page)) - files.keys()


def test_the_page_explains_how_to_use_and_wire_a_block_before_the_names_of_its_source(block: str) -> None:
    page = page_of(block)
    heads = re.findall(r"<h2>(.*?)</h2>", page)
    assert heads.index("How to use it") < heads.index("Wiring") < heads.index("Names in the source system")
    assert heads.index("States") < heads.index("Variables")


def test_the_page_names_the_project_and_its_version(block: str) -> None:
    (footer,) = re.findall(r"<footer>(.*?)</footer>", page_of(block))
    assert footer == f'<a href="https://github.com/motionsync/motionsync">motionsync</a> {__version__}'


def test_the_table_of_variables_is_short(block: str) -> None:
    """The range of all Real inputs is written once, in a sentence; an enumeration starts with a name."""
    page = page_of(block).partition("<h2>Variables</h2>")[2].partition("<h3>")[0]
    assert "1e+12 to 1e+12" not in page
    assert page.count("±1e12") == 1
    for v in Recipe(block).variables.values():
        if v.choices and v.settable:
            assert f"<td>{v.start.name}</td><td>" in page


def test_a_plot_of_characters_keeps_its_lines() -> None:
    """The code of a running text is not broken; that of a plot has lines and blanks."""
    page = page_of("FlyingSaw")
    assert "<pre><code>T_a + T_b\n   |\n" in page
    assert "pre code { white-space: pre; }" in page


def page_of(block: str) -> str:
    contents = FmuContents(Recipe(block), "native", ["linux64"])
    return make_pages(contents)["index.html"].decode()


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('shaded = "state"', "19: shaded: state is a discrete Enumeration output, not a Boolean output"),
        ('shading = "in_gear"', "19: shading: unknown key; there is shaded, curves, variants"),
        ("[picture.curves]\ngear = 'a'", "20: gear: Gearing has no variable 'gear'"),
        ("[picture.curves]\nstart = 'a'", "20: start: is a discrete input, not an output or local variable"),
        ("[picture.variants.A]\nin_gear = true", "20: in_gear: is a discrete output, not a parameter or input"),
    ],
)
def test_a_mistake_in_a_picture_is_reported_with_its_line(table: str, message: str, tmp_path: Path) -> None:
    text = (ROOT / "model" / "motionsync" / "gearing" / "example.toml").read_text("utf-8")
    lines = [line for line in text.partition("[[expect]]")[0].splitlines() if line][:17]
    file = tmp_path / "example.toml"
    file.write_text("\n".join([*lines, "[picture]", table]))
    with pytest.raises(UserError, match=re.escape(f"{file}:{message}")):
        load_scenario(file)


def test_a_picture_has_a_line_for_each_variant_and_a_plot_for_each_further_curve(tmp_path: Path) -> None:
    file = tmp_path / "example.toml"
    file.write_text("""
title = "Two ratios"
source = "Test"
fmu = "Gearing"
stop_time = 1.0
step_size = 0.1
[start]
start = true
[master]
velocity = 10.0
[picture.curves]
"local.progress" = "share"
[picture.variants.single]
[picture.variants.double]
"gearing.numerator" = 2
""")
    shown = make_panels(load_scenario(file), "mm")
    assert [panel.label for panel in shown] == ["position\nmm", "velocity\nmm/s", "acceleration\nmm/s²", "share"]
    assert [[curve.label for curve in panel.curves] for panel in shown] == [
        ["master", "single", "double"],
        ["master", "single", "double"],
        ["single", "double"],
        ["single", "double"],
    ]
