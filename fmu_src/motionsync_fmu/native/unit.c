/* The core of a native unit over one flat block of memory, a table of its variables and two functions of block.c.
 *
 * This file is the same for all blocks: model.h, which is generated, holds the tables. */
#include "unit.h"
#include "heat.h"
#include "decimal.h"
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Texts and lists of numbers are given by their places in TEXTS and NUMBERS. Pointers would need a relocation whenever
 * the library is loaded, and the table of these relocations would be as large as all other tables together. */
typedef struct { /* the allowed values of some variables */
    double min, max, smallest; /* of a number; smallest: the least magnitude but for 0 */
    bool zero; /* whether a number may be 0 */
    uint16_t choices; /* of an enumeration: how many members it has, then their numbers */
    uint16_t text; /* the same in words */
} Range;

typedef struct { /* in this order the table is smallest, packed */
    int16_t offset; /* in the model's memory; or TIME_OFFSET */
    uint16_t range; /* in RANGES */
    uint8_t modes; /* those in which it can be set */
    bool input;
    uint16_t role; /* such as "fixed parameter" */
    bool judged; /* a Real whose range each step checks */
    uint8_t kind; /* a Kind */
} Variable;

typedef struct {
    int32_t code; /* 0 in the last message of a list */
    uint16_t text;
    uint16_t shown; /* whose values the message shows: a list for `named`, which ends with -1 */
} Message;

typedef struct {
    int16_t offset; /* in the model's memory; -1 in the last row */
    uint16_t group; /* in which the variable lies that holds the code; empty if in none */
    uint16_t messages; /* where in MESSAGES the list of what its values mean begins */
} Coded;

typedef struct {
    int32_t offset, most;
} Count;

#define TIME_OFFSET (-(int)sizeof(double)) /* of the time, where that is a variable: it lies before the model's memory */
#include "model.h"

static const char *words(int place) { return TEXTS + place; }

enum { COUNT = sizeof VARIABLES / sizeof *VARIABLES };

/* TEXTS begin with the names of the variables, in their order. */
COLD static const char *name_of(const Variable *v) {
    const char *name = TEXTS;
    for (ptrdiff_t n = v - VARIABLES; n; n--) name += strlen(name) + 1;
    return name;
}

/* What block.c has. Here a block is so many bytes: the names in its header are those of its Python source, and some are
 * used here for other things. The latter two return the refusal, and set `failed` where Python would raise. */
typedef struct Block Block;
void block_start(Block *self);
int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed);

typedef union {
    double aligned;
    uint8_t bytes[MODEL_SIZE];
} Model;

typedef struct { /* no member leaves a gap, so that all bytes of a state are determined */
    char magic[8], guid[40];
    uint64_t size, checksum; /* the checksum is that of serialized bytes, otherwise 0 */
    int64_t mode;
    int64_t given; /* bit n: the next step has a derivative of order n of the master's position */
    double derivatives[3]; /* by order; the first is unused */
    double stop, time; /* stop: INFINITY if there is none; the time comes last: TIME_OFFSET */
    Model model;
} State;

MUST_HOLD(the_time_lies_before_the_model, offsetof(State, model) + TIME_OFFSET == offsetof(State, time));
MUST_HOLD(a_state_has_no_gaps, sizeof MODEL_GUID <= 40 && sizeof(State) == 8 + 40 + 9 * 8 + sizeof(Model));

typedef struct { /* the inputs that a step replaces where derivatives of the master's position are given for it */
    double values[2]; /* the master's velocity and acceleration */
    int64_t mode;
} Replaced;

struct Unit {
    State now;
    int unfit; /* the number of judged Reals outside their ranges; a step needs 0 */
    int64_t codes[sizeof CODED / sizeof *CODED]; /* as the last step left them */
    Replaced replaced; /* in a step */
    int logged; /* a set of Category */
    Status refused; /* what a refused step answers */
    Memory memory;
    Write *write;
    void *importer[]; /* of the size given to unit_new, aligned for pointers */
};

/* --- one value --- */

static inline void *at(Unit *u, const Variable *v) { return (uint8_t *)&u->now + (offsetof(State, model) + v->offset); }
static inline double *real(Unit *u, int variable) { return at(u, VARIABLES + variable); }
static inline int64_t *integer(Unit *u, int variable) { return at(u, VARIABLES + variable); }
static inline const void *held(const Unit *u, const Variable *v) { return at((Unit *)u, v); }

