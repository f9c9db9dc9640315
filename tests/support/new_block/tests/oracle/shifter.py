"""The Shifter a second time, from its description alone."""


def slave_position(master: float, offset: float, period: float) -> float:
    """Where the slave is with its master there."""
    return (master + offset) % period if period else master + offset
