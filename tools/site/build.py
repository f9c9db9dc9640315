"""Builds the site with MkDocs."""

import logging
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mkdocs.commands.build import build
from mkdocs.config import load_config
from mkdocs.exceptions import MkDocsException

from motionsync.blocks import BLOCKS
from motionsync_fmu import UserError
from tools.site.pages import ROOT


class Warnings(logging.Handler):
    """What MkDocs warns of."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.messages: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.messages.append(record.getMessage())


def make_site(folder: Path, explore_pages: Path) -> None:
    """Make the site in a folder that then holds nothing else; `explore_pages`: the folder with the page of each block
    that `motionsync explore` writes.

    Raises:
        UserError: a page is missing, or a link leads nowhere.
    """
    with gather_warnings() as warnings:
        try:
            build(load_config(str(ROOT / "mkdocs.yml"), site_dir=str(folder)))
        except MkDocsException as error:
            raise UserError("\n".join([str(error), *warnings.messages])) from None
    (folder / "404.html").unlink()  # of a server
    target = folder / "explore"
    target.mkdir()
    for name in BLOCKS:
        shutil.copy(explore_pages / f"{name}.html", target)


@contextmanager
def gather_warnings() -> Iterator[Warnings]:
    """What MkDocs warns of in this context."""
    logger, warnings = logging.getLogger("mkdocs"), Warnings()
    logger.addHandler(warnings)
    try:
        yield warnings
    finally:
        logger.removeHandler(warnings)
