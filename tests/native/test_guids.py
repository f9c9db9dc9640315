"""A block's GUID depends on its own sources and on the tool, not on other blocks."""

import shutil
from pathlib import Path

from tests import ROOT
from tests.fmu.test_packages import python

REGISTRATION = """
from .nested.block import Nested

BLOCKS = {**BLOCKS, "Nested": Nested}
"""
GUIDS = """
from motionsync.blocks import BLOCKS
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe

for name in BLOCKS:
    print(name, compute_guid(Recipe(name)))
"""


def guids(root: Path) -> dict[str, str]:
    """The GUIDs of all blocks that are registered in a copy of the sources."""
    return dict(line.split() for line in python(root, GUIDS))


def test_a_new_block_with_refusals_and_faults_changes_no_other_guid(tmp_path: Path) -> None:
    junk = shutil.ignore_patterns("__pycache__")
    for folder in ("model", "fmu_src"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=junk)
    before = guids(tmp_path)
    model = tmp_path / "model" / "motionsync"
    assert len(before) == len(list(model.glob("*/block.py")))
    shutil.copytree(ROOT / "tests" / "support" / "fake_blocks" / "nested", model / "nested", ignore=junk)
    with (model / "blocks.py").open("a") as registry:
        registry.write(REGISTRATION)
    after = guids(tmp_path)
    assert after == before | {"Nested": after["Nested"]}
    assert len({*after.values()}) == len(after)
    faults = model / "nested" / "faults.py"
    faults.write_text(faults.read_text().replace('"done"', '"done", "angle"'))
    last = guids(tmp_path)
    assert last == before | {"Nested": last["Nested"]}
    assert last["Nested"] != after["Nested"]
