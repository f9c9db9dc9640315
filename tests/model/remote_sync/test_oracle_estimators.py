"""The RemoteSync's oracle against numbers worked out by hand: both estimators and their accuracy."""

import math
import random
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import pytest

from tests.model.remote_sync.oracle_cases import (
    PHASE,
    SYNC,
    TIME,
    UNIFORM,
    T,
    beating,
    close,
    column,
    run,
    since,
)
from tests.oracle.remote_sync import PARAMETERS
from tests.oracle.remote_sync_estimators import Beat, Phase

# --- the BEAT estimator -----------------------------------------------------------------------------------------------


def test_equal_clocks_stay_in_time_mode_without_a_correction() -> None:
    rows = run(range(100, 400))
    assert column(rows, "corrected_cycle_index") == [float(n) for n in range(100, 400)]
    assert set(column(rows, "correction_time")) == {0.0}
    assert set(column(rows, "state")) == {TIME}
    assert all(column(rows, "start_up"))
    assert not any(column(rows, "synced"))
    last = rows[-1]
    assert (last["drift"], last["beats"], last["error"], last["warning"]) == (0.0, 0, False, False)
    assert (last["cycle_index_difference"], last["equal_data_total"], last["equal_data_consecutive"]) == (1, 0, 0)


def test_the_index_wraps_and_the_corrected_one_does_not() -> None:
    rows = run([(65500 + n) % 65536 for n in range(100)])
    assert column(rows, "corrected_cycle_index") == [65500.0 + n for n in range(100)]
    other = run([65500 + n - 65536 * (n % 3) for n in range(100)])
    assert other == rows


def test_the_first_beat_is_worked_off_and_the_second_gives_the_drift() -> None:
    """D steps at 500 and 1000, seen at 590 and 1090; N = 500, and c - n goes from 1 to 2 + g(u)."""
    rows = run(beating(1400, 500, 1000), **UNIFORM)
    c = column(rows, "corrected_cycle_index")
    assert (c[590], c[635], c[680], c[1000]) == (590.0, 635.5, 681.0, 1001.0)
    assert (c[1090], c[1135], c[1180]) == (1091.0, close(1135 + 0.5 + 0.5 * 2.27), close(1182.36))
    assert (c[1300], c[1399]) == (close(1302.6), close(1399 + 2.798))
    assert (rows[589]["beats"], rows[590]["beats"], rows[1089]["beats"], rows[1090]["beats"]) == (0, 1, 1, 2)
    assert (rows[1089]["drift"], rows[1090]["drift"]) == (0.0, 2000.0)
    assert rows[500]["correction_time"] == close(-T)
    assert rows[1135]["correction_time"] == close((1.635 - 2) * T)


def test_default_slopes_do_most_of_the_correction_early() -> None:
    """g(0.36) = 0.684; g(0.6) = 0.96; beyond a whole N it stays 1."""
    rows = run(beating(1700, 500, 1000))
    c = column(rows, "corrected_cycle_index")
    assert (c[1180], c[1250], c[1300]) == (close(1182.684), close(1252.95), close(1302.96))
    assert (c[1500], c[1699]) == (close(1503.0), close(1702.0))


def test_synced_waits_for_a_correction_below_the_threshold() -> None:
    """x cycles after 1090: c - k = x(590 + x)/45000 - 1, above -0.05 from x = 66 on."""
    rows = run(beating(1400, 500, 1000), **UNIFORM)
    assert since(rows, "synced") == 1156
    assert (rows[1155]["state"], rows[1156]["state"]) == (TIME, SYNC)
    assert (rows[1155]["start_up"], rows[1156]["start_up"]) == (True, False)
    assert rows[-1]["synced"]  # though c - k is 0.8


def test_a_slower_sender_is_followed_one_cycle_behind() -> None:
    rows = run(beating(1400, 500, 1000, sign=-1, first=10), **UNIFORM)
    assert rows[1300]["corrected_cycle_index"] == close(1300 + 8 - 0.6)
    assert rows[1090]["drift"] == -2000.0


def test_a_beat_is_dated_by_the_middle_of_its_zone() -> None:
    """Two zones of flicker, 480 … 520 and 1000 … 1011: N = 505.5, seen 90 cycles after their ends."""
    differences = [0] * 480 + [1, 0] * 20 + [1] * 480 + [2, 1] * 5 + [1] + [2] * 189
    assert differences[519:521] == [0, 1]
    assert differences[999:1001] + differences[1010:1012] == [1, 2, 1, 2]
    rows = run(n + difference for n, difference in enumerate(differences))
    assert [n for n in range(1, 1200) if rows[n]["beats"] > rows[n - 1]["beats"]] == [610, 1101]
    assert rows[-1]["drift"] == close(1e6 / 505.5)


