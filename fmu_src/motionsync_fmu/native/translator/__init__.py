"""A block as readable C99: the kernel subset, translated with its names, comments and docstrings."""

from .program import c_source

__all__ = ["c_source"]
