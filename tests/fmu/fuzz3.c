/* The fuzzing host for FMI 3.0; fuzz.h describes it. */
#include <math.h>
#include <string.h>
#include "fmi3Functions.h"

typedef int Answer; /* a status */
enum { OK = fmi3OK, WARNING = fmi3Warning, DISCARD = fmi3Discard, ERROR = fmi3Error, REFUSED_STEP = DISCARD };
typedef fmi3Instance Component;
typedef fmi3ValueReference Reference;
typedef fmi3FMUState FmuState;
typedef fmi3Byte Byte;
typedef fmi3Boolean Boolean;
typedef fmi3LogMessageCallback Callbacks;

#define FMI(function) as2##function
#define VERSION "fmi3"
#define VERSION_TEXT "3.0"
#define FUNCTIONS(X, Y)                                                                                         \
    X(GetVersion) X(SetDebugLogging) X(InstantiateCoSimulation) X(InstantiateModelExchange)                     \
    X(InstantiateScheduledExecution) X(FreeInstance) X(EnterInitializationMode) X(ExitInitializationMode)       \
    X(Terminate) X(Reset) X(DoStep) Y(GetReal, GetFloat64) Y(SetReal, SetFloat64) Y(GetInteger, GetInt32)       \
    Y(SetInteger, SetInt32) Y(GetEnumeration, GetInt64) Y(SetEnumeration, SetInt64) X(GetBoolean) X(SetBoolean) \
    X(GetString) X(SetString) Y(GetFMUstate, GetFMUState) Y(SetFMUstate, SetFMUState)                           \
    Y(FreeFMUstate, FreeFMUState) Y(SerializedFMUstateSize, SerializedFMUStateSize)                             \
    Y(SerializeFMUstate, SerializeFMUState) Y(DeSerializeFMUstate, DeserializeFMUState)                         \
    Y(GetRealOutputDerivatives, GetOutputDerivatives) X(GetFloat32) X(SetFloat32) X(GetInt8) X(SetInt8)         \
    X(GetUInt8) X(SetUInt8) X(GetInt16) X(SetInt16) X(GetUInt16) X(SetUInt16) X(GetUInt32) X(SetUInt32)         \
    X(GetUInt64) X(SetUInt64) X(GetBinary) X(SetBinary) X(GetClock) X(SetClock)                                 \
    X(GetNumberOfVariableDependencies) X(GetVariableDependencies) X(GetDirectionalDerivative)                   \
    X(GetAdjointDerivative) X(EnterConfigurationMode) X(ExitConfigurationMode) X(EnterEventMode)                \
    X(EnterStepMode) X(GetIntervalDecimal) X(GetIntervalFraction) X(GetShiftDecimal) X(GetShiftFraction)        \
    X(SetIntervalDecimal) X(SetIntervalFraction) X(SetShiftDecimal) X(SetShiftFraction)                         \
    X(EvaluateDiscreteStates) X(UpdateDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep)     \
    X(SetTime) X(SetContinuousStates) X(GetContinuousStateDerivatives) X(GetEventIndicators)                    \
    X(GetContinuousStates) X(GetNominalsOfContinuousStates) X(GetNumberOfEventIndicators)                       \
    X(GetNumberOfContinuousStates) X(ActivateModelPartition)

/* The log categories, and the set of statuses of each; what is logged in any case, and if logging is
 * off. */
static const struct {
    const char *name;
    int statuses;
} CATEGORIES[] = {{"logStatusWarning", 1 << WARNING},
                  {"logStatusDiscard", 1 << DISCARD},
                  {"logStatusError", 1 << ERROR},
                  {"logAll", -1}};
enum { CATEGORY_COUNT = sizeof CATEGORIES / sizeof *CATEGORIES, LOGGED_ALWAYS = 1 << ERROR, LOGGED_OFF = 1 << ERROR };
static const char *category_of(Answer status) { return CATEGORIES[status - WARNING].name; }

