/* A fuzzing host: random FMI calls in any order, on several instances of one unit, with good and with bad arguments.
 *
 * This is what it does with any version of FMI: fuzz2.c and fuzz3.c include it, and add what only theirs has. Linked with
 * the unit under AddressSanitizer and UndefinedBehaviorSanitizer, which watch the memory, the host itself watches the answers. For every instance it keeps what an importer can know (mode,
 * values, pending derivatives, time, log settings), and after every call:
 *
 * - the status is the one that this knowledge demands, and so is what was logged;
 * - a call that failed, or only reads, has left the serialized state what it was, bit for bit;
 * - no other instance has changed;
 * - values, times and FMU states come back as they were given, and a copy of an instance steps to the same bits;
 * - the call has come back: the host is killed (SIGALRM) by one that takes longer than PATIENCE.
 *
 *     fuzz SEED CALLS
 *
 * prints one line of JSON: how often each function was called and what it answered. The first surprise ends it. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* --- what the importer knows of the unit: expected.h is generated from the block's declarations --- */

typedef enum { REAL, INTEGER, BOOLEAN, ENUMERATION, STRING, KINDS } Kind; /* in FMI 2.0 an enumeration is an INTEGER */
typedef enum { OUTPUT, INPUT, TUNABLE, FIXED } Access;

typedef struct {
    Kind kind;
    Access access;
    double start, min, max, above, below, smallest;
    bool zero;
    const int *choices; /* of an enumeration: how many, then its numbers */
} Variable;

/* GUID, VARIABLES, the indices of some of them (-1: the block has none), REFUSES_STARTS and REFUSES_STEPS (whether the
 * block may refuse, at the end of the initialization and in a step, values that are in their ranges for another reason
 * than a master too far away), END_OF_STEP, LONGEST_STEP, MOST_CYCLES (in a step, of a block that has cycles) */
#include "expected.h"

enum { COUNT = sizeof VARIABLES / sizeof *VARIABLES };
enum { MOST = 8, INSTANCES = 4, STATES = 6, BYTES = 1 << 14, PATIENCE = 30 /* s */ };

/* FUNCTIONS(X, Y) lists the functions: those with the names that they have in FMI 2.0, or in no other version, as X(name);
 * the others as Y(name in FMI 2.0, name). */
#define ID(name) name,
#define NAME(name) VERSION #name,
#define OTHER_ID(former, name) former,
#define OTHER_NAME(former, name) VERSION #name,
typedef enum { FUNCTIONS(ID, OTHER_ID) FUNCTION_COUNT } Function;
static const char *const FUNCTION_NAMES[] = {FUNCTIONS(NAME, OTHER_NAME)};
static const char *const STATUS_NAMES[] = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};
enum { STATUSES = 6, EITHER = STATUSES }; /* EITHER: OK or refused */

typedef enum { NOWHERE = 0, INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY = 15 } Mode;
typedef union {
    double real;
    int64_t integer; /* and Boolean */
    uint64_t bits;
} Value;

typedef struct { /* all that an FMU state restores */
    Mode mode;
    double time, stop; /* stop: INFINITY if there is none */
    Value values[COUNT]; /* of what can be set */
    bool given[3]; /* whether the next step has the master position's derivative of this order */
    double derivatives[3];
    double travelled; /* bound on the master's way since the initialization, in periods */
    double speed;     /* bound on the master's speed at the end of the last step */
} Knowledge;

typedef struct {
    Component unit;
    Callbacks callbacks;
    bool listens; /* whether it has a function for messages */
    char *name;
    int logged; /* a set of statuses, by bit */
    int logs[STATUSES];
    Knowledge known;
    FmuState probe; /* through which the bytes are read */
    Byte bytes[BYTES];
} Slot;

typedef struct {
    FmuState state; /* NULL: none */
    Knowledge known;
} Kept;

static Slot slots[INSTANCES], twin;
static Slot *calling; /* whose unit may log now */
static Kept kept[STATES];
static Knowledge fresh;
static size_t size; /* of a serialized state */
static uint64_t seed, call, counts[FUNCTION_COUNT][STATUSES];
static double slowest;
static int of_kind[KINDS][COUNT], of_kind_count[KINDS], settable[KINDS][COUNT], settable_count[KINDS];

static _Noreturn void surprise(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "surprise at call %llu of seed %llu: ", (unsigned long long)call, (unsigned long long)seed);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    abort();
}

static Value of_real(double x) { return (Value){.real = x}; }
static Value of_integer(int x) { return (Value){.integer = x}; }
static Value of_boolean(int x) { return of_integer(x != 0); }

