"""The how-to pages are true, as far as no other test runs them."""

import re
import shlex
import textwrap
from pathlib import Path
from typing import Any

import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd

from motionsync import CutToLength
from motionsync.blocks import BLOCKS
from motionsync.gearing.interface import StartMode
from motionsync.motion.laws import (
    PARABOLA_PEAK_ACCELERATION,
    PARABOLA_TRAVEL,
    POLYNOMIAL_3_4_5_PEAK_ACCELERATION,
    POLYNOMIAL_3_4_5_PEAK_JERK,
    POLYNOMIAL_3_4_5_TRAVEL,
)
from motionsync_fmu import Stepper
from motionsync_fmu.batch.reductions import NUMBERED, PLAIN
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.recipe import Recipe
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command

DOCS = ROOT / "docs"


def code(page: str, language: str) -> list[str]:
    """The code of a language on a page, without its indentation."""
    blocks = re.findall(rf"^( *)```{language}\n(.*?)^ *```", (DOCS / page).read_text("utf-8"), re.M | re.S)
    return [textwrap.dedent(text) for _, text in blocks]


def test_the_system_of_ones_own_cuts_the_pieces_that_it_is_given(fmus: Fmus, tmp_path: Path) -> None:
    """At 500 mm/s, with `start` at 0.54 s, the n-th cut is due where the line has come 270 - 2 + 804 n mm, and is made
    some 166 mm later: the fifth one at 4454, the sixth one beyond the 5000 mm of ten seconds."""
    (text,) = code("how_to/omsimulator.md", "xml")
    package, h = tmp_path / "saw.ssp", 0.02
    saw = fmus.native("CutToLength").read_bytes()
    write_zip(package, {"SystemStructure.ssd": text.encode(), "resources/CutToLength.fmu": saw})
    system = read_ssd(str(package), validate=True).system
    (binding,) = system.elements[0].parameterBindings
    (parameters,) = binding.parameterValues
    for parameter in parameters.parameters:
        parameter.name = f"saw.{parameter.name}"
    inputs = {
        "line.position": lambda t: 500.0 * (t + h),
        "line.velocity": lambda t: 500.0,
        "line.acceleration": lambda t: 0.0,
        "length": lambda t: 800.0,
        "start": lambda t: t > 0.5,
    }
    table = simulate_ssp(str(package), stop_time=10.0, step_size=h, parameter_set=parameters, input=inputs)
    assert table["saw.statistics.cuts"][-1] == 5
    assert table["saw.last.length"][-1] == pytest.approx(800.0, abs=1e-6)
    assert table["saw.slave.position"].max() == pytest.approx(table["carriage.position"].max())


@pytest.mark.parametrize("h", [0.001, 0.01])
def test_the_run_to_compare_with_has_the_figures_of_the_pages(h: float) -> None:
    """The page states a step of 1 ms; one of 10 ms, too, gives what its digits show."""
    saw = Stepper(CutToLength()).initialize({"length": 800.0, "kerf": 4.0, "axis.max_position": 650.0})
    greatest = 0.0
    for step in range(round(10.0 / h)):
        t = step * h
        saw.step(h, {"master.position": 500.0 * t, "master.velocity": 500.0, "start": t > 0.0099})
        greatest = max(greatest, saw["slave.position"])
    assert saw["statistics.skipped"] == 0
    cuts, length = saw["statistics.cuts"], saw["last.length"]
    for page in ("wiring", "simulink", "libcosim", "modelica", "real_time"):
        text = " ".join((DOCS / "how_to" / f"{page}.md").read_text("utf-8").split())
        assert f"`statistics.cuts` is {cuts}" in text
        assert f"`last.length` is {length:.3f}" in text
        assert f"greatest `slave.position` was {greatest:.1f}." in text
    assert f"which is {saw['limits.max_line_velocity']:.1f}," in (DOCS / "how_to" / "wiring.md").read_text("utf-8")


def test_the_traps_of_inputs_that_are_not_connected(blocks: list[str]) -> None:
    """In Simulink these are 0: each input that has another start value is named, and may be a parameter."""
    page = (DOCS / "how_to" / "simulink.md").read_text("utf-8")
    rows = re.findall(r"^ *\| (\w+) \| `([\w.]+)` \| (\w+) \|", page, re.M)
    for block in blocks:
        starts = {v.name: v.text(v.start) for v in Recipe(block).variables.values() if v.causality == "input"}
        nonzero = {name: start for name, start in starts.items() if start not in ("0", "0.0", "false")}
        assert {name: start for owner, name, start in rows if owner == block} == {
            name: start.removesuffix(".0") for name, start in nonzero.items()
        }
        assert Recipe(block, interface=Interface(parameter=tuple(nonzero))).block()


