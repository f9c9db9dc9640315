"""The table [remote] of a scenario file: the clocks and telegrams by which a block sees its scripted axis."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from ...interface.roles import RemoteAxisVariables
from ..clocks import Clocks, Rate
from ..remote_view import Accuracy, RemoteView
from ..script import Script
from ..settings import Setting
from .keys import Key, TableKeys, number, whole
from .toml_tables import TomlTable

LISTS = ("sender_cycle",)  # the keys whose values are lists of tables
MOST_CYCLES = 1_000_000  # their results still fit into memory
MOST_JITTER = 0.15  # of a cycle: `clocks.LARGEST_JITTER` is three times as much, so it limits hardly any instant

REMOTE = TableKeys(
    "[remote]",
    "The true axis of a block that sees it by telegrams, instead of [master]: the keys of its script, and these.",
    (
        Key(
            "sender_cycle",
            "between two telegrams",
            "number in s, > 0, or a list { at, cycle }: from each time on, in s",
        ),
        number(
            "phase",
            "how long before 0 the first telegram is sent, in cycles of the sender",
            default=0.0,
            least=0.0,
            below=1.0,
        ),
        number(
            "jitter",
            "of sending and of receiving, one sigma, in cycles of the receiver",
            default=0.0,
            least=0.0,
            most=MOST_JITTER,
        ),
        whole("seed", "of the jitter", default=0),
        Key("lost", "telegrams that never arrive", "list of ranges [first, last]", "none"),
        whole("first_index", "index of the first telegram", default=0, most=65535),
        Key("accuracy", "how near to the truth the block has to be", "table", "not checked"),
    ),
)
RATE = TableKeys("sender_cycle", "", (number("at", "", "s"), number("cycle", "", "s", above=0.0)))
ACCURACY = TableKeys(
    "[remote.accuracy]",
    "How near to the truth the block has to be: index, position or both.",
    (
        number("from", "the time from which on this is checked", "s", least=0.0, note="up to stop_time"),
        number(
            "index",
            "corrected_cycle_index less the true index, peak to peak, in cycles of the sender",
            absent="not checked",
            least=0.0,
        ),
        number("position", "slave.position less the true axis", "u", absent="not checked", least=0.0),
        number("behind", "how many data cycles the slave is behind by design", default=0.0, least=0.0),
    ),
)


def read_remote(
    table: TomlTable,
    script: Script,
    axis: RemoteAxisVariables,
    values: Mapping[str, Any],
    settings: Iterable[Setting],
    stop_time: float,
) -> RemoteView:
    """How a block sees the scripted axis.

    `values`: the start values of the block's variables, with the lengths of its cycles and its first delay; `settings`:
    the later changes of the delay.

    Raises:
        UserError: the first mistake in the table.
    """
    cycle, data_cycle, delay = (values[name] for name in (axis.task_cycle, axis.data_cycle, axis.delay))
    rates = list(_read_rates(table))
    if max(stop_time / cycle, *(stop_time / rate.cycle for rate in rates)) > MOST_CYCLES:
        table.fail("", f"makes more than {MOST_CYCLES:,} cycles up to {stop_time:g}")
    first_index = REMOTE.value(table, "first_index", most=axis.wraps_at - 1)
    clocks = Clocks(
        cycle,
        rates,
        REMOTE.value(table, "phase"),
        REMOTE.value(table, "jitter"),
        REMOTE.value(table, "seed"),
        list(_read_lost(table, first_index)),
        first_index,
        axis.wraps_at,
    )
    later = ((s.at, s.values[axis.delay]) for s in settings if axis.delay in s.values)
    accuracy = _read_accuracy(table.table("accuracy"), stop_time) if "accuracy" in table else None
    delays = [(0.0, delay), *sorted(later)]
    return RemoteView(axis, script, clocks, clocks.count_cycles(stop_time), data_cycle or cycle, delays, accuracy)


def _read_rates(table: TomlTable) -> Iterator[Rate]:
    """The sender's cycles: one for ever, or each from a time on."""
    if not isinstance(table.values.get("sender_cycle"), list):
        yield Rate(0.0, table.number("sender_cycle", above=0.0))
        return
    last_at = -math.inf
    rates = table.tables("sender_cycle", "{ at = ..., cycle = ... }")
    if not rates:
        table.fail("sender_cycle", "is empty")
    for i, rate in enumerate(rates):
        RATE.check(rate)
        at = RATE.value(rate, "at", above=last_at)
        if i == 0 and at != 0.0:
            rate.fail("at", f"{at:g}: the first cycle is that from 0 on")
        yield Rate(at, RATE.value(rate, "cycle"))
        last_at = at


def _read_lost(table: TomlTable, first_index: int) -> Iterator[tuple[int, int]]:
    """Ranges of lost telegrams; the first one that is sent may be among them."""
    ranges = table.values.get("lost", [])
    if not isinstance(ranges, list):
        table.fail("lost", "must be a list of ranges [first, last]")
    for pair in ranges:
        if not isinstance(pair, list) or [type(x) for x in pair] != [int, int]:
            table.fail("lost", f"{pair!r} is not a range [first, last] of whole numbers")
        first, last = pair
        if last < first:
            table.fail("lost", f"[{first}, {last}] is backwards: the last is at least the first")
        if first < first_index:
            table.fail("lost", f"[{first}, {last}] is before the first telegram, {first_index}")
        yield first, last


def _read_accuracy(table: TomlTable, stop_time: float) -> Accuracy:
    ACCURACY.check(table)
    if not table.values.keys() & {"index", "position"}:
        table.fail("", "expects nothing: it needs index, position or both")
    begin = ACCURACY.value(table, "from", most=stop_time)
    return Accuracy(begin, *(ACCURACY.value(table, key) for key in ("index", "position", "behind")))
