"""Some thousand random cuts on random machines."""

from dataclasses import replace

import pytest

from motionsync_fmu.batch.simulation import BatchResult
from tests.model.cut_to_length.random_cuts import (
    CUTS,
    OUTPUTS,
    Machines,
    count_cuts,
    draw_machines,
    find_broken_rules,
    limit_shares,
    simulate,
)

pytestmark = pytest.mark.slow

NUMBER = 240


@pytest.fixture(scope="module")
def cuts() -> tuple[Machines, BatchResult]:
    machines = draw_machines(0, NUMBER)
    return machines, simulate(machines)


def test_no_limit_is_broken_and_every_cut_is_where_and_when_it_has_to_be(cuts: tuple[Machines, BatchResult]) -> None:
    machines, result = cuts
    assert {name: instances.tolist() for name, instances in find_broken_rules(machines, result).items()} == {}


def test_the_machines_cut_and_use_their_limits_up(cuts: tuple[Machines, BatchResult]) -> None:
    counts = count_cuts(*cuts)
    assert counts["on time"][0] > NUMBER / 2
    assert counts["on time"][1] > (CUTS - 2) * counts["on time"][0]
    assert counts["too fast, SKIP"][2] > NUMBER / 10
    assert counts["too fast, LATE"][3] > NUMBER / 10
    for name, share in limit_shares(*cuts):
        assert share.max() > 0.999, name


def test_the_rules_detect_what_is_broken(cuts: tuple[Machines, BatchResult]) -> None:
    """Were the limits lower, the ends nearer, the material elsewhere, or the outputs a little different."""
    machines, result = cuts
    broken: set[str] = set()
    for name in ("velocity", "acceleration", "deceleration", "jerk"):
        tighter = {f"axis.max_{name}": 0.5 * machines.start[f"axis.max_{name}"]}
        broken |= set(find_broken_rules(replace(machines, start=machines.start | tighter), result))
    home = machines.start["home_position"]
    for ends in ({"axis.min_position": home + 1.0}, {"axis.max_position": home}, {"home_position": home + 1.0}):
        broken |= set(find_broken_rules(replace(machines, start=machines.start | ends), result))
    for name in OUTPUTS:
        for factor, more in ((1.001, 0.0), (1.0, 1.0), (1.0, -1.0)):
            values = result.values.copy()
            values[:, :, result.names.index(name)] *= factor
            values[:, :, result.names.index(name)] += more
            broken |= set(find_broken_rules(machines, BatchResult(result.names, values, (), {})))
    assert broken == {
        "left out instead of late",
        *("velocity beyond its limit", "velocity on the way home beyond its limit", "acceleration beyond its limit"),
        *("jerk beyond its limit", "beyond axis.min_position", "beyond axis.max_position", "behind home"),
        *("warning.limit_exceeded", "not at its cut in sync", "not as fast as the material in sync"),
        *(
            "blade down without sync",
            "an error",
            "a cut missed",
            "a false warning",
            "no warning",
            "too few or too many cuts",
        ),
        *("a wrong length", "the records do not balance", "a piece too short"),
    }
