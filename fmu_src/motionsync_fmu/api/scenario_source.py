"""What a function takes for a scenario, and for the values in it."""

from collections.abc import Mapping
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from ..errors import UserError
from ..scenario.files.reader import MOST_STEPS, read_scenario_text
from ..scenario.files.shipped import SCENARIO_FILE, find_scenario
from ..scenario.files.toml_tables import read_file, writable
from ..scenario.scenario import Scenario
from ..scenario.variation.overrides import with_overrides

Source = str | Path | Mapping[str, Any] | Scenario
"""A scenario's file or folder, its short name, the contents of its file as a mapping, or itself."""

Value = float | bool | str


def load(scenario: Source, *, set: Mapping[str, Value] | None = None, step_size: float | None = None) -> Scenario:
    """A scenario with other values, and at another step size, than it has; the arguments are those of `run`.

    Raises:
        UserError: there is no such scenario, or something is not allowed.
    """
    if isinstance(scenario, Scenario):
        if set:
            raise UserError("set: a loaded scenario is changed by dataclasses.replace; name its file instead")
        loaded = scenario
    else:
        text, file = _text_of(scenario)
        if set:
            loaded = with_overrides(text, file, {name: literal(value) for name, value in set.items()})
        else:
            loaded = read_scenario_text(text, file)
    return loaded if step_size is None else with_step_size(loaded, step_size)


def with_step_size(scenario: Scenario, step_size: float) -> Scenario:
    """The scenario at another step size, in s.

    Raises:
        UserError: it is not possible at this one; the message starts with `--step-size`.
    """
    text = f"--step-size {step_size:g}"
    if not 0.0 < step_size <= scenario.stop_time:
        raise UserError(f"{text} is not allowed: it must be > 0 and at most the stop time")
    if scenario.stop_time / step_size > MOST_STEPS:
        raise UserError(f"{text} makes more than {MOST_STEPS:,} steps up to {scenario.stop_time:g} s")
    if reason := scenario.step_refusal(step_size):
        raise UserError(f"{text}: {reason}")
    return replace(scenario, step_size=step_size)


def _text_of(source: str | Path | Mapping[str, Any]) -> tuple[str, Path]:
    """The text of a scenario's file, and the file; that of a mapping is named after its title, and does not exist."""
    if isinstance(source, Mapping):
        top = _plain(source)
        return tomli_w.dumps(top), Path(str(top.get("title", "scenario")).replace("/", "-"), SCENARIO_FILE)
    file = find_scenario(Path(source))
    return read_file(file), file


def _plain(value: Any) -> Any:
    """A value in the types that TOML has."""
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, str | bool | int | float):
        return writable(value)
    raise UserError(f"{value!r} is not allowed in a scenario: it must be a number, a text, true or false")


def literal(value: Value) -> str:
    """A value as a scenario's file has it; a number has all its digits."""
    return str(value).lower() if isinstance(value, bool) else str(writable(value))
