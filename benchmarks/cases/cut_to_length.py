"""What the CutToLength is measured in."""

from typing import Any

from cases.measured import FAR, VELOCITY, Bounds, Cases, Steady, Values, Worst
from motionsync.cut_to_length.interface import LateMode, Source, State, ToolMode

LEAD_IN = 1.0  # s: within it the carriage passes from rest into the motion that is measured
FOREVER = 1e6  # s
GO: Values = {"start": True}
WIDE = {"axis.min_position": -1e12, "axis.max_position": 1e12}
FIRST_CUT: Values = {"master.position": -VELOCITY * LEAD_IN, **GO}  # the master is at 0 after the step
UNTIL_DONE = {"tool.mode": ToolMode.FEEDBACK, "late_mode": LateMode.LATE}
WORKING = {
    "kerf": 4.0,
    "tool.settle_time": 0.05,
    "homing.velocity": 1200.0,
    "homing.settle_time": 0.02,
    "approach.reserve": 0.1,
}


def of_one_cut(name: str, state: State, **start: Any) -> Steady:
    """One phase of the first cut's cycle, longer than any benchmark; the first step passes the phases before it."""
    own = {"length": 10.0, "tool.cut_time": 0.01, **{key.replace("__", "."): x for key, x in start.items()}}
    return Steady(name, start=WIDE | own, begin=FIRST_CUT, first=LEAD_IN, holds={"state_code": state})


def piece_ends(
    name: str, start: Values, lengths: Bounds = (700.0, 1400.0), drawn: str = "length", *between: str
) -> Worst:
    """`tool.done` ends the cut: the books are kept, the next piece is fixed, the limits are solved, the way home is
    planned. In the step between the carriage comes home, and into the next cut, wherever that is possible first."""
    return Worst(
        f"a piece ends, {name}",
        ("tool.done",),
        start=UNTIL_DONE | {"auto_start": True} | start,
        pause=4.0,
        between=between,
        draws={drawn: lengths},
        watch=("state_code",),
        planned=((State.RETURNING,), (State.PULLING,)),
    )


CASES = Cases(
    steady=(
        Steady("waiting for the start", start={"length": FAR}, begin=GO, holds={"state_code": State.WAITING}),
        Steady("off", holds={"state_code": State.OFF}),
        Steady(
            "to home after start",
            start={"axis.initial_position": 1e3, "homing.velocity": 1e-3},
            begin=GO,
            first=LEAD_IN,
            holds={"state_code": State.HOMING},
        ),
        of_one_cut("approaching", State.APPROACHING, length=FAR + 10.0, front_position=FAR, approach__distance=FAR),
        of_one_cut("in sync, settling", State.SYNCHRONOUS, tool__settle_time=FOREVER),
        of_one_cut("cutting, by time", State.CUTTING, tool__cut_time=FOREVER),
        of_one_cut("cutting, by distance", State.CUTTING, tool__mode=ToolMode.DISTANCE, tool__cut_distance=FAR),
        of_one_cut("opening the gap", State.PULLING, gap__distance=1.0, gap__travel=FAR),
        of_one_cut("the blade leaves the material", State.CLEARING, tool__retract_time=FOREVER),
        of_one_cut("on the way home", State.RETURNING, homing__velocity=1e-6),
        Steady(
            "after a fault",
            start={"length": 10.0, "tool.mode": ToolMode.FEEDBACK, "tool.timeout": 0.01},
            begin=FIRST_CUT,
            first=LEAD_IN,
            holds={"state_code": State.FAULT},
        ),
        Steady("waiting for a mark", start={"source": Source.MARK}, begin=GO, holds={"state_code": State.WAITING}),
        Steady(
            "waiting, the line's velocity changes in each step",
            start={"length": FAR},
            begin=GO,
            holds={"state_code": State.WAITING},
            change=1e-3,
        ),
    ),
    worst=(
        piece_ends("start values", {}),
        piece_ends("all times, limits of its own", WORKING),
        piece_ends("with a gap", WORKING | {"gap.distance": 10.0, "gap.travel": 150.0}),
        piece_ends("eased way home", WORKING | {"homing.ease": True}, (1500.0, 1900.0)),
        piece_ends(
            "64 orders wait",
            WORKING | {"order.repeat": True, "order.length": 900.0},
            (700.0, 1400.0),
            "order.length",
            "order.add",
        ),
    ),
)
