"""The animated picture of a run's machine, as one part of a page. It needs no library; its colours are in colours.css.

Where a page has plots, too, both share their time by the event `motionsync:time` of the document, whose detail has the
`time` in s and the `source`: "machine" or "plots".
"""

from functools import cache
from pathlib import Path

from markupsafe import Markup

from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..packed import packed_json
from ..style import TEMPLATES, load_template
from .recorded import recorded_machine

FOLDER = Path(__file__).parent
PLACEHOLDER = "/* fragment.py puts the scenes here */\n"  # in machine.js
SCENES = ("axes.js", "belt.js", "cylinder.js", "window.js")
RECORDED = ("../packed.js", "machine_data.js", "recorded.js")  # what makes and loads a scene of a recording


def machine(scenario: Scenario, recording: Recording) -> Markup:
    """The picture of the run, with a slider, a play button and readouts; empty for a block that has no picture."""
    data = recorded_machine(scenario, recording)
    if data is None:
        return Markup("")
    scenes = {"window"} if scenario.remote else {picture["scene"] for picture in data["block"]["pictures"]}
    return _rendered(packed_json(data), *(f"{scene}.js" for scene in sorted(scenes)), *RECORDED)


def live_machine() -> Markup:
    """The picture of a run that the page itself makes, and hands over as `motionsyncMachine.load(data)`: see
    machine_data.js."""
    return _rendered("", *SCENES)


def _rendered(data: str, *scripts: str) -> Markup:
    code = _text("machine.js").replace(PLACEHOLDER, "\n".join(map(_text, scripts)))
    page = load_template(TEMPLATES, "machine.html.j2")
    return Markup(page.render(data=data, style=Markup(_text("machine.css")), code=Markup(code)))


@cache
def _text(name: str) -> str:
    return (FOLDER / name).read_text("utf-8")
