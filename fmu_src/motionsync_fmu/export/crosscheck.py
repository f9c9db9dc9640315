"""Scenarios as models of the FMI cross-check: what other tools need to import an FMU and to check the result.

The layout and the files are those of its rules (github.com/modelica/fmi-cross-check, FMI-CROSS-CHECK-RULES.md, version
4.1). A model has no file for start values, so that they are baked into its FMU; what a run changes is an input.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isclose
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput

from ..about import __version__
from ..errors import UserError
from ..fmus.fmu import BuildOptions, build
from ..interface.fingerprint import Files
from ..interface.recipe import Recipe
from ..native.platforms import ROWS, Platform
from ..pages.style import load_template
from ..paths import replace_files
from ..scenario.evaluate.reference_comparison import read_reference
from ..scenario.evaluate.reference_files import csv_text, inputs_csv, options_text
from ..scenario.files.example import load_example
from ..scenario.files.reader import load_scenario
from ..scenario.files.shipped import find_files
from ..scenario.run.simulation import communication_points, start_inputs
from ..scenario.scenario import Scenario

TEMPLATES = Path(__file__).parent / "templates"
LAYOUT = "fmus/2.0/cs/{platform}/motionsync/{version}/{model}"
FOLDERS = ("linux64", "win64", "darwin64")  # of the platforms that the cross-check knows, those of a native FMU
C_CODE = "c-code"  # what it calls the platform of an FMU with sources
MOST_VARIABLES = 10  # of a reference: so the rules advise


@dataclass(frozen=True)
class Model:
    """One model of the cross-check.

    Attributes:
        name: the name of its folder and of its files.
        recipe: the FMU that runs the scenario without start values.
    """

    name: str
    scenario: Scenario
    recipe: Recipe


def models(texts: Sequence[str]) -> list[Model]:
    """The models of these blocks (their examples) and scenarios; of all blocks if there are none.

    Raises:
        UserError: there is no such block or scenario, two have the same name, or one is no model of the cross-check.
    """
    models_by_name: dict[str, Model] = {}
    for text in texts or list(BLOCKS):
        for name, scenario in _named(text):
            if name in models_by_name:
                raise UserError(f"{text}: {name} is given twice")
            if why := refusal(scenario):
                raise UserError(f"{scenario.file}: no model of the cross-check: {why}")
            models_by_name[name] = Model(name, scenario, recipe_of(scenario))
    return list(models_by_name.values())


def _named(text: str) -> Iterator[tuple[str, Scenario]]:
    """The scenarios that a text means, each with the name of its model."""
    blocks = {name.lower(): name for name in BLOCKS}
    if block := blocks.get(text.lower()):
        yield block, load_example(block)
        return
    for file in find_files(Path(text)):
        scenario = load_scenario(file)
        yield scenario.label.replace("/", "_"), scenario


def refusal(scenario: Scenario) -> str:
    """Why a scenario cannot be run from start values and a table of inputs over time alone; empty if it can."""
    if scenario.reacts:
        return "its inputs depend on the block's outputs"
    if scenario.start.get("master.input_mode") == MasterInput.END_OF_STEP:
        return "its inputs are those of the end of each step, and a table has those of the present time"
    if read_reference(scenario) is None:
        return "it has no reference"
    step = scenario.step_size
    between = (
        t
        for t in communication_points(replace(scenario, expectations=()), step).tolist()
        if not isclose(round(t / step) * step, t)
    )
    if (t := next(between, None)) is not None:
        return f"something happens at {t:g} s, between two steps of {step:g} s"
    declared = recipe_of(scenario).variables
    given = (declared[name].refusal(value) for setting in scenario.settings for name, value in setting.values.items())
    return next(filter(None, given), "")  # a parameter that becomes an input is checked in each step


def recipe_of(scenario: Scenario) -> Recipe:
    """The FMU whose start values are those of the scenario and of its first inputs, and whose inputs are all that
    changes in the run."""
    declared = scenario.recipe.variables
    changed = dict.fromkeys(name for setting in scenario.settings for name in setting.values)
    new_inputs = [name for name in changed if declared[name].causality != "input"]
    starts = {**scenario.start, **start_inputs(scenario)}
    interface = scenario.recipe.interface
    new_inputs += [pattern for causality, pattern in interface.patterns() if causality == "input"]
    return replace(
        scenario.recipe,
        unit=scenario.unit,
        slave_unit=scenario.slave_unit,
        starts={name: declared[name].literal(value) for name, value in starts.items()},
        interface=replace(interface, input=new_inputs),
    )


def files(model: Model) -> Files:
    """The files of a model besides its FMU."""
    scenario, reference = model.scenario, read_reference(model.scenario)
    assert reference, "a scenario without a reference is refused"
    names, table, tolerance = reference
    outputs = [name for name in names if model.recipe.variables[name].causality == "output"][:MOST_VARIABLES]
    rows = table[:, [0, *(1 + names.index(name) for name in outputs)]].tolist()
    interval = float(np.diff(np.unique(table[:, 0])).max())
    values = {"model": model, "scenario": scenario, "tolerance": tolerance, "version": __version__}
    return {
        f"{model.name}_in.csv": inputs_csv(scenario).encode(),
        f"{model.name}_ref.csv": csv_text(["time", *outputs], rows).encode(),
        f"{model.name}_ref.opt": f"{options_text(scenario)}OutputIntervalLength, {interval:.9g}\n".encode(),
        "README.md": load_template(TEMPLATES, "crosscheck.md.j2").render(values).encode(),
    }


def export(
    model: Model,
    folder: Path,
    progress: Callable[[str], None] = lambda text: None,
    platforms: Sequence[Platform] = ROWS,
) -> list[Path]:
    """Build the model's FMU, with its sources, and write its files below a folder, once for each platform that the
    cross-check knows; the folders that hold them.

    `progress`: as for `build`; `platforms`: as for `BuildOptions`.

    Raises:
        UserError: the FMU cannot be built.
    """
    texts = files(model)
    with TemporaryDirectory() as work:
        options = BuildOptions(platforms=platforms, with_sources=True)
        fmu = build(model.recipe, Path(work, "a.fmu"), options, progress)
        texts[f"{model.name}.fmu"] = fmu.read_bytes()
    folders = []
    for platform in (*(row.folder for row in platforms if row.folder in FOLDERS), C_CODE):
        target = folder / LAYOUT.format(platform=platform, version=__version__, model=model.name)
        with replace_files(target) as part:
            for name, text in texts.items():
                part(name).write_bytes(text)
        folders.append(target)
    return folders
