/* The noise of an encoder, as noise.py has it. */

static uint64_t noise_mixed(uint64_t state) {
    uint64_t z = (state ^ (state >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Sample n of the noise, in sigma. */
static double noise_sample(int64_t seed, int64_t n) {
    const uint64_t first = ((uint64_t)seed << 32) + 6 * (uint64_t)n;
    uint64_t total = 0;
    for (uint64_t i = 0; i < 6; i++) {
        const uint64_t output = noise_mixed((first + i) * UINT64_C(0x9E3779B97F4A7C15));
        total += (output >> 32) + (output & UINT64_C(0xFFFFFFFF));
    }
    const double sample = (double)total / 4294967296.0 - 6.0;
    return sample < -4.0 ? -4.0 : sample > 4.0 ? 4.0 : sample;
}
