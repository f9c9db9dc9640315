"""`motionsync run`: what it prints, its exit status, and its messages."""

import csv
import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu import paths
from motionsync_fmu.api import run as api
from motionsync_fmu.fmus.fmu import Flavour, fmu_path
from motionsync_fmu.pages import results
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.workshop import PYTHON, STOP, scenario
from tests.support.scenarios.verdicts import checks_of
from tests.sweeps.example_plans import EXAMPLE


def test_run_takes_a_file_a_folder_and_several(workshop: Command) -> None:
    file = scenario("more/other", STOP.replace("A stop along", "Another stop along"))
    outcome = workshop("run", file, "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.startswith(f"Another stop along a parabola ({file.parent}): as expected\n")
    for arguments in (["more", "stop/scenario.toml"], ["."]):
        outcome = workshop("run", *arguments, "--no-report")
        assert (outcome.status, outcome.err) == (0, "")
        names = re.findall(r"^ok +(\S+) ", outcome.out, re.MULTILINE)
        assert names == ["Synchronizer/other", "Synchronizer/stop"]


# The slave moves at 100 mm/s and stops between 20 and 30: a = v^2/(2 s) = 10000/20 = 500 mm/s2; a parabola's
# acceleration jumps, so its jerk is reported as 0.
PEAKS = "v 100 mm/s, a 500 mm/s2, j 0 mm/s3"


def test_a_result_is_a_line_and_a_summary_ends_with_the_address(workshop: Command) -> None:
    scenario("other")
    outcome = workshop("run", ".")
    assert (outcome.status, outcome.err) == (0, "")
    page = Path("build/reports/index.html").resolve()
    assert outcome.out.splitlines() == [
        f"ok  Synchronizer/other  {PEAKS}",
        f"ok  Synchronizer/stop   {PEAKS}",
        "",
        "2 scenarios: all as expected",
        f"report: {page.as_uri()}",
    ]
    links = re.findall(r'href="([^"]*)"', page.read_text("utf-8"))
    assert links == ["Synchronizer/other/report.html", "Synchronizer/stop/report.html"]
    assert all((page.parent / link).is_file() for link in links)


def test_the_result_of_one_scenario_has_a_line_for_each_figure(workshop: Command) -> None:
    outcome = workshop("run", "stop")
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.splitlines() == [
        "A stop along a parabola (stop): as expected",
        "  position      0 to 30 mm",
        "  velocity      100 mm/s",
        "  acceleration  500 mm/s2",
        "  jerk          0 mm/s3",
        "  peaks         at the communication points",
        "  expectations  4 of 4 met",
        f"  result        {Path('build/reports/Synchronizer/stop/Synchronizer_out.csv')}",
        f"report: {Path('build/reports/Synchronizer/stop/report.html').resolve().as_uri()}",
    ]


def test_verbose_prints_every_check(workshop: Command) -> None:
    outcome = workshop("run", "stop", "--no-report", "--verbose")
    assert outcome.status == 0
    assert outcome.out.count("  met      ") == 4
    assert "the same with FMPy alone: fmpy simulate " in outcome.out
    assert "fmpy simulate" not in workshop("run", "stop", "--no-report").out


def test_the_report_is_opened_in_the_browser(workshop: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    assert workshop("run", "stop", "--open").status == 0
    assert shown == [Path("build/reports/Synchronizer/stop/report.html").resolve().as_uri()]
    assert_one_line(workshop("run", "stop", "--open", "--no-report"), "--open", "--no-report")


def test_a_reaction_that_never_happens_is_reported(workshop: Command) -> None:
    """The slave never goes beyond 30 mm; a required reaction is checked."""
    table = '\n[[on]]\nwhen = "slave.position > 31"\nset = { rest_value = 5.0 }\n'
    scenario("late", STOP + table)
    outcome = workshop("run", "late", "stop", "--no-report")
    assert outcome.status == 0
    assert "    ! reaction to slave.position > 31 once: found never\n" in outcome.out
    assert "2 scenarios: all as expected\n! 1 result with a note: Synchronizer/late\n" in outcome.out
    scenario("late", STOP + table + "required = true\n")
    outcome = workshop("run", "late", "stop", "--no-report")
    assert outcome.status == 1
    assert "    not met  reaction to slave.position > 31 once: found never\n" in outcome.out


def test_a_scenario_without_checks_has_a_note(workshop: Command) -> None:
    scenario("free", STOP[: STOP.index("[[expect]]")])
    outcome = workshop("run", "free", "--no-report")
    assert outcome.status == 0
    assert "as expected, with 1 note\n  ! nothing is checked" in outcome.out


def test_what_the_fmu_logs_is_counted_and_shown(workshop: Command) -> None:
    """A phasing of 0 is refused when a stop reads it."""
    scenario("refused", STOP.replace("stop = true", "stop = true\noutput_phasing = 0.0").split("[[expect]]")[0])
    logged = r"^  the FMU logged at [\d.]+ s: .*output_phasing = 0"
    assert re.search(logged, workshop("run", "refused").out, re.MULTILINE)
    assert "; 1 message of the FMU\n" in workshop("run", "refused", "stop").out


@pytest.mark.parametrize(("options", "printed"), [((), "1 of 3"), (("--json",), "1 of 3")])
def test_an_interruption_keeps_what_is_finished(
    workshop: Command, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], printed: str
) -> None:
    for name in ("a", "b"):
        scenario(name)
    write = results.write_results

    def interrupted(outcome: Any, *arguments: Any, **options: Any) -> Any:
        if outcome.name == "Synchronizer/b":
            monkeypatch.setattr(results, "write_inputs", interrupted_too)
        return write(outcome, *arguments, **options)

    def interrupted_too(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(api, "write_results", interrupted)
    outcome = workshop("run", ".", *options)
    assert (outcome.status, outcome.err) == (130, f"motionsync: interrupted after {printed}\n")
    if options:
        assert [result["name"] for result in json.loads(outcome.out)] == ["Synchronizer/a"]
    else:
        assert outcome.out.startswith(f"ok  Synchronizer/a     {PEAKS}\n\n1 scenario: as expected\n")
    assert sorted(p.name for p in Path("build/reports").iterdir()) == ["Synchronizer", "index.html"]
    assert [p.name for p in Path("build/reports/Synchronizer").iterdir()] == ["a"]


def test_the_step_size_can_be_chosen(workshop: Command) -> None:
    assert workshop("run", "stop", "--no-report", "--step-size", "0.007").status == 0
    text = Path("build/reports/Synchronizer/stop/Synchronizer_out.csv").read_text()
    times = [float(line.split(",")[0]) for line in text.splitlines()[1:]]
    regular = {round(i * 0.007, 9) for i in range(72)}  # and where something is set, expected, or ends
    assert {round(t, 9) for t in times} == regular | {0.1, 0.3, 0.5}


def test_a_scenario_that_reacts_has_the_scans_of_its_file_at_another_step_size(motionsync: Command, fmus: Fmus) -> None:
    """Its report shows the reactions and what they set."""
    fmus.copied(Flavour.PYTHON, "FlyingSaw", Path("build"))
    outcome = motionsync("run", "FlyingSaw/cyclic_cut", "--step-size", 0.007, *PYTHON)
    assert outcome.status == 0
    assert "20 cuts, worst error 0 (to rounding)" in outcome.out
    page = Path("build/reports/FlyingSaw/cyclic_cut/report.html").read_text("utf-8")
    reactions = page[page.index("<summary>Reactions<") : page.index("<summary>The master<")]
    assert re.findall(r'<td class="name">(.*?)</td>.*?<td>(each time)</td>', reactions) == [
        ("in_sync", "each time"),
        ("slave.position &lt; 180", "each time"),
    ]


def test_what_cannot_run_at_a_step_size_is_left_out_with_the_reason(motionsync: Command, fmus: Fmus) -> None:
    for name in ("FlyingSaw", "Synchronizer"):
        fmus.copied(Flavour.PYTHON, name, Path("build"))
    names = ("FlyingSaw/diagonal_saw", "Synchronizer/phasing_changed_while_executing")
    left_out = ("RemoteSync/accelerating_axis", "RemoteSync/no_drift", "Synchronizer/position_only_input")
    outcome = motionsync("run", *PYTHON, *names, *left_out, "--step-size", "0.007", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert re.findall(r"^ok +(\S+) ", outcome.out, re.MULTILINE) == list(names)
    assert outcome.out.splitlines()[-3:] == [
        "2 scenarios: all as expected",
        "! 2 not run: RemoteSync works in cycles of 0.002 s, and a step of 0.007 s is longer: "
        "RemoteSync/accelerating_axis, RemoteSync/no_drift",
        "! 1 not run: POSITION_ONLY takes the velocity from the last two positions: Synchronizer/position_only_input",
    ]
    alone = motionsync("run", *PYTHON, left_out[0], "--step-size", "0.007")
    assert_one_line(alone, "--step-size 0.007", "RemoteSync works in cycles of 0.002 s")


def test_inputs_command_and_tolerances_are_those_of_the_step_that_was_run(workshop: Command) -> None:
    """An expectation without a tolerance allows one step: 0.4 s may be 0.48 s."""
    outcome = workshop("run", "stop", "--no-report", "--json", "--step-size", "0.16")
    (result,) = json.loads(outcome.out)
    assert (outcome.status, result["passed"], result["step_size"]) == (0, True, 0.16)
    assert [e["actual"] for e in result["expectations"] if e["expected"].startswith("first")] == ["0.48 s"]
    assert "--output-interval 0.16 " in result["fmpy"]
    with Path("build/reports/Synchronizer/stop/Synchronizer_in.csv").open(newline="") as f:
        times = [float(row["time"]) for row in csv.DictReader(f)]
    assert times == pytest.approx([0.0, 0.1, 0.16, 0.3, 0.32, 0.48], abs=1e-12)


def test_an_expectation_that_is_not_met_is_exit_status_1(workshop: Command) -> None:
    scenario("wrong", STOP.replace("= 27.5", "= 27.6").replace("time = 0.4\n", "time = 0.2\n"))
    outcome = workshop("run", "wrong", "stop")
    assert (outcome.status, outcome.err) == (1, "")
    assert outcome.out.splitlines()[:-1] == [
        f"NOT Synchronizer/wrong  {PEAKS}",
        "    not met  slave.position = 27.6 ± 1e-9 at 0.3 s: found 27.5",
        "    not met  first synchronized == false at 0.2 s ± 0.01: found 0.4 s",
        f"ok  Synchronizer/stop   {PEAKS}",
        "",
        "2 scenarios: 1 as expected, 1 not: Synchronizer/wrong",
    ]
    alone = workshop("run", "wrong", "-v", "--no-report")
    assert "met      slave.velocity = 50 ± 1e-9 at 0.3 s: found 50\n" in alone.out
    assert "not met  slave.position = 27.6" in workshop("run", "wrong", "--no-report").out
    assert "not met" in Path("build/reports/Synchronizer/wrong/report.html").read_text("utf-8")


def test_a_condition_that_never_holds_and_a_limit_that_is_passed_are_not_met(workshop: Command) -> None:
    changed = STOP.replace("synchronized == false", "slave.position > 31").replace("max = 100.0", "max = 99.0")
    scenario("wrong", changed)
    outcome = workshop("run", "wrong", "--json", "--no-report")
    assert outcome.status == 1
    (result,) = json.loads(outcome.out)
    assert not result["passed"]
    assert [(e["actual"], e["passed"]) for e in result["expectations"][2:]] == [
        ("never", False),
        ("0 to 100 mm/s", False),
    ]


@pytest.mark.parametrize(
    ("reference", "part"),
    [
        ('"time","slave.place"\n0.0,0.0\n0.1,0.0\n0.2,0.0\n', "slave.place"),
        ('"time","slave.position"\n0.0,zero\n', "Synchronizer_ref.csv"),
    ],
)
def test_a_reference_that_cannot_be_used_is_one_line(workshop: Command, reference: str, part: str) -> None:
    Path("stop/Synchronizer_ref.csv").write_text(reference)
    assert_one_line(workshop("run", "stop", "--no-report"), part)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("nowhere",), ("nowhere", "no such file or folder; there is Synchronizer, FlyingSaw", "motionsync list")),
        (("Synchronizer/polynomal",), ("no such file or folder", "did you mean Synchronizer/polynomial")),
        (("synchronizer",), ("no such file or folder", "did you mean Synchronizer or ")),
        (("stop", "nowhere/scenario.toml"), (str(Path("nowhere/scenario.toml")), "no such file or folder")),
        (("empty",), ("empty", "no scenario.toml")),
        (("stop", "--step-size", "abc"), ("--step-size abc", "a number of seconds")),
        (("line",), ("this is a line", "motionsync line line")),
        (("line/line.toml",), ("this is a line", f"motionsync line {Path('line/line.toml')}")),
        (("stop", "--step-size", "0"), ("--step-size 0", "> 0")),
        (("stop", "--step-size", "-0.01"), ("--step-size -0.01", "> 0")),
        (("stop", "--step-size", "0.6"), ("--step-size 0.6", "stop time")),
        (("stop", "--step-size", "nan"), ("--step-size nan", "> 0")),
        (("stop", "--step-size", "inf"), ("--step-size inf", "stop time")),
        (("broken",), (str(Path("broken/scenario.toml:5")), "not TOML")),
    ],
)
def test_a_mistake_in_run_is_one_line(workshop: Command, arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    Path("empty").mkdir()
    shutil.copytree(ROOT / "scenarios/line", "line")
    scenario("broken", STOP.replace("step_size = 0.01", "step_size = "))
    assert_one_line(workshop("run", *arguments), *parts)
    assert not Path("build/reports").exists()


def test_a_mistake_in_one_file_of_a_folder_leaves_out_that_file(workshop: Command) -> None:
    """`motionsync run .` beside a checkout finds files that are made wrong for its tests."""
    scenario("all/good")
    scenario("all/better")
    scenario("all/wrong", STOP.replace("rest_value", "rest_values"))
    outcome = workshop("run", "all", "--no-report")
    assert outcome.status == 2
    assert "2 scenarios: all as expected" in outcome.out
    assert f"1 not run: not valid, for the reason below: {Path('all/wrong')}" in outcome.out
    assert outcome.err.startswith(f"motionsync: {Path('all/wrong/scenario.toml')}:10: rest_values: ")
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize("target", ["nothing.toml", "scenario.toml", "../gone/scenario.toml"])
def test_a_scenario_that_is_a_link_to_nothing_is_not_left_out_silently(workshop: Command, target: str) -> None:
    scenario("all/good")
    scenario("all/better")
    link = Path("all/far/gone/scenario.toml")
    link.parent.mkdir(parents=True)
    link.symlink_to(target)
    outcome = workshop("run", "all", "--no-report")
    assert outcome.status == 2
    assert f"1 not run: not valid, for the reason below: {link.parent}" in outcome.out
    assert outcome.err.startswith(f"motionsync: {link}: no such file")
    assert outcome.err.count("\n") == 1


def test_a_step_size_with_absurdly_many_steps_is_one_line(workshop: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(api, "simulate", lambda *_, **__: pytest.fail("it would take hours and all memory"))
    assert_one_line(workshop("run", "stop", "--step-size", "1e-10"), "--step-size 1e-10", "steps")


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("at = 0.1\nstop = true", "at = 0.1\nrest_value = nan", ("at 0.1 s", "rest_value = nan")),
        ("velocity = 100.0", "velocity = 1e13", ("at 0 s", "master.velocity = 1e+13")),
    ],
)
def test_what_the_fmu_refuses_is_one_line(workshop: Command, old: str, new: str, parts: tuple[str, ...]) -> None:
    file = scenario("refused", STOP.replace(old, new))
    assert_one_line(workshop("run", "refused", "--no-report"), str(file), *parts)


