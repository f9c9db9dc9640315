"""Which file of the project each page of the site is made from, and the links between the pages."""

import posixpath
import re
from functools import cache
from pathlib import Path

from motionsync.blocks import BLOCKS
from motionsync_fmu.about import HOME, REVISION
from motionsync_fmu.interface.block_folder import block_file
from motionsync_fmu.pages.readme import FILE

ROOT = Path(__file__).parents[2]
DOCS = "docs"
BLOCK_PAGE = "reference/blocks/{}.md"
ELSEWHERE = re.compile(r"[a-z]+:|#|<")  # how a link starts that leads to no file
LINK = re.compile(r"(?<=\]\()([^)\s]+)(?=\))")
CODE = re.compile(r"(^ *```.*?^ *```$|`[^`\n]+`)", re.M | re.S)
SECTION = re.compile(r"^<!-- section: (\S+?)#(.+?) -->\n.*$", re.M)


@cache
def made_pages() -> dict[str, str]:
    """The pages that are made from files outside docs/, each with its file."""
    readmes = {
        BLOCK_PAGE.format(name): block_file(block, FILE).resolve().relative_to(ROOT).as_posix()
        for name, block in BLOCKS.items()
    }
    return readmes | {
        "how_to/scenarios.md": "scenarios/README.md",
        "how_to/lines.md": "scenarios/line/README.md",
        "how_to/axis_in_modelica.md": "examples/modelica/README.md",
        "explanation/contributing.md": "CONTRIBUTING.md",
        "reference/changes.md": "CHANGELOG.md",
    }


def source_of(page: str) -> str:
    """The file that a page is made from."""
    return made_pages().get(page, f"{DOCS}/{page}")


def with_site_links(text: str, source: str, page: str) -> str:
    """The text of a file with the links of the page that is made from it."""
    parts = CODE.split(text)  # code has an odd index
    parts[::2] = (LINK.sub(lambda link: _site_link(link[1], source, page), part) for part in parts[::2])
    return "".join(parts)


def _site_link(link: str, source: str, page: str) -> str:
    """Where a link of a file leads from the page; a link to a missing file stays as it is, and MkDocs reports it."""
    if ELSEWHERE.match(link):
        return link
    path, mark, anchor = link.partition("#")
    target = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
    made = {file: name for name, file in made_pages().items()}
    if target in made or (target.startswith(f"{DOCS}/") and (ROOT / target).is_file()):
        name = made.get(target) or target.removeprefix(f"{DOCS}/")
        return posixpath.relpath(name, posixpath.dirname(page) or ".") + mark + anchor
    if (ROOT / target).exists():
        kind = "tree" if (ROOT / target).is_dir() else "blob"
        return f"{HOME}/{kind}/{REVISION}/{target}{mark}{anchor}"
    return link


def insert_sections(text: str, page: str) -> str:
    """The text of a page with the sections of files that it names by `<!-- section: FILE#HEADING -->`; the line below
    such a mark is shown by a code host, which has no section there.

    Raises:
        ValueError: a file has no such section.
    """

    def section(match: re.Match[str]) -> str:
        source, heading = match.groups()
        start = re.compile(rf"^#+ {re.escape(heading)}$", re.M)
        whole = (ROOT / source).read_text("utf-8")
        first = start.search(whole)
        if not first:
            raise ValueError(f"{source_of(page)}: {source} has no section {heading!r}")
        return with_site_links(whole[first.start() :].partition("\n## ")[0], source, page)

    return SECTION.sub(section, text)
