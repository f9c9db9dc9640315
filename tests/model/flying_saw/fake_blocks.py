"""Small blocks around what the flying saw's profiles are measured with: for tests of the compiled code.

They stand alone since a module of tests, whose functions are wrapped, cannot be compiled.
"""

from dataclasses import dataclass

from motionsync import var
from motionsync.flying_saw.extremes import Extremes
from motionsync.flying_saw.profile import Profile
from motionsync.numerics.polynomial import Polynomial


@dataclass(slots=True)
class RootFinder:
    """Finds a polynomial's roots, then those of its derivative."""

    polynomial: Polynomial = var.part(Polynomial)  # noqa: RUF009

    def initialize(self) -> int:
        self.polynomial.solve()
        return 0

    def step(self, h: float) -> int:
        self.polynomial.differentiate()
        self.polynomial.solve()
        return 0


@dataclass(slots=True)
class ProfileMeasurer:
    """Measures a profile, and then also integrates; `times` times."""

    times: int = 1
    profile: Profile = var.part(Profile)  # noqa: RUF009
    extremes: Extremes = var.part(Extremes)  # noqa: RUF009

    def initialize(self) -> int:
        for _ in range(self.times):
            self.extremes.measure(self.profile)
        return 0

    def step(self, h: float) -> int:
        for _ in range(self.times):
            self.extremes.integrate(self.profile)
        return 0
