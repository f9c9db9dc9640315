"""The times of a run: its communication points, and the scans of the controller that its reactions represent.

The scan is a cycle, the step size in the scenario's file, whatever the step size of the run is. At each of its
multiples the controller uses outputs that were sampled SAMPLE_LEAD of a scan earlier: what happens exactly at a scan is
seen at the next one, independently of rounding."""

from dataclasses import dataclass
from math import floor, inf

from motionsync import var

from .axis import Axis

CLOSE = 1e-9  # of a step: communication points nearer to one another are one
SAMPLE_LEAD = 1.0 / 128.0  # of a scan: how long before it the outputs are sampled
UNIT = 1e12  # units of the last decimal of a scan's time in 1 s: then a time that is typed is the same number
UNIT_HIGH = 999999995904.0  # UNIT is the sum of two numbers of half as many bits
UNIT_LOW = 4096.0
SPLIT = 134217729.0  # 2^27 + 1
LONG = 8192.0  # s; from here on, neighbouring numbers are more than a unit of the last decimal apart


@dataclass(slots=True)
class Points:
    """The communication points that a run has in any case, one after the other: a regular grid, the times that are
    named, the breaks of the axis, and the scans. So everything happens at its own time at every step size.

    Attributes:
        step_size: of the run, s.
        stop_time: the end of the run, s.
        scan: the length of a scan, s; 0: there are none.
        has_drive: whether the motion changes at scans, not at breaks.
        named: further times, rising, the last one the end.
        close: times nearer to one another are one point, s.
        next: the next point, s; infinite: there is none.
        grid, named_time, break_time, point_scan: the next time of each kind; infinite: there is none.
        grid_number, named_number, break_number, point_number: their numbers.
        last_of_grid: the number of the last time of the grid.
        other: the next time that is named or a break.
        event: the next time that is not one of the grid alone.
        sample_number, sample_scan: number and time of the next scan for which the outputs are sampled.
        sample: when they are, s; infinite: never.
    """

    step_size: float = 0.0
    stop_time: float = 0.0
    scan: float = 0.0
    has_drive: bool = False
    named: var.Reals = var.series()
    close: float = 0.0
    next: float = 0.0
    grid: float = 0.0
    named_time: float = 0.0
    break_time: float = 0.0
    point_scan: float = 0.0
    grid_number: int = 0
    named_number: int = 0
    break_number: int = 1
    point_number: int = 1
    last_of_grid: int = 0
    other: float = 0.0
    event: float = 0.0
    sample_number: int = 1
    sample_scan: float = 0.0
    sample: float = 0.0

    def begin(self, axis: Axis) -> None:
        """Go to the first point."""
        self.close = CLOSE * self.step_size
        self.last_of_grid = int(self.stop_time / self.step_size * (1.0 + 1e-12))
        self.point_scan = self.scan_time(1)
        self.sample_scan = self.point_scan
        self.sample = self.sample_scan - SAMPLE_LEAD * self.scan
        self.find_other(axis)
        self.event = min(self.other, self.point_scan)
        self.advance(axis)

    def advance(self, axis: Axis) -> None:
        """Go to the next point. Of times that are close to one another one remains: a time of the grid gives way to
        another one after it, and so does any time at which the motion does not change."""
        if self.event - self.grid > self.close:
            self.next = self.grid
            self.advance_grid()
            return
        self.next = min(self.grid, self.event)
        if self.next == inf:
            return
        is_break = self.is_break(self.next)
        self.pass_time(axis, self.next)
        time = min(self.grid, self.event)
        while time - self.next <= self.close:
            is_replaced = time == self.event and not is_break
            if is_replaced:
                is_break = self.is_break(time)
                self.next = time
            self.pass_time(axis, time)
            time = min(self.grid, self.event)

    def is_break(self, t: float) -> bool:
        """Whether the motion changes at one of the next times. Such a point is exactly there, so that `go_until` gives
        the motion that ends there."""
        return t == self.point_scan if self.has_drive else t in (0.0, self.break_time)

    def pass_time(self, axis: Axis, t: float) -> None:
        """Leave behind all that is at t."""
        if self.grid <= t:
            self.advance_grid()
        if self.point_scan <= t:
            number = self.point_number + 1
            self.point_scan = self.sample_scan if number == self.sample_number else self.scan_time(number)
            self.point_number = number
        while self.other <= t:
            if self.named_time <= t:
                self.named_number += 1
            if self.break_time <= t:
                self.break_number += 1
            self.find_other(axis)
        self.event = min(self.other, self.point_scan)

    def advance_grid(self) -> None:
        self.grid_number += 1
        self.grid = float(self.grid_number) * self.step_size if self.grid_number <= self.last_of_grid else inf

    def find_other(self, axis: Axis) -> None:
        """Find the next time that is named, and the next break: neither a recorded line nor a master with a drive has
        such points."""
        self.named_time = self.named[self.named_number] if self.named_number < len(self.named) else inf
        self.break_time = inf
        if not self.has_drive and not axis.is_recorded and self.break_number < axis.count:
            time = axis.breaks[self.break_number]
            self.break_time = time if time <= self.stop_time else inf
        self.other = min(self.named_time, self.break_time)

    # --- scans ---

    def advance_sample(self) -> None:
        """Go to the next sample."""
        number = self.sample_number + 1
        self.sample_scan = self.point_scan if number == self.point_number else self.scan_time(number)
        self.sample_number = number
        self.sample = self.sample_scan - SAMPLE_LEAD * self.scan

    def scan_time(self, number: int) -> float:
        """The time of a scan, s; infinite if it is not before the end of the run."""
        time = rounded(float(number) * self.scan) if self.scan > 0.0 else inf
        return time if time < self.stop_time else inf


def rounded(t: float) -> float:
    """A time, in s, at least 0, with 12 decimals: the nearest one, and of two the even one.

    The time in units of the last decimal is the sum of two numbers: the product as it is rounded, and the product's
    error, which Dekker's algorithm finds exactly (T. J. Dekker 1971, Mul12). Together they determine the nearest whole
    number of units. Its quotient is the nearest number to that decimal fraction."""
    if t >= LONG:
        return t
    units = t * UNIT
    most = SPLIT * t
    high = most - (most - t)
    low = t - high
    error = low * UNIT_LOW - (units - high * UNIT_HIGH - low * UNIT_HIGH - high * UNIT_LOW)
    nearest = float(round(units))
    above = units - nearest
    is_odd = 2.0 * floor(0.5 * nearest) != nearest
    if error > 0.5 - above or (error == 0.5 - above and is_odd):
        nearest += 1.0
    elif error < -0.5 - above or (error == -0.5 - above and is_odd):
        nearest -= 1.0
    return nearest / UNIT
