"""The measure of what tests prove: which changes it makes, which tests it runs, and what it finds."""

import subprocess
from pathlib import Path
from queue import SimpleQueue

import pytest

from tools.mutants import Mutant, find_mutants
from tools.mutation import Reach, copy_tree, draw, try_mutant

PYTHON = '''"""A half; 1 + 1 in a docstring is no code."""


def half(x: int = 1 + 0) -> float:  # 2 + 2
    x += 0
    if "ä" and (x) > 6.0 and not None:
        print(x)
    else:
        x = x if x is not None else -1
    return x / 2
'''
C = """/* 1 + 1 */
#define TWO 2
static int half(const int *x) {
    say("1 + 1", x->y);
    return *x / TWO >= 3 && x[0] - 1;
}
"""


def changes(root: Path, name: str, text: str) -> list[tuple[int, str, str, str]]:
    (root / name).write_text(text, "utf-8")
    return [(m.line, m.operator, m.original, m.replacement) for m in find_mutants(root, name)]


def test_the_changes_of_a_python_file(tmp_path: Path) -> None:
    assert changes(tmp_path, "half.py", PYTHON) == [
        (4, "constant", "1", "(1 + 1)"),
        (4, "arithmetic", "+", "-"),
        (4, "constant", "0", "(0 + 1)"),
        (5, "removed statement", "x += 0", "pass"),
        (5, "constant", "0", "(0 + 1)"),
        (6, "swapped branch", '"ä" and (x) > 6.0 and not None', '(not ("ä" and (x) > 6.0 and not None))'),
        (6, "logic", "and", "or"),
        (6, "comparison", ">", ">="),
        (6, "constant", "6.0", "(6.0 + 1)"),
        (6, "logic", "not None", "(None)"),
        (7, "removed statement", "print(x)", "pass"),
        (9, "swapped branch", "x is not None", "(not (x is not None))"),
        (9, "comparison", "is not", "is"),
        (9, "constant", "1", "(1 + 1)"),
        (10, "arithmetic", "/", "*"),
        (10, "constant", "2", "(2 + 1)"),
    ]


def test_the_changes_of_a_c_file(tmp_path: Path) -> None:
    assert changes(tmp_path, "half.c", C) == [
        (4, "removed statement", 'say("1 + 1", x->y);', ";"),
        (5, "arithmetic", "/", "*"),
        (5, "comparison", ">=", ">"),
        (5, "constant", "3", "(3 + 1)"),
        (5, "logic", "&&", "||"),
        (5, "constant", "0", "(0 + 1)"),
        (5, "arithmetic", "-", "+"),
        (5, "constant", "1", "(1 + 1)"),
    ]