/* A value as a number; that of a Boolean is 0 or 1. */
COLD static double number_of(const Unit *u, const Variable *v) {
    switch (v->kind) {
    case REAL: return *(const double *)held(u, v);
    case BOOLEAN: return *(const uint8_t *)held(u, v);
    default: return (double)*(const int64_t *)held(u, v);
    }
}

/* --- messages: no text has a percent sign, since many importers use the text as a format --- */

typedef struct {
    char bytes[2048];
    size_t length;
} Text;

COLD static void append(Text *text, const char *from, size_t length) {
    size_t room = sizeof text->bytes - 1 - text->length;
    if (length > room) length = room;
    memcpy(text->bytes + text->length, from, length);
    text->length += length;
    text->bytes[text->length] = 0;
}

COLD static void append_text(Text *text, const char *from) { append(text, from, strlen(from)); }

COLD static void append_integer(Text *text, int64_t x) {
    char digits[20];
    size_t first = sizeof digits;
    uint64_t rest = x < 0 ? -(uint64_t)x : (uint64_t)x;
    do digits[--first] = (char)('0' + rest % 10);
    while (rest /= 10);
    if (x < 0) digits[--first] = '-';
    append(text, digits + first, sizeof digits - first);
}

COLD static void append_real(Text *text, double x) {
    char digits[DECIMAL_ROOM];
    append(text, digits, decimal(x, digits));
}

COLD static void append_value(Text *text, const Unit *u, const Variable *v) {
    append_text(text, name_of(v));
    append_text(text, " = ");
    if (v->kind == REAL) append_real(text, number_of(u, v));
    else if (v->kind == BOOLEAN) append_text(text, number_of(u, v) != 0.0 ? "True" : "False");
    else append_integer(text, *(const int64_t *)held(u, v));
}

/* A variable by its number; or, with a number from COUNT on, the one in this group whose name ends with the text at that
 * place, NULL if the group has none. */
COLD static const Variable *named(int number, const char *group) {
    if (number < COUNT) return VARIABLES + number;
    const char *name = TEXTS;
    size_t length = strlen(group);
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++, name += strlen(name) + 1)
        if (!memcmp(name, group, length) && !strcmp(name + length, words(number - COUNT))) return v;
    return NULL;
}

COLD static void append_values(Text *text, const Unit *u, const int16_t *list, const char *group) {
    const char *before = " (";
    for (; *list >= 0; list++) {
        const Variable *v = named(*list, group);
        if (!v) continue;
        append_text(text, before);
        append_value(text, u, v);
        before = ", ";
    }
    if (*before == ',') append_text(text, ")");
}

/* Whether anybody reads messages of this status: if not, no text is made. */
static bool heard(const Unit *u, Status status) {
    static const Category CATEGORIES[] = {LOG_NOTHING, LOG_WARNING, LOG_DISCARD, LOG_ERROR};
    return u->write && u->logged & CATEGORIES[status];
}

COLD void unit_log(Unit *u, int categories) { u->logged = categories; }

/* Beside what the header tells, %v stands for a variable and its value, %l for those of a list, of which a group follows. */
COLD Status unit_say(const Unit *u, Status status, const char *format, ...) {
    if (!heard(u, status)) return status;
    Text text;
    text.length = 0;
    va_list arguments;
    va_start(arguments, format);
    for (; *format; format++) {
        if (*format != '%') append(&text, format, 1);
        else if (*++format == 's') append_text(&text, va_arg(arguments, const char *));
        else if (*format == 'd') append_integer(&text, va_arg(arguments, int64_t));
        else if (*format == 'v') append_value(&text, u, va_arg(arguments, const Variable *));
        else if (*format == 'r') append_real(&text, va_arg(arguments, double));
        else {
            const int16_t *list = va_arg(arguments, const int16_t *);
            append_values(&text, u, list, va_arg(arguments, const char *));
        }
    }
    va_end(arguments);
    u->write(u->importer, status, text.bytes);
    return status;
}

COLD static const char *phase_of(int64_t mode) {
    switch (mode) {
    case INSTANTIATED: return "is instantiated";
    case INITIALIZING: return "is in initialization mode";
    case STEPPING: return "is in step mode";
    default: return "has been terminated";
    }
}

