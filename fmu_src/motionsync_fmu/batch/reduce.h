/* Figures of a run, updated while it runs, so that the values of all steps need not be stored.
 *
 * The values at the ends of some steps are collected as samples, then reduced together: so a measure costs less than
 * another output would. What is stored of an instance is in columns: a column is the address of a double, and instance i
 * has the i-th one from there on. reductions.py makes the tables and the columns, and explains the figures. */
#ifndef REDUCE_H
#define REDUCE_H

#include "block_memory.h"

enum { SAMPLES = 256 }; /* of a row; reductions.py has the same number */
enum { TIMES, LENGTHS, FIRST_VALUES }; /* the first rows */

typedef struct { /* rows of SAMPLES numbers: the times, the lengths of the steps, and the values of each variable */
    double *rows;
    int64_t count; /* of the samples that are collected */
    double elapsed; /* the sum of all lengths */
} Samples;

typedef struct { /* what is stored of the values in a row: the column for it, and a second one for some figures */
    int64_t row, column, second;
    double limit;
} Figure;

typedef struct { /* each n-th of the values in a row: the array for them, and columns that count steps and values */
    int64_t row, address, per_instance, n, steps, count;
} EveryNth;

typedef TABLE(int64_t) Offsets; /* of variables in the block */
typedef TABLE(Figure) Figures;
typedef TABLE(EveryNth) AllEveryNth;

typedef struct {
    Offsets reals, words, flags; /* words: all else of 8 bytes; flags: Booleans. Their rows are in this order */
    Figures initial; /* the value after the initialization */
    Figures last;
    Figures minima, maxima; /* second: the time */
    Figures first; /* the first value that is not 0; second: the time */
    Figures sums, squares; /* of value * h, and of value * value * h */
    Figures above; /* of h where the value is above the limit */
    int64_t elapsed; /* the column of the sum of all h, 0 if there are no sums */
    Figures rises; /* how often the value becomes > 0.5; second: the value at the end of the step before */
    AllEveryNth series;
} Reductions;

/* Start the figures of instance i, whose block is initialized. */
void reduce_begin(const Reductions *r, Samples *s, int64_t i, int64_t block);

/* Update the figures of instance i from samples. */
void reduce_samples(const Reductions *r, Samples s, int64_t i);

/* Read the variables as doubles, into the same column of each row. The Reals are read in fours, twos and ones, since a
 * loop over single ones would take twice as long. */
static inline void read_sample(const Reductions *r, int64_t block, double *to) {
    const int64_t *x = r->reals.rows, *end = x + r->reals.count;
    for (; end - x >= 4; x += 4, to += 4 * SAMPLES) {
        to[0] = AT(const double, block + x[0]);
        to[SAMPLES] = AT(const double, block + x[1]);
        to[2 * SAMPLES] = AT(const double, block + x[2]);
        to[3 * SAMPLES] = AT(const double, block + x[3]);
    }
    if (r->reals.count & 2) {
        to[0] = AT(const double, block + x[0]);
        to[SAMPLES] = AT(const double, block + x[1]);
        x += 2, to += 2 * SAMPLES;
    }
    if (r->reals.count & 1) {
        *to = AT(const double, block + *x);
        to += SAMPLES;
    }
    for (x = r->words.rows, end = x + r->words.count; x < end; x++, to += SAMPLES)
        *to = (double)AT(const int64_t, block + *x);
    for (x = r->flags.rows, end = x + r->flags.count; x < end; x++, to += SAMPLES)
        *to = (double)AT(const uint8_t, block + *x);
}

/* Reduce the collected samples of instance i; to be called at the end of each run. */
static inline void reduce_end(const Reductions *r, Samples *s, int64_t i) {
    reduce_samples(r, *s, i); /* a copy, so that a loop can keep its samples in registers */
    s->count = 0;
}

/* Collect the values at the end of a step of instance i; `time`: of the step's end. */
static inline void reduce_step(const Reductions *r, Samples *s, int64_t i, int64_t block, double time, double h) {
    double *sample = s->rows + s->count;
    sample[TIMES * SAMPLES] = time;
    sample[LENGTHS * SAMPLES] = h;
    read_sample(r, block, sample + FIRST_VALUES * SAMPLES);
    s->elapsed += h;
    if (++s->count == SAMPLES) reduce_end(r, s, i);
}

#endif
