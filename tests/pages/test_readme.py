"""The READMEs stay true: what they show to type does what they say, and what they name exists."""

import math
import re
import shlex
import subprocess
import sys
from dataclasses import fields
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.machine_limits import Machine, approach_distance, cycle_time, return_time, stroke
from motionsync.rotary_knife.block import RotaryKnife
from motionsync_fmu import Stepper
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.interface.causality import Interface
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import cells, members
from motionsync_fmu.pages.readme import read_readme
from motionsync_fmu.pages.results import write_results
from motionsync_fmu.pages.state_diagram import read_diagram
from motionsync_fmu.plan.saw import max_line_velocity
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import simulate
from tests import ROOT
from tests.support.hosts.fmus import Fmus

README = (ROOT / "README.md").read_text("utf-8")
HOW_TO = ROOT / "docs" / "how_to"
PLC, FMPY, PYTHON = ((HOW_TO / f"{name}.md").read_text("utf-8") for name in ("plc", "fmpy", "python"))
SOURCES = {"mv_follow2"}  # a source that is written like a variable
SECTIONS = ("How to use it", "Names in the source system", "Decisions where the source is silent", "States")


def code_with(page: str, text: str) -> str:
    """The one Python example of a page that holds a text."""
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", page, re.S) if text in code]
    return str(code)


def replaced(code: str, old: str, new: str) -> str:
    """The example with another text in one place."""
    assert code.count(old) == 1, old
    return code.replace(old, new)


def row(text: str, head: str) -> list[float]:
    """The cells of a row of a table that start with a number: that number."""
    (row,) = re.findall(rf"^ *\| {re.escape(head)} \|(.*)\|$", text, re.M)
    return [float(cell.split()[0]) for cell in row.split("|") if re.match(r"\s*\d", cell)]


def printed(line: str, word: str) -> tuple[float, float]:
    """The greatest value and its limit, from `word 683 of 1200 mm/s`."""
    ((value, limit),) = re.findall(rf"{word} (\d+) of (\d+) ", line)
    return float(value), float(limit)


def executed(code: str, capsys: pytest.CaptureFixture[str]) -> tuple[dict[str, Any], str]:
    """The names that an example leaves, and what it prints."""
    names: dict[str, Any] = {}
    exec(code, names)
    return names, capsys.readouterr().out


@pytest.mark.parametrize(("length", "line"), [(800.0, 500.0), (1000.0, 250.0), (800.0, 600.0), (300.0, 500.0)])
def test_the_fifteen_lines_are_right_about_other_lengths_and_speeds(
    fmus: Fmus,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    length: float,
    line: float,
) -> None:
    """In any folder into which the FMU was built. The kerf is 4 mm: with start at 0.011 s the n-th cut is due where
    the material has come 0.011 v - 2 + n (L + 4), and it has been made D + 0.25 v later, where D is the approach's way:
    sqrt(1.5 V3/j), V being greater than v by the reserve of 2 %. Pieces of 300 mm need a line of 377 mm/s at most: each
    time the saw has come home, 0.4547 s after a cut, the next one is left out."""
    fmus.copied(Flavour.NATIVE, "CutToLength", tmp_path / "build")
    monkeypatch.chdir(tmp_path)
    code = replaced(code_with(README, "simulate_fmu"), "= 800.0, 500.0 ", f"= {length}, {line} ")
    names, out = executed(code, capsys)
    run, pitch = names["run"], length + 4.0
    made = math.sqrt(1.5 * (1.02 * line) ** 3 / 1e5) + 0.25 * line  # mm of the line behind the cut's place
    passed = (10.0 * line - (0.011 * line - 2.0) - made) / pitch
    if length == 300.0:
        home = passed - 0.4547 * line / pitch
        assert f"{math.floor((passed + 1.0) / 2.0)} cuts, {math.floor((home + 1.0) / 2.0)} left out" in out
        assert "is 604.000000 mm long" in out
    else:
        assert f"{math.floor(passed)} cuts, 0 left out, the last piece is {length:.6f} mm long" in out
    ((way, fastest),) = re.findall(r"goes to (\d+) mm; the line may run at (\d+) mm/s", out)
    assert float(way) == round(float(run["slave.position"].max())) < 650.0
    assert (float(fastest) > line) == (length > 300.0)
    if (length, line) == (800.0, 500.0):
        printed = re.findall(r"`(\d+ cuts, .*?|the carriage goes .*?)`", README)
        assert len(printed) == 2
        for text in printed:
            assert text in out


