/* The fuzzing host for FMI 2.0; fuzz.h says what it does. */
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
#define FUNCTIONS(X, Y)                                                                                           \
    X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance) X(SetupExperiment)        \
    X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset) X(GetReal) X(GetInteger)           \
    X(GetBoolean) X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate) X(SetFMUstate)  \
    X(FreeFMUstate) X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate)                         \
    X(GetDirectionalDerivative) X(SetRealInputDerivatives) X(GetRealOutputDerivatives) X(DoStep) X(CancelStep)    \
    X(GetStatus) X(GetRealStatus) X(GetIntegerStatus) X(GetBooleanStatus) X(GetStringStatus) X(EnterEventMode)    \
    X(NewDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates)  \
    X(GetDerivatives) X(GetEventIndicators) X(GetContinuousStates) X(GetNominalsOfContinuousStates)

/* The log categories, and the sets of statuses for which they stand; what is logged whatever is chosen, and if logging is
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

static void note(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    Slot *s = environment;
    if (!name || strcmp(name, s->name ? s->name : "")) surprise("logged under another instance's name: %s", name);
    noted(s, status, category, message);
}

static void instantiate(Slot *s) {
    if (s->unit) return;
    const char *name = random_name(), *guid = random_guid();
    fmi2Type type = one_in(12) ? fmi2ModelExchange : fmi2CoSimulation;
    bool callbacks = !one_in(20), logging = !one_in(3);
    bool good = good_names(name, guid) && callbacks && type == fmi2CoSimulation;
    free(s->name);
    s->name = name ? strdup(name) : NULL;
    s->callbacks = (fmi2CallbackFunctions){one_in(6) ? NULL : note, calloc, free, NULL, s};
    if (one_in(4)) s->callbacks.allocateMemory = NULL, s->callbacks.freeMemory = NULL;
    s->listens = s->callbacks.logger;
    s->logged = s->listens ? -1 : 0;
    const char *resources = one_in(3) ? NULL : "file:///nowhere";
    called(s);
    scarce = one_in(30);
    bool lacking = scarce;
    s->unit = fmi2Instantiate(name, type, guid, resources, callbacks ? &s->callbacks : NULL, one_in(2), logging);
    scarce = false;
    instantiated(s, Instantiate, good && !lacking, !lacking && callbacks && s->listens);
}

static void make_twin(void) {
    twin.callbacks = (fmi2CallbackFunctions){NULL, NULL, NULL, NULL, &twin};
    twin.unit = fmi2Instantiate("twin", fmi2CoSimulation, GUID, NULL, &twin.callbacks, fmi2False, fmi2False);
}

static void get_types_platform(Slot *s) {
    called(s);
    bool right = !strcmp(fmi2GetTypesPlatform(), fmi2TypesPlatform);
    concluded(s, GetTypesPlatform, right ? OK : ERROR, OK, false);
}

static void setup_experiment(Slot *s) {
    double start = random_real(), stop = one_in(2) ? random_real() : start + 1e4 * share();
    bool ends = one_in(4), good = in(s, INSTANTIATED) && isfinite(start) && (!ends || stop >= start);
    Answer status = fmi2SetupExperiment(called(s), one_in(2), random_real(), start, ends, stop);
    if (concluded(s, SetupExperiment, status, expected(good), true)) return;
    s->known.time = start;
    s->known.stop = ends ? stop : INFINITY;
}

static void enter_initialization_mode(Slot *s) {
    Answer status = fmi2EnterInitializationMode(called(s));
    if (!concluded(s, EnterInitializationMode, status, expected(in(s, INSTANTIATED)), true))
        s->known.mode = INITIALIZING;
}

static void cancel_step(Slot *s) { concluded(s, CancelStep, fmi2CancelStep(called(s)), ERROR, false); }

/* --- derivatives --- */

static void set_real_input_derivatives(Slot *s) {
    size_t n = below(4);
    Reference *r = random_references(n, REAL, !one_in(8));
    fmi2Integer *order = random_orders(n);
    fmi2Real *values = room(n, sizeof *values);
    bool good = in(s, INSTANTIATED | INITIALIZING | STEPPING) && (!n || (r && order && values)), ignored = false;
    Knowledge known = s->known;
    for (size_t i = 0; good && i < n; i++) {
        if (!one_in(4) && interpolates()) r[i] = (Reference)POSITION;
        values[i] = random_real();
        if (r[i] >= COUNT || VARIABLES[r[i]].kind != REAL || VARIABLES[r[i]].access != INPUT || order[i] < 1) {
            good = false;
        } else if (!interpolates() || (int)r[i] != POSITION || order[i] > 2 ||
                   known.values[INPUT_MODE].integer == END_OF_STEP) {
            ignored = true;
        } else {
            known.given[order[i]] = true;
            known.derivatives[order[i]] = values[i];
        }
    }
    int wanted = good && ignored ? WARNING : expected(good);
    Answer status = fmi2SetRealInputDerivatives(called(s), r, n, order, values);
    bool taken = memcmp(&known, &s->known, sizeof known);
    if (concluded(s, SetRealInputDerivatives, status, wanted, taken) != ERROR) s->known = known;
    free(r), free(order), free(values);
}

