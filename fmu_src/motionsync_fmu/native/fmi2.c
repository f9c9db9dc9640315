/* FMI 2.0 co-simulation over one flat block of memory, a table of its variables and two compiled functions.
 *
 * The same for all blocks: model.h, which is generated, holds the memory's start image and the tables. There are no
 * globals: all that changes lies in the instance. A call that fails changes nothing, tells why, and may be repeated. */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmi2Functions.h"

typedef enum { REAL, INTEGER, BOOLEAN, ENUMERATION } Kind;
typedef enum { OUTPUT, INPUT, TUNABLE, FIXED } Access; /* OUTPUT is never set, FIXED only before stepping */

/* Texts and lists of numbers are told by their places in TEXTS and NUMBERS: pointers would have to be put right whenever
 * the library is loaded, and the table of these would be as large as all others. */
typedef struct {
    int name, role; /* such as "fixed parameter" */
    Kind kind;
    Access access;
    size_t offset; /* in the model's memory */
    double min, max, above, below, smallest; /* of a number: min and max are allowed, above and below are not;
                                                smallest but for 0 */
    bool zero; /* whether a number may be 0 */
    int choices; /* of an enumeration: how many, then its numbers */
    int range; /* the allowed values in words */
} Variable;

typedef struct {
    int64_t code; /* of the last of a list: 0 */
    int text;
    int shown; /* the variables that it speaks of; ended by -1 */
} Message;

typedef struct {
    int variable; /* of the last: -1 */
    int messages; /* what its values mean: where in MESSAGES that begins */
} Coded;

#include "model.h"

static const char *words(int place) { return TEXTS + place; }

enum { COUNT = sizeof VARIABLES / sizeof *VARIABLES };
enum { REALS = 1 << REAL, INTEGERS = 1 << INTEGER | 1 << ENUMERATION, BOOLEANS = 1 << BOOLEAN }; /* sets of kinds */

/* Numba's calling convention: where the answer goes, where an exception goes; other than 0 if there was one. */
int32_t model_initialize(int64_t *refusal, void **exception, void *model);
int32_t model_step(int64_t *refusal, void **exception, void *model, double h);

typedef enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY = 15 } Mode; /* or a set of them */

typedef union {
    double aligned;
    uint8_t bytes[MODEL_SIZE];
} Model;

typedef struct { /* an FMU state; no member leaves a gap, so its bytes are all known */
    char magic[8], guid[40];
    uint64_t size, checksum; /* the checksum is that of serialized bytes, otherwise 0 */
    int64_t mode;
    int64_t given; /* bit n: the next step has a derivative of order n of the master's position */
    double derivatives[3]; /* by order; the first is unused */
    double time;
    Model model;
} State;

_Static_assert(sizeof MODEL_GUID <= 40 && sizeof(State) == 8 + 40 + 8 * 8 + sizeof(Model), "State has gaps");

typedef struct {
    State now;
    int unfit; /* how many Real inputs have values with which no step is done */
    int logged; /* the categories that are switched on: a set of Category */
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[];
} Instance;

/* --- log: no text has a percent sign, since many an importer takes it for a format --- */

typedef enum { LOG_WARNING = 1, LOG_ERROR = 2, LOG_ALL = 3 } Category;

typedef struct {
    char bytes[2048];
    size_t length;
} Text;

static void append(Text *text, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int more = vsnprintf(text->bytes + text->length, sizeof text->bytes - text->length, format, arguments);
    va_end(arguments);
    text->length += more > 0 ? (size_t)more : 0;
    if (text->length >= sizeof text->bytes) text->length = sizeof text->bytes - 1;
}

/* The fewest of 6, 15, 16 or 17 digits that read back as the same number, whatever the locale. */
static void append_real(Text *text, double x) {
    static const int DIGITS[] = {6, 15, 16, 17};
    char number[40];
    if (!__builtin_isfinite(x)) {
        append(text, "%s", x != x ? "nan" : x > 0.0 ? "inf" : "-inf");
        return;
    }
    for (int i = 0; i < 4; i++) {
        snprintf(number, sizeof number, "%.*g", DIGITS[i], x);
        if (strtod(number, NULL) == x) break;
    }
    for (char *p = number; *p; p++)
        if (*p == ',') *p = '.';
    append(text, "%s", number);
}

