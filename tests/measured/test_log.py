"""What the log says of a line that is not ideal: little, however often a condition comes and goes."""

from typing import Any, ClassVar

import numpy as np
import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.master import MasterInput
from motionsync_fmu.python.slave import BlockSlave
from tests.measured.lines import STEP, counted, noisy, times

COUNTS = "master: master.position comes in counts, as from an encoder"


class Slave(BlockSlave):
    block_type = CutToLength
    build = "0"
    starts: ClassVar[dict[str, Any]] = {}


def messages(mode: MasterInput, positions: Any) -> list[str]:
    """Of a CutToLength with a line of 500 mm/s."""
    slave = Slave(instance_name="saw")
    cells = {name: v.cell for name, v in slave.by_name.items()}
    start = {"master.input_mode": mode, "master.velocity": 500.0, "length": 800.0, "auto_start": True}
    for name, value in start.items():
        cells[name].set(value)
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    for n, position in enumerate(positions):
        cells["master.position"].set(float(position))
        assert slave.do_step(n * STEP, STEP)
    slave.terminate()
    return [entry.msg for entry in slave.log_queue]


def test_limits_that_noise_exceeds_all_the_time_are_two_lines_each() -> None:
    """With POSITION_ONLY velocity, acceleration and more are beyond the axis in thousands of steps."""
    log = messages(MasterInput.POSITION_ONLY, noisy(500.0 * times(3.0), 0.1, 1)[0])
    limits = [text for text in log if "limit exceeded" in text]
    kinds = {text.partition(" (")[0] for text in limits}
    assert len(kinds) >= 3
    for kind in kinds:
        first, *whole = [text for text in limits if text.startswith(kind)]
        assert "times: " not in first
        assert len(whole) <= 1
        assert all("times: " in text for text in whole)
    others = [text for text in log if text not in limits]
    assert len(others) <= 2, "a line for each skipped cut, of two that are possible"


@pytest.mark.parametrize("mode", [MasterInput.POSITION_ONLY, MasterInput.START_OF_STEP, MasterInput.END_OF_STEP])
def test_a_position_in_counts_is_logged_once(mode: MasterInput) -> None:
    log = messages(mode, counted(487.3 * times(0.5), 0.1))
    assert sum(text.startswith(COUNTS) for text in log) == 1


def test_nothing_is_logged_of_a_measured_line() -> None:
    line = counted(noisy(500.0 * times(2.0), 0.02, 1)[0], 0.1)
    assert messages(MasterInput.MEASURED, line) == []


def test_nothing_is_logged_of_an_ideal_line() -> None:
    assert messages(MasterInput.POSITION_ONLY, 500.0 * np.array(times(1.0))) == []