@pytest.mark.parametrize(
    ("block", "name", "output", "start"),
    [
        ("Gearing", "activate", "in_gear", {"gear_in.start_mode": StartMode.CW_DIRECT}),
        ("CutToLength", "length", "statistics.cuts", {"length": 300.0}),
        ("RotaryKnife", "length", "statistics.cuts", {"length": 400.0}),
        ("CutToLength", "order.quantity", "order.waiting", {"order.length": 100.0}),
        ("CutToLength", "line.wanted_velocity", "line.velocity_request", {}),
        ("RotaryKnife", "line.wanted_velocity", "line.velocity_request", {}),
    ],
)
def test_an_input_that_is_0_disables_what_the_page_says(
    block: str, name: str, output: str, start: dict[str, Any]
) -> None:
    greatest = []
    for given in ({}, {name: 0}):
        stepper = Stepper(BLOCKS[block]()).initialize(start | given)
        values = []
        for i in range(4000):
            commands = {n: i > 10 for n in ("start", "order.add") if n in stepper.cells}
            stepper.step(1e-3, {"master.position": 0.3 * i, "master.velocity": 300.0, **commands})
            values.append(float(stepper[output]))
        greatest.append(max(values[100:]))
    assert greatest[0] > 0.0
    assert greatest[1] == 0.0


def test_the_table_of_ramps() -> None:
    """Those of the half ramp by hand: the second derivative of u^3 - u^4/2 is at most 1.5, the third one 6. Over 2 D
    these are 1.5/2 v²/D and 6/4 v³/D²."""
    text = (DOCS / "explanation" / "laws.md").read_text("utf-8")
    parabola, polynomial, half = (
        [float(number) for number in re.findall(r"\| ([\d.]+) ", re.findall(rf"^\| {law}.*$", text, re.M)[0])]
        for law in ("parabola", "polynomial 3-4-5", "half ramp")
    )
    assert parabola == [PARABOLA_TRAVEL, PARABOLA_PEAK_ACCELERATION]
    computed = (POLYNOMIAL_3_4_5_TRAVEL, POLYNOMIAL_3_4_5_PEAK_ACCELERATION, POLYNOMIAL_3_4_5_PEAK_JERK)
    assert polynomial == [round(number, 3) for number in computed]
    assert half == [2.0, 0.75, 1.5]


def test_the_plans_have_the_figures_of_the_page(motionsync: Command) -> None:
    page = (DOCS / "how_to" / "plan_line.md").read_text("utf-8")
    knife, both = (
        " ".join(motionsync(*shlex.split(line), "--no-report").out.split())
        for line in re.findall(r"^    motionsync (.*)$", page, re.M)
    )
    assert "600 6000 360" in knife
    assert "400 1864.34" in knife
    assert "up to 6000 mm/s (360 m/min), pieces of 400 mm at up to 1864 mm/s" in " ".join(page.split())
    assert "The knife is the better machine for pieces of 600 mm" in both
    assert "all of them up to 627.3 mm/s" in both
    assert "the saw at up to 627.3 mm/s" in page


def test_every_kind_of_measure_is_listed() -> None:
    table = re.findall(r"^\| (`.*?) \|", (DOCS / "reference" / "measures.md").read_text("utf-8"), re.M)
    assert re.findall(r"`(.*?)`", " ".join(table)) == sorted([*PLAIN, *NUMBERED.values()], key=" ".join(table).index)


def test_each_line_that_a_run_prints_is_explained() -> None:
    source = (ROOT / "fmu_src" / "motionsync_fmu" / "pages" / "summary.py").read_text("utf-8")
    names = set(re.findall(r'yield "([a-z ]+)"', source))
    assert len(names) > 10
    page = (DOCS / "reference" / "run_output.md").read_text("utf-8")
    rows = re.findall(r"^\| (`.*?) \|", page, re.M)
    assert names <= set(re.findall(r"`(.*?)`", " ".join(rows)))


def test_a_test_of_ones_own_project_runs() -> None:
    (text,) = [text for text in code("how_to/tests.md", "python") if "assert" in text]
    exec(text, {})
