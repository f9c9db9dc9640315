"""Where the locals of a function are declared: in the innermost block that holds all uses, before the first one."""

import ast
from collections.abc import Iterator
from typing import TypeAlias

from ..subset.function_rules import without_docstring
from ..subset.package import CheckedFunction

# To a statement: its index, then the name or number of a block in it, the index of a statement in that, and so on.
Path: TypeAlias = tuple[int | str, ...]


def blocks(statement: ast.stmt) -> Iterator[tuple[int | str, list[ast.stmt]]]:
    """The blocks inside a statement."""
    match statement:
        case ast.If() | ast.While() | ast.For():
            yield "body", statement.body
            yield "orelse", statement.orelse
        case ast.Match(cases=cases):
            yield from enumerate(case.body for case in cases)


def find_declarations(function: CheckedFunction) -> dict[Path, list[str]]:
    """The locals to declare before or in each statement, by its path; a loop declares its variable itself."""
    loops = {id(n.target) for n in function.walk(function.node) if isinstance(n, ast.For)}
    names = (n for n in function.walk(function.node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store))
    locals_ = {name.id for name in names if id(name) not in loops} - {*function.parameters} - {"_"}
    uses: dict[str, list[Path]] = {}
    _collect_uses(function, without_docstring(function.node.body), (), locals_, uses)
    declared: dict[Path, list[str]] = {}
    for name, paths in uses.items():
        block = _common_block(paths)
        first = min(path[len(block)] for path in paths if isinstance(path[len(block)], int))
        declared.setdefault((*block, first), []).append(name)
    return declared


def _collect_uses(
    function: CheckedFunction, block: list[ast.stmt], path: Path, locals_: set[str], uses: dict[str, list[Path]]
) -> None:
    """Collect the statements that use each local themselves, and not in a block inside."""
    for i, statement in enumerate(block):
        statement_path, inner = (*path, i), list(blocks(statement))
        nested = {id(n) for _, body in inner for s in body for n in function.walk(s)}
        for n in function.walk(statement):
            if isinstance(n, ast.Name) and n.id in locals_ and id(n) not in nested:
                uses.setdefault(n.id, []).append(statement_path)
        for name, body in inner:
            _collect_uses(function, body, (*statement_path, name), locals_, uses)


def _common_block(paths: list[Path]) -> Path:
    """The path of the innermost block around all of these statements."""
    shared = 0
    while all(shared < len(path) for path in paths) and len({path[shared] for path in paths}) == 1:
        shared += 1
    return paths[0][: shared - 1] if shared % 2 else paths[0][:shared]
