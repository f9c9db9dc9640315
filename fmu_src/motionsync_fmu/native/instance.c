/* The core of a native instance over one block of memory, a table of its variables and two functions of block.c: life
 * and steps. The other parts are included, so that the compiler sees all of an instance at once and inlines across
 * them.
 *
 * These files are the same for all blocks: model.h, which is generated, holds the tables. */
#include "instance_memory.h"
#include "instance_messages.h"
#include "instance_ranges.h"

/* No step is done while a Real that each step checks is out of range. Such Reals are counted when they are set, so that
 * a step need not check each of them. */
COLD static bool is_out_of_range(const Instance *self, const Variable *v) {
    return v->checked && !has_allowed_value(self, v);
}

static inline int64_t code_of(Instance *self, int i) { return *(int64_t *)(self->now.model.bytes + CODED[i].offset); }

void *instance_memory(Instance *self) { return &self->now.model; }

COLD void instance_count_out_of_range(Instance *self) {
    self->out_of_range = 0;
    for (int i = 0; i < COUNT; i++) self->out_of_range += is_out_of_range(self, VARIABLES + i);
}

/* Computes from the state what the instance stores besides it. */
COLD static void update_caches(Instance *self) {
    for (int i = 0; CODED[i].offset >= 0; i++) self->codes[i] = code_of(self, i);
    self->episodes = 0;
    for (int i = 0; i < EPISODES; i++) self->episodes += self->now.episodes[i].count != 0;
    instance_count_out_of_range(self);
}

/* The message of a code, in the list of messages that starts there; NULL: it has none. */
COLD static const Message *find_message(int messages, int64_t code) {
    const Message *m = MESSAGES + messages;
    while (m->code && m->code != code) m++;
    return m->code ? m : NULL;
}

/* Logs what a code means, with the values of the variables in its message. */
COLD static void log_message(const Instance *self, Status status, const char *group, const Message *m) {
    if (!m) return;
    const char *separator = *group ? ": " : "";
    instance_report(self, status, "%s%s%s%l", group, separator, text_at(m->text), NUMBERS + m->variables, group, " (");
}

/* --- life --- */

const char *instance_guid(void) { return MODEL_GUID; }

COLD Instance *instance_new(size_t size, Memory memory, LogFunction *log, Status refusal_status) {
    Instance *self = memory.allocate(1, sizeof *self + size);
    if (!self) return NULL;
    memset(self, 0, sizeof *self + size);
    self->memory = memory;
    self->log = log;
    self->refusal_status = refusal_status;
    self->logged_categories = LOG_ALL;
    return self;
}

COLD void instance_free(Instance *self) {
    if (self) self->memory.release(self);
}

void *instance_importer_data(Instance *self) { return self->importer; }

COLD void instance_reset(Instance *self) {
    memset(&self->now, 0, sizeof self->now);
    memcpy(self->now.magic, "motsync1", sizeof self->now.magic);
    memcpy(self->now.guid, MODEL_GUID, sizeof MODEL_GUID);
    self->now.size = sizeof(State);
    self->now.mode = INSTANTIATED;
    self->now.stop = INFINITY;
    block_start((Block *)&self->now.model);
    update_caches(self);
}

Mode instance_mode(const Instance *self) { return (Mode)self->now.mode; }
double instance_time(const Instance *self) { return self->now.time; }

COLD Status instance_set_times(Instance *self, double start, double stop, const char *call) {
    if (!is_finite(start))
        return instance_report(self, STATUS_ERROR, "%s: start time = %r is not allowed: it must be finite", call,
                               start);
    if (!(stop >= start))
        return instance_report(self, STATUS_ERROR, "%s: stop time = %r is not allowed: it must be >= the start time %r",
                               call, stop, start);
    self->now.time = start;
    self->now.stop = stop;
    return STATUS_OK;
}

void instance_enter_initialization(Instance *self) { self->now.mode = INITIALIZING; }

