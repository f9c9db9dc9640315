"""The kernel subset: the small, plain Python of the model that is also compiled to native code.

`check` walks the syntax trees of the model's modules and returns what is outside the subset: file, line and rule. One
recursion does all of it: visiting an expression applies its rules and returns the kind of its value; visiting a
statement keeps `bound`, the locals that are certain to have a value at that place. What a type checker finds anyway (a
field that does not exist, a wrong argument) is left to it.
"""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TypeAlias

EXEMPT = ("__init__.py", "blocks.py", "var.py")  # public names, registry, declarations: only Python runs them
ENUMERATIONS = ("var.Enumeration",)  # what enumerations derive from
MATH = {"math.sqrt": "float", "math.floor": "int", "math.isfinite": "bool", "math.fmod": "float"}
MATH_CONSTANTS = ("math.e", "math.inf", "math.nan", "math.pi", "math.tau")
COPY = "var.copy"  # of one part into another of the same class
BUILTINS = {"abs": 1, "min": 2, "max": 2, "round": 1, "int": 1, "float": 1, "len": 1}  # with their least arguments
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)

STRING = "no strings in kernel code"
TUPLE = "a tuple is only returned, unpacked into locals at once, or searched with `in`"
POWER = "no `**` and no pow, which machines round differently: write a product"
MEMBER = "an enumeration member is compared, never converted or asked for its name, value or description"
CALL = "only kernel functions, methods of objects, abs, min, max, round, int, float, len and math's are called"
KINDS = "a float, int, bool, an enumeration, list[float] or a kernel dataclass"
PATTERN = "match and its patterns: an integer or an enumeration member, several joined with `|`, or `_`"
DERIVED = (
    "a dataclass derives from one kernel dataclass at most; unless that one has declared fields only, it then adds "
    "nothing but declared fields"
)
IMPORTS = "a kernel module imports only math, dataclass, the declarations and names from modules of its package"
MODULE_LEVEL = (
    "at module level stand only imports, constants (numbers; names of variables), enumerations, dataclasses, functions"
)

FORBIDDEN: dict[type[ast.AST], str] = {
    node: rule
    for rule, nodes in {
        STRING: (ast.JoinedStr,),
        TUPLE: (ast.Tuple,),
        "no lists, dicts or sets are made in kernel code": (ast.List, ast.Dict, ast.Set),
        "no comprehension and no generator: write a loop": (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp),
        "no function or class inside a function": (ast.Lambda, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef),
        "no exceptions in kernel code: return a fault": (ast.Try, ast.TryStar, ast.Raise, ast.Assert),
        "no with, yield or await in kernel code": (ast.With, ast.AsyncWith, ast.Yield, ast.YieldFrom, ast.Await),
        "no global, nonlocal or del in kernel code": (ast.Global, ast.Nonlocal, ast.Delete),
        "imports stand at module level": (ast.Import, ast.ImportFrom),
        "no assignment inside an expression (`:=`)": (ast.NamedExpr,),
        "no star expressions": (ast.Starred,),
        "no slices: index one element": (ast.Slice,),
    }.items()
    for node in nodes
}

# The kind of a value: "float", "int", "bool", "list", "?" (unknown: it broke a rule already), the class of an
# enumeration member or object, or the kinds in a returned tuple.
Kind: TypeAlias = "str | ast.ClassDef | tuple[Kind, ...]"
Meaning: TypeAlias = ast.stmt | str | None  # of a module-level name: its statement, or such as "math.sqrt"
Bound: TypeAlias = frozenset[str] | None  # the locals that have a value; None: this place is never reached


@dataclass(frozen=True)
class Violation:
    """What is outside the subset, and where."""

    file: str
    line: int
    rule: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.rule}"


def meet(a: Bound, b: Bound) -> Bound:
    """What is bound where two paths join."""
    if a is None or b is None:
        return b if a is None else a
    return a & b


def names_of_variables(node: ast.expr | None) -> bool:
    """Whether a constant is a tuple of names, for members of enumerations."""
    return isinstance(node, ast.Tuple) and all(isinstance(n, ast.Constant) and type(n.value) is str for n in node.elts)


