"""The documentation site, built once in a test run, and its pages."""

import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from functools import cached_property
from html.parser import HTMLParser
from pathlib import Path

from motionsync.blocks import BLOCKS
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.extras import dry_run
from tests.support.scenarios.explored import explored

MAKE = """
from pathlib import Path
from tests.support.project.extras import hide_others

hide_others(*{extras})
from tools.site.build import make_site

make_site(Path({site!r}), Path({pages!r}))
"""
VERBATIM = ("code", "pre", "script", "style", "svg")  # their texts are no prose


@dataclass
class SitePage(HTMLParser):
    """A page: its anchors, its addresses (tag, address), the texts of its code, and its prose."""

    text: str
    anchors: set[str] = field(default_factory=set)
    addresses: list[tuple[str, str]] = field(default_factory=list)
    code: list[str] = field(default_factory=list)
    prose: list[str] = field(default_factory=list)
    inside: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.anchors |= {value for key in ("id", "name") if (value := values.get(key))}
        self.addresses += [(tag, value) for key in ("href", "src") if (value := values.get(key))]
        if tag in VERBATIM:
            self.inside.append(tag)
            self.code.append("")

    def handle_endtag(self, tag: str) -> None:
        if self.inside[-1:] == [tag]:
            self.inside.pop()

    def handle_data(self, data: str) -> None:
        if self.inside:
            self.code[-1] += data
        else:
            self.prose.append(data)


class Site:
    """The site in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @cached_property
    def pages(self) -> dict[str, SitePage]:
        """The pages by their paths, without those of `motionsync explore`."""
        files = sorted(self.folder.rglob("*.html"))
        return {
            path: SitePage(file.read_text("utf-8"))
            for file in files
            if not (path := file.relative_to(self.folder).as_posix()).startswith("explore/")
        }


def made_site(fmus: Fmus, explored_block: str = "CutToLength") -> Site:
    """The site, made with nothing but what `make docs` installs, when it is first asked for. The page to explore one
    block serves for all: they take a minute to make."""

    def fill(folder: Path) -> None:
        pages = folder / "explore"
        pages.mkdir()
        for name in BLOCKS:
            shutil.copyfile(explored(fmus, explored_block).file, pages / f"{name}.html")
        code = MAKE.format(extras=dry_run("docs")[0], site=str(folder / "site"), pages=str(pages))
        done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    return Site(fmus.shared.once("site", fill) / "site")
