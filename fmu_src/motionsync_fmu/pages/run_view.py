"""A run at a glance, for a cell of a notebook: the verdict, the machine's picture and the figures."""

from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.recording import Recording
from ..scenario.scenario import Scenario
from .machine.fragment import machine
from .style import TEMPLATES, load_template
from .summary import figure_rows


def view_run(scenario: Scenario, recording: Recording, outcome: ScenarioOutcome) -> str:
    """The text of a page, which loads nothing from elsewhere."""
    return load_template(TEMPLATES, "run_view.html.j2").render(
        scenario=scenario, outcome=outcome, machine=machine(scenario, recording), rows=[*figure_rows(outcome)]
    )
