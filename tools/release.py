"""Makes all files of a release: `python -m tools.release` writes them to build/release.

| file | what it is |
| --- | --- |
| motionsync-<version>-py3-none-any.whl, motionsync-<version>.tar.gz | the package, as wheel and as source |
| motionsync-<version>-fmus.zip | the FMUs of all blocks (FMI 2.0 and 3.0, in several units), pages, pages to explore |
| motionsync-<version>-site.zip | the documentation, which opens from its folder; natively |
| motionsync-<version>.cdx.json | the software bill of materials, in CycloneDX |
| RELEASE_NOTES.md | this version's section of CHANGELOG.md |
| SHA256SUMS | the other files' checksums, for `sha256sum --check` |

The date of the version in CHANGELOG.md is that of all files, unless SOURCE_DATE_EPOCH gives another: the same sources
make the same bytes.
"""

import base64
import calendar
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from motionsync.blocks import BLOCKS
from motionsync_fmu.about import HOME, __version__
from motionsync_fmu.errors import UserError
from motionsync_fmu.explorer.page import scenarios_of, write_page
from motionsync_fmu.fmus.fmu import BuildOptions, Flavour, build
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.build_time import build_time
from motionsync_fmu.interface.fingerprint import Files
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.interface.variables import summary
from motionsync_fmu.pages.block_page import PICTURE
from motionsync_fmu.pages.style import load_template
from tools.sbom import make_sbom
from tools.site.build import make_site

ROOT = Path(__file__).parent.parent
UNITS = ("mm", "m", "deg")
EXPLORE = "explore/"  # the folder of the pages to explore the blocks
SECTION = r"^## \[{version}\] - (\d{{4}})-(\d\d)-(\d\d)$(.*?)(?=^## |^\[[^]]+\]: |\Z)"  # of Keep a Changelog
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Notes:
    """The changelog's section on a version.

    Attributes:
        text: in Markdown, without the section's heading.
        time: the version's date, in s since 1970.
    """

    text: str
    time: int


def read_notes(changelog: str, version: str) -> Notes:
    """The changelog's section of a version.

    Raises:
        UserError: there is none, or it is empty.
    """
    match = re.search(SECTION.format(version=re.escape(version)), changelog, re.M | re.S)
    if not match or not match[4].strip():
        raise UserError(
            f"CHANGELOG.md has no text on version {version}: write what has changed under "
            f"'## [{version}] - <year>-<month>-<day>' before it is released"
        )
    year, month, day = (int(part) for part in match.groups()[:3])
    return Notes(match[4].strip() + "\n", calendar.timegm((year, month, day, 0, 0, 0)))


def make_release(
    folder: Path,
    progress: Progress,
    blocks: Iterable[str] = BLOCKS,
    units: Iterable[str] = UNITS,
    flavour: Flavour = Flavour.NATIVE,
) -> None:
    """Make a release in a folder that then holds nothing else.

    `progress` is called with a line of text before each task. There is an FMU of each block in each unit, natively for
    each version of FMI.

    Raises:
        UserError: this is a development version, the changelog has no text on it, or an FMU cannot be built.
    """
    if ".dev" in __version__:
        final = __version__.partition(".dev")[0]
        raise UserError(
            f"{__version__} is a development version: write {final} into fmu_src/motionsync_fmu/about.py before it is "
            "released"
        )
    current = read_notes((ROOT / "CHANGELOG.md").read_text("utf-8"), __version__)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with (
        date_files(current.time),
        tempfile.TemporaryDirectory(dir=folder.parent, prefix=f"{folder.name}.") as work,
    ):
        part = Path(work, folder.name)
        part.mkdir()
        progress("wheel and source")
        build_package(part)
        fmus = build_fmus(list(blocks), list(units), flavour, progress)
        write_zip(part / f"motionsync-{__version__}-fmus.zip", fmus)
        explore_pages = {name: page for name, page in fmus.items() if name.startswith(EXPLORE)}
        if len(explore_pages) == len(BLOCKS):
            progress("site")
            write_zip(part / f"motionsync-{__version__}-site.zip", build_site(explore_pages))
        sbom = make_sbom(build_time() or current.time)
        (part / f"motionsync-{__version__}.cdx.json").write_bytes(sbom.encode())
        (part / "RELEASE_NOTES.md").write_bytes(current.text.encode())
        (part / "SHA256SUMS").write_bytes(checksums(part).encode())
        shutil.rmtree(folder, ignore_errors=True)
        part.rename(folder)