static void say(const Instance *c, fmi2Status status, const char *text) {
    bool warning = status == fmi2Warning;
    if (c->logger && c->logged & (warning ? LOG_WARNING : LOG_ERROR))
        c->logger(c->environment, c->name, status, warning ? "logStatusWarning" : "logStatusError", text);
}

static fmi2Status fail(const Instance *c, const char *format, ...) {
    Text text = {.length = 0};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text.bytes, sizeof text.bytes, format, arguments);
    va_end(arguments);
    say(c, fmi2Error, text.bytes);
    return fmi2Error;
}

/* --- what may be called when, and with what --- */

static const char *name_of(int64_t mode) {
    switch (mode) {
    case INSTANTIATED: return "is instantiated";
    case INITIALIZING: return "is in initialization mode";
    case STEPPING: return "is in step mode";
    default: return "has been terminated";
    }
}

static bool may(const Instance *c, int modes, const char *call) {
    if (!c) return false;
    if (!(c->now.mode & modes)) fail(c, "%s is not allowed now: the unit %s", call, name_of(c->now.mode));
    return c->now.mode & modes;
}

/* Whether a pointer was given where something is to be read or written. */
static bool given(const Instance *c, const void *pointer, const char *call) {
    if (!pointer) fail(c, "%s: a pointer is missing", call);
    return pointer;
}

static const Variable *find(const Instance *c, fmi2ValueReference r, int kinds) {
    if (r < COUNT && kinds & 1 << VARIABLES[r].kind) return VARIABLES + r;
    const char *what = kinds == REALS ? "Real" : kinds == INTEGERS ? "Integer or Enumeration" : "Boolean";
    fail(c, "no %s has the value reference %u", what, r);
    return NULL;
}

static bool may_get(const Instance *c, int kinds, const fmi2ValueReference r[], size_t n, const void *values,
                    const char *call) {
    if (!may(c, INITIALIZING | STEPPING | TERMINATED, call)) return false;
    if (n && !(given(c, r, call) && given(c, values, call))) return false;
    for (size_t i = 0; i < n; i++)
        if (!find(c, r[i], kinds)) return false;
    return true;
}

static bool may_set(const Instance *c, int kinds, const fmi2ValueReference r[], size_t n, const void *values,
                    const char *call) {
    if (!may(c, INSTANTIATED | INITIALIZING | STEPPING, call)) return false;
    if (n && !(given(c, r, call) && given(c, values, call))) return false;
    for (size_t i = 0; i < n; i++) {
        const Variable *v = find(c, r[i], kinds);
        if (!v) return false;
        if (v->access == OUTPUT || (v->access == FIXED && c->now.mode == STEPPING)) {
            fail(c, "%s (%s) cannot be set now", words(v->name), words(v->role));
            return false;
        }
    }
    return true;
}

/* --- values --- */

static void *at(Model *model, const Variable *v) { return model->bytes + v->offset; }
static double *real(Instance *c, int variable) { return at(&c->now.model, VARIABLES + variable); }
static int64_t integer(Model *model, int variable) { return *(int64_t *)at(model, VARIABLES + variable); }

static void append_value(Text *text, Instance *c, const Variable *v) {
    append(text, "%s = ", words(v->name));
    switch (v->kind) {
    case REAL: append_real(text, *(double *)at(&c->now.model, v)); break;
    case BOOLEAN: append(text, "%s", *(uint8_t *)at(&c->now.model, v) ? "True" : "False"); break;
    default: append(text, "%lld", (long long)*(int64_t *)at(&c->now.model, v));
    }
}

/* Of a number; NaN fails every comparison. */
static bool fits(const Variable *v, double x) {
    bool sized = x != 0.0 ? fabs(x) >= v->smallest : v->zero;
    return sized & (fabs(x) <= DBL_MAX) & (x >= v->min) & (x <= v->max) & (x > v->above) & (x < v->below);
}

