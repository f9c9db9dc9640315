/* Figures of a run, kept up to date step by step; reduce.h says what the tables hold. */
#include "reduce.h"

#define COLUMN(column) AT(double, (column) + i * (int64_t)sizeof(double))
#define EACH(Type, row, table) const Type *row = (table).rows, *end = row + (table).count; row < end; row++

/* Bring variables into their columns, as doubles. */
static inline void read_values(const Values *v, int64_t i, int64_t block) {
    for (EACH(Reading, x, v->reals)) COLUMN(x->column) = AT(const double, block + x->offset);
    for (EACH(Reading, x, v->words)) COLUMN(x->column) = (double)AT(const int64_t, block + x->offset);
    for (EACH(Reading, x, v->flags)) COLUMN(x->column) = (double)AT(const uint8_t, block + x->offset);
}

/* The first value, and whatever is not a number, becomes the extreme; what is not a number stays it. */
static inline void take_extreme(const Figure *f, int64_t i, double x, double time) {
    const double extreme = COLUMN(f->to), since = COLUMN(f->also);
    if (extreme != extreme && since == since) return;
    COLUMN(f->to) = x;
    COLUMN(f->also) = time;
}

/* Keep each n-th value. */
static inline void take_series(const Series *s, int64_t i) {
    const double steps = COLUMN(s->steps) + 1.0, count = COLUMN(s->count);
    COLUMN(s->steps) = steps < (double)s->n ? steps : 0.0;
    if (steps < (double)s->n) return;
    AT(double, s->address + i * s->per_instance + (int64_t)count * (int64_t)sizeof(double)) = COLUMN(s->value);
    COLUMN(s->count) = count + 1.0;
}

/* The figures that few ask for. */
static inline void take_rare(const Reductions *r, int64_t i, double h) {
    for (EACH(Figure, f, r->rises)) {
        const double x = COLUMN(f->value);
        COLUMN(f->to) += x > 0.5 && !(COLUMN(f->also) > 0.5) ? 1.0 : 0.0;
        COLUMN(f->also) = x;
    }
    for (EACH(Figure, f, r->above)) COLUMN(f->to) += COLUMN(f->value) > f->limit ? h : 0.0;
    for (EACH(Series, s, r->series)) take_series(s, i);
}

void reduce_begin(const Reductions *r, int64_t i, int64_t block) {
    read_values(&r->before, i, block);
}

void reduce_step(const Reductions *r, int64_t i, int64_t block, double time, double h) {
    read_values(&r->last, i, block);
    for (EACH(Figure, f, r->minima)) {
        const double x = COLUMN(f->value);
        if (!(x >= COLUMN(f->to))) take_extreme(f, i, x, time);
    }
    for (EACH(Figure, f, r->maxima)) {
        const double x = COLUMN(f->value);
        if (!(x <= COLUMN(f->to))) take_extreme(f, i, x, time);
    }
    if (r->elapsed) {
        COLUMN(r->elapsed) += h;
        for (EACH(Figure, f, r->sums)) COLUMN(f->to) += COLUMN(f->value) * h;
        for (EACH(Figure, f, r->squares)) COLUMN(f->to) += COLUMN(f->value) * COLUMN(f->value) * h;
    }
    if (r->rare) take_rare(r, i, h);
}
