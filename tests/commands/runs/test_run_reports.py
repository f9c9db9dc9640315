"""`motionsync run`: the files that it writes, reports and JSON."""

import csv
import json
import re
import shlex
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from tests.support.project.command_line import Command
from tests.support.project.workshop import STOP, scenario


def test_run_writes_results_and_report(workshop: Command) -> None:
    assert workshop("run", "stop", "--output", "results").status == 0
    with Path("results/Synchronizer/stop/Synchronizer_out.csv").open(newline="") as f:
        header, *rows = list(csv.reader(f))
    assert header[0] == "time"
    axis = [
        f"{part}.{name}" for part in ("master", "slave") for name in ("position", "velocity", "acceleration", "jerk")
    ]
    assert header[:10] == ["time", *axis, "state"]
    assert {"state_code", "local.progress"} <= set(header)
    assert {row[header.index("state")] for row in rows} <= {"0", "1", "2"}
    assert {row[header.index("synchronized")] for row in rows} == {"0", "1"}
    assert [float(row[header.index("master.position")]) for row in rows[::10]] == pytest.approx([0, 10, 20, 30, 40, 50])
    times = [float(row[0]) for row in rows]
    assert times == pytest.approx([i * 0.01 for i in range(51)], abs=1e-12)
    position = header.index("slave.position")
    assert float(rows[10][position]) == pytest.approx(10.0, abs=1e-12)
    assert float(rows[30][position]) == pytest.approx(27.5, abs=1e-9)
    assert float(rows[50][position]) == 30.0
    assert Path("results/Synchronizer/stop/report.html").is_file()


def test_run_without_a_report_writes_none(workshop: Command) -> None:
    assert workshop("run", "stop", "--no-report").status == 0
    names = sorted(p.name for p in Path("build/reports").rglob("*") if p.is_file())
    assert names == ["Synchronizer_in.csv", "Synchronizer_out.csv"]


def test_the_printed_line_for_fmpy_runs_also_a_scenario_without_generated_files(workshop: Command) -> None:
    (result,) = json.loads(workshop("run", "stop", "--no-report", "--json").out)
    words = shlex.split(result["fmpy"])
    fmpy = str(Path(sys.executable).with_name(words[0]))
    subprocess.run([fmpy, *words[1:], "--output-variables", "slave.position"], check=True)
    with Path("Synchronizer_out.csv").open(newline="") as f:
        rows = {round(float(row["time"]), 6): float(row["slave.position"]) for row in csv.DictReader(f)}
    assert rows[0.3] == pytest.approx(27.5, abs=1e-9)  # what the scenario expects


class PageParser(HTMLParser):
    """Collects what a page would load from elsewhere, its links, and its text."""

    def __init__(self) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str | None] = []
        self.words: list[str] = []
        self.tag = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tag = tag
        if tag == "a":  # a link loads nothing until somebody follows it
            self.links += [v for k, v in attrs if k == "href"]
            return
        self.loads += [f"{tag} {k}={v}" for k, v in attrs if k in ("src", "href", "srcset", "data", "action", "poster")]
        self.loads += [f"{tag} {k}={v}" for k, v in attrs if k == "style" and "url(" in (v or "")]

    def handle_endtag(self, tag: str) -> None:
        self.tag = ""

    def handle_data(self, data: str) -> None:
        if self.tag == "style":
            self.loads += re.findall(r"@import.*|url\(.*", data)
        elif self.tag != "script":
            self.words += data.split()


def test_the_report_is_one_self_contained_page(workshop: Command) -> None:
    assert workshop("run", "stop").status == 0
    folder = Path("build/reports/Synchronizer/stop")
    assert sorted(p.name for p in folder.iterdir()) == ["Synchronizer_in.csv", "Synchronizer_out.csv", "report.html"]
    page = PageParser()
    page.feed((folder / "report.html").read_text("utf-8"))
    assert page.loads == []
    assert page.links == ["Synchronizer_out.csv"]
    text = " ".join(page.words)
    for part in ("A stop along a parabola", "By hand", "slave.position = 27.5", "synchronized == false", "rest_value"):
        assert part in text


def test_the_report_escapes_the_text_of_the_scenario(workshop: Command) -> None:
    scenario("odd", STOP.replace("A stop along", "<img src='http://example.org'> & </script>"))
    assert workshop("run", "odd").status == 0
    page = PageParser()
    page.feed(Path("build/reports/Synchronizer/odd/report.html").read_text("utf-8"))
    assert page.loads == []
    assert "<img src='http://example.org'> & </script> a parabola" in " ".join(page.words)


