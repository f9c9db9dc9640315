"""The recording of a line of a minute, as an encoder makes it, that scenarios/CutToLength/recorded_line replays.

Each 10 ms a measuring wheel of 0.01 mm a count gives a position, with noise of 0.01 mm (one sigma). The line starts
from rest, changes its speed, stops for five seconds and goes on; in between the wheel slips: for a second and a half it
turns by a hundredth less than the material moves.

python -m tests.support.scenarios.recorded_line
"""

from tests import ROOT
from tests.oracle.master import stretches
from tests.oracle.numerics.splitmix64 import noise_sample

FILE = ROOT / "scenarios" / "CutToLength" / "recorded_line" / "trace.csv"
ROWS, INTERVAL = 6001, 0.01  # s
RESOLUTION, NOISE, SEED = 0.01, 0.01, 90  # mm
WHEEL = {  # what the wheel turns, in mm and s
    "position": 1234.56,
    "segments": [
        {"duration": 1.0},
        {"duration": 2.5, "acceleration": 160.0},  # to 400 mm/s
        {"duration": 10.0},
        {"duration": 1.0, "acceleration": 100.0},  # to 500 mm/s
        {"duration": 7.0},
        {"duration": 0.05, "acceleration": -100.0},  # it slips
        {"duration": 1.4},
        {"duration": 0.05, "acceleration": 100.0},
        {"duration": 5.0},
        {"duration": 2.0, "acceleration": -250.0},  # to a stop
        {"duration": 5.0},
        {"duration": 2.0, "acceleration": 225.0},  # to 450 mm/s
        {"duration": 12.0},
        {"duration": 1.0, "acceleration": -200.0},  # to 250 mm/s
        {"duration": 15.0},
    ],
}


def recording() -> str:
    """The text of the file."""
    pieces = stretches(WHEEL, ROWS * INTERVAL)
    lines, current = ["time,position"], 0
    for n in range(ROWS):
        t = n * INTERVAL
        while current + 1 < len(pieces) and pieces[current + 1].begin <= t:
            current += 1
        counts = round(pieces[current].at(t).position / RESOLUTION + NOISE / RESOLUTION * noise_sample(SEED, n))
        lines.append(f"{n // 100}.{n % 100:02},{counts // 100}.{counts % 100:02}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(recording(), "utf-8", newline="\n")