@pytest.mark.parametrize(("length", "line"), [(1500.0, 1000.0), (400.0, 500.0), (3000.0, 1200.0), (1000.0, 1300.0)])
def test_the_plc_loop_is_right_about_other_lengths_and_speeds(
    fmus: Fmus, capsys: pytest.CaptureFixture[str], length: float, line: float
) -> None:
    """A cut is counted 0.2 s after its mark met the saw, `meet` beyond it; the first order can be met by mark 1. At
    1300 mm/s the saw comes home too late for the second mark of 1000 mm."""
    code = replaced(code_with(PLC, "gear_in_pos"), "length, line = 1500.0, 1000.0", f"length, line = {length}, {line}")
    code = replaced(code, "build/native/FlyingSaw.fmu", str(fmus.native("FlyingSaw")))
    names, out = executed(code, capsys)
    assert max(map(abs, names["cuts"])) < 1e-9
    for what in ("velocity", "acceleration"):
        value, limit = printed(out, what)
        assert 0.0 < value <= limit == names[f"max_{what}"]
    if line == 1300.0:
        assert "a command was refused 17118" in out
        assert "1 cuts, worst error" in out
    else:
        assert "stopped" not in out
        assert f"{math.floor((line * 14.8 - names['meet']) / length)} cuts, worst error" in out


def test_the_line_that_follows_the_request_misses_no_cut(fmus: Fmus, capsys: pytest.CaptureFixture[str]) -> None:
    """The example starts like the one of the FlyingSaw. All 17 pieces are made, and each is good; what is printed
    is below it. Pieces of 600 mm are cut at 98 % of what the machine can do then, those of 2500 mm at the velocity
    that is wanted, which the line comes near to."""
    head, _, _ = code_with(PLC, "gear_in_pos").partition("saw.instantiate()")
    code = head.replace("build/native/FlyingSaw.fmu", str(fmus.native("CutToLength")))
    names, out = executed(code + code_with(PLC, "line.velocity_request"), capsys)
    assert "17 good pieces, 0 cuts left out" in out
    assert names["slowest"] == pytest.approx(0.98 * max_line_velocity(Machine(max_position=900.0), 604.0), rel=1e-6)
    assert names["fastest"] == pytest.approx(1500.0, abs=0.5)
    assert 0.98 * max_line_velocity(Machine(max_position=900.0), 2504.0) > 1500.0
    velocities = re.findall(r"at (\d+) to (\d+) mm/s", PLC)
    assert velocities == [(f"{names['slowest']:.0f}", f"{names['fastest']:.0f}")]


def test_the_first_lines_from_python_run_as_they_are_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the start at 0.1 s on, a line of 400 mm/s brings 9560 mm in 24 s: seven pieces of 1200 mm. At
    1000 mm/s pieces of 600 and 800 mm are too short for this saw."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code_with(PYTHON, "result.to_frame()"), names)
    result, rows = names["result"], names["rows"].to_frame()
    assert [piece.length for piece in result.pieces] == pytest.approx([1200.0] * 7, abs=1e-6)
    assert result.passed
    assert result.time.shape == result["slave.position"].shape == (result.to_frame().num_rows,)
    assert Path("report.html").stat().st_size > 100_000
    assert rows.column("length").to_pylist() == [600.0, 800.0, 1000.0]
    assert rows.column("passed").to_pylist() == [False, False, True]


def test_a_run_of_a_saw_that_is_made_in_python() -> None:
    """The n-th cut is due where the line has come 5 - 2 + 804 n mm, and is made some 166 mm later, as for the fifteen
    lines: the sixth at 4993 of 5000 mm."""
    names: dict[str, Any] = {}
    exec(code_with(PYTHON, "run(saw)"), names)
    assert names["result"].passed
    assert names["lengths"] == pytest.approx([800.0] * 6, abs=1e-6)


