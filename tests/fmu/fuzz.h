/* A fuzzing host: random FMI calls in any order, on several instances of one unit, with valid and with invalid arguments.
 *
 * This file has what is common to all versions of FMI: fuzz2.c and fuzz3.c include it and add what is special to theirs.
 * AddressSanitizer and UndefinedBehaviorSanitizer, with which it is linked to the unit, watch the memory; the host itself
 * checks the answers. For every instance it records what an importer can expect (mode, values, pending derivatives, time,
 * log settings), and after every call:
 *
 * - the status is the expected one, and so is what was logged;
 * - a call that failed, or only reads, has left the serialized state unchanged, bit for bit;
 * - no other instance has changed;
 * - values, times and FMU states are read as they were set, and a copy of an instance steps to the same bits;
 * - the call has returned: a call that takes longer than PATIENCE ends the host (SIGALRM).
 *
 *     fuzz SEED CALLS
 *
 * prints one line of JSON: how often each function was called in each mode and what it answered, and how often there were
 * the SITUATIONS. The first failed check ends it. */
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* --- the unit as its modelDescription.xml describes it: expected.h is generated from the block's declarations --- */

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
 * block may refuse values in their ranges, at the end of the initialization and in a step, for another reason than a
 * master too far away), START_OF_STEP and POSITION_ONLY, LONGEST_STEP, MOST_CYCLES (in a step, of a block that has cycles) */
#include "expected.h"

enum { COUNT = sizeof VARIABLES / sizeof *VARIABLES };
enum { MOST = 8, INSTANCES = 4, STATES = 6, BYTES = 1 << 14, PATIENCE = 30 /* s */ };

/* FUNCTIONS(X, Y) lists the functions: X(name) if the name is that of FMI 2.0, or FMI 2.0 has no such function;
 * otherwise Y(name in FMI 2.0, name). */
#define ID(name) name,
#define NAME(name) VERSION #name,
#define NAME_ALONE(name) #name,
#define OTHER_ID(former, name) former,
#define OTHER_NAME(former, name) VERSION #name,
typedef enum { FUNCTIONS(ID, OTHER_ID) FUNCTION_COUNT } Function;
static const char *const FUNCTION_NAMES[] = {FUNCTIONS(NAME, OTHER_NAME)};
static const char *const STATUS_NAMES[] = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};
enum { STATUSES = 6, EITHER = STATUSES, NEAR_STOP }; /* EITHER: OK or refused; NEAR_STOP: an error, too */

typedef enum { NOWHERE = 0, INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY = 15 } Mode;
static const struct {
    Mode mode;
    const char *name;
} MODES[] = {{NOWHERE, "nowhere"},
             {INSTANTIATED, "instantiated"},
             {INITIALIZING, "initializing"},
             {STEPPING, "stepping"},
             {TERMINATED, "terminated"}};
enum { MODE_COUNT = sizeof MODES / sizeof *MODES };

/* What the run has to meet besides: memory that runs out, a step that a copy repeats, a state that is damaged, one that is
 * forged and refused or accepted, and the steps that follow. */
#define SITUATIONS(X) X(no_memory) X(repeated_step) X(damaged) X(forged_refused) X(forged_accepted) X(forged_step)
typedef enum { SITUATIONS(ID) SITUATION_COUNT } Situation;
static const char *const SITUATION_NAMES[] = {SITUATIONS(NAME_ALONE)};
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
    double travelled; /* bound on the master's distance since the initialization, in periods */
    double speed;     /* bound on the master's speed at the end of the last step */
} ExpectedState;

typedef struct {
    Component unit;
    Callbacks callbacks;
    bool listens; /* whether it has a function for messages */
    char *name;
    int logged; /* a set of statuses, one bit each */
    int logs[STATUSES];
    ExpectedState expected;
    FmuState probe; /* through which the bytes are read */
    Byte bytes[BYTES];
} Slot;

typedef struct {
    FmuState state; /* NULL: none */
    ExpectedState expected;
} StoredState;

static Slot slots[INSTANCES], twin;
static Slot *calling; /* whose unit may log now */
static int mode;      /* in which it is called, by its index in MODES */
static StoredState stored_states[STATES];
static ExpectedState fresh;
static size_t size; /* of a serialized state */
static uint64_t seed, call, counts[FUNCTION_COUNT][MODE_COUNT][STATUSES], met[SITUATION_COUNT];
static double slowest;
static int of_kind[KINDS][COUNT], of_kind_count[KINDS], settable[KINDS][COUNT], settable_count[KINDS];

