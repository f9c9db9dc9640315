"""fmuloader, Ecos and libcosim get the bits of FMPy from the FMUs that they can run. A host in C does so in
tests/native/test_same_bits.py and tests/fmi3/test_same_bits.py."""

from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.interface.recipe import Fmi, Recipe
from tests.support.blocks.random_runs import draw_accepted_run
from tests.support.blocks.runs import BlockRun
from tests.support.hosts.fmus import Fmus, Shared, build_for_host
from tests.support.hosts.importers import Row, through_ecos, through_fmpy, through_fmuloader, through_libcosim

H = 2.0**-7  # s; exact, however an importer adds up its steps
STEPS = 600


def least_states(block: str) -> int:
    """How many states the run has to show: three, or both of a block that has two."""
    return min(3, len(Recipe(block).variables["state"].choices))


@pytest.fixture(scope="module")
def run(block: str) -> BlockRun:
    return draw_accepted_run(block, H, STEPS, states=least_states(block))


@pytest.fixture(scope="module")
def baked_run(block: str, run: BlockRun) -> BlockRun:
    """The same without enumerations: one that the run sets has from the start the value that it is given first."""
    choices = {v.name for v in Recipe(block).variables.values() if v.choices}
    start, steps = dict(run.start), []
    for h, values in run.steps:
        start = {name: x for name, x in values.items() if name in choices} | start
        steps.append((h, {name: x for name, x in values.items() if name not in choices}))
    return BlockRun(start, steps)


def through_native(block: str, fmu: Path, run: BlockRun) -> list[Row]:
    rows = through_fmpy(fmu, run)
    assert len({row["state_code"] for row in rows}) >= least_states(block)
    return rows


@pytest.fixture(scope="module")
def expected(block: str, block_native: Path, run: BlockRun) -> list[Row]:
    return through_native(block, block_native, run)


@pytest.fixture(scope="module")
def expected_of_baked(block: str, block_native: Path, baked_run: BlockRun) -> list[Row]:
    return through_native(block, block_native, baked_run)[1:]


@pytest.fixture
def baked(block: str, baked_run: BlockRun, shared: Shared) -> Any:
    """The block's FMU of a flavour and a version, with the run's start values baked in."""

    def of(flavour: Flavour, fmi: Fmi = Fmi.TWO) -> Path:
        recipe = Recipe(block, starts={name: str(value) for name, value in baked_run.start.items()}, fmi=fmi)

        def fill(folder: Path) -> None:
            build_for_host(flavour, recipe, folder / f"{block}.fmu")

        return shared.once(f"baked/{flavour}-{fmi}/{block}", fill) / f"{block}.fmu"

    return of


@pytest.mark.parametrize("fmi", Fmi)
def test_fmuloader_gets_the_bits_of_fmpy(
    block: str, fmi: Fmi, fmus: Fmus, block_native: Path, run: BlockRun, expected: list[Row]
) -> None:
    fmu = fmus.fmi3(block) if fmi == Fmi.THREE else block_native
    assert through_fmuloader(fmu, run) == expected


@pytest.mark.parametrize("fmi", Fmi)
def test_ecos_gets_the_bits_of_fmpy(
    block: str, fmi: Fmi, baked: Any, baked_run: BlockRun, expected_of_baked: list[Row]
) -> None:
    assert_equal_but_for_enumerations(through_ecos(baked(Flavour.NATIVE, fmi), baked_run), expected_of_baked)


@pytest.mark.parametrize("flavour", Flavour)
def test_libcosim_gives_the_results_of_fmpy(
    block: str, flavour: Flavour, baked: Any, baked_run: BlockRun, expected_of_baked: list[Row]
) -> None:
    assert_equal_but_for_enumerations(through_libcosim(baked(flavour), baked_run), expected_of_baked)


def assert_equal_but_for_enumerations(rows: list[Row], expected: list[Row]) -> None:
    """Compare rows of an importer without enumerations with those of FMPy."""
    assert "state_code" in rows[0]
    assert rows == [{name: row[name] for name in rows[0]} for row in expected]
