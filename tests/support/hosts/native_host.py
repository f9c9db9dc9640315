"""What several tests of the native flavour have in common: a run, its serialized state, and a refused call."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException

from motionsync_fmu.interface.recipe import Fmi
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance

OK, WARNING, DISCARD, ERROR = range(4)
ROTARY = {"master.period": 360.0, "rest_value": 180.0, "output_phasing": 45.0, "master.velocity": 90.0}


@contextmanager
def refused(host: FmuInstance, message: str = "") -> Iterator[None]:
    """Check that the call fails with fmi2Error and one log line, and changes no state."""
    before, messages = saved(host), len(host.messages)
    with pytest.raises((FmuError, FMICallException)) as e:
        yield
    cause = e.value.__cause__ or e.value
    assert isinstance(cause, FMICallException)
    assert cause.status == ERROR
    assert len(host.messages) == messages + 1
    assert message in host.messages[-1]
    assert saved(host) == before


def saved(host: FmuInstance) -> bytes:
    """The unit's whole state, as bytes."""
    save, serialize, _, _, free = state_functions(host)
    state = save()
    try:
        return bytes(serialize(state))
    finally:
        free(state)


def restore(host: FmuInstance, packed: bytes) -> None:
    """Bring back a state from its bytes."""
    _, _, deserialize, restore_state, free = state_functions(host)
    state = deserialize(packed)
    restore_state(state)
    free(state)


def state_functions(host: FmuInstance) -> tuple[Any, ...]:
    """What saves, serializes, deserializes, restores and frees states, by the version of FMI."""
    unit = host.unit
    if host.fmi == Fmi.TWO:
        return unit.getFMUstate, unit.serializeFMUstate, unit.deSerializeFMUstate, unit.setFMUstate, unit.freeFMUstate
    return unit.getFMUState, unit.serializeFMUState, unit.deserializeFMUState, unit.setFMUState, unit.freeFMUState


def run_steps(host: FmuInstance, steps: int, h: float = 0.01, **values: Any) -> list[dict[str, Any]]:
    """Steps with a master that moves at 90 u/s; the values after each."""
    result = []
    for _ in range(steps):
        host.step(h, {"master.position": 90.0 * host.time % 360.0, **values})
        result.append(host.get())
    return result
