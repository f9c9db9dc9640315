/* The run of a scenario: its settings, its reactions, its axis, and what is recorded of it. All functions are static, so
 * that the loops of scenario_batch.c and of explorer/web.c, which include this file, have no calls.
 *
 * What the block is given has the bits that scenario/run/simulation.py would give it: what is here follows simulation.py,
 * reactions.py, clocks.py, script.py and drive.py, sum by sum. script_tables.py says what the tables hold. Addresses and
 * offsets are in bytes, and all members have 8 of them, so that the tables are the same for a machine with addresses of
 * 32 bits. */
#ifndef SCENARIO_RUN_H
#define SCENARIO_RUN_H

#include "block_memory.h"
#include "encoder.h"
#include "limits.h"
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

enum { STORED_REAL, STORED_WORD, STORED_FLAG }; /* how the value of a variable is stored in the block: KINDS in script_tables.py */
enum { LESS, GREATER, EQUAL }; /* COMPARISONS there */

typedef struct {
    double position, velocity, acceleration, jerk;
} Motion;

typedef struct {
    double position, velocity, acceleration;
} Telegram;

typedef struct { /* what a Real is allowed to be, and where it is in the block */
    int64_t offset;
    Limit limit;
} Limited;

typedef struct { /* a variable that is set, or to whose value is added */
    int64_t offset, kind, adds, word;
    double real;
} Assignment;

typedef struct { /* what is set when; `what`: a row of the bundles */
    double at;
    int64_t what;
} Event;

typedef struct { /* first and last (exclusive) of the assignments that are made together */
    int64_t first, last;
} Bundle;

typedef struct {
    int64_t offset, kind, comparison;
    double value, margin;
    int64_t at; /* when it sets, for each scan: the address of doubles */
    int64_t times, what; /* how often it happens at most, and the row of the bundles that it sets */
    int64_t held, happened;
} Reaction;

typedef struct { /* where a variable is in the block */
    int64_t offset, kind;
} Field;

typedef struct {
    int64_t block;
    double close, stop_time, period;
    int64_t end_of_step; /* whether the master is shown at the end of a step */
    int64_t points, point_count; /* the communication points that are determined before the run */
    int64_t scans, scan_count;
    double before; /* how long before a scan the outputs are sampled */
    int64_t events, taken, event_count;
    int64_t bundles, assignments, reactions, reaction_count;
    int64_t breaks, motions, motion_count, motion_capacity;
    int64_t indices, telegrams; /* of a remote axis, by its cycles; 0: there is a master */
    double cycle;
    int64_t encoder; /* between the master and the block; 0: there is none */
    int64_t follows, kind; /* the velocity that the master follows; its offset is -1 if it is scripted */
    double gain, most, scan;
    int64_t times, axis, values; /* for each point; 0: nothing is recorded */
    int64_t column, count; /* the distance of the columns in `values`, and how many points are recorded */
    double now, step, end; /* the latest point; the length of the latest step, 0: the block is initialized; its end */
    int64_t cause, number; /* why a batch stopped the run */
    int64_t section, next, point; /* in the motions, the scans and the points */
} Run;

typedef struct { /* what all runs have in common, and the runs */
    int64_t position, velocity, acceleration, cycle_index; /* the offsets of the inputs of the axis */
    int64_t limits, limit_count; /* the Reals that each step checks */
    int64_t sinks, sink_count; /* what is recorded */
    double longest, closest; /* step size; of a cycle: a time that follows an instant by less is taken for that one */
    int64_t reductions, samples; /* of a batch; 0: there are none */
    int64_t runs, run_count;
} Scenarios;

#define ROWS(Type, address) ((Type *)(intptr_t)(address))

static double read(int64_t block, int64_t offset, int64_t kind) {
    if (kind == STORED_REAL) return AT(const double, block + offset);
    return kind == STORED_WORD ? (double)AT(const int64_t, block + offset) : (double)AT(const uint8_t, block + offset);
}

/* --- the scripted axis --- */

/* The motion a time t after the i-th break. */
static Motion motion_after(const Run *r, int64_t i, double time) {
    const Motion m = ROWS(const Motion, r->motions)[i];
    const double t = time - ROWS(const double, r->breaks)[i], a = m.acceleration, j = m.jerk;
    const double position = m.position + t * (m.velocity + t * (a / 2.0 + t * j / 6.0));
    return (Motion){position, m.velocity + t * (a + t * j / 2.0), a + t * j, j};
}

/* The motion at t; where it jumps at t, the motion after the jump. */
static Motion motion_at(Run *r, double t) {
    const double *breaks = ROWS(const double, r->breaks);
    while (r->section + 1 < r->motion_count && breaks[r->section + 1] <= t) r->section++;
    while (r->section > 0 && breaks[r->section] > t) r->section--;
    return motion_after(r, r->section, t);
}