COLD static Status initialize(Instance *self) {
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++)
        if (v->modes && !check_range(self, v, STATUS_ERROR)) return STATUS_ERROR;
    Model before = self->now.model;
    bool failed = false;
    int64_t refusal = block_initialize((Block *)&self->now.model, &failed);
    if (!failed && !refusal) return STATUS_OK;
    if (failed) instance_report(self, STATUS_ERROR, "an arithmetic error: these values lead to no result");
    else log_message(self, STATUS_ERROR, "", find_message(REFUSALS, refusal));
    self->now.model = before;
    return STATUS_ERROR;
}

/* Computes the outputs from parameters and inputs in initialization mode. Errors are logged when that mode is left. */
COLD static void update_outputs(Instance *self) {
    int logged_categories = self->logged_categories;
    self->logged_categories = LOG_NOTHING;
    initialize(self);
    self->logged_categories = logged_categories;
}

COLD Status instance_exit_initialization(Instance *self) {
    if (initialize(self)) return STATUS_ERROR;
    self->now.mode = STEPPING;
    update_caches(self);
    return STATUS_OK;
}

/* --- steps --- */

static bool has_derivatives(void) { return MASTER[0] >= 0; }

/* Whether derivatives of the master's position count: where it is the exact one at the start of the step. */
static bool takes_derivatives(Instance *self) {
    if (!has_derivatives()) return false;
    int64_t mode = *integer_at(self, INPUT_MODE);
    return mode == START_OF_STEP || mode == POSITION_ONLY;
}

/* Replaces inputs by the derivatives that are given for this step, so that they hold the master's motion at the start
 * of the step. Returns whether the values are allowed. */
COLD static bool apply_derivatives(Instance *self) {
    self->replaced_inputs =
        (ReplacedInputs){{*real_at(self, MASTER[1]), *real_at(self, MASTER[2])}, *integer_at(self, INPUT_MODE)};
    for (int order = 1; order <= 2; order++)
        if (self->now.derivatives_given & 1 << order) *real_at(self, MASTER[order]) = self->now.derivatives[order];
    *integer_at(self, INPUT_MODE) = START_OF_STEP;
    return check_range(self, VARIABLES + MASTER[1], self->refusal_status) &&
           check_range(self, VARIABLES + MASTER[2], self->refusal_status);
}

COLD static void restore_inputs(Instance *self) {
    for (int order = 1; order <= 2; order++) *real_at(self, MASTER[order]) = self->replaced_inputs.values[order - 1];
    *integer_at(self, INPUT_MODE) = self->replaced_inputs.mode;
}

/* A refused step has changed nothing: the block guarantees that, so no copy is made. After an arithmetic error, which
 * no block should have, the state is undefined: the instance must be reset. */
static inline Status step_block(Instance *self, double h) {
    bool failed = false;
    int64_t refusal = block_step((Block *)&self->now.model, h, &failed);
    if (failed) {
        self->now.mode = TERMINATED;
        return instance_report(self, STATUS_ERROR,
                               "an arithmetic error: these values lead to no result, and the unit must be reset");
    }
    if (refusal) log_message(self, self->refusal_status, "", find_message(REFUSALS, refusal));
    return refusal ? self->refusal_status : STATUS_OK;
}

/* By how much of itself a step may end past the stop time: importers add up times, and these sums are inexact. */
static const double PAST_STOP = 0.01;

static inline bool is_valid_time(const Instance *self, double time, double h) {
    return (h > 0.0) & (h <= LONGEST_STEP) & is_finite(time) & (time + h <= self->now.stop + PAST_STOP * h);
}

/* A step that would end past the stop time is an error in both versions of FMI: that is what the standards ask for. */
COLD static Status refuse_time(const Instance *self, double time, double h) {
    if (!(h > 0.0 && h <= LONGEST_STEP))
        return instance_report(self, self->refusal_status, "step size = %r is not allowed: it must be > 0 and <= %r", h,
                               LONGEST_STEP);
    if (!is_finite(time))
        return instance_report(self, self->refusal_status, "a step at the time %r is not allowed: it must be finite",
                               time);
    return instance_report(self, STATUS_ERROR,
                           "a step of %r at the time %r is not allowed: it would end past the stop time %r", h, time,
                           self->now.stop);
}