def without_docstring(body: list[ast.stmt]) -> list[ast.stmt]:
    match body:
        case [ast.Expr(value=ast.Constant(value=str())), *rest]:
            return rest
    return body


class Package:
    """The modules of the model (path inside the package to text) and what their names stand for."""

    def __init__(self, sources: Mapping[str, str]) -> None:
        self.trees = {file: ast.parse(text, file) for file, text in sorted(sources.items())}
        self.names = {file: dict(self.module_names(tree)) for file, tree in self.trees.items()}
        self.homes = {node: file for file, tree in self.trees.items() for node in tree.body}
        classes = [(node, file) for node, file in self.homes.items() if isinstance(node, ast.ClassDef)]
        self.constants: dict[ast.stmt, Kind] = {}  # their kinds, as they become known
        self.enumerations = {
            node for node, file in classes if any(self.meaning(file, base) in ENUMERATIONS for base in node.bases)
        }

    @staticmethod
    def exempt(file: str) -> bool:
        return file in EXEMPT or PurePosixPath(file).name == "__init__.py"

    @staticmethod
    def origin(file: str, node: ast.ImportFrom) -> PurePosixPath | None:
        """What a relative import takes names from: a module, without suffix, or a folder; None outside the package."""
        parents = PurePosixPath(file).parents
        inside = 0 < node.level <= len(parents)
        return parents[node.level - 1].joinpath(*(node.module or "").split(".")) if inside else None

    @staticmethod
    def module_names(tree: ast.Module) -> Iterator[tuple[str, tuple[ast.stmt, str]]]:
        """Each module-level name with its statement and, since `import … as` may change it, its original name."""
        for node in tree.body:
            match node:
                case ast.Import() | ast.ImportFrom():
                    yield from ((alias.asname or alias.name, (node, alias.name)) for alias in node.names)
                case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                    yield name, (node, name)
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                    yield name, (node, name)

    def find(self, file: str, name: str) -> Meaning:
        """What a name stands for in a module, through imports inside the package."""
        node, original = self.names.get(file, {}).get(name, (None, name))
        if isinstance(node, ast.Import):
            return original
        if not isinstance(node, ast.ImportFrom):
            return node
        origin = self.origin(file, node)
        if origin is None:
            return f"{node.module}.{original}"
        if node.module is None:
            return str(origin / original)
        module = next((m for m in (f"{origin}.py", f"{origin}/__init__.py") if m in self.trees), "")
        found = self.find(module, original)
        if f"{origin}.py" in EXEMPT and not isinstance(found, ast.Assign | ast.AnnAssign):
            return f"{origin}.{original}"
        return found

    def meaning(self, file: str, node: ast.expr | None) -> Meaning:
        """What a name, or a name of math or of the declarations (`math.sqrt`), stands for in a module."""
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = self.find(file, node.value.id)
            return f"{owner}.{node.attr}" if isinstance(owner, str) else None
        return self.find(file, node.id) if isinstance(node, ast.Name) else None

    def kind(self, file: str, annotation: ast.expr | None) -> Kind:
        """The kind an annotation names; "?" if it is outside the subset."""
        match annotation:
            case ast.Constant(value=None):
                return "None"
            case ast.Constant(value=str(name)):  # a class inside its own body
                return self.kind(file, ast.Name(name))
            case ast.Name(id="float" | "int" | "bool" as name):
                return name
            case ast.Subscript(value=ast.Name(id="list"), slice=ast.Name(id="float")):
                return "list"
            case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=parts)):
                return tuple(self.kind(file, part) for part in parts)
        found = self.meaning(file, annotation)
        return found if isinstance(found, ast.ClassDef) else "?"

    def member(self, owner: ast.ClassDef, name: str, sort: type[ast.stmt]) -> "Kind | None":
        """The kind of a field, or of what a method returns, also of an inherited one; None: there is none."""
        for item in owner.body:
            match item:
                case ast.AnnAssign(target=ast.Name(id=found), annotation=annotation) if found == name and sort is type(
                    item
                ):
                    return self.kind(self.homes[owner], annotation)
                case ast.FunctionDef(name=found, returns=returns) if found == name and sort is type(item):
                    return self.kind(self.homes[owner], returns)
        bases = [self.meaning(self.homes[owner], base) for base in owner.bases]
        inherited = [
            self.member(base, name, sort) for base in bases if isinstance(base, ast.ClassDef) and base != owner
        ]
        return inherited[0] if inherited else None


