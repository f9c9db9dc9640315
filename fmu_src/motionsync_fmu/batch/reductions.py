"""Measures: figures of a block's variables over whole runs, which are updated while the loop runs (`reduce.c`).

Measures need memory for each instance, not for each step. The values at the ends of steps count, not those after the
initialization. The time is that of the end of a step, 0 where the run starts; h is the length of a step.

| kind | meaning |
| --- | --- |
| `initial` | the value after the initialization |
| `last` | the value at the end of the last step |
| `min`, `max` | the least, the greatest value; of equal ones the first |
| `min_time`, `max_time` | when it was there first |
| `first`, `first_time` | the first value that is not 0, or 0; when it was there, or NaN |
| `mean`, `rms` | sum(x h) / sum(h); the root of sum(x x h) / sum(h); summed in the order of the steps |
| `rises` | the number of steps at whose end x > 0.5 while it was not before the step |
| `above:LIMIT` | sum(h) of the steps at whose end x > LIMIT |
| `every:N` | the values at the end of each N-th step |

The structures here have the layout of those in `reduce.h`."""

from collections.abc import Iterable, Mapping, Sequence
from ctypes import Structure, addressof, c_double, c_int64, c_void_p
from itertools import chain
from math import isfinite, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.memory_layout import offset
from ..errors import UserError, choose
from ..interface.recipe import declared_variables
from ..interface.variables import Variable
from .block_description import start_memory
from .result_arrays import new_array

Reals = NDArray[np.float64]
Reduce = Mapping[str, str | Sequence[str]]  # variable to kinds

PLAIN = ("initial", "last", "min", "max", "min_time", "max_time", "first", "first_time", "mean", "rms", "rises")
NUMBERED = {"above": "above:LIMIT", "every": "every:N"}

MOST = 1e15  # of every:N; doubles count further than that

SAMPLES = 256  # as in C
GROUPS = ("Real",), ("Integer", "Enumeration"), ("Boolean",)  # read in different ways
FIRST_ROWS = ("times", "lengths")  # of the samples


class Measure(NamedTuple):
    """One kind of measure of one variable.

    Attributes:
        kind: the kind as it was given, `above:500` say.
        base_kind: the kind without its number.
        number: of `above` and `every`; else NaN.
    """

    variable: Variable
    kind: str
    base_kind: str
    number: float

    @property
    def name(self) -> str:
        return f"{self.variable.name}.{self.kind}"


def parse_measures(variables: Mapping[str, Variable], reduce: Reduce, block_name: str) -> list[Measure]:
    """The measures that are requested, in that order.

    Raises:
        UserError: an unknown variable or kind, a number that is missing or not allowed, or the same measure twice.
    """
    measures: dict[str, Measure] = {}
    for name, kinds in reduce.items():
        variable = choose(variables, name, f"variable of {block_name}")
        for kind in [kinds] if isinstance(kinds, str) else kinds:
            measure = _parse_measure(variable, kind)
            if measure.name in measures:
                raise UserError(f"{name}: the measure {kind} is given 2 times: it must be given once")
            measures[measure.name] = measure
    return list(measures.values())


def _parse_measure(variable: Variable, kind: str) -> Measure:
    base_kind, _, number = kind.partition(":")
    if kind in PLAIN:
        return Measure(variable, kind, base_kind, nan)
    if base_kind not in NUMBERED:
        available = ", ".join([*PLAIN, *NUMBERED.values()])
        raise UserError(f"{variable.name}: no measure is named {kind!r}; there is {available}")
    try:
        value = float(number)
    except ValueError:
        value = nan
    if not isfinite(value) or (base_kind == "every" and not (1.0 <= value <= MOST and value.is_integer())):
        allowed = (
            "a whole number of 1 to 1e15, as in every:10"
            if base_kind == "every"
            else "a finite number, as in above:500"
        )
        raise UserError(f"{variable.name}: the measure {kind!r} is not allowed: after the colon it must have {allowed}")
    return Measure(variable, kind, base_kind, value)


class Table(Structure):
    """The address and the number of rows, as C has all tables of the loop."""

    _fields_ = (("rows", c_void_p), ("count", c_int64))


class _Figure(Structure):
    _fields_ = (("row", c_int64), ("column", c_int64), ("second", c_int64), ("limit", c_double))


class _EveryNth(Structure):
    _fields_ = tuple((name, c_int64) for name in ("row", "address", "per_instance", "n", "steps", "count"))


class _Reductions(Structure):
    _fields_ = (
        ("offsets", Table * 3),
        ("initial", Table),
        ("last", Table),
        ("minima", Table),
        ("maxima", Table),
        ("first", Table),
        ("sums", Table),
        ("squares", Table),
        ("above", Table),
        ("elapsed", c_int64),
        ("rises", Table),
        ("series", Table),
    )


