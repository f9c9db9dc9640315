"""What is at the top of the project, and what is kept of `build`."""

import shutil
import subprocess
from pathlib import Path

from tests import ROOT

FOLDERS = {".ci", "benchmarks", "build", "docs", "examples", "fmu_src", "model", "scenarios", "tests", "tools"}
FILES = {
    ".gitattributes",
    ".gitignore",
    ".pre-commit-config.yaml",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "LICENSE",
    "Makefile",
    "README.md",
    "SECURITY.md",
    "hatch_build.py",
    "mkdocs.yml",
    "pyproject.toml",
}
MADE = ("build/site/README.md", "build/native/Gearing.fmu", "build/explore/Gearing.html", "build/notes.md")


def test_the_top_level_has_these_files_and_folders() -> None:
    """Beside what tools make, which is ignored."""
    ignored = {line.strip("/*") for line in (ROOT / ".gitignore").read_text("utf-8").splitlines()} - {"build"}
    names = {path.name for path in ROOT.iterdir()} - ignored - {".git", "build"}
    assert names == (FOLDERS - {"build"}) | FILES
    assert (ROOT / "build" / "README.md").is_file()


def test_nothing_but_its_readme_is_kept_of_build(tmp_path: Path) -> None:
    """By git, which would add it, and by `make clean`."""
    for name in (".gitignore", "Makefile", "build/README.md"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(ROOT / name, tmp_path / name)
    for name in MADE:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    subprocess.run(["git", "init", "--quiet"], cwd=tmp_path, check=True)
    command = ["git", "ls-files", "--others", "--exclude-standard", "build"]
    shown = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert shown.split() == ["build/README.md"]
    subprocess.run(["make", "--silent", "clean"], cwd=tmp_path, check=True)
    left = {path.relative_to(tmp_path).as_posix() for path in (tmp_path / "build").rglob("*")}
    assert left == {"build/README.md"}