enum { TIME_IS_A_VARIABLE = true };

/* --- the functions that both versions have, with the parameters of FMI 2.0 --- */

static bool one_in(size_t n);
static _Noreturn void fail(const char *format, ...);

#define as2GetVersion fmi3GetVersion
#define as2SetDebugLogging fmi3SetDebugLogging
#define as2FreeInstance fmi3FreeInstance
#define as2ExitInitializationMode fmi3ExitInitializationMode
#define as2Terminate fmi3Terminate
#define as2Reset fmi3Reset
#define as2GetFMUstate fmi3GetFMUState
#define as2SetFMUstate fmi3SetFMUState
#define as2FreeFMUstate fmi3FreeFMUState
#define as2SerializedFMUstateSize fmi3SerializedFMUStateSize
#define as2SerializeFMUstate fmi3SerializeFMUState
#define as2DeSerializeFMUstate fmi3DeserializeFMUState
#define as2GetReal(c, r, n, values) fmi3GetFloat64(c, r, n, values, n)
#define as2SetReal(c, r, n, values) fmi3SetFloat64(c, r, n, values, n)
#define as2GetInteger(c, r, n, values) fmi3GetInt32(c, r, n, values, n)
#define as2SetInteger(c, r, n, values) fmi3SetInt32(c, r, n, values, n)
#define as2GetEnumeration(c, r, n, values) fmi3GetInt64(c, r, n, values, n)
#define as2SetEnumeration(c, r, n, values) fmi3SetInt64(c, r, n, values, n)
#define as2GetBoolean(c, r, n, values) fmi3GetBoolean(c, r, n, values, n)
#define as2SetBoolean(c, r, n, values) fmi3SetBoolean(c, r, n, values, n)
#define as2GetString(c, r, n, values) fmi3GetString(c, r, n, values, n)
#define as2SetString(c, r, n, values) fmi3SetString(c, r, n, values, n)
#define as2GetRealOutputDerivatives(c, r, n, orders, values) fmi3GetOutputDerivatives(c, r, n, orders, values, n)

static Answer as2DoStep(fmi3Instance c, double time, double h, bool noSetFMUStatePriorToCurrentPoint) {
    fmi3Boolean event = true, ended = true, early = true;
    double reached = NAN;
    bool has_outputs = !one_in(8);
    Answer status = fmi3DoStep(c, time, h, noSetFMUStatePriorToCurrentPoint, has_outputs ? &event : NULL,
                                   has_outputs ? &ended : NULL, has_outputs ? &early : NULL,
                               has_outputs ? &reached : NULL);
    if (has_outputs && (event || ended || early)) fail("a step reports an event, an end or an early return");
    if (has_outputs && !status && reached != time + h) fail("a step up to %g reached %g", time + h, reached);
    if (has_outputs && status == DISCARD && !isfinite(reached)) fail("a discarded step does not report the time");
    return status;
}

#include "fuzz.h"

/* --- life --- */

static void on_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    check_message(environment, status, category, message);
}

static void instantiate(Slot *s) {
    if (s->unit) return;
    const char *name = random_name(), *guid = random_guid();
    Function f = one_in(12) ? InstantiateModelExchange : one_in(12) ? InstantiateScheduledExecution
                                                                    : InstantiateCoSimulation;
    bool events = one_in(12), logging = !one_in(3);
    bool is_valid = are_valid_names(name, guid) && f == InstantiateCoSimulation && !events;
    const char *resources = one_in(3) ? NULL : "/nowhere/";
    s->listens = !one_in(6);
    s->callbacks = s->listens ? on_message : NULL;
    s->logged = !s->listens ? 0 : logging ? -1 : 1 << ERROR;
    start_call(s);
    memory_is_out = one_in(30);
    bool is_out_of_memory = memory_is_out;
    if (f == InstantiateCoSimulation)
        s->unit = fmi3InstantiateCoSimulation(name, guid, resources, one_in(2), logging, events, one_in(2), NULL, 0, s,
                                              s->callbacks, NULL);
    else if (f == InstantiateModelExchange)
        s->unit = fmi3InstantiateModelExchange(name, guid, resources, one_in(2), logging, s, s->callbacks);
    else
        s->unit = fmi3InstantiateScheduledExecution(name, guid, resources, one_in(2), logging, s, s->callbacks, NULL,
                                                    NULL, NULL);
    memory_is_out = false;
    check_instantiation(s, f, is_valid && !is_out_of_memory, !is_out_of_memory && s->listens);
}

