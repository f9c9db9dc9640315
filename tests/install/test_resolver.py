"""motionsync installs from wheels alone on every platform and with every Python that it is for."""

from pathlib import Path

import pytest

from tests.install.resolver import EXTRAS, PLATFORMS, PYTHONS, left_out, versions
from tools.requirements import required

pytestmark = pytest.mark.slow

WITHOUT_WHEELS = {  # found by asking for them
    "Linux x86-64": set(),
    "Linux arm64": {"libcosimpy", "ruckig"},
    "Windows x86-64": set(),
    "macOS x86-64": {"libcosimpy", "ruckig"},
    "macOS arm64": {"libcosimpy"},
}


@pytest.mark.parametrize("python", PYTHONS)
@pytest.mark.parametrize("platform", PLATFORMS)
def test_all_extras_resolve(platform: str, python: str) -> None:
    """[test] holds the other extras: what can be installed together can be installed in parts."""
    result = versions(platform, python, "test")
    requested = {r.name.lower() for extra in EXTRAS for r in required(extra)}
    assert requested - set(result) == WITHOUT_WHEELS[platform]


@pytest.mark.parametrize("platform", PLATFORMS)
def test_only_what_has_no_wheel_is_left_out(platform: str) -> None:
    assert {name for extra in EXTRAS for name in left_out(platform, extra)} == WITHOUT_WHEELS[platform]


def test_what_has_no_wheel_is_refused(tmp_path: Path) -> None:
    """The resolver sees the target's wheels: libcosimpy has some for Linux on x86-64, and none for macOS."""
    asked = tmp_path / "requirements.txt"
    asked.write_text("libcosimpy")
    assert "libcosimpy" in versions("Linux x86-64", "3.13", source=asked)
    with pytest.raises(RuntimeError, match="libcosimpy"):
        versions("macOS arm64", "3.13", source=asked)
