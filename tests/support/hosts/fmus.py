"""Builds what takes long to build once in a test run, in the process that asks first."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from filelock import FileLock

from motionsync_fmu.fmus.fmu import BuildOptions, Flavour, build, fmu_path
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native.platforms import host_platform


class Shared:
    """Folders that all processes of a test run share; once filled, a folder does not change."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def once(self, name: str, fill: Callable[[Path], object]) -> Path:
        """The folder of that name, filled by the first process that asks for it.

        Other processes wait for it. If this process fails or dies, the next one deletes what is there and starts anew.
        """
        done, part = self.folder / name, self.folder / f"{name}.part"
        done.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(self.folder / f"{name}.lock"):  # released by the operating system when its process ends
            if not done.exists():
                shutil.rmtree(part, ignore_errors=True)
                part.mkdir()
                fill(part)
                part.rename(done)
        return done


def build_for_host(flavour: Flavour, recipe: Recipe, target: Path) -> Path:
    """Build an FMU that need not run anywhere else: the native one for this machine alone, if it is a platform."""
    platform = host_platform(recipe.fmi) if flavour == Flavour.NATIVE else None
    return build(recipe, target, BuildOptions(flavour, platforms=[platform] if platform else ()))


class Fmus:
    """The FMUs of all blocks, positions in mm; each is built when a test first asks for it."""

    def __init__(self, shared: Shared) -> None:
        self.shared = shared

    def python(self, name: str) -> Path:
        return self.built(Flavour.PYTHON, name)

    def native(self, name: str) -> Path:
        return self.built(Flavour.NATIVE, name)

    def fmi3(self, name: str) -> Path:
        """The FMU of FMI 3.0, for this machine alone."""
        if (platform := host_platform(Fmi.THREE)) is None:
            pytest.skip("no native FMU is for this machine")

        def fill(folder: Path) -> None:
            build(Recipe(name, fmi=Fmi.THREE), folder / f"{name}.fmu", BuildOptions(platforms=[platform]))

        return self.shared.once(f"fmi3-here/{name}", fill) / f"{name}.fmu"

    def fmi3_everywhere(self, name: str) -> Path:
        """The FMU of FMI 3.0, for all platforms."""

        def fill(folder: Path) -> None:
            build(Recipe(name, fmi=Fmi.THREE), folder / f"{name}.fmu")

        return self.shared.once(f"fmi3/{name}", fill) / f"{name}.fmu"

    def built(self, flavour: Flavour, name: str) -> Path:
        def fill(folder: Path) -> None:
            build(Recipe(name), folder / f"{name}.fmu", BuildOptions(flavour))

        return self.shared.once(f"{flavour.value}/{name}", fill) / f"{name}.fmu"

    def copied(self, flavour: Flavour, name: str, output: Path) -> None:
        """Put the FMU where the command line would build it with --output, in a folder that a test may change."""
        target = fmu_path(Recipe(name), output, flavour)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.built(flavour, name), target)
