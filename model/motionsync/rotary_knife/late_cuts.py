"""Cuts that cannot be reached and are left out: which one comes next."""

from ..cutting.interface import Source, Statistics
from ..cutting.material import Material
from ..cutting.piece import UNLIMITED
from ..numerics.grid import floor
from .departure import MOST_PLACES, Departure
from .knife import Knife
from .window import Window

WHOLE = 1e-12  # of a pitch: what a number of pitches may lack to be whole


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
