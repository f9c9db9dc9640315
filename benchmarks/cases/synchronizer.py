"""What the Synchronizer is measured in."""

from cases.measured import PERIOD, TURNS_A_STEP, Cases, H, Steady, Worst
from motionsync.master import MasterInput
from motionsync.synchronizer.interface import Curve

CASES = Cases(
    steady=(
        Steady("on the master", holds={"synchronized": True}),
        Steady(
            "in a ramp",
            start={"output_phasing": 1e9},
            begin={"master.position": -2e9, "stop": True},  # no benchmark comes to its end
            holds={"syn_ramp_on": True},
        ),
    ),
    # The longest step plans a ramp, runs it to its end, plans the stacked ramp and runs that to its end, too.
    worst=tuple(
        Worst(
            f"start and stop together, {mode.name}, {curve.name}",
            ("start", "stop"),
            start={"master.period": PERIOD, "master.input_mode": mode, "curve": curve},
            velocity=TURNS_A_STEP * PERIOD / H,
            watch=("state_code",),
            planned=((0,),),
        )
        for mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP)
        for curve in Curve
    ),
)