class Expressions(ast.NodeVisitor):
    """The rules for expressions; each visit returns the kind of the value."""

    def __init__(self, package: Package, file: str, violations: list[Violation]) -> None:
        self.package = package
        self.file = file
        self.violations = violations

    def flag(self, node: ast.AST, rule: str) -> str:
        self.violations.append(Violation(self.file, getattr(node, "lineno", 1), rule))
        return "?"

    def generic_visit(self, node: ast.AST) -> Kind:
        return self.flag(node, FORBIDDEN.get(type(node), f"{type(node).__name__} is outside the kernel subset"))

    def is_enumeration(self, kind: Kind) -> bool:
        return kind in self.package.enumerations

    def is_object(self, kind: Kind) -> bool:
        return kind == "list" or (isinstance(kind, ast.ClassDef) and not self.is_enumeration(kind))

    def arithmetic(self, a: Kind, b: Kind) -> Kind:
        if "float" in (a, b):
            return "float"
        return "int" if all(kind in ("int", "bool") or self.is_enumeration(kind) for kind in (a, b)) else "?"

    def either(self, a: Kind, b: Kind) -> Kind:
        return a if a == b else self.arithmetic(a, b)

    def value(self, node: ast.expr) -> Kind:
        kind: Kind = self.visit(node)
        return self.flag(node, TUPLE) if isinstance(kind, tuple) else kind

    def condition(self, node: ast.expr) -> Kind:
        kind = self.value(node)
        if self.is_enumeration(kind) or self.is_object(kind):
            return self.flag(node, "an enumeration member or object has no truth value in kernel code: compare it")
        return kind

    def meaning(self, node: ast.expr) -> Meaning:
        return self.package.meaning(self.file, node)

    def named(self, node: ast.Name | ast.Attribute, meaning: Meaning) -> Kind:
        """A module-level name used as a value."""
        if isinstance(meaning, ast.Assign) and names_of_variables(meaning.value):
            return self.flag(node, STRING)
        if isinstance(meaning, ast.Assign | ast.AnnAssign) and meaning.value is not None:
            known = self.package.constants
            if meaning not in known:
                known[meaning] = "?"  # should it be made of itself
                known[meaning] = Expressions(self.package, self.package.homes[meaning], []).value(meaning.value)
            return known[meaning]
        if meaning in MATH_CONSTANTS:
            return "float"
        return self.flag(node, f"`{ast.unparse(node)}` is neither a local nor a constant of the package")

    def visit_Constant(self, node: ast.Constant) -> Kind:
        if isinstance(node.value, bool | int | float):
            return type(node.value).__name__
        return self.flag(node, "no `None` in kernel code" if node.value is None else STRING)

    def visit_Name(self, node: ast.Name) -> Kind:
        return self.named(node, self.meaning(node))

    def visit_Attribute(self, node: ast.Attribute) -> Kind:
        meaning, owner = self.meaning(node), self.meaning(node.value)
        if meaning is not None:
            return self.named(node, meaning)
        if isinstance(owner, ast.ClassDef) and self.is_enumeration(owner):
            return owner
        kind = self.value(node.value)
        if self.is_enumeration(kind):
            return self.flag(node, MEMBER)
        return self.package.member(kind, node.attr, ast.AnnAssign) or "?" if isinstance(kind, ast.ClassDef) else "?"

    def visit_Subscript(self, node: ast.Subscript) -> Kind:
        self.value(node.slice)
        self.value(node.value)
        return "float"

    def visit_Call(self, node: ast.Call) -> Kind:
        for keyword in node.keywords:
            self.flag(keyword.value, "arguments are positional")
        kinds = [self.value(argument) for argument in node.args]
        meaning = self.meaning(node.func)
        match node.func:
            case _ if isinstance(meaning, ast.FunctionDef):
                return self.package.kind(self.package.homes[meaning], meaning.returns)
            case _ if isinstance(meaning, ast.ClassDef):
                made = "an object is made once, with its owner: no allocation in a function"
                return self.flag(node, MEMBER if self.is_enumeration(meaning) else made)
            case _ if isinstance(meaning, str):
                return self.outside(node, meaning, kinds)
            case ast.Attribute(value=value, attr=name) if isinstance(owner := self.value(value), ast.ClassDef):
                result = self.package.member(owner, name, ast.FunctionDef)
                return self.flag(node, CALL) if result is None else result
            case ast.Name(id=name) if name in BUILTINS and len(kinds) >= BUILTINS[name]:
                return self.builtin(node, name, kinds)
        return self.flag(node, POWER if ast.unparse(node.func) == "pow" else CALL)

    def outside(self, node: ast.Call, meaning: str, kinds: list[Kind]) -> Kind:
        """A call of what is not the model's own: of math, or of the declarations, whose `copy` alone is compiled."""
        if meaning == COPY:
            alike = len(kinds) == 2 and kinds[0] == kinds[1] and kinds[0] != "list" and self.is_object(kinds[0])
            return "None" if alike else self.flag(node, "var.copy takes two parts of the same class")
        other = POWER if meaning == "math.pow" else f"{meaning} is not called: only {', '.join(MATH)}"
        return MATH.get(meaning) or self.flag(node, other)

    def builtin(self, node: ast.Call, name: str, kinds: list[Kind]) -> Kind:
        if len(kinds) > 1 and name not in ("min", "max"):
            return self.flag(node, f"{name} takes one argument here")
        if name in ("min", "max"):
            return kinds[0] if len(set(kinds)) == 1 else "float" if "float" in kinds else "?"
        return self.arithmetic(kinds[0], kinds[0]) if name == "abs" else "float" if name == "float" else "int"

    def operate(self, node: ast.AST, op: ast.operator, left: Kind, right: Kind) -> Kind:
        if not isinstance(op, OPERATORS):
            return self.flag(node, POWER if isinstance(op, ast.Pow) else "the operators are + - * / // %")
        if "list" in (left, right):
            return self.flag(node, "no arithmetic with whole lists")
        return "float" if isinstance(op, ast.Div) else self.arithmetic(left, right)

    def visit_BinOp(self, node: ast.BinOp) -> Kind:
        return self.operate(node, node.op, self.value(node.left), self.value(node.right))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Kind:
        kind = self.condition(node.operand) if isinstance(node.op, ast.Not) else self.value(node.operand)
        if isinstance(node.op, ast.Invert):
            return self.flag(node, "no bit operators")
        return "bool" if isinstance(node.op, ast.Not) else self.arithmetic(kind, kind)

    def visit_BoolOp(self, node: ast.BoolOp) -> Kind:
        kinds = {self.condition(operand) for operand in node.values}
        return kinds.pop() if len(kinds) == 1 else "?"

    def visit_IfExp(self, node: ast.IfExp) -> Kind:
        self.condition(node.test)
        return self.either(self.value(node.body), self.value(node.orelse))

    def visit_Compare(self, node: ast.Compare) -> Kind:
        self.value(node.left)
        for op, right in zip(node.ops, node.comparators, strict=True):
            match op, right:
                case ((ast.Is() | ast.IsNot()), _):
                    self.flag(node, "no `is`: compare with ==")
                case ((ast.In() | ast.NotIn()), ast.Tuple(elts=members)):
                    for member in members:
                        self.value(member)
                case ((ast.In() | ast.NotIn()), _):
                    self.flag(node, "`in` searches a tuple of members written there")
                case _:
                    self.value(right)
        return "bool"


