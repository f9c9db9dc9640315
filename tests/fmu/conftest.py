"""Fixtures of the tests of FMUs."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.hosts.importers import Logged


@pytest.fixture
def host(native: Path) -> Iterator[Logged]:
    """The Synchronizer's native FMU, with its messages and their categories."""
    with Logged(native) as host:
        host.lines = []
        yield host
