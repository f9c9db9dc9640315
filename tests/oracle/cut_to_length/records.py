"""What a saw that runs with its material records, beside what every machine that cuts to length does."""

from collections.abc import Mapping
from typing import Any

from tests.oracle.cut_to_length.limits import Saw
from tests.oracle.cut_to_length.parameters import RANGES
from tests.oracle.cutting.records import PieceRecords

STROKE, TOOL_TIMEOUT = 17, 19


class SawRecords(PieceRecords):
    warnings_of_piece = ("gap_skipped", "change_pending")

    def __init__(self, inputs: Mapping[str, Any]) -> None:
        super().__init__(inputs, RANGES)
        self.warnings["blade_early"] = False

    def saw(self) -> Saw:
        return Saw.of(self.inputs, self.calibration)
