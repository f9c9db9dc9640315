"""`motionsync error`: the explanation of a fault code."""

import re
from collections.abc import Iterator

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import members
from tests.support.command_line import Command, assert_one_line


@pytest.mark.parametrize(
    "arguments", [("17118",), ("0x42DE",), ("0x42de",), ("flyingsaw", "17118"), ("must", "BE", "ahead")]
)
def test_error_explains_a_code(motionsync: Command, arguments: tuple[str, ...]) -> None:
    outcome = motionsync("error", *arguments)
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.startswith("FlyingSaw\n  17118 = 0x42DE (NOT_AHEAD) in gear_in_pos.error_id")
    assert "    refused (0x42DE): both sync positions must be" in outcome.out
    assert "gear_in_pos.error_id" in outcome.out
    assert "master.position" in outcome.out


@pytest.mark.parametrize("number", range(1, 15))
def test_the_meanings_of_a_number_are_grouped_by_block(motionsync: Command, number: int) -> None:
    """Each block comes once, in the sequence of `motionsync list`, with all its meanings, that of its error_id first;
    named alone it has these and no others. Each of these numbers is a code of several blocks."""
    meanings = {name: {*meanings_of(name, number)} for name in BLOCKS}
    having = [name for name in BLOCKS if meanings[name]]
    printed = motionsync("error", str(number)).out
    assert re.findall(r"^(\w+)$", printed, re.M) == having
    lead, _, _ = printed.partition("\n\n")
    assert lead.startswith(f"{number}: ")
    assert f"motionsync error {having[0]} {number}" in lead
    for block in having:
        part = re.search(rf"^{block}\n((?: .*\n)+)", printed, re.M)
        assert part
        assert part[0] in motionsync("error", block, str(number)).out
        shown = re.findall(rf"^  {number} \((\w+)\) in (.*)$", part[1], re.M)
        assert {(name, v) for name, where in shown for v in where.split(", ")} == meanings[block]
        ids = [where.endswith("error_id") for _, where in shown]
        assert ids == sorted(ids, reverse=True)


def meanings_of(block: str, number: int) -> Iterator[tuple[str, str]]:
    """The names of a block's codes with a number, each with a variable that shows it."""
    for v in Recipe(block).variables.values():
        for member in members(v.declaration.codes) if v.declaration.codes else ():
            if member.value == number:
                yield member.name, v.name


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("17000",), ("fault code 17000", "17006 = 0x426E (FlyingSaw)")),
        (("Follower", "17118"), ("fault code 17118", "14 (Follower)")),
        (("purple", "elephant"), ("'purple elephant'", "motionsync describe")),
    ],
)
def test_an_unknown_code_is_one_line_with_the_nearest(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("error", *arguments), *parts)