static bool allows(Instance *c, const Variable *v) {
    if (v->kind == REAL) return fits(v, *(double *)at(&c->now.model, v));
    if (v->kind == INTEGER) return fits(v, (double)*(int64_t *)at(&c->now.model, v));
    if (v->kind == BOOLEAN) return true;
    const int32_t *choices = NUMBERS + v->choices;
    for (int32_t i = 1; i <= choices[0]; i++)
        if (choices[i] == *(int64_t *)at(&c->now.model, v)) return true;
    return false;
}

/* A step is refused while a Real input is unfit: counted where one is set, so that a step need not look at each. An
 * input has no limits but min and max; NaN fails both. */
static bool unfit(const Variable *v, double x) { return v->access == INPUT && !(x >= v->min && x <= v->max); }

static void count_unfit(Instance *c) {
    c->unfit = 0;
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].kind == REAL) c->unfit += unfit(VARIABLES + i, *real(c, i));
}

static bool judge(Instance *c, const Variable *v) {
    if (allows(c, v)) return true;
    Text text = {.length = 0};
    append_value(&text, c, v);
    append(&text, " is not allowed: it must be %s", words(v->range));
    say(c, fmi2Error, text.bytes);
    return false;
}

/* Tell what a code means, with the values of the variables it speaks of; `of`: the name of the variable that holds it,
 * whose group comes first. */
static void explain(Instance *c, fmi2Status status, const char *of, int messages, int64_t code) {
    const char *group = strrchr(of, '.');
    for (const Message *m = MESSAGES + messages; m->code; m++) {
        if (m->code != code) continue;
        Text text = {.length = 0};
        if (group) append(&text, "%.*s: ", (int)(group - of), of);
        append(&text, "%s", words(m->text));
        const int32_t *shown = NUMBERS + m->shown;
        for (const int32_t *v = shown; *v >= 0; v++) {
            append(&text, v == shown ? " (" : ", ");
            append_value(&text, c, VARIABLES + *v);
        }
        if (*shown >= 0) append(&text, ")");
        say(c, status, text.bytes);
    }
}

/* --- the two compiled functions --- */

static fmi2Status initialize(Instance *c) {
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++)
        if (v->access != OUTPUT && !judge(c, v)) return fmi2Error;
    Model before = c->now.model;
    int64_t refusal = 0;
    void *exception = NULL;
    int32_t failed = model_initialize(&refusal, &exception, &c->now.model);
    if (!failed && !refusal) return fmi2OK;
    if (failed) fail(c, "an arithmetic error: these values lead to no result");
    else explain(c, fmi2Error, "", REFUSALS, refusal);
    c->now.model = before;
    return fmi2Error;
}

/* While initializing, outputs follow parameters and inputs; what is wrong is told when leaving. */
static void follow(Instance *c) {
    if (c->now.mode != INITIALIZING) return;
    int logged = c->logged;
    c->logged = 0;
    initialize(c);
    c->logged = logged;
}

/* What a step replaces where derivatives of the master's position are given: its velocity and acceleration, and that
 * the inputs hold the master at the step's beginning. */
typedef struct {
    double values[2];
    int64_t mode;
} Lent;

static Lent lend(Instance *c) {
    Lent lent = {{*real(c, MASTER[1]), *real(c, MASTER[2])}, integer(&c->now.model, INPUT_MODE)};
    for (int order = 1; order <= 2; order++)
        if (c->now.given & 1 << order) *real(c, MASTER[order]) = c->now.derivatives[order];
    *(int64_t *)at(&c->now.model, VARIABLES + INPUT_MODE) = START_OF_STEP;
    return lent;
}

static void put_back(Instance *c, const Lent *lent) {
    for (int order = 1; order <= 2; order++) *real(c, MASTER[order]) = lent->values[order - 1];
    *(int64_t *)at(&c->now.model, VARIABLES + INPUT_MODE) = lent->mode;
}

/* A step that the block refuses has changed nothing: that is the block's promise, and saves a copy of it at each step.
 * An arithmetic error, which no block should have, may have, so the unit must begin anew. */
