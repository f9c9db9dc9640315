"""The memory of a long run: a recording needs little more than its numbers, its files next to nothing.

A run has up to a million steps and sixty outputs: 8 bytes each are 480 MB, and four times as much as Python's numbers.
"""

import tracemalloc
from dataclasses import replace
from pathlib import Path

import pytest

from motionsync_fmu.scenario.evaluate.csv_files import write_inputs, write_outputs
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process
from tests.support.project.workshop import scenario

POINTS = 20_000


@pytest.mark.slow
def test_a_recording_needs_its_numbers_and_files_a_few_rows(tmp_path: Path) -> None:
    s = load_scenario(scenario(str(tmp_path)))
    run_in_process(s, s.stop_time / 10)  # what is imported and kept for all runs
    s = replace(s, step_size=s.stop_time / POINTS)
    tracemalloc.start()
    try:
        recording = run_in_process(s, s.step_size)
        _, needed = tracemalloc.get_traced_memory()
        numbers = (1 + 4 + len(recording.values)) * len(recording.time)
        assert len(recording.time) >= POINTS
        assert needed < 12 * numbers + 100 * POINTS  # bytes: the arrays as they grow; the communication points
        tracemalloc.reset_peak()
        before, _ = tracemalloc.get_traced_memory()
        with (tmp_path / "out.csv").open("w") as out:
            write_outputs(out, s, recording)
        _, most = tracemalloc.get_traced_memory()
        assert most - before < 8 * numbers / 2
        tracemalloc.reset_peak()
        with (tmp_path / "in.csv").open("w") as out:
            write_inputs(out, s)
        _, most = tracemalloc.get_traced_memory()
        assert most - before < 150 * POINTS
    finally:
        tracemalloc.stop()
    assert len((tmp_path / "out.csv").read_text().splitlines()) == 1 + len(recording.time)
    assert len((tmp_path / "in.csv").read_text().splitlines()) == len(recording.time)
