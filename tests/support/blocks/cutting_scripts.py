"""Scripts of a line with commands for a machine that cuts to length, and the run of such a machine along one."""

from collections.abc import Collection, Iterable
from random import Random
from typing import Any

from motionsync.master import MasterInput
from motionsync.var import Block
from tests.oracle.cut_to_length.carriage import MasterSection
from tests.oracle.master import stretches
from tests.oracle.numerics import mp
from tests.support.blocks import oracle_runs
from tests.support.blocks.harness import Row
from tests.support.blocks.oracle_runs import Feed, Script, corners

LEAST_SPEED = 1e-3


def simulate(
    block: Block,
    script: Script,
    ends: Iterable[float],
    names: Collection[str],
    at_velocity: Collection[str],
    mode: MasterInput,
    stride: int,
) -> list[Row]:
    """A new block's outputs at the end of each step, or of each `stride`-th one.

    `at_velocity`: what jumps where the line comes to rest, since rounding of the velocity decides; left out there.
    """
    feed, fixed = Feed(script, MasterInput.START_OF_STEP), corners(script)
    rows = []
    for row in oracle_runs.simulate(block, script, ends, names, mode=mode, stride=stride):
        is_at_rest = abs(feed.inputs(row["time"], after=False)["master.velocity"]) <= LEAST_SPEED
        if not is_at_rest:
            rows.append(row)
        elif row["time"] not in fixed:
            rows.append({name: value for name, value in row.items() if name not in at_velocity})
    return rows


def random_line(r: Random, duration: float, *, jumps: bool = True) -> dict[str, Any]:
    """A line that speeds up, brakes, rests, jumps and now and then reverses; a stop is exact, in binary fractions."""
    speed = r.choice([0.0, *[float(r.randint(300, 1300))] * 3])
    segments: list[dict[str, float]] = []
    now, total = speed, 0.0
    while total < duration:
        segment = {"duration": r.randint(12, 192) / 128.0}
        kinds = ["steady", "steady", "ramp", "ramp", "ramp", "stop"] + ["jump"] * jumps + ["back"] * (now > 0.0)
        match r.choice(kinds) if now > 0.0 else "ramp":
            case "ramp":
                change = r.uniform(200.0, 1300.0) - now
                segment["acceleration"] = round(16.0 * change / segment["duration"]) / 16.0
            case "stop":
                segment = {"duration": r.choice([0.25, 0.5, 1.0])}
                segment["acceleration"] = -now / segment["duration"]
            case "back":
                segment["acceleration"] = -16.0 * round((now + r.uniform(20.0, 300.0)) / segment["duration"] / 16.0)
            case "jump":
                segment["velocity"] = now = max(now + r.randint(-200, 200), 0.0)
        segments.append(segment)
        now += segment.get("acceleration", 0.0) * segment["duration"]
        if now < 0.0:  # it does not go back for long, and does not rest then: rounding would decide
            segments.append({"duration": 0.25, "acceleration": (256.0 - now) / 0.25})
            now = 256.0
        if now == 0.0 and r.random() < 0.7:  # nor rests for long
            segments.append({"duration": 0.25})
        total = sum(part["duration"] for part in segments)
    return {"position": r.uniform(-500.0, 5000.0), "velocity": speed, "segments": segments}


def random_marks(
    r: Random, start: dict[str, Any], master: dict[str, Any], duration: float, *, windows: bool
) -> list[dict[str, Any]]:
    """Edges of a sensor that sees a mark on each `spacing` of the material, or nearly so; values for the machine."""
    spacing = r.uniform(300.0, 1500.0)
    start |= {
        "source": 2,
        "mark.latched": r.random() < 0.6,
        "mark.delay": r.choice([0.0, 0.004]),
        "mark.sensor_distance": r.uniform(600.0, 2500.0),
        "mark.cut_offset": r.uniform(-50.0, 50.0),
        "mark.spacing": r.choice([0.0, spacing, spacing]),
        "mark.window": r.choice([0.0, 30.0]) if windows else 0.0,
        "mark.every": r.choice([1, 1, 2]),
        "mark.max_missing": r.choice([0, 1, 3]),
        "mark.substitute": r.random() < 0.6,
    }
    sections = [MasterSection.of(part, 0.0) for part in stretches(master, mp.mpf(duration))[1:]]
    position = master["position"] + r.uniform(0.0, spacing)
    sets: list[dict[str, Any]] = []
    for section in sections:
        while section.direction > 0 and section.at(section.end).position > position:
            passed = section.passes(position, 1, section.begin, section.end)
            time = round((passed or section.begin) + 1.5e-3, 4)
            if r.random() < 0.9:
                period = start["master.period"]
                latched = position % period if period else position
                sets.append({"at": time, "mark.detected": True, "mark.position": latched})
                sets.append({"at": round(time + 0.0063, 4), "mark.detected": False})
            position += (spacing + r.choice([0.0, r.uniform(-5.0, 5.0), r.uniform(-60.0, 60.0)])) / start[
                "material_factor"
            ]
    return sets