static void get_directional_derivative(Slot *s) {
    Reference *r = random_references(2, REAL, false);
    fmi2Real in_values[2] = {1.0, 1.0}, out[2];
    Answer status = fmi2GetDirectionalDerivative(called(s), r, 2, r, below(3), one_in(4) ? NULL : in_values, out);
    concluded(s, GetDirectionalDerivative, status, ERROR, false);
    free(r);
}

/* --- status --- */

static fmi2StatusKind random_kind(void) { return (fmi2StatusKind)below(one_in(4) ? 6 : 4); }
static int asking(const Slot *s, bool where, bool known) {
    return in(s, STEPPING | TERMINATED) && where ? known ? OK : DISCARD : ERROR;
}

static void get_real_status(Slot *s) {
    fmi2StatusKind kind = random_kind();
    fmi2Real time, *where = forgotten() ? NULL : &time;
    int wanted = asking(s, where, kind == fmi2LastSuccessfulTime);
    if (!concluded(s, GetRealStatus, fmi2GetRealStatus(called(s), kind, where), wanted, false) &&
        time != s->known.time)
        surprise("the last successful time is %g, not %g", time, s->known.time);
}
static void get_boolean_status(Slot *s) {
    fmi2StatusKind kind = random_kind();
    fmi2Boolean ended, *where = forgotten() ? NULL : &ended;
    int wanted = asking(s, where, kind == fmi2Terminated);
    if (!concluded(s, GetBooleanStatus, fmi2GetBooleanStatus(called(s), kind, where), wanted, false) &&
        ended != in(s, TERMINATED))
        surprise("terminated is wrong");
}

#define NEVER_KNOWN(Type, T)                                                                                    \
    static void get_##T(Slot *s) {                                                                              \
        fmi2##Type value, *where = forgotten() ? NULL : &value;                                                 \
        int wanted = asking(s, where, false);                                                                   \
        concluded(s, Get##T, fmi2Get##T(called(s), random_kind(), where), wanted, false);                       \
    }
NEVER_KNOWN(Status, Status)
NEVER_KNOWN(Integer, IntegerStatus)
NEVER_KNOWN(String, StringStatus)

/* --- model exchange: there, but only to be refused --- */

static void exchange_model(Slot *s) {
    double x[COUNT];
    fmi2Boolean event, terminated;
    fmi2EventInfo info;
    size_t n = below(COUNT);
    double *where = forgotten() ? NULL : x;
#define REFUSED(function, ...) \
    case function: concluded(s, function, fmi2##function(__VA_ARGS__), ERROR, false); break
    switch (EnterEventMode + below(FUNCTION_COUNT - EnterEventMode)) {
        REFUSED(EnterEventMode, called(s));
        REFUSED(NewDiscreteStates, called(s), forgotten() ? NULL : &info);
        REFUSED(EnterContinuousTimeMode, called(s));
        REFUSED(CompletedIntegratorStep, called(s), one_in(2), forgotten() ? NULL : &event, &terminated);
        REFUSED(SetTime, called(s), random_real());
        REFUSED(SetContinuousStates, called(s), NULL, n);
        REFUSED(GetDerivatives, called(s), where, n);
        REFUSED(GetEventIndicators, called(s), where, n);
        REFUSED(GetContinuousStates, called(s), where, n);
        REFUSED(GetNominalsOfContinuousStates, called(s), where, n);
    }
}

/* --- the acts --- */

static const Act *all_acts(void) {
    static const Act ACTS[] = {
        ACTS_OF_ALL_VERSIONS, {3, get_types_platform}, {3, setup_experiment}, {3, get_directional_derivative},
        {8, set_real_input_derivatives}, {3, cancel_step}, {3, get_Status}, {4, get_real_status},
        {3, get_IntegerStatus}, {4, get_boolean_status}, {3, get_StringStatus}, {8, exchange_model}, {0, NULL}};
    return ACTS;
}
