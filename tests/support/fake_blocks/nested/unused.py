"""No module imports this one: it is not part of the block."""
