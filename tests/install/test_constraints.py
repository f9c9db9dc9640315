"""The constraints with which CI installs name a version of every package that tests need, and no place."""

import re

from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests import ROOT
from tests.install.constraints import FILE
from tools.requirements import distributions_of, required

LINES = [line for line in FILE.read_text("utf-8").splitlines() if not line.startswith("#")]
PINS = [Requirement(line) for line in LINES]


def test_each_line_is_a_name_and_a_version() -> None:
    for line in LINES:
        assert re.fullmatch(r"[a-z0-9.-]+==[\w.]+( ; .+)?", line), line


def test_all_that_is_installed_for_tests_is_pinned_within_the_requirements() -> None:
    """Here, that is: the markers decide for each platform and Python."""
    pinned = {canonicalize_name(r.name): r for r in PINS if not r.marker or Marker(str(r.marker)).evaluate()}
    assert distributions_of("test") <= pinned.keys()
    for requirement in [*required(""), *required("test")]:
        if not requirement.marker or requirement.marker.evaluate():
            (pin,) = pinned[canonicalize_name(requirement.name)].specifier
            assert requirement.specifier.contains(pin.version), f"{requirement}, but {pin}"


def test_ci_installs_with_them() -> None:
    assert "PIP_CONSTRAINT" in (ROOT / ".ci" / "run").read_text("utf-8")