/* --- chance --- */

static uint64_t random_bits(void) { /* SplitMix64; were seeds its own step apart, all would make the same calls */
    static uint64_t state;
    if (!state) state = seed * 0xD1342543DE82EF95u + 1;
    uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}
static size_t below(size_t n) { return random_bits() % n; }
static bool one_in(size_t n) { return below(n) == 0; }
static double share(void) { return (double)(random_bits() >> 11) * 0x1p-53; }

static double random_real(void) {
    static const double SPECIAL[] = {NAN,   INFINITY, -INFINITY, 1.7e308, -1.7e308, 5e-324, -5e-324, 0.0,   -0.0,  1e12,
                                     -1e12, 1.0001e12, -1.0001e12, 1e15,  1e-9,     9e-10,  -1e-9,   1e300, 1e-300};
    Value any = {.bits = random_bits()};
    switch (below(24)) {
    case 0: return SPECIAL[below(sizeof SPECIAL / sizeof *SPECIAL)];
    case 1: return any.real;
    case 2: return ldexp(share() - 0.5, (int)below(90) - 45);
    case 3: return 0.0;
    default: return (share() - 0.4) * 500.0;
    }
}
static int random_integer(void) { return one_in(3) ? (int)random_bits() : (int)below(5) - 1; }

/* What an importer passes that mixes up its pointers. */
static bool forgotten(void) { return one_in(100); }

/* Memory that runs out: the linker sends every malloc and calloc here (--wrap). */
static bool scarce;
void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t each);
void *__wrap_malloc(size_t n) { return scarce ? NULL : __real_malloc(n); }
void *__wrap_calloc(size_t n, size_t each) { return scarce ? NULL : __real_calloc(n, each); }

/* Memory of exactly this size, or none: a byte beyond it is a finding. */
static void *room(size_t n, size_t each) { return forgotten() ? NULL : malloc(n * each); }

static size_t random_count(void) { return one_in(40) ? COUNT : below(MOST); }

static Reference random_reference(Kind kind, bool to_set) {
    const int *from = to_set ? settable[kind] : of_kind[kind];
    int n = to_set ? settable_count[kind] : of_kind_count[kind];
    if (one_in(60) || !n) return one_in(4) ? (Reference)random_bits() : (Reference)below(COUNT + 3);
    return (Reference)from[below((size_t)n)];
}

static Reference *random_references(size_t n, Kind kind, bool to_set) {
    Reference *r = room(n, sizeof *r);
    for (size_t i = 0; r && i < n; i++) r[i] = random_reference(kind, to_set);
    return r;
}

/* --- what must hold after every call --- */

static void noted(Slot *s, Answer status, const char *category, const char *message) {
    if (s != calling) surprise("an instance logs that was not called");
    if (strcmp(category, category_of(status))) surprise("%s logged as %s", STATUS_NAMES[status], category);
    if (!message || !*message || strchr(message, '%')) surprise("an empty message, or one with a format in it");
    s->logs[status]++;
}

static void look(Slot *s, Byte *bytes) {
    if (FMI(GetFMUstate)(s->unit, &s->probe) || FMI(SerializeFMUstate)(s->unit, s->probe, bytes, size))
        surprise("the state cannot be read");
}

static void check_logs(const Slot *s, Function f, Answer status) {
    const int *n = s->logs;
    int all = 0;
    for (int i = 0; i < STATUSES; i++) {
        all += n[i];
        if (n[i] && !(s->logged & 1 << i)) surprise("%s logged what is switched off", FUNCTION_NAMES[f]);
    }
    bool told = status != OK;
    if (told && s->logged & 1 << status && n[status] != 1)
        surprise("%s answered %s and logged it %d times", FUNCTION_NAMES[f], STATUS_NAMES[status], n[status]);
    if (status == OK && all != n[WARNING]) surprise("%s answered OK and logged an error", FUNCTION_NAMES[f]);
}

/* Every call ends here. `changes`: whether a call that succeeded may have changed the state. */
static Answer concluded(Slot *s, Function f, Answer status, int expected, bool changes) {
    counts[f][status]++;
    if (expected == EITHER ? status != OK && status != (f == DoStep ? REFUSED_STEP : ERROR) : (int)status != expected)
        surprise("%s answered %s, expected %s, mode %d", FUNCTION_NAMES[f], STATUS_NAMES[status],
                 expected == EITHER ? "OK or a refusal" : STATUS_NAMES[expected], s ? (int)s->known.mode : 0);
    if (s && s->unit) check_logs(s, f, status);
    for (Slot *other = slots; other < slots + INSTANCES; other++) {
        if (!other->unit) continue;
        Byte now[BYTES];
        bool may_differ = other == s && changes && status != ERROR && status != DISCARD;
        look(other, now);
        if (!may_differ && memcmp(now, other->bytes, size))
            surprise("%s answered %s and changed the state of %s instance", FUNCTION_NAMES[f], STATUS_NAMES[status],
                     other == s ? "its" : "another");
        memcpy(other->bytes, now, size);
    }
    return status;
}