class Reductions:
    """The measures of some instances of a block, while they run and afterwards.

    Attributes:
        measures: those that are requested.
        c_tables: the tables that the functions of `reduce.h` read; they hold the addresses of this object's arrays.
    """

    def __init__(self, block_type: type, reduce: Reduce, instances: int, steps: int | None = None) -> None:
        """`steps`: of each instance, if they have the same number; `every` is not allowed otherwise.

        Raises:
            UserError: `reduce` is not allowed (see `parse_measures`), or its results do not fit into memory.
        """
        self.measures = parse_measures(declared_variables(block_type), reduce, block_type.__name__)
        self._layout = start_memory(block_type).dtype
        self._instances, self._steps = instances, steps
        kinds = {m.variable.name: m.variable.kind for m in self.measures}
        self._groups = [[name for name, kind in kinds.items() if kind in group] for group in GROUPS]
        self._rows = {name: row for row, name in enumerate(chain(*self._groups), len(FIRST_ROWS))}
        self._columns: dict[str, Reals] = {}
        self._tables: list[Any] = []  # so that they live as long as this object
        self.c_tables = self._make_c_tables()

    def samples(self) -> Reals:
        """Memory for the samples of one instance at a time; each thread needs one of its own."""
        return np.empty((len(FIRST_ROWS) + len(self._rows), SAMPLES))

    def results(self, failed: Iterable[int] = ()) -> dict[str, Reals]:
        """The measures by `variable.kind`, each of shape (instances,), or (instances, steps // N) for `every:N`.

        Without a step, `rises`, `above` and `first` are 0, and all others but `initial` are NaN. `failed`: the
        instances that failed. Their measures are NaN; `every` has NaN from the step on at which they failed."""
        indices = list(failed)
        results = {m.name: self._result(m) for m in self.measures}
        for m in self.measures:
            if m.base_kind != "every":
                results[m.name][indices] = nan
        return results

    def _result(self, m: Measure) -> Reals:
        column = self._columns[m.name]
        if m.base_kind not in ("mean", "rms"):
            return column
        elapsed = self._columns["elapsed"]
        mean: Reals = np.divide(column, elapsed, out=np.full(self._instances, nan), where=elapsed > 0.0)
        return np.sqrt(mean, out=mean) if m.base_kind == "rms" else mean

    def _make_c_tables(self) -> Any:
        return _Reductions(
            offsets=tuple(map(self._offsets, self._groups)),
            initial=self._initial(),
            last=self._figures("last"),
            minima=self._timed("min"),
            maxima=self._timed("max"),
            first=self._timed("first", start=0.0),
            sums=self._figures("mean", start=-0.0),  # -0.0 + x is x, also for -0.0
            squares=self._figures("rms", start=-0.0),
            above=self._figures("above", start=0.0),
            elapsed=self._column("elapsed", 0.0) if self._select_measures("mean", "rms") else 0,
            rises=self._rises(),
            series=self._table(_EveryNth, map(self._series, self._select_measures("every"))),
        )

    def _select_measures(self, *kinds: str) -> list[Measure]:
        return [m for m in self.measures if m.base_kind in kinds]

    def _column(self, name: str, start: float = nan) -> int:
        """The address of the column of that name, whose numbers start with that value."""
        if name not in self._columns:
            self._columns[name] = new_array(name, (self._instances,), "run fewer instances at a time")
            self._columns[name].fill(start)
        return self._columns[name].ctypes.data

    def _offsets(self, names: Iterable[str]) -> Table:
        """The offsets of variables in the block's memory."""
        return self._table(c_int64, ((offset(self._layout, name),) for name in names))

    def _initial(self) -> Table:
        """The values after the initialization: for `initial`, and for an edge of `rises` in the first step."""
        names = [m.variable.name for m in self._select_measures("rises")]
        columns = [(m.variable.name, m.name) for m in self._select_measures("initial")]
        columns += [(name, f"{name}.before") for name in names]
        return self._table(_Figure, (self._figure(name, column) for name, column in columns))

    def _figures(self, base_kind: str, start: float = nan) -> Table:
        """All measures of a kind."""
        return self._table(
            _Figure,
            (self._figure(m.variable.name, m.name, start, limit=m.number) for m in self._select_measures(base_kind)),
        )

    def _rises(self) -> Table:
        names = (m.variable.name for m in self._select_measures("rises"))
        return self._table(_Figure, (self._figure(n, f"{n}.rises", 0.0, f"{n}.before") for n in names))

    def _timed(self, kind: str, start: float = nan) -> Table:
        """A figure with its time, for each variable of which one of the two is requested."""
        names = dict.fromkeys(m.variable.name for m in self._select_measures(kind, f"{kind}_time"))
        return self._table(_Figure, (self._figure(n, f"{n}.{kind}", start, f"{n}.{kind}_time") for n in names))

    def _figure(
        self, name: str, column: str, start: float = nan, second: str = "", limit: float = nan
    ) -> tuple[int, int, int, float]:
        """What is stored of a variable in a column, whose numbers start with that value, and in a second one."""
        return self._rows[name], self._column(column, start), self._column(second) if second else 0, limit

    def _series(self, m: Measure) -> tuple[int, ...]:
        n, steps = int(m.number), self._steps
        if steps is None:
            raise UserError(f"{m.variable.name}: the measure {m.kind!r} is not allowed: the runs differ in their steps")
        values = new_array(m.name, (self._instances, steps // n), "choose a greater N")
        values.fill(nan)
        self._columns[m.name] = values
        counts = (self._column(f"{m.name}.{what}", 0.0) for what in ("steps", "count"))
        return self._rows[m.variable.name], values.ctypes.data, values.strides[0], n, *counts

    def _table(self, kind: Any, rows: Iterable[tuple[Any, ...]]) -> Table:
        table = [kind(*row) for row in rows]
        array = (kind * len(table))(*table)
        self._tables.append(array)
        return Table(addressof(array), len(table))
