"""What a page shows: which charts answer the question for two columns, and the figures in them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import sqrt

from ...errors import UserError
from ...pages.numbers import evenly_spaced
from ..conditions import RowCondition
from ..database import Answer, Column, ColumnKind, Database
from .cells import FEWEST, Axis, CellStatistic, choose_statistic, divide_into_cells, plane
from .curves import PASSED, Boundary, boundary, curves
from .example_runs import ExampleRuns
from .packing import SEVERAL
from .pareto_front import better, front

MOST_X, MOST_Y = 160, 120  # cells of a map
MOST_BYTES = 1_500_000  # of the runs and cells of a page
CELL_BYTES = 90  # of a cell, and of its run without the values that vary
PLACE_BYTES, FULL_BYTES = 3, 11  # of a value that varies: its place in a list, or all its bits
MOST_GROUPS, CLASSES = 8, 5  # lines of a chart; of a column with more values, as many classes
MOST_SECTIONS = 6  # lines through a map
MOST_FRONT = 400  # points of a front that are drawn


@dataclass(frozen=True)
class Question:
    """What a user asks for, as the names of columns.

    Attributes:
        y: empty: how the values of x are distributed.
        colour: what the colours of the map show, or what the lines are for; empty: whether runs passed.
        amount: what is statistic of the runs in a cell: mean, min, max or count; empty: what suits the column.
        better: whether less or more of x and y is better: `x=min,y=max`; empty: less.
        beside: further results, drawn over x beside y.
        passed: the condition for a run to count as passed; empty: it met its scenario's expectations.
    """

    x: str
    y: str = ""
    colour: str = ""
    amount: str = ""
    better: str = ""
    comparisons: Sequence[str] = ()
    passed: str = ""


@dataclass
class View:
    """The answer: charts that are left out are None.

    Attributes:
        groups: what the lines of the boundary or of the curves are for.
        statistic: what the colours of the map show.
        boundary: a line for each group; `overall`: one for all runs together.
        curves: y over x; or, where y is varied, the coloured result over x.
        curved: the column that `curves` show.
        curve_groups: what the lines of `curves` are for.
        lines: results that are drawn beside y over x, as `curves` are.
        runs: how many `runs` there are; how many of them `passed`, are `refused`, have `no_x`, `no_y`, `no_value`.
        condition: what makes a run pass, None: the scenario's expectations; `condition_columns`: the columns in it.
        examples: the runs that stand for cells and points.
    """

    x: Axis
    y: Column
    groups: Axis | None
    statistic: CellStatistic
    runs: Mapping[str, int]
    condition: RowCondition | None = None
    condition_columns: Sequence[Column] = ()
    map_y: Axis | None = None
    cells: Answer | None = None
    boundary: Boundary | None = None
    overall: Boundary | None = None
    curves: Answer | None = None
    curved: Column | None = None
    curve_groups: Axis | None = None
    front: Answer | None = None
    front_size: int = 0
    better: Mapping[str, str] = field(default_factory=dict)
    lines: list[tuple[Column, Answer]] = field(default_factory=list)
    examples: ExampleRuns = field(default_factory=ExampleRuns)

    @property
    def columns(self) -> list[Column]:
        """The columns that the page speaks of."""
        return [c for c in (self.x.column, self.y, self.statistic.column, self.curved, *self.condition_columns) if c]


def build_view(db: Database, question: Question) -> View:
    """Answer a question with figures.

    Raises:
        UserError: a name is that of no column, or of one that cannot be shown so.
    """
    condition = RowCondition.read(question.passed) if question.passed else None
    if condition:
        db.apply_condition(condition)
    x, y = _number(db, "--x", question.x), _number(db, "--y", question.y)
    if x == y:
        raise UserError(f"--x and --y are both {x.name}: choose two columns")
    colour = db.column("--colour", question.colour or PASSED)
    if colour.kind is ColumnKind.LIST:
        raise UserError(f"--colour {colour.name}: this column has {colour.kind.value}")
    most_x, most_y = _most(db)
    along = divide_into_cells(db, x, "x", most_x)
    grouping = colour if colour.varied else _few(db, (x, y)) if y.varied else None
    groups = divide_into_cells(db, grouping, "groups", MOST_GROUPS, CLASSES) if grouping else None
    statistic = choose_statistic(db.columns[PASSED] if colour.varied else colour, question.amount)
    view = View(along, y, groups, statistic, _counts(db, x, y, statistic.column), condition)
    view.condition_columns = [db.columns[name] for name in condition.columns] if condition else []
    if y.kind is ColumnKind.NUMBER:
        view.map_y = divide_into_cells(db, y, "y", most_y)
        view.cells = plane(db, along, view.map_y, statistic)
        view.examples.add(view.cells["pick"])
    if x.varied and y.varied and y.kind is ColumnKind.NUMBER:
        _bound(db, view)
    if x.varied:
        _curve(db, view, colour)
    if question.better or not (x.varied or y.varied):
        _front(db, view, question.better)
    for name in question.comparisons:
        column = _number(db, "--beside", name)
        view.lines.append((column, curves(db, along, column, groups)))
    return view


def _number(db: Database, option: str, name: str) -> Column:
    column = db.column(option, name)
    if column.kind in (ColumnKind.TEXT, ColumnKind.LIST) or (option != "--y" and column.kind is not ColumnKind.NUMBER):
        raise UserError(f"{option} {name}: this column has {column.kind.value}; {option} takes one with numbers")
    return column


def _few(db: Database, used: Sequence[Column]) -> Column | None:
    """The first further column that is varied and has few values, for the lines of a chart."""
    for column in db.columns.values():
        if column.varied and column not in used:
            many = db.one(f"SELECT approx_count_distinct({column.sql}) AS n FROM runs")["n"]
            if 1 < many <= MOST_GROUPS:
                return column
    return None


def _most(db: Database) -> tuple[int, int]:
    """How many cells a map may have, so that the page stays small: the more columns vary, the fewer.

    The runs of the page stand for cells, for three lines of each group, and for the front; the sides of the map are
    `share` of the greatest ones, so that their number is cells share^2 + points share + MOST_FRONT."""
    varied = [column.sql for column in db.columns.values() if column.varied]
    counts = ", ".join(f"approx_count_distinct({name}) AS n{i}" for i, name in enumerate(varied))
    different = db.one(f"SELECT {counts} FROM runs")
    each = sum(FULL_BYTES if many >= SEVERAL else PLACE_BYTES for many in different.values())
    runs = max(0.0, MOST_BYTES / (CELL_BYTES + each) - MOST_FRONT)
    cells, points = MOST_X * MOST_Y, 3 * MOST_GROUPS * MOST_X
    share = (sqrt(points**2 + 4.0 * cells * runs) - points) / (2.0 * cells)
    return max(FEWEST, int(MOST_X * min(1.0, share))), max(FEWEST, int(MOST_Y * min(1.0, share)))


def _counts(db: Database, x: Column, y: Column, statistic: Column | None) -> dict[str, int]:
    has_number = f"({statistic.number})" if statistic and statistic.kind is ColumnKind.NUMBER else "1"
    counts = db.one(
        f"SELECT count(*) - count({x.number if x.kind is ColumnKind.NUMBER else x.sql}) AS no_x,"
        f" count(*) - count({y.number}) AS no_y, count(*) - count({has_number}) AS no_value FROM runs"
    )
    return count_runs(db) | {name: int(value) for name, value in counts.items()}


def count_runs(db: Database) -> dict[str, int]:
    """How many `runs` there are, how many of them `passed`, and how many are `refused`."""
    refused = "refusal <> ''" if "refusal" in db.columns else "false"
    counts = db.one(
        f"SELECT count(*) AS runs, count(*) FILTER ({PASSED}) AS passed, count(*) FILTER ({refused}) AS refused"
        " FROM runs"
    )
    return {name: int(value) for name, value in counts.items()}


def _bound(db: Database, view: View) -> None:
    view.boundary = boundary(db, view.x, view.y, view.groups)
    view.overall = boundary(db, view.x, view.y, None) if view.groups else view.boundary
    if view.boundary:
        view.examples.add(view.boundary.points["pick"], view.boundary.points["failed"])


def _curve(db: Database, view: View, colour: Column) -> None:
    """A result over x: y, or what the map is coloured by, if y is varied."""
    if not view.y.varied:
        view.curved, view.curve_groups = view.y, view.groups
    elif colour.kind is ColumnKind.NUMBER and not colour.varied:
        view.curved, view.curve_groups = colour, divide_into_cells(db, view.y, "sections", MOST_SECTIONS, CLASSES)
    else:
        return
    answer = curves(db, view.x, view.curved, view.curve_groups)
    if len(answer["cx"]):
        view.curves = answer
        view.examples.add(*(answer[name] for name in ("pick", "pick_least", "pick_greatest")))


def _front(db: Database, view: View, option: str) -> None:
    view.better = better(option, view.x.column.name, view.y.name)
    answer = front(db, view.x.column, view.y, view.better)
    view.front_size = len(answer["run"])
    drawn = evenly_spaced(view.front_size, MOST_FRONT)
    view.front = {name: values[drawn] for name, values in answer.items()}
    view.examples.add(view.front["run"])
