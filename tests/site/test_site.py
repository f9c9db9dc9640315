"""The documentation site: its links lead somewhere, its references are complete, and no page shows Markdown."""

import posixpath
import re
import tomllib
from collections.abc import Iterator
from typing import Any
from urllib.parse import unquote

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu import scenarios
from motionsync_fmu.about import HOME, __version__
from motionsync_fmu.commands.app import COMMANDS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import members
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command
from tests.support.project.site import Site, SitePage, made_site
from tools.site.reference import block_reference, without_usual_end

ELSEWHERE = re.compile(r"[a-z]+:")
REVISION = "main" if __version__.endswith(".dev0") else f"v{__version__}"
REPOSITORY = re.compile(rf"{re.escape(HOME)}/(?:blob|tree)/{re.escape(REVISION)}/([^#]*)")
OWN_ANCHORS = {"", "__skip", "__search"}  # of the theme
LEFT = re.compile(r"\]\(|\*\*|\| ?---|(?:^|\S)\n {0,3}(?:\d+\.|[-*]) |<!--|```")  # the fourth: a list in a paragraph


@pytest.fixture(scope="module")
def site(fmus: Fmus, request: pytest.FixtureRequest) -> Site:
    """With --registered, the page to explore is that block's, which other tests need then."""
    return made_site(fmus, request.config.getoption("--registered") or "CutToLength")


def test_every_link_leads_to_a_page_an_anchor_or_a_file_of_the_project(site: Site) -> None:
    """Nothing but a link leads out of the site: neither a script nor a font nor a picture comes from the network."""
    broken = []
    for path, page in site.pages.items():
        for tag, address in page.addresses:
            if file := REPOSITORY.fullmatch(address.partition("#")[0]):
                assert (ROOT / file[1]).exists(), f"{path}: {address}"
            elif ELSEWHERE.match(address):
                assert tag == "a", f"{path}: {address}"
            else:
                name, _, anchor = unquote(address).partition("#")
                target = posixpath.normpath(posixpath.join(posixpath.dirname(path), name)) if name else path
                anchors = site.pages[target].anchors | OWN_ANCHORS if target in site.pages else {anchor}
                if not (site.folder / target).is_file() or anchor not in anchors:
                    broken.append(f"{path}: {address}")
    assert not broken


def test_no_page_shows_markdown(site: Site) -> None:
    shown = [(path, text) for path, page in site.pages.items() for text in page.prose if LEFT.search(text)]
    assert not shown


def test_every_page_of_the_project_is_on_the_site(site: Site) -> None:
    sources = [*(ROOT / "docs").rglob("*.md")]
    pages = {file.relative_to(ROOT / "docs").with_suffix(".html").as_posix() for file in sources}
    assert pages - {"assets/README.html"} <= site.pages.keys()


def test_the_first_page_has_the_machine_and_the_two_commands(site: Site) -> None:
    first = site.pages["index.html"]
    assert ("iframe", "explore/CutToLength.html") in first.addresses
    assert (site.folder / "explore" / "CutToLength.html").stat().st_size > 100_000
    assert any("make run" in code and "make test" in code for code in first.code)
    assert ("img", "first_picture.svg") in first.addresses


def test_every_block_has_a_page(site: Site) -> None:
    """With its README first, and then its variables; it leads to the page on which the block is moved by hand."""
    folders = {file.parent.name.replace("_", "") for file in (ROOT / "model" / "motionsync").glob("*/block.py")}
    pages = {path: page for path, page in site.pages.items() if path.startswith("reference/blocks/")}
    assert {path.split("/")[-1].removesuffix(".html").lower() for path in pages} == folders
    for path, page in pages.items():
        assert {"how-to-use-it", "states", "variables"} <= page.anchors
        assert ("a", f"../../explore/{posixpath.basename(path)}") in page.addresses


def test_the_reference_of_a_block_has_its_variables_members_and_codes(block: str) -> None:
    page = SitePage(block_reference(block))
    recipe = Recipe(block)
    names = set(recipe.variables)
    for v in recipe.variables.values():
        names |= {member.name for member in v.choices}
        if v.declaration.codes:
            names |= {member.name for member in members(v.declaration.codes)}
    names |= set(scenarios(block))
    assert names <= set(page.code)
    text = " ".join(page.prose)
    for v in recipe.variables.values():
        assert v.declaration.description in text, v.name


