"""The FMUs of FMI 3.0."""

from pathlib import Path

import pytest

from tests.support.hosts.fmus import Fmus


@pytest.fixture(scope="session")
def block_fmi3(fmus: Fmus, block: str) -> Path:
    """The FMU of each block in turn, for this machine."""
    return fmus.fmi3(block)


@pytest.fixture(scope="session")
def fmi3(fmus: Fmus) -> Path:
    """The Synchronizer's FMU, for this machine: for tests that serve for all blocks but need names of variables."""
    return fmus.fmi3("Synchronizer")
