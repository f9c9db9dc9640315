"""A release: the same bytes again, complete files, and a refusal where the changelog says nothing."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.message import Message
from email.parser import HeaderParser
from html.parser import HTMLParser
from importlib.metadata import version
from pathlib import Path

import pytest
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from fmpy import read_model_description
from markdown_it import MarkdownIt
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import BuildOptions
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.recipe import Recipe
from tests import ROOT
from tests.support.hosts.fmus import Shared
from tools import release

VERSION = __version__.partition(".dev")[0]  # of the next release, or of this one
NAME = f"motionsync-{VERSION}"
MADE = {
    f"{NAME}-py3-none-any.whl",
    f"{NAME}.tar.gz",
    f"{NAME}-fmus.zip",
    f"{NAME}.cdx.json",
    "RELEASE_NOTES.md",
    "SHA256SUMS",
}
RELEASE = """
from pathlib import Path
from tests.support.project.extras import dry_run, hide_others

hide_others(*dry_run("release")[0])
from motionsync_fmu.fmus.fmu import BuildOptions, Flavour
from tools.release import make_release

make_release(Path({folder!r}), print, ["Synchronizer"], ["mm", "deg"], Flavour.PYTHON)
"""
CHANGELOG = """# Changelog

## [Unreleased]

## [2.0.0] - 2027-03-04

### Added

