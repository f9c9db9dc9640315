"""A page in a cell of a notebook."""

from html import escape

FRAME = '<iframe srcdoc="{}" style="width: 100%; height: 40rem; border: 0" title="{}"></iframe>'


def frame(page: str, title: str) -> str:
    """The HTML of a frame that shows a page, which keeps its styles and scripts to itself."""
    return FRAME.format(escape(page), escape(title))
