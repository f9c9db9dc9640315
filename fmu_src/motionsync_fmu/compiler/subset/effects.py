"""The fields that functions read and write, directly or by their calls, and the lengths of the lists they are given."""

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from .expression_rules import COPY, COPY_VALID, PART_FUNCTIONS
from .package import CheckedFunction, Kind, Package, assigned_name

# Fields, each with the class that has it. An element of a list counts as an element of any list.
FieldSet: TypeAlias = frozenset[tuple[ast.ClassDef | None, str]]
ANY_ELEMENT: FieldSet = frozenset({(None, "")})
NO_FIELDS: FieldSet = frozenset()


@dataclass(eq=False)
class Effect:
    """What a call of one function does.

    Attributes:
        reads, writes: fields of any object.
        changed: the parameters through which it changes an object or list, and the locals that are aliases of one.
        lengths: of the lists that are its parameters.
    """

    reads: FieldSet = NO_FIELDS
    writes: FieldSet = NO_FIELDS
    changed: frozenset[str] = frozenset()
    lengths: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Call:
    """One call in a function, with the objects that it passes."""

    node: ast.Call
    callee: CheckedFunction
    objects: list[tuple[str, frozenset[str]]]  # a parameter, and the names through which its object is reached
    lists: list[tuple[str, ast.expr]]


