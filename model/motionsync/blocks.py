"""The blocks by their names, which are also those of their FMUs."""

from collections.abc import Mapping
from typing import Any

from .cut_to_length.block import CutToLength as CutToLength
from .flying_saw.block import FlyingSaw as FlyingSaw
from .follower.block import Follower as Follower
from .gearing.block import Gearing as Gearing
from .remote_sync.block import RemoteSync as RemoteSync
from .rotary_knife.block import RotaryKnife as RotaryKnife
from .synchronizer.block import Synchronizer as Synchronizer

BLOCKS: Mapping[str, type[Any]] = {
    "Synchronizer": Synchronizer,
    "FlyingSaw": FlyingSaw,
    "Gearing": Gearing,
    "Follower": Follower,
    "RemoteSync": RemoteSync,
    "CutToLength": CutToLength,
    "RotaryKnife": RotaryKnife,
}
