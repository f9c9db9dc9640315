"""Drawings that are made small still show the same."""

from motionsync_fmu.pages.compact import compact


def test_a_path_of_straight_lines_becomes_steps() -> None:
    """The points (1, 2), (3.3, 1.5) and back, then (0.1, 0) to (5, 5), by hand: 3.3 - 1 = 2.3, 1.5 - 2 = -0.5; once the
    path is closed it is at (1, 2) again."""
    drawn = b'<path d="M 1.04 2 \nL 3.26 1.5 \nz\nM 0.1 0 \nL 5 4.96 \n"/>'
    assert compact(drawn) == b'<path d="m1 2 2.3 -0.5zm-0.9 -2 4.9 5"/>'


def test_rounding_does_not_add_up() -> None:
    """A hundred steps of 0.04 end at 4, where they end as drawn."""
    points = "".join(f"L {0.04 * i:.6f} 7 \n" for i in range(1, 101))
    steps = compact(f'<path d="M 0 7 \n{points}"/>'.encode()).decode()
    x = [float(number) for number in steps.partition("m")[2].partition('"')[0].split()[0::2]]
    assert abs(sum(x) - 4.0) < 1e-9


def test_a_curve_becomes_steps_with_a_digit_more() -> None:
    """From (1.04, 2): three points to (4.5, 2.25), a second curve to (5, 5), a line to (6, 5), by hand."""
    drawn = b'<path d="M 1.04 2 \nC 2 2 3.333 2.25 4.5 2.25 \nC 5 3 5 4 5 5 \nL 6 5 \n"/>'
    assert compact(drawn) == b'<path d="m1.04 2c0.96 0 2.29 0.25 3.46 0.25 0.5 0.75 0.5 1.75 0.5 2.75l1 0"/>'


def test_a_quadratic_curve_is_left_as_it_is() -> None:
    assert compact(b'<path d="M 1 2 \nQ 3 4 5 6 \n"/>') == b'<path d="M 1 2 \nQ 3 4 5 6 \n"/>'


def test_a_text_keeps_its_digits() -> None:
    assert compact(b'<text x="1.234">0.025 mm</text>') == b'<text x="1.2">0.025 mm</text>'


def test_what_nobody_sees_is_left_out() -> None:
    drawn = b"""<?xml version="1.0" encoding="utf-8" standalone="no"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN"
"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">
<svg>
 <metadata>
  <a/>
 </metadata>
 <g id="figure.1">
  <rect id="used"/>
  <text transform="rotate(-0 6.8 7)" id="text">a</text>
  <use href="#used" transform="rotate(-90)"/>
 </g>
</svg>
"""
    assert (
        compact(drawn)
        == b'<svg>\n<rect id="used"/>\n<text>a</text>\n<use href="#used" transform="rotate(-90)"/>\n</svg>\n'
    )


def test_a_group_with_a_purpose_is_used() -> None:
    drawn = b'<g id="a">\n<g transform="scale(2)">\n<rect/>\n</g>\n</g>\n'
    assert compact(drawn) == b'<g>\n<g transform="scale(2)">\n<rect/>\n</g>\n</g>\n'
