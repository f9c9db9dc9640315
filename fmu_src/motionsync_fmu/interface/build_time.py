"""The build's time, if the environment gives one: the same sources then give the same bytes."""

import os

from ..errors import UserError

FIRST_INSTANT = 315532800  # s since 1970, the first that a zip file can hold


def build_time() -> int | None:
    """The build's time in s since 1970, from SOURCE_DATE_EPOCH; None if it is not set.

    Raises:
        UserError: SOURCE_DATE_EPOCH is no such time.
    """
    text = os.environ.get("SOURCE_DATE_EPOCH")
    if not text:
        return None
    if not text.isdecimal() or len(text) > 10 or int(text) > 4354819198:  # the last instant a zip file can hold
        raise UserError(f"SOURCE_DATE_EPOCH = {text} is not allowed: it must be whole seconds from 0 to 4354819198")
    return max(int(text), FIRST_INSTANT)
