"""SplitMix64 as a function of a counter, and the noise that is made of it.

Steele, Lea, Flood: Fast splittable pseudorandom number generators (OOPSLA 2014), with the constants of Vigna's code.
That generator adds GAMMA to its state and then mixes it: started with the state s, its i-th output, counted from 1, is
`mixed(s + i * GAMMA)`.

Sample n of a seed needs six outputs: those of the states c * GAMMA, c = seed * 2**32 + 6 n ... + 5, without a further
addition. The generator that is started with 0 gives them as its outputs number c; number 0 is 0, the output of the
state 0. Seeds are from 0 to 2**32 - 1; a seed has 2**32 / 6 samples of its own, eight days at 1 kHz, then those of the
next seed follow.
"""

WORD, HALF = 2**64, 2**32
GAMMA = 0x9E3779B97F4A7C15
"""The golden gamma: 2**64 over the golden ratio, made odd."""
GREATEST = 4.0
"""Of a sample of the noise, in sigma."""


def mixed(state: int) -> int:
    """The output, of 64 bits, that belongs to a state, which is taken modulo 2**64."""
    z = state % WORD
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) % WORD
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) % WORD
    return z ^ (z >> 31)


def noise_sample(seed: int, n: int) -> float:
    """Sample n, from 0, of the white noise, in sigma: twelve uniform numbers less 6, at most 4 in magnitude; exact."""
    outputs = [mixed((seed * HALF + 6 * n + i) * GAMMA) for i in range(6)]
    total = sum(output // HALF + output % HALF for output in outputs) - 6 * HALF
    return min(max(total / HALF, -GREATEST), GREATEST)