def test_json_has_all_results_and_nothing_else_is_printed(workshop: Command) -> None:
    Path("stop/Synchronizer_ref.csv").write_text('"time","slave.position"\n0.0,0.0\n0.1,10.0\n0.3,27.5\n0.5,30.0\n')
    outcome = workshop("run", "stop", "--json", "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    (result,) = json.loads(outcome.out)
    actual = [e.pop("actual") for e in result["expectations"]]
    (deviation,) = result["reference"]
    assert deviation.pop("max_difference") <= 3e-8
    assert deviation.pop("at") in (0.0, 0.1, 0.3, 0.5)
    peaks = {p["name"]: (p["least"], p["greatest"], p["limit"], p["exceeded"]) for p in result.pop("peaks")}
    assert {name: of[2:] for name, of in peaks.items()} == dict.fromkeys(peaks, (None, False))
    assert {name: of[:2] for name, of in peaks.items()} == {
        "position": (0.0, 30.0),
        "velocity": (0.0, 100.0),
        "acceleration": (pytest.approx(-500.0), 0.0),
        "jerk": (0.0, 0.0),
    }
    assert result == {
        "scenario": "stop",
        "name": "Synchronizer/stop",
        "title": "A stop along a parabola",
        "fmu": "Synchronizer",
        "step_size": 0.01,
        "passed": True,
        "expectations": [
            {"expected": "slave.position = 27.5 ± 1e-9 at 0.3 s", "passed": True},
            {"expected": "slave.velocity = 50 ± 1e-9 at 0.3 s", "passed": True},
            {"expected": "first synchronized == false at 0.4 s ± 0.01", "passed": True},
            {"expected": "slave.velocity between 0 and 100 mm/s ± 1e-9 mm/s, from 0 s to 0.5 s", "passed": True},
        ],
        "reference": [{"variable": "slave.position", "allowed": pytest.approx(3e-8), "passed": True}],
        "cuts": [],
        "uncut": [],
        "production": None,
        "notes": [],
        "messages": [],
        "result": str(Path("build/reports/Synchronizer/stop/Synchronizer_out.csv")),
        "report": None,
        "fmpy": result["fmpy"],
    }
    assert actual == ["27.5", "50", "0.4 s", "0 to 100 mm/s"]


def test_cuts_are_printed_and_shown(workshop: Command) -> None:
    """The slave is the master until 0.2 s: one cut, 0.5 mm before the mark."""
    table = '\n[cuts]\nwhile = "syn_synchronized"\nlength = 20.0\noffset = 0.5\ntolerance = {}\n'
    scenario("saw", STOP + table.format(0.6))
    outcome = workshop("run", "saw")
    assert (outcome.status, outcome.err) == (0, "")
    assert "  saw           1 cut, worst error 0.5 mm (mark 0.5 mm); 0.6 mm allowed\n" in outcome.out
    verbose = workshop("run", "saw", "--no-report", "-v").out
    assert "met      cuts within 0.6 mm of a mark, one mark each 20 mm: found at most 0.5 mm away\n" in verbose
    page = PageParser()
    page.feed(Path("build/reports/Synchronizer/saw/report.html").read_text("utf-8"))
    assert page.loads == []
    text = " ".join(page.words)
    assert "A cut each time syn_synchronized is true; a mark on the material every 20 mm, from 0.5 on" in text
    assert re.search(r"cut from to mark error 1 0 s 0\.(19|2) s 0\.5 mm -0\.5 mm ", text)
    scenario("saw", STOP + table.format(0.4))
    outcome = workshop("run", "saw", "--json", "--no-report")
    assert outcome.status == 1
    (result,) = json.loads(outcome.out)
    (cut,) = result["cuts"]
    assert cut == pytest.approx({"begin": 0.0, "end": cut["end"], "mark": 0.5, "error": -0.5}, abs=1e-9)


def test_a_run_without_a_cut_is_reported_and_checked(workshop: Command) -> None:
    """It is as expected only if the scenario expects no cut."""
    table = '\n[cuts]\nwhile = "error"\nlength = 20.0\n'
    scenario("saw", STOP + table)
    outcome = workshop("run", "saw")
    assert (outcome.status, outcome.err) == (1, "")
    assert "  saw           no cut; 0.1 mm allowed\n" in outcome.out
    assert "There was none." in Path("build/reports/Synchronizer/saw/report.html").read_text("utf-8")
    scenario("saw", STOP + table + "count = 0\n")
    assert workshop("run", "saw", "--no-report").status == 0
