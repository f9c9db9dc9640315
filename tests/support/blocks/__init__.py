"""Runs of blocks in this process, random and by hand, and their comparison with oracles."""
