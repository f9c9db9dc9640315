/* The runs of scenarios in a batch, one after the other, each from start to end. */
#include "block_memory.h"
#include "causes.h"
#include "reduce.h"
#include "scenario_run.h"

/* End a run that failed, for a cause; `number`: of the refusal or input. Returns false. */
static bool stop(Run *r, int64_t cause, int64_t number) {
    r->cause = cause;
    r->number = number;
    return false;
}

static bool initialize(const Scenarios *s, Run *r) {
    bool failed = false;
    const int64_t refusal = block_initialize((Block *)(intptr_t)r->block, &failed);
    if (failed || refusal) return stop(r, failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    run_begin(s, r);
    return true;
}

/* One step that is prepared. False: the run has failed. */
static bool step(const Scenarios *s, Run *r) {
    bool failed = false;
    if (!(0.0 < r->step && r->step <= s->longest)) return stop(r, CAUSE_STEP_SIZE, 0);
    const int64_t refused = run_first_refused(s, r);
    if (refused >= 0) return stop(r, CAUSE_INPUT, refused);
    const int64_t refusal = block_step((Block *)(intptr_t)r->block, r->step, &failed);
    if (failed || refusal) return stop(r, failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    run_finish(s, r);
    return true;
}

/* Execute the runs. One that has a cause already is left alone. */
void script_run(const Scenarios *s) {
    const Reductions *reductions = (const Reductions *)(intptr_t)s->reductions;
    for (int64_t i = 0; i < s->run_count; i++) {
        Run *r = (Run *)(intptr_t)s->runs + i;
        Samples samples = {(double *)(intptr_t)s->samples, 0, 0.0};
        if (r->cause != CAUSE_NONE) continue;
        const bool is_initialized = initialize(s, r);
        if (is_initialized && reductions) reduce_begin(reductions, &samples, i, r->block);
        while (is_initialized && run_prepare(s, r) && step(s, r))
            if (reductions) reduce_step(reductions, &samples, i, r->block, r->end, r->step);
        if (reductions) reduce_end(reductions, &samples, i);
    }
}
