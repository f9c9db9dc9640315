/* The fuzzing host for FMI 2.0; fuzz.h describes it. */
#include <stdbool.h>
#include <string.h>
#include "fmi2Functions.h"

typedef int Answer; /* a status */
enum { OK = fmi2OK, WARNING = fmi2Warning, DISCARD = fmi2Discard, ERROR = fmi2Error, REFUSED_STEP = ERROR };
typedef fmi2Component Component;
typedef fmi2ValueReference Reference;
typedef fmi2FMUstate FmuState;
typedef fmi2Byte Byte;
typedef fmi2Boolean Boolean;
typedef fmi2CallbackFunctions Callbacks;

#define FMI(function) fmi2##function
#define VERSION "fmi2"
#define VERSION_TEXT "2.0"
#define FUNCTIONS(X, Y)                                                                                          \
    X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance) X(SetupExperiment)       \
    X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset) X(GetReal) X(GetInteger)          \
    X(GetBoolean) X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate) X(SetFMUstate) \
    X(FreeFMUstate) X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate)                        \
    X(GetDirectionalDerivative) X(SetRealInputDerivatives) X(GetRealOutputDerivatives) X(DoStep) X(CancelStep)   \
    X(GetStatus) X(GetRealStatus) X(GetIntegerStatus) X(GetBooleanStatus) X(GetStringStatus) X(EnterEventMode)   \
    X(NewDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates) \
    X(GetDerivatives) X(GetEventIndicators) X(GetContinuousStates) X(GetNominalsOfContinuousStates)

/* The log categories, and the set of statuses of each; what is logged in any case, and if logging is
 * off. */
static const struct {
    const char *name;
    int statuses;
} CATEGORIES[] = {{"logStatusWarning", 1 << WARNING}, {"logStatusError", ~(1 << WARNING)}, {"logAll", -1}};
enum { CATEGORY_COUNT = sizeof CATEGORIES / sizeof *CATEGORIES, LOGGED_ALWAYS = 0, LOGGED_OFF = -1 };
static const char *category_of(Answer status) { return status == WARNING ? "logStatusWarning" : "logStatusError"; }

enum { TIME_IS_A_VARIABLE = false };

#include "fuzz.h"

/* --- life --- */

static void on_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    Slot *s = environment;
    if (!name || strcmp(name, s->name ? s->name : "")) fail("logged under another instance's name: %s", name);
    check_message(s, status, category, message);
}

static void instantiate(Slot *s) {
    if (s->unit) return;
    const char *name = random_name(), *guid = random_guid();
    fmi2Type type = one_in(12) ? fmi2ModelExchange : fmi2CoSimulation;
    bool callbacks = !one_in(20), logging = !one_in(3);
    bool is_valid = are_valid_names(name, guid) && callbacks && type == fmi2CoSimulation;
    free(s->name);
    s->name = name ? strdup(name) : NULL;
    s->callbacks = (fmi2CallbackFunctions){one_in(6) ? NULL : on_message, calloc, free, NULL, s};
    if (one_in(4)) s->callbacks.allocateMemory = NULL, s->callbacks.freeMemory = NULL;
    s->listens = s->callbacks.logger;
    s->logged = s->listens ? -1 : 0;
    const char *resources = one_in(3) ? NULL : "file:///nowhere";
    start_call(s);
    memory_is_out = one_in(30);
    bool is_out_of_memory = memory_is_out;
    s->unit = fmi2Instantiate(name, type, guid, resources, callbacks ? &s->callbacks : NULL, one_in(2), logging);
    memory_is_out = false;
    check_instantiation(s, Instantiate, is_valid && !is_out_of_memory, !is_out_of_memory && callbacks && s->listens);
}

static void make_twin(void) {
    twin.callbacks = (fmi2CallbackFunctions){NULL, NULL, NULL, NULL, &twin};
    twin.unit = fmi2Instantiate("twin", fmi2CoSimulation, GUID, NULL, &twin.callbacks, fmi2False, fmi2False);
}

static void get_types_platform(Slot *s) {
    start_call(s);
    bool right = !strcmp(fmi2GetTypesPlatform(), fmi2TypesPlatform);
    check_call(s, GetTypesPlatform, right ? OK : ERROR, OK, false);
}

static void setup_experiment(Slot *s) {
    double start = random_real(), stop = one_in(2) ? random_real() : start + 1e4 * share();
    bool ends = one_in(4), is_valid = is_in(s, INSTANTIATED) && isfinite(start) && (!ends || stop >= start);
    Answer status = fmi2SetupExperiment(start_call(s), one_in(2), random_real(), start, ends, stop);
    if (check_call(s, SetupExperiment, status, status_if(is_valid), true)) return;
    s->expected.time = start;
    s->expected.stop = ends ? stop : INFINITY;
}

static void enter_initialization_mode(Slot *s) {
    Answer status = fmi2EnterInitializationMode(start_call(s));
    if (!check_call(s, EnterInitializationMode, status, status_if(is_in(s, INSTANTIATED)), true))
        s->expected.mode = INITIALIZING;
}

static void cancel_step(Slot *s) { check_call(s, CancelStep, fmi2CancelStep(start_call(s)), ERROR, false); }

/* --- derivatives --- */

