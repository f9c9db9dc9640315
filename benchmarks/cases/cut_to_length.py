"""What the CutToLength is measured in."""

from typing import Any

from cases.measured import FAR_AWAY, VELOCITY, Bounds, Cases, Steady, Values, Worst
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.interface import LateMode, PieceKind, Source

LEAD_IN = 1.0  # s: within it the carriage passes from rest into the motion that is measured
FOREVER = 1e6  # s
START_COMMAND: Values = {"start": True}
WIDE = {"axis.min_position": -1e12, "axis.max_position": 1e12}
FIRST_CUT: Values = {"master.position": -VELOCITY * LEAD_IN, **START_COMMAND}  # the master is at 0 after the step
UNTIL_DONE = {"tool.mode": ToolMode.FEEDBACK, "late_mode": LateMode.LATE}
ALL_TIMES = {
    "kerf": 4.0,
    "tool.settle_time": 0.05,
    "homing.velocity": 1200.0,
    "homing.settle_time": 0.02,
    "approach.reserve": 0.1,
}


def phase_of_one_cut(name: str, state: State, **start: Any) -> Steady:
    """One phase of the first cut's cycle, longer than any benchmark; the first step passes the phases before it."""
    values = {"length": 10.0, "tool.cut_time": 0.01, **{key.replace("__", "."): x for key, x in start.items()}}
    return Steady(name, start=WIDE | values, begin=FIRST_CUT, first=LEAD_IN, holds={"state_code": state})


def end_of_piece(
    name: str, start: Values, lengths: Bounds = (700.0, 1400.0), drawn_input: str = "length", *between: str
) -> Worst:
    """`tool.done` ends the cut: the piece is recorded, the next one is fixed, the limits are solved, the motion home is
    planned. In the step between the carriage comes home, and into the next cut, wherever that is possible first."""
    return Worst(
        f"a piece ends, {name}",
        ("tool.done",),
        start=UNTIL_DONE | {"auto_start": True} | start,
        pause=4.0,
        between=between,
        draws={drawn_input: lengths},
        watch=("state_code",),
        planned=((State.RETURNING,), (State.PULLING,)),
    )


CASES = Cases(
    steady=(
        Steady(
            "waiting for the start",
            start={"length": FAR_AWAY},
            begin=START_COMMAND,
            holds={"state_code": State.WAITING},
        ),
        Steady("off", holds={"state_code": State.OFF}),
        Steady(
            "to home after start",
            start={"axis.initial_position": 1e3, "homing.velocity": 1e-3},
            begin=START_COMMAND,
            first=LEAD_IN,
            holds={"state_code": State.HOMING},
        ),
        phase_of_one_cut(
            "approaching",
            State.APPROACHING,
            length=FAR_AWAY + 10.0,
            front_position=FAR_AWAY,
            approach__distance=FAR_AWAY,
        ),
        phase_of_one_cut("in sync, settling", State.SYNCHRONOUS, tool__settle_time=FOREVER),
        phase_of_one_cut("cutting, by time", State.CUTTING, tool__cut_time=FOREVER),
        phase_of_one_cut(
            "cutting, by distance", State.CUTTING, tool__mode=ToolMode.DISTANCE, tool__cut_distance=FAR_AWAY
        ),
        phase_of_one_cut("opening the gap", State.PULLING, gap__distance=1.0, gap__travel=FAR_AWAY),
        phase_of_one_cut("the blade leaves the material", State.CLEARING, tool__retract_time=FOREVER),
        phase_of_one_cut("on the way home", State.RETURNING, homing__velocity=1e-6),
        Steady(
            "after a fault",
            start={"length": 10.0, "tool.mode": ToolMode.FEEDBACK, "tool.timeout": 0.01},
            begin=FIRST_CUT,
            first=LEAD_IN,
            holds={"state_code": State.FAULT},
        ),
        Steady(
            "waiting for a mark",
            start={"source": Source.MARK},
            begin=START_COMMAND,
            holds={"state_code": State.WAITING},
        ),
        Steady(
            "waiting, the line's velocity changes in each step",
            start={"length": FAR_AWAY},
            begin=START_COMMAND,
            holds={"state_code": State.WAITING},
            change=1e-3,
        ),
    ),
    worst=(
        end_of_piece("start values", {}),
        end_of_piece("all times, limits of its own", ALL_TIMES),
        end_of_piece("with a gap", ALL_TIMES | {"gap.distance": 10.0, "gap.travel": 150.0}),
        end_of_piece("eased way home", ALL_TIMES | {"homing.ease": True}, (1500.0, 1900.0)),
        end_of_piece(
            "64 orders wait",
            ALL_TIMES | {"order.repeat": True, "order.length": 900.0},
            (700.0, 1400.0),
            "order.length",
            "order.add",
        ),
        Worst(
            "cut_now",
            ("cut_now",),
            start={"auto_start": True},
            pause=2.3,
            draws={"length": (2000.0, 3000.0)},
            watch=("piece.kind",),
            planned=((PieceKind.SHORT,),),
        ),
    ),
    longest_us=100.0,  # all limits of a piece are solved in it
)
