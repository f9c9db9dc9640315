"""What the libraries of FMI 3.0 export: all functions of the standard's header, and nothing else."""

import re
import struct
from pathlib import Path

import fmpy
import pytest

from motionsync_fmu.interface.recipe import Fmi
from motionsync_fmu.native.libraries import HEADERS
from motionsync_fmu.native.platforms import OF_VERSION, Platform
from tests.native.test_libraries import MACHO_OWN, exported, tool
from tests.support.hosts.fmus import Fmus

FUNCTIONS = set(re.findall(r"FMI3_Export \w+\s+(fmi3\w+);", (HEADERS / "fmi3Functions.h").read_text()))


@pytest.fixture(scope="module")
def folder(fmus: Fmus, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The extracted FMU of the Synchronizer: the functions are the same for all blocks."""
    fmu = fmus.fmi3_everywhere("Synchronizer")
    return Path(fmpy.extract(str(fmu), unzipdir=str(tmp_path_factory.mktemp("fmi3"))))


@pytest.mark.parametrize("platform", OF_VERSION[Fmi.THREE], ids=lambda platform: platform.folder)
def test_a_library_exports_the_functions_of_the_standard(platform: Platform, folder: Path) -> None:
    library = folder / platform.library("Synchronizer")
    if platform.suffix == "so":
        lines = tool("readelf", "-W", "--dyn-syms", library).splitlines()
        symbols = [line.split()[4:] for line in lines if "GLOBAL" in line]
        result = {name for _, _, section, name, *_ in symbols if section != "UND"}
    elif platform.suffix == "dll":
        text = tool("objdump", "-p", library)
        result = set(
            re.findall(r"\d\] (\w+)$", text[text.index("[Ordinal/Name Pointer] Table") :].split("\n\n")[0], re.M)
        )
    else:
        processor = {"x86_64": 0x01000007, "aarch64": 0x0100000C}[platform.folder.split("-")[0]]
        assert struct.unpack_from("<2I", library.read_bytes()) == (0xFEEDFACF, processor)  # no universal one
        result = exported(library.read_bytes()) - MACHO_OWN
    assert result == FUNCTIONS
    assert len(result) == 75
