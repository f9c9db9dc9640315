"""The corrected cycle index of RemoteSync, from the whole history of D, in exact (BEAT) or 50-digit (PHASE) numbers.

D is the received index less what equal clocks would have counted. Nothing of a transition zone is kept: its first and
last change and its counts are looked up in the history when D has been quiet.

Readings of the description (BEAT):
- the first cycle counts as a change of D, so that D is first confirmed after `end_of_transition_limit` cycles;
- r > 1: quiet stretches are checked only where D is (n mod r = 0), so that no stretch is quiet unseen;
- N and the drift are known from beat number periods + 1 on, also while time mode is forced; the warning compares the
  mean before a beat with the mean after it, and a beat before which there was none ends it;
- a confirmed change of two or more that finds no beats to forget leaves the warning as it is.
Readings (PHASE):
- every jump of the estimate (a beat, a change of two or more, a first confirmation that differs, the clamp after a zone
  that was none) is blended over B;
- a change of two or more keeps d and P22, but beats are forgotten as by BEAT; a first confirmation that differs moves x
  alone;
- two beats, of whatever sign, make it known; the warning compares the last two distances between beats of one sign, a
  reversal is one; time mode is not its own;
- where more than 20 000 cycles lie between the first two beats, of one sign, d is the slope of the line through both:
  with the given q the filter would overshoot by up to 0.08 cycles.
"""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number, Ratio

ONE = mp.mpq(1)
SIGNIFICANT = mp.mpq(1, 5)
"""Share of N by which the next one may differ without a warning."""

BEAT_NOISE, DRIFT_GROWTH, FIRST_DRIFT, EDGE_MARGIN = mp.mpf("0.005"), mp.mpf("2e-15"), mp.mpf("3e-4"), mp.mpf("0.05")
"""Noise of a beat's date (cycles), growth of the drift's variance (per cycle), first |d|, edge of the clamp."""


def whole_ratio(task_cycle_time: float, data_cycle_time: float) -> Ratio | None:
    """r, data cycles per task cycle, a whole number or the inverse of one (to 1e-6 of it); None for any other."""
    ratio = mp.mpq(data_cycle_time) / mp.mpq(task_cycle_time) if data_cycle_time else ONE
    larger = max(ratio, 1 / ratio)
    whole = mp.mpq(round(larger))
    if abs(larger - whole) > mp.mpq(1, 10**6):
        return None
    return whole if ratio >= 1 else 1 / whole


