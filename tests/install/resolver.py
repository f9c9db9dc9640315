"""What an installation needs on each platform and with each Python, and the table of it:

    python -m tests.install.resolver

uv resolves, since pip cannot resolve for another machine than its own: whatever --platform and --python-version say, it
evaluates environment markers and Requires-Python for the Python that runs it. uv evaluates them for the target, those
of indirect requirements included, and takes a version only if it has a wheel for the target. pip is asked where it is
right, on the machine at hand: it has to agree with what uv has installed (test_wheel.py)."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

from packaging.markers import default_environment
from packaging.utils import canonicalize_name

from tools.requirements import PROJECT, required

PYTHONS = ("3.11", "3.12", "3.13", "3.14")
PLATFORMS = {  # in the table's words: in uv's words, and sys_platform and platform_machine
    "Linux x86-64": ("x86_64-manylinux_2_28", "linux", "x86_64"),
    "Linux arm64": ("aarch64-manylinux_2_28", "linux", "aarch64"),
    "Windows x86-64": ("x86_64-pc-windows-msvc", "win32", "AMD64"),
    "macOS x86-64": ("x86_64-apple-darwin", "darwin", "x86_64"),
    "macOS arm64": ("aarch64-apple-darwin", "darwin", "arm64"),
}
EXTRAS = ("", "native", "test")


def versions(platform: str, python: str, extra: str = "", source: Path = PROJECT) -> dict[str, str]:
    """The version of each package that motionsync[extra], or another file of requirements, needs, also indirectly.

    Raises:
        RuntimeError: no set of wheels fulfils all requirements; the message is uv's reason.
    """
    command = [sys.executable, "-m", "uv", "pip", "compile", "--quiet", "--no-header", "--no-annotate"]
    command += ["--python", sys.executable, "--python-version", python, "--python-platform", PLATFORMS[platform][0]]
    command += ["--only-binary", ":all:", *(["--extra", extra] if extra else []), str(source)]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    pins = (line.split("==") for line in done.stdout.split() if "==" in line)
    return {canonicalize_name(name): version for name, version in pins}


@cache
def environment() -> dict[str, str]:
    """uv's environment: the package index that pip is set up for, else PyPI as in uv.toml, and no Python that uv would
    fetch."""
    shown = subprocess.run([sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True, check=True)
    settings = dict(line.split("=", 1) for line in shown.stdout.splitlines())
    index = next((value.strip("'") for key, value in settings.items() if key.endswith(".index-url")), "")
    own = {"UV_PYTHON_DOWNLOADS": "never", "UV_CONFIG_FILE": str(Path(__file__).with_name("uv.toml"))}
    return os.environ | own | ({"UV_DEFAULT_INDEX": index} if index else {})


def left_out(platform: str, extra: str) -> list[str]:
    """The packages that motionsync[extra] names, but not for this platform."""
    _, system, machine = PLATFORMS[platform]
    given = {name: str(value) for name, value in default_environment().items()}
    given |= {"sys_platform": system, "platform_machine": machine, "extra": ""}
    return [r.name for r in required(extra) if r.marker and not r.marker.evaluate(given)]


def main() -> None:
    print("| platform |", " | ".join(f"[{extra}]" if extra else "no extra" for extra in EXTRAS), "|")
    print("| --- |", " | ".join("---" for _ in EXTRAS), "|")
    for platform in PLATFORMS:
        cells = []
        for extra in EXTRAS:
            counts = [f"{python}: {len(versions(platform, python, extra))}" for python in PYTHONS]
            missing = left_out(platform, extra)
            cells.append(", ".join(counts) + (f"; without {', '.join(missing)}" if missing else ""))
        print(f"| {platform} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
