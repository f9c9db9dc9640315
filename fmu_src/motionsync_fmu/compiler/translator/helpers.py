"""Small functions for what Python does otherwise than C; a block's text starts with those that it needs."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Helper:
    """One function.

    Attributes:
        parameters: without `failed`.
        needs: the functions that it calls.
        apart: whether it is not to be inlined.
    """

    returns: str
    parameters: str
    body: str
    needs: tuple[str, ...] = ()
    apart: bool = False

    @property
    def fails(self) -> bool:
        """Whether it has the parameter `failed`, which it sets where Python would raise."""
        return "failed" in self.body


FINITE = "if (!(fabs(x) <= DBL_MAX)) *failed = true;\n"
HELPERS = {
    "nonzero": Helper("double", "double x", "if (x == 0.0) *failed = true;\nreturn x;"),
    "nonzero_int": Helper("int64_t", "int64_t n", "if (n != 0) return n;\n*failed = true;\nreturn 1;"),
    "index_from_end": Helper(
        "int64_t",
        "int64_t i, int64_t length",
        "if (i < 0 && i >= -length) return i + length;\n*failed = true;\nreturn 0;",
        apart=True,
    ),
    "index_in": Helper(
        "int64_t",
        "int64_t i, int64_t length",
        "return (uint64_t)i < (uint64_t)length ? i : index_from_end(i, length, failed);",
        ("index_from_end",),
    ),
    "py_min": Helper("double", "double a, double b", "return b < a ? b : a;"),
    "py_max": Helper("double", "double a, double b", "return b > a ? b : a;"),
    "py_min_int": Helper("int64_t", "int64_t a, int64_t b", "return b < a ? b : a;"),
    "py_max_int": Helper("int64_t", "int64_t a, int64_t b", "return b > a ? b : a;"),
    "py_abs_int": Helper("int64_t", "int64_t n", "return n < 0 ? -n : n;"),
    "py_isfinite": Helper("bool", "double x", "return fabs(x) <= DBL_MAX;"),
    "py_sqrt": Helper("double", "double x", "if (x < 0.0) *failed = true;\nreturn sqrt(x);"),
    "py_fmod": Helper(
        "double",
        "double x, double y",
        "const double rest = fmod(x, y);\nif (rest != rest && x == x && y == y) *failed = true;\nreturn rest;",
    ),
    "py_mod": Helper(
        "double",
        "double x, double y",
        "const double rest = fmod(x, y);\nif (rest == 0.0) return y < 0.0 ? -0.0 : 0.0;\n"
        "return (rest < 0.0) != (y < 0.0) ? rest + y : rest;",
    ),
    "py_mod_int": Helper(
        "int64_t",
        "int64_t a, int64_t b",
        "const int64_t rest = a % b;\nreturn rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;",
    ),
    "py_floordiv_int": Helper("int64_t", "int64_t a, int64_t b", "return (a - py_mod_int(a, b)) / b;", ("py_mod_int",)),
    "py_floor": Helper("double", "double x", f"{FINITE}return floor(x) + 0.0; /* no -0.0 */"),
    "py_round": Helper("double", "double x", f"{FINITE}return rint(x) + 0.0; /* halves to even; no -0.0 */"),
    "py_int": Helper(
        "int64_t",
        "double x",
        "if (x >= -9223372036854775808.0 && x < 9223372036854775808.0) return (int64_t)x;\n*failed = true;\nreturn 0;",
    ),
}


def helper_texts(names: Iterable[str]) -> Iterator[str]:
    """The helpers of these names, and those that they need, in the order of the table."""
    needed = {*names}.union(*(HELPERS[name].needs for name in names))
    for name in (name for name in HELPERS if name in needed):
        helper = HELPERS[name]
        end = ", bool *failed" if helper.fails else ""
        body = "".join(f"    {line}\n" for line in helper.body.splitlines())
        specifiers = "APART static" if helper.apart else "static inline"
        yield f"{specifiers} {helper.returns} {name}({helper.parameters}{end}) {{\n{body}}}\n"