def test_a_zone_that_closes_at_the_confirmed_value_is_no_beat() -> None:
    """A single flicker at 300 is forgotten by 391; one at 450 belongs to the zone of the beat at 500."""
    indices = beating(1200, 500, 1000)
    indices[300] += 1
    rows = run(indices, **UNIFORM)
    assert rows[499]["beats"] == 0
    assert rows[-1]["drift"] == 2000.0
    indices[450] += 1
    assert run(indices, **UNIFORM)[-1]["drift"] == close(1e6 / (1000 - 475))


def test_the_first_quiet_stretch_is_worked_off_and_is_no_beat() -> None:
    rows = run(beating(300, 40))
    c = column(rows, "corrected_cycle_index")
    assert (c[129], c[130], c[175], c[220]) == (129.0, 130.0, 175.5, 221.0)
    assert rows[-1]["beats"] == 0


def test_a_confirmed_change_of_several_is_worked_off_without_a_beat() -> None:
    indices = [n + (6 if n >= 200 else 0) for n in range(500)]
    rows = run(indices)
    c = column(rows, "corrected_cycle_index")
    assert (c[290], c[320], c[380]) == (290.0, close(322.0), 386.0)
    assert (rows[-1]["beats"], rows[-1]["warning"], rows[-1]["error"]) == (0, False, False)


def test_a_change_of_several_forgets_the_beats() -> None:
    indices = [index + (3 if n >= 1300 else 0) for n, index in enumerate(beating(1600, 500, 1000))]
    rows = run(indices, **UNIFORM)
    assert (rows[1389]["synced"], rows[1389]["drift"]) == (True, 2000.0)
    last = rows[1390]
    assert (last["synced"], last["drift"], last["beats"], last["warning"]) == (False, 0.0, 0, True)
    assert (last["state"], last["start_up"]) == (TIME, True)
    assert last["corrected_cycle_index"] == close(1390 + 2.78)
    assert rows[1435]["corrected_cycle_index"] == close(1435 + (2.78 + 5) / 2)
    assert rows[1480]["corrected_cycle_index"] == 1485.0


def test_a_reversal_starts_anew_with_its_own_beat() -> None:
    """D = 1 again at 1300: seen at 1390, where c - n = 2.78 had been reached."""
    indices = [
        index - (1 if n >= 1300 else 0) - (1 if n >= 1700 else 0) for n, index in enumerate(beating(2000, 500, 1000))
    ]
    rows = run(indices, **UNIFORM)
    reversed_row = rows[1390]
    assert (reversed_row["beats"], reversed_row["warning"], reversed_row["synced"], reversed_row["drift"]) == (
        1,
        True,
        False,
        0.0,
    )
    assert reversed_row["corrected_cycle_index"] == close(1392.78)
    assert rows[1435]["corrected_cycle_index"] == close(1435 + (2.78 + 1) / 2)
    assert (rows[1790]["beats"], rows[1790]["drift"], rows[1790]["warning"]) == (2, -2500.0, False)


def test_the_warning_shows_a_drift_that_changed_by_more_than_a_fifth() -> None:
    rows = run(beating(2800, 500, 1000, 1599, 2200))
    assert [rows[n]["warning"] for n in (1090, 1689, 2290)] == [False, False, False]
    rows = run(beating(2800, 500, 1000, 1601, 2200))
    assert [rows[n]["warning"] for n in (1690, 1691, 2289, 2290)] == [False, True, True, False]


def test_several_periods_are_averaged() -> None:
    rows = run(beating(2200, 500, 1000, 1600, 2000), periods_for_mean_drift=2)
    assert [rows[n]["drift"] for n in (1090, 1689)] == [0.0, 0.0]
    assert (rows[1690]["drift"], rows[2090]["drift"]) == (close(1e6 / 550), close(1e6 / 500))
    assert since(rows, "synced") > 1690


def test_forced_time_mode_measures_the_drift_and_does_not_use_it() -> None:
    rows = run(beating(1400, 500, 1000), force_time_mode=True)
    assert rows[-1]["corrected_cycle_index"] == 1401.0
    assert (rows[-1]["drift"], rows[-1]["synced"], rows[-1]["state"]) == (2000.0, False, TIME)