static _Noreturn void fail(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "failed at call %llu of seed %llu: ", (unsigned long long)call, (unsigned long long)seed);
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

/* Whether the next call gets NULL instead of a pointer that it needs. */
static bool passes_null(void) { return one_in(100); }

/* Memory that runs out: the linker sends every malloc and calloc here (--wrap). */
static bool memory_is_out;
void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t each);
static bool lacks_memory(void) {
    if (memory_is_out) met[no_memory]++;
    return memory_is_out;
}
void *__wrap_malloc(size_t n) { return lacks_memory() ? NULL : __real_malloc(n); }
void *__wrap_calloc(size_t n, size_t each) { return lacks_memory() ? NULL : __real_calloc(n, each); }

/* Memory of exactly this size, so that AddressSanitizer reports each byte beyond it; or NULL. */
static void *allocate_exactly(size_t n, size_t each) { return passes_null() ? NULL : malloc(n * each); }

static size_t random_count(void) { return one_in(40) ? COUNT : below(MOST); }

static Reference random_reference(Kind kind, bool to_set) {
    const int *from = to_set ? settable[kind] : of_kind[kind];
    int n = to_set ? settable_count[kind] : of_kind_count[kind];
    if (one_in(60) || !n) return one_in(4) ? (Reference)random_bits() : (Reference)below(COUNT + 3);
    return (Reference)from[below((size_t)n)];
}

static Reference *random_references(size_t n, Kind kind, bool to_set) {
    Reference *r = allocate_exactly(n, sizeof *r);
    for (size_t i = 0; r && i < n; i++) r[i] = random_reference(kind, to_set);
    return r;
}

/* --- checks after every call --- */

static void check_message(Slot *s, Answer status, const char *category, const char *message) {
    if (s != calling) fail("an instance logs that was not called");
    if (strcmp(category, category_of(status))) fail("%s logged as %s", STATUS_NAMES[status], category);
    if (!message || !*message || strchr(message, '%')) fail("an empty message, or one with a format in it");
    s->logs[status]++;
}

static void read_state(Slot *s, Byte *bytes) {
    if (FMI(GetFMUstate)(s->unit, &s->probe) || FMI(SerializeFMUstate)(s->unit, s->probe, bytes, size))
        fail("the state cannot be read");
}

static void check_logs(const Slot *s, Function f, Answer status) {
    const int *n = s->logs;
    int all = 0;
    for (int i = 0; i < STATUSES; i++) {
        all += n[i];
        if (n[i] && !(s->logged & 1 << i)) fail("%s logged what is switched off", FUNCTION_NAMES[f]);
    }
    bool must_log = status != OK;
    if (must_log && s->logged & 1 << status && n[status] != 1)
        fail("%s answered %s and logged it %d times", FUNCTION_NAMES[f], STATUS_NAMES[status], n[status]);
    if (status == OK && all != n[WARNING]) fail("%s answered OK and logged an error", FUNCTION_NAMES[f]);
}

/* Check the answer of a call, its messages and the states of all instances. `changes`: whether a success may change the
 * state. */
static Answer check_call(Slot *s, Function f, Answer status, int expected, bool changes) {
    counts[f][mode][status]++;
    bool is_either = status == OK || status == (f == DoStep ? REFUSED_STEP : ERROR);
    bool is_expected = expected == EITHER ? is_either : expected == NEAR_STOP ? is_either || status == ERROR : (int)status == expected;
    if (!is_expected)
        fail("%s answered %s, expected %s, mode %d", FUNCTION_NAMES[f], STATUS_NAMES[status],
                 expected >= EITHER ? "OK or a refusal" : STATUS_NAMES[expected], (int)s->expected.mode);
    if (s->unit) check_logs(s, f, status);
    for (Slot *other = slots; other < slots + INSTANCES; other++) {
        if (!other->unit) continue;
        Byte now[BYTES];
        bool may_differ = other == s && changes && status != ERROR && status != DISCARD;
        read_state(other, now);
        if (!may_differ && memcmp(now, other->bytes, size))
            fail("%s answered %s and changed the state of %s instance", FUNCTION_NAMES[f], STATUS_NAMES[status],
                     other == s ? "its" : "another");
        memcpy(other->bytes, now, size);
    }
    return status;
}

