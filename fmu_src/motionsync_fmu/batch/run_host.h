/* What a host in C does for a run: it gives the block the inputs, and records it. The run itself (run.h) is translated
 * from the package `runner`, whose host.py explains the members of Host. All functions are static, so that the loops of
 * scenario_batch.c and of explorer/web.c, which include this file, have no calls. */
#ifndef RUN_HOST_H
#define RUN_HOST_H

#include "block_memory.h"
#include "limits.h"
#include "run.h"

/* A variable, by its offset and how it is stored: two numbers of a series. */

static double read(int64_t block, const int64_t *variable) {
    const int64_t at = block + variable[0];
    if (variable[1] == Stored_REAL) return AT(const double, at);
    return variable[1] == Stored_WORD ? (double)AT(const int64_t, at) : (double)AT(const uint8_t, at);
}

static void write(int64_t block, const int64_t *variable, double x) {
    const int64_t at = block + variable[0];
    if (variable[1] == Stored_REAL) AT(double, at) = x;
    else if (variable[1] == Stored_WORD) AT(int64_t, at) = (int64_t)x;
    else AT(uint8_t, at) = (uint8_t)x;
}

/* Write the outputs that the program sees. */
static void see(Run *r) {
    for (int64_t k = 0; k < r->program.outputs.count; k++)
        REALS(r->program.outputs)[k] = read(r->host.block, WHOLES(r->host.sees) + 2 * k);
}

/* Record a point: the time, the axis, and the variables, in a column each. */
static void record(Run *r) {
    Host *h = &r->host;
    if (!h->times.count) return;
    const int64_t i = h->count++;
    REALS(h->times)[i] = r->now;
    double *axis = REALS(h->axis) + 4 * i;
    axis[0] = r->axis.position;
    axis[1] = r->axis.velocity;
    axis[2] = r->axis.acceleration;
    axis[3] = r->axis.jerk;
    double *value = REALS(h->values) + i;
    const int64_t *end = WHOLES(h->records) + h->records.count;
    for (const int64_t *variable = WHOLES(h->records); variable < end; variable += 2, value += h->times.count)
        *value = read(h->block, variable);
}

static void give_axis(const Run *r) {
    const Host *h = &r->host;
    AT(double, h->block + h->position) = r->position;
    AT(double, h->block + h->velocity) = r->velocity;
    AT(double, h->block + h->acceleration) = r->acceleration;
    if (r->is_remote) AT(int64_t, h->block + h->cycle_index) = r->cycle_index;
}

/* Give the block the axis at time 0; then it is initialized. */
static void run_start(Run *r, bool *failed) {
    Run_start(r, failed);
    give_axis(r);
}

static void run_begin(Run *r, bool *failed) {
    see(r);
    Run_begin(r, failed);
    record(r);
}

/* Give the block what is set for the next step. False: the run is at its end. */
static bool run_prepare(Run *r, bool *failed) {
    if (!Run_try_prepare(r, failed)) return false;
    for (int64_t k = 0; r->sets && k < r->program.values.count; k++)
        write(r->host.block, WHOLES(r->host.sets) + 2 * k, REALS(r->program.values)[k]);
    give_axis(r);
    return true;
}

/* The number of the first checked Real that is not allowed; -1 if all are. */
static int64_t run_first_refused(const Run *r) {
    const Limit *limits = (const Limit *)REALS(r->host.limits);
    for (int64_t k = 0; k < r->host.checks.count; k++)
        if (!allows(limits + k, AT(const double, r->host.block + WHOLES(r->host.checks)[k]))) return k;
    return -1;
}

/* End the step that the block has made. */
static void run_finish(Run *r, bool *failed) {
    Run_finish(r, failed);
    record(r);
    if (!r->samples) return;
    see(r);
    Run_sample(r, failed);
}

#endif
