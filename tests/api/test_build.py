"""`build` from Python: what it builds, what it reports, and its errors."""

from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu import BuiltFmu, UserError, build, describe


def test_an_fmu_is_built_once(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    reported: list[BuiltFmu] = []
    options: dict[str, Any] = {"flavour": "python", "unit": "deg", "start": {"rest_value": 12.25}, "output": tmp_path}
    (fmu,) = build("synchronizer", **options, finished=reported.append)
    assert reported == [fmu]
    assert fmu.path == tmp_path / "python" / "Synchronizer.fmu"
    assert (fmu.is_new, fmu.has_replaced) == (True, False)
    rest = describe(fmu.path).variables["rest_value"]
    assert (rest.start, rest.unit) == ("12.25", "deg")
    (again,) = build(["Synchronizer"], **options)
    assert (again.path, again.is_new, again.has_replaced) == (fmu.path, False, False)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"flavour": "wasm"}, "no flavour is named 'wasm'; there is native, python"),
        ({"fmi": "1"}, "no version of FMI is named '1'"),
        ({"fmu": "CutToLength", "start": {"kerf": -1}}, "kerf = -1"),
        ({"wasm": True}, "--wasm: only an FMU of FMI 3.0"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, options: dict[str, Any], message: str) -> None:
    with pytest.raises(UserError, match=message):
        build(output=tmp_path, **options)
    assert not list(tmp_path.iterdir())
