"""Measures what the tests prove: small changes of the sources, and how many of them a test notices.

    python -m tools.mutation measure             which test runs which line, and how long it takes: once, half an hour
    python -m tools.mutation run --sample 600    tries mutants until so many of the seed's sequence are done
    python -m tools.mutation report              the score of each package, and the mutants that survived

A mutant is run against the tests that run its line until one fails: first those that noticed it in another state of
the project, then the shortest, of a mutant of what is compiled those that compile nothing first: a compiled mutant is
in no cache. All results are in build/mutation, a file for each state that is named; `run` goes on
where it was broken off. A mutant of a line that runs at import is run against the tests of its file or folder, one of C
against those of its folder.
"""

import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from queue import SimpleQueue
from typing import Annotated, Any

import pytest
import typer
from coverage import CoverageData
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from tools.mutants import Mutant, find_mutants

ROOT = Path(__file__).parents[1]
FOLDER = Path("build", "mutation")
SOURCES = (
    "model/motionsync",
    *(f"fmu_src/motionsync_fmu/{name}" for name in ("compiler", "native", "batch", "interface", "scenario")),
)
TESTS_OF_C = {  # the folders of tests that run C which is no block's
    "fmu_src/motionsync_fmu/native": ("tests/native/", "tests/fmu/", "tests/fmi3/"),
    "fmu_src/motionsync_fmu/batch": ("tests/batch/", "tests/native/", "tests/scenario/", "tests/measured/"),
}
COMPILED = ("model/", *(f"fmu_src/motionsync_fmu/{name}/" for name in ("compiler", "native", "batch")))
COMPILERS = tuple(f"fmu_src/motionsync_fmu/{name}" for name in ("native", "batch"))
LEFT_OUT = (
    *("tests/pages/test_contributing.py", "tests/install/"),  # they run other tests, or none of the project's code
    "tests/commands/projects/test_paths.py",  # it limits the size of files, which coverage writes as well
)
COLLECTION = 120.0  # s, at most
State = Annotated[str, typer.Option(help="names the results: before, say")]
PROCESSES = multiprocessing.get_context("forkserver")  # what all tests import is imported once, but for the project
PROCESSES.set_forkserver_preload(["pytest", "hypothesis", "numpy", "mpmath", "fmpy", "typer", "rich", "coverage"])
app = typer.Typer(help=__doc__, no_args_is_help=True, add_completion=False)
console = Console()


@dataclass(frozen=True)
class Reach:
    """Which tests run which line, and how long each of them takes."""

    seconds: dict[str, float]
    tests: dict[str, dict[str, list[int]]]  # by file and line: numbers of the tests in `seconds`
    present: set[str]  # the tests that the project has now
    noticed: dict[str, list[str]] = field(default_factory=dict)  # by mutant: tests that failed with it before
    sound: set[str] = field(default_factory=set)  # tests that have passed in a copy of the sources

    def tests_of(self, mutant: Mutant) -> list[str]:
        """The tests that run a mutant's statement, the shortest first, but for those that noticed it before."""
        names = list(self.seconds)
        if mutant.path.endswith(".py"):
            lines = self.tests.get(mutant.path, {})
            statement = [str(line) for line in range(mutant.lines[0], mutant.lines[1] + 1)]
            numbers = {i for line in statement for i in lines.get(line, ())}
            if not numbers:  # it runs at import, which is no test's
                numbers = {i for tests in lines.values() for i in tests} or self.numbers_of(
                    str(Path(mutant.path).parent)
                )
            reached = {names[i] for i in numbers}
        else:
            folders = next(tests for folder, tests in TESTS_OF_C.items() if mutant.path.startswith(folder))
            reached = {name for name in self.compiling if name.startswith(folders)}
        noticed = self.noticed.get(mutant.name, ())
        reached = {name for name in reached & self.present if not name.startswith(LEFT_OUT)}
        compiling = self.compiling if mutant.path.startswith(COMPILED) else ()
        return sorted(reached, key=lambda name: (name not in noticed, name in compiling, self.seconds[name]))

    @cached_property
    def compiling(self) -> set[str]:
        """The tests that run what compiles, or what runs compiled code."""
        names = list(self.seconds)
        return {names[i] for folder in COMPILERS for i in self.numbers_of(folder)}

    def numbers_of(self, folder: str) -> set[int]:
        """The numbers of the tests that run anything in a folder."""
        files = [lines for path, lines in self.tests.items() if path.startswith(f"{folder}/")]
        return {i for lines in files for tests in lines.values() for i in tests}

    def passes(self, tree: Path, test: str) -> bool:
        """Whether a test passes in a tree without a mutant; it is run once."""
        if test not in self.sound and not first_failure(tree, self.limits([test])):
            self.sound.add(test)
        return test in self.sound

    def limits(self, tests: Sequence[str]) -> dict[str, float]:
        """After how many seconds each of these tests counts as one without an end."""
        return {test: 90.0 + 10.0 * self.seconds[test] for test in tests}


