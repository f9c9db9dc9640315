"""The PHASE estimator, against its Kalman filter computed by hand.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

from itertools import pairwise

import pytest

from tests.model.remote_sync.harness import (
    BEATING,
    PHASE,
    T,
    at,
    beat_cycles,
    beating,
    close,
    offset,
    run,
    since,
)

RHO2, WALK, DRIFT2 = 0.005**2, 2e-15, 3e-4**2
State = tuple[float, float, float, float, float]  # x, d, p11, p12, p22


def updated(state: State, span: float, border: float) -> State:
    """Prediction over a span, then the phase measured there."""
    x, d, p11, p12, p22 = state
    p11, p12, p22 = (
        p11 + 2 * span * p12 + span**2 * p22 + WALK * span**3 / 3,
        p12 + span * p22 + WALK * span**2 / 2,
        p22 + WALK * span,
    )
    g1, g2 = p11 / (p11 + RHO2), p12 / (p11 + RHO2)
    error = border - x - d * span
    return x + d * span + g1 * error, d + g2 * error, (1 - g1) * p11, (1 - g1) * p12, p22 - g2 * p12


def test_the_phase_begins_in_the_middle_of_the_first_difference() -> None:
    recording = run(beating(400, first=3), **PHASE)
    assert set(offset(recording, *range(400))) == {3.5}
    assert set(recording["correction_time"]) == {0.5 * T}


def test_a_beat_dates_the_phase_half_a_cycle_before_its_first_cycle() -> None:
    """Clean steps at 500 and 1000, seen 90 cycles later with 91 cycles counted: b = 499.5 and 999.5."""
    recording = run(BEATING, **PHASE)
    state = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    x, d = state[:2]
    assert at(recording, "drift", 589, 590) == (0.0, close(1e6 * d, tolerance=1e-9))
    rest = 0.5 - (x + d * 90.5)
    assert offset(recording, 590, 635, 680, 1000) == close(
        0.5, x + d * 135.5 + rest / 2, x + d * 180.5, x + d * 500.5, tolerance=1e-10
    )
    before = x + d * (1090 - 499.5)
    x, d = updated(state, 500.0, 2.0)[:2]
    assert recording["drift"][1090] == close(1e6 * d, tolerance=1e-9)
    assert d == pytest.approx(2e-3, rel=3e-3)
    rest = before - (x + d * 90.5)
    assert offset(recording, 1090, 1117, 1399) == close(
        before, x + d * 117.5 + rest * 63 / 90, x + d * 399.5, tolerance=1e-10
    )
    assert (
        since(recording, "synced")
        == since({"synced": [abs(t) < 0.05 * T for t in recording["correction_time"][1090:]]}, "synced") + 1090
    )


def test_the_cycles_beyond_are_counted_wherever_in_the_zone_they_are() -> None:
    """Every other one of 480 to 519: as many as with a clean step at 500."""
    clean, zone = BEATING, beating(1400, 520, 1000)
    for n in range(480, 520, 2):
        zone[n] += 1
    a, b = run(clean, **PHASE), run(zone, **PHASE)
    assert beat_cycles(b) == [610, 1090]
    assert b["drift"][610] == a["drift"][590]
    assert b["drift"][1090] == a["drift"][1090]


def test_a_cycle_counts_once_however_far_beyond_it_is() -> None:
    far = [*BEATING]
    far[500] += 3
    assert run(far, **PHASE)["drift"][1090] == run(BEATING, **PHASE)["drift"][1090]
    back = beating(1400, 499, 1000)  # one cycle short of D in the zone counts for neither
    back[500] -= 2
    assert run(back, **PHASE)["drift"][1090] == run(BEATING, **PHASE)["drift"][1090]


@pytest.mark.parametrize("sign", [1, -1])
def test_phase_follows_either_sender_without_a_lag(sign: int) -> None:
    """The sender's true index: at the border where D steps, half a cycle before; so 2 (or -1) + d (n - 999.5)."""
    recording = run(beating(1400, 500, 1000, sign=sign), **PHASE)
    border = 2 if sign > 0 else -1
    expected = border + sign * 0.002 * 399.5
    assert offset(recording, 1399)[0] == pytest.approx(expected, abs=5e-3)
    assert recording["drift"][1399] == pytest.approx(sign * 2000.0, rel=5e-3)


def test_the_first_two_beats_far_apart_give_the_drift_of_the_line_through_both() -> None:
    """25000 cycles are 40 ppm."""
    recording = run(beating(26000, 500, 25500), **PHASE)
    assert recording["drift"][25590] == close(40.0)
    assert offset(recording, 25900)[0] == close(2 + 40e-6 * (25900 - 25499.5))


def joined(span: float) -> State:
    """After the first two beats, at the second one, which is at the border 2."""
    return 2.0, 1 / span, RHO2, RHO2 / span, 2 * RHO2 / span**2


def test_later_beats_far_apart_go_through_the_filter() -> None:
    """25910 cycles are 38.6 ppm in the mean; a drift that walks there from 40 is as far beyond again by half."""
    recording = run(beating(51600, 500, 25500, 51500 - 90), **PHASE)
    x, d, *_ = updated(joined(25000.0), 25910.0, 3.0)
    assert recording["drift"][51500] == close(1e6 * d, tolerance=1e-9)
    assert recording["drift"][51500] == pytest.approx(40 - 1.5 * (40 - 1e6 / 25910), abs=0.1)
    assert offset(recording, 51599)[0] == close(x + d * 189.5, tolerance=1e-9)