def test_the_batch_example_gives_what_its_comments_say() -> None:
    code = code_with(PYTHON, "outputs=(")
    names: dict[str, Any] = {}
    exec(code, names)
    result = names["result"]
    assert result.values.shape == (1000, 5000, 2)
    assert not result.failures
    peaks = -result["slave.acceleration"].min(axis=1)  # of a stop: v^2 / (2 phasing) times 1.642
    assert peaks[-1] == pytest.approx(1.64224 * 90.0**2 / (2.0 * 90.0), rel=1e-4)
    exec(code_with(PYTHON, "reduce="), names)
    measures = names["result"].measures
    assert (-measures["slave.acceleration.min"]).tolist() == peaks.tolist()
    assert measures["slave.position.every:100"].tobytes() == result["slave.position"][:, 99::100].tobytes()


def test_the_batch_example_with_a_file_fills_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(code_with(PYTHON, "np.memmap"), {})
    values = np.fromfile("positions").reshape(1000, 5000)
    assert values[-1, 1000] == pytest.approx(90.0)


def test_the_line_for_fmpy_runs(native: Path, tmp_path: Path) -> None:
    (name,) = re.findall(r"`motionsync run (.*)`", FMPY)
    scenario = load_scenario(ROOT / "scenarios" / name / "scenario.toml")
    recording = simulate(scenario, native, scenario.step_size)
    folder = tmp_path / "build" / "reports" / name
    write_results(evaluate_run(scenario, recording), scenario, recording, native, folder, report=False)
    (line,) = re.findall(r"fmpy simulate (?:.*\\\n)+.*", FMPY)
    words = shlex.split(line.replace("\\\n", " "))
    words[words.index("build/native/Synchronizer.fmu")] = str(native)
    words[0] = str(Path(sys.executable).with_name("fmpy"))
    subprocess.run(words, cwd=tmp_path, check=True)
    rows = (tmp_path / "Synchronizer_out.csv").read_text().splitlines()
    assert len(rows) == 802
    assert "each of the 801 communication points" in FMPY


def test_its_commands_exist() -> None:
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.M))
    assert set(re.findall(r"make (run|test|docs|line|benchmark|pictures|quick|check|help)\b", README)) <= targets
    for file in re.findall(r"(?:scenarios|build)/[\w/]+\.csv", README):
        assert (ROOT / file).exists(), file


def test_links_lead_to_files_that_exist() -> None:
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    files = [*pages, *(ROOT / "scenarios").rglob("README.md"), *(ROOT / "model").rglob("README.md")]
    for file in files:
        for link in re.findall(r"\]\((?!http|#)([^)#]+)[^)]*\)", file.read_text("utf-8")):
            assert (file.parent / link).exists(), f"{file}: {link}"


def test_the_files_that_the_pages_for_developers_name_exist() -> None:
    """Somewhere in the project with that end of their path; but those of the block that CONTRIBUTING makes, and what is
    made when something is built or run."""
    made = {"block.c", "block.h", "model.h", "plan.toml", "build/release/"}
    folders = ("benchmarks", "docs", "examples", "fmu_src", "model", "scenarios", "tests", "tools")
    paths = [f"/{p.relative_to(ROOT).as_posix()}" for folder in folders for p in (ROOT / folder).rglob("*")]
    for page in ("CONTRIBUTING.md", "docs/explanation/architecture.md", "docs/explanation/proof.md"):
        text = (ROOT / page).read_text("utf-8")
        for name in set(re.findall(r"`([\w./-]+(?:\.(?:py|c|h|js|toml|md|csv|zip)|/))`", text)) - made:
            exists = any(path.endswith(f"/{name.rstrip('/')}") for path in paths) or (ROOT / name).exists()
            assert exists or "clamper" in name.lower(), f"{page}: {name}"


def test_the_builds_that_the_pages_show_are_possible() -> None:
    """Their patterns name variables that may have this causality; baked start values are tested elsewhere."""
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "model").rglob("README.md")]
    seen = 0
    text = "\n".join(page.read_text("utf-8") for page in pages)
    inline, blocks = r"`motionsync build ([^`]+)`", r"^    motionsync build (.*(?:(?<=\\)\n.*)*)$"
    for command in re.findall(inline, text) + re.findall(blocks, text, re.M):
        name, *words = shlex.split(command.replace("\\\n", " "), comments=True)
        words = [word for word in words if word != "--sources"]  # the one option without a value
        overrides: dict[str, list[str]] = {}
        for option, value in zip(words[::2], words[1::2], strict=True):
            overrides.setdefault(option.removeprefix("--as-"), []).append(value)
        if overrides and overrides.keys() <= {"input", "output", "parameter", "local"}:
            seen += len(Recipe(name, interface=Interface(**overrides)).causality_overrides)
    assert seen > 10


