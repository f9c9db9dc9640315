"""Few scenarios that together have all that many have."""

from collections.abc import Iterator, Mapping
from typing import Any


def kinds_of(part: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """What there is in a part of a scenario: each key with each type, each text, and whether a number is 0. Variables
    of one type are one kind."""
    if isinstance(part, dict):
        for key, value in part.items():
            yield from kinds_of(value, path if "." in key else f"{path}.{key}")
    elif isinstance(part, list):
        for value in part:
            yield from kinds_of(value, path)
    elif not path.endswith((".when", ".name")):
        yield path, part if isinstance(part, str) else (type(part), bool(part))


def few_with_all(features: Mapping[str, set[Any]]) -> list[str]:
    """Names of few that together have all features: each time the one that has most of those still missing."""
    missing, result = set().union(*features.values()), list[str]()
    while missing:
        result.append(max(features, key=lambda name: len(features[name] & missing)))
        missing -= features[result[-1]]
    return result
