"""terminalsAndIcons.xml (FMI 3.0, section 2.4.9; FMI 2.0.4 allows the same file): what is wired together. In FMI 3.0 it
also says where the icon is drawn."""

from collections.abc import Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from .fmi2_xml import content
from .recipe import Fmi
from .roles import MOTION
from .table import Group, groups

FOLDER = "terminalsAndIcons"
AXIS = "_motionsync_Axis"  # a terminal kind that the standard does not know starts with an underscore and its maker
EXTENT = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
MILLIMETRES = "0.1"  # of a unit of the extent: the icon is 20 mm wide


def terminals(block: Any, overrides: Mapping[str, str] | None = None, fmi: Fmi = Fmi.TWO) -> bytes:
    """The content of the file: a terminal for each group of variables that has inputs or outputs.

    Two terminals of the kind AXIS are wired by the members that both have: the slave of one block to the master or
    remote axis of another. `overrides`: as for `variables`; `fmi`: the version: the icon of FMI 2.0 is model.png."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    if fmi == Fmi.THREE:
        graphics = SubElement(root, "GraphicalRepresentation")
        SubElement(graphics, "CoordinateSystem", EXTENT | {"suggestedScalingFactorTo_mm": MILLIMETRES})
        SubElement(graphics, "Icon", EXTENT)
    listed = SubElement(root, "Terminals")
    for group in groups(block, "1", overrides=overrides):
        if group.name:
            _terminal(listed, group)
    return content(root)


def _terminal(parent: Element, group: Group) -> None:
    wired = [row.name for row in group.rows if row.causality in ("input", "output")]
    members = {name.removeprefix(f"{group.name}."): name for name in wired}
    if not members:
        return
    kind = {"terminalKind": AXIS} if members.keys() >= {*MOTION} else {}
    terminal = SubElement(parent, "Terminal", kind, name=group.name, matchingRule="bus", description=group.summary)
    for member, name in members.items():
        SubElement(terminal, "TerminalMemberVariable", variableName=name, memberName=member, variableKind="signal")
