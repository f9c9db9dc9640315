"""The run that an FMU brings along by FMI-LS-REF 1.0.0-beta.1: it is complete, and an importer that knows nothing of
motionsync repeats it."""

import hashlib
import re
import zipfile
from pathlib import Path
from urllib.parse import urljoin
from xml.etree.ElementTree import Element, fromstring

import fmpy
import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.ssd import read_ssv
from fmpy.util import read_csv
from lxml import etree

from motionsync_fmu.fmus.fmu import Flavour, build_python
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages.related_files import related_files
from motionsync_fmu.scenario.evaluate.reference_comparison import read_reference
from motionsync_fmu.scenario.files.example import load_example
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.references import assert_met

FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
MANIFEST = f"{FOLDER}fmi-ls-manifest.xml"
# The rules of the layered standard and of MA-HS-Experiments, from their tables. FMPy has the schema of the attributes
# that all manifests have.
SCHEMA = f"""\
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" xmlns:ls="http://fmi-standard.org/fmi-ls-manifest">
  <xs:import namespace="http://fmi-standard.org/fmi-ls-manifest"
      schemaLocation="{Path(fmpy.__file__).parent.as_posix()}/schema/fmi3/fmi3LayeredStandardManifest.xsd"/>
  <xs:element name="fmiReferences">
    <xs:complexType>
      <xs:sequence>
        <xs:element name="Related" minOccurs="0" maxOccurs="unbounded">
          <xs:complexType>
            <xs:attribute name="type" type="xs:string"/>
            <xs:attribute name="source" type="xs:anyURI" use="required"/>
            <xs:attribute name="role" use="required">
              <xs:simpleType><xs:restriction base="xs:string"><xs:pattern
                  value="document|requirement|specification|model|
|parameter|system|testcase|experiment(/(smoke-test|validation|uncertainty-analysis))?|result|method|rationale|report|
|request|delivery|configuration|signature|serialized-state(/.*)?|meta-data|other"/></xs:restriction></xs:simpleType>
            </xs:attribute>
            <xs:attribute name="description" type="xs:string"/>
            <xs:attribute name="checksum" type="xs:hexBinary"/>
          </xs:complexType>
        </xs:element>
      </xs:sequence>
      <xs:attribute ref="ls:fmi-ls-name" use="required" fixed="org.fmi-standard.fmi-ls-ref"/>
      <xs:attribute ref="ls:fmi-ls-version" use="required" fixed="1.0.0-beta.1"/>
      <xs:attribute ref="ls:fmi-ls-description" use="required"
          fixed="Layered Standard providing information on related files included in an FMU."/>
    </xs:complexType>
  </xs:element>
</xs:schema>
""".replace("|\n|", "|")
EXPERIMENTS = """\
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">
  <xs:complexType name="File"><xs:attribute name="source" type="xs:anyURI" use="required"/></xs:complexType>
  <xs:complexType name="Times">
    <xs:attribute name="startTime" type="xs:double"/>
    <xs:attribute name="stopTime" type="xs:double"/>
    <xs:attribute name="stepSize" type="xs:double"/>
  </xs:complexType>
  <xs:complexType name="Experiment">
    <xs:sequence>
      <xs:element name="TransientSimulation" type="Times"/>
      <xs:element name="Parameters" minOccurs="0" type="File"/>
      <xs:element name="Stimuli" minOccurs="0" type="File"/>
      <xs:element name="References" minOccurs="0" type="File"/>
    </xs:sequence>
    <xs:attribute name="name" type="xs:string" use="required"/>
    <xs:attribute name="description" type="xs:string"/>
  </xs:complexType>
  <xs:element name="Experiments">
    <xs:complexType>
      <xs:sequence><xs:element name="Experiment" maxOccurs="unbounded" type="Experiment"/></xs:sequence>
      <xs:attribute name="name" type="xs:string" use="required"/>
      <xs:attribute name="description" type="xs:string"/>
    </xs:complexType>
  </xs:element>
</xs:schema>
"""


def related(fmu: Path) -> dict[str, str]:
    """The related files by their roles, as paths in the FMU."""
    with zipfile.ZipFile(fmu) as z:
        listed = list(fromstring(z.read(MANIFEST)))
        names = z.namelist()
    sources = {r.attrib["role"]: urljoin(MANIFEST, r.attrib["source"]) for r in listed}
    assert len(sources) == len(listed)
    assert {name for name in names if name.startswith(FOLDER)} <= {MANIFEST, *sources.values()} <= set(names)
    return sources


def experiment(fmu: Path, path: str) -> Element:
    with zipfile.ZipFile(fmu) as z:
        text = z.read(path)
    etree.XMLSchema(etree.fromstring(EXPERIMENTS)).assertValid(etree.fromstring(text))
    root = fromstring(text)
    assert (root.tag, root.attrib["name"]) == ("Experiments", read_model_description(str(fmu)).modelName)
    (only,) = root.iter("Experiment")
    return only


