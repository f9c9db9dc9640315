"""Data in a page, as text; its script unpacks them (packed.js)."""

import base64
import json
from typing import Any

from deflate import deflate_compress

SMALLEST = 12  # libdeflate's level


def packed(data: bytes) -> str:
    """Base64 of raw deflate (RFC 1951)."""
    return base64.b64encode(deflate_compress(data, SMALLEST)).decode()


def packed_json(data: Any) -> str:
    """The same of data as JSON has them.

    Raises:
        ValueError: a number is not finite.
    """
    return packed(json.dumps(data, separators=(",", ":"), allow_nan=False).encode())