def test_a_first_beat_back_far_away_goes_through_the_filter() -> None:
    """There and back over the same border: no line leads through both."""
    recording = run([n + (500 <= n < 25500) for n in range(25700)], **PHASE)
    first = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    assert first[0] + first[1] * 25000 > 2.05  # so it was held in its count: the drift is what is left of it
    held = (2.05 - first[0]) / (25499 - 499.5)
    assert recording["drift"][25499] == close(1e6 * held, tolerance=1e-9)
    x, d, *_ = updated((first[0], held, *first[2:]), 25000.0, 1.0)
    assert recording["drift"][25590] == close(1e6 * d, tolerance=1e-9)
    assert offset(recording, 25690)[0] == close(x + d * 190.5, tolerance=1e-9)


def test_phase_sets_the_middle_of_a_first_difference_that_does_not_stay() -> None:
    recording = run(beating(300, 40), **PHASE)
    assert offset(recording, 130, 175, 220, 299) == close(0.5, 1.0, 1.5, 1.5)
    assert recording["beats"][-1] == 0


def test_between_beats_the_phase_stays_in_its_count_but_for_a_slack() -> None:
    """The sender keeps step after two beats of 2000 ppm: it stops at 3.05, and the drift fades."""
    recording = run(beating(4000, 500, 1000), **PHASE)
    assert offset(recording, 3000, 3999) == close(3.05, 3.05)
    assert max(offset(recording, *range(4000))) <= 3.05 + 1e-12
    x, d, *_ = updated(updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0), 500.0, 2.0)
    assert x + d * (1520 - 999.5) < 3.05 < x + d * (1530 - 999.5)
    assert recording["drift"][3999] == close(1e6 * (3.05 - x) / (3999 - 999.5), tolerance=1e-6)
    assert recording["synced"][-1]


def test_a_closed_zone_lets_the_phase_be_held_again_without_a_jump() -> None:
    """A flicker at 1500 keeps the zone open until 1591, where the phase is 0.13 beyond; that is worked off."""
    indices = beating(1800, 500, 1000)
    indices[1500] += 1
    recording = run(indices, **PHASE)
    beyond = offset(recording, 1591)[0]
    assert beyond == pytest.approx(2 + 0.002 * 591.5, abs=5e-3)
    assert offset(recording, 1636, 1681, 1799) == close(3.05 + (beyond - 3.05) / 2, 3.05, 3.05, tolerance=1e-9)
    assert max(abs(b - a) for a, b in pairwise(offset(recording, *range(1200, 1800)))) < 0.0021


def test_phase_needs_no_new_start_for_a_reversal() -> None:
    """Two beats back, 500 apart, after two there: the second one is seen at 2090."""
    indices = [index - (n >= 1500) - (n >= 2000) for n, index in enumerate(beating(2400, 500, 1000))]
    recording = run(indices, **PHASE)
    assert all(recording["synced"][since(recording, "synced") :])
    assert at(recording, "beats", 1090, 1590, 2090) == (2, 3, 4)
    assert at(recording, "warning", 1589, 1590, 2090) == (False, True, False)
    assert recording["drift"][2090] < 0.0


def test_phase_forgets_its_beats_with_a_change_of_two_or_more() -> None:
    """The phase is the middle of the new count; the drift stays."""
    indices = [index + 4 * (n >= 1300) for n, index in enumerate(beating(1600, 500, 1000))]
    recording = run(indices, **PHASE)
    assert at(recording, "synced", 1389, 1390) == (True, False)
    assert at(recording, "beats", 1389, 1390) == (2, 0)
    assert at(recording, "warning", 1389, 1390) == (False, True)
    before = offset(recording, 1390)[0]
    assert before == pytest.approx(2 + 0.002 * 390.5, abs=5e-3)
    d = recording["drift"][1390] * 1e-6
    assert d == pytest.approx(0.002, rel=5e-3)
    assert offset(recording, 1435, 1480) == close((before + 6.5) / 2 + 45 * d, 6.5 + 90 * d)


def test_after_a_change_of_two_or_more_the_phase_is_as_uncertain_as_at_the_start() -> None:
    """D is 5 from 800 on, seen at 890, and 6 from 1400 on: dated 509.5 later. The drift's variance goes on."""
    recording = run([n + (n >= 500) + 4 * (n >= 800) + (n >= 1400) for n in range(1700)], **PHASE)
    _, d, _, _, p22 = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    x, d, *_ = updated((5.5, d, 1 / 12, 0.0, p22), 1399.5 - 890.0, 6.0)
    assert recording["drift"][1490] == close(1e6 * d, tolerance=1e-9)
    assert offset(recording, 1580, 1699) == close(x + d * 180.5, x + d * 299.5, tolerance=1e-9)


def test_phase_warns_of_a_distance_that_differs_by_more_than_a_fifth() -> None:
    assert run(beating(1800, 500, 1000, 1600), **PHASE)["warning"][1690] is False
    assert run(beating(1800, 500, 1000, 1601), **PHASE)["warning"][1691] is True
    assert run(beating(1800, 500, 1000, 1399), **PHASE)["warning"][1489] is True
