"""Small blocks that are made for tests alone: each has what a test of the tool needs, and nothing else."""
