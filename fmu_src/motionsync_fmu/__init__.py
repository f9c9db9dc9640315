"""From a block to an FMU, and what is done with it: the command line as functions.

    from motionsync_fmu import run

    run("CutToLength/basic_cut", set={"master.velocity": 400.0}).passed

`__init__.pyi` lists the names; each is imported when it is used first.
"""

import lazy_loader

from .about import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