COLD static Status check_all_ranges(Instance *self) {
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].checked && !check_range(self, VARIABLES + i, self->refusal_status))
            return self->refusal_status;
    return STATUS_OK;
}

static inline Status check_step(Instance *self, double time, double h) {
    if (!is_valid_time(self, time, h)) return refuse_time(self, time, h);
    return self->out_of_range ? check_all_ranges(self) : STATUS_OK;
}

/* How far the value that a message reports is from its limit, which comes next in the list of its variables. */
COLD static double distance_to_limit(const Instance *self, const Message *m, double value) {
    int limit = NUMBERS[m->variables + 1];
    return fabs(limit < 0 ? value : value - number_of(self, VARIABLES + limit));
}

/* Logs a code that comes again and again where it comes first, and remembers the worst value. */
COLD static void extend_episode(Instance *self, const Coded *c, const Message *m, bool is_new) {
    Episode *e = self->now.episodes + c->episodes + (m - (MESSAGES + c->messages));
    double value = number_of(self, VARIABLES + NUMBERS[m->variables]);
    if (!e->count) {
        log_message(self, STATUS_WARNING, text_at(c->group), m);
        *e = (Episode){.begin = self->now.time, .first = value, .worst = value};
        self->episodes++;
        is_new = true;
    }
    e->count += is_new;
    e->end = self->now.time;
    if (distance_to_limit(self, m, value) > distance_to_limit(self, m, e->worst)) e->worst = value;
}

/* Logs a whole episode, unless its first message has said all of it. */
COLD static void end_episode(Instance *self, const Coded *c, const Message *m, Episode *e) {
    if (e->count != 1 || e->worst != e->first)
        instance_report(self, STATUS_WARNING, "%s: %s (times: %d, from %f s to %f s, worst: %s = %f%l",
                        text_at(c->group), text_at(m->text), e->count, e->begin, e->end,
                        name_of(VARIABLES + NUMBERS[m->variables]), e->worst, NUMBERS + m->variables + 1,
                        text_at(c->group), ", ");
    *e = (Episode){0};
    self->episodes--;
}

/* Ends the episodes whose code has not come since a time. */
COLD static void end_episodes(Instance *self, double since) {
    for (const Coded *c = CODED; c->offset >= 0; c++) {
        if (c->report != REPORT_EPISODES) continue;
        Episode *e = self->now.episodes + c->episodes;
        for (const Message *m = MESSAGES + c->messages; m->code; m++, e++)
            if (e->count && e->end <= since) end_episode(self, c, m, e);
    }
}

COLD static void log_code(Instance *self, int i) {
    const Coded *c = CODED + i;
    int64_t before = self->codes[i], code = self->codes[i] = code_of(self, i);
    const Message *m = find_message(c->messages, code);
    if (m && c->report == REPORT_EPISODES) extend_episode(self, c, m, code != before);
    else log_message(self, STATUS_WARNING, text_at(c->group), m);
}

static void log_codes(Instance *self) {
    for (int i = 0; CODED[i].offset >= 0; i++)
        if (code_of(self, i) != self->codes[i] || (self->codes[i] && CODED[i].report != REPORT_CHANGES))
            log_code(self, i);
    if (self->episodes) end_episodes(self, self->now.time - QUIET_TIME);
}

COLD void instance_terminate(Instance *self) {
    end_episodes(self, INFINITY);
    self->now.mode = TERMINATED;
}

Status instance_step(Instance *self, double time, double h, const char *call) {
    if (!check_mode(self, STEPPING, call)) return STATUS_ERROR;
    Status status = check_step(self, time, h);
    if (status) return status;
    bool derived = self->now.derivatives_given && takes_derivatives(self);
    status = !derived || apply_derivatives(self) ? step_block(self, h) : self->refusal_status;
    if (derived) restore_inputs(self);
    if (status) return status;
    self->now.derivatives_given = 0;
    self->now.time = time + h;
    log_codes(self);
    return STATUS_OK;
}

/* --- the parts that use what is above --- */

#include "instance_access.h"
#include "instance_states.h"
