"""A block that is a package is built as one that is a module: its files, its FMUs, what its parts are called."""

import os
import shutil
import subprocess
import sys
import zipfile
from math import pi
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
from tests import ROOT
from tests.support.hosts.fmus import Shared
from tests.support.hosts.validation import faults_by_fmpy

UNITS = ("mm", "m", "deg", "rad", "1")
REGISTRATION = """
from .nested.block import Nested

BLOCKS = {"Nested": Nested}
"""
BUILDS = """
from pathlib import Path
from motionsync_fmu.fmus.fmu import BuildOptions, Flavour, build
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import host_platform
for flavour, unit in {builds}:
    print(compute_guid(Recipe("Nested", unit)))
    host = host_platform()
    options = BuildOptions(Flavour(flavour), platforms=[host] if host else [])
    build(Recipe("Nested", unit), Path(unit, flavour, "Nested.fmu"), options)
"""


def python(root: Path, code: str) -> list[str]:
    """The lines that a process prints which has the model and fmu_src of `root`."""
    path = os.pathsep.join(str(root / part) for part in ("model", "fmu_src"))
    command = [sys.executable, "-c", code]
    done = subprocess.run(
        command, cwd=root, check=False, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": path}
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.fixture(scope="module")
def root(shared: Shared) -> Path:
    """A copy of the sources whose only block is `Nested`, and its FMUs: <unit>/<flavour>/Nested.fmu."""
    return shared.once("nested", workshop)


def workshop(root: Path) -> None:
    junk = shutil.ignore_patterns("__pycache__")
    for folder in ("model", "fmu_src"):
        shutil.copytree(ROOT / folder, root / folder, ignore=junk)
    nested = ROOT / "tests" / "support" / "fake_blocks" / "nested"
    shutil.copytree(nested, root / "model" / "motionsync" / "nested", ignore=junk)
    with (root / "model" / "motionsync" / "blocks.py").open("a") as registry:
        registry.write(REGISTRATION)
    python(root, BUILDS.format(builds=[("native", "mm"), *(("python", unit) for unit in UNITS)]))


def description(fmu: Path) -> Any:
    with zipfile.ZipFile(fmu) as z:
        return fromstring(z.read("modelDescription.xml"))


@pytest.mark.all_blocks
def test_a_block_has_the_name_of_its_class() -> None:
    assert {name: kind.__name__ for name, kind in BLOCKS.items()} == {name: name for name in BLOCKS}


def test_a_block_s_class_names_its_fmu(root: Path) -> None:
    assert description(root / "mm" / "native" / "Nested.fmu").get("modelName") == "Nested"


def test_the_fmu_holds_what_the_block_imports_and_nothing_else(root: Path) -> None:
    with zipfile.ZipFile(root / "mm" / "python" / "Nested.fmu") as z:
        paths = [name.split("/", 2) for name in z.namelist() if name.startswith("resources/motionsync_")]
    own = {path for _, folder, path in paths if not folder.startswith("motionsync_fmu")}
    modules = (
        *("__init__", "clock", "encoder_filter", "input_watch", "master", "master_path", "slave", "var"),
        *(f"numerics/{name}" for name in ("__init__", "bracket", "computable_range", "cosine", "grid")),
    )
    assert own == {
        *(f"{name}.py" for name in modules),
        *(f"nested/{name}.py" for name in ("__init__", "block", "faults", "law")),
    }


def test_both_flavours_have_one_guid_and_give_the_same_bits(root: Path) -> None:
    fmus = [root / "mm" / flavour / "Nested.fmu" for flavour in ("native", "python")]
    assert len({description(fmu).get("guid") for fmu in fmus}) == 1
    rows, logs = [], []
    for fmu in fmus:
        assert faults_by_fmpy(fmu) == []
        with FmuInstance(fmu) as host:
            host.initialize({"angle": 60.0, "master.velocity": 10.0, "master.acceleration": 1.0})
            row = []
            for i in range(20):
                values = {"master.position": 1.0 * i, "keep.execute": i in (5, 10), "keep.limit": i - 7.0}
                host.step(0.1, values)
                row.append({n: float(v).hex() for n, v in host.get().items()})
            assert host.get(["slave.position"]) == {"slave.position": 3.0}
            rows.append(row)
            logs.append(host.messages)
    assert rows[0] == rows[1]
    assert logs[0] == logs[1] == ["keep: refused: the limit must be > 0 (keep.limit = -2, angle = 60)"]


@pytest.mark.parametrize("file", ["law.py", "faults.py", "__init__.py"])
def test_the_guid_follows_every_module_of_the_package(root: Path, tmp_path: Path, file: str) -> None:
    shutil.copytree(root / "model", tmp_path / "model")
    shutil.copytree(root / "fmu_src", tmp_path / "fmu_src")
    code = BUILDS.format(builds=[]) + "print(compute_guid(Recipe('Nested')))"
    nested = tmp_path / "model" / "motionsync" / "nested"
    built = [description(root / "mm" / "native" / "Nested.fmu").get("guid")]
    (nested / "unused.py").write_text("NOBODY = 1.0\n")
    assert python(tmp_path, code) == built
    (nested / file).write_text((nested / file).read_text() + "\n")
    assert python(tmp_path, code) != built


def test_a_violation_of_the_kernel_subset_is_reported_with_its_path(root: Path, tmp_path: Path) -> None:
    shutil.copytree(root / "model", tmp_path / "model")
    shutil.copytree(root / "fmu_src", tmp_path / "fmu_src")
    law = tmp_path / "model" / "motionsync" / "nested" / "law.py"
    text = law.read_text().replace("1.0 / cosine(degrees)", "cosine(degrees) ** -1.0")
    law.write_text(text)
    line = text[: text.index("**")].count("\n") + 1
    check = "from motionsync_fmu.fmus.fmu import check_kernel\n"
    check += "try:\n    check_kernel('motionsync.nested.block')\nexcept Exception as e:\n    print(e)"
    assert [messages.partition(": ")[0] for messages in python(tmp_path, check)] == [f"motionsync/nested/law.py:{line}"]


# --- what such a block needs of units and limits ---


@pytest.mark.parametrize("unit", UNITS)
def test_angles_are_degrees_whatever_positions_are_in(root: Path, unit: str) -> None:
    fmu = root / unit / "python" / "Nested.fmu"
    assert faults_by_fmpy(fmu) == []
    xml = description(fmu)
    names = [u.get("name") for u in xml.iterfind("UnitDefinitions/Unit")]
    assert len(names) == len(set(names))
    units = {u.get("name"): u.find("BaseUnit").attrib for u in xml.iterfind("UnitDefinitions/Unit")}
    types = {t.get("name"): t.find("Real") for t in xml.iterfind("TypeDefinitions/SimpleType")}
    assert units["deg"].keys() == {"rad", "factor"}
    assert (units["deg"]["rad"], float(units["deg"]["factor"])) == ("1", pi / 180.0)
    assert types["Angle"].get("unit") == "deg"
    assert types["Time"].get("unit") == "s"
    assert units["s"] == {"s": "1"}
    power = types["AccelerationPower"]
    assert (power.get("unit"), power.get("quantity")) == ("1/s3" if unit == "1" else f"{unit}2/s3", "AccelerationPower")
    si = {"mm": {"m": "2", "factor": "1e-06"}, "m": {"m": "2"}, "rad": {"rad": "2"}, "1": {}}
    si["deg"] = {"rad": "2", "factor": repr((pi / 180.0) ** 2)}
    assert units[power.get("unit")] == {**si[unit], "s": "-3"}


@pytest.mark.parametrize("flavour", ["native", "python"])
@pytest.mark.parametrize("angle", [90.0, -90.0, 120.0])
def test_a_limit_may_itself_be_refused(root: Path, flavour: str, angle: float) -> None:
    with FmuInstance(root / "mm" / flavour / "Nested.fmu") as host:
        message = f"angle = {angle:g} is not allowed: it must be > -90 and < 90"
        with pytest.raises(FmuError, match=message):
            host.initialize({"angle": angle})
