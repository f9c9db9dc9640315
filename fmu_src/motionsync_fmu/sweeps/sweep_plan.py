"""The plan of a sweep: a scenario, what varies in it, and so the values of every run.

The runs are numbered from 0: all combinations of the grids, the last factor changing first, and at each of them every
sample of the ranges. The samples are the same at all points of the grid, so what differs between two points does not
come from sampling. The values of any runs are computed from their numbers alone: a plan of 10^9 runs needs no memory,
and the values do not depend on how the runs are cut into chunks.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from hashlib import sha256
from math import prod
from pathlib import Path
from typing import Any, Self, TypedDict, Unpack

import numpy as np
import tomli_w

from ..about import __version__
from ..errors import UserError, choose
from ..fmus.guid import compute_guid
from ..paths import replace_file
from ..scenario.files.toml_tables import read_file, read_toml
from ..scenario.scenario import Scenario
from ..scenario.variation.expressions import Array, Expression, sort_by_need
from ..scenario.variation.scenario_variation import ScenarioVariation, Target
from ..scenario.variation.values import Linear, Listed, Range, Values, read_values, split_setting
from .measures import check_measures
from .samples import Method, Samples, sampler

FILE = "plan.toml"
SCENARIO = "swept_scenario.toml"  # beside it: the scenario's file as it was; no search for scenarios finds this name
KEYS = ("motionsync", "guid", "scenario", "sha256", "samples", "method", "seed", "sampler", "chunk", "set", "measures")
SEARCH = "search"  # the table of a plan whose sweep is one round of a search
MOST_RUNS = 10**9  # that need no confirmation
LARGEST = 2**53  # runs, and seeds: whole numbers that the plan's file keeps exactly
WORDS = {  # for the description of a difference
    "version": "motionsync",
    "guid": "the FMU's GUID",
    "sampler": "scipy",
    "samples": "the number of samples",
    "measures": "--measure",
}
PROBES = 8  # runs whose values are tried before a sweep
HEAD = "# The plan of a sweep; swept_scenario.toml beside it is the scenario's file as it was. Written by motionsync.\n"


class SamplingOptions(TypedDict, total=False):
    """How a sweep samples its ranges, and what it measures.

    Attributes:
        samples: how many samples ranges have; None: there are no ranges.
        method: how ranges are sampled, `"lhs"` or `"sobol"`.
        seed: the seed of the samples.
        measures: figures of outputs over a whole run, their kinds by the names of the outputs.
        yes: start even if there are more than 10^9 runs.
    """

    samples: int | None
    method: str
    seed: int
    measures: Mapping[str, str | Sequence[str]] | None
    yes: bool


@dataclass(frozen=True)
class Factor:
    """What a sweep varies, or what follows from that.

    Attributes:
        name: the name in the scenario, as the user writes it; it is the name of a column, too.
        text: `start:stop:count`, `first:last`, `a,b,c`, `low..high`, a value or an expression.
    """

    name: str
    text: str

    def __str__(self) -> str:
        return f"{self.name}={self.text}"


@dataclass(frozen=True)
class SweepPlan:
    """What a sweep does.

    Attributes:
        file: the scenario's file.
        text: what it has in it; so a computer without the file can run it.
        factors: what varies, and what follows by expressions, in the order of the columns.
        samples: the number of samples of the ranges; 0 without ranges.
        method: how the ranges are sampled.
        seed: the seed of the samples.
        measures: the kinds of measures by the names of outputs.
        chunk: how many runs a part file has; 0: that is not decided yet.
        version: the version of motionsync.
        guid: that of the FMU that runs.
        sampler: the version of scipy, which makes the samples; empty without ranges.
    """

    file: Path
    text: str = field(repr=False)
    factors: tuple[Factor, ...]
    samples: int = 0
    method: Method = Method.LHS
    seed: int = 0
    measures: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    chunk: int = 0
    version: str = __version__
    guid: str = ""
    sampler: str = ""

    @classmethod
    def of(cls, file: Path, settings: Iterable[str], *, chunk: int = 0, **options: Unpack[SamplingOptions]) -> Self:
        """The plan for a scenario's file and settings `NAME=VALUES`.

        Raises:
            UserError: the file, a setting, or what they make together is refused.
        """
        return cls.of_variation(ScenarioVariation.of_file(file), settings, chunk=chunk, **options)

    @classmethod
    def of_variation(
        cls,
        variation: ScenarioVariation,
        settings: Iterable[str],
        *,
        chunk: int = 0,
        **options: Unpack[SamplingOptions],
    ) -> Self:
        """The plan for a scenario that is read already, and settings `NAME=VALUES`.

        Raises:
            UserError: a setting, or what they make together is refused.
        """
        factors = tuple(Factor(*split_setting(setting)) for setting in settings)
        samples = options.get("samples")
        method = choose({str(m): m for m in Method}, options.get("method", Method.LHS), "method")
        plan = cls(variation.file, variation.text, factors, samples or 0, method, options.get("seed", 0), chunk=chunk)
        vars(plan)["variation"] = variation
        recipe = variation.scenario.recipe
        plan = plan.with_fields(measures=check_measures(options.get("measures") or {}, recipe))
        plan._check(samples, options.get("yes", False))
        return plan.with_fields(guid=compute_guid(recipe), sampler=sampler() if plan._ranges else "")

    def with_fields(self, **changes: Any) -> Self:
        """This plan with other values of some fields, of the same scenario, which is not read again."""
        plan = replace(self, **changes)
        vars(plan)["variation"] = self.variation
        return plan

    @property
    def sha256(self) -> str:
        """The SHA-256 of the scenario's text."""
        return sha256(self.text.encode()).hexdigest()

    @cached_property
    def runs(self) -> int:
        """How many runs there are."""
        return prod(grid.count for grid in self._grids.values()) * max(self.samples, 1)

    def values(self, first: int, last: int) -> dict[str, Array]:
        """The values of the runs from `first` to below `last`, by the names of the factors; each of shape (runs,).

        Real variables and numbers of the script are float64, Integers int64, Booleans bool, members of enumerations
        texts; what follows by arithmetic is float64.

        Raises:
            UserError: there are no such runs, or they are sampled by another version of scipy.
        """
        if not 0 <= first <= last <= self.runs:
            raise UserError(f"there are no runs {first} to {last - 1}: the sweep has those from 0 to {self.runs - 1}")
        runs = np.arange(first, last, dtype=np.int64)
        point = runs // max(self.samples, 1)
        columns: dict[str, Array] = {}
        for name, grid in reversed(self._grids.items()):
            columns[name] = grid.at(point % grid.count)
            point //= grid.count
        if self._ranges:
            shares = self._shares(first, last)
            columns |= {name: r.at(shares[:, i]) for i, (name, r) in enumerate(self._ranges.items())}
        return self._complete(columns, len(runs))

    def complete(self, given: Mapping[str, Array]) -> dict[str, Array]:
        """The values of runs with other values of the factors than those of the plan; each of shape (runs,).

        `given`: those of all factors; of what follows by expressions they are computed anew."""
        own = {name: values for name, values in given.items() if name not in self._derived_names}
        return self._complete(own, len(next(iter(given.values()))))

    def _complete(self, columns: dict[str, Array], runs: int) -> dict[str, Array]:
        """The values of all factors; `columns`: of those that do not follow by expressions."""
        for name in self._derived_names:
            expression, sources = self._values[name], self._sources[name]
            assert isinstance(expression, Expression)
            given = {n: columns[s] if isinstance(s, str) else s for n, s in sources.items()}
            columns[name] = np.array(np.broadcast_to(expression.values(given), runs))
        return {factor.name: columns[factor.name] for factor in self.factors}

    def scenario(self, run: int) -> Scenario:
        """The scenario of one run.

        Raises:
            UserError: there is no such run, or the scenario's reader refuses its values; the message has the run.
        """
        scenario = self.scenarios(run, run + 1)[0]
        if isinstance(scenario, UserError):
            raise scenario
        return scenario

    def scenarios(self, first: int, last: int) -> list[Scenario | UserError]:
        """The scenarios of the runs from `first` to below `last`, or the errors of those that the reader refuses."""
        scenarios = self.scenarios_with(self.values(first, last))
        return [UserError(f"run {i}: {s}") if isinstance(s, UserError) else s for i, s in enumerate(scenarios, first)]

    def scenarios_with(self, values: Mapping[str, Array]) -> list[Scenario | UserError]:
        """The scenarios of runs with these values of all factors, or the errors of those that the reader refuses."""
        targets = [self._targets[name] for name in values]
        scenarios: list[Scenario | UserError] = []
        for of_run in zip(*(column.tolist() for column in values.values()), strict=True):
            try:
                scenarios.append(self.variation.with_values(zip(targets, of_run, strict=True)))
            except UserError as e:
                scenarios.append(e)
        return scenarios

    def differs(self, other: "SweepPlan") -> str:
        """What this plan has otherwise than the other one, in one sentence; empty if both give the same rows.

        The size of the chunks makes no difference to the rows."""
        mine, others = ({f.name: f.text for f in plan.factors} for plan in (self, other))
        differences = [] if self.text == other.text else ["the scenario's file is not the same"]
        changed = [name for name, text in mine.items() if text != others.get(name)]
        differences += [_describe_difference(name, mine[name], others.get(name, "")) for name in changed]
        differences += [f"{name} does not vary" for name in others if name not in mine]
        if not differences and [*mine] != [*others]:
            differences = [f"the order is {', '.join(mine)}, not {', '.join(others)}"]
        for what in ("samples", "method", "seed", "measures", "version", "guid", "sampler"):
            if (own := getattr(self, what)) != (other_value := getattr(other, what)):
                differences.append(_describe_difference(WORDS.get(what, what), _to_text(own), _to_text(other_value)))
        return "; ".join(differences)

    def write(self, folder: Path, **others: Mapping[str, Any]) -> None:
        """Write `plan.toml` and a copy of the scenario's file; `others`: further tables by name.

        Raises:
            UserError: they cannot be written.
        """
        plan = HEAD + tomli_w.dumps(self._tables() | others)
        try:
            for name, text in ((SCENARIO, self.text), (FILE, plan)):  # who finds the plan finds both
                with replace_file(folder / name) as part:
                    part.write_text(text, "utf-8", newline="\n")
        except OSError as e:
            raise UserError(f"{folder}: the plan cannot be written: {e}") from None

    @classmethod
    def read(cls, folder: Path, *others: str) -> Self:
        """The plan in a folder; `others`: the names of further tables in its file, which are not read.

        Raises:
            UserError: there is none, or it is damaged.
        """
        top = read_toml(folder / FILE)
        if SEARCH in top and SEARCH not in others:
            raise UserError(f"{folder} is the folder of a search, not of a sweep")
        top.allow_only(*KEYS, *others)
        text = read_file(folder / SCENARIO)
        settings, measures = top.table("set"), top.table("measures", required=False)
        plan = cls(
            Path(top.string("scenario")),
            text,
            tuple(Factor(name, settings.string(name)) for name in settings.values),
            top.whole("samples"),
            choose({str(m): m for m in Method}, top.string("method"), "method"),
            top.whole("seed"),
            {name: measures.strings(name) for name in measures.values},
            top.whole("chunk"),
            top.string("motionsync"),
            top.string("guid"),
            top.string("sampler"),
        )
        if plan.sha256 != top.string("sha256"):
            top.fail("sha256", f"{SCENARIO} beside the plan has changed")
        return plan

    def _tables(self) -> dict[str, Any]:
        return {
            "motionsync": self.version,
            "guid": self.guid,
            "scenario": self.file.resolve().as_posix(),
            "sha256": self.sha256,
            "samples": self.samples,
            "method": str(self.method),
            "seed": self.seed,
            "sampler": self.sampler,
            "chunk": self.chunk,
            "set": {factor.name: factor.text for factor in self.factors},
            "measures": {name: list(kinds) for name, kinds in self.measures.items()},
        }

    def __getstate__(self) -> dict[str, Any]:
        """What another process needs: not what this one has computed."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    @cached_property
    def variation(self) -> ScenarioVariation:
        """The scenario and what may vary in it."""
        return ScenarioVariation(self.text, self.file)

    @cached_property
    def _targets(self) -> dict[str, Target]:
        """What each factor's name means."""
        factor_by_path: dict[Any, Factor] = {}
        targets: dict[str, Target] = {}
        for factor in self.factors:
            with _name_factor_in_errors(factor):
                targets[factor.name] = self.variation.target(factor.name)
            for path in targets[factor.name].paths:
                if before := factor_by_path.get(path):
                    same = "is given twice" if before.name == factor.name else f"is {before.name}, too"
                    raise UserError(f"{factor}: {factor.name} {same}, as {before}")
                factor_by_path[path] = factor
        return targets

    @cached_property
    def _values(self) -> dict[str, Values]:
        """The values or the expression of each factor, by its name."""
        values_by_name: dict[str, Values] = {}
        for factor in self.factors:
            target = self._targets[factor.name]
            with _name_factor_in_errors(factor):
                values_by_name[factor.name] = read_values(factor.text, target.kind)
        return values_by_name

    @property
    def independent(self) -> tuple[str, ...]:
        """The names of the factors that vary by themselves, with more than one value."""
        return tuple(
            name
            for name, values in self._values.items()
            if isinstance(values, Range) or (isinstance(values, Linear | Listed) and values.count > 1)
        )

    @property
    def _grids(self) -> dict[str, Linear | Listed]:
        return {name: v for name, v in self._values.items() if isinstance(v, Linear | Listed)}

    @property
    def _ranges(self) -> dict[str, Range]:
        return {name: v for name, v in self._values.items() if isinstance(v, Range)}

    @cached_property
    def _sources(self) -> dict[str, dict[str, str | Array]]:
        """For each expression, by the names in it: the factor of this meaning, or the value that does not vary."""
        name_by_path = {path: name for name, target in self._targets.items() for path in target.paths}
        sources: dict[str, dict[str, str | Array]] = {}
        for factor in self.factors:
            if isinstance(expression := self._values[factor.name], Expression):
                with _name_factor_in_errors(factor):
                    sources[factor.name] = {n: self._source(n, factor.text, name_by_path) for n in expression.names}
        return sources

    def _source(self, name: str, text: str, name_by_path: Mapping[Any, str]) -> str | Array:
        """Where the values of a name in an expression come from; `text`: the whole expression."""
        if name in self._targets:
            return name
        try:
            target = self.variation.target(name)
        except UserError as e:
            raise UserError(f"{name!r} is no number, and {e}" if name == text else str(e)) from None
        if factor := next((name_by_path[path] for path in target.paths if path in name_by_path), ""):
            return factor
        if target.present is None:
            raise UserError(f"{name} has no value in the scenario")
        present = target.present
        return np.asarray(float(present) if type(present) is int else present)

    @cached_property
    def _derived_names(self) -> list[str]:
        """The names of what follows by expressions, each after those that it needs."""
        needed = {name: [s for s in sources.values() if isinstance(s, str)] for name, sources in self._sources.items()}
        return [name for name in sort_by_need(needed) if name in needed]

    def _shares(self, first: int, last: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The samples that belong to runs, as shares of the ranges; shape (runs, ranges)."""
        if self.sampler and self.sampler != sampler():
            raise UserError(f"the samples of this sweep are made by scipy {self.sampler}, and here is {sampler()}")
        samples = Samples(self.method, self.samples, len(self._ranges), self.seed)
        if last - first >= self.samples:
            return samples.points(0, self.samples)[np.arange(first, last) % self.samples]
        begin, count = first % self.samples, last - first
        points = samples.points(begin, min(begin + count, self.samples))
        more = begin + count - self.samples
        return np.concatenate([points, samples.points(0, more)]) if more > 0 else points

    def _check(self, samples: int | None, yes: bool) -> None:
        """Refuse what makes no sweep; `samples`: None: not given."""
        if not self.factors:
            raise UserError("a sweep varies something: give --set NAME=VALUES, as in: --set master.velocity=200:400:11")
        if self._ranges and samples is None:
            raise UserError(f"{next(iter(self._ranges))} has a range, which is sampled: say how often with --samples")
        if samples is not None and not self._ranges:
            raise UserError(f"--samples {samples}: no factor has a range to be sampled, as in NAME=low..high")
        if samples is not None and samples < 1:
            raise UserError(f"--samples {samples} is not allowed: it must be >= 1")
        if not 0 <= self.seed <= LARGEST:
            raise UserError(f"--seed {self.seed} is not allowed: it must be 0 to {LARGEST}")
        if self.chunk < 0:
            raise UserError(f"a chunk of {self.chunk} runs is not allowed: it must be >= 1, or 0 to be found out")
        if refusal := Samples(self.method, self.samples, len(self._ranges), self.seed).refusal:
            raise UserError(f"--samples {samples}: {refusal}")
        if self.runs > LARGEST:
            raise UserError(f"the sweep has more than {LARGEST:,} runs, which are the most that can be numbered")
        if self.runs > MOST_RUNS and not yes:
            raise UserError(f"the sweep has {self.runs:,} runs; more than {MOST_RUNS:,} need --yes")
        self._probe()

    def _probe(self) -> None:
        """Refuse values of which the reader takes none: then they are a mistake, and not the edge of what works."""
        each = max(self.samples, 1)
        points = self.runs // each
        refused = []
        for i in range(PROBES):
            scenario = self.scenarios(run := i * points // PROBES * each + min(i, each - 1), run + 1)[0]
            if not isinstance(scenario, UserError):
                return
            refused.append(scenario)
        raise refused[0]


@contextmanager
def _name_factor_in_errors(factor: Factor) -> Iterator[None]:
    """Put a factor before the message of a mistake in it."""
    try:
        yield
    except UserError as e:
        raise UserError(f"{factor}: {e}") from None


def _describe_difference(what: str, mine: str, others: str) -> str:
    """That something is as this plan has it, and not as the other one."""
    return f"{what} is {mine or 'none'}, not {others or 'none'}" if mine or others else ""


def _to_text(value: object) -> str:
    if isinstance(value, Mapping):
        return " ".join(f"{name}={','.join(kinds)}" for name, kinds in value.items())
    return str(value)