def test_a_mutant_does_not_fit_another_source(tmp_path: Path) -> None:
    (tmp_path / "half.py").write_text("x = 1 + 2\n")
    (mutant, *_) = find_mutants(tmp_path, "half.py")
    with pytest.raises(ValueError, match=r"half.py, line 1: the source is not the one"):
        mutant.apply("y = 22222 + 2\n")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Two functions, and a test that checks the first and one that checks nothing of the second; one fails always."""
    root = tmp_path / "project"
    for path, text in {
        "model/motionsync/half.py": "def half(x):\n    return x / 2\n\n\ndef third(x):\n    return x / 3\n",
        "model/motionsync/__init__.py": "",
        "tests/test_half.py": (
            "from motionsync.half import half, third\n\n\n"
            "def test_half():\n    assert half(8) == 4\n\n\n"
            "def test_third():\n    third(9)\n\n\n"
            "def test_broken():\n    half(9)\n    raise AssertionError\n"
        ),
        ".gitignore": "build\n",
    }.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text)
    for command in (("init", "-q"), ("add", ".")):
        subprocess.run(["git", *command], cwd=root, check=True)
    return root


def test_a_mutant_that_a_test_notices_is_killed(project: Path) -> None:
    names = ["tests/test_half.py::test_half", "tests/test_half.py::test_third", "tests/test_half.py::test_broken"]
    reach = Reach(dict.fromkeys(names, 0.1), {"model/motionsync/half.py": {"2": [2, 0], "6": [1]}}, {*names})
    trees: SimpleQueue[Path] = SimpleQueue()
    trees.put(copy_tree(project, project / "build" / "tree"))
    mutants = draw(project, 0, 100)
    results = {(m.line, m.original): try_mutant(m, reach, trees, 10.0)["result"] for m in mutants}
    assert results == {(2, "/"): "killed", (2, "2"): "killed", (6, "/"): "survived", (6, "3"): "survived"}


def test_a_sample_is_the_same_after_changes_elsewhere(project: Path) -> None:
    before = draw(project, 0, 3)
    half = project / "model" / "motionsync" / "half.py"
    half.write_text(half.read_text().replace("def half", "ONE = 1\n\n\ndef half"))
    after = [mutant for mutant in draw(project, 0, 5) if "ONE" not in mutant.name]
    assert [mutant.name for mutant in after[:3]] == [mutant.name for mutant in before]
    assert [mutant.line for mutant in after[:3]] == [mutant.line + 3 for mutant in before]
    assert {*draw(project, 1, 4)} == {*draw(project, 2, 4)}
    assert draw(project, 1, 4) != draw(project, 2, 4)


def test_mutants_that_are_alike_are_numbered(tmp_path: Path) -> None:
    (tmp_path / "alike.py").write_text("x = 1 + 2 + 2\nx = 1 + 2 + 2\n")
    names = [mutant.name for mutant in find_mutants(tmp_path, "alike.py")]
    assert len(set(names)) == len(names) == 10
    assert names[0] == "alike.py: constant: '1' -> '(1 + 1)' in x = 1 + 2 + 2 (no. 1)"


def test_tests_are_those_that_run_the_statement_the_shortest_first() -> None:
    seconds, lines = {"slow": 2.0, "quick": 1.0, "other": 0.1}, {"a.py": {"2": [0], "3": [1], "4": [2]}}
    mutant = Mutant("a.py", 3, (2, 3), "constant", 0, 1, "1", "2", "the one")
    assert Reach(seconds, lines, {*seconds}).tests_of(mutant) == ["quick", "slow"]
    assert Reach(seconds, lines, {*seconds}, {"the one": ["slow", "gone"]}).tests_of(mutant) == ["slow", "quick"]
    assert Reach(seconds, lines, {"slow"}).tests_of(mutant) == ["slow"]


def test_what_runs_at_import_is_run_against_the_tests_of_its_file_or_folder() -> None:
    reach = Reach({"slow": 2.0, "quick": 1.0}, {"a/b.py": {"3": [0]}, "a/c.py": {"2": [1]}}, {"slow", "quick"})
    assert reach.tests_of(Mutant("a/b.py", 1, (1, 1), "constant", 0, 1, "1", "2")) == ["slow"]
    assert reach.tests_of(Mutant("a/d.py", 1, (1, 1), "constant", 0, 1, "1", "2")) == ["quick", "slow"]


def test_a_test_that_compiles_comes_last_where_its_code_is_changed() -> None:
    """Compiled code of a changed block is not in the cache; what runs a scenario is not compiled."""
    names = ["tests/batch/test_a.py::test_in_c", "tests/batch/test_b.py::test_in_python"]
    block, runner = "model/motionsync/half.py", "fmu_src/motionsync_fmu/scenario/half.py"
    lines = {"1": [0, 1]}
    tests = {block: lines, runner: lines, "fmu_src/motionsync_fmu/batch/library.py": {"60": [0]}}
    reach = Reach(dict(zip(names, (0.1, 5.0), strict=True)), tests, {*names})
    orders = {path: reach.tests_of(Mutant(path, 1, (1, 1), "constant", 0, 1, "1", "2")) for path in (block, runner)}
    assert orders == {block: names[::-1], runner: names}
    c = "fmu_src/motionsync_fmu/batch/half.c"
    assert reach.tests_of(Mutant(c, 1, (1, 1), "constant", 0, 1, "1", "2")) == names[:1]
