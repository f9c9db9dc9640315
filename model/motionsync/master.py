"""The master axis: from what the importer sets at its inputs to the master's path inside the step.

The slave's setpoint for t+h is computed for the master at t+h. Inputs that describe the master at t are therefore
extrapolated to t+h. Source: the input modes are motionsync's own; they distinguish the sequences in which
co-simulation masters set inputs and step, and an exact master from a measured one.
"""

from dataclasses import dataclass

from . import var
from .encoder_filter import EncoderFilter, correction, leading_acceleration
from .input_watch import InputWarning, InputWatch
from .master_path import MasterPath
from .numerics.computable_range import clamp
from .numerics.grid import wrap
from .var import LARGEST_INPUT, Enumeration, Unit

UNCERTAIN_TIMES = 3.0  # of the reaction time: so long noise, or an overshoot, may move a measured path one way
LARGEST_TURN_COUNT = 1e15  # with more turns the fraction of a turn is lost to rounding
TOO_MANY_TURNS = (  # a refusal's text and the variables it names, for the blocks that have a master
    "the master's position and its prediction must be at most 1e15 periods",
    "master.position",
    "master.velocity",
    "master.acceleration",
    "master.period",
)
POSITION_SOURCES = (  # what the master's position depends on after initialization
    "master.position",
    "master.period",
    "master.input_mode",
    "master.velocity",
    "master.acceleration",
    "master.delay",
)
VELOCITY_SOURCES = ("master.velocity", "master.input_mode", "master.acceleration", "master.delay")
ACCELERATION_SOURCES = ("master.acceleration", "master.input_mode")


class MasterInput(Enumeration):
    """What the master's inputs hold when doStep(t, h) is called"""

    START_OF_STEP = 1, "the master at t, carried on to t+h with constant acceleration (parallel masters, FMPy)"
    END_OF_STEP = 2, "the master at t+h (sequential masters that have stepped the master axis first)"
    POSITION_ONLY = 3, "only the position at t; velocity and acceleration are estimated from the last three"
    MEASURED = 4, "a measured position, smoothed and carried on over its delay"


class PathRefusal(Enumeration):
    """Why the master's path of a step is refused"""

    NONE = 0, "it is not"
    TURNS = 1, "it has too many turns"
    TRAVEL = 2, "it may be longer than the block allows"


