"""The cosine of an angle in degrees, from + - * / alone: the platforms' C libraries do not agree on its last bits.

Beyond 45 degrees the cosine is the sine of the angle that is missing to 90. Sine and cosine are Taylor polynomials in
u, the angle over 30 degrees. Here u is at most 1.5, where the first term left out is below 3e-18.
"""

S1 = 0.5235987755982989  # sin(pi/6 u) = S1 u + S1_REST u + S3 u^3 + ...; S1 + S1_REST is pi/6 to 33 digits
S1_REST = -5.360408832255455e-17
S3 = -0.023924596203935045
S5 = 0.000327953194428671
S7 = -2.140719769235797e-06
S9 = 8.151256657387584e-09
S11 = -2.0315575399030666e-11
S13 = 3.5702758612702236e-14
S15 = -4.6610066605153045e-17
S17 = 4.697946471622617e-20

C2 = -0.13707783890401887  # cos(pi/6 u) = 1 + C2 u^2 + ...
C4 = 0.003131722319766025
C6 = -2.8619315176067162e-05
C8 = 1.4010978125886703e-07
C10 = -4.2679880053956215e-10
C12 = 8.864342003756149e-13
C14 = -1.335280049649465e-15
C16 = 1.5253108628133308e-18


def cosine(degrees: float) -> float:
    """cos of an angle from -90 to 90 degrees, within 3e-16; 1 at 0, 0.5 at 60 and 0 at 90 exactly."""
    angle = abs(degrees)
    if angle > 45.0:
        return near_sine((90.0 - angle) / 30.0)  # the difference is exact
    return near_cosine(angle / 30.0)


def near_sine(u: float) -> float:
    """sin(pi/6 u) for |u| <= 1.5. The greatest term is added last, after the correction of its factor S1; u = 1 gives
    0.5 exactly."""
    w = u * u
    rest = S3 + w * (S5 + w * (S7 + w * (S9 + w * (S11 + w * (S13 + w * (S15 + w * S17))))))
    return u * S1 + u * (S1_REST + w * rest)


def near_cosine(u: float) -> float:
    """cos(pi/6 u) for |u| <= 1.5; u = 0 gives 1 exactly."""
    w = u * u
    return 1.0 + w * (C2 + w * (C4 + w * (C6 + w * (C8 + w * (C10 + w * (C12 + w * (C14 + w * C16)))))))
