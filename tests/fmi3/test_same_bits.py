"""An FMU of FMI 3.0 gives the bits and the messages of that of FMI 2.0 in FMPy, and in a host in C those of FMPy;
tests/fmu/test_importers.py has other importers."""

from pathlib import Path

import fmpy
import pytest

from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.blocks.random_runs import draw_accepted_run, draw_runs
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.importers import bits
from tests.support.hosts.native_host import restore, saved
from tests.support.hosts.replay import TARGETS, orders, replayed, tried


def test_random_runs_give_the_same_states_and_messages(block: str, block_native: Path, block_fmi3: Path) -> None:
    """Runs with refused values, step sizes and commands: at each tenth step the states are equal, byte by byte."""
    steps = failed = 0
    with FmuInstance(block_native) as two, FmuInstance(block_fmi3) as three:
        for run in draw_runs(block, 150, 6):
            for host in (two, three):
                host.unit.reset()
                host.time = 0.0
            why = tried(two.initialize, run.start)
            assert tried(three.initialize, run.start) == why
            for h, values in [] if why else run.steps:
                why = tried(two.step, h, values)
                assert tried(three.step, h, values) == why
                steps, failed = steps + 1, failed + bool(why)
                if steps % 10 == 0:
                    assert saved(two) == saved(three)
            if not why:
                assert bits(two.get()) == bits(three.get())
        assert two.messages == three.messages
    assert steps > 200
    assert failed > 0


def test_a_state_goes_from_one_version_to_the_other(block: str, block_native: Path, block_fmi3: Path) -> None:
    run = draw_accepted_run(block, 2.0**-7, 300)
    with FmuInstance(block_native) as two, FmuInstance(block_fmi3) as three:
        two.initialize(run.start)
        three.initialize()
        for i, (h, values) in enumerate(run.steps):
            ahead, behind = (two, three) if i < 150 else (three, two)
            ahead.step(h, values)
            if i in (149, 299):
                restore(behind, saved(ahead))
                behind.time = ahead.time
                assert bits(behind.get()) == bits(ahead.get())


# --- a host in C, without any Python ---


@pytest.fixture(scope="module")
def expected(fmi3: Path) -> list[tuple[str, str]]:
    """Runs of the Synchronizer through FMPy: those that are compared with FMI 2.0 above."""
    commands: list[tuple[str, str]] = []
    for run in draw_runs("Synchronizer", 150, 6):
        with FmuInstance(fmi3) as host:
            commands.extend(orders(host, run))
    return commands


@pytest.mark.parametrize("target", TARGETS)
def test_a_host_in_c_gets_the_bits_of_fmpy(
    target: str, fmus: Fmus, expected: list[tuple[str, str]], tmp_path: Path
) -> None:
    extracted = Path(fmpy.extract(str(fmus.fmi3_everywhere("Synchronizer")), unzipdir=str(tmp_path / "fmu")))
    answers = replayed(target, extracted, [order for order, _ in expected], tmp_path)
    for (order, answer), result in zip(expected, answers, strict=True):
        assert result == answer, order
    assert {answer for order, answer in expected if order.startswith("s")} == {"0", "2"}
    assert any(order.startswith("E") for order, _ in expected)
