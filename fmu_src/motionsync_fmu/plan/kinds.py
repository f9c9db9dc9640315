"""The kinds of machines that can be planned."""

from collections.abc import Mapping

from .knife import Knife
from .machine import Machine
from .saw import Saw

KINDS: Mapping[str, type[Machine]] = {kind.kind: kind for kind in (Saw, Knife)}
BLOCKS: Mapping[str, type[Machine]] = {kind.block: kind for kind in KINDS.values()}
BOTH = "both"
