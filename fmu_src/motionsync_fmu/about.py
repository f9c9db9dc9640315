"""What package, FMUs and pages state about the project. It is written here only, and hatch_build.py reads it, too."""

__version__ = "0.3.0.dev0"  # with .dev0 (PEP 440) from one release to the next
HOME = "https://github.com/motionsync/motionsync"
REVISION = "main" if ".dev" in __version__ else f"v{__version__}"  # which has the files that pages link to
AUTHORS = "The motionsync authors"
COPYRIGHT = f"Copyright (c) 2026 {AUTHORS}"
