"""Imports go downwards: between packages as the page Architecture draws them, and between modules without a circle.

A package is a folder below `motionsync` or `motionsync_fmu`; the parts of `scenario` count as packages of their own.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from tests import ROOT

SOURCES = (ROOT / "model", ROOT / "fmu_src")
SHARED = {"about", "errors", "paths", "optional_dependencies", "__init__", "model"}  # every package may import these
RUN = {"scenario", "scenario.run"}
SCENARIO = RUN | {"scenario.files", "scenario.evaluate"}
TOOL = {
    "cli": {"commands"},
    "pytest_plugin": {"api"},
    "commands": {
        "api",
        "fmus",
        "interface",
        "production_line",
        "native",
        "pages",
        "plan",
        "sweeps",
        *SCENARIO,
    },
    "api": {
        "batch",
        "explorer",
        "fmus",
        "interface",
        "pages",
        "plan",
        "production_line",
        "sweeps",
        *SCENARIO,
    },
    "explorer": {"batch", "fmus", "interface", "native", "pages", "scenario", "scenario.run", "scenario.files"},
    "production_line": {"fmus", "interface", "pages", *SCENARIO},
    "sweeps": {"batch", "fmus", "interface", "pages", *SCENARIO},
    "plan": {"interface", "pages", *SCENARIO},
    "fmus": {"compiler", "interface", "native", "pages", "scenario.files"},
    "pages": {"interface", "native", *SCENARIO},
    "batch": {"compiler", "interface", "native", *RUN},
    "native": {"compiler", "interface"},
    "compiler": {"interface"},
    "scenario.files": {"interface", "scenario"},
    "scenario.evaluate": {"interface", "scenario.files", *RUN},
    "scenario.run": {"interface", "scenario"},
    "scenario": {"interface"},
    "python": {"interface"},
    "interface": set[str](),
}


@cache
def modules() -> dict[str, Path]:
    """The files of all modules, by their names."""
    files = ((file, file.relative_to(source)) for source in SOURCES for file in sorted(source.rglob("*.py")))
    return {".".join(path.with_suffix("").parts): file for file, path in files}


@cache
def syntax_tree(module: str) -> ast.Module:
    return ast.parse(modules()[module].read_text("utf-8"))


def imported_by(module: str, statements: Iterable[ast.AST]) -> Iterator[str]:
    """The project's modules that some statements of a module import."""
    folder = module.split(".")
    for node in statements:
        if isinstance(node, ast.ImportFrom):
            base = [*folder[: len(folder) - node.level], *(node.module or "").split(".")] if node.level else []
            name = ".".join(filter(None, base)) or str(node.module)
            for alias in node.names:
                candidates = (f"{name}.{alias.name}", f"{name}.{alias.name}.__init__", name, f"{name}.__init__")
                if (target := next((c for c in candidates if c in modules()), module)) != module:
                    yield target
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules())


def package(module: str) -> str:
    """The package of a module, as TOOL names it."""
    root, name, *inner = module.split(".")
    if root == "motionsync":
        return "model"
    return f"{name}.{inner[0]}" if name == "scenario" and len(inner) > 1 else name


@pytest.mark.parametrize("name", sorted(TOOL))
def test_a_package_imports_only_packages_below_it(name: str) -> None:
    own = [module for module in modules() if package(module) == name]
    assert own
    for module in own:
        imported = set(imported_by(module, ast.walk(syntax_tree(module))))
        upwards = {m for m in imported if package(m) not in TOOL[name] | SHARED | {name}}
        assert not upwards, module


def test_no_text_in_the_lowest_layer_names_a_module_above_it() -> None:
    above = {name.partition(".")[0] for name in TOOL} - {"interface"}
    named = re.compile(rf"\b({'|'.join(sorted(above))})[./]\w")
    own = [module for module in modules() if package(module) == "interface"]
    assert own
    for module in own:
        for node in ast.walk(syntax_tree(module)):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                assert not named.search(node.value), module


def test_each_package_has_its_arrows() -> None:
    assert {package(module) for module in modules()} - SHARED == set(TOOL)
    assert {below for packages in TOOL.values() for below in packages} <= set(TOOL)


def test_the_packages_have_no_circle() -> None:
    TopologicalSorter(TOOL).prepare()


def test_the_model_imports_nothing_of_the_tool_and_no_block_another() -> None:
    folders = {block.__module__.split(".")[1] for block in BLOCKS.values()}
    for module in modules():
        if package(module) != "model":
            continue
        _, name, *_ = module.split(".")
        for target in imported_by(module, ast.walk(syntax_tree(module))):
            assert package(target) == "model", module
            other = target.split(".")[1]
            assert name in (other, "blocks") or other not in folders, module


def test_the_modules_have_no_circle() -> None:
    graph = {module: set(imported_by(module, syntax_tree(module).body)) for module in modules()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(f"modules import each other: {' -> '.join(reversed(error.args[1]))}")