static Component start_call(Slot *s) {
    calling = s;
    for (mode = 0; MODES[mode].mode != s->expected.mode;) mode++;
    memset(s->logs, 0, sizeof s->logs);
    return s->unit;
}

static int status_if(bool is_valid) { return is_valid ? OK : ERROR; }
static bool is_in(const Slot *s, int modes) { return s->expected.mode & modes; }

static bool is_allowed(const Variable *v, Value value) {
    for (int i = 1; v->choices && i <= v->choices[0]; i++)
        if (v->choices[i] == value.integer) return true;
    if (v->choices) return false;
    if (v->kind == BOOLEAN) return true;
    double x = v->kind == REAL ? value.real : (double)value.integer;
    bool fits = isfinite(x) && x >= v->min && x <= v->max && x > v->above && x < v->below;
    return fits && (x == 0.0 ? v->zero : fabs(x) >= v->smallest);
}

static Value expected_value(const ExpectedState *k, int variable) {
    return variable < 0 ? of_integer(0) : k->values[variable];
}
static bool interpolates(void) {
    return POSITION >= 0 && VELOCITY >= 0 && ACCELERATION >= 0 && INPUT_MODE >= 0;
}

static bool takes_derivatives(const ExpectedState *k) {
    int64_t mode = expected_value(k, INPUT_MODE).integer;
    return interpolates() && (mode == START_OF_STEP || mode == POSITION_ONLY);
}

#include "fuzz_values.h"

/* --- life --- */

static void store_bytes(Slot *s) { read_state(s, s->bytes); }

static const char *random_name(void) {
    static const char *const NAMES[] = {"unit", "50%n%s", "\xc3\xbcnit \xe2\x82\xac", "", NULL};
    return NAMES[one_in(6) ? below(5) : 0];
}
static const char *random_guid(void) {
    static const char *const GUIDS[] = {NULL, "", "{00000000-0000-0000-0000-000000000000}", GUID " ", "{"};
    return one_in(8) ? GUIDS[below(5)] : GUID;
}
static bool are_valid_names(const char *name, const char *guid) { return name && *name && guid && !strcmp(guid, GUID); }

/* Check an attempt to instantiate. `can_log`: whether the unit can log a refusal. */
static void check_instantiation(Slot *s, Function f, bool is_valid, bool can_log) {
    if (!s->unit && can_log && s->logs[ERROR] != 1) fail("refused without a message");
    if (s->unit) {
        s->expected = fresh;
        store_bytes(s);
    }
    check_call(s, f, s->unit ? OK : ERROR, status_if(is_valid), false);
}

static void free_slot(Slot *s) {
    if (s->unit && s->probe && FMI(FreeFMUstate)(s->unit, &s->probe)) fail("an FMU state cannot be freed");
    FMI(FreeInstance)(start_call(s));
    s->unit = NULL;
    s->expected.mode = NOWHERE;
}
static void free_instance(Slot *s) {
    free_slot(s);
    check_call(s, FreeInstance, OK, OK, false);
}

static void get_version(Slot *s) {
    start_call(s);
    check_call(s, GetVersion, strcmp(FMI(GetVersion)(), VERSION_TEXT) ? ERROR : OK, OK, false);
}

static void set_debug_logging(Slot *s) {
    size_t n = below(4);
    const char **categories = allocate_exactly(n, sizeof *categories);
    int statuses = n ? 0 : -1;
    bool is_valid = s->unit && (!n || categories);
    for (size_t i = 0; categories && i < n; i++) {
        size_t k = below(CATEGORY_COUNT + (one_in(4) ? 3 : 0));
        static const char *const UNKNOWN[] = {"logEvents", "", NULL};
        categories[i] = k < CATEGORY_COUNT ? CATEGORIES[k].name : UNKNOWN[k - CATEGORY_COUNT];
        if (k < CATEGORY_COUNT) statuses |= CATEGORIES[k].statuses;
        else is_valid = false;
    }
    bool on = !one_in(4);
    Answer status = FMI(SetDebugLogging)(start_call(s), on, n, categories);
    check_call(s, SetDebugLogging, status, status_if(is_valid), false);
    if (!status) s->logged = !s->listens ? 0 : on ? statuses | LOGGED_ALWAYS : LOGGED_OFF;
    free(categories);
}

