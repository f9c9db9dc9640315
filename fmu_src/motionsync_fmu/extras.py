"""What may be installed beside motionsync, and how a user gets it."""

from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement

HERE = Path(__file__).parent
NATIVE = ("ziglang", "zopfli")


def missing_for_native() -> str:
    """The first package that builds the native flavour and is not installed; empty if all are."""
    return next((name for name in NATIVE if find_spec(name) is None), "")


def how_to_install(extra: str) -> str:
    """The command that installs an extra, as the end of a sentence.

    In a checkout this is the checkout's own. Elsewhere it names the packages themselves, since in an index of packages
    one of motionsync's name may be a stranger's."""
    checkout = HERE.parents[1]
    if (checkout / "pyproject.toml").is_file():
        return f"pip install '.[{extra}]' in {checkout}"
    wanted = [Requirement(text) for text in metadata.requires("motionsync") or []]
    named = [r for r in wanted if r.marker and "extra" in str(r.marker) and r.marker.evaluate({"extra": extra})]
    packages = " ".join(f"'{r.name}{r.specifier}'" for r in named)
    return f"pip install {packages}" if packages else "there is none for this machine"