def test_the_manifest_keeps_to_the_standard_and_lists_all_files(block_fmu: Path) -> None:
    with zipfile.ZipFile(block_fmu) as z:
        manifest = etree.fromstring(z.read(MANIFEST))
    etree.XMLSchema(etree.fromstring(SCHEMA)).assertValid(manifest)
    assert set(related(block_fmu)) == {"experiment/smoke-test", "parameter", "other", "result", "document"}


def test_the_checksums_are_those_of_the_files(block_fmu: Path) -> None:
    """SHA3-256, where the manifest names no other; the page, which is no part of the experiment, has none."""
    with zipfile.ZipFile(block_fmu) as z:
        for entry in fromstring(z.read(MANIFEST)):
            text = z.read(urljoin(MANIFEST, entry.attrib["source"]))
            expected = None if entry.attrib["role"] == "document" else hashlib.sha3_256(text).hexdigest()
            assert entry.get("checksum") == expected


@pytest.mark.parametrize("flavour", Flavour)
def test_an_importer_repeats_the_run_from_the_files_in_the_fmu(
    flavour: Flavour, block: str, fmus: Fmus, tmp_path: Path
) -> None:
    """FMPy reads all of it; the tolerance is the one that the text states."""
    fmu = fmus.built(flavour, block)
    files = related(fmu)
    run = experiment(fmu, files["experiment/smoke-test"])
    times, *parts_listed = run
    parts = {part.tag: urljoin(files["experiment/smoke-test"], part.attrib["source"]) for part in parts_listed}
    assert parts == {"Parameters": files["parameter"], "Stimuli": files["other"], "References": files["result"]}
    with zipfile.ZipFile(fmu) as z:
        z.extractall(tmp_path)
    text = (tmp_path / files["document"]).read_text("utf-8")
    (messages,) = re.findall(r"within (\S+) times", " ".join(text.split()))
    reference = read_csv(tmp_path / parts["References"])
    names = list(reference.dtype.names[1:])
    assert names[:3] == ["slave.position", "slave.velocity", "slave.acceleration"]
    result = simulate_fmu(
        str(fmu),
        stop_time=float(times.attrib["stopTime"]),
        output_interval=float(times.attrib["stepSize"]),
        start_values=parameters(fmu, parts["Parameters"]),
        input=read_csv(tmp_path / parts["Stimuli"]),
        output=names,
    )
    assert times.attrib["startTime"] == "0.0"
    assert 50 <= len(np.unique(reference["time"])) <= 75
    assert reference["time"][-1] == float(times.attrib["stopTime"])
    assert_met(reference, result, float(messages))


def parameters(fmu: Path, path: str) -> dict[str, str]:
    """The values of an SSV file. It has the names of an enumeration's members, as SSP 1.0 says; FMPy wants numbers."""
    members = {
        (v.name, item.name): item.value
        for v in read_model_description(str(fmu)).modelVariables
        if v.type == "Enumeration"
        for item in v.declaredType.items
    }
    given = read_ssv(str(fmu), path, validate=True).parameters
    return {p.name: members[p.name, p.value] if p.type == "Enumeration" else p.value for p in given}


def test_the_reference_is_rounded_by_less_than_a_hundredth_of_its_tolerance(block: str) -> None:
    example = load_example(block)
    reference = read_reference(example)
    assert reference
    names, table = reference
    text = related_files(example)[f"{FOLDER}example_ref.csv"].decode()
    header, *rows = (line.split(",") for line in text.splitlines())
    columns = [0, *(1 + names.index(name.strip('"')) for name in header[1:])]
    for row in np.array(rows, float):
        deviation = np.abs(table[table[:, 0] == row[0]][:, columns] - row)  # two rows where there is a jump
        assert (deviation <= 1e-2 * example.tolerance * np.maximum(1.0, np.abs(row))).all(axis=1).any()


def test_the_reference_moves(block_fmu: Path) -> None:
    """Else there were nothing to compare."""
    with zipfile.ZipFile(block_fmu) as z:
        lines = z.read(related(block_fmu)["result"]).decode().splitlines()
    positions = [float(line.split(",")[1]) for line in lines[1:]]
    assert max(positions) - min(positions) > 50.0


@pytest.mark.parametrize(
    "recipe",
    [
        Recipe("Synchronizer", starts={"output_phasing": "45"}),
        Recipe("Synchronizer", interface=Interface(local=("status",))),
    ],
    ids=["baked start value", "another causality"],
)
def test_an_fmu_that_the_example_is_not_of_has_no_such_run(recipe: Recipe, tmp_path: Path) -> None:
    fmu = build_python(recipe, tmp_path / "Synchronizer.fmu")
    with zipfile.ZipFile(fmu) as z:
        assert not [name for name in z.namelist() if "fmi-ls-ref" in name]
        assert "fmi-ls-ref" not in z.read("documentation/index.html").decode()