static Component called(Slot *s) {
    calling = s;
    memset(s->logs, 0, sizeof s->logs);
    return s->unit;
}

static int expected(bool good) { return good ? OK : ERROR; }
static bool in(const Slot *s, int modes) { return s->known.mode & modes; }

static bool allowed(const Variable *v, Value value) {
    for (int i = 1; v->choices && i <= v->choices[0]; i++)
        if (v->choices[i] == value.integer) return true;
    if (v->choices) return false;
    if (v->kind == BOOLEAN) return true;
    double x = v->kind == REAL ? value.real : (double)value.integer;
    bool fits = isfinite(x) && x >= v->min && x <= v->max && x > v->above && x < v->below;
    return fits && (x == 0.0 ? v->zero : fabs(x) >= v->smallest);
}

static Value known_value(const Knowledge *k, int variable) {
    return variable < 0 ? of_integer(0) : k->values[variable];
}
static bool interpolates(void) {
    return POSITION >= 0 && VELOCITY >= 0 && ACCELERATION >= 0 && INPUT_MODE >= 0;
}

/* --- getters and setters --- */

static bool good_references(const Slot *s, const Reference *r, size_t n, Kind kind, bool to_set) {
    for (size_t i = 0; i < n; i++) {
        if (TIME_IS_A_VARIABLE && r[i] == COUNT && kind == REAL && !to_set) continue;
        if (r[i] >= COUNT || VARIABLES[r[i]].kind != kind) return false;
        Access access = VARIABLES[r[i]].access;
        if (to_set && (access == OUTPUT || (access == FIXED && in(s, STEPPING)))) return false;
    }
    return true;
}

static int getting(const Slot *s, const Reference *r, size_t n, const void *values, Kind kind) {
    bool now = in(s, INITIALIZING | STEPPING | TERMINATED);
    return expected(now && (!n || (r && values && good_references(s, r, n, kind, false))));
}
static int setting(const Slot *s, const Reference *r, size_t n, const void *values, Kind kind) {
    bool now = in(s, INSTANTIATED | INITIALIZING | STEPPING);
    return expected(now && (!n || (r && values && good_references(s, r, n, kind, true))));
}

/* What has been set is what is got; what the block puts out is finite. */
static void check_value(const Slot *s, Reference r, Value got) {
    if (r == COUNT) { /* the time */
        if (got.real != s->known.time) surprise("the time is %g, not %g", got.real, s->known.time);
        return;
    }
    const Variable *v = VARIABLES + r;
    Value known = s->known.values[r];
    if (v->access != OUTPUT && got.bits != known.bits) surprise("variable %u is not what it was set to", r);
    if (v->access == OUTPUT && v->kind == REAL && !isfinite(got.real)) surprise("variable %u is not finite", r);
}