- Two things ([#1]).

## [1.0.0] - 2026-01-02

## [0.9.0] - 2026-01-01

- One thing.

[2.0.0]: https://example.com/2
"""


class Referring(HTMLParser):
    """The addresses in a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.addresses += [value or "" for name, value in attrs if name in ("href", "src")]


def relative(addresses: list[str]) -> set[str]:
    return {a for a in addresses if not re.match(r"https?:|data:|#", a)}


@pytest.fixture(scope="module")
def project(shared: Shared) -> Path:
    """The project as it is released: a development version gets its final number, and a section of the changelog.

    It has the scenarios of one block alone: those of all are four fifths of the source. That the wheel has them all is
    proved by tests/install/test_wheel.py."""

    def fill(folder: Path) -> None:
        others = [".git", ".venv", "build", "__pycache__", ".*_cache", ".hypothesis", *BLOCKS.keys() - {"Synchronizer"}]
        shutil.copytree(ROOT, folder / "project", ignore=shutil.ignore_patterns(*others))
        about, changes = (folder / "project" / name for name in ("fmu_src/motionsync_fmu/about.py", "CHANGELOG.md"))
        if __version__ != VERSION:
            about.write_text(about.read_text("utf-8").replace(f'"{__version__}"', f'"{VERSION}"'), "utf-8")
            heading = "## [Unreleased]\n"
            section = f"{heading}\n## [{VERSION}] - 2027-01-02\n"
            changes.write_text(changes.read_text("utf-8").replace(heading, section), "utf-8")

    return shared.once("project", fill) / "project"


@pytest.fixture(scope="module")
def made(shared: Shared, project: Path) -> Path:
    """A release with two FMUs of the python flavour, which is quick to build."""

    return shared.once("release", lambda folder: run(project, folder / "made")) / "made"


def run(project: Path, folder: Path, **environment: str) -> str:
    """Make the release in a process of its own, with nothing but what `make release` installs; return its output."""
    path = os.pathsep.join(str(project / part) for part in ("", "model", "fmu_src"))
    path = os.pathsep.join([path, os.environ.get("PYTHONPATH", "")])
    code = RELEASE.format(folder=str(folder))
    environment = {name: text for name, text in os.environ.items() if name != "SOURCE_DATE_EPOCH"} | environment
    environment["PYTHONPATH"] = path
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=project, check=True, capture_output=True, text=True, env=environment)
    return done.stdout


def test_a_release_is_complete_and_its_progress_is_reported(tmp_path: Path, project: Path, made: Path) -> None:
    messages = run(project, tmp_path / "again", PYTHONHASHSEED="7", TZ="Asia/Tokyo")
    assert messages.splitlines() == [
        "wheel and source",
        "mm/Synchronizer_mm.fmu (1 of 2)",
        "deg/Synchronizer_deg.fmu (2 of 2)",
    ]
    for folder in (made, tmp_path / "again"):
        assert {file.name for file in folder.iterdir()} == MADE
    for name in MADE:
        assert (tmp_path / "again" / name).read_bytes() == (made / name).read_bytes(), name


def test_the_checksums_are_those_of_all_other_files(made: Path) -> None:
    lines = (made / "SHA256SUMS").read_text().splitlines()
    assert [line.split("  ")[1] for line in lines] == sorted(MADE - {"SHA256SUMS"})
    for line in lines:
        messages, name = line.split("  ")
        assert hashlib.sha256((made / name).read_bytes()).hexdigest() == messages


def test_the_bill_of_materials_names_what_others_have_made(made: Path) -> None:
    """Each package that pyproject.toml names for an installation or a release, with the version that is installed, and
    the code of others that pages contain; by the schema of CycloneDX."""
    text = (made / f"{NAME}.cdx.json").read_text("utf-8")
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(text) is None
    bill = json.loads(text)
    assert (bill["metadata"]["component"]["name"], bill["metadata"]["component"]["version"]) == ("motionsync", VERSION)
    components = {c["name"]: c for c in bill["components"]}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    always = [canonicalize_name(Requirement(text).name) for text in project["dependencies"]]
    optional = [canonicalize_name(Requirement(text).name) for text in project["optional-dependencies"]["sweep"]]
    assert {components[name]["scope"] for name in always} == {"required"}
    assert {components[name]["scope"] for name in {*optional} - {*always, "motionsync"}} == {"optional"}
    for name in {*always, *optional} - {"motionsync"}:
        assert components[name]["purl"] == f"pkg:pypi/{name}@{version(name)}"
    bundled = {c["purl"] for c in bill["components"] if c["purl"].startswith("pkg:npm/")}
    vendor = (ROOT / "fmu_src" / "motionsync_fmu" / "pages" / "vendor" / "README.md").read_text("utf-8")
    plotly, uplot = re.findall(r"plotly\.js ([\d.]+),|uPlot ([\d.]+);", vendor)
    assert bundled == {f"pkg:npm/plotly.js-basic-dist-min@{plotly[0]}", f"pkg:npm/uplot@{uplot[1]}"}
    refs = {c["bom-ref"] for c in bill["components"]}
    (root,) = [d for d in bill["dependencies"] if d["ref"] == bill["metadata"]["component"]["bom-ref"]]
    assert {*root["dependsOn"]} == refs


def test_every_fmu_has_its_unit_in_its_name_and_its_page_beside_it(made: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(made / f"{NAME}-fmus.zip") as z:
        z.extractall(tmp_path)
        names = set(z.namelist())
    fmus = {"mm/Synchronizer_mm", "deg/Synchronizer_deg"}
    assert names == {"LICENSE", "README.html"} | {f"{fmu}.{kind}" for fmu in fmus for kind in ("fmu", "html")}
    for fmu in fmus:
        block, unit = fmu.split("/")[1].split("_")
        result = read_model_description(str(tmp_path / f"{fmu}.fmu"))
        assert (result.modelName, result.version) == (block, VERSION)
        assert {t.name: t.unit for t in result.typeDefinitions}["Position"] == unit
        page = (tmp_path / f"{fmu}.html").read_text("utf-8")
        assert f"<h1>{block}</h1>" in page
        addresses = Referring(page).addresses
        assert sum(a.startswith("data:image/svg+xml;base64,") for a in addresses) == 1
        assert relative(addresses) <= {"externalDependencies.html"}  # of the python flavour alone
    first = (tmp_path / "README.html").read_text("utf-8")
    assert VERSION in first
    assert relative(Referring(first).addresses) <= names
    assert {f"{fmu}.fmu" for fmu in fmus} <= set(Referring(first).addresses)


@pytest.mark.all_blocks
def test_all_blocks_in_three_units_are_released_natively(
    tmp_path: Path, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is built when nothing is chosen; the build itself is another test's."""
    built = []

    def build(recipe: Recipe, target: Path, options: BuildOptions, progress: release.Progress) -> Path:
        assert options.with_sources
        built.append((options.flavour, recipe.name, recipe.unit, recipe.fmi))
        assert recipe.slave_unit == ("deg" if recipe.name == "RotaryKnife" else "")
        page = f"<code>motionsync explore {recipe.name}</code>"
        write_zip(target, {"documentation/index.html": page.encode(), "documentation/example.svg": b""})
        return target

    def make_site(folder: Path, explore_pages: Path) -> None:
        """The files of the site; what they are is another test's."""
        (folder / "how_to").mkdir(parents=True)
        for name, block in (("index.html", "CutToLength"), ("how_to/wiring.html", "Gearing")):
            (folder / name).write_text((explore_pages / f"{block}.html").read_text())

    monkeypatch.setattr(release, "build", build)
    monkeypatch.setattr(release, "write_page", lambda name, scenarios, fmu, target, notify: target.write_text(name))
    monkeypatch.setattr(release, "build_package", lambda folder: None)
    monkeypatch.setattr(release, "make_site", make_site)
    monkeypatch.setattr(release, "__version__", VERSION)
    monkeypatch.setattr(release, "ROOT", project)
    release.make_release(tmp_path / "all", lambda text: None)
    assert sorted(built) == sorted(
        ("native", block, unit, fmi) for block in BLOCKS for unit in ("mm", "m", "deg") for fmi in ("2", "3")
    )
    with zipfile.ZipFile(tmp_path / "all" / f"{NAME}-fmus.zip") as z:
        assert len(z.namelist()) == 2 + 3 * 3 * len(BLOCKS) + len(BLOCKS)
        assert z.read("explore/FlyingSaw.html") == b"FlyingSaw"
        assert "mm/fmi3/FlyingSaw_mm.fmu" in z.namelist()
        assert b'href="../explore/FlyingSaw.html"' in z.read("deg/FlyingSaw_deg.html")
        first = z.read("README.html").decode()
        assert relative(Referring(first).addresses) == set(z.namelist()) - {"README.html"}
    with zipfile.ZipFile(tmp_path / "all" / f"{NAME}-site.zip") as z:
        assert {name: z.read(name) for name in z.namelist()} == {
            "index.html": b"CutToLength",
            "how_to/wiring.html": b"Gearing",
        }


def test_the_date_is_that_of_the_changelog(project: Path, made: Path) -> None:
    (date,) = re.findall(rf"^## \[{re.escape(VERSION)}\] - (.*)$", changelog(project), re.M)
    for archive in (f"{NAME}-fmus.zip", f"{NAME}-py3-none-any.whl"):
        with zipfile.ZipFile(made / archive) as z:
            assert {"{:04}-{:02}-{:02}".format(*i.date_time) for i in z.infolist()} == {date}
    with tarfile.open(made / f"{NAME}.tar.gz") as t:
        assert len({member.mtime for member in t}) == 1


def test_source_date_epoch_is_honoured_and_left_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    for given, messages in (("1700000000", "1700000000"), (None, "86400")):
        monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
        if given:
            monkeypatch.setenv("SOURCE_DATE_EPOCH", given)
        with release.date_files(86400):
            assert os.environ["SOURCE_DATE_EPOCH"] == messages
        assert os.environ.get("SOURCE_DATE_EPOCH") == given
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "soon")
    with pytest.raises(UserError, match="SOURCE_DATE_EPOCH = soon is not allowed"), release.date_files(0):
        pass


# --- the changelog ---


def changelog(project: Path = ROOT) -> str:
    return (project / "CHANGELOG.md").read_text("utf-8")


def test_the_notes_are_the_changelog_of_the_version(project: Path, made: Path) -> None:
    section = changelog(project).split(f"## [{VERSION}] - ")[1].split("\n## ")[0]
    assert (made / "RELEASE_NOTES.md").read_text("utf-8").split() == section.split()[1:]  # without the date


def test_a_section_ends_where_another_or_the_links_begin() -> None:
    messages = release.read_notes(CHANGELOG, "2.0.0")
    assert messages == release.Notes("### Added\n\n- Two things ([#1]).\n", 1804118400)  # 2027-03-04: 20,881 days
    assert release.read_notes(CHANGELOG, "0.9.0").text == "- One thing.\n"


@pytest.mark.parametrize("version", ["3.0.0", "1.0.0", "2.0", "2x0.0", "Unreleased"])
def test_a_version_of_which_the_changelog_says_nothing_is_refused(version: str) -> None:
    with pytest.raises(UserError, match=f"^CHANGELOG.md has no text on version {version}: write what has changed"):
        release.read_notes(CHANGELOG, version)


def test_nothing_is_made_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(release, "__version__", "99.0.0")
    monkeypatch.setattr(release, "ROOT", tmp_path)
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    with pytest.raises(SystemExit) as e:
        release.main()
    assert str(e.value.code).startswith("release: CHANGELOG.md has no text on version 99.0.0: write")
    assert "\n" not in str(e.value.code)
    assert [file.name for file in tmp_path.iterdir()] == ["CHANGELOG.md"]


def test_a_development_version_is_not_released(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(release, "__version__", "2.0.0.dev0")
    monkeypatch.setattr(release, "ROOT", tmp_path)
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    with pytest.raises(UserError, match=r"^2\.0\.0\.dev0 is a development version: write 2\.0\.0 into .*about\.py"):
        release.make_release(tmp_path / "made", print)
    assert [file.name for file in tmp_path.iterdir()] == ["CHANGELOG.md"]


def test_a_state_with_unreleased_changes_is_a_development_version_of_a_later_release() -> None:
    """Any other state is that of the newest release in the changelog."""
    _, unreleased, *_ = changelog().split("\n## ")
    assert unreleased.startswith("[Unreleased]\n")
    (newest, *_) = re.findall(r"^## \[(\d+\.\d+\.\d+)\]", changelog(), re.M)
    current = Version(__version__)
    if unreleased.strip() == "[Unreleased]":
        assert current >= Version(newest)
    else:
        assert current.is_devrelease
    if current.is_devrelease:
        assert Version(current.base_version) > Version(newest)


def test_the_changelog_is_in_order() -> None:
    dates = re.findall(r"^## \[\d+\.\d+\.\d+\] - (\d{4}-\d\d-\d\d)$", changelog(), re.M)
    assert dates == sorted(dates, reverse=True)
    assert re.findall(r"^## \[(.*?)\]", changelog(), re.M)[0] == "Unreleased"


# --- the package ---


def metadata(made: Path) -> Message:
    with zipfile.ZipFile(made / f"{NAME}-py3-none-any.whl") as z:
        (file,) = (name for name in z.namelist() if name.endswith(".dist-info/METADATA"))
        return HeaderParser().parsestr(z.read(file).decode())


def test_the_package_names_authors_and_addresses(made: Path) -> None:
    result = metadata(made)
    home = "https://github.com/motionsync/motionsync"
    assert result["Version"] == VERSION
    assert result["Author"] == "The motionsync authors"
    assert result.get_all("Project-URL") == [
        f"Homepage, {home}",
        f"Repository, {home}",
        f"Changelog, {home}/blob/v{VERSION}/CHANGELOG.md",
        f"Issues, {home}/issues",
    ]


def test_the_readme_in_the_package_refers_to_no_file_but_by_its_address(made: Path) -> None:
    text = metadata(made).get_payload()
    assert isinstance(text, str)
    shipped = (ROOT / "README.md").read_text("utf-8")
    release_links, readme_links = (
        Referring(MarkdownIt("commonmark").enable("table").render(t)).addresses for t in (text, shipped)
    )
    assert not relative(release_links)
    assert relative(readme_links)  # else this test sees nothing
    at = rf"https://github\.com/motionsync/motionsync/(raw|blob)/v{re.escape(VERSION)}/"
    assert [re.sub(at, "", address) for address in release_links] == readme_links
    assert all((ROOT / address.partition("#")[0]).exists() for address in relative(readme_links))
    assert re.findall(r"```.*?```", text, re.S) == re.findall(r"```.*?```", shipped, re.S)


def test_the_source_gives_the_same_wheel(made: Path, tmp_path: Path) -> None:
    with tarfile.open(made / f"{NAME}.tar.gz") as t:
        t.extractall(tmp_path, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))  # since 3.11.4
        (time,) = {str(int(member.mtime)) for member in t}
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)]
    environment = os.environ | {"SOURCE_DATE_EPOCH": time}
    subprocess.run(command, cwd=tmp_path / NAME, check=True, capture_output=True, env=environment)
    wheel = f"{NAME}-py3-none-any.whl"
    assert (tmp_path / wheel).read_bytes() == (made / wheel).read_bytes()
