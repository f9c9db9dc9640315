/* The core of a native unit over one block of memory, a table of its variables and two functions of block.c: life and
 * steps. The other parts are included, so that the compiler sees all of a unit at once and inlines across them.
 *
 * These files are the same for all blocks: model.h, which is generated, holds the tables. */
#include "unit_memory.h"
#include "unit_messages.h"
#include "unit_ranges.h"

/* No step is done while a Real that each step checks is out of range. Such Reals are counted when they are set, so that a
 * step need not check each of them. */
COLD static bool is_out_of_range(const Unit *u, const Variable *v) { return v->checked && !has_allowed_value(u, v); }

static inline int64_t code_of(Unit *u, int i) { return *(int64_t *)(u->now.model.bytes + CODED[i].offset); }

void *unit_memory(Unit *u) { return &u->now.model; }

COLD void unit_count_out_of_range(Unit *u) {
    u->out_of_range = 0;
    for (int i = 0; i < COUNT; i++) u->out_of_range += is_out_of_range(u, VARIABLES + i);
}

/* Computes from the state what the unit stores besides it. */
COLD static void update_caches(Unit *u) {
    for (int i = 0; CODED[i].offset >= 0; i++) u->codes[i] = code_of(u, i);
    u->episodes = 0;
    for (int i = 0; i < EPISODES; i++) u->episodes += u->now.episodes[i].count != 0;
    unit_count_out_of_range(u);
}

/* The message of a code, in the list of messages that starts there; NULL: it has none. */
COLD static const Message *find_message(int messages, int64_t code) {
    const Message *m = MESSAGES + messages;
    while (m->code && m->code != code) m++;
    return m->code ? m : NULL;
}

/* Logs what a code means, with the values of the variables in its message. */
COLD static void log_message(const Unit *u, Status status, const char *group, const Message *m) {
    if (!m) return;
    const char *separator = *group ? ": " : "";
    unit_report(u, status, "%s%s%s%l", group, separator, text_at(m->text), NUMBERS + m->variables, group, " (");
}

/* --- life --- */

const char *unit_guid(void) { return MODEL_GUID; }

COLD Unit *unit_new(size_t size, Memory memory, LogFunction *log, Status refusal_status) {
    Unit *u = memory.allocate(1, sizeof *u + size);
    if (!u) return NULL;
    memset(u, 0, sizeof *u + size);
    u->memory = memory;
    u->log = log;
    u->refusal_status = refusal_status;
    u->logged_categories = LOG_ALL;
    return u;
}

COLD void unit_free(Unit *u) {
    if (u) u->memory.release(u);
}

void *unit_importer_data(Unit *u) { return u->importer; }

COLD void unit_reset(Unit *u) {
    memset(&u->now, 0, sizeof u->now);
    memcpy(u->now.magic, "motsync1", sizeof u->now.magic);
    memcpy(u->now.guid, MODEL_GUID, sizeof MODEL_GUID);
    u->now.size = sizeof(State);
    u->now.mode = INSTANTIATED;
    u->now.stop = INFINITY;
    block_start((Block *)&u->now.model);
    update_caches(u);
}

Mode unit_mode(const Unit *u) { return (Mode)u->now.mode; }
double unit_time(const Unit *u) { return u->now.time; }

COLD Status unit_set_times(Unit *u, double start, double stop, const char *call) {
    if (!is_finite(start))
        return unit_report(u, UNIT_ERROR, "%s: start time = %r is not allowed: it must be finite", call, start);
    if (!(stop >= start))
        return unit_report(u, UNIT_ERROR, "%s: stop time = %r is not allowed: it must be >= the start time %r", call, stop,
                           start);
    u->now.time = start;
    u->now.stop = stop;
    return UNIT_OK;
}

void unit_enter_initialization(Unit *u) { u->now.mode = INITIALIZING; }