@dataclass(slots=True)
class Master:
    """The master axis and its motion during the present step.

    The step's `path` starts where the step before ended. Its section 0 is the input correction: it takes no time and
    leads to `begin`, the present input. The commands act there, with the velocity and acceleration that the master has
    at `begin`. The other sections take `step` s and lead to `end`. With a period all these positions are unwrapped:
    they are continuous, relative to a whole number of turns that `rebase` selects.

    In mode POSITION_ONLY velocity and acceleration are estimated from the present input and the two before it,
    `last_sample` and `second_last_sample`, with the lengths of the steps that followed each of them. The estimates are
    limited to +-1e12, as Real inputs are, so that samples taken at nearly the same instant cannot make them infinite.
    All modes store the samples: `watch` looks for what is wrong with them, and single steps of START_OF_STEP may come
    in between those of POSITION_ONLY.

    In mode MEASURED `encoder` estimates the motion of the line, and the path is led on to the estimate: it joins the
    path of the step before, without a correction. The parts of the path are what the slave follows, not what the inputs
    hold. `fastest` is the path's greatest speed since `watch_travel`, in u/s.
    """

    position: float = var.input(0.0, "the master's position", Unit.POSITION)
    velocity: float = var.input(
        0.0,
        "the master's velocity (unused with POSITION_ONLY; with MEASURED as the line runs at the start)",
        Unit.VELOCITY,
    )
    acceleration: float = var.input(
        0.0, "the master's acceleration (unused with POSITION_ONLY; with MEASURED at the start only)", Unit.ACCELERATION
    )
    input_mode: MasterInput = var.parameter(MasterInput.START_OF_STEP, "what the master's inputs hold")
    period: float = var.parameter(
        0.0, "modulo period of the positions: 0, a linear axis, or at least 1e-9", Unit.POSITION, min=0.0, smallest=1e-9
    )
    smoothing_time: float = var.parameter(
        0.02, "MEASURED: time constant with which the position is smoothed; 0: it is not", Unit.TIME, min=0.0, max=10.0
    )
    delay: float = var.parameter(0.0, "MEASURED: how old the position at t is", Unit.TIME, min=0.0, max=1.0)
    sample_time: float = var.parameter(
        0.0,
        "MEASURED: how often a new position comes; 0: with each step; else at least 1e-9",
        Unit.TIME,
        min=0.0,
        max=1.0,
        smallest=1e-9,
    )
    smoothed_position: float = var.local(
        0.0, "the master at t+h as the block takes it", Unit.POSITION, depends=POSITION_SOURCES
    )
    smoothed_velocity: float = var.local(0.0, "its velocity", Unit.VELOCITY, depends=VELOCITY_SOURCES)
    smoothed_acceleration: float = var.local(0.0, "its acceleration", Unit.ACCELERATION, depends=ACCELERATION_SOURCES)
    input_warning: int = var.local(
        0,
        "what is wrong with the inputs: 1 counts of an encoder, 2 jumps of the position, 3 a velocity that is not the "
        "position's, 5 a position that does not change; 2 to 5 until 10 s after it was seen last",
        codes=InputWarning,
    )
    likely_period: float = var.snapshot(
        0.0, "by how much the position jumped last: where its counter wraps, the period", Unit.POSITION
    )
    velocity_ratio: float = var.snapshot(
        0.0, "the velocity by that of the position, where they contradicted each other last"
    )
    begin: float = 0.0
    begin_velocity: float = 0.0
    begin_acceleration: float = 0.0
    path: MasterPath = var.part(MasterPath)
    step: float = 1.0
    end: float = 0.0
    end_velocity: float = 0.0
    end_acceleration: float = 0.0
    samples: int = 0
    last_sample: float = 0.0
    last_step: float = 0.0
    second_last_sample: float = 0.0
    second_last_step: float = 0.0
    encoder: EncoderFilter = var.part(EncoderFilter)
    watch: InputWatch = var.part(InputWatch)
    fastest: float = 0.0

    def try_initialize(self) -> bool:
        """Set the master to its inputs; with POSITION_ONLY its velocity is not available yet and taken as 0.

        False if the position has too many turns; nothing has changed then."""
        age = self.delay if self.is_measured() else 0.0
        position = self.position + (self.velocity + 0.5 * self.acceleration * age) * age
        if self.has_too_many_turns(self.position) or self.has_too_many_turns(position):
            return False
        has_velocity = self.input_mode != MasterInput.POSITION_ONLY
        velocity = self.velocity + self.acceleration * age if has_velocity else 0.0
        self.set_end(wrap(position, self.period), velocity, self.acceleration if has_velocity else 0.0)
        self.samples = 0
        return True

    def try_advance(self, h: float) -> bool:
        """Set the path of a step of h seconds. False if the path has too many turns: then nothing has changed."""
        return self.try_advance_within(h, 0.0) == PathRefusal.NONE

    def try_advance_within(self, h: float, longest: float) -> PathRefusal:
        """The same for a block that refuses a step in which the master might travel, back and forth, more than
        `longest`, u; 0: it refuses none. The answer is why the path is refused."""
        if self.has_too_many_turns(self.position):
            return PathRefusal.TURNS
        match self.input_mode:
            case MasterInput.END_OF_STEP:
                return self.try_interpolate(h, longest)
            case MasterInput.MEASURED:
                return self.try_follow_measurement(h, longest)
            case _:
                return self.try_predict(h, longest)

    def present_velocity(self) -> float:
        """The master's velocity where all events up to now are carried out, u/s."""
        return self.velocity_at(self.path.now)

    def velocity_at(self, time: float) -> float:
        """The master's velocity at a time within the step, interpolated between the velocities at both ends.

        It is exact at constant acceleration, and without the rounding errors that the path's derivative would have in a
        short step."""
        return self.begin_velocity + (self.end_velocity - self.begin_velocity) * (time / self.step)

    def distance_beyond(self, position: float, time: float) -> float:
        """How far the master is beyond a position at a time within the step, u."""
        path = self.path
        return (path.origin - position) + time * (path.velocity + time * (path.c2 + time * path.c3))

    def goes_against(self, direction: float) -> bool:
        """Whether the master goes against a direction, 1 or -1, on what is left of the path's section.

        The input correction is no motion: there it is enough that the velocity is against the direction."""
        path = self.path
        is_against = direction * (path.end - path.reached) < 0.0
        return is_against or (path.section == 0 and direction * self.begin_velocity < 0.0)

    def mean_acceleration(self) -> float:
        """The constant acceleration that leads from the velocity at the step's beginning to that at its end, u/s2.

        It is limited to +-1e12, as inputs are."""
        if self.input_mode == MasterInput.END_OF_STEP:
            return clamp((self.end_velocity - self.begin_velocity) / self.step, -LARGEST_INPUT, LARGEST_INPUT)
        return self.begin_acceleration

    def is_measured(self) -> bool:
        """Whether the path follows measurements, so that noise moves it."""
        return self.input_mode == MasterInput.MEASURED

    def watch_travel(self) -> None:
        """From the present step on `uncertain_travel` counts."""
        self.fastest = max(abs(self.begin_velocity), abs(self.end_velocity))

    def uncertain_travel(self) -> float:
        """How far the path may move although the line is at rest, or back although it runs on, u; 0 unless MEASURED.

        It is the travel at the path's greatest speed in three reaction times. The path goes back from its overshoot by
        at most 1.5 times the travel in one after a sudden stop, and by at most 2.7 times by noise, at the greatest
        speed that the noise itself has made."""
        if not self.is_measured():
            return 0.0
        return UNCERTAIN_TIMES * self.reaction_time() * self.fastest

    def reaction_time(self) -> float:
        """What a measurement takes to act on the path, s: smoothing time, delay, and time between two of them."""
        return self.smoothing_time + self.delay + max(self.step, self.sample_time)

    def unwrap_in_current_turn(self, position: float) -> float:
        """`position`, unwrapped into the same turn as the present input."""
        match self.input_mode:
            case MasterInput.END_OF_STEP:
                anchor = self.end
            case MasterInput.MEASURED:
                anchor = self.unwrap_input(self.begin)
            case _:
                anchor = self.begin
        return position + (anchor - self.position)

    def rebase(self) -> None:
        """Drop whole turns, so that positions keep their last bits over any number of turns.

        A block may call this whenever none of its positions belongs to a particular turn."""
        if self.period > 0.0 and not 0.0 <= self.end < self.period:
            wrapped = wrap(self.end, self.period)
            turns = self.end - wrapped
            self.end = wrapped
            self.last_sample -= turns
            self.second_last_sample -= turns
            self.encoder.rebase(turns)

    def try_predict(self, h: float, longest: float) -> PathRefusal:
        """Set the path from the input at t, with constant acceleration, to t+h."""
        position = self.unwrap_input(self.end)
        velocity, acceleration = self.input_motion(position)
        correction = abs(position - self.end) if self.samples > 0 else 0.0
        if 0.0 < longest < correction + (abs(velocity) + 0.5 * abs(acceleration) * h) * h:
            return PathRefusal.TRAVEL
        end = position + (velocity + 0.5 * acceleration * h) * h
        if self.has_too_many_turns(end):
            return PathRefusal.TURNS
        self.set_path(h, position, velocity, acceleration, end)
        self.add_sample(position, h)
        return PathRefusal.NONE

    def set_path(self, h: float, position: float, velocity: float, acceleration: float, end: float) -> None:
        """Set the path of constant acceleration, from an unwrapped position to the end."""
        former = self.end if self.samples > 0 else position
        self.begin = position
        self.begin_velocity = velocity
        self.begin_acceleration = acceleration
        self.step = h
        self.path.set_parabola(former, position, velocity, acceleration, h)
        self.set_end(end, velocity + acceleration * h, acceleration)

    def input_motion(self, position: float) -> tuple[float, float]:
        """Velocity and acceleration at t, where the inputs hold the master at t; `position` is the unwrapped input."""
        if self.input_mode == MasterInput.POSITION_ONLY:
            return self.estimate(position)
        return self.velocity, self.acceleration

    def add_sample(self, position: float, h: float) -> None:
        """Store an input, unwrapped, for the estimates of the next ones."""
        is_at_end = self.input_mode == MasterInput.END_OF_STEP
        self.second_last_sample = self.last_sample
        self.watch_sample(position, h if is_at_end else self.last_step)
        self.samples = min(self.samples + 1, 3)
        self.second_last_step = self.last_step
        self.last_step = h

    def watch_sample(self, position: float, interval: float) -> None:
        """Take an input, unwrapped, so many seconds after the one before, and look at it."""
        watch = self.watch
        change = position - self.last_sample
        self.last_sample = position
        if self.input_mode != MasterInput.MEASURED:
            watch.add_unsmoothed(position, change, interval)
        has_velocity = self.input_mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP)
        velocity = self.velocity if has_velocity else 0.0
        acceleration = self.acceleration if has_velocity else 0.0
        watch.add(position, change, interval, has_velocity, velocity, acceleration)
        if watch.code != self.input_warning or watch.code > InputWarning.COUNTS:
            self.input_warning = watch.code
            self.likely_period = watch.likely_period
            self.velocity_ratio = watch.velocity_ratio

    def try_follow_measurement(self, h: float, longest: float) -> PathRefusal:
        """Set the path that leads on to the estimate from the measurements."""
        encoder = self.encoder
        if self.samples == 0:
            return self.try_start_measurement(h, longest)
        position, velocity, acceleration, path_acceleration = self.follow_measurement(h)
        if 0.0 < longest < (abs(self.end_velocity) + 0.5 * abs(path_acceleration) * h) * h:
            return PathRefusal.TRAVEL
        end = self.end + (self.end_velocity + 0.5 * path_acceleration * h) * h
        if self.has_too_many_turns(end):
            return PathRefusal.TURNS
        if encoder.is_due:
            self.watch_sample(self.unwrap_input(encoder.expected_position), encoder.age)
            encoder.set(position, velocity, acceleration, path_acceleration)
        encoder.advance(h, self.smoothing_time, self.sample_time)
        self.set_path(h, self.end, self.end_velocity, path_acceleration, end)
        self.fastest = max(self.fastest, abs(self.end_velocity))
        return PathRefusal.NONE

    def try_start_measurement(self, h: float, longest: float) -> PathRefusal:
        """Set the path of the first step, along the line as the inputs say that it runs."""
        age = self.delay
        travel = (self.velocity + 0.5 * self.acceleration * age) * age
        measured = self.unwrap_input(self.end - travel)
        begin = measured + travel
        velocity = self.velocity + self.acceleration * age
        if 0.0 < longest < (abs(velocity) + 0.5 * abs(self.acceleration) * h) * h:
            return PathRefusal.TRAVEL
        end = begin + (velocity + 0.5 * self.acceleration * h) * h
        if self.has_too_many_turns(end):
            return PathRefusal.TURNS
        self.encoder.set(measured, self.velocity, self.acceleration, self.acceleration)
        self.encoder.sample_clock.start(0.0)
        self.encoder.advance(h, self.smoothing_time, self.sample_time)
        self.set_path(h, begin, velocity, self.acceleration, end)
        self.watch_sample(measured, h)
        self.samples = 1
        self.fastest = max(self.fastest, abs(self.end_velocity))
        return PathRefusal.NONE

    def follow_measurement(self, h: float) -> tuple[float, float, float, float]:
        """The encoder's estimate at the start of the coming step, which is not the first, and the acceleration that
        leads to it."""
        encoder = self.encoder
        if not encoder.is_due:
            return encoder.position, encoder.velocity, encoder.acceleration, encoder.path_acceleration
        interval = max(h, self.sample_time)
        share = encoder.share
        frequency = encoder.frequency
        if not encoder.has_interval(interval):
            share, frequency = correction(interval, self.smoothing_time)
        position, velocity, acceleration = encoder.corrected(self.unwrap_input(encoder.expected_position))
        age = self.delay
        path_acceleration = leading_acceleration(
            position + (velocity + 0.5 * acceleration * age) * age - self.end,
            velocity + acceleration * age - self.end_velocity,
            acceleration,
            share,
            frequency,
        )
        return position, velocity, acceleration, path_acceleration

    def try_interpolate(self, h: float, longest: float) -> PathRefusal:
        """Set the path along a cubic, from the end of the step before to the input at t+h."""
        expected = self.end + 0.5 * (self.end_velocity + self.velocity) * h
        if self.has_too_many_turns(expected):
            return PathRefusal.TURNS
        position = self.unwrap_input(expected)
        if 0.0 < longest < abs(position - self.end) + (abs(self.end_velocity) + abs(self.velocity)) * h:
            return PathRefusal.TRAVEL
        self.begin = self.end
        self.begin_velocity = self.end_velocity
        self.begin_acceleration = self.end_acceleration
        self.step = h
        self.path.set_cubic(self.end, self.end_velocity, position, self.velocity, h)
        self.set_end(position, self.velocity, self.acceleration)
        self.add_sample(position, h)
        return PathRefusal.NONE

    def set_end(self, position: float, velocity: float, acceleration: float) -> None:
        """The master at the end of the step, and what is shown of it."""
        self.end = position
        self.end_velocity = velocity
        self.end_acceleration = acceleration
        self.smoothed_velocity = velocity
        self.smoothed_acceleration = acceleration
        self.smoothed_position = wrap(position, self.period)

    def estimate(self, position: float) -> tuple[float, float]:
        """Velocity and acceleration, at the newest sample `position`, of the parabola through the last three samples.

        Divided differences with the samples' own distances in time. Two samples give a velocity alone, one sample
        neither."""
        rate = 0.0
        acceleration = 0.0
        if self.samples > 0:
            rate = clamp((position - self.last_sample) / self.last_step, -LARGEST_INPUT, LARGEST_INPUT)
        if self.samples > 1:
            former = clamp(
                (self.last_sample - self.second_last_sample) / self.second_last_step, -LARGEST_INPUT, LARGEST_INPUT
            )
            acceleration = clamp(
                2.0 * (rate - former) / (self.last_step + self.second_last_step), -LARGEST_INPUT, LARGEST_INPUT
            )
        return clamp(rate + 0.5 * acceleration * self.last_step, -LARGEST_INPUT, LARGEST_INPUT), acceleration

    def unwrap_input(self, expected: float) -> float:
        """The input's position, unwrapped into the turn in which it is nearest to the expected position."""
        if self.period == 0.0 or abs(expected - self.position) <= 0.5 * self.period:
            return self.position
        wrapped_input = wrap(self.position, self.period)  # this is exact, a large multiple of the period is not
        return wrapped_input + round((expected - wrapped_input) / self.period) * self.period

    def has_too_many_turns(self, position: float) -> bool:
        """Whether a position is so many periods away from 0 that the fraction of a turn is lost."""
        return self.period > 0.0 and abs(position) > LARGEST_TURN_COUNT * self.period
