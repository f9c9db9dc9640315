/* FMI 2.0 for co-simulation, over the unit's core: the standard's names and types, and what may be called when. */
#include <math.h>
#include "fmi2Functions.h"

typedef fmi2Status Answer;
typedef fmi2CallbackLogger Logger;
typedef fmi2ComponentEnvironment Environment;
#define DISCARDED "logStatusError"
#define CATEGORIES "logStatusWarning, logStatusError, logAll"
#include "fmi.h"

MUST_HOLD(the_statuses_of_the_core_are_those_of_fmi,
          (int)UNIT_WARNING == fmi2Warning && (int)UNIT_DISCARD == fmi2Discard && (int)UNIT_ERROR == fmi2Error);

static void log_to(const void *importer, Status status, const char *text) {
    const Importer *to = importer;
    to->logger(to->environment, to->name, (fmi2Status)status, category(status - UNIT_WARNING), text);
}

/* --- life --- */

/* Whether logging is on makes no difference: there are only warnings and errors, and nobody should miss these. */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    if (!callbacks) return NULL;
    const char *wrong = type == fmi2CoSimulation ? NULL : "the unit is for co-simulation only";
    Memory memory = system_memory();
#ifndef OWN_MEMORY /* the libraries in an FMU define it, since some importers' functions cut addresses to 32 bits */
    if (callbacks->allocateMemory && callbacks->freeMemory)
        memory = (Memory){callbacks->allocateMemory, callbacks->freeMemory};
#endif
    return instantiate(name, guid, memory, callbacks->logger, callbacks->componentEnvironment, UNIT_ERROR, wrong,
                       __func__);
}

void fmi2FreeInstance(fmi2Component c) { unit_free(c); }

fmi2Status fmi2Reset(fmi2Component c) {
    ONLY_WHEN(ANY);
    unit_reset(c);
    return fmi2OK;
}

/* With a list of categories only these are logged; with an empty list, or with logging off, all. */
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    int found;
    ONLY_WHEN(ANY);
    if (find_categories(c, n, categories, &found, __func__)) return fmi2Error;
    unit_log(c, on ? found : LOG_ALL);
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    ONLY_WHEN(INSTANTIATED);
    ANSWER(unit_set_times(c, start, stopDefined ? stop : INFINITY, __func__));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ONLY_WHEN(INSTANTIATED);
    unit_enter_initialization(c);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ONLY_WHEN(INITIALIZING);
    ANSWER(unit_exit_initialization(c));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    ANSWER(unit_step(c, time, h, __func__));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    if (!c) return fmi2Error;
    ANSWER(unit_say(c, UNIT_ERROR, "%s is not allowed now: no step is under way", __func__));
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ONLY_WHEN(STEPPING);
    unit_terminate(c);
    return fmi2OK;
}

/* --- values --- */

#define ACCESS(Type, name, ...)                                                                                    \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type values[]) {       \
        ANSWER(unit_get_##name(c, READABLE, __VA_ARGS__ r, n, values, __func__));                                  \
    }                                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type values[]) { \
        ANSWER(unit_set_##name(c, SETTABLE, __VA_ARGS__ r, n, values, __func__));                                  \
    }
ACCESS(Real, reals, )
ACCESS(Integer, integers, INTEGER | ENUMERATION, )
ACCESS(Boolean, booleans, )

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    ANSWER(none_of(c, "String", READABLE, r, n, __func__));
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    ANSWER(none_of(c, "String", SETTABLE, r, n, __func__));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer orders[], const fmi2Real values[]) {
    ANSWER(unit_set_input_derivatives(c, SETTABLE, r, n, orders, values, __func__));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer orders[], fmi2Real values[]) {
    ANSWER(unit_get_output_derivatives(c, STEPPED, r, n, orders, values, __func__));
}

/* --- FMU states --- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    ANSWER(unit_save(c, s, __func__));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    ANSWER(unit_restore(c, s, __func__));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    ANSWER(unit_free_state(c, s, __func__));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    ANSWER(unit_serialized_size(c, s, n, __func__));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t n) {
    ANSWER(unit_serialize(c, s, (uint8_t *)bytes, n, __func__));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t n, fmi2FMUstate *s) {
    ANSWER(unit_deserialize(c, (const uint8_t *)bytes, n, s, __func__));
}

/* --- status: every step ends within its call --- */

static Status ask(const Unit *c, const void *value, bool known, const char *call) {
    if (!unit_may(c, STEPPED, call) || !unit_given(c, value, call)) return UNIT_ERROR;
    return known ? UNIT_OK : unit_say(c, UNIT_DISCARD, "this status is not known: no step is pending");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    ANSWER(ask(c, value, false, __func__));
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    ANSWER(ask(c, value, false, __func__));
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    ANSWER(ask(c, value, false, __func__));
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Status status = ask(c, value, kind == fmi2LastSuccessfulTime, __func__);
    if (!status) *value = unit_time(c);
    ANSWER(status);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    Status status = ask(c, value, kind == fmi2Terminated, __func__);
    if (!status) *value = unit_mode(c) == TERMINATED;
    ANSWER(status);
}

/* --- not offered; functions of model exchange exist since some importers look for all functions of the standard --- */

#define NOT_OFFERED(function, ...) \
    fmi2Status function(__VA_ARGS__) { ANSWER(not_offered(c, __func__)); }
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
