/* Figures of a run, kept while it runs, so that nobody has to keep the values of all steps.
 *
 * The values at the ends of some steps are collected as samples, then reduced together: so a measure costs less than
 * another output would. What is kept of an instance lies in columns: a column is the address of a double, and instance i
 * has the i-th one from there on. reductions.py makes the tables and the columns, and tells what the figures mean. */
#ifndef REDUCE_H
#define REDUCE_H

#include "loop.h"

enum { SAMPLES = 256 }; /* of a row; reductions.py has the same number */

typedef struct { /* rows of SAMPLES numbers: the times, the lengths of the steps, and the values of each variable */
    double *rows;
    int64_t count; /* of the samples that are collected */
    double elapsed; /* the sum of all lengths */
} Samples;

typedef struct { /* where a variable lies in the block, and the row or column for its value */
    int64_t offset, to;
} Reading;

typedef struct { /* what is kept of the values in a row: the column where it is kept, and a second one beside it */
    int64_t row, to, also;
    double limit;
} Figure;

typedef struct { /* each n-th of the values in a row: the array for them, and columns that count steps and values */
    int64_t row, address, per_instance, n, steps, count;
} Series;

typedef struct {
    const Reading *rows;
    int64_t count;
} Readings;

typedef struct {
    const Figure *rows;
    int64_t count;
} Figures;

typedef struct {
    const Series *rows;
    int64_t count;
} AllSeries;

typedef struct {
    Readings reals, words, flags; /* words: all else of 8 bytes; flags: Booleans */
} Values;

typedef struct {
    Values initial; /* the values after the initialization, into columns */
    Values sampled; /* the values at the end of a step, into rows */
    Figures last;
    Figures minima, maxima; /* also: the time */
    Figures first; /* the first value that is not 0; also: the time */
    Figures sums, squares; /* of value * h, and of value * value * h */
    Figures above; /* of h where the value is above the limit */
    int64_t elapsed; /* the column of the time over which the sums go, 0 if there are none */
    Figures rises; /* how often the value becomes > 0.5; also: the value at the end of the step before */
    AllSeries series;
} Reductions;

/* Begin the figures of instance i, whose block is initialized. */
void reduce_begin(const Reductions *r, Samples *s, int64_t i, int64_t block);

/* Reduce what is collected of instance i; to be called at the end of each run. */
void reduce_end(const Reductions *r, Samples *s, int64_t i);

/* Bring variables into columns or rows, as doubles; the first is at `address`, and they are `size` bytes long. */
static inline void read_values(const Values *v, int64_t block, int64_t address, int64_t size) {
    for (const Reading *x = v->reals.rows, *end = x + v->reals.count; x < end; x++)
        AT(double, address + x->to * size) = AT(const double, block + x->offset);
    for (const Reading *x = v->words.rows, *end = x + v->words.count; x < end; x++)
        AT(double, address + x->to * size) = (double)AT(const int64_t, block + x->offset);
    for (const Reading *x = v->flags.rows, *end = x + v->flags.count; x < end; x++)
        AT(double, address + x->to * size) = (double)AT(const uint8_t, block + x->offset);
}

/* Collect the values at the end of a step of instance i; `time`: of the step's end. */
static inline void reduce_step(const Reductions *r, Samples *s, int64_t i, int64_t block, double time, double h) {
    double *sample = s->rows + s->count;
    sample[0] = time;
    sample[SAMPLES] = h;
    read_values(&r->sampled, block, (int64_t)(intptr_t)sample, SAMPLES * (int64_t)sizeof(double));
    s->elapsed += h;
    if (++s->count == SAMPLES) reduce_end(r, s, i);
}

#endif