static fmi2Status run(Instance *c, double h) {
    int64_t refusal = 0;
    void *exception = NULL;
    if (model_step(&refusal, &exception, &c->now.model, h)) {
        c->now.mode = TERMINATED;
        return fail(c, "an arithmetic error: these values lead to no result, and the unit must be reset");
    }
    if (refusal) explain(c, fmi2Error, "", REFUSALS, refusal);
    return refusal ? fmi2Error : fmi2OK;
}

static bool ready(Instance *c, double h) {
    if (!(h > 0.0 && h <= LONGEST_STEP)) {
        Text text = {.length = 0};
        append(&text, "step size = ");
        append_real(&text, h);
        append(&text, " is not allowed: it must be > 0 and <= %g", LONGEST_STEP);
        fail(c, "%s", text.bytes);
        return false;
    }
    for (int i = 0; c->unfit && i < COUNT; i++)
        if (VARIABLES[i].access == INPUT && !judge(c, VARIABLES + i)) return false;
    return true;
}

static fmi2Status step(Instance *c, double h) {
    if (!ready(c, h)) return fmi2Error;
    int64_t codes[sizeof CODED / sizeof *CODED];
    for (int i = 0; CODED[i].variable >= 0; i++) codes[i] = integer(&c->now.model, CODED[i].variable);
    fmi2Status status;
    if (c->now.given && integer(&c->now.model, INPUT_MODE) != END_OF_STEP) {
        Lent lent = lend(c);
        bool fit = judge(c, VARIABLES + MASTER[1]) && judge(c, VARIABLES + MASTER[2]);
        status = fit ? run(c, h) : fmi2Error;
        put_back(c, &lent);
    } else {
        status = run(c, h);
    }
    if (status) return status;
    c->now.given = 0;
    for (int i = 0; CODED[i].variable >= 0; i++) {
        int64_t code = integer(&c->now.model, CODED[i].variable);
        if (code && code != codes[i])
            explain(c, fmi2Warning, words(VARIABLES[CODED[i].variable].name), CODED[i].messages, code);
    }
    return fmi2OK;
}

/* --- getters and setters --- */

static void put_Real(Instance *c, const Variable *v, double x) {
    double *place = at(&c->now.model, v);
    c->unfit += unfit(v, x) - (c->unfit && unfit(v, *place));
    *place = x;
}
static void put_Integer(Instance *c, const Variable *v, int x) { *(int64_t *)at(&c->now.model, v) = x; }
static void put_Boolean(Instance *c, const Variable *v, int x) { *(uint8_t *)at(&c->now.model, v) = x != 0; }

