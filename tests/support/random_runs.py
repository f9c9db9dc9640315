"""How each registered block is driven at random: each block's runs stand in a module of their own."""

from functools import cache
from typing import Any

from hypothesis import Phase, given, settings

from motionsync.blocks import BLOCKS
from motionsync.flying_saw import block as flying_saw
from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.profile import ProfileKind
from motionsync.follower import block as follower
from motionsync.follower import faults as follower_faults
from motionsync.follower.block import Follower
from motionsync.follower.course import Stage
from motionsync.gearing import choices as gearing
from motionsync.gearing import faults as gearing_faults
from motionsync.gearing.block import Gearing
from motionsync.master import MasterInput
from motionsync.remote_sync import block as remote_sync
from motionsync.remote_sync import faults as remote_sync_faults
from motionsync.remote_sync.blending import Mode
from motionsync.remote_sync.block import RemoteSync
from motionsync.synchronizer import block as synchronizer
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.transition import Curve
from motionsync_fmu.interface.variables import cells, variables
from tests.model.flying_saw import strategies as drive_flying_saw
from tests.model.follower import strategies as drive_follower
from tests.model.gearing import strategies as drive_gearing
from tests.model.remote_sync import strategies as drive_remote_sync
from tests.model.synchronizer import strategies as drive_synchronizer
from tests.support.runs import Drive, Run

# The flying saw's faults that are not rare: the shapes that break the other checks have tests of their own.
OFTEN = (
    Fault.NONE,
    Fault.SLAVE_MOVING,
    Fault.FACTOR,
    Fault.MASTER_STANDING,
    Fault.TIME_BASED,
    Fault.LIMIT,
    Fault.NOT_AHEAD,
    Fault.CHECK,
    Fault.LOCKED,
)


def _synchronizer(block: Synchronizer) -> set[Any]:
    return {
        ("state", block.state),
        ("ramping", block.master.input_mode, block.syn_ramp_on),
        ("fault", block.error_id),
        ("curve", block.running.curve),
    }


