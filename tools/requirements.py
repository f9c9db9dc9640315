"""What an installation of the project needs, as pyproject.toml and the installed packages say."""

import tomllib
from importlib.metadata import requires
from itertools import chain
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROJECT = Path(__file__).parents[1] / "pyproject.toml"


def required(extra: str) -> list[Requirement]:
    """The requirements of an extra, or without an extra those of every installation, as pyproject.toml names them."""
    project = tomllib.loads(PROJECT.read_text("utf-8"))["project"]
    result = map(Requirement, project["optional-dependencies"][extra] if extra else project["dependencies"])
    parts = (chain.from_iterable(map(required, r.extras)) if r.name == "motionsync" else [r] for r in result)
    return list(chain.from_iterable(parts))


def distributions_of(*extras: str) -> set[str]:
    """The canonical names of the distributions that an installation with these extras has, those that others need
    included, as far as they are installed here."""
    names: set[str] = set()
    seen = set()
    left = [requirement for extra in ("", *extras) for requirement in required(extra)]
    while left:
        requirement = left.pop()
        try:
            needed = map(Requirement, requires(requirement.name) or [])
        except ModuleNotFoundError:  # not for this platform, or of an extra that is not installed
            continue
        names.add(canonicalize_name(requirement.name))
        if str(requirement) not in seen:
            asked = [{"extra": each} for each in ("", *requirement.extras)]
            left += [r for r in needed if not r.marker or any(r.marker.evaluate(given) for given in asked)]
        seen.add(str(requirement))
    return names
