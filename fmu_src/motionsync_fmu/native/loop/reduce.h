/* Figures of a run, kept up to date step by step, so that nobody has to keep the values of all steps.
 *
 * What is kept of an instance lies in columns: a column is the address of a double, and instance i has the i-th one from
 * there on. reductions.py makes the tables and the columns, and tells what the figures mean. */
#ifndef REDUCE_H
#define REDUCE_H

#include "loop.h"

typedef struct { /* where a variable lies in the block, and the column for its value */
    int64_t offset, column;
} Reading;

typedef struct { /* what is kept of the values in a column: the column where it is kept, and a second one beside it */
    int64_t value, to, also;
    double limit;
} Figure;

typedef struct { /* each n-th of the values in a column: the array for them, and columns that count steps and values */
    int64_t value, address, per_instance, n, steps, count;
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
    Values before; /* the values after the initialization, for `rises` */
    Values last; /* the values at the end of a step */
    Figures minima, maxima; /* also: the time */
    int64_t elapsed; /* the column of the time over which the sums go, 0 if there are none */
    Figures sums, squares; /* of value * h, and of value * value * h */
    int64_t rare; /* whether there is any of the following, 0 or 1 */
    Figures rises; /* how often the value becomes > 0.5; also: the value at the end of the step before */
    Figures above; /* the time above the limit */
    AllSeries series;
} Reductions;

/* Begin the figures of instance i, whose block is initialized. */
void reduce_begin(const Reductions *r, int64_t i, int64_t block);

/* Take the values at the end of a step of instance i into its figures; `time`: of the step's end. */
void reduce_step(const Reductions *r, int64_t i, int64_t block, double time, double h);

#endif