#define GET_AND_SET(Type, T, C, KIND, RANDOM)                                                                          \
    static void get_##T(Slot *s) {                                                                                     \
        size_t n = random_count();                                                                                     \
        Reference *r = random_references(n, KIND, false);                                                     \
        C *values = room(n, sizeof *values);                                                                           \
        bool initializing = in(s, INITIALIZING); /* outputs follow the inputs then */                                  \
        int wanted = getting(s, r, n, values, KIND);                                                                   \
        Answer status = FMI(Get##Type)(called(s), r, n, values);                                                    \
        if (!concluded(s, Get##Type, status, wanted, initializing))                                                    \
            for (size_t i = 0; i < n; i++) check_value(s, r[i], of_##T(values[i]));                                  \
        free(r), free(values);                                                                                         \
    }                                                                                                                  \
    static void set_##T(Slot *s) {                                                                                     \
        size_t n = random_count();                                                                                     \
        Reference *r = random_references(n, KIND, !one_in(20));                                               \
        C *values = room(n, sizeof *values);                                                                           \
        for (size_t i = 0; values && i < n; i++) values[i] = RANDOM;                                                   \
        int wanted = setting(s, r, n, values, KIND);                                                                   \
        if (!concluded(s, Set##Type, FMI(Set##Type)(called(s), r, n, values), wanted, true))                            \
            for (size_t i = 0; i < n; i++) s->known.values[r[i]] = of_##T(values[i]);                                  \
        free(r), free(values);                                                                                         \
    }
GET_AND_SET(Real, real, double, REAL, random_real())
GET_AND_SET(Integer, integer, int32_t, INTEGER, random_integer())
GET_AND_SET(Boolean, boolean, Boolean, BOOLEAN, random_integer())

static void get_string(Slot *s) {
    size_t n = one_in(2) ? 0 : random_count();
    Reference *r = random_references(n, STRING, false);
    const char **values = room(n, sizeof *values);
    int wanted = getting(s, r, n, values, STRING);
    bool initializing = in(s, INITIALIZING);
    concluded(s, GetString, FMI(GetString)(called(s), r, n, values), wanted, initializing);
    free(r), free(values);
}
static void set_string(Slot *s) {
    size_t n = one_in(2) ? 0 : random_count();
    Reference *r = random_references(n, STRING, true);
    const char **values = room(n, sizeof *values);
    for (size_t i = 0; values && i < n; i++) values[i] = one_in(4) ? NULL : "text";
    int wanted = setting(s, r, n, values, STRING);
    concluded(s, SetString, FMI(SetString)(called(s), r, n, values), wanted, false);
    free(r), free(values);
}

/* --- life --- */

static void remember(Slot *s) { look(s, s->bytes); }

static const char *random_name(void) {
    static const char *const NAMES[] = {"unit", "50%n%s", "\xc3\xbcnit \xe2\x82\xac", "", NULL};
    return NAMES[one_in(6) ? below(5) : 0];
}
static const char *random_guid(void) {
    static const char *const GUIDS[] = {NULL, "", "{00000000-0000-0000-0000-000000000000}", GUID " ", "{"};
    return one_in(8) ? GUIDS[below(5)] : GUID;
}
static bool good_names(const char *name, const char *guid) { return name && *name && guid && !strcmp(guid, GUID); }

/* The end of an attempt to make a unit. `heard`: whether a refusal could be told. */
static void instantiated(Slot *s, Function f, bool good, bool heard) {
    if (!s->unit && heard && s->logs[ERROR] != 1) surprise("refused without a word");
    if (s->unit) {
        s->known = fresh;
        remember(s);
    }
    concluded(s, f, s->unit ? OK : ERROR, expected(good), false);
}

static void free_slot(Slot *s) {
    if (s->unit && s->probe && FMI(FreeFMUstate)(s->unit, &s->probe)) surprise("an FMU state cannot be freed");
    FMI(FreeInstance)(called(s));
    s->unit = NULL;
    s->known.mode = NOWHERE;
}
static void free_instance(Slot *s) {
    free_slot(s);
    concluded(s, FreeInstance, OK, OK, false);
}

static void get_version(Slot *s) {
    called(s);
    concluded(s, GetVersion, strcmp(FMI(GetVersion)(), VERSION_TEXT) ? ERROR : OK, OK, false);
}

static void set_debug_logging(Slot *s) {
    size_t n = below(4);
    const char **categories = room(n, sizeof *categories);
    int chosen = n ? 0 : -1;
    bool good = s->unit && (!n || categories);
    for (size_t i = 0; categories && i < n; i++) {
        size_t k = below(CATEGORY_COUNT + (one_in(4) ? 3 : 0));
        static const char *const UNKNOWN[] = {"logEvents", "", NULL};
        categories[i] = k < CATEGORY_COUNT ? CATEGORIES[k].name : UNKNOWN[k - CATEGORY_COUNT];
        if (k < CATEGORY_COUNT) chosen |= CATEGORIES[k].statuses;
        else good = false;
    }
    bool on = !one_in(4);
    Answer status = FMI(SetDebugLogging)(called(s), on, n, categories);
    concluded(s, SetDebugLogging, status, expected(good), false);
    if (!status) s->logged = !s->listens ? 0 : on ? chosen | LOGGED_ALWAYS : LOGGED_OFF;
    free(categories);
}

static void exit_initialization_mode(Slot *s) {
    const Knowledge *k = &s->known;
    bool good = in(s, INITIALIZING);
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].access != OUTPUT && !allowed(VARIABLES + i, k->values[i])) good = false;
    double period = known_value(k, PERIOD).real, turns = fabs(known_value(k, POSITION).real) / period;
    bool refusable = REFUSES_STARTS || (period > 0.0 && turns > 0.5e15);
    int wanted = good && refusable ? EITHER : expected(good);
    if (concluded(s, ExitInitializationMode, FMI(ExitInitializationMode)(called(s)), wanted, true)) return;
    s->known.mode = STEPPING;
    s->known.travelled = period > 0.0 ? turns : 0.0;
    s->known.speed = fabs(known_value(k, VELOCITY).real);
}

static void terminate(Slot *s) {
    if (!concluded(s, Terminate, FMI(Terminate)(called(s)), expected(in(s, STEPPING)), true))
        s->known.mode = TERMINATED;
}
static void reset(Slot *s) {
    if (!concluded(s, Reset, FMI(Reset)(called(s)), expected(in(s, ANY)), true)) s->known = fresh;
}

/* --- the step --- */

/* Whether the master may be so many periods away, by a bound from above, that the block refuses it. */
static bool far_away(const Knowledge *k, double h, double *travelled, double *speed) {
    bool estimated = known_value(k, INPUT_MODE).integer == POSITION_ONLY;
    double v = k->given[1] || estimated ? 1e12 : fabs(known_value(k, VELOCITY).real);
    double a = k->given[2] || estimated ? 1e12 : fabs(known_value(k, ACCELERATION).real);
    double period = known_value(k, PERIOD).real;
    double way = fabs(known_value(k, POSITION).real) + (v + k->speed + a * h) * h + period;
    *travelled = k->travelled + (period > 0.0 ? way / period : 0.0);
    *speed = v + a * h;
    return *travelled > 1e14;
}

static int stepping(const Slot *s, double t, double h, bool lent) {
    double past = t + h - s->known.stop; /* a hundredth of the step is allowed */
    bool good = in(s, STEPPING) && h > 0.0 && h <= LONGEST_STEP && isfinite(t) && !(past > 0.011 * h);
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].access == INPUT && !allowed(VARIABLES + i, s->known.values[i])) good = false;
    if (TASK_CYCLE >= 0 && h > MOST_CYCLES * known_value(&s->known, TASK_CYCLE).real) good = false;
    for (int order = 1; lent && order <= 2; order++)
        if (s->known.given[order] && !(fabs(s->known.derivatives[order]) <= 1e12)) good = false;
    return good && past > 0.009 * h ? EITHER : good ? OK : in(s, STEPPING) ? REFUSED_STEP : ERROR;
}

