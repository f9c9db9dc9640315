"""`motionsync describe`: variables, choices and fault codes."""

import re
from importlib import import_module
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages import console
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import PYTHON, the_fmu


@pytest.mark.parametrize(("unit", "velocity"), [("mm", "mm/s"), ("deg", "deg/s"), ("1", "1/s")])
def test_describe_shows_every_variable_and_choice(motionsync: Command, unit: str, velocity: str) -> None:
    outcome = motionsync("describe", "Synchronizer", "--unit", unit)
    assert (outcome.status, outcome.err) == (0, "")
    words = outcome.out.replace(",", " ").split()
    for name in ("master.input_mode", "output_phasing", "rest_value", "slave.jerk", "local.peak_acceleration_per_v2"):
        assert name in words
    for text in ("input", "parameter", "output", "local", velocity):
        assert text in words
    for choice in ("1 START_OF_STEP:", "3 POSITION_ONLY:", "1 PARABOLA:", "0 READY:", "2 STACKED:"):
        assert choice in outcome.out


def test_describe_of_a_built_fmu_shows_its_own_unit_and_start_values(motionsync: Command) -> None:
    options = ("--unit", "deg", "--start", "rest_value=12.25", "--output", "here")
    assert motionsync("build", "Synchronizer", *PYTHON, *options).status == 0
    outcome = motionsync("describe", the_fmu("here"))
    assert (outcome.status, outcome.err) == (0, "")
    assert {"deg/s2", "12.25"} <= set(outcome.out.split())
    assert "mm/s2" not in outcome.out


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("Nope",), ("'Nope'", "Synchronizer")),
        (("Synchronizer", "--unit", "furlong"), ("furlong", "mm")),
        (("nowhere.fmu",), ("nowhere.fmu", "no such file")),
        (("build/native/FlyingSaw",), ("build/native/FlyingSaw", "no such file")),
        (("FlyingSaw", "--slave-unit", "deg"), ("slave unit 'deg'", "in its master's unit")),
        (("text.fmu",), ("text.fmu", "not an FMU")),
    ],
)
def test_a_mistake_in_describe_is_one_line(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    Path("text.fmu").write_text("no FMU")
    assert_one_line(motionsync("describe", *arguments), *parts)


@pytest.mark.parametrize("name", BLOCKS)
def test_describe_lists_the_fault_codes(motionsync: Command, name: str) -> None:
    """Each of the block's faults has a line with its code and its description."""
    module = import_module(type(Recipe(name).block()).__module__.replace(".block", ".faults"))
    _, _, codes = motionsync("describe", name).out.partition("Fault codes")
    assert codes
    for fault in Recipe(name).variables["error_id"].declaration.codes or module.Fault:
        if fault.value:
            assert re.search(rf"^  {fault.value} .*{fault.name}: {re.escape(fault.description)}$", codes, re.MULTILINE)


@pytest.mark.all_blocks
def test_describe_fits_a_terminal_of_80_columns(monkeypatch: pytest.MonkeyPatch, motionsync: Command) -> None:
    monkeypatch.setattr(console.out, "_force_terminal", True)
    monkeypatch.setattr(console.out, "_width", 80)
    monkeypatch.setattr(console.out, "no_color", True)
    for name in BLOCKS:
        lines = re.sub(r"\x1b\[[0-9;]*m", "", motionsync("describe", name).out).splitlines()
        headings = [line for line in lines if not line.startswith(" ")]
        assert [line for line in lines if len(line) > 80 and line not in headings] == []
