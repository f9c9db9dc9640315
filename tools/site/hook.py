"""What the site adds to MkDocs: pages from files outside docs/, references made from the sources, links between them.

MkDocs calls the functions `on_…` of this module. A file of the project is written for a code host, and is used as it
is: its links lead to files of the project, and become links to pages of the site or to the code host.
"""

from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from motionsync.blocks import BLOCKS
from tools.site.markdown import draw_diagrams, indent_lists
from tools.site.pages import BLOCK_PAGE, ROOT, insert_sections, made_pages, source_of, with_site_links
from tools.site.reference import block_reference, insert_references

FOR_DEVELOPERS = ("explanation/architecture.md", "explanation/contributing.md", "reference/changes.md")
FIRST_SECTION = "\n## How to use it\n"  # of the README of each block
EXPLORE = """
<a href="../../explore/{0}.html">Move {0} by hand</a>: sliders, commands, curves and the machine, in the browser.
"""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Put the pages of the blocks into the navigation, in the order of the README."""
    (reference,) = (part["Reference"] for part in config.nav or () if "Reference" in part)
    readme = (ROOT / "README.md").read_text("utf-8")
    reference[0]["Blocks"] += [
        BLOCK_PAGE.format(name) for name in sorted(BLOCKS, key=lambda name: readme.index(f"[`{name}`]"))
    ]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made from files outside docs/."""
    for page, source in made_pages().items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text("utf-8")))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """A page as the site has it."""
    name = page.file.src_uri
    if name in FOR_DEVELOPERS:
        page.meta["search"] = {"boost": 0.2}
    text = insert_sections(with_site_links(markdown, source_of(name), name), name)
    text = draw_diagrams(indent_lists(text))
    if block := {BLOCK_PAGE.format(name): name for name in BLOCKS}.get(name):
        text = text.replace(FIRST_SECTION, EXPLORE.format(block) + FIRST_SECTION, 1) + block_reference(block)
    return insert_references(text)
