"""The examples in the READMEs of the scenarios run as they are written, and are as expected."""

import re
from pathlib import Path

import pytest

from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process
from tests import ROOT
from tests.support.scenarios.verdicts import checks_of

README = ROOT / "scenarios" / "README.md"


def files(text: str) -> list[str]:
    """The TOML blocks of a page that are whole files: those with a title."""
    return [block for block in re.findall(r"```toml\n(.*?)```", text, re.DOTALL) if block.startswith("title")]


@pytest.mark.parametrize("i", [0, 1, 2])
@pytest.mark.parametrize("step_size", [0.01, 0.007])
def test_an_example_copied_from_the_page_is_as_expected(i: int, step_size: float, tmp_path: Path) -> None:
    """Three cuts, as all files expect them."""
    examples = files(README.read_text())
    assert len(examples) == 3
    file = tmp_path / "saw" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(examples[i])
    scenario = load_scenario(file)
    recording = run_in_process(scenario, step_size)
    result = checks_of(scenario, recording)
    assert result
    assert [c for c in result if not c.passed] == []
    made = "pieces" if scenario.pieces else "cuts"
    assert any(c.expected == f"number of {made} = 3" and c.actual == "3" for c in result)
    assert recording.unmet == []
    assert not any(recording.values[name].any() for name in recording.values if name.endswith("limit_exceeded"))


def test_the_card_has_every_key_of_a_scenario(tmp_path: Path) -> None:
    """The keys that a reader's message names where one is wrong; [remote] and [encoder] have examples of their own."""
    card, pieces = files(README.read_text())[1:]
    file = tmp_path / "scenario.toml"
    for table, spared in (
        ("", {"slave_unit", "remote", "encoder"}),
        ("[[on]]", set()),
        ("[cuts]", set()),
        ("[picture]", set()),
    ):
        file.write_text(f"nonsense = 1\n{card}" if not table else card.replace(table, f"{table}\nnonsense = 1", 1))
        with pytest.raises(Exception, match="unknown key; there is") as error:
            load_scenario(file)
        for key in set(str(error.value).split("there is ")[1].split(", ")) - spared:
            assert re.search(rf"^(# )?(\[+(picture\.)?{key}\b|{key} =)", card, re.MULTILINE), key
    encoder = re.search(r"```toml\n(\[encoder\].*?)```", README.read_text(), re.DOTALL)
    assert encoder
    file.write_text(f"{card}\n{encoder[1]}")
    assert load_scenario(file).encoder == Encoder(0.1, 0.02, 0.004, 1.0005, 0.05, 500.0, 0.002, 1)
    file.write_text(pieces.replace("[cuts]", "[cuts]\nnonsense = 1"))
    with pytest.raises(Exception, match="unknown key; there is") as error:
        load_scenario(file)
    for key in set(str(error.value).split("there is ")[1].split(", ")):
        assert re.search(rf"^{key} =", pieces, re.MULTILINE), key
