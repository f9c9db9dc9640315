"""The animated picture of a run's machine, as one part of a page. It needs no library; its colours are in colours.css.

Where a page has plots, too, both share their time by the event `motionsync:time` of the document, whose detail has the
`time` in s and the `source`: "machine" or "plots".
"""

from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..style import TEMPLATES, load_template
from .axes import axes
from .belt import belt
from .cylinder import cylinder
from .description import pictures_of
from .remote_axis import remote_axis
from .run import Run

FOLDER = Path(__file__).parent
PLACEHOLDER = "/* fragment.py puts the scenes here: axes.js, belt.js, cylinder.js, window.js */\n"  # in machine.js
SCENES = {"axes": axes, "belt": belt, "cylinder": cylinder}
NAMES = (*SCENES, "window")


def machine(scenario: Scenario, recording: Recording) -> Markup:
    """The picture of the run, with a slider, a play button and readouts; empty for a block that has no picture."""
    data = scene_data(scenario, recording)
    if data is None:
        return Markup("")
    return _rendered(data, data["scene"])


def live_machine() -> Markup:
    """The picture of a run that the page itself makes, and hands over as `motionsyncMachine.load(data)`."""
    return _rendered(None, *NAMES)


def _rendered(data: dict[str, Any] | None, *scenes: str) -> Markup:
    code = _text("machine.js").replace(PLACEHOLDER, "\n".join(_text(f"{name}.js") for name in scenes))
    page = load_template(TEMPLATES, "machine.html.j2")
    return Markup(page.render(data=data, style=Markup(_text("machine.css")), code=Markup(code)))


def scene_data(scenario: Scenario, recording: Recording) -> dict[str, Any] | None:
    """What is drawn of a run; None: nothing."""
    run = Run(scenario, recording)
    if run.scenario.remote:
        return remote_axis(run, run.scenario.remote)
    picture = next((p for p in pictures_of(scenario.recipe) if "where" not in p or run.start(p["where"])), None)
    return SCENES[picture["scene"]](run, picture) if picture else None


@cache
def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")
