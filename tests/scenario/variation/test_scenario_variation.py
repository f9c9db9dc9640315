"""Scenarios with other values than their files have: equal to those of edited files."""

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files, shipped_folder
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script
from motionsync_fmu.scenario.variation.scenario_variation import ScenarioVariation
from tests.support.compiler.calls import calls

SAW = """\
fmu = "FlyingSaw"
title = "A saw"
stop_time = 4.4
step_size = 0.02
[start]
"axis.max_acceleration" = 2500.0
"gear_in_pos.velocity" = 300.0
[master]
velocity = 250
segments = [{ duration = 2.0 }, { duration = 1.0, acceleration = -50.0 }]
[[set]]
at = 0.2
"gear_in_pos.execute" = true
"move_absolute.velocity" = 600.0
[[set]]
at = 1.6
"gear_in_pos.execute" = false
"move_absolute.velocity" = 600.0
"gear_in_pos.velocity" = 400.0
[[on]]
when = "in_sync"
after = 0.1
set = { "move_absolute.position" = 5.0 }
add = { "gear_in_pos.master_sync_position" = "cuts.length" }
[[expect]]
at = 1.5
"slave.velocity" = 250.0
[cuts]
while = "in_sync"
length = 500.0
"""

CUTTER = """\
fmu = "CutToLength"
title = "A cutter"
stop_time = 4
step_size = 0.02
[start]
length = 500.0
"order.quantity" = 2
[master]
velocity = 250
[cuts]
count = 0
"""


EDITS = [
    ("axis.max_acceleration", 3000.5, '"axis.max_acceleration" = 2500.0', '"axis.max_acceleration" = 3000.5', 1),
    ("start.axis.max_acceleration", 99.0, '_acceleration" = 2500.0', '_acceleration" = 99.0', 1),
    ("axis.max_velocity", 800.0, "[start]", '[start]\n"axis.max_velocity" = 800.0', 1),
    ("master.period", 0.0, "[start]", '[start]\n"master.period" = 0.0', 1),
    ("move_absolute.velocity", 700.0, "= 600.0", "= 700.0", 2),
    ("set.1.gear_in_pos.velocity", 350.0, "= 400.0", "= 350.0", 1),
    ("set.0.gear_in_pos.execute", False, "execute\" = true", "execute\" = false", 1),
    ("set.0.at", 0.3, "at = 0.2", "at = 0.3", 1),
    ("move_absolute.position", 6.0, "= 5.0 }", "= 6.0 }", 1),
    ("on.0.after", 0.2, "after = 0.1", "after = 0.2", 1),
    ("on.0.times", 3.0, "after = 0.1", "after = 0.1\ntimes = 3", 1),
    ("on.0.repeat", True, "after = 0.1", "after = 0.1\nrepeat = true", 1),
    ("master.velocity", 300.0, "velocity = 250\n", "velocity = 300\n", 1),
    ("master.acceleration", 7.5, "velocity = 250\n", "velocity = 250\nacceleration = 7.5\n", 1),
    ("master.segments.1.acceleration", -60.0, "-50.0", "-60.0", 1),
    ("master.segments.0.duration", 1.0, "duration = 2.0", "duration = 1.0", 1),
    ("cuts.length", 600.0, "length = 500.0", "length = 600.0", 1),
    ("length", 600.0, "length = 500.0", "length = 600.0", 1),
    ("cuts.offset", 5.0, "[cuts]", "[cuts]\noffset = 5.0", 1),
    ("stop_time", 5.0, "stop_time = 4.4", "stop_time = 5.0", 1),
    ("step_size", 0.01, "step_size = 0.02", "step_size = 0.01", 1),
    ("expect.0.slave.velocity", 240.0, "slave.velocity\" = 250.0", "slave.velocity\" = 240.0", 1),
    ("expect.0.tolerance", 1e-3, "at = 1.5", "at = 1.5\ntolerance = 1e-3", 1),
]  # fmt: skip
"""A name, its value, and the same as an edit of the file: a text, what replaces it, how often."""


def plain(thing: Any) -> Any:
    """All that a scenario has in it, as something that can be compared."""
    if isinstance(thing, Script):
        return list(thing.breaks), plain(thing.motions)
    if is_dataclass(thing):
        return type(thing), [plain(getattr(thing, f.name)) for f in fields(thing) if f.compare]
    if isinstance(thing, list | tuple):
        return [plain(inner) for inner in thing]
    return repr(sorted(thing.items())) if hasattr(thing, "keys") else repr(thing)


def of(text: str, folder: Path) -> ScenarioVariation:
    return ScenarioVariation(text, folder / "scenario.toml")


def edited(text: str, folder: Path, old: str, new: str, times: int = 1) -> Scenario:
    """The scenario of a file in which a text is another one."""
    assert text.count(old) == times
    file = folder / "scenario.toml"
    file.write_text(text.replace(old, new))
    return load_scenario(file)


@pytest.mark.parametrize(("name", "value", "old", "new", "times"), EDITS)
def test_a_varied_scenario_is_that_of_an_edited_file(
    tmp_path: Path, name: str, value: Any, old: str, new: str, times: int
) -> None:
    variation = of(SAW, tmp_path)
    result = variation.with_values([(variation.target(name), value)])
    assert plain(result) == plain(edited(SAW, tmp_path, old, new, times))


