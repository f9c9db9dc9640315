"""The four ways to make axis values of what was received, and the blending from one to another.

Source: TwinCAT TS5066, modes of the axis values and blending time.
"""

from dataclasses import dataclass

from ..var import Enumeration


class Mode(Enumeration):
    """Where the axis values come from"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"
    SYNC = 3, "shifted in time by the correction, the drift being known"
    TIME = 4, "shifted in time by the correction before the drift is known"


@dataclass(slots=True)
class Blending:
    """How much of each mode is in the values.

    From a change of mode on all weights move linearly from where they are; they add up to 1. `cycles` counts from the
    change."""

    mode: Mode = Mode.BYPASS
    cycles: int = 0
    bypass: float = 1.0
    pt1: float = 0.0
    shifted: float = 0.0
    from_bypass: float = 1.0
    from_pt1: float = 0.0
    from_shifted: float = 0.0

    def begin(self, mode: Mode) -> None:
        """All of one mode."""
        self.to(mode)
        self.weigh(0.0)
        self.to(mode)

    def advance(self, mode: Mode, length: float) -> None:
        """The weights of a cycle, in which a change of mode only begins; `length`: of the blending, in cycles."""
        self.weigh(length)
        if mode != self.mode:
            self.to(mode)
            self.weigh(length)
        if self.cycles < length:
            self.cycles += 1

    def to(self, mode: Mode) -> None:
        """From the present weights to a mode."""
        self.mode = mode
        self.cycles = 0
        self.from_bypass = self.bypass
        self.from_pt1 = self.pt1
        self.from_shifted = self.shifted

    def weigh(self, length: float) -> None:
        share = 1.0 if self.cycles >= length else self.cycles / length
        self.bypass = mixed(self.from_bypass, self.mode == Mode.BYPASS, share)
        self.pt1 = mixed(self.from_pt1, self.mode == Mode.PT1, share)
        self.shifted = mixed(self.from_shifted, self.mode in (Mode.SYNC, Mode.TIME), share)


def mixed(before: float, wanted: bool, share: float) -> float:
    return (1.0 - share) * before + (share if wanted else 0.0)