# --- of the CutToLength ---


def test_the_wiring_lists_all_variables() -> None:
    """Its table has each input and each output of the default interface once, and states how many there are."""
    text = read_readme(CutToLength)
    _, _, part = text.partition("\n## What is wired\n")
    rows = re.findall(r"^\|.*\|(.*)\|(.*)\|$", part.partition("\n- ")[0], re.M)[2:]
    for column, causality in zip(zip(*rows, strict=True), ("input", "output"), strict=True):
        names = re.findall(r"`(.+?)`", " ".join(column))
        wired = [name for name, v in Recipe("CutToLength").variables.items() if v.causality == causality]
        assert sorted(names) == sorted(wired)
        assert f"{len(names)} {causality}s" in text


def test_how_far_its_start_values_carry() -> None:
    text, machine = read_readme(CutToLength), Machine()
    lengths, highest, ways = (row(text, head) for head in ("pieces of", "highest line velocity", "way of the carriage"))
    assert len(lengths) > 5
    velocities = [max_line_velocity(machine, length) for length in lengths]
    assert highest == [round(v) for v in velocities]
    assert ways == [round(stroke(machine, v)) for v in velocities]


def test_the_parts_of_its_cycle() -> None:
    """Of the start values, at 500 and at 1000 mm/s; a cut takes 0.25 s: the way from home is D + 0.25 V."""
    text, machine = read_readme(CutToLength), Machine()
    for i, v in enumerate((500.0, 1000.0)):
        distance, cycle = approach_distance(machine, v), cycle_time(machine, v)
        away = distance + 0.25 * v
        for head, value, digits in (
            ("way to the sync position D", distance, 1),
            ("approach", 2.0 * distance / v, 3),
            ("settling, cut, gap, blade out", 0.25, 3),
            ("way from home S", away, 1),
            ("way home", return_time(machine, v, away, 1e4), 3),
            ("cycle T", cycle, 3),
            ("shortest pitch", v * cycle, 1),
            ("stroke", stroke(machine, v), 1),
        ):
            assert row(text, head)[-2:][i] == round(value, digits), head


def test_what_its_limits_cost() -> None:
    """The highest line velocity for pitches, the last of them by the stroke; what halves of limits and times change,
    from the least to the greatest share, for pitches of 500 to 1500."""
    text = re.sub(r"\s+", " ", read_readme(CutToLength))
    velocities = re.findall(
        r"it is (\S+) mm/s for a pitch of 500, (\S+) for 1000, (\S+) for 1500, and (\S+), for the stroke", text
    )
    bounded = Machine(max_position=650.0)
    assert velocities == [
        tuple(f"{max_line_velocity(bounded, pitch):.1f}" for pitch in (500.0, 1000.0, 1500.0, 2000.0))
    ]
    names = [f.name for f in fields(Machine)]
    half = {name: 5000.0 for name in names if name.endswith(("acceleration", "deceleration"))}
    pitches = np.linspace(500.0, 1500.0, 11)
    changes = []
    for changed in (Machine(**half), Machine(approach_jerk=5e4, homing_jerk=5e4), Machine(cut_time=0.125)):
        shares = [
            abs(max_line_velocity(changed, pitch) / max_line_velocity(Machine(), pitch) - 1.0) for pitch in pitches
        ]
        changes.append(f"{100.0 * min(shares):.0f} to {100.0 * max(shares):.0f} %")
    acceleration, jerk, cut = changes
    assert f"the acceleration costs {acceleration} of the line's velocity, half the jerk {jerk}," in text
    assert f"half the time of the cut gains {cut}." in text
    slow, fast = row(read_readme(CutToLength), "shortest pitch")
    assert f"at 1000 mm/s the shortest pitch is {fast / slow:.1f} times that at 500 mm/s" in text


# --- of the RotaryKnife ---


