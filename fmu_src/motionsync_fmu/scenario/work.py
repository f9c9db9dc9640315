"""What was cut or made in a run: by a saw whose marks the scenario gives, or by a block that tells its pieces."""

from dataclasses import dataclass
from functools import cached_property

from .cuts import Cut, find_cuts
from .production import Production, production
from .recording import Recording
from .scenario import Scenario


@dataclass(frozen=True)
class Work:
    """What was cut or made in a run of a scenario; it is found when it is first asked for."""

    scenario: Scenario
    recording: Recording

    @cached_property
    def cuts(self) -> tuple[Cut, ...]:
        """The cuts in the order of time; empty if the scenario has no marks."""
        return tuple(find_cuts(self.scenario.cuts, self.recording)) if self.scenario.cuts else ()

    @cached_property
    def production(self) -> Production | None:
        """What was made by a block that tells its pieces; None: it does not."""
        return production(self.scenario, self.recording)
