"""A machine that cuts to length behind a fieldbus: 200 cuts, their lengths on the material, the reserve they need."""

import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest

from motionsync.cutting.interface import PieceKind
from motionsync_fmu.errors import UserError
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.interface.roles import MOTION
from motionsync_fmu.production_line.line import ProductionLine
from motionsync_fmu.production_line.package import LinePackage, write_package
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.production_line.runs import Inputs, Values, run_alone
from motionsync_fmu.production_line.variants import (
    RAW,
    Variant,
    raw_axis,
    run_through_remote_sync,
    true_axis,
    variant_of,
)
from motionsync_fmu.scenario.recording import Reals, Recording
from tests.line.conftest import Examined
from tests.support.scenarios.lines import MACHINE, integrated, replaced

CYCLE, LENGTH, KERF, TOLERANCE = 0.004, 300.0, 4.0, 0.05  # of line_cut_to_length.toml
SSP = {
    part: f"http://ssp-standard.org/SSP1/SystemStructure{name}"
    for part, name in (("ssd", "Description"), ("ssc", "Common"))
}
MATERIAL = [
    (0.5, 0.0),
    (2.0, 250.0),
    (37.5, 0.0),
    (1.0, -100.0),
    (29.0, 0.0),
    (2.0, 65.0),
    (38.0, 0.0),
    (2.0, -40.0),
]


@dataclass(frozen=True)
class WholeRun:
    """The run of all 200 cuts: RemoteSync alone, then the machine alone. Another test shows that a parallel
    co-simulation gives the same."""

    line: ProductionLine
    package: LinePackage
    remote: Values
    variant: Variant

    def skipped(self, axis: Inputs, reserve: float) -> tuple[int, int]:
        """How many cuts are made, and how many left out, by a machine with this reserve whose master is this axis."""
        start = {"approach.reserve": reserve}
        values = run_alone(self.line, self.package, "CutToLength", {**axis, **self.line.commands}, start)
        return int(values["statistics.cuts"][-1]), int(values["statistics.skipped"][-1])


@pytest.fixture(scope="module")
def whole(output: Path) -> WholeRun:
    line = load_line(MACHINE)
    package = write_package(line, Flavour.NATIVE, output, pytest.fail)
    remote, values = run_through_remote_sync(line, package)
    return WholeRun(line, package, remote, variant_of(line, "RemoteSync", values, values, remote))


def find_cut_positions(recording: Recording, script: list[tuple[float, float]]) -> Reals:
    """The position of each cut on the material, from script and carriage alone: the mean while it cuts."""
    cutting = recording.values["tool.cutting"] != 0.0
    edges = np.flatnonzero(np.diff(cutting, prepend=False, append=False))
    positions = [integrated(script, t) for t in recording.time.tolist()] - recording.values["slave.position"]
    return np.array([positions[i:j].mean() for i, j in zip(edges[::2], edges[1::2], strict=True)])


# --- 200 cuts ---


def test_200_cuts_are_made_and_none_is_missed(whole: WholeRun) -> None:
    values = whole.variant.recording.values
    assert len(whole.variant.pieces) == 200
    assert [int(values[f"statistics.{name}"][-1]) for name in ("cuts", "skipped", "late")] == [200, 0, 0]
    assert whole.variant.missed.sum() == 0.0
    assert not values["error"].any()
    assert not values["warning.any"].any()


def test_recorded_lengths_are_exact_and_the_material_is_cut_within_what_telegrams_allow(whole: WholeRun) -> None:
    """The block's own lengths are exact on the axis that it sees; that axis is within 0.03 cycles, peak to peak, of the
    true one: 0.06 mm at 530 mm/s. Within a piece the estimate hardly changes."""
    assert [x.number for x in whole.variant.products] == list(range(2, 201))
    assert {x.place for x in whole.variant.products} == {LENGTH}
    assert max(abs(x.recorded or 0.0) for x in whole.variant.products) < 1e-10
    worst = max(abs(x.error) for x in whole.variant.products)
    assert 1e-3 < worst < 0.02


def test_the_lengths_are_those_on_the_material(whole: WholeRun) -> None:
    """Computed independently, from the script and the carriage alone."""
    pitches = np.diff(find_cut_positions(whole.variant.recording, MATERIAL))
    assert len(pitches) == 199
    assert [x.error for x in whole.variant.products] == pytest.approx((pitches - KERF - LENGTH).tolist(), abs=1e-8)


# --- the reserve ---


def test_with_remote_sync_hardly_any_reserve_is_needed(whole: WholeRun) -> None:
    """The estimate jumps by some thousandths of a millimetre at most, while the material travels 1.6 mm and more in a
    step: hardly a start is skipped, which without a reserve would be a late cut."""
    axis = {f"master.{n}": np.concatenate([[0.0], whole.remote[f"slave.{n}"][:-1]]) for n in MOTION}
    assert whole.skipped(axis, 0.0) == (200, 0)


