"""Measures: figures of a block's variables over whole runs, which the loop keeps step by step (`reduce.c`).

Measures need memory for each instance, not for each step. Only the ends of steps count, not the values after the
initialization. The time is that of the end of a step, 0 where the run begins; h is the length of a step.

| kind | meaning |
| --- | --- |
| `last` | the value at the end of the last step |
| `min`, `max` | the least, the greatest value; of equal ones the first |
| `min_time`, `max_time` | when it was there first |
| `mean`, `rms` | sum(x h) / sum(h); the root of sum(x x h) / sum(h); summed in the order of the steps |
| `rises` | the number of steps at whose end x > 0.5 while it was not before the step |
| `above:LIMIT` | sum(h) of the steps at whose end x > LIMIT |
| `every:N` | the values at the end of each N-th step |

The structures here have the layout of those in `reduce.h`."""

from collections.abc import Iterable, Mapping, Sequence
from ctypes import Structure, addressof, c_double, c_int64, c_void_p
from math import isfinite, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import UserError, choose
from ...interface.variables import Variable, variables
from ..memory_layout import dtype, offset

Reals = NDArray[np.float64]
Reduce = Mapping[str, str | Sequence[str]]  # variable to kinds

PLAIN = ("last", "min", "max", "min_time", "max_time", "mean", "rms", "rises")
NUMBERED = {"above": "above:LIMIT", "every": "every:N"}


class Measure(NamedTuple):
    """One kind of measure of one variable.

    Attributes:
        kind: the kind as it was given, `above:500` say.
        of: the kind without its number.
        number: of `above` and `every`; else NaN.
    """

    variable: Variable
    kind: str
    of: str
    number: float

    @property
    def name(self) -> str:
        return f"{self.variable.name}.{self.kind}"


def measures(known: Mapping[str, Variable], reduce: Reduce, block_name: str) -> list[Measure]:
    """What is asked for, in that order.

    Raises:
        UserError: an unknown variable or kind, a number that is missing or not allowed, or the same measure twice.
    """
    found: dict[str, Measure] = {}
    for name, kinds in reduce.items():
        variable = choose(known, name, f"variable of {block_name}")
        for kind in [kinds] if isinstance(kinds, str) else kinds:
            measure = _measure(variable, kind)
            if measure.name in found:
                raise UserError(f"{name}: the measure {kind} is given 2 times: it must be given once")
            found[measure.name] = measure
    return list(found.values())


def _measure(variable: Variable, kind: str) -> Measure:
    of, _, number = kind.partition(":")
    if kind in PLAIN:
        return Measure(variable, kind, of, nan)
    if of not in NUMBERED:
        there_is = ", ".join([*PLAIN, *NUMBERED.values()])
        raise UserError(f"{variable.name}: no measure is named {kind!r}; there is {there_is}")
    try:
        value = float(number)
    except ValueError:
        value = nan
    if not isfinite(value) or (of == "every" and not (value >= 1.0 and value.is_integer())):
        allowed = "a whole number >= 1, as in every:10" if of == "every" else "a finite number, as in above:500"
        raise UserError(f"{variable.name}: the measure {kind!r} is not allowed: after the colon it must have {allowed}")
    return Measure(variable, kind, of, value)


class _Table(Structure):
    _fields_ = (("rows", c_void_p), ("count", c_int64))


class _Reading(Structure):
    _fields_ = (("offset", c_int64), ("column", c_int64))


class _Figure(Structure):
    _fields_ = (("value", c_int64), ("to", c_int64), ("also", c_int64), ("limit", c_double))


class _Series(Structure):
    _fields_ = tuple((name, c_int64) for name in ("value", "address", "per_instance", "n", "steps", "count"))


class _Reductions(Structure):
    _fields_ = (
        ("before", _Table * 3),
        ("last", _Table * 3),
        ("minima", _Table),
        ("maxima", _Table),
        ("elapsed", c_int64),
        ("sums", _Table),
        ("squares", _Table),
        ("rare", c_int64),
        ("rises", _Table),
        ("above", _Table),
        ("series", _Table),
    )


