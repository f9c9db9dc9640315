"""`motionsync error`: the explanation of a fault code."""

import re
from collections.abc import Iterator

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import members
from tests.support.project.command_line import Command, assert_one_line


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
@pytest.mark.all_blocks
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


@pytest.mark.parametrize("block", BLOCKS)
def test_the_name_of_a_block_alone_lists_all_its_codes(motionsync: Command, block: str) -> None:
    """Not those alone that have the name in their texts."""
    outcome = motionsync("error", block.lower())
    assert outcome.status == 0
    assert re.findall(r"^(\w.*)$", outcome.out, re.M) == [block]
    listed = {int(n) for n in re.findall(r"^  (\d+)(?: = 0x\w+)? \(", outcome.out, re.M)}
    declared = [v.declaration.codes for v in Recipe(block).variables.values() if v.declaration.codes]
    assert listed == {member.value for kind in declared for member in members(kind)} - {0}


@pytest.mark.parametrize("block", BLOCKS)
def test_a_code_of_another_block_is_none_of_this_one(motionsync: Command, block: str) -> None:
    """17118 is a code of the FlyingSaw, 18 one of both machines that cut, 19289 one of RemoteSync."""
    having = {"17118": ["FlyingSaw"], "18": ["CutToLength", "RotaryKnife"], "19289": ["RemoteSync"]}
    for number, blocks in having.items():
        outcome = motionsync("error", block, number)
        assert outcome.status == (0 if block in blocks else 2)
        if outcome.status:
            assert_one_line(outcome, f"{block} has no fault code {number}")
            nearest = outcome.err.rpartition("the nearest are ")[2].split(", ")
            assert len(nearest) == len({*nearest})


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("",), ("name a fault code",)),
        ((" ", " "), ("name a fault code",)),
        (("Gearing", "elephant"), ("of Gearing", "'elephant'")),
        (("17000",), ("fault code 17000", "17006 = 0x426E (FlyingSaw)")),
        (("Follower", "17118"), ("fault code 17118", "14 (Follower)")),
        (("purple", "elephant"), ("'purple elephant'", "motionsync describe")),
    ],
)
def test_an_unknown_code_is_one_line_with_the_nearest(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("error", *arguments), *parts)
