/* FMI 2.0 for co-simulation, over the instance's core: the standard's names and types, and when each function may be
 * called. */
#include <math.h>
#include "fmi2Functions.h"

typedef fmi2Status FmiStatus;
typedef fmi2CallbackLogger Logger;
typedef fmi2ComponentEnvironment Environment;
#define DISCARD_CATEGORY "logStatusError"
#define CATEGORIES "logStatusWarning, logStatusError, logAll"
#include "fmi.h"

MUST_HOLD(the_statuses_of_the_core_are_those_of_fmi,
          (int)STATUS_WARNING == fmi2Warning && (int)STATUS_DISCARD == fmi2Discard && (int)STATUS_ERROR == fmi2Error);

static void pass_to_importer(const void *importer, Status status, const char *text) {
    const Importer *to = importer;
    to->logger(to->environment, to->name, (fmi2Status)status, category_name(status - STATUS_WARNING), text);
}

/* --- life --- */

/* Whether logging is on makes no difference: there are only warnings and errors, which no user should miss. */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    if (!callbacks) return NULL;
    const char *error = type == fmi2CoSimulation ? NULL : "the unit is for co-simulation only";
    Memory memory = system_memory();
#ifndef OWN_MEMORY /* the libraries in an FMU define it, since some importers' functions cut addresses to 32 bits */
    if (callbacks->allocateMemory && callbacks->freeMemory)
        memory = (Memory){callbacks->allocateMemory, callbacks->freeMemory};
#endif
    return instantiate(name, guid, memory, callbacks->logger, callbacks->componentEnvironment, STATUS_ERROR, error,
                       __func__);
}

void fmi2FreeInstance(fmi2Component c) { instance_free(c); }

fmi2Status fmi2Reset(fmi2Component c) {
    REQUIRE_MODE(ANY);
    instance_reset(c);
    return fmi2OK;
}

/* With a list of categories only these are logged; with an empty list, or with logging off, all. */
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    int logged;
    REQUIRE_MODE(ANY);
    if (find_categories(c, n, categories, &logged, __func__)) return fmi2Error;
    instance_set_categories(c, on ? logged : LOG_ALL);
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    REQUIRE_MODE(INSTANTIATED);
    RETURN_STATUS(instance_set_times(c, start, stopDefined ? stop : INFINITY, __func__));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    REQUIRE_MODE(INSTANTIATED);
    instance_enter_initialization(c);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    REQUIRE_MODE(INITIALIZING);
    RETURN_STATUS(instance_exit_initialization(c));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    RETURN_STATUS(instance_step(c, time, h, __func__));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    if (!c) return fmi2Error;
    RETURN_STATUS(instance_report(c, STATUS_ERROR, "%s is not allowed now: no step is under way", __func__));
}

fmi2Status fmi2Terminate(fmi2Component c) {
    REQUIRE_MODE(STEPPING);
    instance_terminate(c);
    return fmi2OK;
}

/* --- values --- */

#define ACCESS(Type, name, ...)                                                                                        \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type values[]) {           \
        RETURN_STATUS(instance_get_##name(c, READABLE, __VA_ARGS__ r, n, values, __func__));                           \
    }                                                                                                                  \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type values[]) {     \
        RETURN_STATUS(instance_set_##name(c, SETTABLE, __VA_ARGS__ r, n, values, __func__));                           \
    }
ACCESS(Real, reals, )
ACCESS(Integer, integers, INTEGER | ENUMERATION, )
ACCESS(Boolean, booleans, )

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    RETURN_STATUS(refuse_type(c, "String", READABLE, r, n, __func__));
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    RETURN_STATUS(refuse_type(c, "String", SETTABLE, r, n, __func__));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer orders[], const fmi2Real values[]) {
    RETURN_STATUS(instance_set_input_derivatives(c, SETTABLE, r, n, orders, values, __func__));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer orders[], fmi2Real values[]) {
    RETURN_STATUS(instance_get_output_derivatives(c, STEPPED, r, n, orders, values, __func__));
}

/* --- FMU states --- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    RETURN_STATUS(instance_save(c, s, __func__));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    RETURN_STATUS(instance_restore(c, s, __func__));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    RETURN_STATUS(instance_free_state(c, s, __func__));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    RETURN_STATUS(instance_serialized_size(c, s, n, __func__));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t n) {
    RETURN_STATUS(instance_serialize(c, s, (uint8_t *)bytes, n, __func__));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t n, fmi2FMUstate *s) {
    RETURN_STATUS(instance_deserialize(c, (const uint8_t *)bytes, n, s, __func__));
}

/* --- status: every step ends within its call --- */

static Status check_status_call(const Instance *c, const void *value, bool available, const char *call) {
    if (!instance_check_mode(c, STEPPED, call) || !instance_check_pointer(c, value, call)) return STATUS_ERROR;
    return available ? STATUS_OK
                     : instance_report(c, STATUS_DISCARD, "this status is not available: no step is pending");
}

#define NEVER_AVAILABLE(Type, function)                                                  \
    fmi2Status function(fmi2Component c, const fmi2StatusKind kind, Type *value) {       \
        RETURN_STATUS(check_status_call(c, value, false, __func__));                     \
    }
NEVER_AVAILABLE(fmi2Status, fmi2GetStatus)
NEVER_AVAILABLE(fmi2Integer, fmi2GetIntegerStatus)
NEVER_AVAILABLE(fmi2String, fmi2GetStringStatus)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Status status = check_status_call(c, value, kind == fmi2LastSuccessfulTime, __func__);
    if (!status) *value = instance_time(c);
    RETURN_STATUS(status);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    Status status = check_status_call(c, value, kind == fmi2Terminated, __func__);
    if (!status) *value = instance_mode(c) == TERMINATED;
    RETURN_STATUS(status);
}

/* --- not offered; functions of model exchange exist since some importers require all functions of the standard --- */

#define NOT_OFFERED(function, ...) \
    fmi2Status function(__VA_ARGS__) { RETURN_STATUS(refuse_call(c, __func__)); }
NOT_OFFERED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference unknown[], size_t nUnknown,
            const fmi2ValueReference knowns[], size_t nKnown, const fmi2Real dKnown[], fmi2Real dUnknown[])
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