def _flying_saw(block: FlyingSaw) -> set[Any]:
    return {
        ("state", block.state),
        ("PLCopen", block.plcopen_state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("profile", block.characteristics.profile),
    }


def _gearing(block: Gearing) -> set[Any]:
    order = block.order_in if block.state < gearing.State.WAITING_FOR_STOPPOSITION else block.order_out
    return {
        ("state", block.state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("manoeuvre", block.state, order.aim, order.transition),
        ("inactive", block.state if block.frozen else None),
        ("pending", block.state if block.pending else None),
    }


def _follower(block: Follower) -> set[Any]:
    return {
        ("stage", block.course.stage),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("cyclic", block.slave_cycle > 0.0, block.state),
        ("variable", block.variable_cycle, block.state),
        ("tight", block.course.tight),
    }


def _remote_sync(block: RemoteSync) -> set[Any]:
    return {
        ("state", block.state),
        ("fault", block.error_id),
        ("estimator", block.estimator, block.synced),
        ("warning", block.warning),
        ("transition", block.estimator, block.local.transition),
        ("blending", block.blending.mode, block.blending.cycles > 0),
    }


# What the gearing may be about in the states of a manoeuvre; without transition the latter two are over at once.
MANOEUVRES = {
    gearing.State.WAITING_FOR_STARTPOSITION: tuple(gearing.Aim),
    gearing.State.WAITING_FOR_STOPPOSITION: (gearing.Aim.DIRECT, gearing.Aim.POSITION),
    gearing.State.GEAR_IN: tuple(gearing.Aim),
    gearing.State.GEAR_OUT: (gearing.Aim.DIRECT, gearing.Aim.POSITION),
}
AT_ONCE = {
    ("manoeuvre", state, aim, gearing.Transition.NONE)
    for state in (gearing.State.GEAR_IN, gearing.State.GEAR_OUT)
    for aim in gearing.Aim
}
# The follower's faults that are not rare.
FOLLOWER_OFTEN = (
    follower_faults.Fault.NONE,
    follower_faults.Fault.POSITIONING,
    follower_faults.Fault.MASTER_MOVED,
    follower_faults.Fault.NO_ROOM,
    follower_faults.Fault.SPEED_FOLLOWING,
    follower_faults.Fault.MASTER_BACKWARDS,
)


DRIVES: dict[str, Drive] = {
    "Synchronizer": Drive(
        drive_synchronizer.runs,
        _synchronizer,
        frozenset(
            {
                *(("state", state) for state in synchronizer.State),
                *(("ramping", mode, on) for mode in MasterInput for on in (False, True)),
                *(("fault", fault) for fault in synchronizer.Fault),
                *(("curve", curve) for curve in Curve),
            }
        ),
    ),
    "FlyingSaw": Drive(
        drive_flying_saw.runs,
        _flying_saw,
        frozenset(
            {
                *(("state", state) for state in flying_saw.State),
                *(("PLCopen", state) for state in flying_saw.PlcopenState),
                *(("mode", mode) for mode in MasterInput),
                *(("fault", fault) for fault in OFTEN),
                *(("profile", kind) for kind in (ProfileKind.NONE, ProfileKind.P5, ProfileKind.JERK_LIMITED)),
            }
        ),
    ),
    "Gearing": Drive(
        drive_gearing.runs,
        _gearing,
        frozenset(
            {
                *(("state", state) for state in gearing.State),
                *(("mode", mode) for mode in MasterInput),
                *(("fault", fault) for fault in gearing_faults.Fault),
                *(("inactive", state) for state in gearing.State),
                *(("pending", state) for state in (gearing.State.GEAR_IN, gearing.State.GEAR_OUT)),
                *(
                    ("manoeuvre", state, aim, transition)
                    for state, aims in MANOEUVRES.items()
                    for aim in aims
                    for transition in gearing.Transition
                ),
            }
        )
        - AT_ONCE,
    ),
    "Follower": Drive(
        drive_follower.runs,
        _follower,
        frozenset(
            {
                *(("stage", stage) for stage in Stage),
                *(("mode", mode) for mode in MasterInput),
                *(("fault", fault) for fault in FOLLOWER_OFTEN),
                *(("cyclic", False, state) for state in follower.State),
                *(("cyclic", True, state) for state in follower.State if state != follower.State.M_DECEL),
                *(("variable", variable, state) for variable in (False, True) for state in follower.State),
                *(("tight", tight) for tight in (False, True)),
            }
        ),
    ),
    "RemoteSync": Drive(
        drive_remote_sync.runs,
        _remote_sync,
        frozenset(
            {
                *(("state", mode) for mode in Mode),
                *(("fault", fault) for fault in remote_sync_faults.Fault),
                *(("estimator", kind, synced) for kind in remote_sync.Estimator for synced in (False, True)),
                *(("warning", warning) for warning in (False, True)),
                *(("transition", kind, zone) for kind in remote_sync.Estimator for zone in (False, True)),
                *(("blending", mode, True) for mode in Mode),
            }
        ),
    ),
}


def drawn(name: str, steps: int, count: int) -> list[Run]:
    """The same runs at every call."""
    found: list[Run] = []

    @settings(max_examples=count, derandomize=True, database=None, deadline=None, phases=[Phase.generate])
    @given(DRIVES[name].runs(steps))
    def draw(run: Run) -> None:
        found.append(run)

    draw()
    return found


@cache
def calm(name: str, h: float, steps: int, *, count: int = 20) -> Run:
    """A run with steps of size h of which none is refused: of those drawn, the one that meets most."""
    allows = {v.name: v.allows for v in variables(BLOCKS[name]())}
    runs = [
        Run(run.start, [(h, {n: x for n, x in values.items() if allows[n](x)}) for _, values in run.steps])
        for run in drawn(name, steps, count)
    ]
    met = [_met(name, run) for run in runs]
    assert max(met) > 0, f"every run of {name} has a refused step"
    return runs[met.index(max(met))]


def _met(name: str, run: Run) -> int:
    """How many different things a run meets; 0 if anything is refused."""
    block = BLOCKS[name]()
    by_name = {c.name: c for c in cells(block)}
    seen: set[Any] = set()
    for n, value in run.start.items():
        by_name[n].set(value)
    refused = block.initialize()
    for h, values in run.steps:
        for n, value in values.items():
            by_name[n].set(value)
        refused = refused or block.step(h)
        if refused:
            return 0
        seen |= DRIVES[name].watch(block)
    return len(seen)
