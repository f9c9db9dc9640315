"""The measured master, exact: the input mode MEASURED of `master.input_mode`, on the doubles given.

The master's position is measured, with noise or a resolution, and arrives late. An estimate (x, v, a), valid at the
instant of the latest measurement, follows the measurements (fading-memory filter of the third order); the path
(X, V, A), the master as a block follows it at the present time, follows the estimate. Times are s, positions u.

Where the description may be read in two ways, this is the reading:
- The estimate, velocity and acceleration inputs of the start included, describes the master `delay` before its instant.
- The next multiple of `sample_time` is the first one later than the latest measurement: one that a long step has passed
  is not made up for. The tolerance is 1e-9 of `sample_time`.
- A measurement belongs to the instant at which a step takes it, which with odd steps is after the multiple of
  `sample_time`. A is chosen at such an instant only, so the time since the measurement is then 0.
- Of the path, A alone is limited to 1e12; of the estimate v and a, before they are used.
- The unwrapped position counts turns from the first step on, whose measurement is taken as it is.
"""

from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

LIMIT = mp.mpf(10) ** 12
LONGEST_STEP = mp.mpf(10) ** 6
TOLERANCE = mp.mpf(10) ** -9


class MeasuredMaster:
    """The master, initialized with these inputs; afterwards `step` moves it on by one step.

    `path` is what a block shows: X (unwrapped), V and A at the end of the latest step, or at the initialization.
    `estimate` is x, v, a at the latest measurement. Parameters: times in s, from 0; `period` in u, 0: a linear axis.
    """

    estimate: Motion
    path: Motion

    def __init__(
        self,
        position: Number,
        velocity: Number = 0.0,
        acceleration: Number = 0.0,
        *,
        smoothing_time: Number = 0.02,
        delay: Number = 0.0,
        sample_time: Number = 0.0,
        period: Number = 0.0,
    ) -> None:
        self.smoothing_time = mp.mpf(smoothing_time)
        self.delay = mp.mpf(delay)
        self.sample_time = mp.mpf(sample_time)
        self.period = mp.mpf(period)
        self.elapsed = mp.mpf(0)
        """Time since the first step began."""
        self._age: Number = None
        """Time since the latest measurement; None before the first step."""
        self._start(_valid("position", position), _valid("velocity", velocity), _valid("acceleration", acceleration))

    @property
    def wrapped(self) -> Number:
        """X in [0, period), or X if there is no period."""
        return self.path.position % self.period if self.period else self.path.position

    def step(self, h: Number, position: Number, velocity: Number = 0.0, acceleration: Number = 0.0) -> None:
        """One step of length h, with the inputs at its start; velocity and acceleration act in the first step only.

        Raises ValueError, and changes nothing, for an input beyond 1e12 or a step that is not in (0, 1e6] s.
        """
        if not 0 < h <= LONGEST_STEP:
            raise ValueError(f"the step is {h} s; it must be greater than 0 and at most 1e6 s")
        inputs = _valid("position", position), _valid("velocity", velocity), _valid("acceleration", acceleration)
        h = mp.mpf(h)
        if self._age is None:
            self._start(*inputs)
            self._choose_acceleration(h)
            self._age = mp.mpf(0)
        elif self._is_due():
            self._take(inputs[0])
            self._choose_acceleration(h)
        s = self.path
        self.path = Motion(*_carried_on(s, h), s.acceleration)
        self.elapsed += h
        self._age += h

    def _start(self, position: Number, velocity: Number, acceleration: Number) -> None:
        """What the initialization and the first step take over: the estimate, and the path `delay` after it."""
        self.estimate = Motion(position, velocity, acceleration)
        self.path = Motion(*_carried_on(self.estimate, self.delay), acceleration)

    def _is_due(self) -> bool:
        """Whether a measurement is taken at the present time, later than the first step's."""
        if not self.sample_time:
            return True
        multiple = mp.floor((self.elapsed - self._age) / self.sample_time + TOLERANCE) + 1
        return bool(self.elapsed >= (multiple - TOLERANCE) * self.sample_time)

    def _take(self, measured: Number) -> None:
        """The estimate at a measurement, in the turn in which that is nearest to where the estimate expects it."""
        time, self._age = self._age, mp.mpf(0)
        x, v = _carried_on(self.estimate, time)
        error = measured - x
        if self.period:
            error -= mp.nint(error / self.period) * self.period
        pole = self._pole(time)
        self.estimate = Motion(
            x + (1 - pole**3) * error,
            _limited(v + mp.mpf(3) / 2 * (1 - pole) ** 2 * (1 + pole) * error / time),
            _limited(self.estimate.acceleration + (1 - pole) ** 3 * error / time**2),
        )

    def _choose_acceleration(self, h: Number) -> None:
        """The acceleration of the path, from now until the next measurement, which brings it to the estimate."""
        horizon = max(h, self.sample_time)
        pole = self._pole(horizon)
        p, q = _carried_on(self.estimate, self.delay)
        s = self.path
        by_velocity = (1 - pole) * (3 + pole) / 2 * (q - s.velocity) / horizon
        by_position = (1 - pole) ** 2 * (p - s.position) / horizon**2
        self.path = Motion(s.position, s.velocity, _limited(self.estimate.acceleration + by_velocity + by_position))

    def _pole(self, time: Number) -> Number:
        """The share of an error that is left after `time`: a rational exp(-time/smoothing_time)."""
        if not self.smoothing_time:
            return mp.mpf(0)
        u = time / self.smoothing_time
        return 1 / (1 + u * (1 + u / 2 * (1 + u / 3)))


def _carried_on(motion: Motion, time: Number) -> tuple[Number, Number]:
    """Position and velocity after `time` at constant acceleration."""
    return (
        motion.position + motion.velocity * time + motion.acceleration * time**2 / 2,
        motion.velocity + motion.acceleration * time,
    )


def _limited(value: Number) -> Number:
    return min(max(value, -LIMIT), LIMIT)


def _valid(name: str, value: Number) -> Number:
    """An input as a number of the oracle; raises ValueError if it is not finite or beyond 1e12."""
    if not abs(value) <= LIMIT:
        raise ValueError(f"{name} is {value}; it must be between -1e12 and 1e12")
    return mp.mpf(value)
