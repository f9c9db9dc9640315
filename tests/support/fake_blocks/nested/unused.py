"""Nobody imports this: it is not part of the block."""