static void exit_initialization_mode(Slot *s) {
    const ExpectedState *k = &s->expected;
    bool is_valid = is_in(s, INITIALIZING);
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].access != OUTPUT && !is_allowed(VARIABLES + i, k->values[i])) is_valid = false;
    double period = expected_value(k, PERIOD).real, revolutions = fabs(expected_value(k, POSITION).real) / period;
    bool refusable = REFUSES_STARTS || (period > 0.0 && revolutions > 0.5e15);
    int expected = is_valid && refusable ? EITHER : status_if(is_valid);
    if (check_call(s, ExitInitializationMode, FMI(ExitInitializationMode)(start_call(s)), expected, true)) return;
    s->expected.mode = STEPPING;
    s->expected.travelled = period > 0.0 ? revolutions : 0.0;
    s->expected.speed = fabs(expected_value(k, VELOCITY).real);
}

static void terminate(Slot *s) {
    if (!check_call(s, Terminate, FMI(Terminate)(start_call(s)), status_if(is_in(s, STEPPING)), true))
        s->expected.mode = TERMINATED;
}
static void reset(Slot *s) {
    if (!check_call(s, Reset, FMI(Reset)(start_call(s)), status_if(is_in(s, ANY)), true)) s->expected = fresh;
}

/* --- the step --- */

/* Whether the master may be so many periods away, by a bound from above, that the block refuses it. */
static bool may_be_far_away(const ExpectedState *k, double h, double *travelled, double *speed) {
    bool estimated = expected_value(k, INPUT_MODE).integer == POSITION_ONLY;
    double v = k->given[1] || estimated ? 1e12 : fabs(expected_value(k, VELOCITY).real);
    double a = k->given[2] || estimated ? 1e12 : fabs(expected_value(k, ACCELERATION).real);
    double period = expected_value(k, PERIOD).real;
    double distance = fabs(expected_value(k, POSITION).real) + (v + k->speed + a * h) * h + period;
    *travelled = k->travelled + (period > 0.0 ? distance / period : 0.0);
    *speed = v + a * h;
    return *travelled > 1e14;
}

static int expected_of_step(const Slot *s, double t, double h, bool uses_derivatives) {
    double past = t + h - s->expected.stop; /* a hundredth of the step is allowed */
    bool is_valid = is_in(s, STEPPING) && h > 0.0 && h <= LONGEST_STEP && isfinite(t);
    if (is_valid && past > 0.009 * h) return past > 0.011 * h ? ERROR : NEAR_STOP;
    for (int i = 0; i < COUNT; i++)
        if (VARIABLES[i].access == INPUT && !is_allowed(VARIABLES + i, s->expected.values[i])) is_valid = false;
    if (TASK_CYCLE >= 0 && h > MOST_CYCLES * expected_value(&s->expected, TASK_CYCLE).real) is_valid = false;
    for (int order = 1; uses_derivatives && order <= 2; order++)
        if (s->expected.given[order] && !(fabs(s->expected.derivatives[order]) <= 1e12)) is_valid = false;
    return is_valid ? OK : is_in(s, STEPPING) ? REFUSED_STEP : ERROR;
}

static double random_step(void) {
    if (one_in(40)) return share() * 2e6; /* of some blocks it takes a thousand times as long */
    return one_in(10) ? random_real() : share() * 0.1;
}

/* Check that an instance with this one's state from before the step takes the same step to the same state. */
static void check_twin(Slot *s, FmuState before, double t, double h) {
    Byte bytes[BYTES];
    start_call(&twin);
    if (FMI(SetFMUstate)(twin.unit, before) || FMI(DoStep)(twin.unit, t, h, false))
        fail("a copy cannot do the same step");
    read_state(&twin, bytes);
    if (memcmp(bytes, s->bytes, size)) fail("a copy steps to another state");
}

static void do_step(Slot *s) {
    double t = one_in(10) ? random_real() : s->expected.time, h = random_step(), travelled, speed;
    ExpectedState *k = &s->expected;
    bool uses_derivatives = (k->given[1] || k->given[2]) && takes_derivatives(k);
    int expected = expected_of_step(s, t, h, uses_derivatives);
    if ((may_be_far_away(k, h, &travelled, &speed) || REFUSES_STEPS) && !expected) expected = EITHER;
    FmuState before = NULL;
    bool is_repeated = (expected == OK || expected == EITHER) && one_in(8);
    if (is_repeated && FMI(GetFMUstate)(s->unit, &before)) fail("no state before a step");
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    Answer status = FMI(DoStep)(start_call(s), t, h, one_in(2));
    clock_gettime(CLOCK_MONOTONIC, &end);
    double duration = (double)(end.tv_sec - start.tv_sec) * 1e6 + (double)(end.tv_nsec - start.tv_nsec) * 1e-3;
    if (duration > slowest) slowest = duration;
    if (!check_call(s, DoStep, status, expected, true)) {
        k->time = t + h;
        k->given[1] = k->given[2] = false;
        k->travelled = travelled;
        k->speed = speed;
        if (is_repeated) check_twin(s, before, t, h), met[repeated_step]++;
    }
    if (before && FMI(FreeFMUstate)(s->unit, &before)) fail("an FMU state cannot be freed");
}

