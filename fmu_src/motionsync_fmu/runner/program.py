"""The program of a run: what is set at times, and as reactions to outputs; and the drive of a master that follows one.

What a scan sets acts from it on, or `after` seconds later."""

from dataclasses import dataclass
from math import inf

from motionsync import var
from motionsync.var import Enumeration

from .axis import Axis
from .points import Points, rounded

COMPARISON_MARGIN = 1e-9  # of a value, at least of 1: by so much it is beyond another, or else it is equal


class Comparison(Enumeration):
    LESS = 0, "less than the value"
    GREATER = 1, "greater than the value"
    EQUAL = 2, "the value"


@dataclass(slots=True)
class Reactions:
    """The reactions, one element each.

    Attributes:
        output: which of the outputs that the program sees is compared.
        comparison: a Comparison.
        value: what it is compared with.
        after: how long after the scan it sets, s.
        most: how often it happens at most; -1: any number of times.
        held: whether the condition held at the latest sample, 1 or 0.
        happened: how often it has happened.
    """

    output: var.Wholes = var.series()
    comparison: var.Wholes = var.series()
    value: var.Reals = var.series()
    after: var.Reals = var.series()
    most: var.Wholes = var.series()
    held: var.Wholes = var.series()
    happened: var.Wholes = var.series()


@dataclass(slots=True)
class Program:
    """What is set when. Values of all kinds are doubles here; the variables that it sets, and those that it sees, have
    numbers from 0.

    Attributes:
        at: when something is set, s, in this order; the series has space for what reactions set.
        what: what is set then, a bundle of assignments: those of the settings come first, then those of the reactions.
        count: how many there are so far.
        taken: how many of them have been set.
        next: when the next one is, s; infinite: never.
        first: the first assignment of each bundle, and behind all the number of assignments.
        target: the variable that each assignment sets.
        amount: the value, or what is added to the present value.
        adds: 1: it is added; 0: it is set.
        values: the present values of the variables that are set.
        outputs: the present values of the outputs that are seen; the host writes them before a sample.
        reactions: what it does about them.
        settings: how many bundles belong to the settings.
        follows: which of the outputs is the velocity that the master follows; -1: it is scripted.
        gain: the share of the distance to that velocity by which a lag of first order comes nearer in a scan.
        max_acceleration: of the drive, u/s2; infinite: it has no limit.
    """

    at: var.Reals = var.series()
    what: var.Wholes = var.series()
    count: int = 0
    taken: int = 0
    next: float = 0.0
    first: var.Wholes = var.series()
    target: var.Wholes = var.series()
    amount: var.Reals = var.series()
    adds: var.Wholes = var.series()
    values: var.Reals = var.series()
    outputs: var.Reals = var.series()
    reactions: Reactions = var.part(Reactions)
    settings: int = 0
    follows: int = -1
    gain: float = 0.0
    max_acceleration: float = 0.0

    def set_values(self, until: float) -> None:
        """Set what is due up to a time."""
        while self.next <= until:
            bundle = self.what[self.taken]
            self.taken += 1
            self.next = self.at[self.taken] if self.taken < self.count else inf
            for i in range(self.first[bundle], self.first[bundle + 1]):
                k = self.target[i]
                self.values[k] = self.values[k] + self.amount[i] if self.adds[i] == 1 else self.amount[i]

    def begin(self) -> None:
        """Sample the outputs at time 0: a condition that is true there has not become true."""
        self.next = self.at[0] if self.count > 0 else inf
        for i in range(len(self.reactions.held)):
            self.reactions.held[i] = 1 if self.holds(i) else 0

    def sample(self, axis: Axis, points: Points) -> None:
        """Sample the outputs: what becomes true is reacted to from the scan on, and a master with a drive follows."""
        scan = points.sample_scan
        if self.follows >= 0:
            axis.go_until(scan)
            requested = (self.outputs[self.follows] - axis.velocity) * self.gain / points.scan
            axis.accelerate(scan, min(max(requested, -self.max_acceleration), self.max_acceleration))
        for i in range(len(self.reactions.held)):
            held = self.reactions.held[i]
            holds = self.holds(i)
            self.reactions.held[i] = 1 if holds else 0
            if holds and held == 0 and self.reactions.happened[i] != self.reactions.most[i]:
                time = rounded(scan + self.reactions.after[i])
                if time < points.stop_time:
                    self.reactions.happened[i] += 1
                    self.add(time, self.settings + i)
        points.advance_sample()

    def holds(self, i: int) -> bool:
        """Whether the condition of a reaction holds."""
        value = self.reactions.value[i]
        difference = self.outputs[self.reactions.output[i]] - value
        margin = COMPARISON_MARGIN * max(1.0, abs(value))
        comparison = self.reactions.comparison[i]
        if comparison == Comparison.LESS:
            return difference < -margin
        return difference > margin if comparison == Comparison.GREATER else abs(difference) <= margin

    def add(self, time: float, bundle: int) -> None:
        """Let something be set at a time, after all else that is set then."""
        i = self.count
        while i > self.taken and self.at[i - 1] > time:
            self.at[i] = self.at[i - 1]
            self.what[i] = self.what[i - 1]
            i -= 1
        self.at[i] = time
        self.what[i] = bundle
        self.count += 1
        self.next = self.at[self.taken]
