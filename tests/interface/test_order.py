"""The order in which a block's variables are listed, and how many ports the largest blocks have."""

import pytest

from motionsync_fmu.interface.recipe import Recipe

SIGNALS, SETTINGS, WATCHED = range(3)
SECTION = {"input": SIGNALS, "output": SIGNALS, "parameter": SETTINGS, "local": WATCHED}


def test_signals_come_first_then_settings_then_what_is_watched(block: str) -> None:
    """A group, such as `slave.*`, is listed where its first variable belongs; the axis that leads comes first."""
    table = Recipe(block).variables
    sections = {}
    for name, v in table.items():
        group = name.partition(".")[0]
        sections.setdefault(group, SECTION[v.causality])
    assert next(iter(sections)) in ("master", "remote")
    assert list(sections.values()) == sorted(sections.values()), sections
    listed = list(sections)
    commands = [name.partition(".")[0] for name, v in table.items() if v.declaration.command]
    assert max(map(listed.index, commands), default=0) < listed.index("slave") < listed.index("state")


@pytest.mark.parametrize(("block", "inputs", "outputs"), [("FlyingSaw", 30, 45), ("CutToLength", 20, 30)])
def test_a_block_with_many_variables_has_few_ports(block: str, inputs: int, outputs: int) -> None:
    table = Recipe(block).variables.values()
    assert sum(v.causality == "input" for v in table) <= inputs
    assert sum(v.causality == "output" for v in table) <= outputs