static void make_twin(void) {
    twin.unit = fmi3InstantiateCoSimulation("twin", GUID, NULL, false, false, false, false, NULL, 0, &twin, NULL, NULL);
}

static void enter_initialization_mode(Slot *s) {
    double start = random_real(), stop = one_in(2) ? random_real() : start + 1e4 * share();
    bool ends = one_in(4), is_valid = is_in(s, INSTANTIATED) && isfinite(start) && (!ends || stop >= start);
    Answer status = fmi3EnterInitializationMode(start_call(s), one_in(2), random_real(), start, ends, stop);
    if (check_call(s, EnterInitializationMode, status, status_if(is_valid), true)) return;
    s->expected.mode = INITIALIZING;
    s->expected.time = start;
    s->expected.stop = ends ? stop : INFINITY;
}

/* --- values --- */

static Value of_enumeration(int64_t x) { return (Value){.integer = x}; }
static int64_t random_choice(void) { return one_in(20) ? (int64_t)random_bits() : random_integer(); }
GET_AND_SET(Enumeration, enumeration, int64_t, ENUMERATION, random_choice())

/* There are as many values as references, or the call fails. */
static void miscount(Slot *s) {
    size_t n = below(MOST), m = n + 1 + below(3);
    Reference *r = random_references(n, REAL, true);
    double *values = allocate_exactly(m, sizeof *values);
    int32_t *orders = random_orders(n);
    for (size_t i = 0; values && i < m; i++) values[i] = 1.0;
    switch (below(3)) {
    case 0: check_call(s, GetReal, fmi3GetFloat64(start_call(s), r, n, values, m), ERROR, false); break;
    case 1: check_call(s, SetReal, fmi3SetFloat64(start_call(s), r, m, values, n), ERROR, false); break;
    default:
        check_call(s, GetRealOutputDerivatives, fmi3GetOutputDerivatives(start_call(s), r, n, orders, values, m), ERROR,
                  false);
    }
    free(r), free(orders), free(values);
}

