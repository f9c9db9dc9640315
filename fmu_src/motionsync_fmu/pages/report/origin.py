"""Where a result comes from: what a reader needs to get it again."""

import platform
import zipfile
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from xml.etree.ElementTree import fromstring


@dataclass(frozen=True)
class Origin:
    """A run, or one FMU in it.

    Attributes:
        fmu: the file name of the FMU.
        flavour: "native" or "python".
        fmi: the version of FMI: "2.0" or "3.0".
        guid: the FMU's GUID, a hash of its variables and its source; in FMI 3.0 it is the instantiation token.
    """

    fmu: str
    flavour: str
    fmi: str
    guid: str


def origin(fmu: Path) -> Origin:
    """What an FMU says of itself."""
    with zipfile.ZipFile(fmu) as z:
        root = fromstring(z.read("modelDescription.xml"))
        flavour = "python" if "resources/slavemodule.txt" in z.namelist() else "native"
    guid = root.get("guid", root.get("instantiationToken", ""))
    return Origin(fmu.name, flavour, root.get("fmiVersion", ""), guid)


def now() -> str:
    """The date and time, with the distance to UTC."""
    return datetime.now().astimezone().isoformat(" ", "seconds")


def here() -> str:
    """The platform of this process."""
    return f"{platform.system()} {platform.release()}, {platform.machine()}, Python {platform.python_version()}"
