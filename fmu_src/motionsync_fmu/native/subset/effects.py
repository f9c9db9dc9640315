"""What functions read and write, directly or by what they call, and how long the lists are that they are given."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from .expressions import COPY
from .package import Kind, Package, Reading, name_of

# Fields, each with the class that has it. An element of a list counts as an element of any list.
Places: TypeAlias = frozenset[tuple[ast.ClassDef | None, str]]
ANY_LIST: Places = frozenset({(None, "")})
NOTHING: Places = frozenset()


@dataclass(eq=False)
class Effect:
    """What a call of one function does.

    Attributes:
        reads, writes: fields of any object.
        changed: the parameters through which it changes an object or list, and the locals that stand for such a thing.
        lengths: of the lists that are its parameters.
    """

    reads: Places = NOTHING
    writes: Places = NOTHING
    changed: frozenset[str] = frozenset()
    lengths: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Call:
    """One call in a function: the objects that it hands on, by the parameters that get them."""

    node: ast.Call
    callee: Reading
    objects: list[tuple[str, frozenset[str]]]  # a parameter, and the names through which its object is reached
    lists: list[tuple[str, ast.expr]]


class Effects:
    """The effects of all functions that a package has."""

    def __init__(self, package: Package) -> None:
        self.package = package
        self.of: dict[Reading, Effect] = {}
        self.calls: dict[Reading, list[Call]] = {}
        self.direct: dict[ast.AST, tuple[Places, Places, list[Reading]]] = {}
        self.lists: list[tuple[Reading, ast.Call]] = []  # calls that give a parameter a list of another length
        for reading in package.readings.values():
            self.of[reading] = Effect()
            self.calls[reading] = []
            for node in reading.walk(reading.node):
                if callee := reading.callee(node):
                    self.calls[reading].append(self.call(reading, node, callee))
            self.begin(reading)
        grown = True
        while grown:
            grown = sum(map(self.grows, self.of)) > 0

    def call(self, reading: Reading, node: ast.AST, callee: Reading) -> Call:
        assert isinstance(node, ast.Call)
        given = reading.arguments(node, callee)
        objects = [(name, argument) for name, argument in given if is_object(reading, argument)]
        lists = [(name, a) for name, a in objects if reading.kinds[a] == "list"]
        return Call(node, callee, [(name, self.roots(reading, a)) for name, a in objects], lists)

    def begin(self, reading: Reading) -> None:
        """What a function does itself."""
        effect = self.of[reading]
        effect.reads, effect.writes, _ = self.found(reading, reading.node)
        for place in stored(reading, reading.node):
            effect.writes |= ANY_LIST if isinstance(place, ast.Subscript) else self.found(reading, place)[0]
            effect.changed |= self.roots(reading, place)
        for node in reading.walk(reading.node):
            if isinstance(node, ast.Call) and reading.meaning(node.func) == COPY:
                effect.changed |= self.roots(reading, node.args[0])

    def grows(self, reading: Reading) -> bool:
        """Add what the functions do that a function calls, as far as known; whether that is more than before."""
        effect = self.of[reading]
        before = len(effect.reads), len(effect.writes), len(effect.changed), len(effect.lengths)
        for call in self.calls[reading]:
            inner = self.of[call.callee]
            effect.reads |= inner.reads
            effect.writes |= inner.writes
            for name, roots in call.objects:
                if name in inner.changed:
                    effect.changed |= roots
            for name, argument in call.lists:
                length = self.length(reading, argument)
                if length and inner.lengths.setdefault(name, length) != length:
                    self.lists.append((reading, call.node))
        return before != (len(effect.reads), len(effect.writes), len(effect.changed), len(effect.lengths))

    def touched(self, reading: Reading, node: ast.AST) -> tuple[Places, Places]:
        """The fields that an expression or statement reads (or assigns) itself or by its calls; those that its calls
        write."""
        if node not in self.direct:
            self.direct[node] = self.found(reading, node)
        reads, writes, callees = self.direct[node]
        effects = [self.of[callee] for callee in callees]
        return reads.union(*(e.reads for e in effects)), writes.union(*(e.writes for e in effects))

    def found(self, reading: Reading, node: ast.AST) -> tuple[Places, Places, list[Reading]]:
        own: set[tuple[ast.ClassDef | None, str]] = set()
        copied, callees = NOTHING, []
        for n in reading.walk(node):
            if isinstance(n, ast.Subscript) and n in reading.kinds:
                own |= ANY_LIST
            elif isinstance(n, ast.Attribute) and n.value in reading.kinds:
                owner = reading.kinds[n.value]
                if isinstance(owner, ast.ClassDef) and n.attr in (members := self.package.members(owner)):
                    own.add((members[n.attr][1], n.attr))
            elif isinstance(n, ast.Call) and reading.meaning(n.func) == COPY:
                copied |= self.inside(reading.kinds[n.args[0]])
            if callee := reading.callee(n):
                callees.append(callee)
        return frozenset(own) | copied, copied, callees

    def written(self, reading: Reading, node: ast.AST) -> Places:
        """The fields that a statement assigns to, itself or by its calls."""
        own = (
            ANY_LIST if isinstance(place, ast.Subscript) else self.touched(reading, place)[0]
            for place in stored(reading, node)
        )
        return self.touched(reading, node)[1].union(*own)

    def callees(self, reading: Reading) -> list[Reading]:
        """The functions that a function calls itself."""
        return [call.callee for call in self.calls[reading]]

    def inside(self, kind: Kind) -> Places:
        """All fields of an object, with those of its base and of its parts."""
        if not isinstance(kind, ast.ClassDef) or kind in self.package.enumerations:
            return ANY_LIST if kind == "list" else NOTHING
        base = self.package.base(kind)
        own = self.package.fields(kind)
        inner = [self.package.kind(self.package.homes[kind], f.annotation) for f in own]
        places = frozenset((kind, name_of(f)) for f in own)
        return places.union(*map(self.inside, inner), self.inside(base) if base else NOTHING)

    def roots(self, reading: Reading, node: ast.expr) -> frozenset[str]:
        """The parameter through which a place is reached, and the local that stands for a part of it."""
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        assert isinstance(node, ast.Name)
        stands = standing_for(reading, node.id)
        return frozenset({node.id}) | (self.roots(reading, stands) if stands else frozenset())

    def length(self, reading: Reading, node: ast.expr) -> int:
        """Of a list; 0 while it is not known, since no call gives it."""
        if isinstance(node, ast.Name):
            stands = standing_for(reading, node.id)
            return self.length(reading, stands) if stands else self.of[reading].lengths.get(node.id, 0)
        assert isinstance(node, ast.Attribute)
        owner = reading.kinds[node.value]
        assert isinstance(owner, ast.ClassDef)
        return self.package.length(owner, node.attr)


def standing_for(reading: Reading, name: str) -> ast.expr | None:
    """What a local that stands for an object or list was assigned; None if it is a parameter."""
    if name in reading.parameters:
        return None
    found = (
        n.value for n in reading.walk(reading.node) if isinstance(n, ast.Assign | ast.AnnAssign) and name_of(n) == name
    )
    return next(found, None)


def stored(reading: Reading, node: ast.AST) -> Iterator[ast.expr]:
    """The fields and elements that statements assign to."""
    for n in reading.walk(node):
        single = [n.target] if isinstance(n, ast.AnnAssign | ast.AugAssign) else []
        targets = n.targets if isinstance(n, ast.Assign) else single
        yield from (t for t in targets if isinstance(t, ast.Attribute | ast.Subscript))


def is_object(reading: Reading, node: ast.expr) -> bool:
    kind = reading.kinds[node]
    return kind == "list" or (isinstance(kind, ast.ClassDef) and kind not in reading.package.enumerations)
