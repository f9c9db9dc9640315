"""Runs a FlyingSaw along a script as its oracle takes it."""

from collections.abc import Sequence
from typing import Any

from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.interface.stepper import Stepper
from tests.support.harness import Row


def along(script: dict[str, Any], times: Sequence[float], names: Sequence[str]) -> dict[float, Row]:
    """The block's variables of these names at these times; steps end there, at what is set, and at the master's
    segments."""
    stepper = Stepper(FlyingSaw())
    master_position, speed, begin, segments = 0.0, script["master"]["velocity"], 0.0, []
    for segment in script["master"]["segments"]:
        segments.append((begin, master_position, speed, segment["acceleration"]))
        t, begin = segment["duration"], begin + segment["duration"]
        master_position, speed = (
            master_position + (speed + 0.5 * segment["acceleration"] * t) * t,
            speed + segment["acceleration"] * t,
        )
    segments.append((begin, master_position, speed, 0.0))

    def master(time: float) -> dict[str, float]:
        first, p, v, a = [s for s in segments if s[0] <= time + 1e-12][-1]
        t = time - first
        return dict(
            zip(
                ("master.position", "master.velocity", "master.acceleration"),
                (p + (v + 0.5 * a * t) * t, v + a * t, a),
                strict=True,
            )
        )

    sets = {table["at"]: {n: x for n, x in table.items() if n != "at"} for table in script["set"]}
    stepper.initialize({**script["start"], **master(0.0)})
    ends = sorted({*times, *sets, *(s[0] for s in segments if 0.0 < s[0] < times[-1])})
    result: dict[float, Row] = {}
    now = 0.0
    for end in ends:
        if end > times[-1]:
            break
        stepper.step(end - now, {**master(now), **sets.get(now, {})})
        now = end
        if end in times:
            result[end] = stepper.get(names)
    return result
