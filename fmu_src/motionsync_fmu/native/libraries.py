"""The native flavour: a block's `initialize` and `step` as LLVM text, then as one library a platform.

Numba compiles the two on the block's memory (`record`), zig compiles its text and the FMI functions (`fmi2.c`) for all
platforms. Python, Numba and zig are needed here only: the libraries stand alone.
"""

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from importlib.resources import files as package_files
from math import isinf
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import ziglang
from numba import types

from motionsync.master import MasterInput

from ..archive import Files
from ..errors import UserError
from ..interface.variables import LONGEST_STEP, Variable, refusals, spoken_of, variables
from .memory_layout import dtype, entry, image, offset, record
from .numba_target import lowered

TARGETS = {  # the path under binaries/ of what zig compiles for each; the two of macOS become one file
    "x86_64-linux-gnu.2.17": "linux64/{}.so",
    "x86_64-windows-gnu": "win64/{}.dll",
    "x86_64-macos.11.0": "x86_64/{}.dylib",
    "aarch64-macos.11.0": "arm64/{}.dylib",
    "aarch64-linux-gnu.2.17": "aarch64-linux/{}.so",
}
FLAGS = (
    "-O2 -ffp-contract=off -fno-strict-aliasing -fno-slp-vectorize "
    "-fPIC -shared -fvisibility=hidden -g0 -s -Wno-override-module"
)
OPTIONS = {  # of the targets whose name holds the word; whatever can be left out is: an FMU holds five libraries
    "linux": "-Wl,-z,defs -Wl,--hash-style=gnu -fno-asynchronous-unwind-tables -fno-unwind-tables",
    "macos": "-fno-asynchronous-unwind-tables -fno-unwind-tables",
    "windows": "-rtlib=none -Wl,-e,library_main",  # fmi2.c has what is missed then
    "aarch64": "-mno-outline",  # functions made of common pieces are shorter, but pack worse
}
HEADERS = Path(str(package_files("fmpy"))) / "c-code"  # FMI's
PATIENCE = 15.0  # s; a compilation that takes longer is the first of this zig on the machine
FIRST_USE = "compiling zig's own libraries for all platforms: this takes minutes, once; later builds take seconds"

# Derivatives that the importer may give and ask for, by order; not of a block that lacks one of the variables.
MASTER = ("master.position", "master.velocity", "master.acceleration")
INPUT_MODE = "master.input_mode"
SLAVE = ("slave.position", "slave.velocity", "slave.acceleration")

# Numba's functions tell an exception's kind and message, and that they return None: nobody reads it.
UNREAD = re.compile(r"^ +store ptr (?:\S+, ptr %excinfo|null, ptr %retptr),.*\n", re.M)

# What the compiled block may call: of the C library and of LLVM, all exact by IEEE 754 or without floating point.
EXACT = {"sqrt", "floor", "rint", "fmod", "fabs"}
PLAIN = re.compile(r"llvm\.(?:(?:mem(?:set|cpy|move)|lifetime|assume|is\.fpclass)\b.*|\w+\.i\d+)")
# What would let a processor round otherwise. Only this check keeps it out: for LLVM text -ffp-contract has no effect.
INEXACT = re.compile(
    r"\b(?:f(?:add|sub|mul|div|rem|neg|cmp)|select|phi|call)\b[^\n]*?"
    r"\b(?:fast|contract|reassoc|arcp|afn|nnan|ninf|nsz)\b|@llvm\.fma|@llvm\.fmuladd"
)


def libraries(block: Any, guid: str, told: Callable[[str], None] = lambda text: None) -> Files:
    """The library of every platform, by its path under binaries/; `told` is told once if it will take minutes.

    Raises:
        UserError: zig failed.
    """
    name = type(block).__name__
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "fmi2.c").write_bytes((Path(__file__).parent / "fmi2.c").read_bytes())
        (work / "model.ll").write_text(llvm_text(block), "utf-8", newline="\n")
        (work / "model.h").write_text(model_header(block, guid), "utf-8", newline="\n")
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = {path: pool.submit(_compile, target, path.format(name), work) for target, path in TARGETS.items()}
            if wait(jobs.values(), PATIENCE, FIRST_EXCEPTION).not_done:
                told(FIRST_USE)
            files = {path.format(name): job.result() for path, job in jobs.items()}
    mac = [files.pop(f"{processor}/{name}.dylib") for processor in ("x86_64", "arm64")]
    return files | {f"darwin64/{name}.dylib": universal(*mac)}


