/* Figures of a run, updated while it runs; reduce.h describes the tables. */
#include "reduce.h"

#define COLUMN(column) AT(double, (column) + i * (int64_t)sizeof(double))
#define EACH(Type, row, table) const Type *row = (table).rows, *end = row + (table).count; row < end; row++

enum { LANES = 4 }; /* sums that are computed in parallel: a single one would wait for each addition */

typedef enum { PLAIN, SQUARED, ABOVE } Summand;

static inline const double *values_of(const Samples *s, int64_t row) {
    return s->rows + row * SAMPLES;
}

/* --- extremes --- */

/* NaN is beyond everything. */
static inline bool is_beyond(double x, double extreme, bool greatest) {
    return greatest ? !(x <= extreme) : !(x >= extreme);
}

/* Without a branch, so that several values are compared at once. */
static inline bool any_beyond(const double *x, int64_t count, double extreme, bool greatest) {
    int64_t any = 0;
    for (int64_t k = 0; k < count; k++) any |= is_beyond(x[k], extreme, greatest);
    return any != 0;
}

/* An extreme that is NaN stays; the one before the first value has no time and does not. */
static inline void update_extreme(const Samples *s, const Figure *f, int64_t i, bool greatest) {
    const double *x = values_of(s, f->row), *times = values_of(s, TIMES);
    double extreme = COLUMN(f->column), since = COLUMN(f->second);
    if (!any_beyond(x, s->count, extreme, greatest)) return;
    for (int64_t k = 0; k < s->count; k++) {
        if (!is_beyond(x[k], extreme, greatest) || (extreme != extreme && since == since)) continue;
        extreme = x[k];
        since = times[k];
    }
    COLUMN(f->column) = extreme;
    COLUMN(f->second) = since;
}

/* --- sums --- */

static inline double summand(double x, double h, double limit, Summand kind) {
    switch (kind) {
    case PLAIN: return x * h;
    case SQUARED: return x * x * h;
    default: return x > limit ? h : 0.0;
    }
}

/* Add to several sums, step by step: another order would give other bits. Lanes without a figure repeat the first. */
static inline void add_lanes(const Samples *s, const Figure *f, int64_t figures, int64_t i, Summand kind) {
    const Figure *figure[LANES];
    const double *x[LANES], *h = values_of(s, LENGTHS);
    double sum[LANES];
    for (int64_t n = 0; n < LANES; n++) {
        figure[n] = f + (n < figures ? n : 0);
        x[n] = values_of(s, figure[n]->row);
        sum[n] = COLUMN(figure[n]->column);
    }
    for (int64_t k = 0; k < s->count; k++)
        for (int64_t n = 0; n < LANES; n++) sum[n] += summand(x[n][k], h[k], figure[n]->limit, kind);
    for (int64_t n = 0; n < LANES; n++) COLUMN(figure[n]->column) = sum[n];
}

static inline void add_sums(const Samples *s, Figures f, int64_t i, Summand kind) {
    for (int64_t n = 0; n < f.count; n += LANES) add_lanes(s, f.rows + n, f.count - n, i, kind);
}

/* --- the others --- */

static void find_first_value(const Samples *s, const Figure *f, int64_t i) {
    const double *x = values_of(s, f->row);
    const bool has_value = COLUMN(f->second) == COLUMN(f->second);
    for (int64_t k = 0; !has_value && k < s->count; k++) {
        if (x[k] == 0.0) continue;
        COLUMN(f->column) = x[k];
        COLUMN(f->second) = values_of(s, TIMES)[k];
        return;
    }
}

static void count_rises(const Samples *s, const Figure *f, int64_t i) {
    const double *x = values_of(s, f->row);
    int64_t rises = x[0] > 0.5 && !(COLUMN(f->second) > 0.5);
    for (int64_t k = 1; k < s->count; k++) rises += x[k] > 0.5 && !(x[k - 1] > 0.5);
    COLUMN(f->column) += (double)rises;
    COLUMN(f->second) = x[s->count - 1];
}

static void store_series(const Samples *s, const EveryNth *f, int64_t i) {
    const double *x = values_of(s, f->row);
    const int64_t steps = (int64_t)COLUMN(f->steps);
    int64_t count = (int64_t)COLUMN(f->count);
    double *values = &AT(double, f->address + i * f->per_instance);
    for (int64_t k = f->n - 1 - steps; k < s->count; k += f->n) values[count++] = x[k];
    COLUMN(f->steps) = (double)((steps + s->count) % f->n);
    COLUMN(f->count) = (double)count;
}

/* --- all of them --- */

void reduce_begin(const Reductions *r, Samples *s, int64_t i, int64_t block) {
    s->count = 0;
    s->elapsed = 0.0;
    read_sample(r, block, s->rows + FIRST_VALUES * SAMPLES);
    for (EACH(Figure, f, r->initial)) COLUMN(f->column) = *values_of(s, f->row);
}

void reduce_samples(const Reductions *r, Samples samples, int64_t i) {
    const Samples *s = &samples;
    if (!s->count) return;
    for (EACH(Figure, f, r->last)) COLUMN(f->column) = values_of(s, f->row)[s->count - 1];
    for (EACH(Figure, f, r->minima)) update_extreme(s, f, i, false);
    for (EACH(Figure, f, r->maxima)) update_extreme(s, f, i, true);
    for (EACH(Figure, f, r->first)) find_first_value(s, f, i);
    add_sums(s, r->sums, i, PLAIN);
    add_sums(s, r->squares, i, SQUARED);
    add_sums(s, r->above, i, ABOVE);
    if (r->elapsed) COLUMN(r->elapsed) = s->elapsed;
    for (EACH(Figure, f, r->rises)) count_rises(s, f, i);
    for (EACH(EveryNth, f, r->series)) store_series(s, f, i);
}
