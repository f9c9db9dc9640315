"""The package metadata that come from elsewhere: the home and authors, and the README for the package index.

Hatchling calls the hook whenever it makes metadata. The package index has no files but the README, so that the README's
relative links and pictures are made absolute; they lead to the files of this very version, of a development version to
those of the main branch."""

import re
import runpy
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

RELATIVE = re.compile(r"(!?)(\[(?:[^][]|\[[^][]*\](?:\([^()]*\))?)*\])\((?!https?:|#|mailto:)([^()\s]+)\)")


class ProjectMetadata(MetadataHookInterface):
    """Authors, addresses and README."""

    def update(self, metadata: dict[str, Any]) -> None:
        project = runpy.run_path(str(Path(self.root, "fmu_src", "motionsync_fmu", "about.py")))
        home, revision = project["HOME"], project["REVISION"]
        metadata["authors"] = [{"name": project["AUTHORS"]}]
        metadata["urls"] = {
            "Homepage": home,
            "Repository": home,
            "Changelog": f"{home}/blob/{revision}/CHANGELOG.md",
            "Issues": f"{home}/issues",
        }
        text = Path(self.root, "README.md").read_text("utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": make_links_absolute(text, home, revision)}


def make_links_absolute(text: str, home: str, revision: str) -> str:
    """A text in Markdown whose links and pictures name no file, but its address in the repository.

    A picture that is itself a link, `[![...](picture)](file)`, is two of them."""

    def address(match: re.Match[str]) -> str:
        picture, label, file = match.groups()
        kind = "raw" if picture else "blob"
        return f"{picture}{RELATIVE.sub(address, label)}({home}/{kind}/{revision}/{file})"

    return RELATIVE.sub(address, text)
