"""The cuts or pieces of a run: of a saw whose marks the scenario gives, or of a block that reports its pieces; and what
is true of them where the block does not know the true places."""

from dataclasses import dataclass
from functools import cached_property

from ..recording import Recording
from ..scenario import Scenario
from .cuts import Cut, find_cuts, find_uncut_marks
from .production import Production, evaluate_production
from .true_pieces import TruePieces, find_true_pieces


@dataclass(frozen=True)
class CuttingResults:
    """The cuts and pieces of a run of a scenario, computed at the first access."""

    scenario: Scenario
    recording: Recording

    @cached_property
    def cuts(self) -> tuple[Cut, ...]:
        """The cuts in the order of time; empty if the scenario has no marks."""
        spec = self.scenario.cuts
        return tuple(find_cuts(spec, self.recording, self.scenario.slave_period)) if spec else ()

    @cached_property
    def uncut(self) -> tuple[float, ...]:
        """The positions of the marks that passed the saw without a cut, in u, in the sequence of passing."""
        spec = self.scenario.cuts
        return tuple(find_uncut_marks(spec, self.cuts, self.recording)) if spec else ()

    @property
    def missed_marks(self) -> tuple[float, ...]:
        """Those of them that passed after the first cut: each leaves a piece in which two are merged."""
        if not self.cuts:
            return ()
        first, runs_forwards = self.cuts[0].mark, self.recording.master[-1, 0] >= self.recording.master[0, 0]
        return tuple(mark for mark in self.uncut if (mark > first) == runs_forwards)

    @cached_property
    def production(self) -> Production | None:
        """What was made by a block that reports its pieces; None: it does not."""
        return evaluate_production(self.scenario, self.recording)

    @cached_property
    def true_pieces(self) -> TruePieces | None:
        """The pieces as a tape measure finds them; None: nothing is cut, or the block knows the true places."""
        return find_true_pieces(self.scenario, self.recording, self.production, self.cuts)