class History:
    """D at every cycle at which it is checked; since when it has not changed, and where it was quiet."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.values: list[int] = []
        self.changes: list[int] = []
        self.quiets: list[int] = []

    def check(self, n: int, difference: int) -> bool:
        """Note D at cycle n; true where it has been constant for the limit."""
        if not self.values or difference != self.values[-1]:
            self.changes.append(n)
        self.values.append(difference)
        return n - self.changes[-1] >= self.limit

    @property
    def closed(self) -> int:
        """The last quiet cycle: since then a zone may have opened. Before any, the first cycle."""
        return self.quiets[-1] if self.quiets else 0

    def first_change(self) -> int:
        """The first change since the last quiet cycle."""
        return self.changes[bisect_right(self.changes, self.closed)]


@dataclass(frozen=True, slots=True)
class Identification:
    """What is known from `cycle` on: D confirmed, the dates of the beats in force, their sign.

    `held` is the offset that was given there before.
    """

    cycle: int
    confirmed: int
    beats: tuple[Ratio, ...]
    sign: int
    held: Ratio


class Beat:
    """The source's estimator: beats dated by the middle of their zone, the last distances extrapolated."""

    def __init__(self, values: Mapping[str, Any], ratio: Ratio) -> None:
        self.ratio = ratio
        self.periods = int(values["periods_for_mean_drift"])
        self.forced = bool(values["force_time_mode"])
        self.blend = int(values["new_drift_blending_cycles"])
        self.time_mode_blend = int(values["time_mode_blending_cycles"])
        self.corner = mp.mpq(values["slope1_denominator"]), mp.mpq(values["slope1_numerator"])
        self.history = History(int(values["end_of_transition_limit"]))
        self.identified: list[Identification] = []
        self.warning = False

    def cycle(self, n: int, k: int) -> Ratio:
        """The corrected index c at cycle n with the received, unwrapped index k."""
        nominal = n / self.ratio
        if n == 0:
            self.identified.append(Identification(0, k, (), 0, mp.mpq(k)))
        if nominal.denominator == 1:
            difference = k - int(nominal)
            if self.history.check(n, difference):
                self._quiet(n, difference)
                self.history.quiets.append(n)
        return nominal + self.offset(n)

    def offset(self, n: int) -> Ratio:
        """c - n/r at cycle n, from the latest identification."""
        now = self.identified[-1]
        target, blend = mp.mpq(now.confirmed), self.time_mode_blend
        period = self._period(now.beats)
        if period and not self.forced:
            target += now.sign * self._share((n - now.beats[-1]) / period)
            blend = self.blend
        weight = min(ONE, mp.mpq(n - now.cycle, blend))
        return (1 - weight) * now.held + weight * target

    @property
    def beats(self) -> int:
        return len(self.identified[-1].beats)

    @property
    def is_drift_determined(self) -> bool:
        """There are beats enough for a drift, and it may be used."""
        return self.beats > self.periods and not self.forced

    @property
    def drift(self) -> Ratio:
        """In ppm; 0 while it is not known."""
        period = self._period(self.identified[-1].beats)
        return self.identified[-1].sign * 10**6 * self.ratio / period if period else mp.mpq(0)

    def _quiet(self, n: int, difference: int) -> None:
        """D has been constant long enough."""
        last = self.identified[-1]
        change = difference - last.confirmed
        if change == 0:
            return
        if not self.history.quiets:
            self._identify(n, difference, (), 0)
            return
        if abs(change) >= 2:
            self.warning = self.warning or bool(last.beats)
            self._identify(n, difference, (), 0)
            return
        date = mp.mpq(self.history.first_change() + self.history.changes[-1], 2)
        reversal = bool(last.beats) and change != last.sign
        beats = (date,) if reversal else (*last.beats, date)
        before, after = self._period(last.beats), self._period(beats)
        changed = bool(before and after and abs(after - before) > SIGNIFICANT * before)
        self.warning = reversal or changed
        self._identify(n, difference, beats, change)

    def _identify(self, n: int, confirmed: int, beats: tuple[Ratio, ...], sign: int) -> None:
        self.identified.append(Identification(n, confirmed, beats, sign, self.offset(n)))

    def _period(self, beats: tuple[Ratio, ...]) -> Ratio | None:
        """N, the mean of the last distances between beats; None if there are not enough of them."""
        if len(beats) <= self.periods:
            return None
        return (beats[-1] - beats[-1 - self.periods]) / self.periods

    def _share(self, u: Ratio) -> Ratio:
        """g(u): two straight lines to (1, 1), then 1."""
        corner, height = self.corner
        if u <= corner:
            return u * height / corner
        return height + (min(u, ONE) - corner) * (1 - height) / (1 - corner)


