"""Which of several machines is the better one for some orders."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from motionsync.var import Unit

from ..scenario.engineering import engineering, line_speed
from .machine import Machine

DIGITS = 4
MOST_NAMED = 6  # orders that a sentence names each
SAME = 1e-9  # relative: velocities that differ by less are the same


@dataclass(frozen=True)
class ComparedMachine:
    """A machine, and how fast the line may run for each order.

    Attributes:
        label: the machine in a sentence: "the saw", or its title where there are several of its kind.
        velocities: the greatest line velocity for each order, in u/s; 0: none.
        line_velocity: the line velocity for which the orders are compared; None: none is given.
    """

    machine: Machine
    label: str
    orders: Sequence[float]
    velocities: Sequence[float]
    line_velocity: float | None

    @property
    def velocity(self) -> float:
        """The greatest line velocity at which all orders are cut."""
        return min(self.velocities)

    @property
    def critical_order(self) -> float:
        """The order that limits this velocity."""
        return min(zip(self.velocities, self.orders, strict=True))[1]

    @cached_property
    def reached(self) -> list[float]:
        """The orders that are cut at the line velocity that is asked for; without one those that are cut at all."""
        return [
            order
            for order, velocity in zip(self.orders, self.velocities, strict=True)
            if (velocity >= self.line_velocity * (1.0 - SAME) if self.line_velocity else velocity > 0.0)
        ]

    @property
    def reaches_all(self) -> bool:
        return len(self.reached) == len(self.orders)

    @property
    def margin(self) -> float | None:
        """By what share the line might be faster with all orders; None: no line velocity is given."""
        return self.velocity / self.line_velocity - 1.0 if self.line_velocity else None


@dataclass(frozen=True)
class Comparison:
    """How machines do at the same orders.

    Attributes:
        orders: the lengths that are to be cut, in u.
        line_velocity: the line velocity at which they are to be cut, in u/s; None: as fast as possible.
    """

    orders: Sequence[float]
    line_velocity: float | None
    machines: Sequence[ComparedMachine]

    @property
    def better(self) -> ComparedMachine | None:
        """The machine that reaches more of the orders, or as many and lets the line run faster; None: they are
        alike."""
        first, second = sorted(self.machines, key=lambda c: (len(c.reached), c.velocity), reverse=True)[:2]
        if len(first.reached) == len(second.reached) and first.velocity <= second.velocity * (1.0 + SAME):
            return None
        return first

    @property
    def sentence(self) -> str:
        """Which machine is the better one for the orders, and why."""
        better = self.better
        others = [f"{c.label} {self._describe(c)}" for c in self.machines if c is not better]
        if better is None:
            return f"No machine is better for {self._subject()}: {'; '.join(others)}."
        text = f"{better.label} is the better machine for {self._subject()}: it {self._describe(better)}"
        return f"{text[0].upper()}{'; '.join([text[1:], *others])}."

    def _subject(self) -> str:
        """The orders, in words."""
        pieces = f"pieces of {self._lengths(self.orders)}"
        return f"{pieces} at {self._speed(self.line_velocity)}" if self.line_velocity else pieces

    def _describe(self, compared: ComparedMachine) -> str:
        """What a machine does with the orders, in words."""
        if compared.reaches_all:
            limit = f"up to {self._speed(compared.velocity)}"
            if compared.margin is not None:
                limit = f"with a margin of {100.0 * compared.margin:.3g} %, {limit}"
            by = f", limited by those of {self._lengths([compared.critical_order])}" if self.orders[1:] else ""
            return f"cuts them {limit}{by}"
        cut = "cuts none of them" if not compared.reached else f"cuts only those of {self._lengths(compared.reached)}"
        if compared.velocity <= 0.0:
            return f"{cut}, and those of {self._lengths([compared.critical_order])} at no line velocity"
        return f"{cut}, and all of them up to {self._speed(compared.velocity)}"

    def _lengths(self, lengths: Sequence[float]) -> str:
        """Lengths in words: `300, 400 and 600 mm`."""
        *first, last = (engineering(length, digits=DIGITS) for length in lengths)
        text = f"{', '.join(first)} and {last}" if first else last
        if len(first) >= MOST_NAMED:
            text = f"{len(lengths)} lengths from {first[0]} to {last}"
        return f"{text} {self.machines[0].machine.unit_of(Unit.POSITION)}".rstrip()

    def _speed(self, velocity: float) -> str:
        return line_speed(velocity, self.machines[0].machine.unit, digits=DIGITS)

    def as_json(self) -> dict[str, Any]:
        better = self.better
        return {
            "sentence": self.sentence,
            "better": better.machine.title if better else None,
            "line_velocity": self.line_velocity,
            "orders": [*self.orders],
            "greatest_velocities": {c.machine.title: [*c.velocities] for c in self.machines},
        }


def compare(machines: Sequence[Machine], orders: Sequence[float], line_velocity: float | None) -> Comparison:
    """Compare machines for orders of these lengths, in rising sequence; `line_velocity`: as for `Comparison`."""
    kinds = [machine.kind for machine in machines]
    compared = [
        ComparedMachine(
            machine,
            f"the {machine.kind}" if kinds.count(machine.kind) == 1 else machine.title,
            orders,
            [machine.predict_greatest_velocity(order).velocity for order in orders],
            line_velocity,
        )
        for machine in machines
    ]
    return Comparison(orders, line_velocity, compared)
