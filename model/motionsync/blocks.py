"""The blocks by their names, which are also those of their FMUs.

A block is imported when it is used: to import all of them takes longer than most commands do.
"""

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cut_to_length.block import CutToLength as CutToLength
    from .flying_saw.block import FlyingSaw as FlyingSaw
    from .follower.block import Follower as Follower
    from .gearing.block import Gearing as Gearing
    from .remote_sync.block import RemoteSync as RemoteSync
    from .rotary_knife.block import RotaryKnife as RotaryKnife
    from .synchronizer.block import Synchronizer as Synchronizer


class Blocks(Mapping[str, type[Any]]):
    """Blocks by their names.

    Attributes:
        modules: the modules of the blocks, as `import_module` takes them.
    """

    def __init__(self, modules: dict[str, str]) -> None:
        self.modules = modules

    def __getitem__(self, name: str) -> type[Any]:
        block: type[Any] = getattr(import_module(self.modules[name], __package__), name)
        return block

    def __contains__(self, name: object) -> bool:
        return name in self.modules

    def __iter__(self) -> Iterator[str]:
        return iter(self.modules)

    def __len__(self) -> int:
        return len(self.modules)


BLOCKS = Blocks(
    {
        "Synchronizer": ".synchronizer.block",
        "FlyingSaw": ".flying_saw.block",
        "Gearing": ".gearing.block",
        "Follower": ".follower.block",
        "RemoteSync": ".remote_sync.block",
        "CutToLength": ".cut_to_length.block",
        "RotaryKnife": ".rotary_knife.block",
    }
)
