"""modelDescription.xml of FMI 3.0: that of FMI 2.0 in the words of the newer standard.

Everything that is declared is described by `fmi2_xml.describe`. A unit of FMI 3.0 has no event mode and no intermediate
update: a command is an edge at the start of a step, and a step is computed to its end at once.
"""

from collections.abc import Iterable, Iterator
from xml.etree.ElementTree import Element, SubElement

TIME = "time"  # the independent variable, which FMI 3.0 demands; its value reference comes after those of the block
TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}
ABILITIES = {  # of the CoSimulation element: FMI 2.0's name of what has another one in FMI 3.0, or nothing
    "canGetAndSetFMUstate": "canGetAndSetFMUState",
    "canSerializeFMUstate": "canSerializeFMUState",
    "canInterpolateInputs": "",
    "canNotUseMemoryManagementFunctions": "",
}
NOT_OFFERED = {"hasEventMode": "false", "providesIntermediateUpdate": "false"}


def translated(former: Element) -> Element:
    """The description of FMI 3.0 for one of FMI 2.0, with the same value references; both have the same GUID."""
    attributes = {"instantiationToken" if name == "guid" else name: text for name, text in former.attrib.items()}
    root = Element("fmiModelDescription", attributes | {"fmiVersion": "3.0"})
    unit = _single_child(former, "CoSimulation")
    able = {ABILITIES.get(name, name): text for name, text in unit.attrib.items()}
    SubElement(root, "CoSimulation", {name: text for name, text in able.items() if name} | NOT_OFFERED)
    root.append(_units(_single_child(former, "UnitDefinitions")))
    SubElement(root, "TypeDefinitions").extend(_types(_single_child(former, "TypeDefinitions")))
    root.extend(_single_child(former, name) for name in ("LogCategories", "DefaultExperiment"))
    variables = _single_child(former, "ModelVariables")
    model = SubElement(root, "ModelVariables")
    model.extend(_variable(scalar) for scalar in variables)
    model.append(_time(str(len(variables))))
    SubElement(root, "ModelStructure").extend(_structure(_single_child(former, "ModelStructure")))
    return root


def build_description(name: str, files: Iterable[str]) -> Element:
    """sources/buildDescription.xml: the C files that the sources of the FMU are compiled from; `name`: of the block."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    sources = SubElement(SubElement(root, "BuildConfiguration", modelIdentifier=name), "SourceFileSet", language="C99")
    for file in files:
        SubElement(sources, "SourceFile", name=file)
    return root


def _single_child(parent: Element, name: str) -> Element:
    """The child of that name, which the description has once."""
    (child,) = parent.findall(name)
    return child


def _units(former: Element) -> Element:
    """The units, with the second, which the block may lack and time has."""
    units = Element("UnitDefinitions")
    units.extend(former)
    if former.find("Unit[@name='s']") is None:
        SubElement(SubElement(units, "Unit", name="s"), "BaseUnit", s="1")
    return units


def _types(former: Element) -> Iterator[Element]:
    for simple in former:
        (kind,) = simple
        new = Element(f"{TYPES[kind.tag]}Type", simple.attrib | kind.attrib)
        new.extend(kind)
        yield new


def _variable(scalar: Element) -> Element:
    (kind,) = scalar
    return Element(TYPES[kind.tag], scalar.attrib | kind.attrib)


def _time(reference: str) -> Element:
    return Element(
        TYPES["Real"],
        name=TIME,
        valueReference=reference,
        description="the end of the last step",
        causality="independent",
        variability="continuous",
        unit="s",
    )


def _structure(former: Element) -> Iterator[Element]:
    """FMI 2.0 counts variables from 1; FMI 3.0 names them by their value references, which are counted from 0."""

    def references(indices: str) -> str:
        return " ".join(str(int(index) - 1) for index in indices.split())

    for group, name in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        for unknown in _single_child(former, group):
            yield Element(
                name,
                valueReference=references(unknown.get("index", "")),
                dependencies=references(unknown.get("dependencies", "")),
            )
