"""What the report of a long run costs: 396,000 points, and some 2600 pieces.

    python benchmarks/report.py [--minutes 66]

The time is that of the evaluation and of the page, without the run; the memory is what both take on top of the run's
recording (on Linux alone), whose size is printed, too. A machine that does other things makes it slower.
"""

import argparse
import re
import tempfile
from pathlib import Path
from time import perf_counter

from motionsync_fmu.batch.scripted_runs import run_scenarios
from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.files.reader import load_scenario

SECONDS, MEGABYTES = 10.0, 200.0  # the targets
SAW = """
title = "Pieces of 1500 mm from a line at 60 m/min"
fmu = "CutToLength"
stop_time = {stop_time}
step_size = 0.01
[start]
length = 1500.0
kerf = 4.0
[master]
velocity = 1000.0
[[set]]
at = 0.1
start = true
"""


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=66.0, help="how long the run is")
    minutes = parser.parse_args().minutes
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenario.toml"
        file.write_text(SAW.format(stop_time=60.0 * minutes), "utf-8")
        scenario = load_scenario(file)
        names = [v.name for v in scenario.recipe.variables.values() if not v.settable]
        (run,) = run_scenarios([scenario], names)
        assert run.recording, run.failure
        before, begin = memory("VmRSS"), perf_counter()
        outcome = evaluate_run(scenario, run.recording)
        evaluated = perf_counter()
        page = Path(folder) / "report.html"
        write_report(page, scenario, run.recording, outcome)
        written = perf_counter()
        points, held = len(run.recording.time), sum(x.nbytes for x in run.recording.values.values())
        print(f"{points} points, {outcome.figures.work_text}: the recording has {held / 1e6:.0f} MB")
        print(f"evaluation {evaluated - begin:6.1f} s, page {written - evaluated:6.1f} s; at most {SECONDS:g} s wanted")
        print(f"memory {memory('VmHWM') - before:10.0f} MB on top of it; at most {MEGABYTES:g} MB wanted")
        print(f"page {page.stat().st_size / 1e6:12.1f} MB")


def memory(name: str) -> float:
    """A figure of this process's memory, in MB: VmRSS, what it has now; VmHWM, the most that it had."""
    status = Path("/proc/self/status")
    row = re.search(rf"{name}:\s*(\d+) kB", status.read_text()) if status.exists() else None
    return int(row[1]) / 1000.0 if row else 0.0


if __name__ == "__main__":
    main()