class Body(Expressions):
    """The rules for a function: its signature, its statements, and that every local is bound where it is read."""

    def check(self, node: ast.FunctionDef, owner: ast.ClassDef | None) -> None:
        self.kinds: dict[str, Kind] = {}
        self.loops: list[str] = []  # the loop variables of the loops around this place
        self.ended: set[str] = set()  # the loop variables of earlier loops
        self.breaks: list[list[Bound]] = []  # for each loop around this place, what was bound at its breaks
        if node.decorator_list:
            self.flag(node, "no decorators on functions and methods")
        parameters = [argument for argument in ast.walk(node.args) if isinstance(argument, ast.arg)]
        if ast.unparse(node.args) != ", ".join(ast.unparse(argument) for argument in parameters):
            self.flag(node, "parameters are positional: no defaults, *args, **kwargs, `*` or `/`")
        for at, argument in enumerate(parameters):
            kind = self.package.kind(self.file, argument.annotation)
            is_self = owner is not None and at == 0 and argument.arg == "self"
            self.kinds[argument.arg] = owner if is_self and owner else kind
            if not is_self and (kind in ("?", "None") or isinstance(kind, tuple)):
                self.flag(argument, f"a parameter is {KINDS}")
        returns = self.package.kind(self.file, node.returns)
        if returns == "?" or (isinstance(returns, tuple) and "?" in returns):
            self.flag(node, f"a function says what it returns: {KINDS}, a tuple of these, or None")
        self.bound: Bound = frozenset(self.kinds)
        stored = {name.id for name in ast.walk(node) if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)}
        self.locals = stored | self.bound
        self.block(without_docstring(node.body))
        if self.bound is not None and returns not in ("?", "None"):
            self.flag(node, "every path returns a value (a match without `case _` may fall through)")

    def block(self, body: list[ast.stmt]) -> None:
        for statement in body:
            self.visit(statement)

    def meaning(self, node: ast.expr) -> Meaning:
        root = node.value if isinstance(node, ast.Attribute) else node
        return None if isinstance(root, ast.Name) and root.id in self.locals else super().meaning(node)

    def visit_Name(self, node: ast.Name) -> Kind:
        if node.id not in self.locals:
            return super().visit_Name(node)
        if self.bound is not None and node.id not in self.bound:
            late = f"the loop variable {node.id} is not used after its loop"
            self.flag(node, late if node.id in self.ended else f"{node.id} may be unbound here")
        return self.kinds.get(node.id, "?")

    def bind(self, node: ast.AST, name: str, kind: Kind) -> None:
        if name in self.loops:
            self.flag(node, f"the loop variable {name} is not reassigned")
        self.kinds[name] = self.either(self.kinds.get(name, kind), kind)
        self.bound = None if self.bound is None else self.bound | {name}

    def assign(self, target: ast.expr, kind: Kind) -> None:
        if isinstance(target, ast.Name):
            self.bind(target, target.id, kind)
        elif self.is_object(self.visit(target)):
            self.flag(target, "an object or list is never rebound: assign its fields or elements")

    def visit_Assign(self, node: ast.Assign) -> None:
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=parts)], value=ast.Call() as call):
                kinds = self.visit(call)
                for at, part in enumerate(parts):
                    if isinstance(part, ast.Name):
                        self.bind(part, part.id, kinds[at] if isinstance(kinds, tuple) and at < len(kinds) else "?")
                    else:
                        self.flag(part, TUPLE)
            case _:
                kind = self.value(node.value)
                for target in node.targets:
                    self.assign(target, kind)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        kind = self.package.kind(self.file, node.annotation)
        if kind in ("?", "None") or isinstance(kind, tuple):
            self.flag(node, f"a local is {KINDS}")
        if node.value is not None:
            self.value(node.value)
            self.assign(node.target, kind)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        kind = self.value(node.target)
        if isinstance(node.op, ast.Mod) and kind != "float":
            self.flag(node, "no `%=` but on floats: write x = x % n")
        result = self.operate(node, node.op, kind, self.value(node.value))
        if isinstance(node.target, ast.Name):
            self.bind(node, node.target.id, result)

    def visit_Expr(self, node: ast.Expr) -> None:
        self.value(node.value)

    def visit_Pass(self, node: ast.Pass) -> None:
        pass

    def visit_Return(self, node: ast.Return) -> None:
        if isinstance(node.value, ast.Tuple):
            for part in node.value.elts:
                self.value(part)
        elif node.value is not None:
            self.visit(node.value)
        self.bound = None

    def visit_Break(self, node: ast.Break) -> None:
        if self.breaks:
            self.breaks[-1].append(self.bound)
        self.bound = None

    def visit_Continue(self, node: ast.Continue) -> None:
        self.bound = None

    def visit_If(self, node: ast.If) -> None:
        self.condition(node.test)
        before = self.bound
        self.block(node.body)
        after, self.bound = self.bound, before
        self.block(node.orelse)
        self.bound = meet(after, self.bound)

    def visit_Match(self, node: ast.Match) -> None:
        self.selector(node.subject)
        before, after, complete = self.bound, None, False
        for case in node.cases:
            self.bound = before
            self.pattern(case.pattern)
            if case.guard is not None:
                self.condition(case.guard)
            self.block(case.body)
            after = meet(after, self.bound)
            complete |= case.guard is None and isinstance(case.pattern, ast.MatchAs)
        self.bound = after if complete else meet(after, before)

    def selector(self, node: ast.expr) -> None:
        kind = self.value(node)
        if kind not in ("int", "?") and not self.is_enumeration(kind):
            self.flag(node, PATTERN)

    def pattern(self, pattern: ast.pattern) -> None:
        match pattern:
            case ast.MatchOr(patterns=parts):
                for part in parts:
                    self.pattern(part)
            case ast.MatchValue(value=value):
                self.selector(value)
            case ast.MatchAs(pattern=None, name=None):
                pass
            case _:
                self.flag(pattern, PATTERN)

    def visit_While(self, node: ast.While) -> None:
        self.forget_loop_variables(node)
        self.condition(node.test)
        endless = isinstance(node.test, ast.Constant) and bool(node.test.value)
        self.loop(node, None if endless else self.bound)

    def visit_For(self, node: ast.For) -> None:
        match node:
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Name(id="range"), args=limits, keywords=[])):
                for limit in limits:
                    self.value(limit)
                self.forget_loop_variables(node)
                skipped = self.bound
                self.bind(node, name, "int")
                self.loops.append(name)
                self.loop(node, skipped)
                self.loops.pop()
            case _:
                self.flag(node, "for runs one variable over range")

    def forget_loop_variables(self, loop: ast.While | ast.For) -> None:
        """A loop comes round: what an inner `for` leaves behind is not used before that `for` either."""
        targets = [inner.target for inner in ast.walk(loop) if isinstance(inner, ast.For)]
        names = {target.id for target in targets if isinstance(target, ast.Name)} - set(self.loops)
        self.ended |= names
        self.bound = None if self.bound is None else self.bound - names

    def loop(self, node: ast.While | ast.For, skipped: Bound) -> None:
        if node.orelse:
            self.flag(node.orelse[0], "a loop has no else")
        self.breaks.append([])
        self.block(node.body)
        self.bound = skipped
        for bound in self.breaks.pop():
            self.bound = meet(self.bound, bound)


