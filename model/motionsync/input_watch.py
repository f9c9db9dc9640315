"""What can be seen to be wrong with the master's inputs: counts, jumps, velocities and positions that are nonsense.

A wrong input looks like a line, and the block follows it. So nothing here changes what the block does; it is reported.
Source: the rules are motionsync's own.
"""

from dataclasses import dataclass

from . import var
from .numerics.computable_range import clamp
from .var import Enumeration

ROUNDED = 1e-8  # of the position: a difference up to here may be rounding, and harms nobody
ALTERNATIONS = 30  # of the second difference, between two values: no line does that, but a counter
ENOUGH = 30  # samples, after which a line is known; in a row, what no line does by chance
OUTSTANDING = 10.0  # times the greatest change so far, and the one that the velocity allows: so much is a jump
CALM = 0.1  # of a jump's velocity: the next change is no greater, since a line that has sped up does not stop at once
CONTRADICTION = 0.5  # of the greater one: so far are a change and what the velocity says of it apart
INDISTINCT = 2e-7  # of the position: a line that creeps by up to here is at rest, in single precision
STUCK = 100.0  # times the greatest change: so far a line has run while its position stays the same
QUIET_TIME = 10.0 * (1.0 - 1e-9)  # s, but for the rounding of a sum; the log ends its episodes after 10 s, too
GREATEST = 1e100  # of a quotient: a very small divisor does not make it infinite


class InputWarning(Enumeration):
    """What is wrong with the master's inputs"""

    NONE = 0, "nothing that can be seen"
    COUNTS = (
        1,
        "master.position comes in counts, as from an encoder, and the setpoint jumps with them; "
        "master.input_mode MEASURED smooths it",
        "master.position",
    )
    JUMP = (
        2,
        "master.position jumps by master.likely_period; if its counter wraps there, set master.period",
        "master.likely_period",
        "master.period",
    )
    VELOCITY = (
        3,
        "master.velocity is master.velocity_ratio times the change of master.position: its unit, its sign, or it is "
        "not wired",
        "master.velocity_ratio",
        "master.velocity",
    )
    FROZEN = (
        5,
        "master.position does not change while master.velocity says that the line runs: an encoder that broke, or "
        "position and velocity swapped",
        "master.position",
        "master.velocity",
    )