/* Types that no variable has. */
#define NONE(Type)                                                                                                     \
    static void none_##Type(Slot *s) {                                                                                 \
        size_t n = one_in(2) ? 0 : random_count();                                                                     \
        Reference *r = allocate_exactly(n, sizeof *r);                                                                 \
        for (size_t i = 0; r && i < n; i++) r[i] = (Reference)below(COUNT + 3);                                        \
        fmi3##Type *values = allocate_exactly(n, sizeof *values);                                                      \
        int getting_none = status_if(is_in(s, INITIALIZING | STEPPING | TERMINATED) && !n);                            \
        int setting_none = status_if(is_in(s, INSTANTIATED | INITIALIZING | STEPPING) && !n);                          \
        if (one_in(2)) check_call(s, Get##Type, fmi3Get##Type(start_call(s), r, n, values REST), getting_none, false); \
        else check_call(s, Set##Type, fmi3Set##Type(start_call(s), r, n, values REST), setting_none, false);           \
        free(r), free(values);                                                                                         \
    }
#define REST , n
NONE(Float32) NONE(Int8) NONE(UInt8) NONE(Int16) NONE(UInt16) NONE(UInt32) NONE(UInt64)
#undef REST
#define REST
NONE(Clock)

static void none_Binary(Slot *s) {
    Reference r[] = {(Reference)below(COUNT + 3)};
    size_t n = below(2), sizes[] = {0};
    fmi3Binary values[] = {NULL};
    int getting_none = status_if(is_in(s, INITIALIZING | STEPPING | TERMINATED) && !n);
    int setting_none = status_if(is_in(s, INSTANTIATED | INITIALIZING | STEPPING) && !n);
    if (one_in(2)) check_call(s, GetBinary, fmi3GetBinary(start_call(s), r, n, sizes, values, n), getting_none, false);
    else check_call(s, SetBinary, fmi3SetBinary(start_call(s), r, n, sizes, values, n), setting_none, false);
}

static void (*const NONE_OF[])(Slot *) = {none_Float32, none_Int8, none_UInt8, none_Int16,
                                          none_UInt16, none_UInt32, none_UInt64, none_Clock, none_Binary};
static void none(Slot *s) { NONE_OF[below(sizeof NONE_OF / sizeof *NONE_OF)](s); }

/* --- these functions exist, but refuse every call --- */

static void refused_call(Slot *s) {
    double x[COUNT];
    fmi3Boolean flags[5];
    fmi3IntervalQualifier qualifiers[COUNT];
    uint64_t counts_of[COUNT], resolutions[COUNT];
    Reference r[COUNT] = {0};
    size_t n = below(COUNT), count, *number = passes_null() ? NULL : &count;
    double *destination = passes_null() ? NULL : x;
#define REFUSED(function, ...) \
    case function: check_call(s, function, fmi3##function(start_call(s), ##__VA_ARGS__), ERROR, false); break
    switch (GetNumberOfVariableDependencies + below(FUNCTION_COUNT - GetNumberOfVariableDependencies)) {
        REFUSED(GetNumberOfVariableDependencies, r[0], number);
        REFUSED(GetVariableDependencies, r[0], NULL, r, NULL, NULL, n);
        REFUSED(GetDirectionalDerivative, r, n, r, n, x, n, destination, n);
        REFUSED(GetAdjointDerivative, r, n, r, n, x, n, destination, n);
        REFUSED(EnterConfigurationMode);
        REFUSED(ExitConfigurationMode);
        REFUSED(EnterEventMode);
        REFUSED(EnterStepMode);
        REFUSED(GetIntervalDecimal, r, n, destination, qualifiers);
        REFUSED(GetIntervalFraction, r, n, counts_of, resolutions, qualifiers);
        REFUSED(GetShiftDecimal, r, n, destination);
        REFUSED(GetShiftFraction, r, n, counts_of, resolutions);
        REFUSED(SetIntervalDecimal, r, n, destination);
        REFUSED(SetIntervalFraction, r, n, counts_of, resolutions);
        REFUSED(SetShiftDecimal, r, n, destination);
        REFUSED(SetShiftFraction, r, n, counts_of, resolutions);
        REFUSED(EvaluateDiscreteStates);
        REFUSED(UpdateDiscreteStates, flags, flags + 1, flags + 2, flags + 3, flags + 4, destination);
        REFUSED(EnterContinuousTimeMode);
        REFUSED(CompletedIntegratorStep, one_in(2), flags, flags + 1);
        REFUSED(SetTime, random_real());
        REFUSED(SetContinuousStates, NULL, n);
        REFUSED(GetContinuousStateDerivatives, destination, n);
        REFUSED(GetEventIndicators, destination, n);
        REFUSED(GetContinuousStates, destination, n);
        REFUSED(GetNominalsOfContinuousStates, destination, n);
        REFUSED(GetNumberOfEventIndicators, number);
        REFUSED(GetNumberOfContinuousStates, number);
        REFUSED(ActivateModelPartition, r[0], random_real());
    }
}

/* --- the actions --- */

static const Action *all_actions(void) {
    static const Action ACTIONS[] = {ACTIONS_OF_ALL_VERSIONS, {12, get_enumeration}, {12, set_enumeration}, {4, miscount},
                               {30, none},           {50, refused_call},    {0, NULL}};
    return ACTIONS;
}
