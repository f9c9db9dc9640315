"""What `motionsync describe` shows."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..interface.codes import FaultCode, codes_of
from ..interface.recipe import Recipe
from ..interface.table import Group, Row, groups
from ..interface.units import BASES
from ..interface.variables import summary, variables


def describe(fmu: str | Path, *, unit: str = "mm", slave_unit: str = "") -> Description:
    """The variables, enumerations and fault codes of a block or of a built FMU.

    Args:
        fmu: a block's name, or the path of a built FMU.
        unit: of all positions, `"mm"`, `"m"`, `"deg"`, `"rad"` or `"1"`; a built FMU has its own.
        slave_unit: of the slave's positions, for a block whose slave may have another unit than its master; by default
            deg if its tool turns, else `unit`.

    Raises:
        UserError: there is no such block, FMU or unit.
    """
    recipe = _recipe(fmu, unit, slave_unit)
    block = replace(recipe, starts={}).block()
    return Description(
        recipe.name,
        summary(type(block)),
        _with_starts(groups(block, recipe.unit, recipe.slave_unit, recipe.causality_overrides), recipe.starts),
        list(dict.fromkeys(v.cell.type for v in variables(block) if v.choices)),
        codes_of(recipe.name, block),
    )


@dataclass(frozen=True, repr=False)
class Description:
    """What a block has.

    Attributes:
        name: the block's name.
        summary: what it does, in a line.
        groups: its variables by groups, in the order of the FMU.
        enumerations: the types of its variables that are enumerations.
        codes: its fault codes.
    """

    name: str
    summary: str
    groups: list[Group]
    enumerations: list[type[Any]]
    codes: list[FaultCode]

    @cached_property
    def variables(self) -> dict[str, Row]:
        """The variables by name. Each has `causality`, `variability`, `type`, `unit`, `start`, `allowed_range` and
        `description`, all as texts."""
        return {row.name: row for group in self.groups for row in group.rows}

    def __repr__(self) -> str:
        count, codes = len(self.variables), len(self.codes)
        return f"{self.name}: {self.summary} ({count} variables, {codes} fault codes)"

    def _repr_html_(self) -> str:
        """The variables as a table, and the fault codes as another one."""
        from ..pages.style import TEMPLATES, load_template  # noqa: PLC0415 (Jinja is loaded where it is needed)

        return load_template(TEMPLATES, "description.html.j2").render(description=self)


def _with_starts(rows: list[Group], starts: Mapping[str, str]) -> list[Group]:
    """The same groups, with start values in place of the block's own ones."""
    return [
        replace(group, rows=[replace(row, start=starts.get(row.name, row.start)) for row in group.rows])
        for group in rows
    ]


def _recipe(fmu: str | Path, unit: str, slave_unit: str) -> Recipe:
    """The recipe of the FMU or block that the argument names."""
    path, name = Path(fmu), str(fmu)
    if path.is_file() or path.suffix.lower() == ".fmu":
        from ..scenario.run.fmu_instance import read_recipe  # noqa: PLC0415 (FMPy takes long to load)

        if not path.is_file():
            raise UserError(f"{fmu}: no such file")
        return read_recipe(path)
    if path.name != name:
        raise UserError(f"{fmu}: no such file; name a block, or the path of a built FMU")
    slaves = resolve_name(BASES, slave_unit, "slave unit") if slave_unit else ""
    return Recipe(resolve_name(BLOCKS, name, "block"), resolve_name(BASES, unit, "unit"), {}, slaves)
