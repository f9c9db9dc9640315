"""`motionsync error`: the explanation of a fault code."""

import re

import pytest

from tests.support.command_line import Command, assert_one_line


@pytest.mark.parametrize(
    "arguments", [("17118",), ("0x42DE",), ("0x42de",), ("flyingsaw", "17118"), ("must", "BE", "ahead")]
)
def test_error_explains_a_code(motionsync: Command, arguments: tuple[str, ...]) -> None:
    outcome = motionsync("error", *arguments)
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.startswith(
        "FlyingSaw, 17118 = 0x42DE (NOT_AHEAD)\n  refused (0x42DE): both sync positions must be"
    )
    assert "gear_in_pos.error_id" in outcome.out
    assert "master.position" in outcome.out


def test_error_lists_all_blocks_that_have_a_code(motionsync: Command) -> None:
    """Of these seven; a further block may have the code, too."""
    having = ["FlyingSaw", "Gearing", "Follower", *6 * ["CutToLength"], *5 * ["RotaryKnife"]]
    listed = re.findall(r"^(\w+), 2 ", motionsync("error", "2").out, re.MULTILINE)
    assert [name for name in listed if name in {*having, "Synchronizer", "RemoteSync"}] == having
    assert re.findall(r"^(\w+), 2 ", motionsync("error", "Follower", "2").out, re.MULTILINE) == ["Follower"]


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
