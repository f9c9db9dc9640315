"""The pages on a measured line are true: their figures are those of the runs and formulas that they name."""

import re
from math import sqrt

import pytest

from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.batch.scripted_runs import run_scenarios
from motionsync_fmu.scenario.evaluate.key_figures import KeyFigures, compute_key_figures
from tests import ROOT

PAGE = "".join((ROOT / "docs" / folder / "measured_line.md").read_text("utf-8") for folder in ("tutorial", "how_to"))
FILE = ROOT / "scenarios" / "CutToLength" / "measured_line" / "scenario.toml"


def table(heading: str) -> list[list[str]]:
    """The rows of the table whose first column has this heading."""
    lines = PAGE[PAGE.index(f"| {heading} |") :].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def figures(*changes: str) -> KeyFigures:
    scenario = load(FILE, set=dict(change.split("=") for change in changes))
    outputs = [v.name for v in scenario.recipe.variables.values() if not v.settable]
    (run,) = run_scenarios([scenario], outputs, threads=1)
    assert run.recording, run.failure
    return compute_key_figures(scenario, run.recording)


@pytest.mark.parametrize("row", table("`--set`"), ids=lambda row: row[0])
def test_the_table_has_the_figures_of_the_runs(row: list[str]) -> None:
    result = figures(*re.findall(r"`([^`]+)`", row[0]))
    assert result.true_pieces
    assert result.load
    true = result.true_pieces
    computed = (
        f"{abs(true.worst):.4f} mm",
        f"{true.deviation:.4f} mm",
        f"{true.c_pk:.2f}",
        f"{result.load.peak:.0f} N",
    )
    assert tuple(row[1:]) == computed


def test_the_motor_gives_these_shares_of_what_it_can() -> None:
    load = figures().load
    assert load
    assert load.peak_share
    assert load.rms_share
    shares = f"{100.0 * load.peak_share:.0f} % of its peak and {100.0 * load.rms_share:.0f} % of its continuous force"
    assert shares in PAGE


def test_the_examples_of_how_to_choose_are_computed_right() -> None:
    h, noise = 1e-3, 0.02
    lowest = (3.0 * 3.7123 / 0.02 * noise * sqrt(h) / 10_000.0) ** 0.4
    assert f"10 000 mm/s² that is {1e3 * lowest:.0f} ms" in PAGE
    assert f"that is {0.02 * sqrt(0.02 / h) / 1.4252:.3f} s · s_V" in PAGE
    assert f"{noise * sqrt(2.0) / h:.0f} mm/s of velocity" in PAGE
    assert round(noise * sqrt(6.0) / h**2, -3) == 49_000.0
    assert "49 000 mm/s² of acceleration" in PAGE
