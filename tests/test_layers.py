"""Imports go downwards, as the picture of the page Architecture draws them, and modules have no circle."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from tests import ROOT

PAGE = (ROOT / "docs" / "explanation" / "architecture.md").read_text("utf-8")
SOURCES = (ROOT / "model", ROOT / "fmu_src")
SHARED = {"about", "errors", "paths", "optional_dependencies", "__init__"}  # every package may import these
FOLDERS = sorted(block.__module__.split(".")[1] for block in BLOCKS.values())
NODE = re.compile(r'^ +(\w+)(?:\["([^":]+)[^"]*"\])?(?: -+> ([\w &]+))?$', re.M)


def drawn() -> tuple[dict[str, str], dict[str, set[str]]]:
    """The node of each package or module that the picture names, and the nodes to which the arrows of a node lead."""
    nodes, arrows = dict[str, str](), dict[str, set[str]]()
    for node, label, targets in NODE.findall(PAGE.partition("```mermaid")[2].partition("```")[0]):
        named = FOLDERS if label == "one folder a block" else label.split(", ")
        nodes |= dict.fromkeys(filter(None, named), node)
        arrows.setdefault(node, set()).update(filter(None, targets.split(" & ")))
    return nodes, arrows


NODES, ARROWS = drawn()


@cache
def modules() -> dict[str, Path]:
    """The files of all modules, by their names."""
    files = ((file, file.relative_to(source)) for source in SOURCES for file in sorted(source.rglob("*.py")))
    return {".".join(path.with_suffix("").parts): file for file, path in files}


@cache
def syntax_tree(module: str) -> ast.Module:
    return ast.parse(modules()[module].read_text("utf-8"))


@cache
def imports(module: str) -> set[str]:
    """The project's modules that a module imports, in functions and for its types as well."""
    return set(_imported(module))


def _imported(module: str) -> Iterator[str]:
    folder = module.split(".")
    for node in ast.walk(syntax_tree(module)):
        if isinstance(node, ast.ImportFrom):
            base = [*folder[: len(folder) - node.level], *(node.module or "").split(".")] if node.level else []
            name = ".".join(filter(None, base)) or str(node.module)
            for alias in node.names:
                candidates = (f"{name}.{alias.name}", f"{name}.{alias.name}.__init__", name, f"{name}.__init__")
                if (target := next((c for c in candidates if c in modules()), module)) != module:
                    yield target
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in modules())


def node_of(module: str) -> str:
    """The node to which a module belongs; empty: none."""
    _, *names = module.split(".")
    return NODES.get("/".join(names[:2])) or NODES.get(names[0], "")


@cache
def reached(node: str) -> set[str]:
    """The nodes to which the arrows lead from one, directly or by others, and itself."""
    return {node}.union(*map(reached, ARROWS[node]))


def test_the_packages_have_no_circle() -> None:
    TopologicalSorter(ARROWS).prepare()


def test_each_module_is_in_the_picture() -> None:
    assert {module.split(".")[1] for module in modules() if not node_of(module)} == SHARED


@pytest.mark.parametrize("node", sorted(set(NODES.values())))
def test_a_package_imports_only_packages_below_it(node: str) -> None:
    """And each of its arrows stands for an import."""
    own = [module for module in modules() if node_of(module) == node]
    assert own
    for module in own:
        upwards = {m for m in imports(module) if node_of(m) not in reached(node) | {""}}
        assert not upwards, module
    assert ARROWS[node] <= {node_of(m) for module in own for m in imports(module)}


def test_no_block_imports_another() -> None:
    for module in modules():
        if node_of(module) == NODES[FOLDERS[0]]:
            others = {m.split(".")[1] for m in imports(module)} & set(FOLDERS) - {module.split(".")[1]}
            assert not others, module


def test_the_tool_imports_of_the_model_what_the_page_says() -> None:
    """And the plan of a line what the machines and `cutting` have in addition."""
    (sentence,) = re.findall(r"`fmu_src/` imports (.*?) of it,", PAGE, re.S)
    machines = {NODES[FOLDERS[0]], NODES["cutting"]}
    imported = {
        "/".join(target.split(".")[1:])
        for module in modules()
        if module.startswith("motionsync_fmu.")
        for target in imports(module)
        if target.startswith("motionsync.") and (node_of(module) != "plan" or node_of(target) not in machines)
    }
    assert imported == set(re.findall(r"`([^`]+)`", sentence))


def test_no_text_in_the_lowest_layer_names_a_module_above_it() -> None:
    above = {name.partition("/")[0] for name, node in NODES.items() if node not in reached("interface")}
    named = re.compile(rf"\b({'|'.join(sorted(above))})[./]\w")
    own = [module for module in modules() if node_of(module) == "interface"]
    assert own
    for module in own:
        for node in ast.walk(syntax_tree(module)):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                assert not named.search(node.value), module


def test_the_modules_have_no_circle() -> None:
    try:
        TopologicalSorter({module: imports(module) for module in modules()}).prepare()
    except CycleError as error:
        pytest.fail(f"modules import each other: {' -> '.join(reversed(error.args[1]))}")
