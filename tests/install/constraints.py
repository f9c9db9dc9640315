"""The versions of all packages with which CI tests, for every platform and Python that the project is for:

    python -m tests.install.constraints

writes them to tests/constraints.txt. A version that is in the file stays, as far as pyproject.toml allows it; with the
option `--upgrade` the newest ones are taken."""

import subprocess
import sys

from tests import ROOT
from tests.install.resolver import PYTHONS, environment
from tools.requirements import PROJECT

FILE = ROOT / "tests" / "constraints.txt"


def main() -> None:
    command = [sys.executable, "-m", "uv", "pip", "compile", "--universal", "--quiet", "--no-header", "--no-annotate"]
    command += ["--python-version", PYTHONS[0], "--extra", "test", "--output-file", str(FILE), str(PROJECT)]
    sys.exit(subprocess.run([*command, *sys.argv[1:]], env=environment(), check=False).returncode)


if __name__ == "__main__":
    main()