#include "fuzz_states.h"

/* --- the run --- */

typedef struct {
    int weight; /* those that end a simulation are rare: deep states need long ones */
    void (*action)(Slot *);
} Action;

#define ACTIONS_OF_ALL_VERSIONS                                                                                        \
    {60, do_step}, {40, set_real}, {12, set_integer}, {25, set_boolean}, {25, get_real}, {12, get_integer},            \
        {12, get_boolean}, {3, get_string}, {3, set_string}, {3, get_version}, {4, set_debug_logging},                 \
        {1, free_instance}, {2, enter_initialization_mode}, {2, exit_initialization_mode}, {1, terminate}, {1, reset}, \
        {6, get_fmu_state}, {4, set_fmu_state}, {4, free_fmu_state}, {4, foreign_fmu_state},                           \
        {4, serialized_fmu_state_size}, {4, serialize_fmu_state}, {8, deserialize_fmu_state}, {4, forge_state},        \
        {6, get_real_output_derivatives}

/* Defined by the file that includes this one. The last action is empty; the twin is an instance that only copies. */
static const Action *all_actions(void);
static void instantiate(Slot *s);
static void enter_initialization_mode(Slot *s);
static void make_twin(void);

/* Random calls alone seldom reach step mode, where most of the code is: prefer those that lead to it. Each mode lasts long
 * enough that all functions are called in it. */
static void (*next_action(const Slot *s))(Slot *) {
    switch (s->expected.mode) {
    case NOWHERE:
        if (one_in(20)) return instantiate;
        break;
    case INSTANTIATED:
        if (one_in(20)) return enter_initialization_mode;
        break;
    case INITIALIZING:
        if (one_in(6)) return exit_initialization_mode;
        if (one_in(40)) return reset;
        break;
    case TERMINATED:
        if (one_in(60)) return reset;
        break;
    default: break;
    }
    int all = 0;
    for (const Action *action = all_actions(); action->action; action++) all += action->weight;
    int remaining_weight = (int)below((size_t)all);
    const Action *action = all_actions();
    while ((remaining_weight -= action->weight) >= 0) action++;
    return action->action;
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
        fail("the unit cannot be instantiated, or its state is larger than the host expects");
    store_bytes(&twin);
}

static void tidy_up(void) {
    for (int i = 0; i < STATES; i++)
        if (FMI(FreeFMUstate)(twin.unit, &stored_states[i].state)) fail("an FMU state cannot be freed");
    for (Slot *s = slots; s < slots + INSTANCES; s++) {
        free_slot(s);
        free(s->name);
    }
    free_slot(&twin);
}

static void report(void) {
    uint64_t all = 0;
    printf("{\"functions\": {");
    for (int f = 0; f < FUNCTION_COUNT; f++) {
        printf("%s\"%s\": {", f ? ", " : "", FUNCTION_NAMES[f]);
        for (int m = 0; m < MODE_COUNT; m++) {
            printf("%s\"%s\": {", m ? ", " : "", MODES[m].name);
            for (int i = 0; i < STATUSES; i++) {
                printf("%s\"%s\": %llu", i ? ", " : "", STATUS_NAMES[i], (unsigned long long)counts[f][m][i]);
                all += counts[f][m][i];
            }
            printf("}");
        }
        printf("}");
    }
    printf("}, \"situations\": {");
    for (int i = 0; i < SITUATION_COUNT; i++)
        printf("%s\"%s\": %llu", i ? ", " : "", SITUATION_NAMES[i], (unsigned long long)met[i]);
    printf("}, \"seed\": %llu, \"calls\": %llu, \"slowest_step_us\": %.1f}\n", (unsigned long long)seed,
           (unsigned long long)all, slowest);
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
        next_action(s)(s);
    }
    tidy_up();
    report();
    return 0;
}