def test_the_table_of_its_pieces() -> None:
    """What a knife with the start values does between the third cut and the fifth one, on a line of 100 mm/s. On pieces
    that are longer than `limits.max_length` it rests; the limits of its line do not depend on the line's velocity."""
    text = read_readme(RotaryKnife)
    lengths, peaks, limits = (
        row(text, head)
        for head in ("pieces of, mm", "greatest velocity over that in sync", "`limits.max_line_velocity`, mm/s")
    )
    middles = [*row(text, "in the middle"), 0.0]  # the last one: rest
    for length, peak, middle, limit in zip(lengths, peaks, middles, limits, strict=True):
        knife = Stepper(RotaryKnife()).initialize({"length": length, "auto_start": True, "master.velocity": 100.0})
        velocities = []
        for step in range(100_000):
            knife.step(0.01, {"master.position": float(step), "master.velocity": 100.0})
            if knife["statistics.cuts"] >= 3:
                velocities.append(knife["slave.velocity"] / 60.0)  # in sync 360 degrees in 600 mm
            if knife["statistics.cuts"] == 5:
                break
        assert max(velocities) == pytest.approx(peak, abs=5.1e-4)
        assert (min(velocities) if middle <= 1.0 else max(velocities)) == pytest.approx(middle, abs=5.1e-4)
        assert round(knife["limits.max_line_velocity"]) == limit
    assert knife["limits.max_length"] == lengths[-2]


# --- of the blocks ---


def folder(block: str) -> str:
    """The block's folder in the repository."""
    module = type(Recipe(block).block()).__module__
    return "/".join(["model", *module.split(".")[:-1]])


def test_the_root_readme_links_to_each_block(block: str) -> None:
    assert f"({folder(block)}/README.md)" in README


def test_a_block_s_readme_has_the_sections_that_all_have(block: str) -> None:
    text = read_readme(type(Recipe(block).block()))
    assert text.startswith(f"# {block}\n")
    headings = re.findall(r"^## (.*)", text, re.M)
    assert [heading for heading in headings if heading in SECTIONS] == list(SECTIONS)
    assert len(re.findall(rf"^!\[.+\]\(../../../docs/{block}.svg\)$", text, re.M)) == 1


def test_its_diagram_has_the_states_that_the_block_shows_or_its_stages(block: str) -> None:
    _, _, text = read_readme(type(Recipe(block).block())).partition("\n## States\n")
    (diagram,) = re.findall(r"```mermaid\nstateDiagram-v2\n(.*?)```", text, re.S)
    shown = {member.name for member in Recipe(block).variables["state"].choices}
    assert set(read_diagram(diagram).states) in (shown, set(stages(block)))
    assert all(re.search(rf"\b{name}\b", text) for name in shown)


def test_its_table_has_a_row_for_each_stage(block: str) -> None:
    _, _, text = read_readme(type(Recipe(block).block())).partition("\n## States\n")
    (table,) = re.findall(r"^\| [Ss]tage \|.*\n\|[- |]+\n((?:\|.*\n)+)", text, re.M)
    assert re.findall(r"^\| `?(\w+)`? \|", table, re.M) == list(stages(block))


def stages(block: str) -> dict[str, int]:
    """What drives the slave, by name."""
    (kind,) = {cell.type for cell in cells(Recipe(block).block()) if cell.type.__name__ == "Stage"}
    return {member.name: member.value for member in members(kind)}


def test_the_variables_that_it_names_exist(block: str) -> None:
    """All in backticks that is written as a variable: in full, the last part after a dot, a group, or a pattern."""
    recipe = Recipe(block)
    names = set(recipe.variables)
    existing = {name.split(".", i)[-1] for name in names for i in range(name.count(".") + 1)}
    existing |= {f".{last}" for last in existing} | {name.partition(".")[0] for name in names} | {"true", "false"}
    prose = re.sub(r"```.*?```", "", read_readme(type(recipe.block())), flags=re.S)
    written = set(re.findall(r"`(\.?[a-z][a-z0-9_.*]*)`", prose))
    files = {name for name in written if name.endswith((".py", ".toml", ".md"))}
    unknown = {
        name for name in written - files - existing - SOURCES if not any(fnmatchcase(full, name) for full in names)
    }
    assert not unknown
    assert written & names
