"""Columns as the script of a page takes them: numbers as bytes, texts as places in a list of the different ones."""

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

LONGEST = 160  # letters of a text
MOST_TEXT = 200_000  # letters of all texts of a column together
SEVERAL = 4000  # a column with so many different numbers or more has each number in full


def numbers_packed(values: NDArray[Any]) -> dict[str, Any]:
    """Numbers with all their bits: eight bytes each, or places in a list if there are few different ones."""
    reals = values.astype(float)
    few, places = np.unique(reals.view(np.int64), return_inverse=True)
    if len(few) < min(SEVERAL, len(reals) / 2):
        listed = [value if np.isfinite(value) else None for value in few.view(float).tolist()]
        return {"list": listed, "places": bytes_packed(places, "<u2")}
    return {"data": bytes_packed(reals, "<f8")}


def texts_packed(values: NDArray[Any]) -> dict[str, Any]:
    """Texts as indices in a list of the different ones; the rarest are left out if all together are too long."""
    texts = [str(v).lower() if isinstance(v, (bool, np.bool_)) else _shortened(v) for v in values.tolist()]
    few, counts = np.unique(np.array(texts, object), return_counts=True)
    numbers: dict[str, int] = {"": 0}
    remaining = MOST_TEXT
    for text in few[np.argsort(-counts, kind="stable")].tolist():
        remaining -= len(text)
        if remaining >= 0:
            numbers.setdefault(text, len(numbers))
    indices = np.array([numbers.get(text, 0) for text in texts])
    return {"list": list(numbers), "places": bytes_packed(indices, "<u2" if len(numbers) <= 65536 else "<u4")}


def bytes_packed(values: NDArray[Any], kind: str) -> dict[str, str]:
    """Numbers of a NumPy type as text; what is beyond the type is its greatest number."""
    inside = np.clip(values, np.finfo(kind).min, np.finfo(kind).max) if "f" in kind else values
    return {"kind": kind[1:], "bytes": base64.b64encode(np.ascontiguousarray(inside, kind).tobytes()).decode("ascii")}


def _shortened(text: object) -> str:
    shown = "" if text is None else str(text)
    return shown if len(shown) <= LONGEST else shown[: LONGEST - 2] + " …"
