"""Where a result comes from: what a reader needs to reproduce it."""

import platform
import zipfile
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from xml.etree.ElementTree import fromstring

from markupsafe import Markup

from ...about import __version__


def origin_rows(sources: Mapping[str, str], more: Mapping[str, str]) -> dict[str, str]:
    """The table "Where this comes from" of a page, by the names of its rows.

    `sources`: what was run; `more`: rows at the end."""
    program = {"date": current_time(), "motionsync": __version__}
    return {**program, **sources, "platform": describe_platform(), **more}


def shown_path(file: Path) -> str:
    """A file as readers elsewhere may see it: from the current folder on, else with its own folder alone."""
    return str(file.relative_to(Path.cwd()) if file.is_relative_to(Path.cwd()) else Path(file.parent.name) / file.name)


def describe_fmu(fmu: Path) -> Markup:
    """An FMU by its file name, version of FMI, flavour and GUID: a hash of its variables and its source, in FMI 3.0 the
    instantiation token."""
    with zipfile.ZipFile(fmu) as z:
        root = fromstring(z.read("modelDescription.xml"))
        flavour = "python" if "resources/slavemodule.txt" in z.namelist() else "native"
    guid = root.get("guid", root.get("instantiationToken", ""))
    text = Markup("{}, FMI {}, {} flavour, GUID <code>{}</code>")
    return text.format(fmu.name, root.get("fmiVersion", ""), flavour, guid)


def current_time() -> str:
    """The date and time, with the distance to UTC."""
    return datetime.now().astimezone().isoformat(" ", "seconds")


def describe_platform() -> str:
    """The platform of this process."""
    return f"{platform.system()} {platform.release()}, {platform.machine()}, Python {platform.python_version()}"