@pytest.mark.parametrize(
    ("allowed", "shown"),
    [
        ("0 to 1e+12", "≥ 0"),
        ("0, or 1e-09 to 1e+12", "0, or ≥ 1e-09"),
        ("> 0 and <= 1e+12", "> 0"),
        ("-1e+12 to 1e+12", "-1e+12 to 1e+12"),
        ("0 to 0.15", "0 to 0.15"),
    ],
)
def test_the_usual_end_of_a_range_is_left_out(allowed: str, shown: str) -> None:
    assert without_usual_end(allowed) == shown


def test_the_reference_of_commands_has_what_the_help_prints(site: Site, motionsync: Command) -> None:
    page = site.pages["reference/commands.html"]
    written = " ".join(page.code)
    seen = 0
    for name in COMMANDS:
        assert f"motionsync-{name}" in page.anchors
        printed = motionsync(name, "--help").out
        options = set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", printed, re.M)) - {"--help"}
        seen += len(options)
        for option in options:
            assert re.search(rf"{option}\b", written), f"{name} {option}"
    assert seen > 40
    assert ("a", "../how_to/lines.html") in page.addresses  # a file that a help names


def test_the_reference_of_python_has_what_the_package_offers(site: Site) -> None:
    """The names in the stub that type checkers read."""
    stub = (ROOT / "fmu_src" / "motionsync_fmu" / "__init__.pyi").read_text("utf-8")
    names = set(re.findall(r"import \w+ as (\w+)", stub)) - {"__version__"}
    page = site.pages["reference/python.html"]
    text = {part.strip() for part in [*page.prose, *page.code]}
    assert names
    assert names <= text
    results = {"Piece", "Rows", "FaultCode", "LineOutcome", "MachinePlan", "BatchResult", "ScenarioOutcome", "Row"}
    anchors = {anchor.rpartition(".")[2]: anchor for anchor in page.anchors if anchor.startswith("motionsync_fmu.")}
    assert results <= anchors.keys()
    assert ("a", f"#{anchors['Piece']}") in page.addresses  # where a property has this type
    assert not [part for part in text if re.fullmatch(r"\w+,", part)]  # a docstring has one name in a row


@pytest.mark.all_blocks
def test_the_names_of_plcopen_are_complete(site: Site) -> None:
    """Each command of the FlyingSaw, each of PLCopen's states that it shows, and each block."""
    page = site.pages["reference/plcopen.html"]
    variables = Recipe("FlyingSaw").variables
    assert {f"{name.partition('.')[0]}.*" for name in variables if name.endswith(".execute")} <= set(page.code)
    cells = {part.strip() for part in page.prose}
    assert {f"{member.value} {member.name}" for member in variables["plcopen_state"].choices} <= cells
    assert {*BLOCKS} <= cells


def test_the_reference_of_scenario_files_has_every_key_of_the_shipped_ones(site: Site) -> None:
    code = set(site.pages["reference/scenario_keys.html"].code)
    seen = 0
    for file in (ROOT / "scenarios").rglob("scenario.toml"):
        scenario = tomllib.loads(file.read_text("utf-8"))
        for key in keys(scenario, Recipe(scenario["fmu"]).variables.keys()):
            seen += 1
            assert key in code or key in TABLE_NAMES, f"{file}: {key}"
    assert seen > 1000


TABLE_NAMES = {
    "interface",
    "start",
    "master",
    "remote",
    "encoder",
    "servo",
    "load",
    "set",
    "on",
    "expect",
    "cuts",
    "picture",
}
IN_BRACES = {"min", "max", "amplitude", "cycle"}  # shown with the key of their table


def keys(value: Any, variables: Any) -> Iterator[str]:
    """The keys of a table and of those inside it that are no names of variables."""
    if isinstance(value, list):
        for part in value:
            yield from keys(part, variables)
    elif isinstance(value, dict):
        for key, inner in value.items():
            computed = key.startswith(("actual.", "load."))
            if key not in variables and not computed and key not in IN_BRACES:
                yield key
            if key not in ("variants", "curves"):
                yield from keys(inner, variables)


def test_a_section_of_another_file_comes_with_its_links(site: Site) -> None:
    """The README links to docs/how_to/wiring.md, and to a file in examples/, which is a page, too."""
    addresses = {address for _, address in site.pages["explanation/proof.html"].addresses}
    assert {"../how_to/wiring.html#fmi-20-or-fmi-30", "../how_to/axis_in_modelica.html"} <= addresses