@app.command()
def measure(jobs: Annotated[int, typer.Option(help="processes of the tests")] = 2) -> None:
    """Run all tests once and record which lines each of them runs."""
    folder = ROOT / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    data, times = folder / "coverage", folder / "times.xml"
    config = folder / "coveragerc"
    config.write_text(f"[run]\ndata_file = {data}\nrelative_files = true\n")
    cover = ["--cov=model", "--cov=fmu_src", "--cov-context=test", "--cov-report=", f"--cov-config={config}"]
    skip = [f"--ignore={path}" for path in LEFT_OUT]
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        f"-n{jobs}",
        "--dist=worksteal",
        *cover,
        *skip,
        f"--junitxml={times}",
    ]
    subprocess.run(command, cwd=ROOT, check=False)
    write_reach(data, times, folder / "reach.json")


def write_reach(data: Path, times: Path, path: Path) -> None:
    """Join what the coverage and the times of the tests that passed say."""
    passed = [case for case in ET.parse(times).iter("testcase") if not len(case)]
    seconds = {node_id(case): float(case.get("time", 0.0)) for case in passed}
    numbers = {name: i for i, name in enumerate(seconds)}
    coverage = CoverageData(str(data))
    coverage.read()
    tests: dict[str, dict[str, list[int]]] = {}
    for file in coverage.measured_files():
        lines: dict[str, set[int]] = defaultdict(set)
        for line, contexts in coverage.contexts_by_lineno(file).items():
            names = (context.split("|")[0] for context in contexts)
            lines[str(line)] |= {numbers[name] for name in names if name in numbers}
        tests[file] = {line: sorted(reached) for line, reached in lines.items() if reached}
    path.write_text(json.dumps({"seconds": seconds, "tests": tests}))


def node_id(case: ET.Element) -> str:
    """pytest's name of a test, from the class and the name in its report."""
    module, name = case.get("classname", ""), case.get("name", "")
    return f"{module.replace('.', '/')}.py::{name}"


@app.command()
def run(
    sample: Annotated[int, typer.Option(help="how many mutants of the seed's sequence")] = 600,
    seed: Annotated[int, typer.Option(help="of the sequence")] = 0,
    jobs: Annotated[int, typer.Option(help="mutants tried at once")] = 2,
    budget: Annotated[float, typer.Option(help="s; the shortest tests of a mutant, up to so long in all")] = 120.0,
    state: State = "now",
) -> None:
    """Try mutants; those that were tried before in this state are not tried again."""
    measured = json.loads((ROOT / FOLDER / "reach.json").read_text())
    reach = Reach(**measured, present=present_tests(ROOT), noticed=noticed(ROOT / FOLDER))
    results = results_of(state)
    done = {result["name"] for result in read_results(results)}
    open_mutants = [mutant for mutant in draw(ROOT, seed, sample) if mutant.name not in done]
    console.print(f"{sample - len(open_mutants)} of {sample} are done; results: {results}")
    trees: SimpleQueue[Path] = SimpleQueue()
    for i in range(jobs):
        trees.put(copy_tree(ROOT, ROOT / FOLDER / f"tree-{i}"))
    with Progress(console=console) as progress, ThreadPoolExecutor(jobs) as pool, results.open("a") as file:
        task = progress.add_task("mutants", total=len(open_mutants))
        for future in as_completed([pool.submit(try_mutant, mutant, reach, trees, budget) for mutant in open_mutants]):
            result = future.result()
            print(json.dumps(result), file=file, flush=True)
            if result["result"] == "survived":
                console.print(result["name"], markup=False)
            progress.advance(task)
    report(state)


@app.command()
def report(state: State = "now") -> None:
    """Print the score of each package and the survivors."""
    results = read_results(results_of(state))
    table = Table("package", "mutants", "killed", "survived", "no test runs it", "score")
    packages = sorted({package_of(result["name"]) for result in results})
    for package in [*packages, ""]:
        own = [result["result"] for result in results if package in ("", package_of(result["name"]))]
        counts = [own.count(name) for name in ("killed", "survived", "not reached")]
        table.add_row(package or "all", str(len(own)), *map(str, counts), f"{counts[0] / max(len(own), 1):.1%}")
    console.print(table)
    for result in results:
        if result["result"] != "killed":
            text = f"{result['result']}: {result['name']}, line {result['line']} ({result['tests']} tests)"
            console.print(text, markup=False)


def results_of(state: str) -> Path:
    return ROOT / FOLDER / f"results-{state}.jsonl"


def present_tests(root: Path) -> set[str]:
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q"]
    return set(subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.split("\n"))


def noticed(folder: Path) -> dict[str, list[str]]:
    """The tests that noticed a mutant in any state."""
    tests: dict[str, list[str]] = defaultdict(list)
    for path in sorted(folder.glob("results-*.jsonl")):
        for result in read_results(path):
            tests[result["name"]].append(result["by"])
    return tests


