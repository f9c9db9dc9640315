"""Compares a run with the reference of its scenario."""

import csv
import math
import os
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UserError
from ..engineering import engineering
from ..recording import Recording, nearest_turn
from ..scenario import Scenario

ARCHIVE = "references.zip"  # the references of all scenarios in the folders beside it, as <folder>/<file>


@dataclass(frozen=True)
class Deviation:
    """How far a variable is from the reference.

    Attributes:
        greatest: the greatest |difference|, in the variable's unit.
        at: the time of it, in s.
        allowed: how great it may be.
        points: at how many times both were compared.
        scale: the greatest magnitude in the reference, at least 1.
    """

    name: str
    greatest: float
    at: float
    allowed: float
    points: int
    scale: float

    @property
    def passed(self) -> bool:
        return self.greatest <= self.allowed

    @property
    def text(self) -> str:
        """The deviation in one sentence."""
        if not self.points:
            return f"{self.name}: the reference has no time in common with the run"
        difference = engineering(self.greatest, scale=self.scale)
        allowed = engineering(self.allowed)
        return f"{self.name}: {difference} from the reference at {engineering(self.at)} s, {allowed} allowed"


def reference_file(scenario: Scenario) -> Path:
    """The file next to a scenario's that is its reference, if there is one; a reference in ARCHIVE has its name."""
    return scenario.file.with_name(f"{scenario.recipe.name}_ref.csv")


def find_reference(scenario: Scenario) -> Path | zipfile.Path | None:
    """The reference next to a scenario's file, else that in ARCHIVE in the folder above; None without one.

    Raises:
        UserError: the archive cannot be read.
    """
    file = reference_file(scenario)
    if os.path.lexists(file):
        return file
    folder = file.parent.resolve()
    archive = folder.parent / ARCHIVE
    if not archive.is_file():
        return None
    try:
        member = zipfile.Path(archive, f"{folder.name}/{file.name}")
    except (OSError, zipfile.BadZipFile) as error:
        raise UserError(f"{archive}: {error}") from None
    return member if member.exists() else None


def read_reference(scenario: Scenario) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]]] | None:
    """Names and rows, of shape (points, 1 + names), of the scenario's reference; None without one.

    Raises:
        UserError: a reference that cannot be read.
    """
    place = find_reference(scenario)
    if place is None:
        return None
    try:
        if not place.is_file():  # a link to nothing, a pipe
            raise OSError("it is no file")
        with place.open(encoding="utf-8", newline="") as lines:
            header, *rows = list(csv.reader(lines))
        table = np.array(rows, float)
        if why := _find_mistake(header, table):
            raise ValueError(why)
    except (OSError, ValueError, csv.Error, zipfile.BadZipFile, zlib.error) as error:
        raise UserError(f"{place}: not a reference: {error}") from None
    return header[1:], table


def _find_mistake(header: list[str], table: np.ndarray[Any, np.dtype[np.float64]]) -> str:
    """Why these are no reference; empty if they are one."""
    if len(table) < 3:  # two rows are start and end, and nothing of the run
        return f"{len(table)} rows, fewer than 3"
    if table.shape[1] != len(header):
        return "rows of different lengths"
    if len(header) < 2:
        return "no column but the time"
    if not np.isfinite(table).all():
        row, column = np.argwhere(~np.isfinite(table))[0]
        return f"{header[column]} is {table[row, column]} in row {row + 1}"
    if (falls := np.diff(table[:, 0]) < 0.0).any():
        row = int(np.argmax(falls)) + 1
        return f"the time falls from {table[row - 1, 0]} to {table[row, 0]} s in row {row + 1}"
    return ""


def compare_with_reference(scenario: Scenario, recording: Recording) -> list[Deviation]:
    """Compare a recording with the reference at their common times.

    Two rows of the reference at one time are the values before and after a jump; any value between them agrees. A
    position that wraps has the same value a turn away: where its turn ends is no jump. The scenario's tolerance is
    relative to the greatest magnitude of the variable in the reference, at least 1.
    """
    reference = read_reference(scenario)
    if reference is None:
        return []
    names, table = reference
    if unknown := [n for n in names if n not in recording.columns]:
        raise UserError(f"{scenario.file.parent}: the reference has {unknown[0]!r}, the FMU has not")
    times = np.unique(table[:, 0])
    at = np.searchsorted(recording.time, times - 1e-9)
    common = (at < len(recording.time)) & (
        np.abs(recording.time[np.minimum(at, len(recording.time) - 1)] - times) <= 1e-9
    )
    first = np.searchsorted(table[:, 0], times[common], "left")
    last = np.searchsorted(table[:, 0], times[common], "right") - 1
    deviations = []
    for column, name in enumerate(names, 1):
        period, before = scenario.period_of(name), table[first, column]
        after = nearest_turn(table[last, column], before, period)
        values = nearest_turn(recording.columns[name][at[common]], before, period)
        beyond = np.maximum(np.minimum(before, after) - values, values - np.maximum(before, after))
        differences = np.maximum(beyond, 0.0)
        worst = int(np.argmax(differences)) if len(differences) else 0
        scale = max(1.0, float(np.abs(table[:, column]).max()))
        greatest, time = (
            (float(differences[worst]), float(times[common][worst])) if len(differences) else (math.inf, 0.0)
        )
        deviations.append(Deviation(name, greatest, time, scenario.tolerance * scale, int(common.sum()), scale))
    return deviations