@contextmanager
def date_files(time: int) -> Iterator[None]:
    """In this context all files get this time, in s since 1970, unless SOURCE_DATE_EPOCH gives another one.

    Raises:
        UserError: SOURCE_DATE_EPOCH is no such time.
    """
    before = os.environ.get("SOURCE_DATE_EPOCH")
    os.environ["SOURCE_DATE_EPOCH"] = before or str(time)
    try:
        build_time()
        yield
    finally:
        if before is None:
            del os.environ["SOURCE_DATE_EPOCH"]
        else:
            os.environ["SOURCE_DATE_EPOCH"] = before


def build_package(folder: Path) -> None:
    """The package as wheel and as source.

    Raises:
        UserError: Hatchling failed.
    """
    command = [sys.executable, "-m", "hatchling", "build", "--directory", str(folder)]
    result = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    if result.returncode:
        raise UserError(f"the package cannot be made: {result.stderr.strip()}")


def build_fmus(blocks: list[str], units: list[str], flavour: Flavour, progress: Progress) -> Files:
    """The files in the archive of FMUs: <unit>/<block>_<unit>.fmu and its page, <unit>/fmi3/<block>_<unit>.fmu, a first
    page, the licence; natively explore/<block>.html, too."""
    native = flavour == Flavour.NATIVE
    versions = list(Fmi) if native else [Fmi.TWO]
    first_page = make_first_page(blocks, units, native=native)
    files: Files = {"LICENSE": (ROOT / "LICENSE").read_bytes(), "README.html": first_page}
    recipes = [Recipe(block, unit, fmi=fmi) for unit in units for fmi in versions for block in blocks]
    with tempfile.TemporaryDirectory() as folder:
        for i, recipe in enumerate(recipes, 1):
            folder_name = recipe.unit if recipe.fmi == Fmi.TWO else f"{recipe.unit}/fmi3"
            name = f"{folder_name}/{recipe.name}_{recipe.unit}"
            progress(f"{name}.fmu ({i} of {len(recipes)})")
            fmu = build(recipe, Path(folder, f"{name}.fmu"), BuildOptions(flavour, with_sources=native), progress)
            files[f"{name}.fmu"] = fmu.read_bytes()
            if recipe.fmi == Fmi.TWO:
                files[f"{name}.html"] = page_with_picture(fmu, recipe.name, native=native)
            if native and (recipe.unit, recipe.fmi) == (units[0], Fmi.TWO):
                explore_page = Path(folder, f"{recipe.name}.html")
                write_page(recipe.name, scenarios_of(recipe.name), fmu, explore_page, progress)
                files[f"{EXPLORE}{recipe.name}.html"] = explore_page.read_bytes()
    return files


def build_site(explore_pages: Files) -> Files:
    """The files of the documentation; `explore_pages`: explore/<block>.html of all blocks.

    Raises:
        UserError: a page is missing, or a link leads nowhere.
    """
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work, "site")
        Path(work, EXPLORE).mkdir()
        for name, page in explore_pages.items():
            Path(work, name).write_bytes(page)
        make_site(folder, Path(work, EXPLORE))
        files = (file for file in folder.rglob("*") if file.is_file())
        return {file.relative_to(folder).as_posix(): file.read_bytes() for file in sorted(files)}


def make_first_page(blocks: list[str], units: list[str], *, native: bool) -> bytes:
    """The page that describes the FMUs; `native`: whether there are some of FMI 3.0, and pages to explore."""
    values = {
        "version": __version__,
        "home": HOME,
        "units": units,
        "native": native,
        "blocks": {block: summary(BLOCKS[block]) for block in blocks},
    }
    return load_template(Path(__file__).parent, "fmus.html.j2").render(values).encode()


def page_with_picture(fmu: Path, name: str, *, native: bool) -> bytes:
    """An FMU's page with its picture in it, as one file; `native`: with a link to the page to explore the block."""
    with zipfile.ZipFile(fmu) as z:
        text, picture = (z.read(f"documentation/{name}") for name in ("index.html", PICTURE))
    source = b'src="data:image/svg+xml;base64,' + base64.b64encode(picture) + b'"'
    whole = text.replace(b'src="' + PICTURE.encode() + b'"', source)
    command = f"<code>motionsync explore {name}</code>"
    link = f'<a href="../explore/{name}.html">{name}, explored</a>' if native else command
    return whole.replace(command.encode(), link.encode())


def checksums(folder: Path) -> str:
    return "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in sorted_files(folder))


def sorted_files(folder: Path) -> Iterator[Path]:
    """The files in a folder, by name."""
    yield from sorted(folder.iterdir())


def main() -> None:
    """Make the release of all FMUs in build/release, and list its files."""
    folder = ROOT / "build" / "release"
    try:
        make_release(folder, lambda text: print(text, flush=True))
    except UserError as e:
        sys.exit(f"release: {e}")
    for file in sorted_files(folder):
        print(f"{file.relative_to(ROOT)}  {file.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