def test_two_receiver_cycles_a_datum() -> None:
    """r = 2: odd cycles are half an index on; N = 500 receiver cycles make 4000 ppm."""
    indices = [n // 2 + (n >= 500) + (n >= 1000) for n in range(1400)]
    rows = run(indices, data_cycle_time=2 * T, **UNIFORM)
    c = column(rows, "corrected_cycle_index")
    assert (c[1], rows[1]["correction_time"], rows[2]["correction_time"]) == (0.5, close(T), 0.0)
    assert (rows[1]["equal_data_consecutive"], rows[2]["equal_data_consecutive"]) == (1, 0)
    assert rows[1399]["equal_data_total"] == 700
    assert (rows[589]["beats"], rows[590]["beats"], rows[1090]["drift"]) == (0, 1, 4000.0)
    assert (c[635], c[1180], c[1201]) == (close(317.5 + 0.5), close(592.36), close(600.5 + 2 + 201 / 500))


def test_two_data_a_receiver_cycle() -> None:
    """r = 1/2: c counts data, the correction time is half a receiver cycle for each."""
    indices = [2 * n + (n >= 500) + (n >= 1000) for n in range(1400)]
    rows = run(indices, data_cycle_time=T / 2, **UNIFORM)
    c = column(rows, "corrected_cycle_index")
    assert (c[1], rows[1]["cycle_index_difference"], rows[500]["correction_time"]) == (2.0, 2, close(-T / 2))
    assert (rows[1090]["drift"], c[1180]) == (1000.0, close(2362.36))
    assert since(rows, "synced") < 1156  # half the difference counts


@pytest.mark.parametrize("drift", [1e-3, -1e-3])
def test_the_corrected_index_never_jumps(drift: float) -> None:
    """Beats, a jump of five, a reversal: no step of c differs from 1 by more than a whole blending does."""
    indices = clocks(drift, 0.3, 4000, 0.01, 7)
    back = clocks(-drift, 0.3 + drift * 4000, 4000, 0.01, 8)
    indices += [index + 4000 + 5 for index in back]
    c = column(run(indices), "corrected_cycle_index")
    assert max(abs(b - a - 1) for a, b in pairwise(c)) < 6.5 / 90 + 5e-3


# --- the PHASE estimator ----------------------------------------------------------------------------------------------


def test_the_filter_takes_a_beat_where_it_is_counted() -> None:
    """D = 1 in 91 cycles until 590: the phase was 1 at 499.5, half a cycle more than assumed."""
    rows = run(beating(900, 500), estimator=PHASE)
    assert column(rows[:591], "corrected_cycle_index") == [n + 0.5 for n in range(591)]
    tau = 499.5
    p11 = 1 / 12 + tau**2 * 9e-8 + 2e-15 * tau**3 / 3
    p12 = tau * 9e-8 + 2e-15 * tau**2 / 2
    gain1, gain2 = p11 / (p11 + 2.5e-5), p12 / (p11 + 2.5e-5)
    x, d = 0.5 + gain1 / 2, gain2 / 2
    assert rows[590]["drift"] == pytest.approx(1e6 * d, rel=1e-12)
    j = 0.5 - (x + d * 90.5)
    c = column(rows, "corrected_cycle_index")
    assert c[635] == close(635 + x + d * 135.5 + j / 2)
    assert c[680] == close(680 + x + d * 180.5)
    assert rows[-1]["beats"] == 1
    assert not rows[-1]["synced"]


def test_flicker_is_counted_into_the_date() -> None:
    """Every other cycle of 480 … 519 beyond: the same 499.5 as a clean step at 500."""
    clean, zone = beating(900, 500), beating(900, 520)
    for n in range(480, 520, 2):
        zone[n] += 1
    a, b = run(clean, estimator=PHASE), run(zone, estimator=PHASE)
    assert b[609]["drift"] == 0.0
    assert b[610]["drift"] == a[590]["drift"]


def test_the_phase_stays_inside_the_confirmed_cycle() -> None:
    """After two beats of 2000 ppm the sender keeps step: x̂ stops 0.05 beyond the cycle, and the drift fades."""
    rows = run(beating(4000, 500, 1000), estimator=PHASE)
    assert rows[1400]["drift"] == pytest.approx(2000, rel=5e-3)
    assert rows[-1]["corrected_cycle_index"] == close(3999 + 3.05)
    assert rows[-1]["drift"] == pytest.approx(1e6 * 1.05 / (3999 - 999.5), rel=5e-3)
    assert rows[-1]["synced"]


def test_a_reversal_needs_no_new_start() -> None:
    indices = [index - (n >= 1500) - (n >= 2000) for n, index in enumerate(beating(2400, 500, 1000))]
    rows = run(indices, estimator=PHASE)
    first = since(rows, "synced")
    assert all(column(rows[first:], "synced"))
    assert (rows[-1]["beats"], rows[-1]["warning"]) == (4, False)
    assert rows[-1]["drift"] < 0


def test_a_change_of_several_sets_the_phase_to_the_middle() -> None:
    indices = [n + (4 if n >= 200 else 0) for n in range(500)]
    rows = run(indices, estimator=PHASE)
    c = column(rows, "corrected_cycle_index")
    assert (c[290], c[335], c[380]) == (290.5, 337.5, 384.5)


def test_the_first_quiet_stretch_sets_the_phase_to_its_middle() -> None:
    c = column(run(beating(300, 40), estimator=PHASE), "corrected_cycle_index")
    assert (c[130], c[175], c[220]) == (130.5, 176.0, 221.5)


# --- accuracy ---------------------------------------------------------------------------------------------------------


def clocks(drift: float, phase: float, cycles: int, jitter: float, seed: int) -> list[int]:
    """What a receiver finds at n, when the sender writes index m at (m - phase)/(1 + drift); both are jittered."""
    noise = random.Random(seed)
    indices, m = [], math.floor(phase) - 2
    written = (m + 1 - phase) / (1 + drift) + jitter * noise.gauss(0, 1)
    for n in range(cycles):
        now = n + jitter * noise.gauss(0, 1)
        while written <= now:
            m += 1
            written = (m + 1 - phase) / (1 + drift) + jitter * noise.gauss(0, 1)
        indices.append(m)
    return indices


def recording(kind: Callable[..., Beat | Phase], drift: float, jitter: float, **slopes: float) -> tuple[float, float]:
    """Peak to peak of c against the true index, the largest of |step - 1 - d|, from 91 cycles after the second beat."""
    seed = round(1e6 * drift)
    phase = random.Random(seed).random()
    estimator = kind(PARAMETERS | slopes, Fraction(1))
    steps, errors, synced, before = [], [], 0, 0.0
    for n, index in enumerate(clocks(drift, phase, int(4 / abs(drift)) + 300, jitter, seed)):
        c = float(estimator.cycle(n, index))
        synced += estimator.is_drift_determined
        if synced > 91:
            errors.append(c - n * (1 + drift) - phase)
            steps.append(abs(c - before - 1 - drift))
        before = c
    assert len(errors) > 0.4 / abs(drift)
    return max(errors) - min(errors), max(steps[1:])


@pytest.mark.parametrize("drift", [2e-3, -2e-3, 1e-3, -5e-4])
@pytest.mark.parametrize("jitter", [0.0, 0.01])
def test_the_accuracy_of_the_estimators(drift: float, jitter: float) -> None:
    d = abs(drift)
    spread, step = (0.12, 0.0012) if jitter else (0.0, 0.0)
    peak, uneven = recording(Beat, drift, jitter, **UNIFORM)
    assert peak <= 93 * d + spread
    assert uneven <= 2.1 * d + step
    peak, uneven = recording(Beat, drift, jitter)
    assert peak <= 0.45 + 93 * d + spread
    assert uneven <= 5 * d + (0.002 if jitter else 0.0)
    peak, uneven = recording(Phase, drift, jitter)
    assert peak <= (0.03 if jitter else 0.05)
    assert uneven <= 0.002


@pytest.mark.parametrize(("drift", "behind"), [(1e-3, 0.0), (-1e-3, 1.0)])
def test_where_the_corrected_index_is_for_either_sign(drift: float, behind: float) -> None:
    """BEAT: the sender's index, one less if it is slower, to 0.1 (a beat is seen late). PHASE: the sender's index."""
    indices = clocks(drift, 0.4, 3900, 0.0, 1)
    for kind, late in ((Beat, behind), (Phase, 0.0)):
        estimator = kind(PARAMETERS | UNIFORM, Fraction(1))
        errors = [float(estimator.cycle(n, index)) - n * (1 + drift) - 0.4 for n, index in enumerate(indices)]
        assert all(abs(error + late) < 0.1 for error in errors[2900:])
