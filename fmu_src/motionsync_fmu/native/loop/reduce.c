/* Figures of a run, kept while it runs; reduce.h says what the tables hold. */
#include "reduce.h"

#define COLUMN(column) AT(double, (column) + i * (int64_t)sizeof(double))
#define EACH(Type, row, table) const Type *row = (table).rows, *end = row + (table).count; row < end; row++

enum { LANES = 4 }; /* sums that are added up side by side: one alone would wait for each addition */

typedef enum { PLAIN, SQUARED, ABOVE } Summand;

static inline const double *values_of(const Samples *s, int64_t row) {
    return s->rows + row * SAMPLES;
}

/* --- extremes --- */

/* Not a number is beyond everything. */
static inline bool is_beyond(double x, double extreme, bool greatest) {
    return greatest ? !(x <= extreme) : !(x >= extreme);
}

/* Without a branch, so that several values are compared at once. */
static inline bool any_beyond(const double *x, int64_t count, double extreme, bool greatest) {
    int64_t found = 0;
    for (int64_t k = 0; k < count; k++) found |= is_beyond(x[k], extreme, greatest);
    return found != 0;
}

/* Once there is an extreme that is not a number, it stays; before the first value there is one, but no time. */
static inline void take_extreme(const Samples *s, const Figure *f, int64_t i, bool greatest) {
    const double *x = values_of(s, f->row), *times = values_of(s, TIMES);
    double extreme = COLUMN(f->to), since = COLUMN(f->also);
    if (!any_beyond(x, s->count, extreme, greatest)) return;
    for (int64_t k = 0; k < s->count; k++) {
        if (!is_beyond(x[k], extreme, greatest) || (extreme != extreme && since == since)) continue;
        extreme = x[k];
        since = times[k];
    }
    COLUMN(f->to) = extreme;
    COLUMN(f->also) = since;
}

/* --- sums --- */

static inline double summand(double x, double h, double limit, Summand kind) {
    switch (kind) {
    case PLAIN: return x * h;
    case SQUARED: return x * x * h;
    default: return x > limit ? h : 0.0;
    }
}

/* Continue some sums, step by step: any other order would have other bits. Lanes without a figure repeat the first. */
static inline void add_some(const Samples *s, const Figure *f, int64_t figures, int64_t i, Summand kind) {
    const Figure *figure[LANES];
    const double *x[LANES], *h = values_of(s, LENGTHS);
    double sum[LANES];
    for (int64_t n = 0; n < LANES; n++) {
        figure[n] = f + (n < figures ? n : 0);
        x[n] = values_of(s, figure[n]->row);
        sum[n] = COLUMN(figure[n]->to);
    }
    for (int64_t k = 0; k < s->count; k++)
        for (int64_t n = 0; n < LANES; n++) sum[n] += summand(x[n][k], h[k], figure[n]->limit, kind);
    for (int64_t n = 0; n < LANES; n++) COLUMN(figure[n]->to) = sum[n];
}

static inline void add_up(const Samples *s, Figures f, int64_t i, Summand kind) {
    for (int64_t n = 0; n < f.count; n += LANES) add_some(s, f.rows + n, f.count - n, i, kind);
}

/* --- the others --- */

static void take_first(const Samples *s, const Figure *f, int64_t i) {
    const double *x = values_of(s, f->row);
    const bool found = COLUMN(f->also) == COLUMN(f->also);
    for (int64_t k = 0; !found && k < s->count; k++) {
        if (x[k] == 0.0) continue;
        COLUMN(f->to) = x[k];
        COLUMN(f->also) = values_of(s, TIMES)[k];
        return;
    }
}

static void count_rises(const Samples *s, const Figure *f, int64_t i) {
    const double *x = values_of(s, f->row);
    int64_t rises = x[0] > 0.5 && !(COLUMN(f->also) > 0.5);
    for (int64_t k = 1; k < s->count; k++) rises += x[k] > 0.5 && !(x[k - 1] > 0.5);
    COLUMN(f->to) += (double)rises;
    COLUMN(f->also) = x[s->count - 1];
}

static void keep_series(const Samples *s, const Series *f, int64_t i) {
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
    for (EACH(Figure, f, r->initial)) COLUMN(f->to) = *values_of(s, f->row);
}

void reduce_samples(const Reductions *r, Samples samples, int64_t i) {
    const Samples *s = &samples;
    if (!s->count) return;
    for (EACH(Figure, f, r->last)) COLUMN(f->to) = values_of(s, f->row)[s->count - 1];
    for (EACH(Figure, f, r->minima)) take_extreme(s, f, i, false);
    for (EACH(Figure, f, r->maxima)) take_extreme(s, f, i, true);
    for (EACH(Figure, f, r->first)) take_first(s, f, i);
    add_up(s, r->sums, i, PLAIN);
    add_up(s, r->squares, i, SQUARED);
    add_up(s, r->above, i, ABOVE);
    if (r->elapsed) COLUMN(r->elapsed) = s->elapsed;
    for (EACH(Figure, f, r->rises)) count_rises(s, f, i);
    for (EACH(Series, f, r->series)) keep_series(s, f, i);
}
