"""The characteristic values of a synchronisation profile, for the whole profile at constant master velocity.

Source: TS5055, sections 6 and 12.3.2, the four values that TwinCAT reserves included.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.grid import wrap
from ..var import Unit
from .extremes import Extremes
from .profile import ProfileKind
from .profile_plan import ProfilePlan


@dataclass(slots=True)
class Characteristics:
    """The values of the last synchronisation that has started; 0 before the first. Names as in
    MC_FlyingSawCharacValues."""

    profile: ProfileKind = var.local(ProfileKind.NONE, "the polynomials of the profile")
    master_velocity_nominal: float = var.snapshot(
        0.0, "master velocity at the start, taken as constant (fMasterVeloNom)", Unit.VELOCITY
    )
    master_position_start: float = var.snapshot(0.0, "master position at the start (fMasterPosStart)", Unit.POSITION)
    slave_position_start: float = var.snapshot(0.0, "slave position at the start (fSlavePosStart)", Unit.POSITION)
    slave_velocity_start: float = var.snapshot(0.0, "slave velocity at the start (fSlaveVeloStart)", Unit.VELOCITY)
    slave_acceleration_start: float = var.snapshot(
        0.0, "the profile's acceleration at the start (fSlaveAccStart)", Unit.ACCELERATION
    )
    slave_jerk_start: float = var.snapshot(0.0, "the profile's jerk at the start (fSlaveJerkStart)", Unit.JERK)
    master_position_end: float = var.snapshot(0.0, "master position at the end (fMasterPosEnd)", Unit.POSITION)
    slave_position_end: float = var.snapshot(0.0, "slave position at the end (fSlavePosEnd)", Unit.POSITION)
    slave_velocity_end: float = var.snapshot(0.0, "slave velocity at the end (fSlaveVeloEnd)", Unit.VELOCITY)
    slave_acceleration_end: float = var.snapshot(0.0, "slave acceleration at the end (fSlaveAccEnd)", Unit.ACCELERATION)
    slave_jerk_end: float = var.snapshot(0.0, "slave jerk at the end (fSlaveJerkEnd)", Unit.JERK)
    slave_position_min: float = var.snapshot(0.0, "least slave position (fSlavePosMin)", Unit.POSITION)
    slave_position_max: float = var.snapshot(0.0, "greatest slave position (fSlavePosMax)", Unit.POSITION)
    master_position_at_slave_position_min: float = var.snapshot(0.0, "master then (fMPosAtSPosMin)", Unit.POSITION)
    master_position_at_slave_position_max: float = var.snapshot(0.0, "master then (fMPosAtSPosMax)", Unit.POSITION)
    slave_velocity_min: float = var.snapshot(0.0, "least slave velocity (fSlaveVeloMin)", Unit.VELOCITY)
    slave_velocity_max: float = var.snapshot(0.0, "greatest slave velocity (fSlaveVeloMax)", Unit.VELOCITY)
    master_position_at_slave_velocity_min: float = var.snapshot(0.0, "master then (fMPosAtSVeloMin)", Unit.POSITION)
    master_position_at_slave_velocity_max: float = var.snapshot(0.0, "master then (fMPosAtSVeloMax)", Unit.POSITION)
    slave_acceleration_min: float = var.snapshot(0.0, "least slave acceleration (fSlaveAccMin)", Unit.ACCELERATION)
    slave_acceleration_max: float = var.snapshot(0.0, "greatest slave acceleration (fSlaveAccMax)", Unit.ACCELERATION)
    master_position_at_slave_acceleration_min: float = var.snapshot(0.0, "master then (fMPosAtSAccMin)", Unit.POSITION)
    master_position_at_slave_acceleration_max: float = var.snapshot(0.0, "master then (fMPosAtSAccMax)", Unit.POSITION)
    slave_velocity_at_slave_acceleration_min: float = var.snapshot(
        0.0, "velocity then (fSVeloAtSAccMin)", Unit.VELOCITY
    )
    slave_velocity_at_slave_acceleration_max: float = var.snapshot(
        0.0, "velocity then (fSVeloAtSAccMax)", Unit.VELOCITY
    )
    slave_jerk_min: float = var.snapshot(0.0, "least slave jerk (fSlaveJerkMin)", Unit.JERK)
    slave_jerk_max: float = var.snapshot(0.0, "greatest slave jerk (fSlaveJerkMax)", Unit.JERK)
    slave_dynamic_momentum_min: float = var.snapshot(
        0.0, "least velocity times acceleration (fSlaveDynMomMin)", Unit.MOMENTUM
    )
    slave_dynamic_momentum_max: float = var.snapshot(
        0.0, "greatest velocity times acceleration (fSlaveDynMomMax)", Unit.MOMENTUM
    )
    slave_velocity_mean: float = var.snapshot(0.0, "mean over time of the speed (fSlaveVeloMean)", Unit.VELOCITY)
    slave_acceleration_effective: float = var.snapshot(
        0.0, "root mean square over time (fSlaveAccEff)", Unit.ACCELERATION
    )

    def show(self, plan: ProfilePlan, period: float) -> None:
        """Show the values of a plan that starts now; one that is in sync at once ends where it starts.

        `period`: the master's, u."""
        self.profile = plan.profile.kind
        self.master_velocity_nominal = plan.master.velocity
        self.slave_acceleration_end = 0.0
        if plan.profile.segments > 0:
            plan.extremes.integrate(plan.profile)
            self.show_ends(plan)
            self.show_extremes(plan.extremes)
        else:
            self.show_constant(plan.slave.position, plan.slave.velocity)
        self.show_master_positions(plan, period)

    def show_ends(self, plan: ProfilePlan) -> None:
        """Show the slave's state at the profile's beginning and end."""
        self.slave_position_start = plan.slave.position
        self.slave_velocity_start = plan.slave.velocity
        _, _, acceleration, jerk = plan.profile.at(0.0)
        self.slave_acceleration_start = acceleration
        self.slave_jerk_start = jerk
        self.slave_position_end = plan.slave_end
        self.slave_velocity_end = plan.end_velocity
        _, _, _, last = plan.profile.at(plan.profile.duration())
        self.slave_jerk_end = last

    def show_extremes(self, extremes: Extremes) -> None:
        """Show the slave's extreme values in the profile."""
        self.slave_position_min = extremes.position_min
        self.slave_position_max = extremes.position_max
        self.slave_velocity_min = extremes.velocity_min
        self.slave_velocity_max = extremes.velocity_max
        self.slave_acceleration_min = extremes.acceleration_min
        self.slave_acceleration_max = extremes.acceleration_max
        self.slave_velocity_at_slave_acceleration_min = extremes.velocity_at_acceleration_min
        self.slave_velocity_at_slave_acceleration_max = extremes.velocity_at_acceleration_max
        self.slave_jerk_min = extremes.jerk_min
        self.slave_jerk_max = extremes.jerk_max
        self.slave_dynamic_momentum_min = extremes.momentum_min
        self.slave_dynamic_momentum_max = extremes.momentum_max
        self.slave_velocity_mean = extremes.velocity_mean
        self.slave_acceleration_effective = extremes.acceleration_effective

    def show_constant(self, position: float, velocity: float) -> None:
        """Show the values of a single instant at constant velocity."""
        self.slave_position_start = self.slave_position_end = position
        self.slave_position_min = self.slave_position_max = position
        self.slave_velocity_start = self.slave_velocity_end = velocity
        self.slave_velocity_min = self.slave_velocity_max = velocity
        self.slave_velocity_at_slave_acceleration_min = self.slave_velocity_at_slave_acceleration_max = velocity
        self.slave_velocity_mean = abs(velocity)
        self.slave_acceleration_start = self.slave_acceleration_effective = 0.0
        self.slave_acceleration_min = self.slave_acceleration_max = 0.0
        self.slave_jerk_start = self.slave_jerk_end = 0.0
        self.slave_jerk_min = self.slave_jerk_max = 0.0
        self.slave_dynamic_momentum_min = self.slave_dynamic_momentum_max = 0.0

    def show_master_positions(self, plan: ProfilePlan, period: float) -> None:
        """Show the master's positions at all these instants, within its period."""
        start = plan.master.position
        velocity = plan.master.velocity if plan.profile.segments > 0 else 0.0
        extremes = plan.extremes
        self.master_position_start = wrap(start, period)
        self.master_position_end = wrap(plan.master_end, period)
        self.master_position_at_slave_position_min = wrap(start + velocity * extremes.position_min_time, period)
        self.master_position_at_slave_position_max = wrap(start + velocity * extremes.position_max_time, period)
        self.master_position_at_slave_velocity_min = wrap(start + velocity * extremes.velocity_min_time, period)
        self.master_position_at_slave_velocity_max = wrap(start + velocity * extremes.velocity_max_time, period)
        self.master_position_at_slave_acceleration_min = wrap(start + velocity * extremes.acceleration_min_time, period)
        self.master_position_at_slave_acceleration_max = wrap(start + velocity * extremes.acceleration_max_time, period)
