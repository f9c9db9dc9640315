"""What all pages have in common: their templates, the colours of pictures, and how units are typeset."""

import re

import jinja2

MASTER, SLAVE = "#7a8793", "#c8451b"
POWER = re.compile(r"(?<=[a-z])([2-9])(?![0-9a-zA-Z])")  # of a unit
RAISED = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")


def typeset(text: str) -> str:
    """A unit, or a value with its unit, as it is printed: mm/s² for mm/s2."""
    return POWER.sub(lambda found: found[1].translate(RAISED), text)


TEMPLATES = jinja2.Environment(
    loader=jinja2.PackageLoader("motionsync_fmu.pages"),
    undefined=jinja2.StrictUndefined,
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
)
TEMPLATES.filters["typeset"] = typeset