class Phase:
    """Beats dated by counting the cycles beyond the confirmed D; a Kalman filter of phase and drift over them."""

    def __init__(self, values: Mapping[str, Any], ratio: Ratio) -> None:
        assert ratio == 1
        self.blend = int(values["new_drift_blending_cycles"])
        self.forced = bool(values["force_time_mode"])
        self.history = History(int(values["end_of_transition_limit"]))
        self.confirmed = 0
        self.dates: list[tuple[Number, int]] = []
        self.warning = False
        self.t, self.x, self.d = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        self.p11, self.p12, self.p22 = mp.mpf(1) / 12, mp.mpf(0), FIRST_DRIFT**2
        self.jump, self.jumped = mp.mpf(0), 0

    @property
    def is_drift_determined(self) -> bool:
        return self.beats >= 2 and not self.forced

    @property
    def beats(self) -> int:
        return len(self.dates)

    @property
    def drift(self) -> Number:
        return self.d * 10**6

    def cycle(self, n: int, k: int) -> Number:
        """The corrected index c at cycle n with the received, unwrapped index k."""
        difference = k - n
        if n == 0:
            self.confirmed, self.x = difference, difference + mp.mpf(1) / 2
        before, moved = self._offset(n), False
        if self.history.check(n, difference):
            zone = self.history.changes[-1] > self.history.closed
            moved = self._quiet(n, difference)
            self.history.quiets.append(n)
            moved = (self._clamp(n) and zone) or moved
        else:
            self._clamp(n)
        if moved:
            self.jump, self.jumped = before - self._phase(n), n
        return n + self._offset(n)

    def _phase(self, n: int) -> Number:
        return self.x + self.d * (n - self.t)

    def _offset(self, n: int) -> Number:
        return self._phase(n) + self.jump * max(mp.mpf(0), 1 - mp.mpf(n - self.jumped) / self.blend)

    def _since_closed(self) -> list[int]:
        """D less the confirmed one in all cycles since the zone before was closed."""
        return [value - self.confirmed for value in self.history.values[self.history.closed + 1 :]]

    def _quiet(self, n: int, difference: int) -> bool:
        """D has been constant long enough; true where x is moved by it."""
        change = difference - self.confirmed
        first = not self.history.quiets
        if change == 0:
            return False
        if first:
            self.x = difference + mp.mpf(1) / 2
        elif abs(change) == 1:
            counted = sum(min(max(change * beyond, 0), 1) for beyond in self._since_closed())
            self._beat(n + mp.mpf(1) / 2 - counted, max(self.confirmed, difference), change)
        else:
            self.x, self.t = difference + mp.mpf(1) / 2, mp.mpf(n)
            self.p11, self.p12 = mp.mpf(1) / 12, mp.mpf(0)
            self.warning = self.warning or bool(self.dates)
            self.dates = []
        self.confirmed = difference
        return True

    def _beat(self, date: Number, border: int, sign: int) -> None:
        """A beat at `date`, where the phase was at `border`."""
        last = self.dates[-1] if self.dates else None
        dates = [date for date, of in self.dates[-2:] if of == sign]
        self.dates.append((date, sign))
        apart = date - last[0] if last else mp.mpf(0)
        before = dates[1] - dates[0] if len(dates) == 2 else None
        reversal = bool(last and last[1] != sign)
        self.warning = reversal or bool(before and abs(apart - before) > before / 5)
        if len(self.dates) == 2 and not reversal and apart > 20000:
            self.x, self.d, self.t = mp.mpf(border), sign / apart, date
            self.p11, self.p12, self.p22 = BEAT_NOISE**2, BEAT_NOISE**2 / apart, 2 * BEAT_NOISE**2 / apart**2
        else:
            self._update(date, border)

    def _update(self, date: Number, border: int) -> None:
        """At `date` the phase was at `border`: F = [[1, τ], [0, 1]], the drift a random walk, one measurement."""
        tau = date - self.t
        x = self.x + self.d * tau
        p11 = self.p11 + 2 * tau * self.p12 + tau**2 * self.p22 + DRIFT_GROWTH * tau**3 / 3
        p12 = self.p12 + tau * self.p22 + DRIFT_GROWTH * tau**2 / 2
        p22 = self.p22 + DRIFT_GROWTH * tau
        variance = p11 + BEAT_NOISE**2
        gain1, gain2 = p11 / variance, p12 / variance
        self.x, self.d, self.t = x + gain1 * (border - x), self.d + gain2 * (border - x), date
        self.p11, self.p12, self.p22 = (1 - gain1) * p11, (1 - gain1) * p12, p22 - gain2 * p12

    def _clamp(self, n: int) -> bool:
        """While D is the confirmed one the phase is inside its cycle, to the edge; true where it was not."""
        zone = self.history.changes[-1] > self.history.closed
        low, high = self.confirmed - EDGE_MARGIN, self.confirmed + 1 + EDGE_MARGIN
        phase = self._phase(n)
        if zone or low <= phase <= high:
            return False
        self.d = (min(max(phase, low), high) - self.x) / (n - self.t)
        return True