def test_titles_and_paths_are_shown_as_they_are(workshop: Command) -> None:
    """What looks like markup is none."""
    scenario("odd[b]", STOP.replace("A stop along", "[red] [/] [/x] \\\\[bold]"))
    outcome = workshop("run", "odd[b]", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.startswith("[red] [/] [/x] \\[bold] a parabola (odd[b]): as expected\n")
    listed = workshop("list", "--scenarios", "odd[b]")
    assert listed.status == 0
    assert "[red] [/] [/x]" in listed.out


def test_a_scenario_run_from_its_own_folder_has_its_folders_name(
    workshop: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.move("build", "stop/build")
    monkeypatch.chdir("stop")
    for path in (".", "scenario.toml"):
        assert workshop("run", path, "--output", f"by {path}").status == 0
        assert Path(f"by {path}/Synchronizer/stop/report.html").is_file()


def test_scenarios_of_the_same_name_keep_their_own_results(workshop: Command) -> None:
    for folder in ("a/stop", "b/stop"):
        scenario(folder)
    outcome = workshop("run", "a", "b", "--no-report", "--json")
    if outcome.status == 2:  # to refuse it is as good
        assert_one_line(outcome, "stop")
    else:
        assert len({result["result"] for result in json.loads(outcome.out)}) == 2


def test_a_run_is_evaluated_as_the_sweep_evaluates_it(motionsync: Command, fmus: Fmus) -> None:
    """Through the FMU, without the reference, which is one of the file's own values; the folder is one of its own."""
    plan = SweepPlan.of(EXAMPLE, ["master.velocity=390..410"], samples=3)
    value = plan.values(1, 2)["master.velocity"].tolist()[0]
    scenario = plan.scenario(1)
    expected = checks_of(scenario, run_in_process(scenario, scenario.step_size))
    fmu = fmu_path(scenario.recipe, paths.OUTPUT, Flavour.PYTHON)
    fmu.parent.mkdir(parents=True)
    shutil.copy(fmus.python("CutToLength"), fmu)
    outcome = motionsync("run", EXAMPLE, "--set", f"master.velocity={value!r}", "--flavour", "python", "--json")
    (result,) = json.loads(outcome.out)
    assert outcome.status == 1
    assert result["overrides"] == {"master.velocity": repr(value)}
    assert [c["actual"] for c in result["expectations"]] == [c.actual for c in expected]
    assert result["reference"] == []
    report = Path(result["report"])
    assert report.parent.name.startswith("cut_to_length-")
    assert f"<code>master.velocity</code> = {value!r}" in report.read_text("utf-8")
    assert (report.parent / "CutToLength_in.csv").is_file()


@pytest.mark.parametrize(
    ("setting", "parts"),
    [
        ("master.velocty=500", ("--set", "'master.velocty'", "master.velocity")),
        ("master.velocity", ("--set", "NAME=VALUE")),
        (
            "master.velocity=fast",
            (
                "--set",
                "master.velocity=fast",
                "'fast' is not allowed: it must be a number in mm/s, or with a unit of its own",
            ),
        ),
        ("master.velocity=100:200:3", ("--set", "one value", "motionsync sweep")),
        ("master.velocity=nan", ("--set", "finite")),
        ("axis.max_acceleration=-1", ("--set", "axis.max_acceleration", "-1")),
    ],
)
def test_a_value_that_is_none_is_reported(motionsync: Command, setting: str, parts: tuple[str, ...]) -> None:
    assert_one_line(motionsync("run", "CutToLength/basic_cut", "--set", setting, "--flavour", "python"), *parts)
