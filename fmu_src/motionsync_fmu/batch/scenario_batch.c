/* The runs of scenarios in a batch, one after the other, each from start to end. */
#include "causes.h"
#include "reduce.h"
#include "run_host.h"

typedef struct { /* the runs, and what they have in common */
    int64_t runs, count;
    double longest; /* step size, s */
    const Reductions *reductions;
    double *samples; /* for the reductions: their rows */
} RunBatch;

/* End a run that failed, for a cause; `number`: of the refusal or input. Returns false. */
static bool stop(Run *r, int64_t cause, int64_t number) {
    r->host.cause = cause;
    r->host.number = number;
    return false;
}

static bool initialize(Run *r) {
    bool failed = false;
    run_start(r, &failed);
    const int64_t refusal = block_initialize((Block *)(intptr_t)r->host.block, &failed);
    if (failed || refusal) return stop(r, failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    run_begin(r, &failed);
    return !failed || stop(r, CAUSE_RAISED, 0);
}

/* One step that is prepared. False: the run has failed. */
static bool step(const RunBatch *b, Run *r, bool *failed) {
    if (!(0.0 < r->step && r->step <= b->longest)) return stop(r, CAUSE_STEP_SIZE, 0);
    const int64_t refused = run_first_refused(r);
    if (refused >= 0) return stop(r, CAUSE_INPUT, refused);
    const int64_t refusal = block_step((Block *)(intptr_t)r->host.block, r->step, failed);
    if (*failed || refusal) return stop(r, *failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    run_finish(r, failed);
    return true;
}

/* Execute the runs. One that has a cause already is left alone. */
void script_run(const RunBatch *b) {
    for (int64_t i = 0; i < b->count; i++) {
        Run *r = (Run *)(intptr_t)b->runs + i;
        Samples samples = {b->samples, 0, 0.0};
        bool failed = false;
        if (r->host.cause != CAUSE_NONE) continue;
        const bool is_initialized = initialize(r);
        if (is_initialized && b->reductions) reduce_begin(b->reductions, &samples, i, r->host.block);
        while (is_initialized && !failed && run_prepare(r, &failed) && step(b, r, &failed))
            if (b->reductions) reduce_step(b->reductions, &samples, i, r->host.block, r->end, r->step);
        if (failed && r->host.cause == CAUSE_NONE) stop(r, CAUSE_RAISED, 0);
        if (b->reductions) reduce_end(b->reductions, &samples, i);
    }
}
