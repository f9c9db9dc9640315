"""`--fmi 3`, the option of several commands."""

import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from motionsync_fmu.fmus.fmu import BuildOptions, Finish, Flavour, fmu_path, start_build, why_outdated
from motionsync_fmu.interface.recipe import Fmi, Recipe
from motionsync_fmu.native.platforms import OF_VERSION, host_platform
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.validation import faults_by_fmpy
from tests.support.project.command_line import Command, assert_one_line

FMU = Path("build/fmi3/Synchronizer.fmu")


@pytest.fixture
def built(motionsync: Command, fmus: Fmus) -> Command:
    """`motionsync` in a folder with an up-to-date FMU of FMI 3.0."""
    FMU.parent.mkdir(parents=True)
    shutil.copyfile(fmus.fmi3_everywhere("Synchronizer"), FMU)
    return motionsync


def test_what_is_built_is_run_and_described(built: Command) -> None:
    outcome = built("build", "Synchronizer", "--fmi", "3")
    assert (outcome.status, outcome.out) == (0, f"{FMU}  is up to date\n")
    outcome = built("run", "Synchronizer/polynomial", "--fmi", "3")
    assert outcome.status == 0, outcome
    assert outcome.err == ""  # nothing was built
    (report,) = Path("build/reports").rglob("report.html")
    assert "Synchronizer.fmu, FMI 3.0, native flavour, GUID" in report.read_text("utf-8")
    assert "(Synchronizer/polynomial): as expected" in outcome.out
    shown = built("describe", FMU).out
    assert shown == built("describe", "Synchronizer").out


def test_it_holds_a_library_for_each_processor_and_its_licence(built: Command) -> None:
    with zipfile.ZipFile(FMU) as z:
        names = set(z.namelist())
        page = z.read("documentation/index.html").decode()
    libraries = {
        "binaries/x86_64-linux/Synchronizer.so",
        "binaries/aarch64-linux/Synchronizer.so",
        "binaries/x86_64-windows/Synchronizer.dll",
        "binaries/x86_64-darwin/Synchronizer.dylib",
        "binaries/aarch64-darwin/Synchronizer.dylib",
    }
    assert {name for name in names if name.startswith("binaries/")} == libraries
    assert {"documentation/licenses/license.txt", "terminalsAndIcons/terminalsAndIcons.xml"} <= names
    assert "terminalsAndIcons/icon.png" in names
    assert "model.png" not in names
    assert "This is the native flavour, for FMI 3.0." in page
    for platform in OF_VERSION[Fmi.THREE]:
        assert f"<tr><th>{platform.folder}</th><td>{platform.title}" in page


def test_an_fmu_of_the_other_version_is_stale(built: Command, tmp_path: Path) -> None:
    three = Recipe("Synchronizer", fmi=Fmi.THREE)
    assert fmu_path(three, Path("build"), Flavour.NATIVE) == FMU
    assert why_outdated(FMU, three) == ""
    assert why_outdated(FMU, Recipe("Synchronizer")) == "stale"


def test_a_component_is_added_for_fmi_3_only(built: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    if (platform := host_platform(Fmi.THREE)) is None:
        pytest.skip("no native FMU is for this machine")
    assert_one_line(
        built("build", "Synchronizer", "--wasm"),
        "--wasm: only an FMU of FMI 3.0 can have a WebAssembly component; add --fmi 3",
    )

    def start_quick_build(recipe: Recipe, options: BuildOptions) -> Finish:
        """For this machine alone."""
        return start_build(recipe, replace(options, platforms=[platform]))

    monkeypatch.setattr("motionsync_fmu.api.build.start_build", start_quick_build)
    assert "kB" in built("build", "Synchronizer", "--fmi", "3", "--wasm").out  # what is there has none
    component = "binaries/wasm32-wasip2/Synchronizer.wasm"
    with zipfile.ZipFile(FMU) as z:
        assert {component, "extra/org.modelica.fmi-ls-wasm/manifest.xml"} <= set(z.namelist())
        assert z.read(component).startswith(b"\0asm\x0d\0\1\0")  # a component, no core module
        assert "experimental" in z.read("documentation/index.html").decode()
    assert faults_by_fmpy(FMU) == []
    assert "is up to date" in built("build", "Synchronizer", "--fmi", "3", "--wasm").out


@pytest.mark.parametrize("command", [("build", "Synchronizer"), ("run", "Synchronizer/polynomial")])
def test_the_python_flavour_is_refused(motionsync: Command, command: tuple[str, ...]) -> None:
    assert_one_line(
        motionsync(*command, "--fmi", "3", "--flavour", "python"),
        "the python flavour is of FMI 2.0 only: for --fmi 3 take --flavour native",
    )
    assert_one_line(motionsync(*command, "--fmi", "1"), "'1' is not one of '2', '3'")
    assert not Path("build").exists()
