"""How the page of a block opens: `explore.toml` in the block's folder."""

from pathlib import Path

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.explorer import opening
from motionsync_fmu.explorer.page import scenarios_of
from motionsync_fmu.interface.recipe import Recipe
from tests.support.scenarios.explored import opens_with


def test_a_page_has_the_scenario_with_which_it_opens_first_and_the_example(block: str) -> None:
    names = [s.name if s.file.name == "scenario.toml" else "example" for s in scenarios_of(block)]
    assert names[0] == opens_with(block)
    assert names.count("example") == 1


def test_the_main_values_can_be_set(block: str) -> None:
    main = opening.opening_of(block).main
    variables = Recipe(block).variables
    assert len(set(main)) == len(main)
    assert all(name == "cuts.length" or variables[name].settable for name in main)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('scenario = "polynomal"', "explore.toml:2: scenario: Synchronizer has no scenario 'polynomal'"),
        (
            'main = ["output_phasing", "state"]',
            "explore.toml:2: main: 'state' is no input or parameter of Synchronizer",
        ),
        ("first = 1", "explore.toml:2: first: unknown key; there is scenario, main"),
    ],
)
def test_a_mistake_is_reported_with_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, message: str
) -> None:
    file = tmp_path / "explore.toml"
    file.write_text(f"# a comment\n{line}\n")
    monkeypatch.setattr(opening, "block_file", lambda *_: file)
    with pytest.raises(UserError) as error:
        opening.opening_of("Synchronizer")
    assert str(error.value).endswith(message)