@dataclass(slots=True)
class InputWatch:
    """Finds out what is wrong with a master's samples. Positions are unwrapped; a `change` is that of the position
    since the sample before, u, an `h` the time since then, s.

    A finding above COUNTS begins an episode, or goes on with it. The episode is over when there has been none for 10 s.
    Each code is shown once in it, from where it is seen first until another one is: so the log has one line for each,
    even if two are seen in turns. COUNTS, which is seen all the time, is shown outside of episodes.
    """

    code: InputWarning = InputWarning.NONE
    likely_period: float = 0.0  # u; by how much the last jump was off
    velocity_ratio: float = 0.0  # the given velocity by that of the position, where they last contradicted each other
    quiet_time: float = 0.0  # since the last finding of the episode
    has_shown_jump: bool = False
    has_shown_velocity: bool = False
    has_shown_frozen: bool = False

    # How many samples there have been, and the last one: a velocity that is not given is 0.
    samples: int = var.count(ENOUGH)
    change: float = 0.0
    h: float = 0.0
    has_velocity: bool = False
    velocity: float = 0.0
    acceleration: float = 0.0

    # Of a line of constant velocity that comes in counts the second differences are 0, one count up and one down, the
    # last two in turns. An ideal line has constant ones; noise has any.
    second_difference: float = 0.0  # u; the last one that is not 0 but for rounding
    alternations: int = 0

    # The greatest change and velocity of all samples but jumps, u and u/s; and of a change that is a jump if the next
    # one is small, its velocity and by how much it is off, u.
    greatest_change: float = 0.0
    greatest_velocity: float = 0.0
    is_jump_pending: bool = False
    pending_velocity: float = 0.0
    pending_excess: float = 0.0

    # Samples in a row: whose change contradicts the velocity, with the travel by either, u; and without a change.
    contradictions: int = 0
    row_change: float = 0.0
    row_travel: float = 0.0
    unchanged: int = 0
    unchanged_travel: float = 0.0  # by the velocity, forwards and back

    def add_unsmoothed(self, position: float, change: float, h: float) -> None:
        """Look for counts in a sample that nothing smooths; `add` comes next."""
        second_difference = change - self.change
        if self.samples < 2 or abs(second_difference) <= ROUNDED * (abs(position) + abs(change)):
            return
        error = abs(second_difference + self.second_difference)
        is_alternating = error <= 1e-3 * abs(second_difference) and abs(h - self.h) <= 1e-9 * h
        self.alternations = min(self.alternations + 1, ALTERNATIONS) if is_alternating else 0
        self.second_difference = second_difference
        if self.alternations == ALTERNATIONS and self.code == InputWarning.NONE:
            self.code = InputWarning.COUNTS

    def add(
        self, position: float, change: float, h: float, has_velocity: bool, velocity: float, acceleration: float
    ) -> None:
        """Look for all else, and keep the sample. Velocity and acceleration, u/s and u/s2, are 0 if they are not given;
        change and h of the first sample mean nothing."""
        if self.samples > 0:
            seen = InputWarning.NONE
            distance = abs(change)
            if has_velocity and self.has_velocity:
                travel = 0.5 * (self.velocity + velocity) * h
                if abs(change - travel) > CONTRADICTION * max(distance, abs(travel)):
                    seen = self.try_find_contradiction(position, change, travel, h, velocity, acceleration)
                else:
                    self.contradictions = 0
                    self.unchanged = self.unchanged if change == 0.0 else 0
            else:
                self.contradictions = 0
                self.unchanged = 0
            if (
                self.is_jump_pending or distance > self.greatest_change or distance > self.greatest_velocity * h
            ) and self.try_find_jump(change, h, has_velocity, velocity, acceleration):
                seen = InputWarning.JUMP
            if self.code != InputWarning.NONE or seen != InputWarning.NONE:
                self.show(seen, h)
        self.samples = min(self.samples + 1, ENOUGH)
        self.change = change
        self.h = h
        self.has_velocity = has_velocity
        self.velocity = velocity
        self.acceleration = acceleration

    def try_find_contradiction(
        self, position: float, change: float, travel: float, h: float, velocity: float, acceleration: float
    ) -> InputWarning:
        """VELOCITY or FROZEN, if the change of this sample and of many before it is not at all the travel, u, that the
        velocity says."""
        if change == 0.0:
            self.contradictions = 0
            return self.try_find_frozen(position, h, velocity)
        self.unchanged = 0
        strength = max(abs(self.acceleration), abs(acceleration))
        tolerance = max(0.5 * strength * h * h, ROUNDED * (abs(position) + abs(change)))
        if abs(change - travel) <= tolerance:
            self.contradictions = 0
            return InputWarning.NONE
        if self.contradictions == 0 or (change > 0.0) != (self.row_change > 0.0):
            self.contradictions = 0
            self.row_change = 0.0
            self.row_travel = 0.0
        self.contradictions = min(self.contradictions + 1, ENOUGH)
        self.row_change += change
        self.row_travel += travel
        if self.contradictions < ENOUGH:
            return InputWarning.NONE
        self.velocity_ratio = clamp(self.row_travel / self.row_change, -GREATEST, GREATEST)
        return InputWarning.VELOCITY

    def try_find_frozen(self, position: float, h: float, velocity: float) -> InputWarning:
        """FROZEN, if the position has been the same for many samples in which the line runs, and it should be far away
        by now."""
        if self.unchanged == 0:
            self.unchanged_travel = 0.0
        self.unchanged = min(self.unchanged + 1, ENOUGH)
        self.unchanged_travel += 0.5 * (abs(self.velocity) + abs(velocity)) * h
        should_be_away = self.unchanged_travel > max(STUCK * self.greatest_change, INDISTINCT * abs(position))
        return InputWarning.FROZEN if self.unchanged == ENOUGH and should_be_away else InputWarning.NONE

    def try_find_jump(self, change: float, h: float, has_velocity: bool, velocity: float, acceleration: float) -> bool:
        """Whether the change before this one was a jump; this one may be the next."""
        distance = abs(change)
        was_jump = self.is_jump_pending and distance <= CALM * self.pending_velocity * h
        if was_jump:
            self.likely_period = self.pending_excess
        elif self.is_jump_pending:
            self.include(abs(self.change), self.pending_velocity)
        self.is_jump_pending = False
        if distance > self.greatest_change or distance > self.greatest_velocity * h:
            self.take_greatest(change, h, has_velocity, velocity, acceleration)
        return was_jump

    def take_greatest(self, change: float, h: float, has_velocity: bool, velocity: float, acceleration: float) -> None:
        """A change that is greater than ever, or faster: whether it may be a jump.

        The first one is none: it may be the first count of a line that creeps."""
        distance = abs(change)
        quotient = min(distance / h, GREATEST)
        speed = max(abs(self.velocity), abs(velocity))
        strength = max(abs(self.acceleration), abs(acceleration))
        usual = max(self.greatest_change, self.greatest_velocity * h, (speed + 0.5 * strength * h) * h)
        if self.samples >= ENOUGH - 1 and distance > OUTSTANDING * usual and self.greatest_change > 0.0:
            is_given = has_velocity and self.has_velocity
            expected = 0.5 * (self.velocity + velocity) * h if is_given else self.change / self.h * h
            self.is_jump_pending = True
            self.pending_velocity = quotient
            self.pending_excess = min(abs(change - expected), GREATEST)
        else:
            self.include(distance, quotient)

    def include(self, distance: float, velocity: float) -> None:
        """A change of this distance that is none of a jump."""
        self.greatest_change = max(self.greatest_change, distance)
        self.greatest_velocity = max(self.greatest_velocity, velocity)

    def show(self, seen: InputWarning, h: float) -> None:
        """Begin an episode with a finding, go on with it, or end it without one."""
        if seen == InputWarning.NONE:
            self.quiet_time += h
            if self.code != InputWarning.COUNTS and self.quiet_time >= QUIET_TIME:
                self.code = InputWarning.NONE
            return
        if self.code <= InputWarning.COUNTS:
            self.has_shown_jump = False
            self.has_shown_velocity = False
            self.has_shown_frozen = False
        self.quiet_time = 0.0
        match seen:
            case InputWarning.JUMP:
                self.code = self.code if self.has_shown_jump else seen
                self.has_shown_jump = True
            case InputWarning.VELOCITY:
                self.code = self.code if self.has_shown_velocity else seen
                self.has_shown_velocity = True
            case _:
                self.code = self.code if self.has_shown_frozen else seen
                self.has_shown_frozen = True
