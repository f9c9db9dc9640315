"""A process as in an environment with nothing but some extras of the project, as a make target sets it up in a fresh
clone:

    python -m tests.support.project.extras EXTRA[,EXTRA]... MODULE [ARGUMENT]...

runs a module there. What the extras do not install is hidden, though it is installed."""

import re
import runpy
import subprocess
import sys
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import packages_distributions
from types import ModuleType
from typing import Any

from packaging.utils import canonicalize_name

from tests import ROOT
from tools.requirements import distributions_of


def dry_run(target: str) -> tuple[list[str], list[str]]:
    """The extras that a make target installs in a fresh clone, and the commands that it runs then, without the folder
    of the environment: `motionsync line`, `python -m tools.site`."""
    command = ["make", "--dry-run", "--always-make", target]
    shown = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return re.findall(r"installing motionsync\[(\w+)\]", shown), re.findall(r"\.venv/bin/((?!python -m pip).*)", shown)


def hide_others(*extras: str) -> None:
    """From now on this process finds no package but those of the extras, of every installation, and of the library."""
    installed = distributions_of(*extras) | {"motionsync"}
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


if __name__ == "__main__":
    given, module, *arguments = sys.argv[1:]
    hide_others(*given.split(","))
    sys.argv[1:] = arguments
    runpy.run_module(module, run_name="__main__", alter_sys=True)
