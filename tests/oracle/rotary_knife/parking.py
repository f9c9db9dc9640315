"""How a rotary knife parks in time: by a motion of its own, from wherever it is, with the axis's limits.

`abort` and faults do that; `stop` leaves the way to rest to the sequence.

Readings of the specification that it leaves open:
- The motion begins with an acceleration that the axis could have. One that slows a knife down that turns forwards is
  no more than what a stop needs: sqrt(2·jerk·velocity).
- The blade's passing of a cut's place is counted while the knife moves in time, forwards.
- A stop that ends at a park place, to 1e-9 of a turn, ends there.
"""

from tests.oracle.cutting.machine import Event
from tests.oracle.flying_saw.motion import run, stop
from tests.oracle.master import Motion
from tests.oracle.motion_start import attainable_acceleration
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.numerics.root_search import find_first_root
from tests.oracle.rotary_knife.limits import SPARE, Knife
from tests.oracle.rotary_knife.state import FAULT, OFF, PARKING, WAITING, KnifeState
from tests.oracle.timed_motion import TimedMotion, plan_move


def plan_parking(knife: Knife, time: float, position: Number, velocity: Number, acceleration: Number) -> TimedMotion:
    """From a state of the slave to the first park place at which it can come to rest."""
    limits = knife.velocity, knife.acceleration, knife.acceleration
    a = attainable_acceleration(velocity, acceleration, *limits)
    if velocity >= 0:
        a = max(a, -mp.sqrt(2 * knife.jerk * velocity))
    start = Motion(position, velocity, a)
    end = run(start, stop(start, knife.acceleration, knife.jerk)).position
    places = mp.ceil((end - SPARE * knife.turn - knife.park_angle) / knife.spacing)
    target = max(knife.park_angle + places * knife.spacing, end)
    return plan_move(time, (position, velocity, a, mp.mpf(0)), target, (*limits, knife.jerk))


def when_passed(motion: TimedMotion, position: Number, begin: float) -> float | None:
    """When the motion passes a position forwards."""
    if motion.target < position:
        return None
    return find_first_root(lambda time: motion.at(time)[0] - float(position), begin, motion.end)


class ParkingKnife(KnifeState):
    """A knife that is switched off, or parks in time."""

    def _events_in_time(self) -> list[Event]:
        assert self.timed is not None
        events: list[Event] = [(max(self.timed.end, self.time), self._arrive)]
        at = when_passed(self.timed, self.last_position + self.knife.spacing, self.time)
        return events if at is None else [(at, self._pass_place), *events]

    def _pass_place(self) -> None:
        """A blade passes where it would cut, out of sync."""
        self.log.append((self.time, "unsynchronised"))
        self.last_position += self.knife.spacing
        self.records.statistics.add("unsynchronised")

    def _park_in_time(self) -> None:
        slope, master = self.derivatives(), self.master()
        s = slope[0]
        velocity = slope[1] * master.velocity
        acceleration = slope[2] * master.velocity**2 + slope[1] * master.acceleration
        self.last_position = mp.floor((s + SPARE * self.knife.turn) / self.knife.spacing) * self.knife.spacing
        self.timed = plan_parking(self.knife, self.time, s, velocity, acceleration)

    def _arrive(self) -> None:
        assert self.timed is not None
        self.log.append((self.time, "parked"))
        target, self.timed = mp.mpf(self.timed.target), None
        self.last_position = mp.floor(target / self.knife.spacing) * self.knife.spacing
        self.rest_at(self.last_position + self.knife.park_angle, self.state)
        if self.state != FAULT:
            self._switch_off()

    def _switch_off(self) -> None:
        self.rest_at(self.derivatives()[0], OFF)
        self.is_stopping = self.is_cut_requested = self.has_no_earlier_cut = False
        self.records.stop()

    def _fail(self, fault: int) -> None:
        self.log.append((self.time, f"fault {fault}"))
        moves = self.state not in (OFF, WAITING)
        self.fault = fault
        self.is_stopping = self.is_cut_requested = self.has_no_earlier_cut = False
        self.records.stop()
        if self.timed is None and moves:
            self._park_in_time()
        elif self.timed is None:
            self.rest_at(self.derivatives()[0], FAULT)
        self.state = FAULT

    def _do_reset(self) -> None:
        self.refusal = 0
        if self.state == FAULT and self.timed is None:
            self.fault = 0
            self.rest_at(self.derivatives()[0], OFF)

    def _do_abort(self) -> None:
        if not self.records.is_running:
            return
        self._answer_command()
        self.is_stopping, self.is_cut_requested = True, False
        if self.state == WAITING:
            self._switch_off()
        elif self.timed is None:
            self._park_in_time()
            self.state = PARKING

    def _do_stop(self) -> None:
        if not self.records.is_running:
            return
        self._answer_command()
        self.is_stopping = True
        if self.state == WAITING:
            self._switch_off()
