"""What a synchronisation of the flying saw is planned from: the states of both axes, and the command's values."""

from collections.abc import Collection
from dataclasses import dataclass

from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

GEAR_IN_VELO, GEAR_IN_POS = "gear_in_velo", "gear_in_pos"


@dataclass(frozen=True, slots=True)
class Limits:
    """Of a command, after substitution of the axis's values (u/s, u/s2, u/s2, u/s3)."""

    velocity: Number
    acceleration: Number
    deceleration: Number
    jerk: Number

    def __post_init__(self) -> None:
        for name in self.__slots__:
            object.__setattr__(self, name, mp.mpf(getattr(self, name)))

    @property
    def valid(self) -> bool:
        return all(mp.isfinite(x) and x > 0 for x in (self.velocity, self.acceleration, self.deceleration, self.jerk))


@dataclass(frozen=True, slots=True)
class Request:
    """What a synchronisation is planned from.

    `mode`: gear_in_velo or gear_in_pos; `sync`: the sync positions (master, slave) of gear_in_pos (u), the master's
    already the next one ahead; `bits`: names of the sync mode that are set; `ends`: software end positions (u);
    `encoder_noise`: an encoder as master makes accelerations up to below it (u/s2).
    """

    mode: str
    master: Motion
    slave: Motion
    factor: Number
    limits: Limits
    bits: Collection[str] = ()
    ends: tuple[Number, Number] = (-mp.inf, mp.inf)
    sync: tuple[Number, Number] | None = None
    encoder_noise: Number = ZERO

    @property
    def time_based(self) -> bool:
        return "time_based" in self.bits

    @property
    def synchronous_velocity(self) -> Number:
        return self.factor * self.master.velocity

    @property
    def master_acceleration(self) -> Number:
        """What counts of it in a profile over the master's position."""
        ignored = "ignore_master_acceleration" in self.bits or abs(self.master.acceleration) < self.encoder_noise
        return ZERO if ignored else self.master.acceleration

    @property
    def slave_acceleration(self) -> Number:
        return ZERO if "ignore_slave_acceleration" in self.bits else self.slave.acceleration

    @property
    def start_acceleration(self) -> Number:
        """ã0, that of the profile at constant master velocity."""
        return self.slave_acceleration - self.slave.velocity * self.master_acceleration / self.master.velocity

    @property
    def is_slave_at_rest(self) -> bool:
        return bool(self.slave.velocity == 0 and self.slave.acceleration == 0)

    @property
    def time(self) -> Number:
        """T of gear_in_pos (s)."""
        assert self.sync
        return (self.sync[0] - self.master.position) / self.master.velocity

    @property
    def distance(self) -> Number:
        """D of gear_in_pos (u)."""
        assert self.sync
        return self.sync[1] - self.slave.position