def _compile(target: str, path: str, work: Path) -> bytes:
    """One library; names of files stay relative, so that it is the same wherever it was compiled."""
    (work / path).parent.mkdir()
    options = [option for word, some in OPTIONS.items() if word in target for option in some.split()]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *FLAGS.split(), "-I.", "-I", str(HEADERS)]
    done = subprocess.run(
        [*command, "fmi2.c", "model.ll", "-lm", *options, "-o", path],
        cwd=work,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if done.returncode:
        raise UserError(
            f"zig could not compile for {target}: it needs a folder that can be written (ZIG_GLOBAL_CACHE_DIR; else "
            f"one in the user's cache) with 1 GB to spare; without zig take --flavour python. zig said:\n"
            f"{done.stderr.strip()[-2000:]}"
        )
    return (work / path).read_bytes()


def linked_licences() -> Files:
    """Of what the libraries hold beside the block, Numba and zig: the start of a Windows library, FMI's headers."""
    mingw = Path(*ziglang.__path__) / "lib" / "libc" / "mingw" / "COPYING"
    header = (HEADERS / "fmi2Functions.h").read_text("utf-8")
    return {
        "mingw-w64.txt": mingw.read_bytes(),
        "fmi-headers.txt": header[header.index("Copyright") : header.index("*/")].rstrip().encode() + b"\n",
    }


def abilities(block: Any) -> dict[str, str]:
    """What only this flavour can do, as attributes of the description's CoSimulation element."""
    index = {v.name: i for i, v in enumerate(variables(block))}
    found = {"maxOutputDerivativeOrder": "2"} if has(index, *SLAVE) else {}
    return found | ({"canInterpolateInputs": "true"} if has(index, *MASTER, INPUT_MODE) else {})


def has(index: dict[str, int], *names: str) -> bool:
    return index.keys() >= {*names}


# --- LLVM text ---


def llvm_text(block: Any) -> str:
    """Both entry points and what they need, and nothing else: no Python, no unknown external symbol."""
    this = record(block)
    methods = {"initialize": (this,), "step": (this, types.float64)}
    whole, entries = lowered({f"model_{m}": (entry(type(block), m), arguments) for m, arguments in methods.items()})
    whole = llvm.parse_assembly(UNREAD.sub("", str(whole)))
    _keep(whole, entries)
    return portable(str(whole))


def _keep(module: llvm.ModuleRef, entries: dict[str, str]) -> None:
    """Drop all that the entry points do not need. Numba's names count how much was compiled before: they go too."""
    for i, thing in enumerate((*module.functions, *module.global_variables)):
        if thing.name in entries:
            thing.linkage, thing.visibility, thing.name = "external", "hidden", entries[thing.name]
        elif not thing.is_declaration:
            thing.linkage, thing.name = "internal", f"internal_{i}"
    _optimise(module)


def _optimise(module: llvm.ModuleRef) -> None:
    """Once for all platforms, with an eye on size: most of a large block is planning, which a step seldom does."""
    for function in module.functions:
        if not function.is_declaration:
            for attribute in ("optsize", "nounwind"):  # the last: no tables of how to unwind it
                function.add_function_attribute(attribute)
    llvm.initialize_native_target()
    machine = llvm.Target.from_default_triple().create_target_machine()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    first = llvm.create_new_module_pass_manager()
    first.add_merge_functions_pass()  # what several classes inherit, before it is inlined where each calls it
    first.run(module, builder)
    builder.getModulePassManager().run(module, builder)


def portable(text: str) -> str:
    """Without a target; refused if it calls anything outside the allow-list, or may be rounded otherwise elsewhere."""
    text = re.sub(r"^(target|source_filename|; ModuleID).*\n", "", text, flags=re.M)
    called = re.findall(r"^declare .*?@([\w.]+)\(", text, re.M)
    foreign = [n for n in called if re.sub(r"^llvm\.|\.f64$", "", n) not in EXACT and not PLAIN.fullmatch(n)]
    if foreign:
        raise RuntimeError(f"the compiled block needs {sorted(foreign)}")
    if inexact := INEXACT.search(text):
        raise RuntimeError(f"not the same bits everywhere: {inexact[0]}")
    if "target-" in text:
        raise RuntimeError("the compiled block is for one processor only")
    return text


def universal(*thin: bytes) -> bytes:
    """A Mach-O file for several processors: a header, then each library on a 16 KiB boundary."""
    header, body, at = (0xCAFEBABE).to_bytes(4, "big") + len(thin).to_bytes(4, "big"), b"", 1 << 14
    for library in thin:
        processor = library[4:12][3::-1] + library[8:12][::-1]  # cpu type and subtype, big-endian
        header += processor + b"".join(n.to_bytes(4, "big") for n in (at + len(body), len(library), 14))
        body += library + bytes(-len(library) % at)
    return header.ljust(at, b"\0") + body


# --- tables for the C file ---


def model_header(block: Any, guid: str) -> str:
    """What fmi2.c needs to know about the block: its memory, its variables, what it refuses."""
    start, layout, vs = image(block).tobytes(), dtype(block), variables(block)
    index = {v.name: i for i, v in enumerate(vs)}
    pool = Pool()
    rows = [_row(v, layout, pool) for v in vs]
    messages = _messages(refusals(type(block)), index, pool)
    coded = []
    for v in vs:
        if v.declaration.codes:
            coded.append(_list((index[v.name], len(messages))))
            messages += _messages(v.declaration.codes, index, pool, v.name)
    master = [index[name] for name in MASTER] if has(index, *MASTER, INPUT_MODE) else [-1] * 3
    slave = [index[name] for name in SLAVE] if has(index, *SLAVE) else [-1] * 3
    lines = [
        f"#define MODEL_GUID {quoted(guid)}",
        f"#define MODEL_SIZE {len(start)}",
        f"#define LONGEST_STEP {LONGEST_STEP!r}",
        f"enum {{ START_OF_STEP = {MasterInput.START_OF_STEP}, END_OF_STEP = {MasterInput.END_OF_STEP} }};",
        f"enum {{ INPUT_MODE = {index.get(INPUT_MODE, -1)} }};",
        f"static const int MASTER[] = {_list(master)}, SLAVE[] = {_list(slave)};",
        f"static const uint8_t START[MODEL_SIZE] = {_list(start)};",
        *("static const char TEXTS[] =", *(f'    {quoted(text)} "\\0"' for text in pool.texts), ";"),
        f"static const int32_t NUMBERS[] = {_list(n for numbers in pool.lists for n in numbers)};",
        *("static const Variable VARIABLES[] = {", *(f"    {row}," for row in rows), "};"),
        *("static const Message MESSAGES[] = {", *(f"    {row}," for row in messages), "};"),
        "enum { REFUSALS = 0 }; /* where in MESSAGES they begin */",
        f"static const Coded CODED[] = {_list([*coded, '{-1, 0}'])};",
    ]
    return "\n".join([*lines, ""])


class Pool:
    """Texts and lists of numbers, each once, and where in the array of all it begins."""

    def __init__(self) -> None:
        self.texts: dict[str, int] = {}
        self.lists: dict[tuple[int, ...], int] = {}

    def text(self, text: str) -> int:
        clean = unformatted(text)
        return self.texts.setdefault(clean, sum(len(other.encode()) + 1 for other in self.texts))

    def numbers(self, *numbers: int) -> int:
        return self.lists.setdefault(numbers, sum(map(len, self.lists)))


def _row(v: Variable, layout: Any, pool: Pool) -> str:
    access = {"input": "INPUT", "parameter": v.variability.upper()}.get(v.causality, "OUTPUT")
    d = v.declaration
    columns = (
        pool.text(v.name),
        pool.text(f"{v.variability} {v.causality}"),
        v.kind.upper(),
        access,
        offset(layout, v.name),
        *(number(x) for x in (d.min, d.max, d.above, d.below, d.smallest)),
        str(d.zero).lower(),
        pool.numbers(len(v.choices), *(int(m) for m in v.choices)),
        pool.text(v.allowed_range),
    )
    return _list(columns)


def _messages(codes: Any, index: dict[str, int], pool: Pool, coded: str = "") -> list[str]:
    rows = []
    for m in codes:
        if m != 0:
            shown = pool.numbers(*(index[name] for name in spoken_of(m, index, coded)), -1)
            rows.append(_list((int(m), pool.text(m.description), shown)))
    return [*rows, "{0, 0, 0}"]


def _list(items: Iterable[Any]) -> str:
    return "{" + ", ".join(map(str, items)) + "}"


def number(x: float) -> str:
    """A number in C, with all its bits."""
    return ("-" if x < 0 else "") + "INFINITY" if isinf(x) else float(x).hex()


def quoted(text: str) -> str:
    """A text in C, without percent signs."""
    escaped = unformatted(text).replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def unformatted(text: str) -> str:
    """Without percent signs: many an importer takes them for a format."""
    return text.replace("%", "percent")
