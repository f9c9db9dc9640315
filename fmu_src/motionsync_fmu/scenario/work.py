"""What was cut or made in a run: by a saw whose marks the scenario gives, or by a block that tells its pieces."""

from dataclasses import dataclass

from ..interface.roles import books
from .cuts import Cut, find_cuts
from .production import Production, production
from .recording import Recording
from .scenario import Scenario


@dataclass(frozen=True)
class Work:
    """What was cut or made.

    Attributes:
        cuts: the cuts in the order of time; empty if the scenario has no marks.
        production: what was made by a block that tells its pieces; None: it does not.
    """

    cuts: tuple[Cut, ...]
    production: Production | None


def work(scenario: Scenario, recording: Recording) -> Work:
    """What was cut or made in a run of a scenario."""
    return Work(
        tuple(find_cuts(scenario.cuts, recording)) if scenario.cuts else (),
        production(scenario, recording),
    )


def tells_work(scenario: Scenario) -> bool:
    """Whether a run of the scenario tells what was cut or made."""
    return scenario.cuts is not None or books(scenario.recipe.variables.values()) is not None
