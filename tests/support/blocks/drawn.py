"""How many random examples Hypothesis draws for a test, and which."""

from collections.abc import Callable
from typing import Any, TypeVar

from hypothesis import HealthCheck, Phase, seed, settings

Test = TypeVar("Test", bound=Callable[..., Any])

AS_DRAWN = (Phase.explicit, Phase.reuse, Phase.generate)
shares = {"examples": 1.0}
"""How many times as many examples this run draws as the tests ask for."""


def draw_times(share: float) -> None:
    """From now on a test gets so many times as many examples, at least 5; to be called before tests are imported."""
    shares["examples"] = share
    settings.register_profile("project", max_examples=_number(100))
    settings.load_profile("project")


def drawn(examples: int = 100, *, anew: bool = False, shrink: bool = True) -> Callable[[Test], Test]:
    """Decorates a test that has `given`: so many examples, the same ones every time; `anew`: other ones each time.

    `shrink`: False where to make a failing example smaller would take minutes, or shows nothing, as of a seed. The seed
    is fixed, since without one Hypothesis takes the test's text: a rename would draw other examples. How long an
    example takes is no failure.
    """
    phases = Phase if shrink else AS_DRAWN
    chosen = settings(
        deadline=None,
        derandomize=not anew,
        max_examples=_number(examples),
        phases=phases,
        suppress_health_check=list(HealthCheck),
    )

    def decorate(test: Test) -> Test:
        return chosen(test) if anew else seed(0)(chosen(test))

    return decorate


def _number(examples: int) -> int:
    return max(round(examples * shares["examples"]), 5)
