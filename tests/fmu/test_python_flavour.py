"""What PythonFMU would lose or break, held together by the python flavour: the exit of the process, damaged states,
references, paths, memory."""

import gc
import hashlib
import json
import os
import platform
import string
import subprocess
import sys
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance, unfit_characters

FOLDER = Path(__file__).parent
FATAL = 4

FAILS = """
import math, sys
from pathlib import Path
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
with FmuInstance(Path(sys.argv[1])) as host:
    try:
        host.initialize({"master.position": math.nan})
    except FmuError as e:
        print(e)
"""

FLIPS = """
import sys
from pathlib import Path
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
with FmuInstance(Path(sys.argv[1])) as host:
    host.initialize({"rest_value": 4.0}).step(0.1)
    allowed = host.unit.serializeFMUstate(host.unit.getFMUstate())
    flips = sorted({*range(0, 8 * 64, 5), *range(0, 8 * len(allowed), 7)})
    for bit in flips:
        damaged = bytearray(allowed)
        damaged[bit // 8] ^= 1 << bit % 8
        try:
            host.call(host.unit.setFMUstate, host.unit.deSerializeFMUstate(bytes(damaged)))
        except FmuError as e:
            assert "no FMU state, or a damaged one" in str(e)
        else:
            print("accepted:", bit)
    host.step(0.1)
    host.unit.setFMUstate(host.unit.deSerializeFMUstate(allowed))
    host.step(0.1)
    print(len(flips), host.get()["slave.position"])
"""


def in_a_process(code: str, fmu: Path, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code, str(fmu)], capture_output=True, text=True, check=False, **options
    )


@pytest.mark.skipif(platform.system() != "Linux", reason="needs LD_PRELOAD")
def test_nothing_is_used_after_it_was_freed_when_the_process_exits(fmu: Path, tmp_path: Path) -> None:
    """PythonFMU's library frees its state twice; whether a host aborts then depends on what lies beside it."""
    guard = tmp_path / "guard.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", guard, FOLDER / "guard.c"], check=True)
    done = in_a_process(FAILS, fmu, env={**os.environ, "LD_PRELOAD": str(guard)})
    assert done.stdout == "master.position = nan is not allowed: it must be -1e+12 to 1e+12\n"
    assert (done.returncode, done.stderr) == (0, "")


# --- states ---


def sealed(text: bytes) -> bytes:
    """The bytes of a state with this text."""
    return hashlib.sha256(text).hexdigest().encode() + text


def test_each_flipped_bit_of_a_state_is_found(fmu: Path) -> None:
    """In a process of its own, which would die of the first exception that PythonFMU sees."""
    done = in_a_process(FLIPS, fmu)
    assert (done.returncode, done.stderr) == (0, "")
    flips, position = done.stdout.split()
    assert int(flips) > 500
    assert float(position) == 0.0


@pytest.mark.parametrize("foreign", [b"", b"not a state", b"[1, 2]", b'{"build": "another"}'])
def test_bytes_that_are_no_state_are_refused(fmu: Path, foreign: bytes) -> None:
    with FmuInstance(fmu) as host:
        host.initialize()
        for text in (foreign, sealed(foreign)[:-1]):
            with pytest.raises(FmuError, match="these bytes are no FMU state, or a damaged one"):
                host.call(host.unit.setFMUstate, host.unit.deSerializeFMUstate(text))


def test_a_state_of_another_fmu_is_refused(fmu: Path) -> None:
    with FmuInstance(fmu) as host:
        host.initialize()
        text = b'{"build": "another"}'
        with pytest.raises(FmuError, match="this FMU state belongs to another FMU"):
            host.call(host.unit.setFMUstate, host.unit.deSerializeFMUstate(sealed(text)))


def test_a_state_with_forged_contents_is_refused(fmu: Path) -> None:
    """Its hash is right, but its values do not fit the block: PythonFMU would not survive the exception."""
    with FmuInstance(fmu) as host:
        host.initialize({"rest_value": 4.0})
        saved = host.unit.serializeFMUstate(host.unit.getFMUstate())
        state = json.loads(saved[64:])
        cells = state["cells"]
        assert {type(x) for x in cells} == {float, int, bool, list}
        forged: list[Any] = [
            {k: v for k, v in state.items() if k != "mode"},
            {k: v for k, v in state.items() if k != "cells"},
            *({**state, "mode": mode} for mode in (None, 3, "is gone", [], True)),
            *({**state, "cells": other} for other in (None, 7, {}, "x", cells[:-1], [*cells, 0.0])),
        ]
        for i, value in enumerate(cells):
            others = [None, "x", [value], {}, 10**30, 1.0 if isinstance(value, bool) else not value]
            others += [value[:-1], [*value, 0.0], [*value[:-1], 1]] if isinstance(value, list) else []
            forged += ({**state, "cells": [*cells[:i], other, *cells[i + 1 :]]} for other in others)
        texts = [json.dumps(contents).encode() for contents in forged]
        texts += [b"[" * 100_000, b"9" * 5000, b"[1, 2]", b"\xff\xfe"]
        for text in texts:
            with pytest.raises(FmuError, match=r"this FMU state does not fit this FMU|these bytes are no FMU state"):
                host.call(host.unit.setFMUstate, host.unit.deSerializeFMUstate(sealed(text)))
        assert host.unit.serializeFMUstate(host.unit.getFMUstate()) == saved