def test_raw_telegrams_need_the_reserve_of_a_cycle(whole: WholeRun) -> None:
    """A telegram that skips an index jumps by a cycle's travel: at 400 to 530 mm/s by 1.6 to 2.12 mm. The approach is
    lead = sqrt(1.5 v^3 / 200000), 21.9 to 33.4 mm; a reserve r makes it ((1 + r)^1.5 - 1) lead longer. That is 1.67 to
    2.54 mm with r = 0.05, but 0.66 to 1.01 mm with 0.02."""
    for v in (400.0, 530.0):
        lead = (1.5 * v**3 / 200000.0) ** 0.5
        assert (1.02**1.5 - 1.0) * lead < v * CYCLE < (1.05**1.5 - 1.0) * lead
    made = {reserve: whole.skipped(raw_axis(whole.line), reserve) for reserve in (0.02, 0.05)}
    assert made == {0.02: (199, 1), 0.05: (200, 0)}


# --- checks of a machine ---


def test_a_machine_is_checked_by_its_pieces(machine: Examined) -> None:
    """The first seven cuts, through the SSP package."""
    result = machine.result
    assert [c.text for c in result.checks if not c.passed] == []
    messages = [c.text for c in result.checks]
    assert "number of cuts = 7: found 7" in messages
    assert "no cut left out or late: found 0" in messages
    (true, recorded) = (text for text in messages if text.startswith("products within 0.05 mm of their ordered length"))
    assert "on the true axis, once in sync: found at most 0.0" in true
    assert true.endswith("away in 6 products")
    assert "as recorded, once in sync: found at most" in recorded
    wired, raw = result.after[:2]
    assert (wired.cuts, wired.missed, wired.recorded) == (7, 0, pytest.approx(0.0, abs=1e-10))
    assert wired.worst is not None
    assert raw.worst is not None
    assert wired.worst < TOLERANCE < raw.worst


def test_lengths_are_measured_on_the_true_axis_in_each_variant(machine: Examined) -> None:
    """Against the script and the carriage alone. A machine that sees raw telegrams records no errors."""
    for variant in machine.result.variants:
        pitches = np.diff(find_cut_positions(variant.recording, MATERIAL[:2]))
        assert [x.error for x in variant.products] == pytest.approx((pitches - KERF - LENGTH).tolist(), abs=1e-8)
    raw = machine.variant(RAW)
    assert max(abs(x.recorded or 0.0) for x in raw.products) < 1e-10
    assert max(abs(x.error) for x in raw.products) > 0.1


def test_a_missed_cut_is_counted_and_its_piece_is_no_product(machine: Examined) -> None:
    """Pieces of 200 mm and a kerf of 4 mm need a cut each 0.408 s; the machine's cycle takes 0.539 s."""
    line, axis = machine.line, true_axis(machine.line)
    values = run_alone(line, machine.package, "CutToLength", {**axis, **line.commands}, {"length": 200.0})
    variant = variant_of(line, "too short", values, values, None)
    assert {p.name for p in variant.pieces[1:]} == {"MERGED"}
    assert int(variant.missed.sum()) == len(variant.pieces) - 1
    assert variant.products == []


def test_enumerations_are_declared_in_the_package(machine: Examined) -> None:
    """The kind of a piece: SSP 1.0 requires each enumeration of a connector among those of the system."""
    with zipfile.ZipFile(machine.package.ssp) as z:
        structure = fromstring(z.read("SystemStructure.ssd"))
    declared = structure.findall("ssd:Enumerations/ssc:Enumeration", SSP)
    kinds = {m.name: str(int(m)) for m in PieceKind}
    assert {e.get("name"): {i.get("name"): i.get("value") for i in e} for e in declared} == {
        "CutToLength.PieceKind": kinds
    }
    used = {e.get("name") for e in structure.iterfind(".//ssd:Connector/ssc:Enumeration", SSP)}
    assert used == {"CutToLength.PieceKind"}


MISTAKES = {  # the old text, the new text, the message
    "marks": ("tolerance = 0.05", "length = 304.0", "length: is not needed: CutToLength itself reports where it cuts"),
    "lengths": (
        "tolerance = 0.05",
        "lengths = [300.0]",
        "lengths: in a line each product is compared with its ordered",
    ),
    "kinds": ("tolerance = 0.05", 'kinds = ["PRODUCT"]', "kinds: in a line each product is compared with its ordered"),
    "skipped": ("tolerance = 0.05", "skipped = 1", "skipped: 1 is not allowed: in a line no cut may be skipped"),
    "the kind": ("error = { max = 0.0 }", '"last.kind" = { max = 1 }', "last.kind: is an enumeration"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, message = MISTAKES[name]
    file = tmp_path / MACHINE.name
    file.write_text(replaced(MACHINE.read_text(), (old, new)))
    number = 1 + file.read_text().splitlines().index(new)
    with pytest.raises(UserError) as e:
        load_line(file)
    assert str(e.value).startswith(f"{file}:{number}: ")
    assert message in str(e.value)
