"""The picture of an axis on another controller: where it truly is, where by the telegram, where by the block."""

from typing import Any

import numpy as np

from ...scenario.evaluate.remote_errors import remote_errors
from ...scenario.remote_view import RemoteView
from .run import FINENESS, Run
from .signals import held, smooth

USUAL = 0.98  # the share of the errors that the window shows
MARGIN = 1.6  # the half width of the window, as a multiple of the greatest usual error
LEAST = 1e-9  # of the axis' travel: the least half width
EXACT, COARSE = 10, 4  # digits of positions, and of errors


def remote_axis(run: Run, remote: RemoteView) -> dict[str, Any]:
    """The window that moves with the true axis; in it, how far telegram and slave are from the truth."""
    errors_of_run = remote_errors(remote, run.recording)
    usual = float(np.quantile(np.abs(errors_of_run.position), USUAL))
    half = MARGIN * max(usual, LEAST * float(np.ptp(run.recording.master[:, 0])), 1e-9)
    time, master = run.recording.time, run.recording.master
    true, within = smooth(time, master[:, 0], master[:, 1], FINENESS * half)
    return run.common(2.0 * half) | {
        "scene": "window",
        "half": half,
        "within": within,
        "true": true,
        "slave": held(time, run.values("slave.position"), EXACT),
        "telegram": held(errors_of_run.time, errors_of_run.position, COARSE),
        "corrected": held(errors_of_run.time, errors_of_run.corrected_position, COARSE),
        "telegram_index": held(errors_of_run.time, errors_of_run.index, COARSE),
        "corrected_index": held(errors_of_run.time, errors_of_run.corrected_index, COARSE),
    }
