"""`motionsync run`: the FMUs that it builds and chooses."""

import json
import re
import zipfile
from pathlib import Path

from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import host_platform
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import PYTHON, description, scenario, the_fmu


def test_a_missing_fmu_is_built_for_this_machine_and_reported(motionsync: Command, cache: Path) -> None:
    scenario("stop")
    first = motionsync("run", "stop", "--no-report", "--json")
    assert first.status == 0
    message = re.fullmatch(r"building (\S+), for this machine alone \.\.+\n", first.err)
    assert message
    assert json.loads(first.out)[0]["passed"]
    fmu = Path(message[1])
    assert fmu.is_relative_to(cache)
    assert fmu.is_file()
    assert not Path("build/native").exists()
    with zipfile.ZipFile(fmu) as z:
        libraries = [name for name in z.namelist() if name.startswith("binaries/")]
    row = host_platform()
    assert row
    assert libraries == [row.library("Synchronizer")]
    assert description(fmu).get("guid") == compute_guid(Recipe("Synchronizer"))
    second = motionsync("run", "stop", "--no-report")
    assert (second.status, second.err) == (0, "")


def test_a_stale_fmu_is_left_alone_and_another_one_is_run(workshop: Command, built: Path, cache: Path) -> None:
    fmu = Path("build/python/Synchronizer.fmu")
    fresh = fmu.read_bytes()
    assert workshop("build", "Synchronizer", *PYTHON, "--start", "rest_value=5", "--output", "other").status == 0
    for other in (the_fmu("other").read_bytes(), b"no FMU", fresh[:3000], b""):
        fmu.write_bytes(other)
        outcome = workshop("run", "stop", "--no-report", *PYTHON)
        assert outcome.status == 0
        assert fmu.read_bytes() == other
        (run,) = cache.rglob("*.fmu")
        assert run.read_bytes() == fresh


def test_a_damaged_fmu_in_the_cache_is_built_anew(motionsync: Command, cache: Path) -> None:
    scenario("stop")
    assert motionsync("run", "stop", "--no-report", *PYTHON).status == 0
    (fmu,) = cache.rglob("*.fmu")
    fresh = fmu.read_bytes()
    for other in (b"no FMU", fresh[:3000], b""):
        fmu.write_bytes(other)
        outcome = motionsync("run", "stop", "--no-report", *PYTHON)
        assert outcome.status == 0
        assert outcome.err.startswith(f"building {fmu} ..")
        assert fmu.read_bytes() == fresh


def test_a_folder_in_the_fmus_place_is_one_line(motionsync: Command) -> None:
    scenario("stop")
    Path("build/native/Synchronizer.fmu").mkdir(parents=True)
    assert_one_line(motionsync("run", "stop"), str(Path("build/native/Synchronizer.fmu")))