static void set_real_input_derivatives(Slot *s) {
    size_t n = below(4);
    Reference *r = random_references(n, REAL, !one_in(8));
    fmi2Integer *order = random_orders(n);
    fmi2Real *values = allocate_exactly(n, sizeof *values);
    bool is_valid = is_in(s, INSTANTIATED | INITIALIZING | STEPPING) && (!n || (r && order && values)), ignored = false;
    ExpectedState new_state = s->expected;
    for (size_t i = 0; is_valid && i < n; i++) {
        if (!one_in(4) && interpolates()) r[i] = (Reference)POSITION;
        values[i] = random_real();
        if (r[i] >= COUNT || VARIABLES[r[i]].kind != REAL || VARIABLES[r[i]].access != INPUT || order[i] < 1) {
            is_valid = false;
        } else if (!takes_derivatives(&new_state) || (int)r[i] != POSITION || order[i] > 2) {
            ignored = true;
        } else {
            new_state.given[order[i]] = true;
            new_state.derivatives[order[i]] = values[i];
        }
    }
    int expected = is_valid && ignored ? WARNING : status_if(is_valid);
    Answer status = fmi2SetRealInputDerivatives(start_call(s), r, n, order, values);
    bool changes = memcmp(&new_state, &s->expected, sizeof new_state);
    if (check_call(s, SetRealInputDerivatives, status, expected, changes) != ERROR) s->expected = new_state;
    free(r), free(order), free(values);
}

static void get_directional_derivative(Slot *s) {
    Reference *r = random_references(2, REAL, false);
    fmi2Real in_values[2] = {1.0, 1.0}, out[2];
    Answer status = fmi2GetDirectionalDerivative(start_call(s), r, 2, r, below(3), one_in(4) ? NULL : in_values, out);
    check_call(s, GetDirectionalDerivative, status, ERROR, false);
    free(r);
}

/* --- status --- */

static fmi2StatusKind random_kind(void) { return (fmi2StatusKind)below(one_in(4) ? 6 : 4); }
static int expected_of_status(const Slot *s, bool destination, bool is_available) {
    return is_in(s, STEPPING | TERMINATED) && destination ? is_available ? OK : DISCARD : ERROR;
}

static void get_real_status(Slot *s) {
    fmi2StatusKind kind = random_kind();
    fmi2Real time, *destination = passes_null() ? NULL : &time;
    int expected = expected_of_status(s, destination, kind == fmi2LastSuccessfulTime);
    if (!check_call(s, GetRealStatus, fmi2GetRealStatus(start_call(s), kind, destination), expected, false) &&
        time != s->expected.time)
        fail("the last successful time is %g, not %g", time, s->expected.time);
}
static void get_boolean_status(Slot *s) {
    fmi2StatusKind kind = random_kind();
    fmi2Boolean ended, *destination = passes_null() ? NULL : &ended;
    int expected = expected_of_status(s, destination, kind == fmi2Terminated);
    if (!check_call(s, GetBooleanStatus, fmi2GetBooleanStatus(start_call(s), kind, destination), expected, false) &&
        ended != is_in(s, TERMINATED))
        fail("terminated is wrong");
}

#define NEVER_AVAILABLE(Type, T)                                                                       \
    static void get_##T(Slot *s) {                                                                     \
        fmi2##Type value, *destination = passes_null() ? NULL : &value;                                \
        int expected = expected_of_status(s, destination, false);                                      \
        check_call(s, Get##T, fmi2Get##T(start_call(s), random_kind(), destination), expected, false); \
    }
NEVER_AVAILABLE(Status, Status)
NEVER_AVAILABLE(Integer, IntegerStatus)
NEVER_AVAILABLE(String, StringStatus)

/* --- model exchange: these functions exist, but refuse every call --- */

static void exchange_model(Slot *s) {
    double x[COUNT];
    fmi2Boolean event, terminated;
    fmi2EventInfo info;
    size_t n = below(COUNT);
    double *destination = passes_null() ? NULL : x;
#define REFUSED(function, ...) \
    case function: check_call(s, function, fmi2##function(__VA_ARGS__), ERROR, false); break
    switch (EnterEventMode + below(FUNCTION_COUNT - EnterEventMode)) {
        REFUSED(EnterEventMode, start_call(s));
        REFUSED(NewDiscreteStates, start_call(s), passes_null() ? NULL : &info);
        REFUSED(EnterContinuousTimeMode, start_call(s));
        REFUSED(CompletedIntegratorStep, start_call(s), one_in(2), passes_null() ? NULL : &event, &terminated);
        REFUSED(SetTime, start_call(s), random_real());
        REFUSED(SetContinuousStates, start_call(s), NULL, n);
        REFUSED(GetDerivatives, start_call(s), destination, n);
        REFUSED(GetEventIndicators, start_call(s), destination, n);
        REFUSED(GetContinuousStates, start_call(s), destination, n);
        REFUSED(GetNominalsOfContinuousStates, start_call(s), destination, n);
    }
}

/* --- the actions --- */

static const Action *all_actions(void) {
    static const Action ACTIONS[] = {
        ACTIONS_OF_ALL_VERSIONS, {3, get_types_platform}, {6, setup_experiment}, {3, get_directional_derivative},
        {8, set_real_input_derivatives}, {3, cancel_step}, {3, get_Status}, {4, get_real_status},
        {3, get_IntegerStatus}, {4, get_boolean_status}, {3, get_StringStatus}, {20, exchange_model}, {0, NULL}};
    return ACTIONS;
}
