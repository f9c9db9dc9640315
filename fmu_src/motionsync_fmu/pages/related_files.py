"""Files in an FMU for the users of importers: its block's example as a run to repeat, by FMI-LS-REF 1.0.0-beta.1.

The layered standard fixes the folder and the manifest. The experiment is a file by MA-HS-Experiments, which is a draft.
The parameters are an SSV file of SSP 1.0, inputs and reference are CSV files as the FMI cross-check has them.
"""

from hashlib import sha3_256
from typing import Any

import numpy as np

from ..interface.fingerprint import Files
from ..interface.roles import MOTION
from ..scenario.evaluate.csv_files import csv_text, inputs_csv
from ..scenario.evaluate.reference_comparison import read_reference
from ..scenario.scenario import Scenario
from .numbers import rounded
from .style import TEMPLATES, load_template

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
POINTS = 50  # of the reference, about: every FMU carries it
DIGITS = 12  # of its values: the error is below a hundredth of the tolerance
COLUMNS = (*(f"slave.{name}" for name in MOTION), "state_code")  # of it: the setpoint, and the state


def related_files(example: Scenario) -> Files:
    """Make the files, by their paths in the FMU; none if the example has no reference.

    Raises:
        UserError: the reference cannot be read.
    """
    reference = read_reference(example)
    if reference is None:
        return {}
    names, table = reference
    available = [name for name in COLUMNS if name in names]
    columns = [0, *(1 + names.index(name) for name in available)]
    times = np.unique(table[:, 0])
    selected = np.isin(table[:, 0], [*times[:: max(len(times) // POINTS, 1)], times[-1]])
    values: dict[str, Any] = {
        "example": example,
        "name": "example",
        "values": [
            {"name": name, "kind": v.kind, "value": v.text(given) if v.choices else v.literal(given)}
            for name, given in example.start.items()
            if (v := example.recipe.variables[name])
        ],
    }
    rows = [[time, *rounded(outputs, DIGITS)] for time, *outputs in table[selected][:, columns].tolist()]

    def rendered(template: str) -> bytes:
        return load_template(TEMPLATES, f"{template}.j2").render(values).encode()

    files = {
        "example.exp": rendered("example.exp"),
        "example.ssv": rendered("parameters.ssv"),
        "example_in.csv": inputs_csv(example).encode(),
        "example_ref.csv": csv_text(["time", *available], rows).encode(),
    }
    values["checksums"] = {name: sha3_256(content).hexdigest() for name, content in files.items()}
    files["fmi-ls-manifest.xml"] = rendered("fmi-ls-manifest.xml")
    return {f"{FOLDER}/{name}": content for name, content in files.items()}
