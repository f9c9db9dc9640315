"""The blending from one mode of the axis values to another. Source: TwinCAT TS5066, blending time."""

from dataclasses import dataclass

from .interface import Mode


@dataclass(slots=True)
class ModeBlending:
    """The shares that the modes have in the axis values.

    After a change of mode all shares move linearly from their present values to the new mode's; they add up to 1.
    `cycles` counts from the change. SYNC and TIME share `shifted`: both shift the values by the correction.
    """

    mode: Mode = Mode.BYPASS
    cycles: int = 0
    bypass: float = 1.0
    pt1: float = 0.0
    shifted: float = 0.0
    from_bypass: float = 1.0
    from_pt1: float = 0.0
    from_shifted: float = 0.0

    def start(self, mode: Mode) -> None:
        """Start with all values from one mode."""
        self.start_towards(mode)
        self.set_shares(0.0)
        self.start_towards(mode)

    def advance(self, mode: Mode, length: float) -> None:
        """Compute the shares of a cycle; a change of mode starts in it. `length`: of the blending, in cycles."""
        self.set_shares(length)
        if mode != self.mode:
            self.start_towards(mode)
            self.set_shares(length)
        if self.cycles < length:
            self.cycles += 1

    def start_towards(self, mode: Mode) -> None:
        """Start from the present shares towards those of a mode."""
        self.mode = mode
        self.cycles = 0
        self.from_bypass = self.bypass
        self.from_pt1 = self.pt1
        self.from_shifted = self.shifted

    def set_shares(self, length: float) -> None:
        """Compute the shares so many `cycles` after the change."""
        part = 1.0 if self.cycles >= length else self.cycles / length
        self.bypass = blended_share(self.from_bypass, self.mode == Mode.BYPASS, part)
        self.pt1 = blended_share(self.from_pt1, self.mode == Mode.PT1, part)
        self.shifted = blended_share(self.from_shifted, self.mode in (Mode.SYNC, Mode.TIME), part)


def blended_share(before: float, is_target: bool, part: float) -> float:
    """The share of a mode after a part, 0 to 1, of the blending; at its end 1 for the blending's target, else 0."""
    return (1.0 - part) * before + (part if is_target else 0.0)
