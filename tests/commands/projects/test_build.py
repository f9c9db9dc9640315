"""`motionsync build`: its files, options and messages, and the sequence of several builds."""

import zipfile
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu import paths
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import BuildOptions, Finish, Flavour
from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.interface.recipe import Recipe
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import FLAVOURS, PYTHON, STOP, description, scenario, start_value, the_fmu

NATIVE = ("--flavour", "native", "--output", "made")


@pytest.mark.all_blocks
def test_build_without_a_name_builds_every_block(motionsync: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is built of each is another test's; the next one builds both flavours, of one block."""

    def start_build(recipe: Recipe, options: BuildOptions) -> Finish:
        def finish(target: Path, progress: object) -> Path:
            target.write_text(f"{recipe.name}, {options.flavour}")
            return target

        return finish

    monkeypatch.setattr("motionsync_fmu.api.build.start_build", start_build)
    outcome = motionsync("build", "--output", "here", *PYTHON)
    assert outcome.status == 0
    made = {f.name: f.read_text() for f in Path("here/python").iterdir()}
    assert made == {f"{name}.fmu": f"{name}, python" for name in BLOCKS}
    targets = [str(Path(f"here/python/{name}.fmu")) for name in BLOCKS]
    assert [line.split("  ")[0] for line in outcome.out.splitlines()] == targets
    assert [line.rstrip(".") for line in outcome.err.splitlines()] == [f"building {target} " for target in targets]


def test_build_by_name_lands_in_the_folder_build(motionsync: Command) -> None:
    assert motionsync("build", "Synchronizer").status == 0
    assert sorted(map(str, Path("build").rglob("*.fmu"))) == [
        str(Path(f"build/{flavour}/Synchronizer.fmu")) for flavour in FLAVOURS
    ]


def test_baked_start_values_are_in_the_description(motionsync: Command) -> None:
    """What they do in a run shows in importers (tests/fmu/test_importers.py)."""
    starts = {"curve": "PARABOLA", "output_phasing": "-7.5", "rest_value": "-20", "active": "TRUE", "stop": "0"}
    options = [part for name, value in starts.items() for part in ("--start", f"{name}={value}")]
    assert motionsync("build", "Synchronizer", *PYTHON, *options, "--output", "here").status == 0
    fmu = the_fmu("here")
    values = {name: start_value(fmu, name) for name in starts}
    assert values == {
        "curve": "1",
        "output_phasing": "-7.5",
        "rest_value": "-20.0",
        "active": "true",
        "stop": "false",
    }


def test_names_of_blocks_flavours_units_and_members_may_have_any_case(motionsync: Command) -> None:
    start = ("--start", "curve=parabola", "--unit", "DEG", "--flavour", "PYTHON", "--output", "here")
    assert motionsync("build", "synchronizer", *start).status == 0
    fmu = Path("here/python/Synchronizer.fmu")
    assert start_value(fmu, "curve") == "1"
    assert "deg" in motionsync("describe", fmu).out.split()
    assert motionsync("describe", "FLYINGSAW", "--unit", "M").out.startswith("FlyingSaw: ")
    assert "FlyingSaw/cyclic_cut" in motionsync("list", "flyingsaw").out


def test_a_start_value_may_have_a_unit_of_its_own(motionsync: Command) -> None:
    """A quarter of a turn is 90 deg, which the slave of this Follower is in; its master is in m."""
    units = ("--unit", "m", "--slave-unit", "deg", "--start", "park_slave=0.25 rev", "--start", "master_cycle=150 cm")
    assert motionsync("build", "Follower", *PYTHON, *units, "--output", "here").status == 0
    fmu = the_fmu("here")
    assert (start_value(fmu, "park_slave"), start_value(fmu, "master_cycle")) == ("90.0", "1.5")


def test_unit_and_start_values_change_the_guid(motionsync: Command) -> None:
    options = [
        (),
        ("--unit", "deg"),
        ("--start", "rest_value=5"),
        ("--start", "rest_value=6"),
        ("--start", "curve=PARABOLA"),
    ]
    guids = []
    for i, option in enumerate(options):
        assert motionsync("build", "Synchronizer", *PYTHON, *option, "--output", str(i)).status == 0
        guids.append(description(the_fmu(str(i))).get("guid"))
    assert len(set(guids)) == len(options)


def test_an_enumeration_by_number_is_the_same_build_as_by_name(motionsync: Command) -> None:
    for folder, value in (("name", "PARABOLA"), ("number", "1")):
        assert motionsync("build", "Synchronizer", *PYTHON, "--start", f"curve={value}", "--output", folder).status == 0
    assert the_fmu("name").read_bytes() == the_fmu("number").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("Nope",), ("'Nope'", "Synchronizer")),
        (("Synchroniser",), ("'Synchroniser'", "did you mean Synchronizer")),
        (("Synchronizer", "--flavour", "nativ"), ("'nativ' is not one of 'native', 'python'",)),
        (("Synchronizer", "Nope"), ("'Nope'",)),
        (("Synchronizer", "--unit", "km"), ("km", "mm", "deg")),
        (("Synchronizer", "--start", "rest_value"), ("rest_value", "NAME=VALUE")),
        (("Synchronizer", "--start", "rest_valu=3"), ("'rest_valu'", "rest_value")),
        (("Synchronizer", "--start", "=3"), ("''", "parameter or input")),
        (("Synchronizer", "--start", "slave.position=3"), ("slave.position", "parameter or input")),
        (
            ("Synchronizer", "--start", "rest_value=abc"),
            ("rest_value=abc: 'abc' is not allowed: it must be a number in mm, or with a unit of its own",),
        ),
        (("Synchronizer", "--start", "rest_value="), ("rest_value=: '' is not allowed", "a number in mm")),
        (("Synchronizer", "--start", "rest_value=5 rad"), ("rest_value=5 rad: '5 rad' is in rad: it must be in mm",)),
        (("Synchronizer", "--start", "rest_value=5 kg"), ("rest_value=5 kg: 'kg' is no unit", "m/min")),
        (("Synchronizer", "--start", "rest_value=nan"), ("rest_value = nan", "-1e+12 to 1e+12")),
        (("Synchronizer", "--start", "rest_value=1e13"), ("rest_value = 1e+13", "-1e+12 to 1e+12")),
        (("Synchronizer", "--start", "output_phasing=0"), ("output_phasing = 0", "1e-09 to 1e+12")),
        (("Synchronizer", "--start", "master.period=-1"), ("master.period = -1", "0, or >= 1e-09")),
        (("Synchronizer", "--start", "active=yes"), ("active=yes: 'yes' is not allowed", "true or false")),
        (("Synchronizer", "--start", "curve=CUBIC"), ("curve=CUBIC", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "curve=3"), ("curve = 3", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "curve=1.5"), ("curve=1.5: '1.5'", "PARABOLA", "POLYNOMIAL_3_4_5")),
        (("Synchronizer", "--start", "active=1", "--start", "active=0"), ("--start active", "twice", "1", "0")),
        (
            ("Synchronizer", "--as-input", "output_fasing"),
            ("--as-input: no variable", "'output_fasing'", "output_phasing"),
        ),
        (("Synchronizer", "--as-input", "curve"), ("--as-input: curve cannot become an input", "fixed")),
        (("Synchronizer", "--as-parameter", "st*"), ("--as-parameter: start cannot become a parameter", "command")),
        (("Synchronizer", "--as-local", "slave.*"), ("--as-local: slave.position cannot become a local variable",)),
        (
            ("Synchronizer", "--as-output", "elsewhere"),
            ("--as-output: no variable of Synchronizer is named 'elsewhere'",),
        ),
        (
            ("Synchronizer", "--as-parameter", "rest_value", "--as-input", "rest_*"),
            ("--as-parameter: rest_value already becomes an input",),
        ),
        (("--as-local", "ready"), ("--as-local", "one block")),
        (("Synchronizer", "Synchronizer", "--start", "rest_value=3"), ("--start", "one block")),
    ],
)
def test_a_mistake_in_build_is_one_line_and_builds_nothing(
    motionsync: Command, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    assert_one_line(motionsync("build", *arguments), *parts)
    assert not Path("build").exists()


def test_an_fmu_that_is_up_to_date_is_built_again_by_force_only(motionsync: Command) -> None:
    build = ("build", "Synchronizer", *PYTHON)
    assert motionsync(*build).status == 0
    fmu = the_fmu("build")
    first, content = fmu.stat().st_mtime_ns, fmu.read_bytes()
    again = motionsync(*build)
    assert (again.status, again.out) == (0, f"{fmu}  is up to date\n")
    assert fmu.stat().st_mtime_ns == first
    assert "kB" in motionsync(*build, "--force").out
    assert fmu.stat().st_mtime_ns != first
    assert fmu.read_bytes() == content
    assert "kB" in motionsync(*build, "--unit", "deg").out
    assert "kB" in motionsync(*build).out


def test_variables_with_another_causality_have_an_fmu_of_their_own(motionsync: Command) -> None:
    overrides = (
        "--as-input",
        "output_*",
        "--as-parameter",
        "active",
        "--as-parameter",
        "rest_value",
        "--as-local",
        "ready",
    )
    assert motionsync("build", "Synchronizer", *PYTHON).status == 0
    default = the_fmu("build").read_bytes()
    outcome = motionsync("build", "Synchronizer", *PYTHON, *overrides, "--as-output", "local.*")
    assert outcome.status == 0
    fmu = Path(outcome.out.split("  ")[0])
    assert Path("build/python/Synchronizer.fmu").read_bytes() == default
    causalities = {
        v.get("name"): f"{v.get('variability')} {v.get('causality')}"
        for v in description(fmu).iterfind("ModelVariables/ScalarVariable")
    }
    assert causalities["output_phasing"] == "discrete input"
    assert causalities["active"] == causalities["rest_value"] == "tunable parameter"
    assert causalities["ready"] == "discrete local"
    assert causalities["local.progress"] == "continuous output"
    assert causalities["curve"] == "fixed parameter"
    shown = motionsync("describe", fmu).out
    for text in ("output_phasing  input, Real", "active  tunable parameter, Boolean", "local.progress  output, Real"):
        assert f"\n  {text}" in shown
    assert "POLYNOMIAL_3_4_5" in shown


def test_a_scenario_with_an_interface_leaves_the_default_fmu_alone(motionsync: Command, cache: Path) -> None:
    """STOP sets stop alone; the other variables keep their start values, so its expectations hold."""
    interface = '[interface]\ninput = "output_phasing"\nparameter = ["active", "rest_value"]\n\n[start]'
    scenario("wired", STOP.replace("[start]", interface, 1))
    scenario("stop")
    assert motionsync("build", "Synchronizer", *PYTHON).status == 0
    default = the_fmu("build").stat().st_mtime_ns
    for folder, built in (("wired", True), ("stop", False), ("wired", False)):
        outcome = motionsync("run", folder, *PYTHON, "--no-report")
        assert outcome.status == 0, outcome
        assert ("building" in outcome.err) == built
    assert the_fmu(str(cache)).name.startswith("Synchronizer-")
    assert the_fmu("build").stat().st_mtime_ns == default


@pytest.mark.parametrize("epoch", ["yesterday", "1.5", "99999999999", "99999999999999999999"])
def test_a_bad_source_date_epoch_is_one_line(motionsync: Command, monkeypatch: pytest.MonkeyPatch, epoch: str) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    assert_one_line(motionsync("build", "Synchronizer", *PYTHON), "SOURCE_DATE_EPOCH", epoch)


def test_an_output_folder_that_cannot_be_made_is_one_line(workshop: Command) -> None:
    Path("taken").write_text("a file")
    assert_one_line(workshop("build", "Synchronizer", "--output", "taken"), "taken")
    assert_one_line(workshop("run", "stop", "--no-report", "--output", "taken"), "taken")


@pytest.fixture
def events(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What happens, in sequence; the Gearing is refused. Nothing is compiled."""
    events: list[str] = []

    def start_build(recipe: Recipe, options: BuildOptions) -> Finish:
        events.append(f"start {recipe.name}")
        if recipe.name == "Gearing":
            raise UserError("outside the kernel subset")

        def finish(target: Path, progress: object) -> Path:
            events.append(f"finish {recipe.name}")
            target.write_bytes(b"")
            return target

        return finish

    monkeypatch.setattr("motionsync_fmu.api.build.start_build", start_build)
    return events


def test_zig_has_the_next_fmu_while_one_is_finished(motionsync: Command, events: list[str]) -> None:
    outcome = motionsync("build", "Synchronizer", "FlyingSaw", "Follower", *NATIVE)
    assert outcome.status == 0, outcome.err
    expected = (
        "start Synchronizer, start FlyingSaw, finish Synchronizer, start Follower, finish FlyingSaw, finish Follower"
    )
    assert events == expected.split(", ")
    assert [Path(line.split()[0]).stem for line in outcome.out.splitlines()] == [
        "Synchronizer",
        "FlyingSaw",
        "Follower",
    ]


def test_a_refused_block_does_not_stop_the_one_before(motionsync: Command, events: list[str]) -> None:
    outcome = motionsync("build", "Synchronizer", "Gearing", "Follower", *NATIVE)
    assert outcome.status == 2
    assert "outside the kernel subset" in outcome.err
    assert events == ["start Synchronizer", "start Gearing", "finish Synchronizer", "start Gearing"]
    assert [Path(line.split()[0]).stem for line in outcome.out.splitlines()] == ["Synchronizer"]


def test_the_command_builds_anew_what_lacks_the_sources_or_should(
    motionsync: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What is built is another test's."""
    built = []

    def start_build(recipe: Recipe, options: BuildOptions) -> Finish:
        built.append((options.flavour, options.with_sources))
        files = {"modelDescription.xml": f'<fmiModelDescription guid="{compute_guid(recipe)}"/>'.encode()}

        def finish(target: Path, progress: object) -> Path:
            write_zip(target, files | ({"sources/instance.c": b""} if options.with_sources else {}))
            return target

        return finish

    monkeypatch.setattr("motionsync_fmu.api.build.start_build", start_build)
    monkeypatch.setattr(paths, "OUTPUT", tmp_path)
    for further in ([], [], ["--sources"], ["--sources"], []):
        outcome = motionsync("build", "Synchronizer", *NATIVE, *further)
        assert outcome.status == 0, outcome.err
    assert built == [(Flavour.NATIVE, False), (Flavour.NATIVE, True), (Flavour.NATIVE, False)]
    outcome = motionsync("build", "Synchronizer", *NATIVE, "--start", "rest_value=5")
    note = "kB, positions in mm, start values: rest_value = 5; it replaces the FMU that was there\n"
    assert outcome.out.endswith(note)
    outcome = motionsync("build", "Synchronizer", "--sources", "--flavour", "python", "--output", "made")
    assert (outcome.status, outcome.out) == (2, "")
    assert "--sources: the python flavour has no C" in outcome.err


TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"


def test_an_fmu_of_fmi_2_has_terminals_where_they_are_asked_for(motionsync: Command, tmp_path: Path) -> None:
    """The python flavour needs no compiler; both flavours get their documents from one function."""
    built = tmp_path / "python" / "Gearing.fmu"
    command = ("build", "Gearing", "--flavour", "python", "--output", str(tmp_path))
    for options, expected in (((), False), (("--terminals",), True), (("--terminals",), True), ((), False)):
        before = built.read_bytes() if built.exists() else b""
        outcome = motionsync(*command, *options)
        assert outcome.status == 0, outcome.err
        with zipfile.ZipFile(built) as z:
            assert (TERMINALS in z.namelist()) == expected
            if expected:
                assert b'name="slave"' in z.read(TERMINALS)
        assert ("is up to date" in outcome.out) == (built.read_bytes() == before)