COLD bool unit_may(const Unit *u, int modes, const char *call) {
    if (!u) return false;
    if (!(u->now.mode & modes)) unit_say(u, UNIT_ERROR, "%s is not allowed now: the unit %s", call, phase_of(u->now.mode));
    return u->now.mode & modes;
}

/* The same for the functions that are called most: this one can be inlined, and calls only to report an error. */
static inline bool may(const Unit *u, int modes, const char *call) {
    return (u && u->now.mode & modes) || unit_may(u, modes, call);
}

COLD bool unit_given(const Unit *u, const void *pointer, const char *call) {
    if (u && !pointer) unit_say(u, UNIT_ERROR, "%s: a pointer is missing", call);
    return u && pointer;
}

/* --- ranges --- */

static inline bool is_finite(double x) { return fabs(x) <= DBL_MAX; }

static inline const Range *range_of(const Variable *v) { return RANGES + v->range; }

/* Whether a number is in its variable's range; NaN fails every comparison. */
static inline bool fits(const Variable *v, double x) {
    const Range *range = range_of(v);
    return (x >= range->min) & (x <= range->max) & ((fabs(x) >= range->smallest) | ((x == 0.0) & range->zero));
}

COLD static bool allows(const Unit *u, const Variable *v) {
    if (v->kind == BOOLEAN) return true;
    if (v->kind != ENUMERATION) return fits(v, number_of(u, v));
    const int16_t *choices = NUMBERS + range_of(v)->choices;
    for (int i = 1; i <= choices[0]; i++)
        if (choices[i] == *(const int64_t *)held(u, v)) return true;
    return false;
}

/* Whether a variable has an allowed value; if not, that is logged with this status. */
COLD static bool judge(const Unit *u, const Variable *v, Status status) {
    if (allows(u, v)) return true;
    const char *hint = v->input && number_of(u, v) == 0.0 ? "; an unwired input gives 0" : "";
    unit_say(u, status, "%v is not allowed: it must be %s%s", v, words(range_of(v)->text), hint);
    return false;
}

/* No step is done while a Real is unfit that each step checks. Unfit Reals are counted where they are set, so that a
 * step need not look at each. */
COLD static bool unfit(const Unit *u, const Variable *v) { return v->judged && !allows(u, v); }

static inline int64_t code_of(Unit *u, int i) { return *(int64_t *)(u->now.model.bytes + CODED[i].offset); }

/* Find out what the unit knows of its state beside it. */
COLD static void look(Unit *u) {
    for (int i = 0; CODED[i].offset >= 0; i++) u->codes[i] = code_of(u, i);
    u->unfit = 0;
    for (int i = 0; i < COUNT; i++) u->unfit += unfit(u, VARIABLES + i);
}

/* Log what a code means, with the values of the variables that its message shows. */
COLD static void explain(const Unit *u, Status status, const char *group, int messages, int64_t code) {
    const Message *m = MESSAGES + messages;
    while (m->code && m->code != code) m++;
    if (m->code) unit_say(u, status, "%s%s%s%l", group, *group ? ": " : "", words(m->text), NUMBERS + m->shown, group);
}

/* --- life --- */

const char *unit_guid(void) { return MODEL_GUID; }

COLD Unit *unit_new(size_t size, Memory memory, Write *write, Status refused) {
    Unit *u = memory.allocate(1, sizeof *u + size);
    if (!u) return NULL;
    memset(u, 0, sizeof *u + size);
    u->memory = memory;
    u->write = write;
    u->refused = refused;
    u->logged = LOG_ALL;
    return u;
}

COLD void unit_free(Unit *u) {
    if (u) u->memory.release(u);
}

void *unit_importer(Unit *u) { return u->importer; }

COLD void unit_reset(Unit *u) {
    memset(&u->now, 0, sizeof u->now);
    memcpy(u->now.magic, "motsync1", sizeof u->now.magic);
    memcpy(u->now.guid, MODEL_GUID, sizeof MODEL_GUID);
    u->now.size = sizeof(State);
    u->now.mode = INSTANTIATED;
    u->now.stop = INFINITY;
    block_start((Block *)&u->now.model);
    look(u);
}

Mode unit_mode(const Unit *u) { return (Mode)u->now.mode; }
double unit_time(const Unit *u) { return u->now.time; }

