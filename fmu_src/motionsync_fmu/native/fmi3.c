/* FMI 3.0 for co-simulation, over the instance's core: the standard's names and types, and when each function may be
 * called.
 *
 * There is no event mode, no intermediate update and no early return: a command is an edge at the start of a step, and
 * a step is computed to its end at once. A step that is refused has changed nothing, which this standard calls
 * discarded. */
#include <math.h>
#include "fmi3Functions.h"

typedef fmi3Status FmiStatus;
typedef fmi3LogMessageCallback Logger;
typedef fmi3InstanceEnvironment Environment;
#define DISCARD_CATEGORY "logStatusDiscard"
#define CATEGORIES "logStatusWarning, logStatusDiscard, logStatusError, logAll"
#include "fmi.h"

MUST_HOLD(the_statuses_of_the_core_are_those_of_fmi,
          (int)STATUS_WARNING == fmi3Warning && (int)STATUS_DISCARD == fmi3Discard && (int)STATUS_ERROR == fmi3Error);

static void pass_to_importer(const void *importer, Status status, const char *text) {
    const Importer *to = importer;
    if (to->logger) to->logger(to->environment, (fmi3Status)status, category_name(status - STATUS_WARNING), text);
}

/* --- life --- */

const char *fmi3GetVersion(void) { return fmi3Version; }

/* Which messages are logged: errors always, warnings and discarded steps if the importer switches them on. */
static void set_logging(Instance *c, bool on, int categories) {
    instance_set_categories(c, on ? categories | LOG_ERROR : LOG_ERROR);
}

static Instance *create_instance(fmi3String name, fmi3String token, bool logging, fmi3InstanceEnvironment environment,
                         fmi3LogMessageCallback logger, const char *error, const char *call) {
    Instance *c = instantiate(name, token, system_memory(), logger, environment, STATUS_DISCARD, error, call);
    if (c) set_logging(c, logging, LOG_ALL);
    return c;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference intermediate[], size_t nIntermediate,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update) {
    const char *error = eventModeUsed ? "the unit has no event mode" : NULL;
    return create_instance(name, token, logging, environment, logger, error, __func__);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger) {
    return create_instance(name, token, logging, environment, logger, "the unit is for co-simulation only", __func__);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
    return create_instance(name, token, logging, environment, logger, "the unit is for co-simulation only", __func__);
}

void fmi3FreeInstance(fmi3Instance c) { instance_free(c); }

fmi3Status fmi3Reset(fmi3Instance c) {
    REQUIRE_MODE(ANY);
    instance_reset(c);
    return fmi3OK;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    int logged;
    REQUIRE_MODE(ANY);
    if (find_categories(c, n, categories, &logged, __func__)) return fmi3Error;
    set_logging(c, on, logged);
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stopDefined, fmi3Float64 stop) {
    REQUIRE_MODE(INSTANTIATED);
    if (instance_set_times(c, start, stopDefined ? stop : INFINITY, __func__)) return fmi3Error;
    instance_enter_initialization(c);
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    REQUIRE_MODE(INITIALIZING);
    RETURN_STATUS(instance_exit_initialization(c));
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 h, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *event, fmi3Boolean *ended, fmi3Boolean *early, fmi3Float64 *reached) {
    Status status = instance_step(c, time, h, __func__);
    if (event) *event = false;
    if (ended) *ended = false;
    if (early) *early = false;
    if (reached && c) *reached = instance_time(c);
    RETURN_STATUS(status);
}

fmi3Status fmi3Terminate(fmi3Instance c) {
    REQUIRE_MODE(STEPPING);
    instance_terminate(c);
    return fmi3OK;
}

/* --- values: no variable is an array, so that there are as many values as references --- */

static bool counts_agree(const Instance *c, size_t references, size_t values, const char *call) {
    if (c && references != values)
        instance_report(c, STATUS_ERROR, "%s: there must be as many values as value references", call);
    return references == values;
}

#define GET(Type)                                                                                                      \
    fmi3Status fmi3Get##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##Type values[], size_t m)
#define SET(Type)                                                                                                      \
    fmi3Status fmi3Set##Type(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##Type values[],        \
                             size_t m)