def test_what_was_read_before_makes_no_difference(tmp_path: Path) -> None:
    variation = of(SAW, tmp_path)
    expected = [plain(edited(SAW, tmp_path, old, new, times)) for _, _, old, new, times in EDITS]
    for order in (range(len(EDITS)), reversed(range(len(EDITS))), range(0, len(EDITS), 3)):
        for i in order:
            name, value, *_ = EDITS[i]
            assert plain(variation.with_values([(variation.target(name), value)])) == expected[i]
            with pytest.raises(UserError):
                variation.with_values([(variation.target(name), value), (variation.target("step_size"), -1.0)])


def test_a_varied_scenario_costs_a_part_of_reading_the_file(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(SAW)
    variation = of(SAW, tmp_path)
    target = variation.target("axis.max_acceleration")

    def varied() -> Scenario:
        return variation.with_values([(target, 1000.0)])

    assert calls(varied) < 0.5 * calls(lambda: load_scenario(file))


def test_several_values_change_together_and_the_first_scenario_stays(tmp_path: Path) -> None:
    variation = of(SAW, tmp_path)
    before = plain(variation.scenario)
    names = {"length": 400.0, "master.segments.0.duration": 1.5, "master.segments.1.acceleration": -10.0}
    result = variation.with_values([(variation.target(name), value) for name, value in names.items()])
    text = SAW.replace("length = 500.0", "length = 400.0").replace("duration = 2.0", "duration = 1.5")
    assert plain(result) == plain(edited(text, tmp_path, "-50.0", "-10.0"))
    assert plain(variation.with_values([])) == plain(variation.scenario) == before


def test_a_length_is_the_blocks_variable_where_there_is_one(tmp_path: Path) -> None:
    variation = of(CUTTER, tmp_path)
    target = variation.target("length")
    assert (target.name, target.paths, target.kind.name) == ("length", (("start", "length"),), "Real")
    assert variation.with_values([(target, 650.0)]).start == {"length": 650.0, "order.quantity": 2}


def test_an_integer_gets_whole_numbers(tmp_path: Path) -> None:
    variation = of(CUTTER, tmp_path)
    result = variation.with_values([(variation.target("order.quantity"), 3.0), (variation.target("stop_time"), 5.0)])
    assert (result.start["order.quantity"], type(result.start["order.quantity"])) == (3, int)
    with pytest.raises(UserError, match=r"scenario\.toml:7: order\.quantity: 2\.5 is no Integer"):
        variation.with_values([(variation.target("order.quantity"), 2.5)])


def test_a_member_of_an_enumeration_is_reported_by_its_name(tmp_path: Path) -> None:
    variation = of(CUTTER, tmp_path)
    target = variation.target("start_mode")
    assert target.kind.members == ((1, "FRONT"), (2, "TRIM"), (3, "CONTINUE"))
    assert variation.with_values([(target, "CONTINUE")]).start["start_mode"] == 3


def test_a_variable_with_several_values_is_refused_with_their_paths(tmp_path: Path) -> None:
    with pytest.raises(UserError) as e:
        of(SAW, tmp_path).target("gear_in_pos.velocity")
    assert str(e.value) == (
        "gear_in_pos.velocity has several values in the scenario: 300.0 in start.gear_in_pos.velocity, "
        "400.0 in set.1.gear_in_pos.velocity; name the one that is to vary"
    )


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("axis.max_acc", "axis.max_acceleration"),
        ("mastr.velocity", "master.velocity"),
        ("master.segments.2.acceleration", "master.segments.1.acceleration"),
        ("cuts.lenght", "cuts.length"),
        ("fmu", ""),
        ("title", ""),
        ("cuts.while", ""),
        ("cuts", ""),
        ("master.segments", ""),
        ("set.0", ""),
        ("slave.position", ""),
        ("", ""),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest_ones(tmp_path: Path, name: str, near: str) -> None:
    with pytest.raises(UserError) as e:
        of(SAW, tmp_path).target(name)
    assert f"no variable of FlyingSaw or number of the scenario is named {name!r}; there is" in str(e.value)
    assert near in str(e.value).partition("there is")[2]


def test_the_reader_refuses_a_value_in_its_own_words_with_line_and_key(tmp_path: Path) -> None:
    variation = of(SAW, tmp_path)
    for name, value, old, new in (
        ("axis.max_acceleration", -5.0, "2500.0", "-5.0"),
        ("step_size", 0.0, "step_size = 0.02", "step_size = 0.0"),
        ("master.segments.1.duration", -1.0, "duration = 1.0", "duration = -1.0"),
        ("set.1.at", 9.0, "at = 1.6", "at = 9.0"),
    ):
        with pytest.raises(UserError) as expected:
            edited(SAW, tmp_path, old, new)
        with pytest.raises(UserError) as result:
            variation.with_values([(variation.target(name), value)])
        assert str(result.value) == str(expected.value)


@pytest.mark.parametrize("file", sorted(find_files(shipped_folder())), ids=lambda file: file.parent.name)
def test_every_shipped_scenario_is_read_again_as_it_is(file: Path) -> None:
    variation = ScenarioVariation(file.read_text("utf-8-sig"), file)
    assert plain(variation.with_values([])) == plain(load_scenario(file))
