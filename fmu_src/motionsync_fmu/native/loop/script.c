/* Runs of scenarios: each is carried from start to end with all that its script, settings and reactions give the block.
 *
 * What the block is given has the bits that scenario/run.py would give it: what stands here follows run.py, reactions.py,
 * script.py, drive.py and clocks.py, sum by sum. script_tables.py makes the tables and says what they hold; addresses
 * and offsets are in bytes. */
#include "reduce.h"

enum { REAL, WORD, FLAG }; /* how the value of a variable lies in the block: KINDS in script_tables.py */
enum { LESS, GREATER, EQUAL }; /* COMPARISONS there */

typedef struct {
    double position, velocity, acceleration, jerk;
} Motion;

typedef struct {
    double position, velocity, acceleration;
} Telegram;

typedef struct { /* what a Real is allowed to be, and where it lies in the block */
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

typedef struct {
    int64_t block;
    double close, stop_time, period;
    int64_t end_of_step; /* whether the master is shown at the end of a step */
    int64_t points, point_count; /* the communication points that are known */
    int64_t scans, scan_count;
    double before; /* how long before a scan the outputs are looked at */
    int64_t events, taken, event_count;
    int64_t bundles, assignments, reactions, reaction_count;
    int64_t breaks, motions, motion_count;
    int64_t indices, telegrams; /* of a remote axis, by its cycles; 0: there is a master */
    double cycle;
    int64_t follows, kind; /* the velocity that the master follows; its offset is -1 if it is scripted */
    double gain, most, scan;
    int64_t times, axis, values; /* for each point; 0: nothing is recorded */
    int64_t room, count; /* the distance of the columns in `values`, and how many points are recorded */
    double now, step; /* the latest point, and the length of the latest step; 0: the block is initialized */
    int64_t cause, number;
    int64_t place, next; /* in the breaks, and in the scans */
} Run;

typedef struct { /* where a variable lies in the block */
    int64_t offset, kind;
} Place;

typedef struct {
    int64_t position, velocity, acceleration, cycle_index; /* the inputs of the axis */
    const Limited *limits;
    int64_t limit_count;
    const Place *sinks; /* what is recorded */
    int64_t sink_count;
    double longest, closest; /* step size; of a cycle: a time that follows an instant by less is taken for that one */
    const Reductions *reductions;
    double *samples; /* for the reductions: their rows */
    Run *runs;
    int64_t run_count;
} Scenarios;

#define ROWS(Type, address) ((Type *)(intptr_t)(address))

static double read(int64_t block, int64_t offset, int64_t kind) {
    if (kind == REAL) return AT(const double, block + offset);
    return kind == WORD ? (double)AT(const int64_t, block + offset) : (double)AT(const uint8_t, block + offset);
}

/* --- the scripted axis --- */

/* The motion a time t after the i-th break. */
static Motion after(const Run *r, int64_t i, double time) {
    const Motion m = ROWS(const Motion, r->motions)[i];
    const double t = time - ROWS(const double, r->breaks)[i], a = m.acceleration, j = m.jerk;
    const double position = m.position + t * (m.velocity + t * (a / 2.0 + t * j / 6.0));
    return (Motion){position, m.velocity + t * (a + t * j / 2.0), a + t * j, j};
}

/* The motion at t; where it jumps at t, the motion after the jump. */
static Motion at(Run *r, double t) {
    const double *breaks = ROWS(const double, r->breaks);
    while (r->place + 1 < r->motion_count && breaks[r->place + 1] <= t) r->place++;
    while (r->place > 0 && breaks[r->place] > t) r->place--;
    return after(r, r->place, t);
}

/* The motion at t; where it jumps at t, the motion before the jump. */
static Motion until(Run *r, double t) {
    const double *breaks = ROWS(const double, r->breaks);
    while (r->place + 1 < r->motion_count && breaks[r->place + 1] < t) r->place++;
    while (r->place > 0 && breaks[r->place] >= t) r->place--;
    return after(r, r->place, t);
}

/* The remainder of a position as Python has it, for a period > 0. */
static double wrapped(double x, double period) {
    const double rest = fmod(x, period);
    return rest < 0.0 ? rest + period : rest == 0.0 ? 0.0 : rest;
}

static int64_t at_least_0(int64_t i) {
    return i > 0 ? i : 0;
}

/* How many of the cycles have acted before t. */
static int64_t acted(const Scenarios *s, const Run *r, double t) {
    return at_least_0(-(int64_t)floor(-(t / r->cycle - s->closest)));
}

/* Show the block its axis for the step from t to `end`. */
static void show(const Scenarios *s, Run *r, double t, double end) {
    Telegram shown;
    if (r->telegrams) {
        const int64_t first = acted(s, r, t), last = acted(s, r, end) - 1, i = at_least_0(first < last ? first : last);
        shown = ROWS(const Telegram, r->telegrams)[i];
        AT(int64_t, r->block + s->cycle_index) = ROWS(const int64_t, r->indices)[i];
    } else {
        const Motion m = r->end_of_step && end > t ? until(r, end) : at(r, t);
        const double position = r->period != 0.0 ? wrapped(m.position, r->period) : m.position;
        shown = (Telegram){position, m.velocity, m.acceleration};
    }
    AT(double, r->block + s->position) = shown.position;
    AT(double, r->block + s->velocity) = shown.velocity;
    AT(double, r->block + s->acceleration) = shown.acceleration;
}

/* --- settings and reactions --- */

static double next_setting(const Run *r) {
    return r->taken < r->event_count ? ROWS(const Event, r->events)[r->taken].at : INFINITY;
}

static double next_look(const Run *r) {
    return r->next < r->scan_count ? ROWS(const double, r->scans)[r->next] - r->before : INFINITY;
}

static void assign(int64_t block, const Assignment *a) {
    const int64_t to = block + a->offset;
    if (a->kind == REAL) AT(double, to) = a->adds ? AT(double, to) + a->real : a->real;
    else if (a->kind == WORD) AT(int64_t, to) = a->adds ? AT(int64_t, to) + a->word : a->word;
    else AT(uint8_t, to) = (uint8_t)a->word;
}

/* Set what is set up to a time. */
static void take(Run *r, double time) {
    while (next_setting(r) <= time) {
        const Bundle *b = ROWS(const Bundle, r->bundles) + ROWS(const Event, r->events)[r->taken++].what;
        for (int64_t i = b->first; i < b->last; i++) assign(r->block, ROWS(const Assignment, r->assignments) + i);
    }
}

/* An event more, behind those of the same time. */
static void wait_for(Run *r, double time, int64_t what) {
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

/* The outputs at time 0: a condition that holds has not become true. */
static void hold(const Run *r) {
    Reaction *reactions = ROWS(Reaction, r->reactions);
    for (int64_t i = 0; i < r->reaction_count; i++) reactions[i].held = holds(r, reactions + i);
}

/* Forget the earlier one of two motions: nothing is recorded, and the run is past it. */
static void forget(Run *r) {
    ROWS(double, r->breaks)[0] = ROWS(double, r->breaks)[1];
    ROWS(Motion, r->motions)[0] = ROWS(Motion, r->motions)[1];
    r->motion_count = 1;
    r->place = 0;
}

/* The master goes on from a scan with the acceleration that its drive gives it. */
static void follow(Run *r, double scan) {
    const Motion m = until(r, scan);
    double a = (read(r->block, r->follows, r->kind) - m.velocity) * r->gain / r->scan;
    a = -r->most > a ? -r->most : a;
    a = r->most < a ? r->most : a;
    if (!r->times && r->motion_count == 2) forget(r);
    ROWS(double, r->breaks)[r->motion_count] = scan;
    ROWS(Motion, r->motions)[r->motion_count++] = (Motion){m.position, m.velocity, a, 0.0};
}

/* The outputs at the next look: what becomes true is reacted to from the scan on, and the master follows. */
static void look(Run *r) {
    const int64_t next = r->next++;
    if (r->follows >= 0) follow(r, ROWS(const double, r->scans)[next]);
    Reaction *end = ROWS(Reaction, r->reactions) + r->reaction_count;
    for (Reaction *x = ROWS(Reaction, r->reactions); x < end; x++) {
        const int64_t held = x->held;
        const double time = ROWS(const double, x->at)[next];
        x->held = holds(r, x);
        if (x->held && !held && x->happened != x->times && time < r->stop_time) {
            x->happened++;
            wait_for(r, time, x->what);
        }
    }
}

/* --- a run --- */

/* Record a point: the time, the axis, and in a column each what is asked for. */
static void record(const Scenarios *s, Run *r, double time, Motion m) {
    r->now = time;
    if (!r->times) return;
    const int64_t i = r->count++;
    ROWS(double, r->times)[i] = time;
    ROWS(Motion, r->axis)[i] = m;
    for (int64_t k = 0; k < s->sink_count; k++)
        ROWS(double, r->values + k * r->room)[i] = read(r->block, s->sinks[k].offset, s->sinks[k].kind);
}

/* The number of the first Real that is not allowed; -1 if all are. */
static int64_t refused(const Scenarios *s, int64_t block) {
    for (int64_t k = 0; k < s->limit_count; k++) {
        const Limited *l = s->limits + k;
        if (!allows(&l->limit, AT(const double, block + l->offset))) return k;
    }
    return -1;
}

/* End a run that failed, for a cause; `number`: of the refusal or input. The answer is false. */
static bool stop(Run *r, int64_t cause, int64_t number) {
    r->cause = cause;
    r->number = number;
    return false;
}

/* One step, from t to `end`. False: the run has failed. */
static bool try_step(const Scenarios *s, Run *r, Samples *samples, int64_t i, double t, double end) {
    const double h = end - t;
    bool failed = false;
    r->step = h;
    if (!(0.0 < h && h <= s->longest)) return stop(r, CAUSE_STEP_SIZE, 0);
    show(s, r, t, end);
    const int64_t bad = refused(s, r->block);
    if (bad >= 0) return stop(r, CAUSE_INPUT, bad);
    const int64_t refusal = block_step((Block *)(intptr_t)r->block, h, &failed);
    if (failed || refusal) return stop(r, failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    record(s, r, end, until(r, end));
    if (s->reductions) reduce_step(s->reductions, samples, i, r->block, end, h);
    if (next_look(r) <= end + r->close) look(r);
    return true;
}

/* Begin a run. False: it has failed. */
static bool try_begin(const Scenarios *s, Run *r, Samples *samples, int64_t i) {
    bool failed = false;
    const int64_t refusal = block_initialize((Block *)(intptr_t)r->block, &failed);
    if (failed || refusal) return stop(r, failed ? CAUSE_RAISED : CAUSE_REFUSED, refusal);
    if (s->reductions) reduce_begin(s->reductions, samples, i, r->block);
    record(s, r, 0.0, at(r, 0.0));
    hold(r);
    return true;
}

/* The steps, one by one. Where a step ends depends on what the reactions see at the end of the one before. */
static void carry(const Scenarios *s, Run *r, Samples *samples, int64_t i) {
    const double *points = ROWS(const double, r->points);
    double t = points[0];
    for (int64_t known = 1; known < r->point_count;) {
        take(r, t + r->close);
        const double seen = next_look(r), set = next_setting(r);
        double end = set < seen ? set : seen;
        if (end >= points[known] - r->close) end = points[known++];
        if (!try_step(s, r, samples, i, t, end)) return;
        t = end;
    }
}

/* Carry the runs. One that has a cause already is left alone. */
void script_run(const Scenarios *s) {
    for (int64_t i = 0; i < s->run_count; i++) {
        Run *r = s->runs + i;
        Samples samples = {s->samples, 0, 0.0};
        if (r->cause != CAUSE_NONE) continue;
        if (try_begin(s, r, &samples, i)) carry(s, r, &samples, i);
        if (s->reductions) reduce_end(s->reductions, &samples, i);
    }
}