static double random_step(void) {
    switch (below(10)) {
    case 0: return random_real();
    case 1: return share() * 2e6;
    default: return share() * 0.1;
    }
}

/* An instance that was given this one's state before the step takes the same step to the same state. */
static void check_twin(Slot *s, FmuState before, double t, double h) {
    Byte bytes[BYTES];
    called(&twin);
    if (FMI(SetFMUstate)(twin.unit, before) || FMI(DoStep)(twin.unit, t, h, false))
        surprise("a copy cannot do the same step");
    look(&twin, bytes);
    if (memcmp(bytes, s->bytes, size)) surprise("a copy steps to another state");
}

static void do_step(Slot *s) {
    double t = one_in(10) ? random_real() : s->known.time, h = random_step(), travelled, speed;
    Knowledge *k = &s->known;
    bool lent = (k->given[1] || k->given[2]) && known_value(k, INPUT_MODE).integer != END_OF_STEP;
    int wanted = stepping(s, t, h, lent);
    if ((far_away(k, h, &travelled, &speed) || REFUSES_STEPS) && !wanted) wanted = EITHER;
    FmuState before = NULL;
    bool twice = (wanted == OK || wanted == EITHER) && one_in(8);
    if (twice && FMI(GetFMUstate)(s->unit, &before)) surprise("no state before a step");
    struct timespec begun, ended;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    Answer status = FMI(DoStep)(called(s), t, h, one_in(2));
    clock_gettime(CLOCK_MONOTONIC, &ended);
    double took = (double)(ended.tv_sec - begun.tv_sec) * 1e6 + (double)(ended.tv_nsec - begun.tv_nsec) * 1e-3;
    if (took > slowest) slowest = took;
    if (!concluded(s, DoStep, status, wanted, true)) {
        k->time = t + h;
        k->given[1] = k->given[2] = false;
        k->travelled = travelled;
        k->speed = speed;
        if (twice) check_twin(s, before, t, h);
    }
    if (before && FMI(FreeFMUstate)(s->unit, &before)) surprise("an FMU state cannot be freed");
}

/* --- FMU states: kept ones come from any instance and go to any --- */

static Kept *random_kept(void) { return kept + below(STATES); }