COLD Status unit_set_times(Unit *u, double start, double stop, const char *call) {
    if (!is_finite(start)) return unit_say(u, UNIT_ERROR, "%s: start time = %r is not allowed: it must be finite", call, start);
    if (!(stop >= start))
        return unit_say(u, UNIT_ERROR, "%s: stop time = %r is not allowed: it must be >= the start time %r", call, stop, start);
    u->now.time = start;
    u->now.stop = stop;
    return UNIT_OK;
}

void unit_enter_initialization(Unit *u) { u->now.mode = INITIALIZING; }
void unit_terminate(Unit *u) { u->now.mode = TERMINATED; }

COLD static Status initialize(Unit *u) {
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++)
        if (v->modes && !judge(u, v, UNIT_ERROR)) return UNIT_ERROR;
    Model before = u->now.model;
    bool failed = false;
    int64_t refusal = block_initialize((Block *)&u->now.model, &failed);
    if (!failed && !refusal) return UNIT_OK;
    if (failed) unit_say(u, UNIT_ERROR, "an arithmetic error: these values lead to no result");
    else explain(u, UNIT_ERROR, "", REFUSALS, refusal);
    u->now.model = before;
    return UNIT_ERROR;
}

/* In initialization mode, let the outputs follow parameters and inputs. Errors are logged when that mode is left. */
COLD static void follow(Unit *u) {
    int logged = u->logged;
    u->logged = LOG_NOTHING;
    initialize(u);
    u->logged = logged;
}

COLD Status unit_exit_initialization(Unit *u) {
    if (initialize(u)) return UNIT_ERROR;
    u->now.mode = STEPPING;
    look(u);
    return UNIT_OK;
}

/* --- steps --- */

static bool has_derivatives(void) { return MASTER[0] >= 0; }

/* Puts the derivatives that are given for this step in the place of the inputs, which then hold the master at the step's
 * beginning. Whether they are allowed. */
COLD static bool replace(Unit *u) {
    u->replaced = (Replaced){{*real(u, MASTER[1]), *real(u, MASTER[2])}, *integer(u, INPUT_MODE)};
    for (int order = 1; order <= 2; order++)
        if (u->now.given & 1 << order) *real(u, MASTER[order]) = u->now.derivatives[order];
    *integer(u, INPUT_MODE) = START_OF_STEP;
    return judge(u, VARIABLES + MASTER[1], u->refused) && judge(u, VARIABLES + MASTER[2], u->refused);
}

COLD static void put_back(Unit *u) {
    for (int order = 1; order <= 2; order++) *real(u, MASTER[order]) = u->replaced.values[order - 1];
    *integer(u, INPUT_MODE) = u->replaced.mode;
}

/* A refused step has changed nothing: the block guarantees that, so no copy is made. After an arithmetic error, which
 * no block should have, the state is undefined: the unit must be reset. */
static inline Status run(Unit *u, double h) {
    bool failed = false;
    int64_t refusal = block_step((Block *)&u->now.model, h, &failed);
    if (failed) {
        u->now.mode = TERMINATED;
        return unit_say(u, UNIT_ERROR, "an arithmetic error: these values lead to no result, and the unit must be reset");
    }
    if (refusal) explain(u, u->refused, "", REFUSALS, refusal);
    return refusal ? u->refused : UNIT_OK;
}

/* By how much of itself a step may end past the stop time: importers add up times, and these sums are inexact. */
static const double PAST_STOP = 0.01;

static inline bool in_time(const Unit *u, double time, double h) {
    return (h > 0.0) & (h <= LONGEST_STEP) & is_finite(time) & (time + h <= u->now.stop + PAST_STOP * h);
}

COLD static void tell_time(const Unit *u, double time, double h) {
    if (!(h > 0.0 && h <= LONGEST_STEP))
        unit_say(u, u->refused, "step size = %r is not allowed: it must be > 0 and <= %r", h, LONGEST_STEP);
    else if (!is_finite(time)) unit_say(u, u->refused, "a step at the time %r is not allowed: it must be finite", time);
    else
        unit_say(u, u->refused, "a step of %r at the time %r is not allowed: it would end past the stop time %r", h, time,
               u->now.stop);
}

COLD static bool judge_all(Unit *u) {
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].judged && !judge(u, VARIABLES + i, u->refused)) return false;
    return true;
}

