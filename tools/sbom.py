"""The software bill of materials of a release, in CycloneDX: what is in it that others have made, and what it needs."""

import re
from datetime import UTC, datetime
from importlib.metadata import metadata
from uuid import NAMESPACE_URL, uuid5

from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentScope, ComponentType
from cyclonedx.model.license import DisjunctiveLicense, LicenseExpression
from cyclonedx.output.json import JsonV1Dot6
from packageurl import PackageURL

from motionsync_fmu.about import HOME, __version__
from motionsync_fmu.explorer.page import VENDOR
from tools.requirements import distributions_of

BUNDLED = re.compile(r"\| (\S+) ([\d.]+)[,;].*?npm package `([\w.-]+)`")  # in the list of vendored code


def make_sbom(time: int) -> str:
    """The bill of this version, in JSON: the same bytes for the same sources and packages. `time`: that of the release,
    in s since 1970.

    A package that every installation needs is required; one that only sweeps, FMUs of the native flavour or the
    documentation need is optional."""
    root = Component(
        name="motionsync",
        version=__version__,
        type=ComponentType.APPLICATION,
        licenses=[DisjunctiveLicense(id="MIT")],
        bom_ref="motionsync",
    )
    bom = Bom(serial_number=uuid5(NAMESPACE_URL, f"{HOME}@{__version__}"))
    bom.metadata.component = root
    bom.metadata.timestamp = datetime.fromtimestamp(time, UTC)
    always = distributions_of()
    components = [installed(name, name in always) for name in sorted(distributions_of("release"))]
    components += [
        Component(
            name=package,
            version=version,
            type=ComponentType.LIBRARY,
            scope=ComponentScope.REQUIRED,
            purl=PackageURL("npm", None, package, version),
            bom_ref=f"npm:{package}",
            licenses=[DisjunctiveLicense(id="MIT")],
        )
        for _, version, package in BUNDLED.findall((VENDOR / "README.md").read_text("utf-8"))
    ]
    for component in components:
        bom.components.add(component)
    bom.register_dependency(root, components)
    return JsonV1Dot6(bom).output_as_string(indent=2) + "\n"


def installed(name: str, is_required: bool) -> Component:
    """An installed package of Python."""
    about = metadata(name)
    version, expression = about["Version"], str(about.json.get("license_expression", ""))
    return Component(
        name=name,
        version=version,
        type=ComponentType.LIBRARY,
        scope=ComponentScope.REQUIRED if is_required else ComponentScope.OPTIONAL,
        purl=PackageURL("pypi", None, name, version),
        bom_ref=f"pypi:{name}",
        licenses=[LicenseExpression(expression)] if expression else [],
    )