def package_of(name: str) -> str:
    return "/".join(name.split(":", 1)[0].split("/")[1:3])


def read_results(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def draw(root: Path, seed: int, sample: int) -> list[Mutant]:
    """The first `sample` mutants of all in SOURCES, in an order that a seed gives their names.

    So the sample of another state of the project has the same mutants, but for lines that have changed.
    """
    files = subprocess.run(["git", "ls-files", *SOURCES], cwd=root, check=True, capture_output=True, text=True).stdout
    paths = [path for path in files.split() if path.endswith((".py", ".c", ".h"))]
    mutants = [mutant for path in paths for mutant in find_mutants(root, path)]
    return sorted(mutants, key=lambda mutant: sha256(f"{seed} {mutant.name}".encode()).digest())[:sample]


def copy_tree(root: Path, tree: Path) -> Path:
    """A copy of the files under version control, as they are now."""
    shutil.rmtree(tree, ignore_errors=True)
    files = subprocess.run(["git", "ls-files", "-z"], cwd=root, check=True, capture_output=True, text=True).stdout
    for path in filter(None, files.split("\0")):
        if (root / path).is_file():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / path, tree / path)
    return tree


def try_mutant(mutant: Mutant, reach: Reach, trees: SimpleQueue[Path], budget: float) -> dict[str, Any]:
    """Run a mutant's tests in one of the trees, which has the mutant meanwhile."""
    tests = list(within_budget(reach, reach.tests_of(mutant), budget))
    tree = trees.get()
    source = (tree / mutant.path).read_text("utf-8")
    result, failed = "not reached", ""
    try:
        while tests and result not in ("killed", "survived"):
            (tree / mutant.path).write_text(mutant.apply(source), "utf-8")
            failed = first_failure(tree, reach.limits(tests))
            (tree / mutant.path).write_text(source, "utf-8")
            if failed in tests and not reach.passes(tree, failed):
                tests.remove(failed)  # it fails in a copy of the sources, whatever these are
            else:
                result = "killed" if failed else "survived"
    finally:
        (tree / mutant.path).write_text(source, "utf-8")
        trees.put(tree)
    return {"name": mutant.name, "line": mutant.line, "result": result, "by": failed, "tests": len(tests)}


def within_budget(reach: Reach, tests: Sequence[str], budget: float) -> Iterator[str]:
    """The first tests that take no longer in all; at least one."""
    total = 0.0
    for i, test in enumerate(tests):
        total += reach.seconds[test]
        if i and total > budget:
            return
        yield test


def first_failure(tree: Path, limits: Mapping[str, float]) -> str:
    """The first of some tests that fails in a tree, or what else went wrong; empty if all pass.

    `limits`: how long each test may take, in s; the tests run in this order.
    """
    names, failures = tree / "build" / "tests.txt", tree / "build" / "failures.txt"
    names.parent.mkdir(exist_ok=True)
    names.write_text("\n".join(limits))
    failures.unlink(missing_ok=True)
    process = PROCESSES.Process(target=run_tests, args=(tree, names, Watch(failures, dict(limits))))
    process.start()
    process.join(COLLECTION + sum(limits.values()))
    with suppress(ProcessLookupError):  # what a test has started, too
        os.killpg(process.pid or 0, signal.SIGKILL)
    process.join()
    if failures.exists():
        return failures.read_text("utf-8").split("\n")[0]
    return "no end" if (process.exitcode or 0) < 0 else f"exit status {process.exitcode}" if process.exitcode else ""


def run_tests(tree: Path, names: Path, watch: "Watch") -> None:
    """Run tests in this process, with the sources of a tree."""
    os.setsid()
    os.chdir(tree)
    with (tree / "build" / "output.txt").open("w") as output:
        os.dup2(output.fileno(), 1)
        os.dup2(output.fileno(), 2)
    sources = [str(tree / part) for part in ("model", "fmu_src")]
    sys.path[:0] = sources
    os.environ["PYTHONPATH"] = os.pathsep.join(sources)
    # Compiled modules are found by size and second: one of a former mutant could be taken for this one.
    sys.dont_write_bytecode = True
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    status = pytest.main(["-x", "-q", "--tb=no", "-p", "no:cacheprovider", f"@{names}"], plugins=[watch])
    sys.exit(int(status))


@dataclass(frozen=True, eq=False)  # pytest hashes its plugins
class Watch:
    """A plugin of pytest that writes the names of the tests that fail into a file, and ends a process whose test has no
    end.

    Attributes:
        failures: the file.
        limits: how long each test may take, in s.
    """

    failures: Path
    limits: dict[str, float]

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, self.limits[nodeid])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            with self.failures.open("a", encoding="utf-8") as file:
                print(report.nodeid, file=file)


if __name__ == "__main__":
    app()
