/* The loop of a batch: it initializes each instance; then, step by step, it sets and checks the inputs, steps the
 * instance, and reads or reduces the outputs.
 *
 * One loop serves all blocks and every choice of variables: tables of addresses, strides and offsets, all in bytes, state
 * what is set and what is read. batch_layout.py explains them. */
#include "block_memory.h"
#include "causes.h"
#include "limits.h"
#include "reduce.h"

typedef struct { /* values for each instance and step */
    int64_t address, per_instance, per_step;
} Array;

typedef struct { /* the values of a variable, and its offset in the block */
    Array values;
    int64_t offset;
} Source;

typedef struct { /* a variable's offset in the block, and that of its value in a row of the target */
    int64_t offset, target_offset;
} Sink;

typedef TABLE(Source) Sources;
typedef TABLE(Sink) Sinks;

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
} BatchLayout;

static int64_t address_of(const Array *a, int64_t i, int64_t t) {
    return a->address + i * a->per_instance + t * a->per_step;
}

/* Set the inputs of a step, up to the first Real that is not allowed: its number; -1 if all are allowed. */
static int64_t set_inputs(const BatchLayout *p, int64_t block, int64_t i, int64_t t) {
    for (int64_t k = 0; k < p->reals.count; k++) {
        const Source *s = p->reals.rows + k;
        const double x = AT(const double, address_of(&s->values, i, t));
        AT(double, block + s->offset) = x;
        if (!allows(p->limits + k, x)) return k;
    }
    for (const Source *s = p->words.rows, *end = s + p->words.count; s < end; s++)
        AT(int64_t, block + s->offset) = AT(const int64_t, address_of(&s->values, i, t));
    for (const Source *s = p->flags.rows, *end = s + p->flags.count; s < end; s++)
        AT(uint8_t, block + s->offset) = AT(const uint8_t, address_of(&s->values, i, t));
    return -1;
}

/* Copy the outputs into a row of the target, as doubles. */
static void write_outputs(const BatchLayout *p, int64_t block, int64_t row) {
    for (const Sink *s = p->out_reals.rows, *end = s + p->out_reals.count; s < end; s++)
        AT(double, row + s->target_offset) = AT(const double, block + s->offset);
    for (const Sink *s = p->out_words.rows, *end = s + p->out_words.count; s < end; s++)
        AT(double, row + s->target_offset) = (double)AT(const int64_t, block + s->offset);
    for (const Sink *s = p->out_flags.rows, *end = s + p->out_flags.count; s < end; s++)
        AT(double, row + s->target_offset) = (double)AT(const uint8_t, block + s->offset);
}

/* Run one instance from start to end. The report: why, at which step, and at which input or refusal it stopped. */
static Report run_instance(const BatchLayout *p, int64_t i, Samples *samples) {
    const int64_t block = p->blocks + i * p->size;
    Block *self = (Block *)(intptr_t)block;
    bool failed = false;
    int64_t refusal = block_initialize(self, &failed);
    if (failed || refusal) return (Report){failed ? CAUSE_RAISED : CAUSE_REFUSED, -1, refusal};
    if (p->reductions) reduce_begin(p->reductions, samples, p->first + i, block);
    double time = 0.0;
    for (int64_t t = 0; t < p->steps; t++) {
        const double h = AT(const double, address_of(&p->step_sizes, i, t));
        if (!(0.0 < h && h <= p->longest)) return (Report){CAUSE_STEP_SIZE, t, 0};
        const int64_t refused_input = set_inputs(p, block, i, t);
        if (refused_input >= 0) return (Report){CAUSE_INPUT, t, refused_input};
        refusal = block_step(self, h, &failed);
        if (failed || refusal) return (Report){failed ? CAUSE_RAISED : CAUSE_REFUSED, t, refusal};
        write_outputs(p, block, address_of(&p->target, i, t));
        time += h;
        if (p->reductions) reduce_step(p->reductions, samples, p->first + i, block, time, h);
    }
    return (Report){CAUSE_NONE, 0, 0};
}

/* Execute a plan. An instance whose report has a cause already is left alone. */
void batch_run(const BatchLayout *p) {
    for (int64_t i = 0; i < p->instances; i++) {
        if (p->reports[i].cause != CAUSE_NONE) continue;
        Samples samples = {p->samples, 0, 0.0};
        p->reports[i] = run_instance(p, i, &samples);
        if (p->reductions) reduce_end(p->reductions, &samples, p->first + i);
    }
}
