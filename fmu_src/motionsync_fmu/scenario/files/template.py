"""The template of a scenario: the block's example, with comments on its tables."""

import re

from .example import load_example

COMMENTS = {
    "[start]": "# What the block starts with: parameters and inputs. What is not named keeps the block's own value.",
    "[master]": "# The axis that is followed: where it starts, and how it moves on. segments = [{ duration = 2.0 },\n"
    "# { duration = 1.0, acceleration = -100.0 }] would keep the velocity for 2 s and then slow down.",
    "[remote]": "# The true axis on the other controller, and the clock by which its telegrams are sent.",
    "[remote.accuracy]": "# How near to the true axis the slave has to be.",
    "[[set]]": "# What is set during the run, at a time in s. A command is given by its rising edge: false to true.\n"
    '# [[on]] with when = "in_sync" or another output reacts instead: scenarios/README.md describes all tables.',
    "[[expect]]": "# What the outputs must be; motionsync run reports deviations. Values hold at a time (at), events\n"
    "# happen for the first time (when, time), limits hold for a while (from, to).",
    "[cuts]": "# The slave is a saw, the master its material: where its marks are, and how many are cut. What meets\n"
    "# master_sync_position with slave_sync_position cuts at master_sync_position - slave_sync_position / ratio.",
}
PIECES = (  # in place of the comment of [cuts], for a block that reports its pieces
    "# The pieces that there have to be: count = how many, lengths = [...], kinds = [...]. If cuts are meant to be\n"
    "# skipped: skipped = how many. What the block reports is compared with the positions of slave and master."
)
HEAD = """\
# A scenario of the block {name}. Lengths, speeds and times are yours to change: run it again, and look at the report.
# Positions are in `unit` ("mm" if it is left out), times in s.
"""


def make_template(name: str) -> str:
    """The text of a scenario file that runs the block of this name.

    Raises:
        UserError: no block has this name.
    """
    example = load_example(name)
    comments = COMMENTS | ({"[cuts]": PIECES} if example.pieces else {})
    text = example.text.partition("\n[picture")[0].rstrip() + "\n"
    text = re.sub(r"^source = .*\n", "", text, flags=re.MULTILINE)
    for heading, comment in comments.items():
        before, match, after = text.partition(f"\n{heading}")
        text = f"{before}\n{comment}{match}{after}" if match else text
    return HEAD.format(name=name) + text
