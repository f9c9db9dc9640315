"""The noise of an encoder: a generator whose numbers depend on the seed and the number of the sample alone.

Sources: Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014 (SplitMix64), of whose outputs
each gives two uniform numbers; twelve of them less 6 are nearly Gaussian. It needs products of 64 bits without a sign,
which the kernel subset does not have: `noise.h` is the same by hand."""

GAMMA = 0x9E3779B97F4A7C15  # 2^64 over the golden ratio, made odd
MASK = 2**64 - 1
GREATEST = 4.0  # sigma


def sample(seed: int, n: int) -> float:
    """Sample n of the noise, from 0, in sigma, within 4; `seed`: 0 to 2^32 - 1."""
    total = 0
    for i in range(6 * n, 6 * n + 6):
        z = ((seed << 32) + i) * GAMMA & MASK
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & MASK
        z = (z ^ z >> 27) * 0x94D049BB133111EB & MASK
        z ^= z >> 31
        total += (z >> 32) + (z & 0xFFFFFFFF)
    return min(max(total / 2.0**32 - 6.0, -GREATEST), GREATEST)
