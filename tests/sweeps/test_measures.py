"""The measures of a sweep, as the command line gives them."""

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.sweeps.measures import check_measures, join_measures, parse_texts
from motionsync_fmu.sweeps.result_columns import measure_columns

SAW = Recipe("FlyingSaw")


def test_an_output_may_be_named_in_several_texts() -> None:
    texts = ["slave.velocity=max, max_time", "IN_SYNC=rises", "slave.velocity=above:500,rms"]
    result = check_measures(parse_texts(texts), SAW)
    assert result == {"slave.velocity": ("max", "max_time", "above:500", "rms"), "in_sync": ("rises",)}
    assert measure_columns(result) == [
        "slave.velocity.max", "slave.velocity.max_time", "slave.velocity.above:500", "slave.velocity.rms",
        "in_sync.rises",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("slave.velocity", "--measure slave.velocity: it must be NAME=KIND,..., as in slave.velocity=max,max_time"),
        ("=max", "it must be NAME=KIND,..."),
        ("slave.velocity=", "it must be NAME=KIND,..."),
        ("slave.velocity=max,,min", "it must be NAME=KIND,..."),
        ("slave.speed=max", "no variable of FlyingSaw is named 'slave.speed'"),
        ("slave.velocity=maximum", "slave.velocity: no measure is named 'maximum'; there is"),
        ("slave.velocity=above:fast", "'above:fast' is not allowed"),
        ("slave.velocity=max,max", "the measure max is given 2 times"),
        ("slave.velocity=every:10", "'every:10' is many numbers, and a row has one a measure"),
        ("axis.max_jerk=max", "axis.max_jerk is a tunable parameter: outputs and local variables are measured"),
    ],
)
def test_a_text_that_is_no_measure_is_reported(text: str, message: str) -> None:
    with pytest.raises(UserError) as error:
        check_measures(parse_texts([text]), SAW)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_one_kind_needs_no_list() -> None:
    assert check_measures({"state": "last"}, SAW) == {"state": ("last",)}


def test_measures_that_both_need_are_kept_once() -> None:
    mine = {"slave.jerk": ("max", "rms"), "state": ("last",)}
    joined = join_measures(mine, {"slave.jerk": ("min", "max")})
    assert joined == {"slave.jerk": ("max", "rms", "min"), "state": ("last",)}
