"""What the Gearing is measured in."""

from typing import Any

from cases.measured import FAR_AWAY, PERIOD, TURNS_A_STEP, Cases, H, Steady, Worst
from motionsync.gearing.interface import StartMode, State, StopMode, Transition

STRAIGHT_IN = {"gear_in.start_mode": StartMode.CW_CCW_DIRECT, "gear_in.transition": Transition.NONE}
STRAIGHT_OUT = {"gear_out.stop_mode": StopMode.CW_CCW_DIRECT, "gear_out.transition": Transition.NONE}
AT_REFERENCE = {"gear_in.start_mode": StartMode.WITH_CW_CCW_REFERENCE_POSITION}
AT_STOP = {"gear_out.stop_mode": StopMode.WITH_CW_CCW_STOP_POSITION}
SHORT = 0.1  # u and H: a transition within the step that starts it
ROTARY = {"master.period": PERIOD, "slave.period": PERIOD, "gearing.numerator": 7, "gearing.denominator": -3}


def engaged(name: str, transition: Transition, *, velocity: float = 500.0, **start: Any) -> Worst:
    """From rest into gear within a step, through a reference position ahead that is drawn anew each time."""
    own = {"gear_in.transition": transition, "gear_in.distance": SHORT, "gear_in.time": SHORT * H}
    return Worst(
        f"engaged, {name}",
        ("start",),
        start=AT_REFERENCE | STRAIGHT_OUT | own | start,
        velocity=velocity,
        ahead={"gear_in.reference_position": ("master.position", (0.6 * SHORT, 0.3))},
        watch=("state_code",),
        planned=((State.ACTIVE,),),
    )


def disengaged(name: str, transition: Transition) -> Worst:
    """From gear to rest within a step, at whose beginning `start` falls; the step between leads into gear."""
    own = {"gear_out.transition": transition, "gear_out.distance": SHORT, "gear_out.time": SHORT * H}
    return Worst(
        f"disengaged, {name}",
        ("reset",),
        start=STRAIGHT_IN | AT_STOP | own,
        between=("start",),
        ahead={"gear_out.stop_position": ("slave.position", (0.6 * SHORT, 0.3))},
        watch=("state_code",),
        planned=((State.STOPPED,),),
    )


CASES = Cases(
    steady=(
        Steady("in gear", start=STRAIGHT_IN, begin={"start": True}, holds={"state_code": State.ACTIVE}),
        Steady(
            "waiting for the reference position",
            begin={"start": True, "gear_in.reference_position": FAR_AWAY},
            holds={"state_code": State.WAITING_FOR_STARTPOSITION},
        ),
        Steady(
            "in a master-based transition",
            start=STRAIGHT_IN | {"gear_in.transition": Transition.MASTER_BASED, "gear_in.distance": FAR_AWAY},
            begin={"start": True},
            holds={"state_code": State.GEAR_IN},
        ),
        Steady(
            "in a time-based transition",
            start=STRAIGHT_IN | {"gear_in.transition": Transition.TIME_BASED, "gear_in.time": FAR_AWAY},
            begin={"start": True},
            holds={"state_code": State.GEAR_IN},
        ),
    ),
    worst=(
        engaged("master-based", Transition.MASTER_BASED),
        engaged("time-based", Transition.TIME_BASED),
        engaged("master-based, rotary axes", Transition.MASTER_BASED, **ROTARY),
        engaged("master-based, many turns", Transition.MASTER_BASED, velocity=TURNS_A_STEP * PERIOD / H, **ROTARY),
        disengaged("master-based", Transition.MASTER_BASED),
        disengaged("time-based", Transition.TIME_BASED),
    ),
)
