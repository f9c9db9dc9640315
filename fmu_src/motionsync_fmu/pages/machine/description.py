"""How the machine of a block is drawn: `machine.toml` in the block's folder, for reports and for the pages of
`motionsync explore`. A block without this file has no picture of its own; one with a remote axis needs none.

The file holds tables `[[picture]]`; the first one that applies is drawn. A *condition* is a Boolean output, or
`output == MEMBER` of an enumeration; in a list, one of them has to hold; an empty list never does. Keys marked * are
required.

- `where`: a start value that is not 0 if the picture applies; without it, it always does.
- `scene` *: "axes", master and slave side by side; "belt", a carriage over moving material; or "cylinder", blades that
  turn above it.

Of axes:

- `master_period`, `slave_period` *: start values, the first that is not 0 counts; `a unless b`: not if `b` is set.
- `coupled`, `changing` *: conditions for the readout "in step" or "changing"; else it is "none".
- `master_marks`, `slave_marks`: each with a `label` *, `at` or `from` and `to`, any variables; `shown`: conditions.

Of a belt:

- `tool` *: "saw" or "gripper"; `down` *: conditions, for a scenario whose `[cuts]` name no output for the blade.
- `in_sync`: conditions that hold where the carriage is in sync, without it those of `down`; `zone`: instead, the two
  start values between which it is.
- `ratio`: the slave's travel over the master's, a start value or an output; a block with pieces has a role for it.
- `home` *: a start value, with `home_label`; with `home_used`, a Boolean output, if that is ever true.
- `next_cut`, `next_cut_shown`: the position on the material, and whether it is determined.
- `product_distance`: how far the master is from the meeting with the next product.

Of a cylinder, whose block records its pieces, all of them are required:

- `turn`, `circumference`, `blades`, `park`: start values: the slave's position per turn and that at park (0: half way
  between two blades), the circle on which the blades' edges run, and how many there are; one is at the material where
  the slave's position is 0.
- `before`, `after`, `overspeed`: the window around a cut, and by which share the edge is faster in it.
- `along_material`: `parameter == MEMBER`, where the edge's speed along the material is the line's, not that along its
  circle.
- `in_sync`: conditions; `next_cut`, `next_cut_shown`: as of a belt.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from motionsync.blocks import BLOCKS

from ...interface.block_folder import block_file
from ...interface.recipe import Recipe
from ...interface.variables import Variable
from ...scenario.files.toml_tables import TomlTable, read_toml
from ...scenario.files.variable_tables import Subject, VariableTable

FILE = "machine.toml"
CYLINDER = ("turn", "circumference", "blades", "park", "before", "after", "overspeed", "along_material", "in_sync")
REQUIRED = {
    "axes": ("master_period", "slave_period", "coupled", "changing"),
    "belt": ("tool", "down", "home"),
    "cylinder": (*CYLINDER, "next_cut", "next_cut_shown"),
}
TEXTS = ("scene", "tool", "label", "home_label")
MARKS = ("master_marks", "slave_marks")


def pictures_of(recipe: Recipe) -> list[dict[str, Any]]:
    """The pictures of this block; none for one without this file.

    Raises:
        UserError: a picture lacks a key, or names what the block has not.
    """
    file = block_file(BLOCKS[recipe.name], FILE)
    if not file.is_file():
        return []
    pictures = read_toml(file).tables("picture")
    for picture in pictures:
        scene = picture.string("scene")
        if scene not in REQUIRED:
            picture.fail("scene", f"{scene!r} is none of {', '.join(REQUIRED)}")
        _check(picture, REQUIRED[scene], Subject(recipe.name, recipe.variables, "", ""))
    return [picture.values for picture in pictures]


class _PictureTable(VariableTable):
    """A picture, or a mark in one: it may name all variables."""

    def fits(self, v: Variable) -> bool:
        return True


def named_in(picture: Mapping[str, Any]) -> Iterator[str]:
    """The names of all variables that a picture, or a mark in one, names."""
    for key, given in picture.items():
        if key in MARKS:
            for mark in given:
                yield from named_in(mark)
        elif key not in TEXTS:
            for text in [given] if isinstance(given, str) else given:
                yield from text.partition(" == ")[0].split(" unless ")


def _check(table: TomlTable, required: Iterable[str], block: Subject) -> None:
    """Check that a picture, or a mark in one, has these keys and names what the block has."""
    for key in required:
        if key not in table:
            table.fail(key, "is missing")
    named = _PictureTable(table, block)
    for key in table.values:
        if key in MARKS:
            for mark in table.tables(key):
                _check(mark, ("label",), block)
        elif key not in TEXTS:
            for text in table.strings(key):
                condition, _, member = text.partition(" == ")
                for name in condition.split(" unless "):
                    named.variable(name, key)
                if member:
                    named.value(condition, member, key)