# --- wrong calls ---


@pytest.mark.parametrize("reference", [2**31, 2**32 - 1, 2**32 - 32, 10**6])
def test_a_reference_that_is_too_large_is_refused(fmu: Path, reference: int) -> None:
    with FmuInstance(fmu) as host:
        host.initialize()
        before = host.get()
        for call, values in ((host.unit.getReal, ()), (host.unit.setReal, ([7.0],)), (host.unit.getBoolean, ())):
            with pytest.raises(FmuError, match=f"has the value reference {reference}"):
                host.call(call, [reference], *values)
        assert host.get() == before


def test_a_step_outside_step_mode_is_refused(fmu: Path) -> None:
    with FmuInstance(fmu) as host:
        for mode, enter in (
            ("is instantiated", None),
            ("is in initialization mode", host.unit.enterInitializationMode),
            (None, host.unit.exitInitializationMode),
            ("has been terminated", host.unit.terminate),
            ("is instantiated", host.unit.reset),
        ):
            if enter:
                host.call(enter)
            if mode is None:
                host.step(0.1)
                continue
            with pytest.raises(FmuError, match=f"fmi2DoStep is not allowed now: the unit {mode}") as e:
                host.step(0.1)
            assert e.value.__cause__.status == FATAL


# --- paths ---


def test_the_characters_that_a_path_may_have(fmu: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    allowed = " _-.~" + string.ascii_letters + string.digits
    assert not unfit_characters(Path("/", allowed, allowed))
    folder = tmp_path / allowed
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    with FmuInstance(fmu) as host:
        host.initialize().step(0.1)


def test_any_other_character_in_a_path_is_refused_by_name(
    fmu: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    others = "".join(c for c in string.punctuation if c not in "_-.~/") + "äπ中"
    for c in others:
        assert unfit_characters(Path("/a", f"b{c}d")) == c
        folder = tmp_path / f"to{c}"
        folder.mkdir()
        monkeypatch.setattr("tempfile.tempdir", str(folder))
        with pytest.raises(UserError) as e:
            FmuInstance(fmu)
        assert f"does not run in {folder}" in str(e.value)
        assert f"does not read {c} in a path" in str(e.value)
        assert not list(folder.iterdir())


# --- memory ---


def test_an_instance_that_has_gone_leaves_next_to_nothing(fmu: Path) -> None:
    """PythonFMU loses 14 small objects at each instantiation: what it reads of the class and of its four bases, and the
    path. It lost 45 when each instantiation made the class anew, and searched all paths that others had added."""

    def come_and_go(times: int) -> int:
        gc.collect()
        before, own = sys.getallocatedblocks(), host.unit.component
        for _ in range(times):
            host.unit.instantiate()
            host.unit.fmi2FreeInstance(host.unit.component)
        host.unit.component = own
        gc.collect()
        return sys.getallocatedblocks() - before

    with FmuInstance(fmu) as host:
        paths = len(sys.path)
        come_and_go(10)
        assert come_and_go(100) < 100 * 20
        assert len(sys.path) == paths


BUILD_AFTER_RUN = """
import sys
from pathlib import Path
from zipfile import ZipFile
from motionsync_fmu.fmus.fmu import BuildOptions, Flavour, build
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
assert "pythonfmu" not in sys.modules
with FmuInstance(Path(sys.argv[1])) as host:
    host.initialize({})
assert "site-packages" not in sys.modules["pythonfmu"].__file__
target = build(Recipe("Synchronizer"), Path(sys.argv[2]) / "Synchronizer.fmu", BuildOptions(Flavour.PYTHON))
print(*sorted(ZipFile(target).namelist()), sep="\\n")
"""


def test_an_fmu_is_complete_that_is_built_after_another_one_has_run(fmu: Path, tmp_path: Path) -> None:
    """The process has imported the copy of PythonFMU in the FMU that has run, whose folder is gone."""
    command = [sys.executable, "-c", BUILD_AFTER_RUN, str(fmu), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with ZipFile(fmu) as z:
        assert done.stdout.split() == sorted(z.namelist())
