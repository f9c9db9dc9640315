"""Which of two machines is the better one, by hand.

Known of the reference saw: 619.645830 for pieces of 500, 1001.572745 for 1000, 1431.797780 for 2000. The knife's jerk
limits it: v = Z cbrt(2e4/(60 d)), with Z = L - 60 and d = 0.6 |600 - L|, so 440 cbrt(2e4/3600) = 779.283 for 500 and
940 cbrt(2e4/14400) = 1048.778 for 1000; on 2000 it parks, 1.5 (0.6 v)3/1622 = 2e4 gives 1174.471."""

import json
import math
import re
from dataclasses import replace

import pytest

from motionsync_fmu.api.plan_line import plan_line
from motionsync_fmu.errors import UserError
from motionsync_fmu.plan.comparison import Comparison, compare
from tests.model.cut_to_length.machine_results import GREATEST_VELOCITIES
from tests.plan.machines import KNIFE, REFERENCE, knife, machine

SLOW_KNIFE = KNIFE | {"axis.max_jerk": "2e4"}
KNIFE_VELOCITIES = {
    500.0: 440.0 * math.cbrt(2e4 / 3600),
    1000.0: 940.0 * math.cbrt(2e4 / 14400),
    2000.0: math.cbrt(2e4 * 162**2 / 1.5) / 0.6,
}


def compared(orders: list[float], line_velocity: float | None = None) -> Comparison:
    return compare([machine(REFERENCE), knife(SLOW_KNIFE)], orders, line_velocity)


def test_without_a_line_velocity_the_faster_line_for_all_orders_counts() -> None:
    comparison = compared([500.0, 1000.0])
    saw, knife_ = comparison.machines
    assert saw.velocities == pytest.approx([GREATEST_VELOCITIES[length] for length in (500.0, 1000.0)], abs=1e-6)
    assert knife_.velocities == pytest.approx([KNIFE_VELOCITIES[length] for length in (500.0, 1000.0)], rel=1e-9)
    assert comparison.better is knife_
    assert comparison.sentence == (
        "The knife is the better machine for pieces of 500 and 1000 mm: it cuts them up to 779.3 mm/s (46.76 m/min), "
        "limited by those of 500 mm; the saw cuts them up to 619.6 mm/s (37.18 m/min), limited by those of 500 mm."
    )


def test_the_machine_that_reaches_more_orders_is_better() -> None:
    """At 1010 the saw misses pieces of 1000; its 1431.8 for 2000 does not help."""
    comparison = compared([1000.0, 2000.0], 1010.0)
    assert [c.reached for c in comparison.machines] == [[2000.0], [1000.0, 2000.0]]
    assert comparison.better
    assert comparison.sentence == (
        "The knife is the better machine for pieces of 1000 and 2000 mm at 1010 mm/s (60.6 m/min): it cuts them with a "
        "margin of 3.84 %, up to 1049 mm/s (62.93 m/min), limited by those of 1000 mm; the saw cuts only those of 2000 "
        "mm, and all of them up to 1002 mm/s (60.09 m/min)."
    )


def test_where_both_reach_the_orders_the_greater_margin_counts() -> None:
    comparison = compared([2000.0], 900.0)
    assert comparison.sentence == (
        "The saw is the better machine for pieces of 2000 mm at 900 mm/s (54 m/min): it cuts them with a margin of "
        "59.1 %, up to 1432 mm/s (85.91 m/min); the knife cuts them with a margin of 30.5 %, up to 1174 mm/s "
        "(70.47 m/min)."
    )


def test_an_order_that_a_machine_cannot_cut_at_any_velocity() -> None:
    """A window of 60 leaves no way to pieces of 50. The saw cuts them, on a slow line."""
    comparison = compared([50.0, 2000.0])
    assert comparison.better is comparison.machines[0]
    assert "; the knife cuts only those of 2000 mm, and those of 50 mm at no line velocity." in comparison.sentence


