/* What an encoder makes of a true position: scale, runout, noise, resolution. What is here follows scenario/encoder.py and
 * motionsync/cosine.py, operation by operation, so that the bits are the same. */
#ifndef ENCODER_H
#define ENCODER_H

#include <math.h>
#include <stdint.h>

#define SAMPLE_ROUNDING 1e-9 /* of the interval of samples: a time that is before a sample by less has it already */

typedef struct {
    double resolution, noise, delay, scale, amplitude, length; /* amplitude and length: of the runout */
    double sample_time, interval; /* of the samples: sample_time, or else the step size */
    int64_t seed;
    double initial_position, initial_velocity, initial_acceleration; /* of the line before time 0 */
    double start_velocity, start_acceleration; /* inputs of the block with sample 0 */
    int64_t number; /* of the latest sample; -1: there is none yet */
    double latest, former; /* the latest two samples */
} Encoder;

static uint64_t mixed(uint64_t state) {
    uint64_t z = (state ^ (state >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Sample n of the noise, in sigma. */
static double noise_sample(int64_t seed, int64_t n) {
    const uint64_t first = ((uint64_t)seed << 32) + 6 * (uint64_t)n;
    uint64_t total = 0;
    for (uint64_t i = 0; i < 6; i++) {
        const uint64_t output = mixed((first + i) * UINT64_C(0x9E3779B97F4A7C15));
        total += (output >> 32) + (output & UINT64_C(0xFFFFFFFF));
    }
    const double sample = (double)total / 4294967296.0 - 6.0;
    return sample < -4.0 ? -4.0 : sample > 4.0 ? 4.0 : sample;
}

/* sin(pi/6 u) for |u| <= 1.5 */
static double near_sine(double u) {
    const double w = u * u;
    const double rest = -0.023924596203935045 + w * (0.000327953194428671 + w * (-2.140719769235797e-06 + w * (8.151256657387584e-09 + w * (-2.0315575399030666e-11 + w * (3.5702758612702236e-14 + w * (-4.6610066605153045e-17 + w * 4.697946471622617e-20))))));
    return u * 0.5235987755982989 + u * (-5.360408832255455e-17 + w * rest);
}

/* cos(pi/6 u) for |u| <= 1.5 */
static double near_cosine(double u) {
    const double w = u * u;
    return 1.0 + w * (-0.13707783890401887 + w * (0.003131722319766025 + w * (-2.8619315176067162e-05 + w * (1.4010978125886703e-07 + w * (-4.2679880053956215e-10 + w * (8.864342003756149e-13 + w * (-1.335280049649465e-15 + w * 1.5253108628133308e-18)))))));
}

/* sin(2 pi turns) */
static double sine_of_turns(double turns) {
    const double part = turns - floor(turns + 0.5), angle = fabs(360.0 * fabs(part) - 90.0);
    const double magnitude = angle > 45.0 ? near_sine((90.0 - angle) / 30.0) : near_cosine(angle / 30.0);
    return part > 0.0 ? magnitude : -magnitude;
}

/* What is measured of a true position, with the noise of sample n. */
static double measured(const Encoder *e, double true_position, int64_t n) {
    double x = true_position * e->scale;
    if (e->amplitude != 0.0) x += e->amplitude * sine_of_turns(true_position / e->length);
    if (e->noise != 0.0) x += e->noise * noise_sample(e->seed, n);
    return e->resolution != 0.0 ? floor(x / e->resolution) * e->resolution : x;
}

#endif