static void get_fmu_state(Slot *s) {
    Kept *k = random_kept();
    if (forgotten()) {
        concluded(s, GetFMUstate, FMI(GetFMUstate)(called(s), NULL), ERROR, false);
        return;
    }
    scarce = one_in(30);
    int wanted = expected(in(s, ANY) && !(scarce && !k->state));
    Answer status = FMI(GetFMUstate)(called(s), &k->state);
    scarce = false;
    if (!concluded(s, GetFMUstate, status, wanted, false)) k->known = s->known;
}

static void set_fmu_state(Slot *s) {
    Kept *k = random_kept();
    int wanted = expected(in(s, ANY) && k->state);
    if (!concluded(s, SetFMUstate, FMI(SetFMUstate)(called(s), k->state), wanted, true)) s->known = k->known;
}

static void free_fmu_state(Slot *s) {
    Kept *k = random_kept();
    if (forgotten()) {
        concluded(s, FreeFMUstate, FMI(FreeFMUstate)(called(s), NULL), expected(in(s, ANY)), false);
        return;
    }
    concluded(s, FreeFMUstate, FMI(FreeFMUstate)(called(s), &k->state), expected(in(s, ANY)), false);
    if (s->unit && k->state) surprise("a freed state's pointer is not NULL");
}

/* A state of another unit: as long as ours, and freed by nobody but the host. */
static void foreign_fmu_state(Slot *s) {
    Byte *bytes = malloc(size), out[BYTES];
    memcpy(bytes, twin.bytes, size);
    bytes[below(48)] ^= (Byte)(1 << below(8)); /* in what a unit is recognized by */
    FmuState foreign = bytes;
    size_t n;
    switch (below(5)) {
    case 0: concluded(s, SetFMUstate, FMI(SetFMUstate)(called(s), foreign), ERROR, false); break;
    case 1: concluded(s, GetFMUstate, FMI(GetFMUstate)(called(s), &foreign), ERROR, false); break;
    case 2: concluded(s, FreeFMUstate, FMI(FreeFMUstate)(called(s), &foreign), ERROR, false); break;
    case 3:
        concluded(s, SerializedFMUstateSize, FMI(SerializedFMUstateSize)(called(s), foreign, &n), ERROR, false);
        break;
    default:
        concluded(s, SerializeFMUstate, FMI(SerializeFMUstate)(called(s), foreign, out, size), ERROR, false);
    }
    if (foreign != bytes) surprise("a foreign state's pointer was changed");
    free(bytes);
}

static void serialized_fmu_state_size(Slot *s) {
    Kept *k = random_kept();
    size_t found = 0, *n = forgotten() ? NULL : &found;
    Answer status = FMI(SerializedFMUstateSize)(called(s), k->state, n);
    concluded(s, SerializedFMUstateSize, status, expected(in(s, ANY) && k->state && n), false);
    if (!status && found != size) surprise("the size of a state has changed");
}

static void serialize_fmu_state(Slot *s) {
    Kept *k = random_kept();
    size_t n = one_in(4) ? below(size) : size + (one_in(4) ? below(100) : 0);
    Byte *bytes = room(n, 1);
    int wanted = expected(in(s, ANY) && k->state && bytes && n >= size);
    concluded(s, SerializeFMUstate, FMI(SerializeFMUstate)(called(s), k->state, bytes, n), wanted, false);
    free(bytes);
}

/* Bytes of a state, whole or in one of the ways in which files and wires spoil them: whether they are still good. */
static bool spoiled(Byte *bytes, size_t n) {
    Byte whole[BYTES];
    memcpy(whole, bytes, n);
    switch (below(8)) {
    case 0: /* a few bits */
        for (size_t i = 1 + below(4); i; i--) bytes[below(n)] ^= (Byte)(1 << below(8));
        break;
    case 1: /* a few bytes */
        for (size_t i = 1 + below(20); i; i--) bytes[below(n)] = (Byte)random_bits();
        break;
    case 2: /* everything */
        for (size_t i = 0; i < n; i++) bytes[i] = (Byte)random_bits();
        break;
    case 3: /* two parts in the wrong order */
        memmove(bytes, bytes + n / 2, n / 2);
        break;
    default: break;
    }
    return memcmp(whole, bytes, n);
}

