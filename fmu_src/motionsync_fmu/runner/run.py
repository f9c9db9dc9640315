"""The run of a scenario: what the block is given in each step, and what is seen of it. The host steps the block:

    run.start()                # the inputs with which the block is initialized
    ...                        # initialize it, and write the outputs that the program sees
    run.begin()
    while run.try_prepare():
        ...                    # give the block the inputs of the axis, and if `sets` the program's values; step it
        run.finish()
        if run.samples:
            ...                # write the outputs that the program sees
            run.sample()

The motion of the axis at `now` is in `run.axis` after `begin` and `finish`.
"""

from dataclasses import dataclass
from math import inf

from motionsync import var
from motionsync.numerics.grid import wrap

from .axis import Axis
from .encoder import Encoder
from .host import Host
from .points import Points
from .program import Program
from .telegrams import WIDTH, Telegrams


@dataclass(slots=True)
class Run:
    """One run.

    Attributes:
        axis: the true master, or the remote axis.
        encoder: between the master and the block; without it the block is given the true motion.
        telegrams: by which the block sees a remote axis.
        points, program: when and what.
        host: what a host in compiled code knows of the run.
        has_encoder, is_remote: which of them are used.
        is_ahead: whether the block is given the master at the end of a step.
        period: of the master's position, u; 0: it is not wrapped.
        step: the length of the present step, s; 0: the block is initialized.
        end: the end of it, s.
        now: the latest communication point, s.
        sets: whether values have been set for the step.
        samples: whether the outputs are to be sampled after it.
        position, velocity, acceleration, cycle_index: the inputs of the axis for the step.
    """

    axis: Axis = var.part(Axis)
    encoder: Encoder = var.part(Encoder)
    telegrams: Telegrams = var.part(Telegrams)
    points: Points = var.part(Points)
    program: Program = var.part(Program)
    host: Host = var.part(Host)
    has_encoder: bool = False
    is_remote: bool = False
    is_ahead: bool = False
    period: float = 0.0
    step: float = 0.0
    end: float = 0.0
    now: float = 0.0
    sets: bool = False
    samples: bool = False
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    cycle_index: int = 0

    def start(self) -> None:
        """Show the axis at time 0."""
        if self.has_encoder:
            self.encoder.begin(self.axis)
        self.show_axis(0.0, 0.0)

    def begin(self) -> None:
        """Begin, when the block is initialized; the outputs have been written."""
        self.axis.go_to(0.0)
        self.program.begin()
        self.points.begin(self.axis)
        self.end = self.points.next
        self.points.advance(self.axis)

    def try_prepare(self) -> bool:
        """Set what is due, and the axis, for the next step. False: the run is at its end.

        Where a step ends depends on what the reactions have seen at the end of the one before."""
        if self.points.next == inf:
            return False
        t = self.end
        close = self.points.close
        self.sets = self.program.next <= t + close
        if self.sets:
            self.program.set_values(t + close)
        self.end = min(self.points.sample, self.program.next)
        if self.end >= self.points.next - close:
            self.end = self.points.next
            self.points.advance(self.axis)
        self.step = self.end - t
        self.show_axis(t, self.end)
        return True

    def finish(self) -> None:
        """End the step that the block has made."""
        self.now = self.end
        self.axis.go_until(self.now)
        self.samples = self.points.sample <= self.now + self.points.close

    def sample(self) -> None:
        """Let the program see the outputs, which have been written."""
        self.program.sample(self.axis, self.points)

    def show_axis(self, t: float, end: float) -> None:
        """Show the block its axis for the step from t to `end`."""
        if self.is_remote:
            i = self.telegrams.shown(t, end)
            self.cycle_index = self.telegrams.cycle_index[i]
            self.position = self.telegrams.motion[WIDTH * i]
            self.velocity = self.telegrams.motion[WIDTH * i + 1]
            self.acceleration = self.telegrams.motion[WIDTH * i + 2]
            return
        is_ahead = self.is_ahead and end > t
        if self.has_encoder:
            self.encoder.show(self.axis, end if is_ahead else t)
            self.position = wrap(self.encoder.position, self.period)
            self.velocity = self.encoder.velocity
            self.acceleration = self.encoder.acceleration
            return
        if is_ahead:
            self.axis.go_until(end)
        else:
            self.axis.go_to(t)
        self.position = wrap(self.axis.position, self.period)
        self.velocity = self.axis.velocity
        self.acceleration = self.axis.acceleration
