/* The loops of native_cost.py: the steps of a unit of FMI 2.0, done and timed without any Python. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>
#include "fmi2FunctionTypes.h"

enum { MOST = 256, SLICE = 1000 };

typedef struct {
    const fmi2ValueReference *r;
    size_t n;
} References;

typedef struct { /* CHost of native_cost.py is the same */
    fmi2Component unit;
    fmi2SetRealTYPE *set_real;
    fmi2GetRealTYPE *get_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2GetIntegerTYPE *get_integer;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2DoStepTYPE *do_step;
    References master, counter, outputs;  /* set and got at each step: position, velocity, acceleration; an Integer */
    References commands, between;         /* Booleans: raised in a step, and in the step before it */
    References draws, aheads, bases;      /* Reals: set before the step between, and after it, relative to others */
    References watched;                   /* Integers to look at after each step with the commands raised */
    double counts, now, place;            /* of the counter, 1/s; s; of the master */
} Host;

static double clock_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static fmi2Status set_master(const Host *host, double velocity) {
    fmi2Real inputs[3] = {host->place, velocity, 0.0};
    return host->set_real(host->unit, host->master.r, 3, inputs);
}

/* Set three inputs, doStep, get the outputs: three calls, as a simulation makes them; four with a counter, which does not
 * change where a step of a run starts, since that time is inexact. */
static inline fmi2Status full_step(Host *host, double h, double velocity) {
    fmi2Real values[MOST];
    fmi2Status status = set_master(host, velocity);
    fmi2Integer count = (fmi2Integer)(int64_t)(host->counts * host->now + 0.25);
    if (host->counter.n) status |= host->set_integer(host->unit, host->counter.r, 1, &count);
    status |= host->do_step(host->unit, host->now, h, fmi2True);
    status |= host->get_real(host->unit, host->outputs.r, host->outputs.n, values);
    host->now += h;
    host->place += velocity * h;
    return status;
}

/* n steps, the master being faster by the share `change` in every second one. times: the mean of a step in ns, and that of
 * the quickest SLICE steps on end. */
fmi2Status steady(Host *host, long n, double h, double velocity, double change, double times[2]) {
    const double velocities[2] = {velocity, velocity * (1.0 + change)};
    fmi2Status status = fmi2OK;
    times[0] = 0.0;
    for (long done = 0, slice; done < n; done += slice) {
        slice = n - done < SLICE ? n - done : SLICE;
        double start = clock_ns();
        for (long i = 0; i < slice; i++) status |= full_step(host, h, velocities[i % 2]);
        double one = clock_ns() - start;
        times[0] += one / (double)n;
        times[1] = fmin(times[1], one / (double)slice);
    }
    return status;
}

static fmi2Status set_level(const Host *host, const References *list, fmi2Boolean level) {
    fmi2Boolean levels[MOST];
    for (size_t i = 0; i < list->n; i++) levels[i] = level;
    return host->set_boolean(host->unit, list->r, list->n, levels);
}

/* n times one step of `pause` with the commands low, then one of h with the commands raised. took: the times of the second
 * steps, ns; seen: the values of what is watched; drawn, ahead: what is set, a row each time. */
fmi2Status worst(Host *host, long n, double h, double velocity, double pause, const double *drawn, const double *ahead,
                 double *took, fmi2Integer *seen) {
    fmi2Status status = fmi2OK;
    for (long i = 0; i < n; i++, drawn += host->draws.n, ahead += host->aheads.n, seen += host->watched.n) {
        fmi2Real values[MOST];
        status |= host->set_real(host->unit, host->draws.r, host->draws.n, drawn);
        status |= set_level(host, &host->commands, fmi2False);
        status |= set_level(host, &host->between, fmi2True);
        status |= full_step(host, pause, velocity);
        status |= set_master(host, velocity); /* the bases may lie before it */
        status |= host->get_real(host->unit, host->bases.r, host->bases.n, values);
        for (size_t k = 0; k < host->aheads.n; k++) values[k] += ahead[k];
        status |= host->set_real(host->unit, host->aheads.r, host->aheads.n, values);
        status |= set_level(host, &host->between, fmi2False);
        double start = clock_ns();
        status |= set_level(host, &host->commands, fmi2True);
        status |= full_step(host, h, velocity);
        took[i] = clock_ns() - start;
        status |= host->get_integer(host->unit, host->watched.r, host->watched.n, seen);
    }
    return status;
}