/* The motion at t; where it jumps at t, the motion before the jump. */
static Motion motion_until(Run *r, double t) {
    const double *breaks = ROWS(const double, r->breaks);
    while (r->section + 1 < r->motion_count && breaks[r->section + 1] < t) r->section++;
    while (r->section > 0 && breaks[r->section] >= t) r->section--;
    return motion_after(r, r->section, t);
}

/* The remainder of a position as Python has it, for a period > 0. */
static double wrapped(double x, double period) {
    const double rest = fmod(x, period);
    return rest < 0.0 ? rest + period : rest == 0.0 ? 0.0 : rest;
}

/* The true position at t, also before the start. */
static double true_position(Run *r, const Encoder *e, double t) {
    if (t >= 0.0) return motion_at(r, t).position;
    return e->initial_position + t * (e->initial_velocity + t * e->initial_acceleration / 2.0);
}

/* Sample n of the encoder. */
static double sample(Run *r, const Encoder *e, int64_t n) {
    return measured(e, true_position(r, e, (double)n * e->interval - e->delay), n);
}

/* What the encoder shows at t: the difference of the latest two samples is the velocity. */
static Telegram encoded(Run *r, double t) {
    Encoder *e = ROWS(Encoder, r->encoder);
    const int64_t n = (int64_t)(t / e->interval + SAMPLE_ROUNDING);
    if (n != e->number) {
        if (n > 0) e->former = n == e->number + 1 ? e->latest : sample(r, e, n - 1);
        e->latest = sample(r, e, n);
        e->number = n;
    }
    const bool is_between = e->sample_time == 0.0 && t != (double)n * e->interval;
    const double shown = is_between ? measured(e, true_position(r, e, t - e->delay), n) : e->latest;
    const double rest = r->period != 0.0 ? wrapped(shown, r->period) : shown;
    const double position = r->period != 0.0 && rest == r->period ? 0.0 : rest;
    if (n == 0) return (Telegram){position, e->start_velocity, e->start_acceleration};
    return (Telegram){position, (e->latest - e->former) / e->interval, 0.0};
}

static int64_t at_least_0(int64_t i) {
    return i > 0 ? i : 0;
}

/* How many of the cycles have acted before t. */
static int64_t acted_cycles(const Scenarios *s, const Run *r, double t) {
    return at_least_0(-(int64_t)floor(-(t / r->cycle - s->closest)));
}

/* Show the block its axis for the step from t to `end`. */
static void run_show_axis(const Scenarios *s, Run *r, double t, double end) {
    Telegram shown;
    if (r->telegrams) {
        const int64_t first = acted_cycles(s, r, t), last = acted_cycles(s, r, end) - 1, i = at_least_0(first < last ? first : last);
        shown = ROWS(const Telegram, r->telegrams)[i];
        AT(int64_t, r->block + s->cycle_index) = ROWS(const int64_t, r->indices)[i];
    } else if (r->encoder) {
        shown = encoded(r, r->end_of_step && end > t ? end : t);
    } else {
        const Motion m = r->end_of_step && end > t ? motion_until(r, end) : motion_at(r, t);
        const double position = r->period != 0.0 ? wrapped(m.position, r->period) : m.position;
        shown = (Telegram){position, m.velocity, m.acceleration};
    }
    AT(double, r->block + s->position) = shown.position;
    AT(double, r->block + s->velocity) = shown.velocity;
    AT(double, r->block + s->acceleration) = shown.acceleration;
}

/* --- settings and reactions --- */

static double next_setting_time(const Run *r) {
    return r->taken < r->event_count ? ROWS(const Event, r->events)[r->taken].at : INFINITY;
}

static double next_sample_time(const Run *r) {
    return r->next < r->scan_count ? ROWS(const double, r->scans)[r->next] - r->before : INFINITY;
}

static void assign(int64_t block, const Assignment *a) {
    const int64_t to = block + a->offset;
    if (a->kind == STORED_REAL) AT(double, to) = a->adds ? AT(double, to) + a->real : a->real;
    else if (a->kind == STORED_WORD) AT(int64_t, to) = a->adds ? AT(int64_t, to) + a->word : a->word;
    else AT(uint8_t, to) = (uint8_t)a->word;
}

/* Set what is set up to a time. */
static void apply_due_settings(Run *r, double time) {
    while (next_setting_time(r) <= time) {
        const Bundle *b = ROWS(const Bundle, r->bundles) + ROWS(const Event, r->events)[r->taken++].what;
        for (int64_t i = b->first; i < b->last; i++) assign(r->block, ROWS(const Assignment, r->assignments) + i);
    }
}