static void deserialize_fmu_state(Slot *s) {
    Kept *from = random_kept(), *to = random_kept();
    size_t n = one_in(10) ? below(size) : size + (one_in(10) ? 1 + below(100) : 0);
    Byte *bytes = room(n, 1);
    bool good = in(s, ANY) && bytes && n == size && from->state;
    if (bytes) memset(bytes, 0, n);
    if (s->unit && bytes && n == size && from->state) {
        if (FMI(SerializeFMUstate)(s->unit, from->state, bytes, n)) surprise("a state cannot be serialized");
        if (spoiled(bytes, n)) good = false;
    }
    Knowledge known = from->known;
    FmuState made = NULL, *where = forgotten() ? NULL : &made;
    scarce = one_in(30);
    good = good && where && !scarce;
    Answer status = FMI(DeSerializeFMUstate)(called(s), bytes, n, where);
    scarce = false;
    concluded(s, DeSerializeFMUstate, status, expected(good), false);
    if (!status != !!made) surprise("deserialized: status and pointer disagree");
    if (made) {
        if (to->state && FMI(FreeFMUstate)(s->unit, &to->state)) surprise("an FMU state cannot be freed");
        to->state = made;
        to->known = known;
    }
    free(bytes);
}

/* --- forged states: with the right checksum, but of nothing that the unit has ever been --- */

enum { CHECKSUM = 56, FORGEABLE = 64, MEMORY = 120 }; /* where these begin in a serialized state; the block's memory is last */

static void sign(Byte *bytes) { /* as unit.c says: FNV-1a by words, each mixed; the checksum itself counts as 0 */
    uint64_t sum = 14695981039346656037u, word;
    memset(bytes + CHECKSUM, 0, sizeof sum);
    for (size_t i = 0; i < size; i += sizeof word) {
        memcpy(&word, bytes + i, sizeof word);
        sum = (sum ^ word) * 1099511628211u;
        sum ^= sum >> 32;
    }
    memcpy(bytes + CHECKSUM, &sum, sizeof sum);
}

/* An integer has 32 bits: with larger ones the block's sums and products would overflow, which is not defined in C. */
static Value random_word(size_t place) {
    for (const int *whole = INTEGERS; *whole >= 0; whole++)
        if (place == MEMORY + (size_t)*whole) return of_integer(one_in(2) ? (int)below(80) - 8 : (int)random_bits());
    return one_in(4) ? (Value){.bits = random_bits()} : of_real(random_real());
}

/* The twin takes such a state over, and steps: it may answer what it likes, but in time and within its memory. */
static void forge_state(Slot *s) {
    Byte *bytes = malloc(size);
    memcpy(bytes, s->bytes, size);
    for (size_t i = 1 + below(4); i; i--) {
        size_t place = FORGEABLE + 8 * below((size - FORGEABLE) / 8);
        Value word = random_word(place);
        memcpy(bytes + place, &word, one_in(3) ? 1 + below(4) : 8);
    }
    sign(bytes);
    FmuState made = NULL;
    Answer status = FMI(DeSerializeFMUstate)(called(s), bytes, size, &made);
    concluded(s, DeSerializeFMUstate, status, EITHER, false);
    free(bytes);
    if (status) return;
    if (FMI(SetFMUstate)(called(&twin), made)) surprise("a state that was accepted cannot be restored");
    for (int i = 0; i < 3; i++) (void)FMI(DoStep)(twin.unit, s->known.time, random_step(), false);
    if (FMI(Reset)(twin.unit) || FMI(FreeFMUstate)(twin.unit, &made)) surprise("a forged state cannot be left");
}

/* --- derivatives --- */

static int32_t *random_orders(size_t n) {
    int32_t *order = room(n, sizeof *order);
    for (size_t i = 0; order && i < n; i++) order[i] = one_in(20) ? random_integer() : 1 + (int32_t)below(2);
    return order;
}

static void get_real_output_derivatives(Slot *s) {
    size_t n = below(4);
    Reference *r = random_references(n, REAL, false);
    int32_t *order = random_orders(n);
    double *values = room(n, sizeof *values);
    bool good = in(s, STEPPING | TERMINATED) && (!n || (r && order && values));
    for (size_t i = 0; good && i < n; i++) {
        if (!one_in(8)) r[i] = SLAVE[0];
        if (SLAVE[0] >= COUNT || r[i] != SLAVE[0] || order[i] < 1 || order[i] > 2) good = false;
    }
    Answer status = FMI(GetRealOutputDerivatives)(called(s), r, n, order, values);
    concluded(s, GetRealOutputDerivatives, status, expected(good), false);
    for (size_t i = 0; !status && i < n; i++) {
        double value;
        if (FMI(GetReal)(s->unit, SLAVE + order[i], 1, &value) || value != values[i])
            surprise("derivative %d of the slave's position is not the variable", order[i]);
    }
    free(r), free(order), free(values);
}