#define ACCESS(Type, name, ...)                                                                                        \
    GET(Type) {                                                                                                        \
        if (!counts_agree(c, n, m, __func__)) return fmi3Error;                                                        \
        RETURN_STATUS(instance_get_##name(c, READABLE, __VA_ARGS__ r, n, values, __func__));                           \
    }                                                                                                                  \
    SET(Type) {                                                                                                        \
        if (!counts_agree(c, n, m, __func__)) return fmi3Error;                                                        \
        RETURN_STATUS(instance_set_##name(c, SETTABLE, __VA_ARGS__ r, n, values, __func__));                           \
    }
ACCESS(Float64, reals, )
ACCESS(Int32, integers, INTEGER, )
ACCESS(Int64, enumerations, )
ACCESS(Boolean, flags, )

#define NONE(Type)                                                                                                     \
    GET(Type) { RETURN_STATUS(refuse_type(c, #Type, READABLE, r, n, __func__)); }                                      \
    SET(Type) { RETURN_STATUS(refuse_type(c, #Type, SETTABLE, r, n, __func__)); }
NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(UInt32)
NONE(UInt64)
NONE(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary values[],
                         size_t m) {
    RETURN_STATUS(refuse_type(c, "Binary", READABLE, r, n, __func__));
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t sizes[],
                         const fmi3Binary values[], size_t m) {
    RETURN_STATUS(refuse_type(c, "Binary", SETTABLE, r, n, __func__));
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Clock values[]) {
    RETURN_STATUS(refuse_type(c, "Clock", READABLE, r, n, __func__));
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Clock values[]) {
    RETURN_STATUS(refuse_type(c, "Clock", SETTABLE, r, n, __func__));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 values[], size_t m) {
    if (!counts_agree(c, n, m, __func__)) return fmi3Error;
    RETURN_STATUS(instance_get_output_derivatives(c, STEPPED, r, n, orders, values, __func__));
}

/* --- FMU states --- */

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    RETURN_STATUS(instance_save(c, s, __func__));
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) {
    RETURN_STATUS(instance_restore(c, s, __func__));
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) {
    RETURN_STATUS(instance_free_state(c, s, __func__));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n) {
    RETURN_STATUS(instance_serialized_size(c, s, n, __func__));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState s, fmi3Byte bytes[], size_t n) {
    RETURN_STATUS(instance_serialize(c, s, bytes, n, __func__));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t n, fmi3FMUState *s) {
    RETURN_STATUS(instance_deserialize(c, bytes, n, s, __func__));
}

/* --- not offered; all functions of the standard have to be there --- */

#define NOT_OFFERED(function, ...) \
    fmi3Status function(__VA_ARGS__) { RETURN_STATUS(refuse_call(c, __func__)); }
NOT_OFFERED(fmi3GetNumberOfVariableDependencies, fmi3Instance c, fmi3ValueReference r, size_t *n)
NOT_OFFERED(fmi3GetVariableDependencies, fmi3Instance c, fmi3ValueReference r, size_t elements[],
            fmi3ValueReference independents[], size_t elementsOfIndependents[], fmi3DependencyKind kinds[], size_t n)
NOT_OFFERED(fmi3GetDirectionalDerivative, fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
            const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
            fmi3Float64 sensitivity[], size_t nSensitivity)
NOT_OFFERED(fmi3GetAdjointDerivative, fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns,
            const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
            fmi3Float64 sensitivity[], size_t nSensitivity)
NOT_OFFERED(fmi3EnterConfigurationMode, fmi3Instance c)
NOT_OFFERED(fmi3ExitConfigurationMode, fmi3Instance c)
NOT_OFFERED(fmi3EnterEventMode, fmi3Instance c)
NOT_OFFERED(fmi3EnterStepMode, fmi3Instance c)
NOT_OFFERED(fmi3GetIntervalDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 intervals[],
            fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetIntervalFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3UInt64 counters[],
            fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetShiftDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 shifts[])
NOT_OFFERED(fmi3GetShiftFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3UInt64 counters[],
            fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetIntervalDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n,
            const fmi3Float64 intervals[])
NOT_OFFERED(fmi3SetIntervalFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n,
            const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetShiftDecimal, fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 shifts[])
NOT_OFFERED(fmi3SetShiftFraction, fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3EvaluateDiscreteStates, fmi3Instance c)
NOT_OFFERED(fmi3UpdateDiscreteStates, fmi3Instance c, fmi3Boolean *needed, fmi3Boolean *ended, fmi3Boolean *nominals,
            fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
NOT_OFFERED(fmi3EnterContinuousTimeMode, fmi3Instance c)
NOT_OFFERED(fmi3CompletedIntegratorStep, fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
            fmi3Boolean *event, fmi3Boolean *ended)
NOT_OFFERED(fmi3SetTime, fmi3Instance c, fmi3Float64 time)
NOT_OFFERED(fmi3SetContinuousStates, fmi3Instance c, const fmi3Float64 x[], size_t n)
NOT_OFFERED(fmi3GetContinuousStateDerivatives, fmi3Instance c, fmi3Float64 x[], size_t n)
NOT_OFFERED(fmi3GetEventIndicators, fmi3Instance c, fmi3Float64 indicators[], size_t n)
NOT_OFFERED(fmi3GetContinuousStates, fmi3Instance c, fmi3Float64 x[], size_t n)
NOT_OFFERED(fmi3GetNominalsOfContinuousStates, fmi3Instance c, fmi3Float64 x[], size_t n)
NOT_OFFERED(fmi3GetNumberOfEventIndicators, fmi3Instance c, size_t *n)
NOT_OFFERED(fmi3GetNumberOfContinuousStates, fmi3Instance c, size_t *n)
NOT_OFFERED(fmi3ActivateModelPartition, fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
