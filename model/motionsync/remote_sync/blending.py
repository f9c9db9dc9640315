"""The blending from one mode of the axis values to another.

Source: TwinCAT TS5066, blending time.
"""

from dataclasses import dataclass

from .interface import Mode


@dataclass(slots=True)
class Blending:
    """The shares that the modes have in the axis values.

    After a change of mode all shares move linearly from where they are to the new mode's; they always add up to 1.
    `cycles` counts from the change. SYNC and TIME share one share, `shifted`: both shift the values by the correction.
    """

    mode: Mode = Mode.BYPASS
    cycles: int = 0
    bypass: float = 1.0
    pt1: float = 0.0
    shifted: float = 0.0
    from_bypass: float = 1.0
    from_pt1: float = 0.0
    from_shifted: float = 0.0

    def begin(self, mode: Mode) -> None:
        """All values come from one mode."""
        self.head_for(mode)
        self.weigh(0.0)
        self.head_for(mode)

    def advance(self, mode: Mode, length: float) -> None:
        """The shares of a cycle; a change of mode begins in it. `length`: of the blending, in cycles."""
        self.weigh(length)
        if mode != self.mode:
            self.head_for(mode)
            self.weigh(length)
        if self.cycles < length:
            self.cycles += 1

    def head_for(self, mode: Mode) -> None:
        """From the present shares to a mode."""
        self.mode = mode
        self.cycles = 0
        self.from_bypass = self.bypass
        self.from_pt1 = self.pt1
        self.from_shifted = self.shifted

    def weigh(self, length: float) -> None:
        """The shares so many `cycles` after the change."""
        part = 1.0 if self.cycles >= length else self.cycles / length
        self.bypass = mixed(self.from_bypass, self.mode == Mode.BYPASS, part)
        self.pt1 = mixed(self.from_pt1, self.mode == Mode.PT1, part)
        self.shifted = mixed(self.from_shifted, self.mode in (Mode.SYNC, Mode.TIME), part)


def mixed(before: float, wanted: bool, part: float) -> float:
    """The share of a mode after a part, 0 to 1, of the blending; at its end 1 if the mode is the wanted one, else 0."""
    return (1.0 - part) * before + (part if wanted else 0.0)