/* --- the run --- */

typedef struct {
    int weight; /* those that end a simulation are rare: deep states need long ones */
    void (*act)(Slot *);
} Act;

#define ACTS_OF_ALL_VERSIONS                                                                                          \
    {60, do_step}, {40, set_real}, {12, set_integer}, {25, set_boolean}, {25, get_real}, {12, get_integer},           \
        {12, get_boolean}, {3, get_string}, {3, set_string}, {3, get_version}, {4, set_debug_logging},                \
        {1, free_instance}, {2, enter_initialization_mode}, {2, exit_initialization_mode}, {1, terminate}, {1, reset}, \
        {6, get_fmu_state}, {4, set_fmu_state}, {4, free_fmu_state}, {4, foreign_fmu_state},                          \
        {4, serialized_fmu_state_size}, {4, serialize_fmu_state}, {8, deserialize_fmu_state}, {8, forge_state},       \
        {6, get_real_output_derivatives}

/* What the file has that includes this one: its acts, the last of which is empty, and how it makes an instance that only
 * copies. */
static const Act *all_acts(void);
static void instantiate(Slot *s);
static void enter_initialization_mode(Slot *s);
static void make_twin(void);

/* Blind chance seldom finds its way into step mode, where most of the code is: lend it a hand. */
static void (*next_act(const Slot *s))(Slot *) {
    switch (s->known.mode) {
    case NOWHERE:
        if (one_in(3)) return instantiate;
        break;
    case INSTANTIATED:
        if (one_in(8)) return enter_initialization_mode;
        break;
    case INITIALIZING:
        if (one_in(6)) return exit_initialization_mode;
        if (one_in(40)) return reset;
        break;
    case TERMINATED:
        if (one_in(12)) return reset;
        break;
    default: break;
    }
    int all = 0;
    for (const Act *act = all_acts(); act->act; act++) all += act->weight;
    int chosen = (int)below((size_t)all);
    const Act *act = all_acts();
    while ((chosen -= act->weight) >= 0) act++;
    return act->act;
}

static void prepare(void) {
    fresh.mode = INSTANTIATED;
    fresh.stop = INFINITY;
    for (int i = 0; i < COUNT; i++) {
        const Variable *v = VARIABLES + i;
        of_kind[v->kind][of_kind_count[v->kind]++] = i;
        if (v->access == OUTPUT) continue;
        settable[v->kind][settable_count[v->kind]++] = i;
        if (v->kind == REAL) fresh.values[i].real = v->start;
        else fresh.values[i].integer = (int64_t)v->start;
    }
    make_twin();
    if (!twin.unit || FMI(GetFMUstate)(twin.unit, &twin.probe) ||
        FMI(SerializedFMUstateSize)(twin.unit, twin.probe, &size) || size > BYTES)
        surprise("the unit cannot be instantiated, or its state is larger than the host expects");
    remember(&twin);
}

static void tidy_up(void) {
    for (int i = 0; i < STATES; i++)
        if (FMI(FreeFMUstate)(twin.unit, &kept[i].state)) surprise("an FMU state cannot be freed");
    for (Slot *s = slots; s < slots + INSTANCES; s++) {
        free_slot(s);
        free(s->name);
    }
    free_slot(&twin);
}

static void report(void) {
    uint64_t all = 0;
    for (int f = 0; f < FUNCTION_COUNT; f++)
        for (int i = 0; i < STATUSES; i++) all += counts[f][i];
    printf("{\"seed\": %llu, \"calls\": %llu, \"slowest_step_us\": %.1f, \"functions\": {", (unsigned long long)seed,
           (unsigned long long)all, slowest);
    for (int f = 0; f < FUNCTION_COUNT; f++) {
        printf("%s\"%s\": {", f ? ", " : "", FUNCTION_NAMES[f]);
        for (int i = 0; i < STATUSES; i++)
            printf("%s\"%s\": %llu", i ? ", " : "", STATUS_NAMES[i], (unsigned long long)counts[f][i]);
        printf("}");
    }
    printf("}}\n");
}

int main(int count, char *arguments[]) {
    if (count != 3) {
        fprintf(stderr, "usage: %s SEED CALLS\n", arguments[0]);
        return 2;
    }
    seed = strtoull(arguments[1], NULL, 10);
    uint64_t calls = strtoull(arguments[2], NULL, 10);
    prepare();
    for (call = 0; call < calls; call++) {
        alarm(PATIENCE);
        Slot *s = slots + below(INSTANCES);
        next_act(s)(s);
    }
    tidy_up();
    report();
    return 0;
}
