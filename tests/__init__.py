"""What proves the project. The modules of tests import one another by their full names."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
