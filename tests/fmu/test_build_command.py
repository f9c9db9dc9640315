"""The order in which `motionsync build` begins and finishes several FMUs."""

from pathlib import Path

import pytest

from motionsync_fmu.build import Finish, Flavour
from motionsync_fmu.commands import build as command
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from tests.support.command_line import Command

NATIVE = ("--flavour", "native", "--folder", "made")


@pytest.fixture
def events(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What happens, in order; the Gearing is refused. Nothing is compiled."""
    told: list[str] = []

    def begun(flavour: Flavour, recipe: Recipe, **_: bool) -> Finish:
        told.append(f"begin {recipe.name}")
        if recipe.name == "Gearing":
            raise UserError("outside the kernel subset")

        def finish(target: Path, progress: object) -> Path:
            told.append(f"finish {recipe.name}")
            target.write_bytes(b"")
            return target

        return finish

    monkeypatch.setattr(command, "begun", begun)
    return told


def test_zig_has_the_next_fmu_while_one_is_finished(motionsync: Command, events: list[str]) -> None:
    done = motionsync("build", "Synchronizer", "FlyingSaw", "Follower", *NATIVE)
    assert done.status == 0, done.err
    order = (
        "begin Synchronizer, begin FlyingSaw, finish Synchronizer, begin Follower, finish FlyingSaw, finish Follower"
    )
    assert events == order.split(", ")
    assert [Path(line.split()[0]).stem for line in done.out.splitlines()] == ["Synchronizer", "FlyingSaw", "Follower"]


def test_a_refused_block_does_not_stop_the_one_before(motionsync: Command, events: list[str]) -> None:
    done = motionsync("build", "Synchronizer", "Gearing", "Follower", *NATIVE)
    assert done.status == 2
    assert "outside the kernel subset" in done.err
    assert events == ["begin Synchronizer", "begin Gearing", "finish Synchronizer", "begin Gearing"]
    assert [Path(line.split()[0]).stem for line in done.out.splitlines()] == ["Synchronizer"]