static inline bool ready(Unit *u, double time, double h) {
    if (!in_time(u, time, h)) {
        tell_time(u, time, h);
        return false;
    }
    return !u->unfit || judge_all(u);
}

COLD static void tell_code(Unit *u, int i) {
    int64_t code = u->codes[i] = code_of(u, i);
    if (code) explain(u, UNIT_WARNING, words(CODED[i].group), CODED[i].messages, code);
}

Status unit_step(Unit *u, double time, double h, const char *call) {
    if (!may(u, STEPPING, call)) return UNIT_ERROR;
    if (!ready(u, time, h)) return u->refused;
    bool derived = has_derivatives() && u->now.given && *integer(u, INPUT_MODE) != END_OF_STEP;
    Status status = !derived || replace(u) ? run(u, h) : u->refused;
    if (derived) put_back(u);
    if (status) return status;
    u->now.given = 0;
    u->now.time = time + h;
    for (int i = 0; CODED[i].offset >= 0; i++)
        if (code_of(u, i) != u->codes[i]) tell_code(u, i);
    return UNIT_OK;
}

/* --- getters and setters --- */

COLD static const char *kind_names(int kinds) {
    switch (kinds) {
    case REAL: return "Real";
    case INTEGER: return "Integer";
    case ENUMERATION: return "Enumeration";
    case BOOLEAN: return "Boolean";
    default: return "Integer or Enumeration";
    }
}

static inline bool is_one(uint32_t r, int kinds) { return r < COUNT && kinds & VARIABLES[r].kind; }

COLD static bool none_has(const Unit *u, uint32_t r, int kinds) {
    unit_say(u, UNIT_ERROR, "no %s has the value reference %d", kind_names(kinds), (int64_t)r);
    return false;
}

COLD static bool cannot_be_set(const Unit *u, uint32_t r) {
    unit_say(u, UNIT_ERROR, "%s (%s) cannot be set now", name_of(VARIABLES + r), words(VARIABLES[r].role));
    return false;
}

static inline bool can_get(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!may(u, modes, call)) return false;
    if (n && !(r && values)) return unit_given(u, NULL, call);
    for (size_t i = 0; i < n; i++)
        if (!is_one(r[i], kinds)) return none_has(u, r[i], kinds);
    if (u->now.mode == INITIALIZING) follow(u);
    return true;
}

static inline bool can_set(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!may(u, modes, call)) return false;
    if (n && !(r && values)) return unit_given(u, NULL, call);
    for (size_t i = 0; i < n; i++) {
        if (!is_one(r[i], kinds)) return none_has(u, r[i], kinds);
        if (!(VARIABLES[r[i]].modes & u->now.mode)) return cannot_be_set(u, r[i]);
    }
    return true;
}

/* The same for the kinds that are got and set less often than Reals: one function for all of them. */
static bool can_get_others(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_get(u, modes, kinds, r, n, values, call);
}

static bool can_set_others(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_set(u, modes, kinds, r, n, values, call);
}

COLD static void put_unfit(Unit *u, const Variable *v, double x) {
    u->unfit -= unfit(u, v);
    *(double *)at(u, v) = x;
    u->unfit += unfit(u, v);
}

static inline void put_real(Unit *u, const Variable *v, double x) {
    const Range *range = range_of(v);
    bool fit = x >= range->min && x <= range->max && fabs(x) >= range->smallest; /* as mostly, but for some zeros */
    if (fit && !u->unfit) *(double *)at(u, v) = x;
    else put_unfit(u, v, x);
}
static inline void put_integer(Unit *u, const Variable *v, int64_t x) { *(int64_t *)at(u, v) = x; }
static inline void put_boolean(Unit *u, const Variable *v, int32_t x) { *(uint8_t *)at(u, v) = x != 0; }

/* A getter and a setter. FURTHER: a further parameter, `kinds`, or nothing; Given and Held: the type of the values for the
 * importer, and in the model's memory; `others`: what can_get and can_set end with. */
