"""The pages of `motionsync explore`: each is made once in a test run, with all scenarios of its block."""

import base64
import json
import re
import tomllib
import zlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from motionsync.blocks import BLOCKS
from motionsync_fmu.explorer.page import scenarios_of, write_page
from motionsync_fmu.interface.block_folder import block_file
from tests.support.blocks.varied import few_with_all, kinds_of
from tests.support.hosts.fmus import Fmus

INPUTS = ("axis", "encoder", "drive", "remote", "settings", "reactions", "cuts")
"""What the page makes the inputs of a run from, beside the start values."""


@dataclass(frozen=True)
class Explored:
    """A page, and what is packed in it."""

    file: Path

    @cached_property
    def text(self) -> str:
        return self.file.read_text("utf-8")

    @cached_property
    def data(self) -> dict[str, Any]:
        return dict(json.loads(self._unpacked("data")))

    @cached_property
    def code(self) -> bytes:
        """The WebAssembly module."""
        return self._unpacked("code")

    def varied_scenarios(self) -> list[str]:
        """Names of few scenarios that together have every kind of motion, clock, setting, reaction and cut that any
        has."""
        return few_with_all(
            {
                s["name"]: {*kinds_of({key: s[key] for key in INPUTS}), s["start"].get("master.input_mode")}
                for s in self.data["scenarios"]
            }
        )

    def scenario(self, name: str) -> dict[str, Any]:
        """What the page knows of a scenario."""
        return next(s for s in self.data["scenarios"] if s["name"] == name)

    def _unpacked(self, part: str) -> bytes:
        (packed,) = re.findall(rf'<script type="application/octet-stream" id="{part}">([^<]*)<', self.text)
        return zlib.decompress(base64.b64decode(packed), -zlib.MAX_WBITS)


def opens_with(name: str) -> str:
    """The name of the scenario with which the page of this block opens, by the block's `explore.toml`."""
    file = block_file(BLOCKS[name], "explore.toml")
    keys = tomllib.loads(file.read_text("utf-8")) if file.is_file() else {}
    return str(keys.get("scenario", "example"))


def explored(fmus: Fmus, name: str) -> Explored:
    """The page of a block, in the process that asks first."""

    def fill(folder: Path) -> None:
        write_page(name, scenarios_of(name), fmus.native(name), folder / f"{name}.html")

    return Explored(fmus.shared.once(f"explore/{name}", fill) / f"{name}.html")
