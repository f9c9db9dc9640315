"""Ramps known by hand, in degrees, rest position 180: the examples of the source text and their mirror images."""

from motionsync.synchronizer.interface import Curve

# law, phasing, whether it is a start, master at the ramp's beginning and end, slave where the master is at 180
RAMP_RESULTS = [
    (Curve.PARABOLA, 90.0, True, 90.0, 270.0, 202.5),
    (Curve.PARABOLA, 90.0, False, 90.0, 270.0, 157.5),
    (Curve.PARABOLA, 180.0, True, 0.0, 360.0, 225.0),
    (Curve.PARABOLA, 180.0, False, 0.0, 360.0, 135.0),
    (Curve.POLYNOMIAL_3_4_5, 90.0, True, 101.25, 270.0, 195.6103111),
    (Curve.POLYNOMIAL_3_4_5, 90.0, False, 90.0, 258.75, 164.3896889),
    (Curve.PARABOLA, -90.0, True, 270.0, 90.0, 157.5),
    (Curve.PARABOLA, -90.0, False, 270.0, 90.0, 202.5),
    (Curve.POLYNOMIAL_3_4_5, -90.0, True, 258.75, 90.0, 164.3896889),
    (Curve.POLYNOMIAL_3_4_5, -90.0, False, 270.0, 101.25, 195.6103111),
]
