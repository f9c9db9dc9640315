"""A process as in an environment with nothing but some extras of the project, as a make target sets it up in a fresh
clone:

    python -m tests.support.extras EXTRA[,EXTRA]... MODULE [ARGUMENT]...

runs a module there. What the extras do not install is hidden, though it is installed."""

import re
import runpy
import subprocess
import sys
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from types import ModuleType
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests import ROOT
from tests.install.resolver import required


def dry_run(target: str) -> tuple[list[str], list[str]]:
    """The extras that a make target installs in a fresh clone, and the commands that it runs then, without the folder
    of the environment: `motionsync line`, `python -m tools.site`."""
    command = ["make", "--dry-run", "--always-make", target]
    shown = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return re.findall(r"installing motionsync\[(\w+)\]", shown), re.findall(r"\.venv/bin/((?!python -m pip).*)", shown)


def hide_others(*extras: str) -> None:
    """From now on this process finds no package but those of the extras, of every installation, and of the library."""
    installed = distributions_of(*extras)
    hidden = {
        package
        for package, owners in packages_distributions().items()
        if installed.isdisjoint(map(canonicalize_name, owners))
    }

    class Finder(PathFinder):
        """Finds modules on sys.path, but no hidden ones."""

        @classmethod
        def find_spec(cls, fullname: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
            return None if fullname.partition(".")[0] in hidden else PathFinder.find_spec(fullname, path, target)

    sys.meta_path[sys.meta_path.index(PathFinder)] = Finder


def distributions_of(*extras: str) -> set[str]:
    """The distributions that an installation with these extras has, those that others need included."""
    found = {"motionsync"}
    left = [requirement for extra in ("", *extras) for requirement in required(extra)]
    seen = set()
    while left:
        requirement = left.pop()
        if str(requirement) in seen:
            continue
        seen.add(str(requirement))
        found.add(canonicalize_name(requirement.name))
        try:
            needed = map(Requirement, requires(requirement.name) or [])
        except PackageNotFoundError:  # not for this platform
            continue
        asked = [{"extra": each} for each in ("", *requirement.extras)]
        left += [r for r in needed if not r.marker or any(r.marker.evaluate(given) for given in asked)]
    return found


if __name__ == "__main__":
    given, module, *arguments = sys.argv[1:]
    hide_others(*given.split(","))
    sys.argv[1:] = arguments
    runpy.run_module(module, run_name="__main__", alter_sys=True)
