"""Makes drawings small, so that an FMU stays small: what is invisible is removed."""

import re

TAG = re.compile(rb"<[^>]*>")  # with the coordinates; between tags are texts, whose numbers stay
NUMBER = re.compile(rb"-?\d+\.\d{2,}")
PATH = re.compile(rb' d="((?:[ML] \S+ \S+ \n|C(?: \S+){6} \n|z\n)+)"')  # of straight lines and cubic curves
SEGMENT = re.compile(rb"([MLCz])((?: \S+)*)")
CURVE = b"\nC "  # in a tag whose path has curves: they get a digit more, so that they join without corners


def compact(drawing: bytes) -> bytes:
    """Matplotlib's drawing with coordinates to a tenth of a point, of curves to a hundredth, each relative to the point
    before it.

    Metadata, indentation, groups without a purpose, names that nothing refers to and rotations by 0 are left out."""
    text = TAG.sub(_rounded, drawing)
    text = re.sub(rb"\s*<metadata>.*?</metadata>|<\?xml.*?>\s*|<!DOCTYPE.*?>\s*", b"", text, flags=re.S)
    text = re.sub(rb' transform="rotate\(-?0 [^)]*\)"', b"", text)
    used = set(re.findall(rb"#(\w+)", text))
    text = re.sub(rb' id="([^"]*)"', lambda name: name[0] if name[1] in used else b"", text)
    text = re.sub(rb"\n\s+", b"\n", text)
    if b"<g " not in text:
        text = re.sub(rb"</?g>\n", b"", text)
    return PATH.sub(lambda path: b' d="' + _relative(path[1]) + b'"', text)


def _rounded(tag: re.Match[bytes]) -> bytes:
    digits = 2 if CURVE in tag[0] else 1
    return NUMBER.sub(lambda number: b"%g" % round(float(number[0]), digits), tag[0])


def _relative(path: bytes) -> bytes:
    """A path of straight lines and cubic curves: its start, then the steps from each point to the next."""
    at = start = (0.0, 0.0)
    steps, before = [], b""
    for command, coordinates in SEGMENT.findall(path):
        if command == b"z":
            steps.append(b"z")
            at, before = start, command
            continue
        numbers = [float(x) for x in coordinates.split()]
        moved = b" ".join(b"%g" % round(x - at[i % 2], 2) for i, x in enumerate(numbers))
        letter = {b"M": b"m", b"L": b"l", b"C": b"c"}[command]
        continued = letter == before or (letter == b"l" and before == b"m")  # what follows a start is a line
        steps.append((b" " if continued else letter) + moved)
        at, before = (numbers[-2], numbers[-1]), letter
        start = at if command == b"M" else start
    return b"".join(steps)
