"""What package, FMUs and pages state about the project. It is written here only, and hatch_build.py reads it, too."""

__version__ = "0.2.0"
HOME = "https://github.com/motionsync/motionsync"
AUTHORS = "The motionsync authors"
COPYRIGHT = f"Copyright (c) 2026 {AUTHORS}"
