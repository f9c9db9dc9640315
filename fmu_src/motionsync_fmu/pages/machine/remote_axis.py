"""The picture of an axis on another controller: where it truly is, where the telegram says, where the block says."""

from typing import Any

import numpy as np

from ...scenario.telegrams import Remote, errors
from .run import FINENESS, Run
from .signals import held, smooth

USUAL = 0.98  # the share of the errors that the window shows
ROOM = 1.6  # the half width of the window, as a multiple of the greatest usual error
LEAST = 1e-9  # of the axis' travel: the least half width
EXACT, COARSE = 10, 4  # digits of positions, and of errors


def remote_axis(run: Run, remote: Remote) -> dict[str, Any]:
    """The window that moves with the true axis; in it, how far telegram and slave are from the truth."""
    found = errors(remote, run.recording)
    usual = float(np.quantile(np.abs(found.position), USUAL))
    half = ROOM * max(usual, LEAST * float(np.ptp(run.recording.master[:, 0])), 1e-9)
    time, master = run.recording.time, run.recording.master
    true, within = smooth(time, master[:, 0], master[:, 1], FINENESS * half)
    return run.common(2.0 * half) | {
        "scene": "window",
        "half": half,
        "within": within,
        "true": true,
        "slave": held(time, run.values("slave.position"), EXACT),
        "telegram": held(found.time, found.position, COARSE),
        "corrected": held(found.time, found.corrected_position, COARSE),
        "telegram_index": held(found.time, found.index, COARSE),
        "corrected_index": held(found.time, found.corrected_index, COARSE),
    }
