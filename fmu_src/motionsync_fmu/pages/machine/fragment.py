"""The animated picture of a run's machine, as one self-contained part of a page: it needs no other file and no library.

Where a page has plots, too, both share their time by the event `motionsync:time` of the document, whose detail has the
`time` in s and the `source`: "machine" or "plots".
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..style import TEMPLATES
from . import axes, belt
from .remote_axis import remote_axis
from .run import Run

HERE = Path(__file__).parent
SCENES = "/* the scenes */\n"  # where machine.js takes up the code of the scenes
NAMES = ("axes", "belt", "window")


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
    code = _text("machine.js").replace(SCENES, "\n".join(_text(f"{name}.js") for name in scenes))
    page = TEMPLATES.get_template("machine.html.j2")
    return Markup(page.render(data=data, style=Markup(_text("machine.css")), code=Markup(code)))


def scene_data(scenario: Scenario, recording: Recording) -> dict[str, Any] | None:
    """What is drawn of a run; None: nothing."""
    run = Run(scenario, recording)
    if run.scenario.remote:
        return remote_axis(run, run.scenario.remote)
    scenes: dict[str, Callable[[Run], dict[str, Any]]] = {
        "CutToLength": belt.cut_to_length,
        "FlyingSaw": belt.flying_saw,
        "Follower": _follower,
        "Gearing": axes.gearing,
        "Synchronizer": axes.synchronizer,
    }
    make = scenes.get(run.scenario.recipe.name)
    return make(run) if make else None


def _follower(run: Run) -> dict[str, Any]:
    return axes.follower(run) if run.start("slave_cycle") else belt.follower(run)


@cache
def _text(name: str) -> str:
    return (HERE / name).read_text("utf-8")
