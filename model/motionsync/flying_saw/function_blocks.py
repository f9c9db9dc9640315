"""All function blocks of the axis together: their edges, their outputs, and which of them owns the axis."""

from ..var import Enumeration
from .commands import GearInVelo, Phase
from .interface import FlyingSawInterface, State


class Owner(Enumeration):
    """Whose command moves the axis, or waits to do so"""

    NOBODY = 0, "no command's, or one that is done"
    GEAR_IN_VELO = 1, "gear_in_velo's"
    GEAR_IN_POS = 2, "gear_in_pos's"
    HALT = 3, "halt's"
    STOP = 4, "stop's"
    MOVE_VELOCITY = 5, "move_velocity's"
    MOVE_ABSOLUTE = 6, "move_absolute's"


def take_execute_levels(block: FlyingSawInterface) -> None:
    """Take the present levels of `execute` as they are: the first level of an input is no edge."""
    block.reset.edge.take_level(block.reset.execute)
    block.stop.edge.take_level(block.stop.execute)
    block.halt.edge.take_level(block.halt.execute)
    block.gear_out.edge.take_level(block.gear_out.execute)
    block.gear_in_velo.edge.take_level(block.gear_in_velo.execute)
    block.gear_in_pos.edge.take_level(block.gear_in_pos.execute)
    block.move_velocity.edge.take_level(block.move_velocity.execute)
    block.move_absolute.edge.take_level(block.move_absolute.execute)


def report_phase(block: FlyingSawInterface, owner: Owner, phase: Phase) -> None:
    """Report what has become of the owner's command."""
    match owner:
        case Owner.GEAR_IN_VELO:
            block.gear_in_velo.report(phase)
        case Owner.GEAR_IN_POS:
            block.gear_in_pos.report(phase)
        case Owner.HALT:
            block.halt.report(phase)
        case Owner.STOP:
            block.stop.report(phase)
        case Owner.MOVE_VELOCITY:
            block.move_velocity.report(phase)
        case Owner.MOVE_ABSOLUTE:
            block.move_absolute.report(phase)
        case _:
            pass


def show_function_blocks(block: FlyingSawInterface) -> None:
    """Derive the outputs of all function blocks at the end of a step; `state` has been derived before."""
    show_gear_in(block.gear_in_velo, block.state)
    show_gear_in(block.gear_in_pos, block.state)
    block.gear_out.show()
    block.halt.show()
    block.halt.done = block.halt.is_reached()
    block.stop.show()
    block.stop.done = block.stop.is_reached()
    block.move_velocity.show()
    block.move_velocity.in_velocity = block.move_velocity.is_reached()
    block.move_absolute.show()
    block.move_absolute.done = block.move_absolute.is_reached()
    block.reset.show()


def show_gear_in(command: GearInVelo, state: State) -> None:
    """Derive the outputs of one of both gear-in commands."""
    command.show()
    command.in_sync = command.is_reached()
    command.start_sync = state in (State.SYNCHRONIZING, State.SYNCHRON) and (command.busy or command.in_sync)
