"""A block's README.md as part of the page in its FMU."""

from collections.abc import Iterator
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token
from markupsafe import Markup

from ..errors import UserError
from ..interface.block_folder import block_file
from .state_diagram import draw_diagram

FILE = "README.md"
FIGURE = Markup('<figure>\n<img src="{file}" alt="{title}">\n<figcaption>{caption}</figcaption>\n</figure>\n')
ELSEWHERE = ("http://", "https://")  # how a link starts that works inside an FMU


def read_readme(block_type: type[Any]) -> str:
    """Read the README.md in the folder of a block.

    Raises:
        UserError: it is missing.
    """
    file = block_file(block_type, FILE)
    try:
        return file.read_text("utf-8")
    except OSError as e:
        raise UserError(f"{file}: cannot be read: {e}: a block's README.md is part of its page") from None


def render_readme(text: str, picture: str, title: str) -> Markup:
    """Render a README as HTML below a page's own title.

    The title of the README is left out; the page's own `picture`, a file next to the page with the alternative text
    `title`, replaces the README's picture and has its caption; the state diagram is drawn; links to files outside the
    FMU become plain text.
    """
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = list(_adapt(markdown.parse(text), picture, title))
    return Markup(markdown.renderer.render(tokens, markdown.options, {}))


def _adapt(tokens: list[Token], picture: str, title: str) -> Iterator[Token]:
    """The README's tokens as the page needs them."""
    for before, token, after in zip([None, *tokens], tokens, [*tokens[1:], None], strict=False):
        if token.tag == "h1" or (before and before.tag == "h1" and before.nesting == 1):
            continue  # the title
        if _is_picture(before) or _is_picture(after):
            continue  # the ends of the paragraph that holds nothing but the picture
        if _is_picture(token):
            caption = token.children[0].content if token.children else ""
            yield _html(FIGURE.format(file=picture, title=title, caption=caption))
        elif token.type == "fence" and token.info.strip() == "mermaid":
            yield _html(draw_diagram(token.content))
        else:
            if token.children:
                token.children = list(_without_links(token.children))
            yield token


def _is_picture(token: Token | None) -> bool:
    return bool(token and token.children and [child.type for child in token.children] == ["image"])


def _without_links(tokens: list[Token]) -> Iterator[Token]:
    """The tokens, with all links but those to the network as plain text."""
    is_link_valid = True
    for token in tokens:
        if token.type == "link_open":
            is_link_valid = str(token.attrGet("href")).startswith(ELSEWHERE)
        if is_link_valid or token.type not in ("link_open", "link_close"):
            yield token


def _html(text: Markup) -> Token:
    return Token("html_block", "", 0, content=str(text))