COLD static Status initialize(Unit *u) {
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++)
        if (v->modes && !check_range(u, v, UNIT_ERROR)) return UNIT_ERROR;
    Model before = u->now.model;
    bool failed = false;
    int64_t refusal = block_initialize((Block *)&u->now.model, &failed);
    if (!failed && !refusal) return UNIT_OK;
    if (failed) unit_report(u, UNIT_ERROR, "an arithmetic error: these values lead to no result");
    else log_message(u, UNIT_ERROR, "", find_message(REFUSALS, refusal));
    u->now.model = before;
    return UNIT_ERROR;
}

/* Computes the outputs from parameters and inputs in initialization mode. Errors are logged when that mode is left. */
COLD static void update_outputs(Unit *u) {
    int logged_categories = u->logged_categories;
    u->logged_categories = LOG_NOTHING;
    initialize(u);
    u->logged_categories = logged_categories;
}

COLD Status unit_exit_initialization(Unit *u) {
    if (initialize(u)) return UNIT_ERROR;
    u->now.mode = STEPPING;
    update_caches(u);
    return UNIT_OK;
}

/* --- steps --- */

static bool has_derivatives(void) { return MASTER[0] >= 0; }

/* Whether derivatives of the master's position count: where it is the exact one at the start of the step. */
static bool takes_derivatives(Unit *u) {
    if (!has_derivatives()) return false;
    int64_t mode = *integer_at(u, INPUT_MODE);
    return mode == START_OF_STEP || mode == POSITION_ONLY;
}

/* Replaces inputs by the derivatives that are given for this step, so that they hold the master's motion at the start
 * of the step. Returns whether the values are allowed. */
COLD static bool apply_derivatives(Unit *u) {
    u->replaced_inputs = (ReplacedInputs){{*real_at(u, MASTER[1]), *real_at(u, MASTER[2])}, *integer_at(u, INPUT_MODE)};
    for (int order = 1; order <= 2; order++)
        if (u->now.derivatives_given & 1 << order) *real_at(u, MASTER[order]) = u->now.derivatives[order];
    *integer_at(u, INPUT_MODE) = START_OF_STEP;
    return check_range(u, VARIABLES + MASTER[1], u->refusal_status) &&
           check_range(u, VARIABLES + MASTER[2], u->refusal_status);
}

COLD static void restore_inputs(Unit *u) {
    for (int order = 1; order <= 2; order++) *real_at(u, MASTER[order]) = u->replaced_inputs.values[order - 1];
    *integer_at(u, INPUT_MODE) = u->replaced_inputs.mode;
}

/* A refused step has changed nothing: the block guarantees that, so no copy is made. After an arithmetic error, which
 * no block should have, the state is undefined: the unit must be reset. */
static inline Status step_block(Unit *u, double h) {
    bool failed = false;
    int64_t refusal = block_step((Block *)&u->now.model, h, &failed);
    if (failed) {
        u->now.mode = TERMINATED;
        return unit_report(u, UNIT_ERROR, "an arithmetic error: these values lead to no result, and the unit must be reset");
    }
    if (refusal) log_message(u, u->refusal_status, "", find_message(REFUSALS, refusal));
    return refusal ? u->refusal_status : UNIT_OK;
}

/* By how much of itself a step may end past the stop time: importers add up times, and these sums are inexact. */
static const double PAST_STOP = 0.01;

static inline bool is_valid_time(const Unit *u, double time, double h) {
    return (h > 0.0) & (h <= LONGEST_STEP) & is_finite(time) & (time + h <= u->now.stop + PAST_STOP * h);
}

/* A step that would end past the stop time is an error in both versions of FMI: that is what the standards ask for. */
COLD static Status refuse_time(const Unit *u, double time, double h) {
    if (!(h > 0.0 && h <= LONGEST_STEP))
        return unit_report(u, u->refusal_status, "step size = %r is not allowed: it must be > 0 and <= %r", h, LONGEST_STEP);
    if (!is_finite(time))
        return unit_report(u, u->refusal_status, "a step at the time %r is not allowed: it must be finite", time);
    return unit_report(u, UNIT_ERROR, "a step of %r at the time %r is not allowed: it would end past the stop time %r", h,
                       time, u->now.stop);
}

