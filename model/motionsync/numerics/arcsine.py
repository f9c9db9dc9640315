"""The arcsine, from + - * / and the square root alone: the platforms' C libraries do not agree on its last bits.

Up to 1/2 it is y + y z P(z) with z = y^2; beyond, the angle is measured from the right angle, pi/2 - 2 arcsin(w) with
w = sqrt((1 - y)/2). P is the polynomial that deviates least from (arcsin(y)/y - 1)/z over 0 <= z <= 1/4, by 2e-17.
"""

from math import sqrt

A3 = 0.16666666666666669
A5 = 0.07499999999998433
A7 = 0.04464285714635543
A9 = 0.030381944138531247
A11 = 0.02237217294214989
A13 = 0.017352392720869973
A15 = 0.013971212973552933
A17 = 0.011479177415184906
A19 = 0.01032281435018578
A21 = 0.005457506718640358
A23 = 0.01740087944269402
A25 = -0.014851887071247204
A27 = 0.028757851367421566

RIGHT_ANGLE = 1.5707963267948966  # RIGHT_ANGLE + RIGHT_ANGLE_REST is pi/2 to 33 digits
RIGHT_ANGLE_REST = 6.123233995736766e-17
SPLITTER = 134217729.0  # 2^27 + 1: the product with it splits off the upper half of a number's bits (Dekker)


def arcsine(y: float) -> float:
    """arcsin of a number from -1 to 1, in rad, within 2e-16 of its magnitude."""
    if abs(y) <= 0.5:
        return y + y * relative_excess(y * y)
    angle = near_right_angle(0.5 * (1.0 - abs(y)))  # the difference is exact
    return -angle if y < 0.0 else angle


def near_right_angle(z: float) -> float:
    """pi/2 - 2 arcsin(sqrt(z)) for 0 <= z < 1/4. The root is the sum of its upper bits and of a rest that its rounding
    does not spoil: pi/2 less twice the upper bits is exact."""
    root = sqrt(z)
    upper = SPLITTER * root - (SPLITTER * root - root)
    rest = (z - upper * upper) / (root + upper) if z > 0.0 else 0.0
    return (RIGHT_ANGLE - 2.0 * upper) + (RIGHT_ANGLE_REST - 2.0 * (rest + root * relative_excess(z)))


def relative_excess(z: float) -> float:
    """arcsin(y)/y - 1 for 0 <= z = y^2 <= 1/4."""
    upper = A15 + z * (A17 + z * (A19 + z * (A21 + z * (A23 + z * (A25 + z * A27)))))
    return z * (A3 + z * (A5 + z * (A7 + z * (A9 + z * (A11 + z * (A13 + z * upper))))))
