"""Blocks on measured lines: 100 seeds at once in the compiled loop."""