#define ACCESS(Type, KINDS, T)                                                                               \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type values[]) {       \
        if (!may_get(c, KINDS, r, n, values, "fmi2Get" #Type)) return fmi2Error;                                   \
        follow(c);                                                                                                 \
        Model *model = &((Instance *)c)->now.model;                                                                \
        for (size_t i = 0; i < n; i++) values[i] = (fmi2##Type)*(T *)at(model, VARIABLES + r[i]);                  \
        return fmi2OK;                                                                                             \
    }                                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type values[]) { \
        if (!may_set(c, KINDS, r, n, values, "fmi2Set" #Type)) return fmi2Error;                                   \
        for (size_t i = 0; i < n; i++) put_##Type(c, VARIABLES + r[i], values[i]);                                 \
        return fmi2OK;                                                                                             \
    }
ACCESS(Real, REALS, double)
ACCESS(Integer, INTEGERS, int64_t)
ACCESS(Boolean, BOOLEANS, uint8_t)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    if (!may(c, INITIALIZING | STEPPING | TERMINATED, "fmi2GetString")) return fmi2Error;
    return n ? fail(c, "no String has the value reference %u", r ? *r : 0) : fmi2OK;
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    if (!may(c, INSTANTIATED | INITIALIZING | STEPPING, "fmi2SetString")) return fmi2Error;
    return n ? fail(c, "no String has the value reference %u", r ? *r : 0) : fmi2OK;
}

/* --- life --- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

static void begin(Instance *c) {
    memset(&c->now, 0, sizeof c->now);
    memcpy(c->now.magic, "motsync1", sizeof c->now.magic);
    memcpy(c->now.guid, MODEL_GUID, sizeof MODEL_GUID);
    c->now.size = sizeof(State);
    c->now.mode = INSTANTIATED;
    memcpy(c->now.model.bytes, START, MODEL_SIZE);
    count_unfit(c);
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    if (!callbacks) return NULL;
    const char *called = name ? name : "";
    Instance *c = calloc(1, sizeof *c + strlen(called) + 1);
    if (!c) return NULL;
    c->logger = callbacks->logger;
    c->environment = callbacks->componentEnvironment;
    c->logged = logging ? LOG_ALL : 0;
    strcpy(c->name, called);
    const char *wrong = NULL;
    if (!*called) wrong = "the instance needs a name";
    else if (type != fmi2CoSimulation) wrong = "the unit is for co-simulation only";
    else if (!guid || strcmp(guid, MODEL_GUID)) wrong = "the GUID is not that of this unit, " MODEL_GUID;
    if (wrong) {
        fail(c, "fmi2Instantiate: %s", wrong);
        free(c);
        return NULL;
    }
    begin(c);
    return c;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2Reset(fmi2Component c) {
    if (!may(c, ANY, "fmi2Reset")) return fmi2Error;
    begin(c);
    return fmi2OK;
}

/* Switched on with categories, only those are logged; without, all. */
fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    static const struct { const char *name; Category category; } KNOWN[] = {
        {"logStatusWarning", LOG_WARNING}, {"logStatusError", LOG_ERROR}, {"logAll", LOG_ALL}};
    Instance *c = component;
    int chosen = n ? 0 : LOG_ALL;
    if (!may(c, ANY, "fmi2SetDebugLogging") || (n && !given(c, categories, "fmi2SetDebugLogging"))) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        int found = 0;
        for (int k = 0; k < 3; k++)
            if (categories[i] && !strcmp(categories[i], KNOWN[k].name)) found = KNOWN[k].category;
        if (!found) return fail(c, "fmi2SetDebugLogging: the categories are logStatusWarning, logStatusError, logAll");
        chosen |= found;
    }
    c->logged = on ? chosen : 0;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    if (!may(c, INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    ((Instance *)c)->now.time = start;
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    if (!may(c, INSTANTIATED, "fmi2EnterInitializationMode")) return fmi2Error;
    ((Instance *)c)->now.mode = INITIALIZING;
    return fmi2OK;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    if (!may(c, INITIALIZING, "fmi2ExitInitializationMode") || initialize(c)) return fmi2Error;
    ((Instance *)c)->now.mode = STEPPING;
    return fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    if (!may(c, STEPPING, "fmi2DoStep") || step(c, h)) return fmi2Error;
    ((Instance *)c)->now.time = t + h;
    return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component c) {
    return c ? fail(c, "fmi2CancelStep is not allowed now: no step is under way") : fmi2Error;
}
fmi2Status fmi2Terminate(fmi2Component c) {
    if (!may(c, STEPPING, "fmi2Terminate")) return fmi2Error;
    ((Instance *)c)->now.mode = TERMINATED;
    return fmi2OK;
}

/* --- the FMU state: the whole block and where it is in its life; good for all instances of this unit --- */

static uint64_t checksum(const State *s) { /* FNV-1a: every change of one byte changes it */
    State bare = *s;
    bare.checksum = 0;
    uint64_t sum = 14695981039346656037u;
    for (size_t i = 0; i < sizeof bare; i++) sum = (sum ^ ((const uint8_t *)&bare)[i]) * 1099511628211u;
    return sum;
}

static bool ours(const Instance *c, const State *s, const char *call) {
    if (!given(c, s, call)) return false;
    bool same = !memcmp(s, &c->now, offsetof(State, checksum)); /* magic, GUID and size */
    if (!same) fail(c, "%s: this FMU state belongs to another FMU", call);
    return same;
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *s) {
    Instance *c = component;
    if (!may(c, ANY, "fmi2GetFMUstate") || !given(c, s, "fmi2GetFMUstate")) return fmi2Error;
    if (*s && !ours(c, *s, "fmi2GetFMUstate")) return fmi2Error;
    if (!*s && !(*s = malloc(sizeof(State)))) return fail(c, "fmi2GetFMUstate: out of memory");
    memcpy(*s, &c->now, sizeof(State));
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate s) {
    Instance *c = component;
    if (!may(c, ANY, "fmi2SetFMUstate") || !ours(c, s, "fmi2SetFMUstate")) return fmi2Error;
    memcpy(&c->now, s, sizeof(State));
    count_unfit(c);
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    if (!may(c, ANY, "fmi2FreeFMUstate")) return fmi2Error;
    if (!s || !*s) return fmi2OK; /* the standard: nothing to do */
    if (!ours(c, *s, "fmi2FreeFMUstate")) return fmi2Error;
    free(*s);
    *s = NULL;
    return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    const char *call = "fmi2SerializedFMUstateSize";
    if (!may(c, ANY, call) || !ours(c, s, call) || !given(c, n, call)) return fmi2Error;
    *n = sizeof(State);
    return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t n) {
    const char *call = "fmi2SerializeFMUstate";
    if (!may(c, ANY, call) || !ours(c, s, call) || !given(c, bytes, call)) return fmi2Error;
    if (n < sizeof(State)) return fail(c, "%s: there must be room for %u bytes", call, (unsigned)sizeof(State));
    State packed;
    memcpy(&packed, s, sizeof packed);
    packed.checksum = checksum(&packed);
    memcpy(bytes, &packed, sizeof packed);
    return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t n, fmi2FMUstate *s) {
    const char *call = "fmi2DeSerializeFMUstate";
    if (!may(c, ANY, call) || !given(c, bytes, call) || !given(c, s, call)) return fmi2Error;
    if (n != sizeof(State)) return fail(c, "%s: an FMU state of this unit has %u bytes", call, (unsigned)sizeof(State));
    State packed;
    memcpy(&packed, bytes, sizeof packed);
    if (!ours(c, &packed, call)) return fmi2Error;
    if (packed.checksum != checksum(&packed)) return fail(c, "%s: this FMU state is damaged", call);
    packed.checksum = 0;
    State *made = malloc(sizeof *made);
    if (!made) return fail(c, "%s: out of memory", call);
    memcpy(made, &packed, sizeof packed);
    *s = made;
    return fmi2OK;
}

/* --- derivatives --- */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    const char *call = "fmi2SetRealInputDerivatives";
    Instance *c = component;
    if (!may(c, INSTANTIATED | INITIALIZING | STEPPING, call)) return fmi2Error;
    if (n && !(given(c, r, call) && given(c, order, call) && given(c, values, call))) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        const Variable *v = find(c, r[i], REALS);
        if (!v) return fmi2Error;
        if (v->access != INPUT) return fail(c, "%s: %s (%s) is no input", call, words(v->name), words(v->role));
        if (order[i] < 1) return fail(c, "%s: order = %d is not allowed: it must be >= 1", call, order[i]);
    }
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < n; i++) {
        if ((int)r[i] == MASTER[0] && order[i] <= 2 && integer(&c->now.model, INPUT_MODE) != END_OF_STEP) {
            c->now.derivatives[order[i]] = values[i];
            c->now.given |= 1 << order[i];
        } else if (status == fmi2OK) {
            status = fmi2Warning;
            say(c, status, "fmi2SetRealInputDerivatives: ignored but for orders 1 and 2 of the master's position where "
                           "it is the one at the step's beginning");
        }
    }
    return status;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[]) {
    const char *call = "fmi2GetRealOutputDerivatives";
    Instance *c = component;
    if (!may(c, STEPPING | TERMINATED, call)) return fmi2Error;
    if (n && !(given(c, r, call) && given(c, order, call) && given(c, values, call))) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        if (!find(c, r[i], REALS)) return fmi2Error;
        if ((int)r[i] != SLAVE[0] || order[i] < 1 || order[i] > 2)
            return fail(c, "%s: only orders 1 and 2 of the slave's position are known", call);
    }
    for (size_t i = 0; i < n; i++) values[i] = *real(c, SLAVE[order[i]]);
    return fmi2OK;
}

