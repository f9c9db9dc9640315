"""What the RotaryKnife is measured in."""

from cases.measured import FAR_AWAY, VELOCITY, Cases, Steady, Values, Worst
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.rotary_knife.interface import State, SyncMode

START_COMMAND: Values = {"start": True}
# A cylinder so large that each section lasts longer than any benchmark, k = 3.6e-8 degrees per u. The first step, in
# which the master travels up to 90 s, leads there.
LARGE: Values = {"knife.circumference": 1e10}
WINDOW: Values = LARGE | {"sync.before": FAR_AWAY, "sync.after": FAR_AWAY}  # 36 degrees on both sides
# Without a window, and with the park angle so near that the ramp up takes 5556 u: a trim of 6000 is cut in that step.
AFTER_TRIM: Values = LARGE | {
    "sync.before": 0.0,
    "sync.after": 0.0,
    "knife.park_angle": 359.9999,
    "start_mode": StartMode.TRIM,
    "trim_length": 6000.0,
}
LEAD_IN = 90.0  # s
LEADING: Values = START_COMMAND | {"master.position": -LEAD_IN * VELOCITY}  # the master is at 0 at its end
# An axis that can follow a line on which a piece ends in every second step of 1 ms.
QUICK_AXIS: Values = {
    "auto_start": True,
    "axis.max_velocity": 1e7,
    "axis.max_acceleration": 1e12,
    "axis.max_jerk": 1e12,
}

CASES = Cases(
    steady=(
        Steady(
            "waiting for the ramp up",
            start={"length": FAR_AWAY},
            begin=START_COMMAND,
            holds={"state_code": State.WAITING},
        ),
        Steady("off", holds={"state_code": State.OFF}),
        Steady(
            "ramp up",  # 2 (360 - 180 - 36) / k = 8e9, and the window's 1e9
            start=WINDOW | {"length": 9.0 * FAR_AWAY + 100.0},
            begin=LEADING,
            first=LEAD_IN,
            holds={"state_code": State.ENGAGING},
        ),
        Steady(
            "in the window",  # a ramp of 2 (360 - 323.9999 - 36) / k = 5556
            start=WINDOW | {"knife.park_angle": 323.9999, "length": FAR_AWAY + 6000.0},
            begin=LEADING,
            first=LEAD_IN,
            holds={"state_code": State.SYNCHRONOUS},
        ),
        Steady(
            "in the window, HORIZONTAL",  # it begins at 321.073825, 1.2854 k over the master: a ramp of 5383
            start=WINDOW
            | {"sync.mode": SyncMode.HORIZONTAL, "knife.park_angle": 321.0737, "length": FAR_AWAY + 6000.0},
            begin=LEADING,
            first=LEAD_IN,
            holds={"state_code": State.SYNCHRONOUS},
        ),
        Steady(
            "turning on",
            start=AFTER_TRIM | {"length": 8.0 * FAR_AWAY},
            begin=LEADING,
            first=LEAD_IN,
            holds={"state_code": State.TURNING},
        ),
        Steady(
            "ramp down",
            start=AFTER_TRIM | {"length": 50.0 * FAR_AWAY},
            begin=LEADING,
            first=LEAD_IN,
            holds={"state_code": State.DISENGAGING},
        ),
        Steady(
            "parking after a fault",
            start=AFTER_TRIM | {"length": 1.0, "late_mode": LateMode.STOP_LINE, "axis.max_velocity": 1e-5},
            begin=LEADING,
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
        Worst(
            "a piece ends",
            ("take_sample",),
            start=QUICK_AXIS | {"sample_length": 620.0},
            velocity=4e5,  # two pieces in three steps; ramp up and lengths keep the greatest jerk that is allowed
            draws={"length": (560.0, 700.0)},
            watch=("piece.kind",),
            planned=((PieceKind.SAMPLE,), (PieceKind.PRODUCT,)),
        ),
        Worst(
            "a piece ends, HORIZONTAL, a cut is late",
            ("take_sample",),
            start=QUICK_AXIS
            | {
                "sync.mode": SyncMode.HORIZONTAL,
                "sync.before": 30.0,
                "sync.after": 30.0,
                "late_mode": LateMode.LATE,
                "sample_length": 300.0,
            },
            velocity=2.1e5,  # two pieces in five steps; the samples are late
            draws={"length": (500.0, 900.0)},
            watch=("piece.kind",),
            planned=((PieceKind.SAMPLE,), (PieceKind.PRODUCT,)),
        ),
        Worst(
            "cut_now",
            ("cut_now",),
            start={"auto_start": True},
            pause=0.7,
            draws={"length": (900.0, 1200.0)},
            watch=("piece.kind",),
            planned=((PieceKind.SHORT,),),
        ),
    ),
    longest_us=100.0,  # all limits of a piece are solved in it
)
