"""What the Follower is measured in."""

from cases.measured import FAR_AWAY, Cases, H, Steady, Worst
from motionsync.follower.interface import State

CYCLES_A_STEP = 5.0
LONG_CYCLE = {"master_cycle": 1e12}
TO_PARK = {"position_to_park": True}  # at standstill on the park: the slave is there at once
LATE = {"variable_cycle": True, "recover_late_sync": True, "stop_in_park": False, "slave_cycle": 500.0}


def passed(name: str, state: State, sync_slave: float, sync_out: float, sync_master: float, first: float) -> Steady:
    """One section of a cycle, longer than any benchmark; the first step passes the sections before it."""
    return Steady(
        name,
        start=LONG_CYCLE
        | {"sync_slave": sync_slave, "sync_out": sync_out, "space_stop_slave": 1.0, "sync_master": sync_master},
        begin=TO_PARK,
        first=first,
        holds={"state_code": state},
    )


CASES = Cases(
    steady=(
        passed("with the master", State.M_SYNCHRONIZED, 1.0, FAR_AWAY, 10.0, 1.0),
        passed("waiting at the park", State.M_WAITING, 1.0, 2.0, FAR_AWAY, H),
        passed(
            "on the way to the meeting",
            State.M_FOLLOWING,
            FAR_AWAY,
            2.0 * FAR_AWAY,
            2.0 * FAR_AWAY + 10.0,
            1.0,
        ),
        passed("on the way home", State.M_HOMING, 1.0, 2.0, 10.0, 1.0),
        Steady(
            "in a positioning, cruising",
            start={"slave.initial_position": FAR_AWAY},
            begin=TO_PARK,
            first=1.0,
            holds={"state_code": State.M_POSITIONING},
        ),
    ),
    worst=(
        Worst(
            "position_to_park",
            ("position_to_park",),
            start=LONG_CYCLE | {"sync_master": 0.9e12},
            pause=10.0,
            draws={"park_slave": (-1000.0, 90.0)},
            watch=("state_code",),
            planned=((State.M_POSITIONING,),),
        ),
        *(
            Worst(
                f"position_to_cycle, {name}",
                ("position_to_cycle",),
                start=start,
                velocity=0.0,
                pause=10.0,
                draws={"sync_master": (0.0, 1000.0)},
                watch=("state_code",),
                planned=((State.M_POSITIONING,),),
            )
            for name, start in (
                ("linear", {}),
                ("cyclic", {"slave_cycle": 500.0}),
                ("cyclic without parking", {"slave_cycle": 500.0, "stop_in_park": False}),
            )
        ),
        *(
            Worst(
                f"{CYCLES_A_STEP:.0f} cycles in the step, {name}",
                ("reset",),
                start=start,
                velocity=CYCLES_A_STEP * 1000.0 / H,
                between=("position_to_park",),
                watch=("state_code",),
                planned=tuple((state,) for state in State if state >= State.M_WAITING),
            )
            for name, start in (
                ("linear", {}),
                ("cyclic", {"slave_cycle": 500.0}),
                ("cyclic without parking", {"slave_cycle": 500.0, "stop_in_park": False}),
            )
        ),
        Worst(
            "a late meeting is joined, limits checked",
            ("reset",),
            start=LATE | {"max_speed": 1e5, "max_acceleration": 1e9},
            pause=10.0,
            between=("position_to_park",),
            ahead={"sync_master": ("master.position", (20.0, 190.0))},
            watch=("state_code",),
            planned=((State.M_FOLLOWING,),),
        ),
    ),
)