/* --- status: every step ends within its call --- */

static fmi2Status unknown(const Instance *c, const void *value, const char *call) {
    if (!may(c, STEPPING | TERMINATED, call) || !given(c, value, call)) return fmi2Error;
    say(c, fmi2Discard, "this status is not known: no step is pending");
    return fmi2Discard;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    return unknown(c, value, "fmi2GetStatus");
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    return unknown(c, value, "fmi2GetIntegerStatus");
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    return unknown(c, value, "fmi2GetStringStatus");
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    const char *call = "fmi2GetRealStatus";
    if (kind != fmi2LastSuccessfulTime) return unknown(c, value, call);
    if (!may(c, STEPPING | TERMINATED, call) || !given(c, value, call)) return fmi2Error;
    *value = ((Instance *)c)->now.time;
    return fmi2OK;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    const char *call = "fmi2GetBooleanStatus";
    if (kind != fmi2Terminated) return unknown(c, value, call);
    if (!may(c, STEPPING | TERMINATED, call) || !given(c, value, call)) return fmi2Error;
    *value = ((Instance *)c)->now.mode == TERMINATED;
    return fmi2OK;
}

/* --- not offered; the functions of model exchange are there since some importers look for all of the standard's --- */

#define NOT_OFFERED(function, ...)                                                              \
    fmi2Status function(__VA_ARGS__) {                                                          \
        return c ? fail(c, #function " is not offered by this co-simulation unit") : fmi2Error; \
    }
NOT_OFFERED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference unknown[], size_t nUnknown,
            const fmi2ValueReference known[], size_t nKnown, const fmi2Real dKnown[], fmi2Real dUnknown[])
