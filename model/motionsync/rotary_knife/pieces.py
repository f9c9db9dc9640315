"""The pieces of a rotary knife: each is fixed with the window that is set then, and ends with a cut that is reached."""

from dataclasses import dataclass

from .. import var
from ..cutting.faults import NoLength, PieceFault
from ..cutting.interface import PieceKind, Source, Statistics
from ..cutting.material import Material
from ..cutting.operation import Operation
from ..cutting.piece import UNLIMITED
from ..numerics.grid import floor
from .departure import MOST_PLACES, Departure
from .interface import RotaryKnifeInterface
from .knife import Knife
from .predictions import Predictions
from .window import Window

WHOLE = 1e-12  # of a pitch: what a number of pitches may lack to be whole


@dataclass(slots=True)
class FixedPiece:
    """What the piece in progress was fixed with.

    Attributes:
        window: of the cut that ends it.
        ramp_begin: where the ramp up to this window begins, from the cut, u of the master.
        ramp_velocity: of the fastest line that admits this ramp, u/s.
        is_late: its cut is made later than where it was due.
    """

    window: Window = var.part(Window)
    ramp_begin: float = 0.0
    ramp_velocity: float = 0.0
    is_late: bool = False

    def accept(
        self,
        block: RotaryKnifeInterface,
        operation: Operation,
        material: Material,
        predictions: Predictions,
        is_sample_pending: bool,
    ) -> None:
        """Take the present window for the piece that was fixed; it is not fixed if the knife would have to park for it,
        and must not. `is_sample_pending`: before it was fixed."""
        piece = material.piece
        if not piece.is_fixed:
            return
        if piece.kind != PieceKind.TRIM and is_too_long(block, predictions, piece.pitch):
            piece.reset()
            material.is_sample_pending = is_sample_pending
            operation.refusal = PieceFault.TUNABLE
        else:
            self.take_window(predictions)

    def take_window(self, predictions: Predictions) -> None:
        """The piece in progress ends with a cut in the window as it is set."""
        var.copy(self.window, predictions.window)
        self.ramp_begin = predictions.ramp_up.way.ramp_up.begin
        self.ramp_velocity = predictions.ramp_up.max_line_velocity
        self.is_late = False
        predictions.is_cycle_current = False


def is_too_long(block: RotaryKnifeInterface, predictions: Predictions, pitch: float) -> bool:
    """Whether the knife would have to park for a piece of that pitch, u of the master, and must not."""
    return not block.allow_parking and block.source == Source.LENGTH and pitch > predictions.lengths.longest


def missing_length(block: RotaryKnifeInterface, predictions: Predictions, material: Material) -> NoLength:
    """Why no length is known for the piece that starts at the last cut."""
    reason = material.missing_length()
    pitch = material.pitch_of(material.expected_length(False))
    is_longer = pitch < UNLIMITED and is_too_long(block, predictions, pitch)
    return NoLength.TOO_LONG if reason == NoLength.NONE and not material.piece.is_fixed and is_longer else reason


def changed_cut(block: RotaryKnifeInterface, predictions: Predictions, material: Material) -> float:
    """The cut of the product in progress if it is fixed anew, a position of the master; UNLIMITED: it cannot be."""
    length, _ = material.next_product()
    pitch = material.pitch_of(length)
    is_possible = pitch < UNLIMITED and not is_too_long(block, predictions, pitch)
    return material.piece.begin + pitch if is_possible else UNLIMITED


def skip_cuts_before(material: Material, place: float, statistics: Statistics) -> None:
    """Leave out the next cut, and all others that are before a position of the master, u."""
    if material.demand.source == Source.MARK:
        material.skip_mark(statistics)
        while material.marks.waiting > 0 and material.marks.position(0) < place:
            material.skip_mark(statistics)
        material.merge_to_next_mark()
    else:
        piece = material.piece
        number = -floor(WHOLE - (place - piece.end) / piece.pitch)
        material.skip_pitches(max(number, 1.0), statistics)


def skip_to_reached_cut(
    departure: Departure, knife: Knife, window: Window, material: Material, statistics: Statistics
) -> bool:
    """Leave out the next cut, and all others up to the first one that can be reached; False: none can, and the piece
    stays as it is."""
    if material.demand.source == Source.MARK:
        return skip_to_reached_mark(departure, knife, window, material, statistics)
    piece = material.piece
    number = 1.0
    if piece.pitch >= UNLIMITED:
        return False
    for _ in range(MOST_PLACES):
        if departure.try_cut(knife, window, piece.end + number * piece.pitch, True):
            material.skip_pitches(number, statistics)
            return True
        if departure.is_beyond_ramps():
            return False
        number += 1.0
    return False


def skip_to_reached_mark(
    departure: Departure, knife: Knife, window: Window, material: Material, statistics: Statistics
) -> bool:
    """As `skip_to_reached_cut`, of the marks that wait."""
    for index in range(1, material.marks.waiting):
        place = material.marks.position(index)
        if not material.piece.leaves_length(place):
            continue
        if departure.try_cut(knife, window, place, True):
            for _ in range(index):
                material.skip_mark(statistics)
            material.merge_to_next_mark()
            return True
        if departure.is_beyond_ramps():
            return False
    return False