def test_where_neither_reaches_an_order_the_one_that_comes_nearer_is_better() -> None:
    comparison = compared([50.0], 1e5)
    assert comparison.better is comparison.machines[0]
    assert "it cuts none of them, and all of them up to " in comparison.sentence


def test_machines_that_are_alike() -> None:
    """779.3 mm/s for 500."""
    alike = compare([replace(knife(SLOW_KNIFE), title=title) for title in ("Old", "New")], [500.0], None)
    assert alike.better is None
    assert alike.sentence == (
        "No machine is better for pieces of 500 mm: Old cuts them up to 779.3 mm/s (46.76 m/min); New cuts them up to "
        "779.3 mm/s (46.76 m/min)."
    )


def test_many_orders_are_not_named_each() -> None:
    lengths = [500.0 + 10.0 * n for n in range(8)]
    assert "for pieces of 8 lengths from 500 to 570 mm: " in compared(lengths).sentence


def test_the_orders_are_those_of_the_scenarios() -> None:
    """The scenario cuts five lengths at 1000 mm/s."""
    plan = plan_line("RotaryKnife/formats", machine="both", velocity=[500.0], length=[1500.0])
    assert plan.comparison
    assert [*plan.comparison.orders] == [1500.0]
    assert plan.machines[0].machine.orders == (300.0, 400.0, 600.0, 900.0, 1500.0)
    assert [m.machine.kind for m in plan.machines] == ["knife", "saw"]
    assert plan.machines[0].machine.line_velocity == 1000.0


def test_what_is_known_of_the_material_counts_for_both() -> None:
    plan = plan_line("CutToLength/basic_cut", machine="both", length="1500", velocity="500")
    assert [m.machine.value("kerf") for m in plan.machines] == [4.0, 4.0]
    assert plan.is_confirmed
    assert json.loads(json.dumps(plan.as_json()))["comparison"]["orders"] == [1500.0]


@pytest.mark.parametrize(
    ("arguments", "options", "text"),
    [
        ([], {"machine": "drill"}, "no kind of machine is named 'drill'; there is saw, knife, both"),
        (["CutToLength/basic_cut"], {"machine": "knife"}, "--machine knife: CutToLength/basic_cut is a saw"),
        (
            [],
            {"machine": "both", "set": {"axis.max_jerk": "1"}},
            "Write CutToLength.axis.max_jerk or RotaryKnife.axis.",
        ),
        ([], {"machine": "both", "set": {"load.friction": "1"}}, "--set load.friction: of which machine?"),
        ([], {"machine": "both", "set": {"kerfs": "1"}}, "'kerfs'"),
        ([], {"machine": "knife", "set": {"tool.cut_time": "1"}}, "parameter or input of RotaryKnife"),
        ([], {"machine": "knife", "set": {"sync.before": "400"}}, "sync.before"),
        (["FlyingSaw/cyclic_cut"], {}, "FlyingSaw is no machine that can be planned: it must be CutToLength or Rot"),
        ([], {"machine": "both", "length": "-1"}, "--length -1: -1 is not allowed"),
    ],
)
def test_mistakes(arguments: list[str], options: dict[str, object], text: str) -> None:
    with pytest.raises(UserError, match=re.escape(text)):
        plan_line(*arguments, **options)  # type: ignore[arg-type]


def test_settings_for_one_of_two_machines() -> None:
    plan = plan_line(
        machine="both",
        set={"CutToLength.axis.max_velocity": "900", "knife.blades": "2", "knife.park_angle": "90", "kerf": "2"},
        length="1000",
        velocity="100",
    )
    saw, knife_ = (m.machine for m in plan.machines)
    assert (saw.value("axis.max_velocity"), knife_.value("axis.max_velocity")) == (900.0, 3600.0)
    assert (saw.value("kerf"), knife_.value("kerf"), knife_.value("knife.blades")) == (2.0, 2.0, 2)