/* An event more, behind those of the same time. */
static void add_event(Run *r, double time, int64_t what) {
    Event *events = ROWS(Event, r->events);
    int64_t i = r->event_count++;
    for (; i > r->taken && events[i - 1].at > time; i--) events[i] = events[i - 1];
    events[i] = (Event){time, what};
}

static bool holds(const Run *r, const Reaction *x) {
    const double beyond = read(r->block, x->offset, x->kind) - x->value;
    if (x->comparison == LESS) return beyond < -x->margin;
    return x->comparison == GREATER ? beyond > x->margin : fabs(beyond) <= x->margin;
}

/* Sample the outputs at time 0: a condition that is true there has not become true. */
static void sample_start(const Run *r) {
    Reaction *reactions = ROWS(Reaction, r->reactions);
    for (int64_t i = 0; i < r->reaction_count; i++) reactions[i].held = holds(r, reactions + i);
}

/* Drop the first motion: nothing is recorded, and the run is past it. */
static void drop_first_motion(Run *r) {
    r->motion_count--;
    for (int64_t i = 0; i < r->motion_count; i++) {
        ROWS(double, r->breaks)[i] = ROWS(double, r->breaks)[i + 1];
        ROWS(Motion, r->motions)[i] = ROWS(Motion, r->motions)[i + 1];
    }
    r->section = at_least_0(r->section - 1);
}

/* The master goes on from a scan with the acceleration that its drive gives it. */
static void follow_velocity(Run *r, double scan) {
    const Motion m = motion_until(r, scan);
    double a = (read(r->block, r->follows, r->kind) - m.velocity) * r->gain / r->scan;
    a = -r->most > a ? -r->most : a;
    a = r->most < a ? r->most : a;
    if (r->motion_count == r->motion_capacity) drop_first_motion(r);
    ROWS(double, r->breaks)[r->motion_count] = scan;
    ROWS(Motion, r->motions)[r->motion_count++] = (Motion){m.position, m.velocity, a, 0.0};
}

/* Sample the outputs: what becomes true is reacted to from the scan on, and the master follows. */
static void sample_outputs(Run *r) {
    const int64_t next = r->next++;
    if (r->follows >= 0) follow_velocity(r, ROWS(const double, r->scans)[next]);
    Reaction *end = ROWS(Reaction, r->reactions) + r->reaction_count;
    for (Reaction *x = ROWS(Reaction, r->reactions); x < end; x++) {
        const int64_t held = x->held;
        const double time = ROWS(const double, x->at)[next];
        x->held = holds(r, x);
        if (x->held && !held && x->happened != x->times && time < r->stop_time) {
            x->happened++;
            add_event(r, time, x->what);
        }
    }
}

/* --- a run --- */

/* Record a point: the time, the axis, and the outputs, in a column each. */
static void record(const Scenarios *s, Run *r, double time, Motion m) {
    r->now = time;
    if (!r->times) return;
    const int64_t i = r->count++;
    ROWS(double, r->times)[i] = time;
    ROWS(Motion, r->axis)[i] = m;
    const Field *sinks = ROWS(const Field, s->sinks);
    for (int64_t k = 0; k < s->sink_count; k++)
        ROWS(double, r->values + k * r->column)[i] = read(r->block, sinks[k].offset, sinks[k].kind);
}

/* Record time 0, when the block is initialized. */
static void run_begin(const Scenarios *s, Run *r) {
    record(s, r, 0.0, motion_at(r, 0.0));
    sample_start(r);
    r->end = ROWS(const double, r->points)[0];
    r->point = 1;
}

/* Set what is due, and the axis, for the next step, which takes `step`. False: the run is at its end. Where a step ends
 * depends on what the reactions have seen at the end of the one before. */
static bool run_prepare(const Scenarios *s, Run *r) {
    if (r->point >= r->point_count) return false;
    const double t = r->end, point = ROWS(const double, r->points)[r->point];
    apply_due_settings(r, t + r->close);
    const double sample = next_sample_time(r), setting = next_setting_time(r);
    double end = setting < sample ? setting : sample;
    if (end >= point - r->close) {
        end = point;
        r->point++;
    }
    r->step = end - t;
    r->end = end;
    run_show_axis(s, r, t, end);
    return true;
}

/* The number of the first checked Real that is not allowed; -1 if all are. */
static int64_t run_first_refused(const Scenarios *s, const Run *r) {
    const Limited *limits = ROWS(const Limited, s->limits);
    for (int64_t k = 0; k < s->limit_count; k++)
        if (!allows(&limits[k].limit, AT(const double, r->block + limits[k].offset))) return k;
    return -1;
}

/* Record the end of a step; the reactions see it. */
static void run_finish(const Scenarios *s, Run *r) {
    record(s, r, r->end, motion_until(r, r->end));
    if (next_sample_time(r) <= r->end + r->close) sample_outputs(r);
}

#endif
