"""Curves over a column: a result with the band of its runs, and the boundary from which on runs pass."""

from dataclasses import dataclass

import numpy as np

from ..database import Answer, Column, Database
from .cells import Axis

PASSED = "passed"  # the column with whether a run was as expected


@dataclass(frozen=True)
class Boundary:
    """Between the runs that passed and the others, over x: one row for each cell of x and each group.

    Attributes:
        above: the runs pass above the boundary; otherwise below it.
        points: `cx`, `group`; `surely`: the outermost value of y from which on every run passed, NaN: there is none;
            `partly`: the outermost value with a run that passed; `pick`: the run at `surely`, -1 where there is none;
            `failed`: the last run that did not pass, or -1; `runs`: how many there are.
    """

    above: bool
    points: Answer


def _group(groups: Axis | None) -> str:
    return groups.cell if groups else "0"


def curves(db: Database, x: Axis, y: Column, groups: Axis | None) -> Answer:
    """Mean, least and greatest y of the runs in each cell of x, of each group.

    The answer has `cx`, `group`, `runs`, `mean`, `least`, `greatest`, and the runs that represent these three: the
    nearest one to the mean, `pick`, and `pick_least`, `pick_greatest`."""
    return db.ask(f"""
        WITH placed AS (SELECT run, {x.cell} AS cx, {_group(groups)} AS g, {y.number} AS v FROM runs),
        cells AS (SELECT cx, g, avg(v) AS mean FROM placed WHERE cx IS NOT NULL AND g IS NOT NULL AND v IS NOT NULL
            GROUP BY cx, g)
        SELECT cx, g AS "group", count(*) AS runs, any_value(mean) AS mean, min(v) AS least, max(v) AS greatest,
            arg_min(run, (abs(v - mean), run)) AS pick, arg_min(run, (v, run)) AS pick_least,
            arg_min(run, (-v, run)) AS pick_greatest
        FROM placed JOIN cells USING (cx, g) WHERE v IS NOT NULL GROUP BY cx, g ORDER BY g, cx""")


def boundary(db: Database, x: Axis, y: Column, groups: Axis | None) -> Boundary | None:
    """Where, over x, the runs start to pass; None if all of them did, or none.

    Runs pass above the boundary if those that passed are above the others on average, cell by cell."""
    placed = f"""SELECT run, {x.cell} AS cx, {_group(groups)} AS g, {y.number} AS v, {PASSED} AS ok FROM runs"""
    rise = db.one(f"""
        WITH placed AS ({placed})
        SELECT sum(rise) AS rise FROM (
            SELECT avg(v) FILTER (ok) - avg(v) FILTER (NOT ok) AS rise FROM placed
            WHERE cx IS NOT NULL AND g IS NOT NULL AND v IS NOT NULL GROUP BY cx, g)""")["rise"]
    if not np.isfinite(rise) or rise == 0.0:
        return None
    sign = 1 if rise > 0.0 else -1
    points = db.ask(f"""
        WITH placed AS (SELECT run, cx, g, {sign} * v AS u, ok FROM ({placed})
            WHERE cx IS NOT NULL AND g IS NOT NULL AND v IS NOT NULL),
        cells AS (SELECT cx, g, max(u) FILTER (NOT ok) AS broken FROM placed GROUP BY cx, g)
        SELECT cx, g AS "group", count(*) AS runs, {sign} * min(u) FILTER (ok) AS partly,
            {sign} * min(u) FILTER (ok AND (broken IS NULL OR u > broken)) AS surely,
            coalesce(arg_min(run, (u, run)) FILTER (ok AND (broken IS NULL OR u > broken)), -1) AS pick,
            coalesce(arg_min(run, (-u, run)) FILTER (NOT ok), -1) AS failed
        FROM placed JOIN cells USING (cx, g) GROUP BY cx, g ORDER BY g, cx""")
    return Boundary(sign > 0, points)
