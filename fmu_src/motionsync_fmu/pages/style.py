"""What all pages share: templates, the colours of pictures, and how units are typeset."""

import re
from functools import cache
from pathlib import Path

import jinja2

TEMPLATES = Path(__file__).parent / "templates"  # of all pages
MASTER, SLAVE = "#7a8793", "#c8451b"
POWER = re.compile(r"(?<=[a-z])([2-9])(?![0-9a-zA-Z])")  # of a unit
RAISED = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")


def typeset(text: str) -> str:
    """A unit, or a value with its unit, as it is printed: mm/s² for mm/s2."""
    return POWER.sub(lambda digit: digit[1].translate(RAISED), text)


def with_unit(name: str, unit: str) -> str:
    """A name with its unit, as it is printed: velocity in mm/s²; without a unit the name alone."""
    return f"{name} in {typeset(unit)}" if unit else name


def load_template(folder: Path, name: str) -> jinja2.Template:
    """A template in a folder; what it extends or includes is there, too, or among the templates of all pages."""
    return _environment(folder).get_template(name)


@cache
def _environment(folder: Path) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([folder, TEMPLATES]),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["typeset"] = typeset
    return environment