#define ACCESS(names, name, FURTHER, kinds, Given, Held, others)                                             \
    Status unit_get_##names(Unit *u, int modes, FURTHER const uint32_t r[], size_t n, Given values[],        \
                            const char *call) {                                                              \
        if (!can_get##others(u, modes, kinds, r, n, values, call)) return UNIT_ERROR;                        \
        for (size_t i = 0; i < n; i++) values[i] = (Given)*(const Held *)held(u, VARIABLES + r[i]);          \
        return UNIT_OK;                                                                                      \
    }                                                                                                        \
    Status unit_set_##names(Unit *u, int modes, FURTHER const uint32_t r[], size_t n, const Given values[],  \
                            const char *call) {                                                              \
        if (!can_set##others(u, modes, kinds, r, n, values, call)) return UNIT_ERROR;                        \
        for (size_t i = 0; i < n; i++) put_##name(u, VARIABLES + r[i], values[i]);                           \
        return UNIT_OK;                                                                                      \
    }
#define KINDS int kinds,
ACCESS(reals, real, , REAL, double, double, )
ACCESS(integers, integer, KINDS, kinds, int32_t, int64_t, _others)
ACCESS(enumerations, integer, , ENUMERATION, int64_t, int64_t, _others)
ACCESS(booleans, boolean, , BOOLEAN, int32_t, uint8_t, _others)
ACCESS(flags, boolean, , BOOLEAN, bool, uint8_t, _others)

/* --- derivatives --- */

/* Whether derivatives can be handed over now, and are lists of n things each. */
COLD static bool may_derive(const Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                            const double values[], const char *call) {
    if (!unit_may(u, modes, call)) return false;
    return !n || (unit_given(u, r, call) && unit_given(u, orders, call) && unit_given(u, values, call));
}

COLD static bool are_settable(const Unit *u, const uint32_t r[], size_t n, const int32_t orders[], const char *call) {
    for (size_t i = 0; i < n; i++) {
        if (!is_one(r[i], REAL)) return none_has(u, r[i], REAL);
        const Variable *v = VARIABLES + r[i];
        if (!v->input) {
            unit_say(u, UNIT_ERROR, "%s: %s (%s) is no input", call, name_of(v), words(v->role));
            return false;
        }
        if (orders[i] < 1) {
            unit_say(u, UNIT_ERROR, "%s: order = %d is not allowed: it must be >= 1", call, (int64_t)orders[i]);
            return false;
        }
    }
    return true;
}

COLD Status unit_set_input_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                       const double values[], const char *call) {
    if (!may_derive(u, modes, r, n, orders, values, call) || !are_settable(u, r, n, orders, call)) return UNIT_ERROR;
    bool ignored = false;
    for (size_t i = 0; i < n; i++) {
        if (has_derivatives() && (int)r[i] == MASTER[0] && orders[i] <= 2 && *integer(u, INPUT_MODE) != END_OF_STEP) {
            u->now.derivatives[orders[i]] = values[i];
            u->now.given |= 1 << orders[i];
        } else {
            ignored = true;
        }
    }
    if (!ignored) return UNIT_OK;
    return unit_say(u, UNIT_WARNING,
                    "%s: ignored but for orders 1 and 2 of the master's position where it is the one at the step's "
                    "beginning",
                    call);
}

COLD Status unit_get_output_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                        double values[], const char *call) {
    if (!may_derive(u, modes, r, n, orders, values, call)) return UNIT_ERROR;
    for (size_t i = 0; i < n; i++) {
        if (!is_one(r[i], REAL)) return none_has(u, r[i], REAL), UNIT_ERROR;
        if ((int)r[i] != SLAVE[0] || orders[i] < 1 || orders[i] > 2)
            return unit_say(u, UNIT_ERROR, "%s: only orders 1 and 2 of the slave's position are known", call);
    }
    for (size_t i = 0; i < n; i++) values[i] = *real(u, SLAVE[orders[i]]);
    return UNIT_OK;
}

/* --- states --- */

/* FNV-1a by words: any change within one word changes the sum. The checksum itself counts as 0. */
static uint64_t checksum(const uint8_t *state) {
    uint64_t sum = 14695981039346656037u;
    for (size_t i = 0; i < sizeof(State); i += sizeof sum) {
        uint64_t word = 0;
        if (i != offsetof(State, checksum)) memcpy(&word, state + i, sizeof word);
        sum = (sum ^ word) * 1099511628211u;
        sum ^= sum >> 32;
    }
    return sum;
}

