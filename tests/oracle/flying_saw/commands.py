"""The flying saw's function blocks as PLCopen shows them: what each puts out, and when a result is taken back.

Readings of the specification that it leaves open:
- Falling edges come before rising ones of the same time; a command that they leave running and that is aborted then
  shows command_aborted for one step.
- A block belongs to its latest edge: if the same block is started again while its command runs and that is refused, it
  shows the error, and what becomes of the older command, which goes on, is not shown any more.
- A command in_sync or in_velocity whose execute has fallen shows nothing, but still shows its abortion for one step;
  parked by the backstop it is busy again, and in_sync is not shown for a step in which it is parked.
- start_sync holds in SYNCHRONIZING and SYNCHRON for as long as the block is busy or shows in_sync.
- `reset` is accepted while the axis is locked; it clears the error and does not release the lock.
"""

from dataclasses import dataclass, field

from tests.oracle.numerics.mp import Number

GROUPS = ("reset", "stop", "halt", "gear_out", "gear_in_velo", "gear_in_pos", "move_velocity", "move_absolute")
"""In the order in which simultaneous edges act."""

RESULT = {"gear_in_velo": "in_sync", "gear_in_pos": "in_sync", "move_velocity": "in_velocity"}
"""The output that reports success, where it is not `done`."""

HAS_BUSY = frozenset(GROUPS) - {"reset"}
ABORTABLE = frozenset(GROUPS) - {"reset", "gear_out"}
"""These have active and command_aborted as well."""

GEAR_IN = frozenset({"gear_in_velo", "gear_in_pos"})

IDLE, BUSY, DONE, ABORTED, ERROR = range(5)


@dataclass(frozen=True, slots=True)
class Pulse:
    """A result that arose at `time` (s) after execute fell: shown in one step; `given`: by a set of that time."""

    time: Number
    given: bool
    group: str
    shows: int
    error_id: int = 0


@dataclass(slots=True)
class Command:
    """One function block: what it shows, and since when its execute is true."""

    group: str
    execute: bool = False
    shows: int = IDLE
    error_id: int = 0
    pulses: list[Pulse] = field(default_factory=list)

    def fall(self) -> None:
        self.execute = False
        if self.shows != BUSY:
            self.shows = IDLE

    def start(self) -> None:
        self.shows = BUSY

    def finish(self, shows: int, time: Number, given: bool, error_id: int = 0) -> None:
        """A result: kept while execute is true, else for one step."""
        if self.execute:
            self.shows, self.error_id = shows, error_id
        else:
            self.shows = IDLE
            self.pulses.append(Pulse(time, given, self.group, shows, error_id))

    def outputs(self, synchronizing: bool) -> dict[str, float]:
        return shown(self.group, self.shows, self.error_id, synchronizing)


def shown(group: str, shows: int, error_id: int, synchronizing: bool) -> dict[str, float]:
    """The outputs of a group; `synchronizing`: the axis is in SYNCHRONIZING or SYNCHRON."""
    result: dict[str, float] = {RESULT.get(group, "done"): shows == DONE}
    if group in HAS_BUSY:
        result["busy"] = shows == BUSY
    if group in ABORTABLE:
        result |= {"active": shows == BUSY, "command_aborted": shows == ABORTED}
    if group in GEAR_IN:
        result["start_sync"] = synchronizing and shows in (BUSY, DONE)
    result |= {"error": shows == ERROR, "error_id": error_id if shows == ERROR else 0}
    return {f"{group}.{name}": float(output) for name, output in result.items()}