class Reductions:
    """The measures of some instances of a block, while they run and afterwards.

    Attributes:
        measures: what is asked for.
        in_c: the tables that `reduce_begin` and `reduce_step` read; they hold the addresses of this object's arrays.
    """

    def __init__(self, block_type: type[Any], reduce: Reduce, instances: int, steps: int = 0) -> None:
        """`steps`: their number, which `every` alone needs.

        Raises:
            UserError: `reduce` is not as it must be, as `measures` tells.
        """
        block = block_type()
        self.measures = measures({v.name: v for v in variables(block)}, reduce, block_type.__name__)
        self._layout = dtype(block)
        self._instances, self._steps = instances, steps
        self._columns: dict[str, Reals] = {}
        self._tables: list[Any] = []  # keeps them alive
        self.in_c = self._in_c()

    def results(self, failed: Iterable[int] = ()) -> dict[str, Reals]:
        """The measures by `variable.kind`, each of shape (instances,), or (instances, steps // N) for `every:N`.

        Without a step, times, extremes, means and the last value are NaN. `failed`: the instances that failed. Their
        measures are NaN; `every` has NaN from the step on at which they failed."""
        places = list(failed)
        results = {m.name: self._result(m) for m in self.measures}
        for m in self.measures:
            if m.of != "every":
                results[m.name][places] = nan
        return results

    def _result(self, m: Measure) -> Reals:
        column = self._columns[m.name]
        if m.of not in ("mean", "rms"):
            return column
        elapsed = self._columns["elapsed"]
        mean: Reals = np.divide(column, elapsed, out=np.full(self._instances, nan), where=elapsed > 0.0)
        return np.sqrt(mean, out=mean) if m.of == "rms" else mean

    def _in_c(self) -> Any:
        values = {m.variable.name: m.variable for m in self.measures}
        rises, above, every = self._of("rises"), self._of("above"), self._of("every")
        sums, squares = self._of("mean"), self._of("rms")
        return _Reductions(
            before=self._readings((m.variable for m in rises), "before"),
            last=self._readings(values.values(), "last"),
            minima=self._extremes("min"),
            maxima=self._extremes("max"),
            elapsed=self._column("elapsed", 0.0) if sums or squares else 0,
            sums=self._figures((m, self._column(m.name, -0.0), 0) for m in sums),
            squares=self._figures((m, self._column(m.name, -0.0), 0) for m in squares),
            rare=int(bool(rises or above or every)),
            rises=self._figures(
                (m, self._column(m.name, 0.0), self._column(f"{m.variable.name}.before")) for m in rises
            ),
            above=self._figures((m, self._column(m.name, 0.0), 0) for m in above),
            series=self._table(_Series, map(self._series, every)),
        )

    def _of(self, *kinds: str) -> list[Measure]:
        return [m for m in self.measures if m.of in kinds]

    def _column(self, name: str, begin: float = nan) -> int:
        """The address of the column of that name, whose numbers begin with that value."""
        if name not in self._columns:
            self._columns[name] = np.full(self._instances, begin)
        return self._columns[name].ctypes.data

    def _readings(self, of: Iterable[Variable], column: str) -> tuple[_Table, ...]:
        """What to read of the block: Reals; Integers and enumerations; Booleans."""
        chosen = list(of)
        return tuple(
            self._table(
                _Reading,
                ((offset(self._layout, v.name), self._column(f"{v.name}.{column}")) for v in chosen if v.kind in kinds),
            )
            for kinds in (("Real",), ("Integer", "Enumeration"), ("Boolean",))
        )

    def _extremes(self, kind: str) -> _Table:
        """One for each variable, whether the extreme is asked for or its time."""
        chosen = {m.variable.name: m for m in self._of(kind, f"{kind}_time")}
        columns = ((m, f"{name}.{kind}") for name, m in chosen.items())
        return self._figures((m, self._column(c), self._column(f"{c}_time")) for m, c in columns)

    def _figures(self, columns: Iterable[tuple[Measure, int, int]]) -> _Table:
        rows = ((self._column(f"{m.variable.name}.last"), to, also, m.number) for m, to, also in columns)
        return self._table(_Figure, rows)

    def _series(self, m: Measure) -> tuple[int, ...]:
        n, name = int(m.number), m.variable.name
        values = self._columns[m.name] = np.full((self._instances, self._steps // n), nan)
        counts = (self._column(f"{m.name}.{what}", 0.0) for what in ("steps", "count"))
        return self._column(f"{name}.last"), values.ctypes.data, values.strides[0], n, *counts

    def _table(self, kind: type[Structure], rows: Iterable[tuple[Any, ...]]) -> _Table:
        table = [kind(*row) for row in rows]
        array = (kind * len(table))(*table)
        self._tables.append(array)
        return _Table(addressof(array), len(table))