COLD static Status check_all_ranges(Unit *u) {
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].checked && !check_range(u, VARIABLES + i, u->refusal_status)) return u->refusal_status;
    return UNIT_OK;
}

static inline Status check_step(Unit *u, double time, double h) {
    if (!is_valid_time(u, time, h)) return refuse_time(u, time, h);
    return u->out_of_range ? check_all_ranges(u) : UNIT_OK;
}

/* How far the value that a message reports is from its limit, which comes next in the list of its variables. */
COLD static double distance_to_limit(const Unit *u, const Message *m, double value) {
    int limit = NUMBERS[m->variables + 1];
    return fabs(limit < 0 ? value : value - number_of(u, VARIABLES + limit));
}

/* Logs a code that comes again and again where it comes first, and remembers the worst value. */
COLD static void extend_episode(Unit *u, const Coded *c, const Message *m, bool is_new) {
    Episode *e = u->now.episodes + c->episodes + (m - (MESSAGES + c->messages));
    double value = number_of(u, VARIABLES + NUMBERS[m->variables]);
    if (!e->count) {
        log_message(u, UNIT_WARNING, text_at(c->group), m);
        *e = (Episode){.begin = u->now.time, .first = value, .worst = value};
        u->episodes++;
        is_new = true;
    }
    e->count += is_new;
    e->end = u->now.time;
    if (distance_to_limit(u, m, value) > distance_to_limit(u, m, e->worst)) e->worst = value;
}

/* Logs a whole episode, unless its first message has said all of it. */
COLD static void end_episode(Unit *u, const Coded *c, const Message *m, Episode *e) {
    if (e->count != 1 || e->worst != e->first)
        unit_report(u, UNIT_WARNING, "%s: %s (times: %d, from %f s to %f s, worst: %s = %f%l", text_at(c->group),
                    text_at(m->text), e->count, e->begin, e->end, name_of(VARIABLES + NUMBERS[m->variables]), e->worst,
                    NUMBERS + m->variables + 1, text_at(c->group), ", ");
    *e = (Episode){0};
    u->episodes--;
}

/* Ends the episodes whose code has not come since a time. */
COLD static void end_episodes(Unit *u, double since) {
    for (const Coded *c = CODED; c->offset >= 0; c++) {
        if (c->report != REPORT_EPISODES) continue;
        Episode *e = u->now.episodes + c->episodes;
        for (const Message *m = MESSAGES + c->messages; m->code; m++, e++)
            if (e->count && e->end <= since) end_episode(u, c, m, e);
    }
}

COLD static void log_code(Unit *u, int i) {
    const Coded *c = CODED + i;
    int64_t before = u->codes[i], code = u->codes[i] = code_of(u, i);
    const Message *m = find_message(c->messages, code);
    if (m && c->report == REPORT_EPISODES) extend_episode(u, c, m, code != before);
    else log_message(u, UNIT_WARNING, text_at(c->group), m);
}

static void log_codes(Unit *u) {
    for (int i = 0; CODED[i].offset >= 0; i++)
        if (code_of(u, i) != u->codes[i] || (u->codes[i] && CODED[i].report != REPORT_CHANGES)) log_code(u, i);
    if (u->episodes) end_episodes(u, u->now.time - QUIET_TIME);
}

COLD void unit_terminate(Unit *u) {
    end_episodes(u, INFINITY);
    u->now.mode = TERMINATED;
}

Status unit_step(Unit *u, double time, double h, const char *call) {
    if (!check_mode(u, STEPPING, call)) return UNIT_ERROR;
    Status status = check_step(u, time, h);
    if (status) return status;
    bool derived = u->now.derivatives_given && takes_derivatives(u);
    status = !derived || apply_derivatives(u) ? step_block(u, h) : u->refusal_status;
    if (derived) restore_inputs(u);
    if (status) return status;
    u->now.derivatives_given = 0;
    u->now.time = time + h;
    log_codes(u);
    return UNIT_OK;
}

/* --- the parts that use what is above --- */

#include "unit_access.h"
#include "unit_states.h"
