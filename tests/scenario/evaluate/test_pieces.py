"""The pieces of a block that reports them: what a run of a scenario finds, measures once more and checks.

Most runs are made by hand (`tests/support/scenarios/hand_made_run.py`), so that each number is known: the line runs at
1000 u/s, the front end is a cut at 198, the kerf is 4. Pieces of 1500, 1500, 1000 and 2000 end at 1702, 3206, 4210 and
6214.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.cutting.interface import PieceKind
from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.roles import piece_variables
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.pages.summary import print_result, print_row
from motionsync_fmu.scenario.evaluate.cutting_results import CuttingResults
from motionsync_fmu.scenario.evaluate.find_pieces import Piece, find_pieces, rises
from motionsync_fmu.scenario.evaluate.key_figures import compute_key_figures
from motionsync_fmu.scenario.evaluate.outcome import ScenarioOutcome
from motionsync_fmu.scenario.evaluate.production import Production, evaluate_production
from motionsync_fmu.scenario.evaluate.verdict import find_notes, gather
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.settings import Setting
from tests.support.scenarios.hand_made_run import APPROACH, CUT, HandMadeRun, record
from tests.support.scenarios.scenario_texts import assert_refused
from tests.support.scenarios.verdicts import checks_of

TEXT = """
title = "t"
fmu = "CutToLength"
stop_time = 8.0
step_size = 0.01
[start]
kerf = 4.0
[master]
velocity = 1000.0
[[set]]
at = 0.2
start = true
"""
P, S, M = PieceKind.PRODUCT, PieceKind.SAMPLE, PieceKind.MERGED
FOUR = [(P, 1500.0, 0.0), (P, 1500.0, 0.0), (S, 1000.0, 0.0), (M, 2000.0, 500.0)]
ENDS = [1702.0, 3206.0, 4210.0, 6214.0]


def scenario(folder: Path, more: str = "", text: str = TEXT) -> Scenario:
    file = folder / "scenario.toml"
    file.write_text(text + more, "utf-8")
    return load_scenario(file)


def run(s: Scenario, **changed: Any) -> Recording:
    """A run by hand of the four pieces; `changed`: what is different in it."""
    four_pieces = HandMadeRun(198.0, 4.0, FOUR, [1.0, 0.4, 0.3, 0.2], [(0.0, 900.0)], [(0.0, 1250.0)], [3])
    return record(s, replace(four_pieces, **changed), 0.2, 0.01)


def with_values(recording: Recording, **values: Any) -> Recording:
    """The same run with other values; in names `__` is a dot."""
    return replace(recording, values=recording.values | {name.replace("__", "."): v for name, v in values.items()})


def production_of(s: Scenario, recording: Recording) -> Production:
    production = evaluate_production(s, recording)
    assert production
    return production


def verdicts(s: Scenario, recording: Recording) -> dict[str, tuple[str, bool]]:
    """What is found of each expectation."""
    return {_key(c.expected): (c.actual, c.passed) for c in checks_of(s, recording)}


def notes_of(s: Scenario, recording: Recording) -> list[str]:
    return find_notes(gather(s, recording, CuttingResults(s, recording), []))


def _key(expected: str) -> str:
    """The first two words, or what is counted."""
    return expected.partition(" =")[0] if expected.startswith("number of") else " ".join(expected.split()[:2])


# --- what is found ---


def test_the_pieces_are_reported_and_measured(tmp_path: Path) -> None:
    """A cut is in sync when the material has gone on by D: at (C + D)/1000 s, and it lasts 0.25 s."""
    result = find_pieces(s := scenario(tmp_path), run(s))
    assert [(p.number, p.name, p.length, p.error, p.good) for p in result] == [
        (1, "PRODUCT", 1500.0, 0.0, True),
        (2, "PRODUCT", 1500.0, 0.0, True),
        (3, "SAMPLE", 1000.0, 0.0, False),
        (4, "MERGED", 2000.0, 500.0, False),
    ]
    assert [p.end for p in result] == pytest.approx(ENDS, abs=1e-9)
    assert [p.begin for p in result] == pytest.approx([198.0, *ENDS[:-1]], abs=1e-9)
    assert result[0].measured is None  # where the front end was, the positions do not show
    assert [p.measured for p in result[1:]] == pytest.approx([1500.0, 1000.0, 2000.0], abs=1e-9)
    assert [p.ordered for p in result] == [1500.0, 1500.0, 1000.0, 1500.0]
    assert [p.reserve for p in result] == [1.0, 0.4, 0.3, 0.2]
    for piece, end in zip(result, ENDS, strict=True):
        sync = (end + APPROACH) / 1000.0
        assert piece.sync == pytest.approx(sync, abs=1e-9)
        assert piece.cut == pytest.approx((sync, sync + CUT), abs=0.01)
        assert 0.0 <= piece.reported_at - (sync + CUT) < 0.01
        assert piece.wander < 1e-9


def test_a_block_that_shows_no_pieces_has_none() -> None:
    assert piece_variables(variables(FlyingSaw())) is None


def test_factor_kerf_and_correction_are_those_with_which_a_piece_was_begun(tmp_path: Path) -> None:
    """From 3 s on, while the second piece is made, the correction is 7 and the kerf 5.

    The block reported 1500 of a pitch of 1504, so it took those of before; the third is reported as 992 = 1004 - 5 - 7.
    With a factor of 1.02 and the kerf of 5 a pitch of 1504 is 1529.08 long."""
    s = scenario(tmp_path)
    later = replace(run(s), settings=[*s.settings, Setting(3.0, {"length_correction": 7.0, "kerf": 5.0})])
    lengths = later.values["last.length"]
    error = np.where(lengths == 1000.0, 992.0, lengths)
    result = find_pieces(s, with_values(later, last__length=error))
    assert [p.measured for p in result[1:3]] == pytest.approx([1500.0, 992.0], abs=1e-9)
    factor = scenario(tmp_path, text=TEXT.replace("kerf = 4.0", "kerf = 5.0\nmaterial_factor = 1.02"))
    second = find_pieces(factor, run(s))[1]
    assert second.measured == pytest.approx(1.02 * 1504.0 - 5.0, abs=1e-9)


def test_a_saw_that_travels_otherwise_than_the_material_cuts_at_the_same_places(tmp_path: Path) -> None:
    """A diagonal saw goes 1.25 for each 1 of the material."""
    s = scenario(tmp_path)
    plain = run(s)
    saw = with_values(
        plain,
        slave__position=1.25 * plain.values["slave.position"],
        local__coupling_factor=np.full(len(plain.time), 1.25),
    )
    assert [p.end for p in find_pieces(s, saw)] == pytest.approx(ENDS, abs=1e-9)


def test_the_first_piece_after_a_further_start_is_not_measured_from_the_cut_before(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    stopped = run(s)
    running = np.where((stopped.time > 2.5) & (stopped.time < 2.8), 0.0, stopped.values["running"])
    result = find_pieces(s, with_values(stopped, running=running))
    assert [p.measured is None for p in result] == [True, True, False, False]
    assert result[1].begin == pytest.approx(3206.0 - 1504.0, abs=1e-9)


def test_a_cut_within_one_step_is_reported_but_not_measured(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    plain = run(s)
    unseen = with_values(plain, tool__cutting=np.zeros(len(plain.time)))
    result = find_pieces(s, unseen)
    assert [(p.number, p.cut, p.measured) for p in result] == [(n, None, None) for n in (1, 2, 3, 4)]
    assert "cuts within" not in verdicts(scenario(tmp_path, "[cuts]\ncount = 4\n"), unseen)


def test_a_cut_that_was_broken_off_is_none(tmp_path: Path) -> None:
    """The blade was down between 2.4 s and 2.6 s, and no piece was reported: the cut at 3.3 s ended the second one."""
    s = scenario(tmp_path)
    plain = run(s)
    cutting = np.where((plain.time > 2.4) & (plain.time < 2.6), 1.0, plain.values["tool.cutting"])
    result = find_pieces(s, with_values(plain, tool__cutting=cutting))
    assert [p.end for p in result] == pytest.approx(ENDS, abs=1e-9)


def test_pieces_that_are_reported_within_one_step_are_counted(tmp_path: Path) -> None:
    """At points 3 s apart the block has reported 0, 1 and 3 pieces: the second one nobody saw."""
    s = scenario(tmp_path)
    full = run(s)
    sparse = Recording(
        full.time[::300], {n: v[::300] for n, v in full.values.items()}, full.master[::300], [], full.settings
    )
    production = production_of(s, sparse)
    assert production.cuts == 3
    assert [p.number for p in production.pieces] == [1, 3]
    assert notes_of(s, sparse)[-1] == "1 piece not reported: the step is longer than it takes to make one"


def test_a_counter_that_begins_anew_goes_on_counting() -> None:
    counter = np.array([2.0, 3.0, 3.0, 0.0, 0.0, 1.0, 3.0, 2.0])
    assert rises(counter).tolist() == [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0]


# --- how it is shown ---


def test_what_was_made_is_reported_in_words(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    production = production_of(s, run(s))
    assert production.pieces_text == "4 pieces: 2 PRODUCT, 1 SAMPLE, 1 MERGED; 2 good"
    assert production.made_text == "2 products, all good; also 1 sample, 1 merged"
    assert production.worst_text == "0 mm"
    assert (production.skipped, production.late, production.missed_text) == (1, 0, "1 skipped")
    assert production.reserve_text == "at least 20 % (piece 4) of a cycle"
    assert production.short_text == "4 pieces, worst error 0 mm (2 products, 1 merged piece not included), 1 skipped"
    assert production.tolerance == 0.5  # the block's own
    assert production.line
    assert production.line_speed_text == "1000 mm/s (60 m/min)"
    assert production.line.limit_text == "nearest to its limit at 0.21 s: 1000 of 1250 mm/s"
    assert notes_of(s, run(s)) == []


def test_the_worst_product_is_reported_with_its_number(tmp_path: Path) -> None:
    """The merged piece is off by 500, but nobody ordered it so."""
    s = scenario(tmp_path)
    production = production_of(s, run(s, pieces=[(P, 1500.0, 0.1), (P, 1500.0, -0.25), *FOUR[2:]]))
    assert production.worst_text == "0.25 mm (piece 2)"
    assert (
        production.short_text
        == "4 pieces, worst error 0.25 mm (piece 2) (2 products, 1 merged piece not included), 1 skipped"
    )


def test_a_line_that_is_too_fast_is_reported_and_a_note_where_cuts_were_missed(tmp_path: Path) -> None:
    """Between 2 s and 3.5 s the machine follows 950 u/s only; before `start` nothing is asked of it."""
    s = scenario(tmp_path)
    limit = [(0.0, 1250.0), (2.0, 950.0), (3.5, 1250.0)]
    in_time = (
        "for 1.5 s faster than the next pieces allow (most at 2 s: 1000 of 950 mm/s), but slow enough in time: "
        "no cut was late"
    )
    too_late = "above its limit for 1.5 s, most at 2 s: 1000 of 950 mm/s"
    for skipped, comment in (([], in_time), ([3], too_late)):
        recording = run(s, limit=limit, skipped_with=skipped)
        production = production_of(s, recording)
        assert production.line_text == comment
        assert production.line
        assert production.line.beyond == pytest.approx(1.5)
        assert production.line.limit_text == "above its limit for 1.5 s, most at 2 s: 1000 of 950 mm/s"
        assert notes_of(s, recording) == [f"the line was {comment}"]


def test_without_a_piece_there_is_little_to_show(tmp_path: Path) -> None:
    s = scenario(tmp_path, "[cuts]\n")
    nothing = run(s, pieces=[])
    production = production_of(s, nothing)
    assert (production.pieces_text, production.worst_text, production.reserve_text) == ("no piece", "", "")
    assert production.short_text == "no piece"
    skipped = {"number of skipped cuts": ("0", True)}
    assert verdicts(s, nothing) == skipped | {"products as": ("no piece", False)}
    assert verdicts(scenario(tmp_path, "[cuts]\ncount = 0\n"), nothing) == skipped | {"number of pieces": ("0", True)}


def test_json_and_console_show_the_pieces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    s = scenario(tmp_path)
    outcome = ScenarioOutcome(
        "f", "n", "t", "CutToLength", 0.01, compute_key_figures(s, run(s)), [], [], [], [], "r", None, "p"
    )
    production = outcome.as_json()["production"]
    assert [p["length"] for p in production["pieces"]] == [1500.0, 1500.0, 1000.0, 2000.0]
    assert (production["cuts"], production["skipped"], production["late"]) == (4, 1, 0)
    print_result(outcome, verbose=False)
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    begin = next(i for i, line in enumerate(lines) if line.startswith("made "))
    assert lines[begin : begin + 5] == [
        "made 4 pieces: 2 PRODUCT, 1 SAMPLE, 1 MERGED; 2 good",
        "length error 0 mm (2 products, 1 merged piece not included) 0.5 mm allowed",
        "not on time 1 skipped",
        "reserve at least 20 % (piece 4) of a cycle",
        "line 1000 mm/s (60 m/min) nearest to its limit at 0.21 s: 1000 of 1250 mm/s",
    ]
    print_row(outcome, 3)
    assert (
        "4 pieces, worst error 0 mm (2 products, 1 merged piece not included), 1 skipped; v " in capsys.readouterr().out
    )


# --- how it is evaluated ---


def test_pieces_are_evaluated_by_their_table(tmp_path: Path) -> None:
    s = scenario(tmp_path, "[cuts]\ntolerance = 1e-9\ncount = 4\nskipped = 1\n")
    result = verdicts(s, run(s))
    assert result["number of pieces"] == ("4", True)
    assert result["products as"] == ("at most 0 mm off", True)
    assert result["pieces as"][1]
    assert result["the tool"][1]
    assert verdicts(scenario(tmp_path, "[cuts]\ncount = 5\n"), run(s))["number of pieces"] == ("4", False)
    (skipped,) = (c for c in checks_of(scenario(tmp_path), run(s)) if "limit" not in c.expected)
    assert (skipped.expected, skipped.actual, skipped.passed) == ("number of skipped cuts = 0", "1", False)
    assert verdicts(scenario(tmp_path, "[cuts]\nskipped = 2\n"), run(s))["number of skipped cuts"] == ("1", False)


def test_lengths_and_kinds_are_compared_one_by_one(tmp_path: Path) -> None:
    cases = (
        ("lengths = [1500, 1500, 1000, 2000]", "4 lengths,", ("at most 0 mm off", True)),
        ("lengths = [1500, 1500.05, 1000, 2000]", "4 lengths,", ("at most 0.05 mm off", True)),
        ("lengths = [1500, 1500, 900, 2000]", "4 lengths,", ("piece 3 of 1000 instead of 900 mm", False)),
        ("lengths = [1500, 1500]", "2 lengths,", ("4 pieces", False)),
        ('kinds = ["PRODUCT", "PRODUCT", "SAMPLE", "MERGED"]', "kinds of", ("PRODUCT, PRODUCT, SAMPLE, MERGED", True)),
        ('kinds = ["PRODUCT", "PRODUCT"]', "kinds of", ("PRODUCT, PRODUCT, SAMPLE, MERGED", False)),
    )
    for text, expected, result in cases:
        s = scenario(tmp_path, f"[cuts]\n{text}\n")
        check = verdicts(s, run(s))
        assert check[expected] == result
        assert ("products as" in check) == text.startswith("kinds")


def test_a_product_that_is_not_as_ordered_is_evaluated(tmp_path: Path) -> None:
    s = scenario(tmp_path, "[cuts]\ntolerance = 0.3\n")
    off = run(s, pieces=[(P, 1500.2, 0.2), (P, 1500.4, 0.4), *FOUR[2:]])
    assert verdicts(s, off)["products as"] == ("at most 0.4 mm (piece 2) off", False)
    wider = scenario(tmp_path, "[cuts]\ntolerance = 0.5\n")
    assert verdicts(wider, off)["products as"][1]


def test_records_that_do_not_agree_with_the_positions_are_found(tmp_path: Path) -> None:
    """The block reports 1500 and no error, but the saw was 0.2 behind its place all through the second cut."""
    s = scenario(tmp_path, "[cuts]\n")
    honest = run(s)
    second = (honest.time > 2.0) & (honest.time < 4.0) & (honest.values["tool.cutting"] != 0.0)
    saw = honest.values["slave.position"] - 0.2 * second
    result = verdicts(s, with_values(honest, slave__position=saw))
    assert result["products as"] == ("at most 0 mm off", True)
    assert result["pieces as"] == ("at most 0.2 mm off", False)


def test_a_saw_that_does_not_stay_at_its_place_is_found(tmp_path: Path) -> None:
    """In the first cut, which nobody can measure: it slides by 0.6, so that it is 0.3 from the middle at both ends."""
    s = scenario(tmp_path, "[cuts]\n")
    honest = run(s)
    first = np.flatnonzero((honest.time < 2.2) & (honest.values["tool.cutting"] != 0.0))
    saw = honest.values["slave.position"].copy()
    saw[first] += np.linspace(-0.3, 0.3, len(first))
    assert verdicts(s, with_values(honest, slave__position=saw))["the tool"] == ("0.3 mm", False)


# --- the table ---


def test_the_table_is_read(tmp_path: Path) -> None:
    s = scenario(
        tmp_path, '[cuts]\ntolerance = 0.25\ncount = 2\nskipped = 3\nlengths = [5, 6.5]\nkinds = ["TRIM", "SHORT"]\n'
    )
    assert s.cuts is None
    assert s.pieces
    assert (s.pieces.tolerance, s.pieces.count, s.pieces.lengths) == (0.25, 2, (5.0, 6.5))
    assert s.pieces.skipped == 3
    assert s.pieces.kinds == ("TRIM", "SHORT")
    plain = scenario(tmp_path, "[cuts]\n").pieces
    assert plain
    assert (plain.tolerance, plain.count, plain.lengths, plain.kinds) == (0.1, None, None, None)
    metres = scenario(tmp_path, "[cuts]\n", TEXT.replace("stop", 'unit = "m"\nstop')).pieces
    assert metres
    assert metres.tolerance == 1e-4
    assert scenario(tmp_path).pieces is None


@pytest.mark.parametrize(
    ("line", "key", "parts"),
    [
        ("length = 1500.0", "length", ("is not needed", "CutToLength itself reports")),
        ('while = "in_sync"', "while", ("is not needed",)),
        ("lenghts = [1.0]", "lenghts", ("unknown key", "lengths")),
        ("lengths = 1500.0", "lengths", ("1500.0", "list of numbers")),
        ('lengths = [1500.0, "x"]', "lengths", ("'x'", "number")),
        ("lengths = [true]", "lengths", ("True", "number")),
        ("lengths = [inf]", "lengths", ("inf", "finite")),
        ('kinds = ["PRODUKT"]', "kinds", ("'PRODUKT'", "PRODUCT, SAMPLE")),
        ("kinds = [1]", "kinds", ("neither a text",)),
        ("count = -1", "count", ("-1",)),
        ("skipped = -1", "skipped", ("-1", ">= 0")),
        ("skipped = 1.5", "skipped", ("1.5", "whole number")),
        ("skipped = true", "skipped", ("True", "number")),
        ("tolerance = -0.1", "tolerance", ("-0.1", ">= 0")),
    ],
)
def test_a_mistake_in_the_table_is_reported_with_its_line(
    line: str, key: str, parts: tuple[str, ...], tmp_path: Path
) -> None:
    assert_refused(f"{TEXT}[cuts]\n{line}\n", tmp_path, line, key, *parts)


def test_where_positions_are_no_lengths_the_tolerance_has_to_be_given(tmp_path: Path) -> None:
    overridden = TEXT.replace("stop", 'unit = "deg"\nstop')
    with pytest.raises(UserError, match="tolerance: is missing: in deg"):
        scenario(tmp_path, "[cuts]\n", overridden)
    assert scenario(tmp_path, "[cuts]\ntolerance = 1.0\n", overridden).pieces


# --- the block itself ---


REAL = """
title = "t"
fmu = "CutToLength"
stop_time = 8.0
step_size = {}
[start]
auto_start = true
kerf = 4.0
length = 1500.0
material_factor = 1.02
diagonal_angle = 30.0
"axis.max_velocity" = 2000.0
[master]
velocity = 1000.0
segments = [{{ duration = 4.0 }}, {{ duration = 1.0, acceleration = -300.0 }}]
[[set]]
at = 2.0
length_correction = 3.0
[cuts]
tolerance = 1e-9
"""


@pytest.mark.parametrize("step", [0.01, 0.037])
def test_the_block_shows_what_the_positions_say(step: float, tmp_path: Path) -> None:
    """Pitches of (1500 + 4)/1.02 = 1474.51 before the correction, (1500 + 4 + 3)/1.02 = 1477.45 after it. The second
    piece was fixed before 2 s, at the end of the first cut at about 1.8 s."""
    s = scenario(tmp_path, text=REAL.format(step))
    recording = run_in_process(s, step)
    assert all(c.passed for c in checks_of(s, recording))
    result = find_pieces(s, recording)
    assert len(result) == 4
    pitches = np.diff([p.end for p in result])
    assert pitches == pytest.approx([1504.0 / 1.02, 1507.0 / 1.02, 1507.0 / 1.02], abs=1e-9)
    assert all(isinstance(p, Piece) and p.measured == pytest.approx(1500.0, abs=1e-9) for p in result[1:])
