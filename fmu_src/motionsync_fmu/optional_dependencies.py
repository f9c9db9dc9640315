"""Optional dependencies of motionsync, and the commands that install them."""

from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement

from .errors import UserError

FOLDER = Path(__file__).parent
COMPILER = "ziglang"  # builds the native flavour


def missing_for_native() -> str:
    """The name of the package that builds the native flavour, if it is not installed; else empty."""
    return "" if find_spec(COMPILER) else COMPILER


def require(extra: str, *packages: str) -> None:
    """Check that packages of an extra are installed.

    Raises:
        UserError: one is not; the message has the command that installs them.
    """
    if missing := next((name for name in packages if find_spec(name) is None), ""):
        raise UserError(f"this needs {missing}, which is not installed: {how_to_install(extra)}")


def how_to_install(extra: str) -> str:
    """The command that installs an extra, as the end of a sentence.

    In a checkout it installs the extra of the checkout. Elsewhere it names the packages themselves, since a package
    named motionsync in an index may be somebody else's."""
    checkout = FOLDER.parents[1]
    if (checkout / "pyproject.toml").is_file():
        return f"pip install --editable '.[{extra}]' in {checkout}"
    requirements = [Requirement(text) for text in metadata.requires("motionsync") or []]
    needed = [r for r in requirements if r.marker and "extra" in str(r.marker) and r.marker.evaluate({"extra": extra})]
    packages = " ".join(f"'{r.name}{r.specifier}'" for r in needed)
    return f"pip install {packages}" if packages else "there is none for this machine"
