"""A block around the slave's own motion: for tests of its compiled code.

It has a module of its own, since the functions of a test module are wrapped and cannot be compiled.
"""

from dataclasses import dataclass

from motionsync import var
from motionsync.flying_saw.faults import Refusal
from motionsync.motion.jerk_limited import Motion


@dataclass(slots=True)
class Planner:
    """Each step plans the motion that `kind` selects from the numbers in `given` (0: none), and advances it."""

    motion: Motion = var.part(Motion)
    kind: int = 0
    given: list[float] = var.array(8)
    steps: int = 1
    reached: bool = False
    end: float = 0.0
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0

    def initialize(self) -> Refusal:
        self.motion.start(self.given[0], self.given[1], 0.0)
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        x = self.given
        if self.kind > 0:
            self.motion.start(x[0], x[1], x[2])
        match self.kind:
            case 1:
                self.motion.move(x[3], x[4], x[5], x[6], x[7])
            case 2:
                self.reached = self.motion.try_change(x[3], x[4], -x[5], x[6], x[7])
            case 3:
                self.motion.halt(x[6], x[7])
            case _:
                pass
        for _ in range(self.steps):
            self.motion.advance(h)
        p, v, a, j = self.motion.at(0.0)
        self.position = p
        self.velocity = v
        self.acceleration = a
        self.jerk = j
        self.end = self.motion.end_time()
        return Refusal.NONE
