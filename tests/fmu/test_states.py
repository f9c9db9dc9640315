"""The FMU states of the native flavour: restored, copied, serialized, damaged and forged."""

import ctypes
import math
import struct
import time
from ctypes import byref, c_void_p
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.compiler.memory_layout import dtype, offset
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import Cell, cells
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.native_host import ROTARY, refused, run_steps, saved


def test_a_state_may_be_one_of_another_instance_overwritten_and_freed(native: Path, host: FmuInstance) -> None:
    run_steps(host.initialize(ROTARY), 120, stop=True)
    state, time = host.unit.getFMUstate(), host.time
    first = run_steps(host, 400, start=True)
    with FmuInstance(native) as other:
        other.unit.setFMUstate(state)
        other.time = time
        assert run_steps(other, 400, start=True) == first
    address = state.value
    host.unit.fmi2GetFMUstate(host.unit.component, byref(state))  # overwritten in place
    assert state.value == address
    host.unit.setFMUstate(state)
    host.unit.freeFMUstate(state)
    assert state.value is None


def test_every_damaged_bit_is_detected(host: FmuInstance) -> None:
    run_steps(host.initialize(ROTARY), 50, stop=True)
    packed = saved(host)
    for position in range(len(packed)):
        damaged = bytearray(packed)
        damaged[position] ^= 1 << position % 8
        with refused(host, "this FMU state"):
            host.unit.deSerializeFMUstate(bytes(damaged))
    for size in (0, 1, 55, len(packed) - 1, len(packed) + 1):
        with refused(host, f"has {len(packed)} bytes"):
            host.unit.deSerializeFMUstate((packed + b"\0")[:size])


def test_a_state_of_another_unit_is_refused(host: FmuInstance) -> None:
    host.initialize()
    packed = bytearray(saved(host))
    at = packed.index(host.description.guid.encode())
    packed[at + 1] = ord("0") if packed[at + 1] != ord("0") else ord("1")
    with refused(host, "this FMU state belongs to another FMU"):
        host.unit.deSerializeFMUstate(bytes(packed))
    foreign = ctypes.create_string_buffer(bytes(packed))
    for call in (host.unit.setFMUstate, host.unit.serializeFMUstate):
        with refused(host, "this FMU state belongs to another FMU"):
            call(ctypes.cast(foreign, c_void_p))


def test_a_state_needs_enough_memory(host: FmuInstance) -> None:
    state = host.unit.getFMUstate()
    memory = ctypes.create_string_buffer(100)
    with refused(host, "there must be at least"):
        host.unit.fmi2SerializeFMUstate(host.unit.component, state, memory, 100)
    assert memory.raw == bytes(100)
    host.unit.freeFMUstate(state)


# --- forged states: with a valid checksum, but of no state that the unit can reach ---

CHECKSUM, MODE, GIVEN, STOP, TIME, MEMORY = 56, 64, 72, 104, 112, 120  # offsets in a serialized state


def with_checksum(state: bytearray) -> bytes:
    """A state with the checksum of instance_states.h: FNV-1a by words, each mixed; the checksum itself counts as 0."""
    struct.pack_into("<Q", state, CHECKSUM, 0)
    total = 14695981039346656037
    for (word,) in struct.iter_unpack("<Q", state):
        total = (total ^ word) * 1099511628211 % 2**64
        total ^= total >> 32
    struct.pack_into("<Q", state, CHECKSUM, total)
    return bytes(state)


def forge_state(host: FmuInstance, form: str, at: int, value: Any) -> bytes:
    state = bytearray(saved(host))
    struct.pack_into(form, state, at, value)
    return with_checksum(state)


def test_the_checksum_of_the_tests_is_that_of_the_unit(host: FmuInstance) -> None:
    run_steps(host.initialize(ROTARY), 50, stop=True)
    assert with_checksum(bytearray(saved(host))) == saved(host)


@pytest.mark.parametrize(
    ("form", "at", "value"),
    [
        *(("<q", MODE, mode) for mode in (0, 3, 5, 16, -1, 2**40)),
        *(("<q", GIVEN, bits) for bits in (1, 8, -1, 2**33)),
        *(("<d", TIME, time) for time in (math.nan, math.inf, -math.inf)),
        ("<d", STOP, math.nan),
    ],
)
def test_a_forged_state_is_refused(host: FmuInstance, form: str, at: int, value: Any) -> None:
    host.initialize()
    with refused(host, "this FMU state is none that this unit makes"):
        host.unit.deSerializeFMUstate(forge_state(host, form, at, value))
    host.step(0.1)


def test_a_flag_is_true_or_false_in_a_state(host: FmuInstance) -> None:
    host.initialize()
    flags = [c.name for c in cells(Recipe("Synchronizer").block()) if c.type is bool]
    assert len(flags) > 10
    for name in flags:
        at = MEMORY + offset(dtype(Recipe("Synchronizer").block()), name)
        host.unit.freeFMUstate(host.unit.deSerializeFMUstate(forge_state(host, "B", at, 1)))
        with refused(host, "none that this unit makes"):
            host.unit.deSerializeFMUstate(forge_state(host, "B", at, 2))


def is_count(cell: Cell) -> bool:
    """Whether a cell is declared by `var.count`: a smaller number is its limit."""
    return any(f.name == cell.attribute and "most" in f.metadata for f in fields(cell.owner))


def test_an_integer_of_a_state_is_small_enough_for_sums(host: FmuInstance) -> None:
    host.initialize()
    integers = [c.name for c in cells(Recipe("Synchronizer").block()) if c.type is int and not is_count(c)]
    assert "master.samples" in integers
    for name in integers:
        at = MEMORY + offset(dtype(Recipe("Synchronizer").block()), name)
        for value in (2**60, -(2**60)):
            host.unit.freeFMUstate(host.unit.deSerializeFMUstate(forge_state(host, "<q", at, value)))
        for value in (2**60 + 1, -(2**60) - 1, 2**63 - 1, -(2**63)):
            with refused(host, "none that this unit makes"):
                host.unit.deSerializeFMUstate(forge_state(host, "<q", at, value))


def test_a_block_without_derivatives_has_none_in_its_states(fmus: Fmus) -> None:
    with FmuInstance(fmus.native("RemoteSync")) as host:
        host.initialize()
        with refused(host, "none that this unit makes"):
            host.unit.deSerializeFMUstate(forge_state(host, "<q", GIVEN, 2))


def test_a_forged_clock_does_not_hang_a_step(fmus: Fmus) -> None:
    block = Recipe("RemoteSync").block()
    with FmuInstance(fmus.native("RemoteSync")) as host:
        host.initialize()
        state = forge_state(host, "<d", MEMORY + offset(dtype(block), "time_to_cycle"), -1e300)
        host.unit.setFMUstate(host.unit.deSerializeFMUstate(state))
        start = time.process_time()
        host.step(0.01)
        assert time.process_time() - start < 5.0


def test_a_queue_is_no_longer_than_its_capacity_in_a_state(fmus: Fmus) -> None:
    block = Recipe("CutToLength").block()
    with FmuInstance(fmus.native("CutToLength")) as host:
        host.initialize()
        for name, capacity in (
            ("material.marks.first", 63),
            ("material.marks.waiting", 64),
            ("material.orders.waiting", 64),
        ):
            at = MEMORY + offset(dtype(block), name)
            host.unit.freeFMUstate(host.unit.deSerializeFMUstate(forge_state(host, "<q", at, capacity)))
            for count in (capacity + 1, -1, 2**62):
                with refused(host, "none that this unit makes"):
                    host.unit.deSerializeFMUstate(forge_state(host, "<q", at, count))