COLD static bool ours(const Unit *u, const void *state, const char *call) {
    if (!unit_given(u, state, call)) return false;
    bool same = !memcmp(state, &u->now, offsetof(State, checksum)); /* magic, GUID and size */
    if (!same) unit_say(u, UNIT_ERROR, "%s: this FMU state belongs to another FMU", call);
    return same;
}

COLD static State *new_state(const Unit *u, const char *call) {
    State *made = u->memory.allocate(1, sizeof *made);
    if (!made) unit_say(u, UNIT_ERROR, "%s: out of memory", call);
    return made;
}

COLD Status unit_save(const Unit *u, void **state, const char *call) {
    if (!unit_given(u, state, call) || (*state && !ours(u, *state, call))) return UNIT_ERROR;
    if (!*state && !(*state = new_state(u, call))) return UNIT_ERROR;
    memcpy(*state, &u->now, sizeof(State));
    return UNIT_OK;
}

COLD Status unit_restore(Unit *u, const void *state, const char *call) {
    if (!ours(u, state, call)) return UNIT_ERROR;
    memcpy(&u->now, state, sizeof(State));
    look(u);
    return UNIT_OK;
}

COLD Status unit_free_state(const Unit *u, void **state, const char *call) {
    if (!u) return UNIT_ERROR;
    if (!state || !*state) return UNIT_OK; /* the standard: nothing to do */
    if (!ours(u, *state, call)) return UNIT_ERROR;
    u->memory.release(*state);
    *state = NULL;
    return UNIT_OK;
}

COLD Status unit_serialized_size(const Unit *u, const void *state, size_t *n, const char *call) {
    if (!ours(u, state, call) || !unit_given(u, n, call)) return UNIT_ERROR;
    *n = sizeof(State);
    return UNIT_OK;
}

COLD Status unit_serialize(const Unit *u, const void *state, uint8_t bytes[], size_t n, const char *call) {
    if (!ours(u, state, call) || !unit_given(u, bytes, call)) return UNIT_ERROR;
    if (n < sizeof(State)) return unit_say(u, UNIT_ERROR, "%s: there must be room for %d bytes", call, (int64_t)sizeof(State));
    memcpy(bytes, state, sizeof(State));
    uint64_t sum = checksum(bytes);
    memcpy(bytes + offsetof(State, checksum), &sum, sizeof sum);
    return UNIT_OK;
}

/* Whether all that loops and branches rely on is as the block leaves it. */
COLD static bool sound(const Model *model) {
    const uint8_t *flag = model->bytes - 1;
    for (const uint16_t *distance = FLAGS; *distance; distance++)
        if (*(flag += *distance) > 1) return false;
    for (const Count *count = COUNTS; count->offset >= 0; count++) {
        int64_t value;
        memcpy(&value, model->bytes + count->offset, sizeof value);
        if (value < 0 || value > count->most) return false;
    }
    return true;
}

/* Whether a state can be one that this unit has made. Its checksum does not tell that: a forged state may have one. */
COLD static bool possible(const State *s) {
    int64_t derivatives = has_derivatives() ? 1 << 1 | 1 << 2 : 0;
    bool known = s->mode == INSTANTIATED || s->mode == INITIALIZING || s->mode == STEPPING || s->mode == TERMINATED;
    return known && !(s->given & ~derivatives) && is_finite(s->time) && s->stop == s->stop && sound(&s->model);
}

COLD Status unit_deserialize(const Unit *u, const uint8_t bytes[], size_t n, void **state, const char *call) {
    if (!unit_given(u, bytes, call) || !unit_given(u, state, call)) return UNIT_ERROR;
    if (n != sizeof(State))
        return unit_say(u, UNIT_ERROR, "%s: an FMU state of this unit has %d bytes", call, (int64_t)sizeof(State));
    if (!ours(u, bytes, call)) return UNIT_ERROR;
    uint64_t sum;
    memcpy(&sum, bytes + offsetof(State, checksum), sizeof sum);
    if (sum != checksum(bytes)) return unit_say(u, UNIT_ERROR, "%s: this FMU state is damaged", call);
    State *made = new_state(u, call);
    if (!made) return UNIT_ERROR;
    memcpy(made, bytes, sizeof *made);
    made->checksum = 0;
    if (!possible(made)) {
        u->memory.release(made);
        return unit_say(u, UNIT_ERROR, "%s: this FMU state is none that this unit makes", call);
    }
    *state = made;
    return UNIT_OK;
}