class Module(Expressions):
    """The rules for what stands at module level and in classes."""

    def generic_visit(self, node: ast.AST) -> Kind:
        return self.flag(node, MODULE_LEVEL) if isinstance(node, ast.stmt) else super().generic_visit(node)

    def visit_Call(self, node: ast.Call) -> Kind:
        if self.meaning(node.func) == "math.sqrt":
            return super().visit_Call(node)
        return self.flag(node, "a constant is a number or arithmetic on numbers; it calls nothing but math.sqrt")

    def visit_Import(self, node: ast.Import) -> None:
        if [alias.name for alias in node.names] != ["math"]:
            self.flag(node, IMPORTS)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        names = [alias.name for alias in node.names]
        origin = self.package.origin(self.file, node)
        if node.level:
            allowed = origin is not None and (node.module or [str(origin / name) for name in names] == ["var"])
        else:
            allowed = node.module == "math" or (node.module == "dataclasses" and names == ["dataclass"])
        if "*" in names or not allowed:
            self.flag(node, IMPORTS)

    def visit_Assign(self, node: ast.Assign) -> None:
        if len(node.targets) != 1 or not isinstance(node.targets[0], ast.Name):
            self.flag(node, MODULE_LEVEL)
        if not names_of_variables(node.value):
            self.value(node.value)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if self.package.kind(self.file, node.annotation) not in ("float", "int", "bool") or node.value is None:
            self.flag(node, MODULE_LEVEL)
        else:
            self.value(node.value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        Body(self.package, self.file, self.violations).check(node, None)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        rules = self.enumeration if self.is_enumeration(node) else self.dataclass
        rules(node)

    def enumeration(self, node: ast.ClassDef) -> None:
        for item in without_docstring(node.body):
            match item:
                case ast.Assign(
                    targets=[ast.Name()],
                    value=ast.Tuple(elts=[number, ast.Constant(value=str()) | ast.Starred(value=ast.Name()), *_]),
                ):
                    if self.value(number) == "int":
                        continue
            self.flag(item, 'an enumeration holds only members: NAME = integer, "description"')

    def dataclass(self, node: ast.ClassDef) -> None:
        if [ast.unparse(decorator) for decorator in node.decorator_list] != ["dataclass(slots=True)"]:
            self.flag(node, "a class is an enumeration or a @dataclass(slots=True)")
        bases = [self.meaning(base) for base in node.bases]
        extended = any(isinstance(base, ast.ClassDef) and not self.only_declared(base) for base in bases)
        if node.keywords or len(bases) > 1 or not all(isinstance(base, ast.ClassDef) for base in bases):
            self.flag(node, DERIVED)
        for item in without_docstring(node.body):
            match item:
                case ast.AnnAssign(target=ast.Name(), annotation=annotation, value=start):
                    if extended and self.declared(start) is None:
                        self.flag(item, DERIVED)
                    self.field(item, self.package.kind(self.file, annotation), start)
                case ast.FunctionDef(name=name):
                    if extended:
                        self.flag(item, DERIVED)
                    if self.package.member(node, name, ast.AnnAssign) is not None:
                        self.flag(item, f"the method {name} has the name of a field")
                    Body(self.package, self.file, self.violations).check(item, node)
                case _:
                    self.flag(item, "a dataclass holds only typed fields and methods")

    def only_declared(self, node: ast.ClassDef) -> bool:
        """Whether a dataclass is an interface: nothing but declared fields, its own and those it inherits."""
        own = Module(self.package, self.package.homes[node], [])  # names mean what they mean in its own module
        fields = (isinstance(item, ast.AnnAssign) and own.declared(item.value) for item in without_docstring(node.body))
        bases = (own.meaning(base) for base in node.bases)
        return all(fields) and all(isinstance(base, ast.ClassDef) and own.only_declared(base) for base in bases)

    def declared(self, start: ast.expr | None) -> ast.Call | None:
        """The call on the declarations, such as `var.input(0.0, …)`, that gives a field its start value."""
        meaning = self.meaning(start.func) if isinstance(start, ast.Call) else None
        is_declared = isinstance(meaning, str) and meaning.startswith("var.")
        return start if isinstance(start, ast.Call) and is_declared else None

    def field(self, item: ast.AnnAssign, kind: Kind, start: ast.expr | None) -> None:
        call = self.declared(start)
        if kind in ("?", "None") or isinstance(kind, tuple) or isinstance(item.annotation, ast.Constant):
            self.flag(item, f"a field is {KINDS}")
        elif self.is_object(kind):
            if call is None or (kind != "list" and kind not in [self.meaning(made) for made in call.args[:1]]):
                self.flag(item, "an object or list is made with its owner: var.part(Class), var.ring(length)")
        else:
            first = start if call is None else call.args[0] if call.args else None
            given = self.flag(item, "a field has a start value") if first is None else self.value(first)
            if given not in (kind, "?") and not (kind == "int" and self.is_enumeration(given)):
                self.flag(item, "a field starts with a value of its own type: a float with 1.0, not 1")


def violations(package: Package, file: str) -> list[Violation]:
    """What is outside the subset in one module of a package, in the order of its lines."""
    module = Module(package, file, [])
    for statement in without_docstring(package.trees[file].body):
        module.visit(statement)
    return sorted(dict.fromkeys(module.violations), key=lambda violation: violation.line)


def check(package_sources: Mapping[str, str]) -> list[Violation]:
    """What is outside the subset in the modules of the model, given as path inside the package to text.

    Raises SyntaxError, with file and line, if a text is not Python at all.
    """
    package = Package(package_sources)
    return [found for file in package.trees if not package.exempt(file) for found in violations(package, file)]
