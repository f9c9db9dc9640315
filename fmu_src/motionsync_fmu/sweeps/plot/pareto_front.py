"""The Pareto front: the runs than which no other is better in one result and as good in the other."""

from collections.abc import Mapping

from ...errors import UserError
from ..database import Answer, Column, Database
from .curves import PASSED

BETTER = {"min": 1, "max": -1}  # the sign with which less is better


def better(option: str, x: str, y: str) -> dict[str, str]:
    """What is better of x and of y, from a text such as `x=min,y=max`; less is better where it names nothing.

    Raises:
        UserError: the text is something else.
    """
    directions = {"x": "min", "y": "min"}
    for text in option.split(",") if option else ():
        name, _, which = (part.strip() for part in text.partition("="))
        name = {x: "x", y: "y"}.get(name, name)
        if name not in directions or which not in BETTER:
            raise UserError(f"--better {option}: write x or y, and whether min or max of it is better: x=min,y=max")
        directions[name] = which
    return directions


def front(db: Database, x: Column, y: Column, which: Mapping[str, str]) -> Answer:
    """The runs of the front, from the best x on: `run`, `x`, `y`. Of several runs at one point it has the first.

    Only runs that passed count, if any did: what does not work is no choice."""
    passed = db.one(f"SELECT bool_or({PASSED}) AS passed FROM runs")["passed"]
    sx, sy = BETTER[which["x"]], BETTER[which["y"]]
    return db.ask(f"""
        WITH places AS (
            SELECT u, min(w) AS w, arg_min(run, (w, run)) AS run FROM (
                SELECT run, {sx} * {x.number} AS u, {sy} * {y.number} AS w FROM runs {f"WHERE {PASSED}" * bool(passed)})
            WHERE u IS NOT NULL AND w IS NOT NULL GROUP BY u)
        SELECT run, {sx} * u AS x, {sy} * w AS y FROM (
            SELECT *, min(w) OVER (ORDER BY u ROWS BETWEEN UNBOUNDED PRECEDING AND 1 PRECEDING) AS before FROM places)
        WHERE before IS NULL OR w < before ORDER BY u""")
