"""Why a block cannot be initialized or stepped with the values it was given: shared by all blocks."""

from .declare import Choice


class Refusal(Choice):
    """What `initialize` and `step` answer; anything but `NONE` is a failed call that has changed nothing."""

    NONE = 0, "done"
    MASTER_TURNS = (
        1,
        "the master's position and its prediction must be at most 1e15 periods",
        "master.position",
        "master.velocity",
        "master.acceleration",
        "master.period",
    )