class Effects:
    """The effects of all functions that a package has."""

    def __init__(self, package: Package) -> None:
        self.package = package
        self.by_function: dict[CheckedFunction, Effect] = {}
        self.calls: dict[CheckedFunction, list[Call]] = {}
        self.own_accesses: dict[ast.AST, tuple[FieldSet, FieldSet, list[CheckedFunction]]] = {}
        # Calls that pass a list of another length than an earlier call to the same parameter.
        self.length_conflicts: list[tuple[CheckedFunction, ast.Call]] = []
        for function in package.functions.values():
            self.by_function[function] = Effect()
            self.calls[function] = []
            for node in function.walk(function.node):
                if callee := function.callee(node):
                    self.calls[function].append(self.describe_call(function, node, callee))
            self.add_own_effect(function)
        grown = True
        while grown:
            grown = sum(map(self.add_effects_of_calls, self.by_function)) > 0

    def describe_call(self, function: CheckedFunction, node: ast.AST, callee: CheckedFunction) -> Call:
        assert isinstance(node, ast.Call)
        arguments = function.arguments(node, callee)
        objects = [(name, argument) for name, argument in arguments if self.package.is_object(function.kinds[argument])]
        lists = [(name, a) for name, a in objects if function.kinds[a] == "list"]
        return Call(node, callee, [(name, self.root_names(function, a)) for name, a in objects], lists)

    def add_own_effect(self, function: CheckedFunction) -> None:
        """Add what a function does itself, without its calls."""
        effect = self.by_function[function]
        effect.reads, effect.writes, _ = self.find_accesses(function, function.node)
        for target in assigned_targets(function, function.node):
            effect.writes |= (
                ANY_ELEMENT if isinstance(target, ast.Subscript) else self.find_accesses(function, target)[0]
            )
            effect.changed |= self.root_names(function, target)
        for node in function.walk(function.node):
            if isinstance(node, ast.Call) and function.meaning(node.func) in (COPY, COPY_VALID):
                effect.changed |= self.root_names(function, node.args[0])

    def add_effects_of_calls(self, function: CheckedFunction) -> bool:
        """Add the effects of the called functions, as far as determined; whether that is more than before."""
        effect = self.by_function[function]
        before = len(effect.reads), len(effect.writes), len(effect.changed), len(effect.lengths)
        for call in self.calls[function]:
            inner = self.by_function[call.callee]
            effect.reads |= inner.reads
            effect.writes |= inner.writes
            for name, roots in call.objects:
                if name in inner.changed:
                    effect.changed |= roots
            for name, argument in call.lists:
                length = self.list_length(function, argument)
                if length and inner.lengths.setdefault(name, length) != length:
                    self.length_conflicts.append((function, call.node))
        return before != (len(effect.reads), len(effect.writes), len(effect.changed), len(effect.lengths))

    def accessed_fields(self, function: CheckedFunction, node: ast.AST) -> tuple[FieldSet, FieldSet]:
        """The fields that an expression or statement reads (or assigns) itself or by its calls; those that its calls
        write."""
        if node not in self.own_accesses:
            self.own_accesses[node] = self.find_accesses(function, node)
        reads, writes, callees = self.own_accesses[node]
        effects = [self.by_function[callee] for callee in callees]
        return reads.union(*(e.reads for e in effects)), writes.union(*(e.writes for e in effects))

    def find_accesses(
        self, function: CheckedFunction, node: ast.AST
    ) -> tuple[FieldSet, FieldSet, list[CheckedFunction]]:
        """The fields that a node accesses itself, those that it copies into, and the functions that it calls."""
        own: set[tuple[ast.ClassDef | None, str]] = set()
        copied, callees = NO_FIELDS, []
        for n in function.walk(node):
            if isinstance(n, ast.Subscript) and n in function.kinds:
                own |= ANY_ELEMENT
            elif isinstance(n, ast.Attribute) and n.value in function.kinds:
                owner = function.kinds[n.value]
                if isinstance(owner, ast.ClassDef) and n.attr in (fields := self.package.all_fields(owner)):
                    own.add((fields[n.attr][1], n.attr))
            elif isinstance(n, ast.Call) and function.meaning(n.func) in PART_FUNCTIONS:
                own |= self.fields_inside(function.kinds[n.args[0]])
                if function.meaning(n.func) in (COPY, COPY_VALID):
                    copied |= self.fields_inside(function.kinds[n.args[0]])
            if callee := function.callee(n):
                callees.append(callee)
        return frozenset(own) | copied, copied, callees

    def written_fields(self, function: CheckedFunction, node: ast.AST) -> FieldSet:
        """The fields that a statement assigns to, itself or by its calls."""
        own = (
            ANY_ELEMENT if isinstance(target, ast.Subscript) else self.accessed_fields(function, target)[0]
            for target in assigned_targets(function, node)
        )
        return self.accessed_fields(function, node)[1].union(*own)

    def callees(self, function: CheckedFunction) -> list[CheckedFunction]:
        """The functions that a function calls itself."""
        return [call.callee for call in self.calls[function]]

    def reachable_from(self, functions: Iterable[CheckedFunction]) -> list[CheckedFunction]:
        """These functions and all that they call, directly or indirectly."""
        reached = list(functions)
        for function in reached:  # it grows meanwhile
            reached += [callee for callee in dict.fromkeys(self.callees(function)) if callee not in reached]
        return reached

    def fields_inside(self, kind: Kind) -> FieldSet:
        """All fields of an object, with those of its base and of its parts."""
        if not isinstance(kind, ast.ClassDef) or kind in self.package.enumerations:
            return ANY_ELEMENT if kind == "list" else NO_FIELDS
        base = self.package.base_class(kind)
        own = self.package.own_fields(kind)
        names = frozenset((kind, name) for name in own)
        return names.union(*map(self.fields_inside, own.values()), self.fields_inside(base) if base else NO_FIELDS)

    def root_names(self, function: CheckedFunction, node: ast.expr) -> frozenset[str]:
        """The parameter through which an object is reached, and the local that is an alias of a part of it."""
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        assert isinstance(node, ast.Name)
        aliased = aliased_value(function, node.id)
        return frozenset({node.id}) | (self.root_names(function, aliased) if aliased else frozenset())

    def list_length(self, function: CheckedFunction, node: ast.expr) -> int:
        """The length of a list; 0 as long as no call has determined it."""
        if isinstance(node, ast.Name):
            aliased = aliased_value(function, node.id)
            return (
                self.list_length(function, aliased) if aliased else self.by_function[function].lengths.get(node.id, 0)
            )
        assert isinstance(node, ast.Attribute)
        owner = function.kinds[node.value]
        assert isinstance(owner, ast.ClassDef)
        return self.package.list_length(owner, node.attr)


def aliased_value(function: CheckedFunction, name: str) -> ast.expr | None:
    """The object or list that was assigned to a local; None if it is a parameter."""
    if name in function.parameters:
        return None
    values = (
        n.value
        for n in function.walk(function.node)
        if isinstance(n, ast.Assign | ast.AnnAssign) and assigned_name(n) == name
    )
    return next(values, None)


def assigned_targets(function: CheckedFunction, node: ast.AST) -> Iterator[ast.expr]:
    """The fields and elements that statements assign to."""
    for n in function.walk(node):
        single = [n.target] if isinstance(n, ast.AnnAssign | ast.AugAssign) else []
        targets = n.targets if isinstance(n, ast.Assign) else single
        yield from (t for t in targets if isinstance(t, ast.Attribute | ast.Subscript))
