/* The loop of a batch: it initializes each instance; then, step by step, it sets and judges the inputs, steps the
 * instance, and reads or reduces the outputs.
 *
 * One loop serves all blocks and every choice of variables: tables of addresses, strides and offsets, all in bytes, say
 * what is set and what is read. plan.py tells what they mean. */
#include "reduce.h"

typedef struct { /* values for each instance and step */
    int64_t address, per_instance, per_step;
} Array;

typedef struct { /* the values of a variable, and where it lies in the block */
    Array values;
    int64_t offset;
} Source;

typedef struct { /* where a variable lies in the block, and where its value goes in a row of the target */
    int64_t offset, to;
} Sink;

typedef struct {
    const Source *rows;
    int64_t count;
} Sources;

typedef struct {
    const Sink *rows;
    int64_t count;
} Sinks;

typedef struct {
    int64_t cause, step, number;
} Report;

typedef struct {
    int64_t blocks, size, instances, steps;
    Array step_sizes;
    double longest;
    Sources reals, words, flags; /* words: all else of 8 bytes; flags: Booleans */
    const Limit *limits; /* of the Reals */
    Sinks out_reals, out_words, out_flags;
    Array target;
    const Reductions *reductions;
    double *samples; /* for the reductions: their rows */
    int64_t first; /* the number of the first instance there */
    Report *reports;
} Plan;

static int64_t place(const Array *a, int64_t i, int64_t t) {
    return a->address + i * a->per_instance + t * a->per_step;
}

/* Set the inputs of a step until a Real is not allowed. Its number; -1 if all are allowed. */
static int64_t try_set(const Plan *p, int64_t block, int64_t i, int64_t t) {
    for (int64_t k = 0; k < p->reals.count; k++) {
        const Source *s = p->reals.rows + k;
        const double x = AT(const double, place(&s->values, i, t));
        AT(double, block + s->offset) = x;
        if (!allows(p->limits + k, x)) return k;
    }
    for (const Source *s = p->words.rows, *end = s + p->words.count; s < end; s++)
        AT(int64_t, block + s->offset) = AT(const int64_t, place(&s->values, i, t));
    for (const Source *s = p->flags.rows, *end = s + p->flags.count; s < end; s++)
        AT(uint8_t, block + s->offset) = AT(const uint8_t, place(&s->values, i, t));
    return -1;
}

/* Copy what is asked for into a row of the target, as doubles. */
static void put(const Plan *p, int64_t block, int64_t row) {
    for (const Sink *s = p->out_reals.rows, *end = s + p->out_reals.count; s < end; s++)
        AT(double, row + s->to) = AT(const double, block + s->offset);
    for (const Sink *s = p->out_words.rows, *end = s + p->out_words.count; s < end; s++)
        AT(double, row + s->to) = (double)AT(const int64_t, block + s->offset);
    for (const Sink *s = p->out_flags.rows, *end = s + p->out_flags.count; s < end; s++)
        AT(double, row + s->to) = (double)AT(const uint8_t, block + s->offset);
}

/* Carry one instance from start to end. Why, at which step, and at which input or refusal it stopped. */
static Report carried(const Plan *p, int64_t i, Samples *samples) {
    const int64_t block = p->blocks + i * p->size;
    Block *self = (Block *)(intptr_t)block;
    bool failed = false;
    int64_t refusal = block_initialize(self, &failed);
    if (failed || refusal) return (Report){failed ? CAUSE_RAISED : CAUSE_REFUSED, -1, refusal};
    if (p->reductions) reduce_begin(p->reductions, samples, p->first + i, block);
    double time = 0.0;
    for (int64_t t = 0; t < p->steps; t++) {
        const double h = AT(const double, place(&p->step_sizes, i, t));
        if (!(0.0 < h && h <= p->longest)) return (Report){CAUSE_STEP_SIZE, t, 0};
        const int64_t bad = try_set(p, block, i, t);
        if (bad >= 0) return (Report){CAUSE_INPUT, t, bad};
        refusal = block_step(self, h, &failed);
        if (failed || refusal) return (Report){failed ? CAUSE_RAISED : CAUSE_REFUSED, t, refusal};
        put(p, block, place(&p->target, i, t));
        time += h;
        if (p->reductions) reduce_step(p->reductions, samples, p->first + i, block, time, h);
    }
    return (Report){CAUSE_NONE, 0, 0};
}

/* Carry out a plan. An instance whose report has a cause already is left alone. */
void batch_run(const Plan *p) {
    for (int64_t i = 0; i < p->instances; i++) {
        if (p->reports[i].cause != CAUSE_NONE) continue;
        Samples samples = {p->samples, 0, 0.0};
        p->reports[i] = carried(p, i, &samples);
        if (p->reductions) reduce_end(p->reductions, &samples, p->first + i);
    }
}
