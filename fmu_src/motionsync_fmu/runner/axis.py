"""The axis of a run: segments of constant jerk, one after the other, from time 0 on."""

from dataclasses import dataclass
from math import inf

from motionsync import var

MOTION = 4  # numbers of a motion: position (u, unwrapped), velocity, acceleration, jerk


@dataclass(slots=True)
class Axis:
    """The motion of the axis at every time; the last segment has no end.

    Attributes:
        breaks: when each segment begins, s; the first one at 0.
        motions: the motions then, MOTION numbers each.
        count: how many segments there are; both series may have space for more.
        is_recorded: whether it was recorded by an encoder: its breaks are no points of a run.
        start_position, start_velocity, start_acceleration: the motion before time 0, as it is at 0.
        section: the present segment; the search for another one starts there.
        begin, end: the times between which it is, s; infinite: it has no end.
        from_position, from_velocity, from_acceleration: the motion at its begin; its jerk is that of all of it.
        time: the latest time, s.
        position, velocity, acceleration, jerk: the motion then.
    """

    breaks: var.Reals = var.series()
    motions: var.Reals = var.series()
    count: int = 0
    is_recorded: bool = False
    start_position: float = 0.0
    start_velocity: float = 0.0
    start_acceleration: float = 0.0
    section: int = 0
    begin: float = 0.0
    end: float = 0.0
    from_position: float = 0.0
    from_velocity: float = 0.0
    from_acceleration: float = 0.0
    time: float = -1.0
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0

    def go_to(self, t: float) -> None:
        """Go to a time; where the axis jumps then, after the jump."""
        if not self.begin <= t < self.end:
            self.enter(self.section_at(t, self.section))
        elif t == self.time:
            return
        self.show(t)

    def go_until(self, t: float) -> None:
        """Go to a time; where the axis jumps then, before the jump."""
        if not self.begin < t <= self.end:
            i = self.section_at(t, self.section)
            while i > 0 and self.breaks[i] >= t:
                i -= 1
            self.enter(i)
        self.show(t)

    def enter(self, i: int) -> None:
        """Make a segment the present one."""
        k = MOTION * i
        self.section = i
        self.begin = self.breaks[i]
        self.end = self.breaks[i + 1] if i + 1 < self.count else inf
        self.from_position = self.motions[k]
        self.from_velocity = self.motions[k + 1]
        self.from_acceleration = self.motions[k + 2]
        self.jerk = self.motions[k + 3]

    def show(self, t: float) -> None:
        """Show the motion at t, in the present segment."""
        self.time = t
        time = t - self.begin
        self.position = position_after(time, self.from_position, self.from_velocity, self.from_acceleration, self.jerk)
        self.velocity = velocity_after(time, self.from_velocity, self.from_acceleration, self.jerk)
        self.acceleration = self.from_acceleration + time * self.jerk

    def section_at(self, t: float, near: int) -> int:
        """The segment at t, at a break the later one; the search starts at the segment `near`."""
        i = near
        while i + 1 < self.count and self.breaks[i + 1] <= t:
            i += 1
        while i > 0 and self.breaks[i] > t:
            i -= 1
        return i

    def true_position(self, t: float, near: int) -> float:
        """The position at t, also before 0."""
        if t < 0.0:
            return position_after(t, self.start_position, self.start_velocity, self.start_acceleration, 0.0)
        i = self.section_at(t, near)
        k = MOTION * i
        return position_after(
            t - self.breaks[i], self.motions[k], self.motions[k + 1], self.motions[k + 2], self.motions[k + 3]
        )

    def accelerate(self, t: float, a: float) -> None:
        """Let the axis go on from t with another acceleration; where there is no more space, its first segment is
        lost."""
        self.go_until(t)
        if self.count == len(self.breaks):
            self.count -= 1
            for i in range(self.count):
                self.breaks[i] = self.breaks[i + 1]
            for i in range(MOTION * self.count):
                self.motions[i] = self.motions[i + MOTION]
            self.section = max(self.section - 1, 0)
        k = MOTION * self.count
        self.breaks[self.count] = t
        self.motions[k] = self.position
        self.motions[k + 1] = self.velocity
        self.motions[k + 2] = a
        self.motions[k + 3] = 0.0
        self.count += 1
        self.end = t


def position_after(time: float, position: float, v: float, a: float, j: float) -> float:
    """The position a time later, with constant jerk."""
    return position + time * (v + time * (a / 2.0 + time * j / 6.0))


def velocity_after(time: float, v: float, a: float, j: float) -> float:
    """The velocity then."""
    return v + time * (a + time * j / 2.0)
