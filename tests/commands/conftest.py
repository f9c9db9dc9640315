"""Fixtures for the tests of commands: folders with a built FMU, and an empty cache."""

import shutil
from pathlib import Path

import pytest

from motionsync_fmu import paths
from motionsync_fmu.fmus.fmu import Flavour
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.project.command_line import Command
from tests.support.project.workshop import scenario


@pytest.fixture
def cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache in place of the user's."""
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setattr(paths, "cache_folder", lambda: folder)
    return folder


@pytest.fixture(scope="module")
def built(shared: Shared, fmus: Fmus) -> Path:
    """A folder `build` in which the FMU for STOP is up to date, in both flavours."""

    def fill(folder: Path) -> None:
        for flavour in Flavour:
            fmus.copied(flavour, "Synchronizer", folder / "build")

    return shared.once("cli", fill) / "build"


@pytest.fixture
def workshop(motionsync: Command, built: Path) -> Command:
    """`motionsync` in a folder with an up-to-date FMU and the scenario `stop`."""
    shutil.copytree(built, "build")
    scenario("stop")
    return motionsync