NOT_OFFERED(fmi2EnterEventMode, fmi2Component c)
NOT_OFFERED(fmi2NewDiscreteStates, fmi2Component c, fmi2EventInfo *info)
NOT_OFFERED(fmi2EnterContinuousTimeMode, fmi2Component c)
NOT_OFFERED(fmi2CompletedIntegratorStep, fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
            fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
NOT_OFFERED(fmi2SetTime, fmi2Component c, fmi2Real time)
NOT_OFFERED(fmi2SetContinuousStates, fmi2Component c, const fmi2Real x[], size_t n)
NOT_OFFERED(fmi2GetDerivatives, fmi2Component c, fmi2Real derivatives[], size_t n)
NOT_OFFERED(fmi2GetEventIndicators, fmi2Component c, fmi2Real indicators[], size_t n)
NOT_OFFERED(fmi2GetContinuousStates, fmi2Component c, fmi2Real x[], size_t n)
NOT_OFFERED(fmi2GetNominalsOfContinuousStates, fmi2Component c, fmi2Real nominals[], size_t n)

/* --- Windows: in place of the C start-up and of zig's library, which would be linked as a whole: half of the file --- */

#ifdef _WIN32
int library_main(void *library, uint32_t reason, void *reserved) { return 1; } /* the C library starts by itself */

/* The remainder with the sign of x, exact; the coprocessor's instruction takes away some bits of the quotient a time. */
double fmod(double x, double y) {
    long double rest = x, divisor = y;
    uint16_t status;
    do __asm__("fprem\n\tfnstsw %1" : "+t"(rest), "=a"(status) : "u"(divisor) : "cc");
    while (status & 0x400);
    return (double)rest;
}

/* Called with a frame's size in rax before it is taken: touches each of its pages in turn, as Windows demands. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    pushq %rcx\n"
        "    pushq %rax\n"
        "    leaq 24(%rsp), %rcx\n"
        "1:  cmpq $4096, %rax\n"
        "    jb 2f\n"
        "    subq $4096, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    subq $4096, %rax\n"
        "    jmp 1b\n"
        "2:  subq %rax, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    popq %rax\n"
        "    popq %rcx\n"
        "    ret\n");
#endif
