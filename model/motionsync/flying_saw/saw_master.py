"""The master of a flying saw, which may be an encoder.

Source: TS5055, section 7, note.
"""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..numerics.computable_range import LARGEST
from ..var import Unit


@dataclass(slots=True)
class SawMaster(Master):
    """The master axis, which may be an encoder."""

    encoder_scaling: float = var.parameter(
        0.0,
        "travel per increment, if the master is an encoder, else 0: a master acceleration below 2 encoder_scaling / "
        "master.sample_time^2 (if that is 0, of the step) counts as 0 at the coupling; not with time_based",
        Unit.POSITION,
        min=0.0,
        max=LARGEST,
    )


def coupling_acceleration(master: SawMaster, acceleration: float) -> float:
    """What counts of the master's acceleration at the coupling, u/s2: nothing that may be the encoder's alone."""
    cycle = master.sample_time if master.sample_time > 0.0 else master.step
    return 0.0 if abs(acceleration) * cycle * cycle < 2.0 * master.encoder_scaling else acceleration
