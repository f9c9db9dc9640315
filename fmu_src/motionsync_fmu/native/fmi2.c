/* FMI 2.0 for co-simulation, over the unit's core: the standard's names and types, and what may be called when. */
#include <math.h>
#include <string.h>
#include "fmi2Functions.h"
#include "cold.h"
#include "unit.h"

_Static_assert((int)UNIT_WARNING == fmi2Warning && (int)UNIT_DISCARD == fmi2Discard && (int)UNIT_ERROR == fmi2Error,
               "the core's statuses are FMI's");

typedef struct { /* what this file keeps with each unit */
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[];
} Importer;

COLD static void log_to(const void *importer, Status status, const char *text) {
    const Importer *to = importer;
    const char *category = status == UNIT_WARNING ? "logStatusWarning" : "logStatusError";
    to->logger(to->environment, to->name, (fmi2Status)status, category, text);
}

enum { SETTABLE = INSTANTIATED | INITIALIZING | STEPPING, READABLE = INITIALIZING | STEPPING | TERMINATED };

/* The function ends with an error unless the unit is in one of these modes. */
#define ONLY_WHEN(modes) \
    if (!unit_may(c, modes, __func__)) return fmi2Error

/* The function ends with the status of this call of the core. */
#define ANSWER(status) return (fmi2Status)(status)

/* --- life --- */

/* Whether logging is on makes no difference: there are only warnings and errors, and nobody should miss these. */

COLD const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
COLD const char *fmi2GetVersion(void) { return fmi2Version; }

COLD fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    if (!callbacks) return NULL;
    const char *called = name ? name : "";
    Memory memory = {callbacks->allocateMemory, callbacks->freeMemory};
    if (!memory.allocate || !memory.release) memory = system_memory();
    Unit *c = unit_new(sizeof(Importer) + strlen(called) + 1, memory, callbacks->logger ? log_to : NULL);
    if (!c) return NULL;
    Importer *importer = unit_importer(c);
    importer->logger = callbacks->logger;
    importer->environment = callbacks->componentEnvironment;
    memcpy(importer->name, called, strlen(called) + 1);
    if (!*called) unit_fail(c, "%s: the instance needs a name", __func__);
    else if (type != fmi2CoSimulation) unit_fail(c, "%s: the unit is for co-simulation only", __func__);
    else if (!guid || strcmp(guid, unit_guid()))
        unit_fail(c, "%s: the GUID is not that of this unit, %s", __func__, unit_guid());
    else {
        unit_reset(c);
        return c;
    }
    unit_free(c);
    return NULL;
}

COLD void fmi2FreeInstance(fmi2Component c) { unit_free(c); }

COLD fmi2Status fmi2Reset(fmi2Component c) {
    ONLY_WHEN(ANY);
    unit_reset(c);
    return fmi2OK;
}

/* With a list of categories only these are logged; with an empty list, or with logging off, all. */
COLD fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    static const struct { const char *name; Category category; } KNOWN[] = {
        {"logStatusWarning", LOG_WARNING}, {"logStatusError", LOG_ERROR}, {"logAll", LOG_ALL}};
    int chosen = n ? LOG_NOTHING : LOG_ALL;
    ONLY_WHEN(ANY);
    if (n && !unit_given(c, categories, __func__)) return fmi2Error;
    for (size_t i = 0; i < n; i++) {
        int found = LOG_NOTHING;
        for (int k = 0; k < 3; k++)
            if (categories[i] && !strcmp(categories[i], KNOWN[k].name)) found = KNOWN[k].category;
        if (!found) ANSWER(unit_fail(c, "%s: the categories are logStatusWarning, logStatusError, logAll", __func__));
        chosen |= found;
    }
    unit_log(c, on ? chosen : LOG_ALL);
    return fmi2OK;
}

COLD fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    ONLY_WHEN(INSTANTIATED);
    ANSWER(unit_set_times(c, start, stopDefined ? stop : INFINITY, __func__));
}

COLD fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ONLY_WHEN(INSTANTIATED);
    unit_enter_initialization(c);
    return fmi2OK;
}

COLD fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ONLY_WHEN(INITIALIZING);
    ANSWER(unit_exit_initialization(c));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    ANSWER(unit_step(c, time, h, __func__));
}

COLD fmi2Status fmi2CancelStep(fmi2Component c) {
    if (!c) return fmi2Error;
    ANSWER(unit_fail(c, "%s is not allowed now: no step is under way", __func__));
}

COLD fmi2Status fmi2Terminate(fmi2Component c) {
    ONLY_WHEN(STEPPING);
    unit_terminate(c);
    return fmi2OK;
}

/* --- values --- */

#define ACCESS(Type, name)                                                                                         \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type values[]) {       \
        ANSWER(unit_get_##name(c, READABLE, r, n, values, __func__));                                              \
    }                                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type values[]) { \
        ANSWER(unit_set_##name(c, SETTABLE, r, n, values, __func__));                                              \
    }
ACCESS(Real, reals)
ACCESS(Integer, integers)
ACCESS(Boolean, booleans)

COLD static fmi2Status no_string(const Unit *c, const fmi2ValueReference r[], size_t n) {
    if (n) unit_fail(c, "no String has the value reference %d", (int64_t)(r ? *r : 0));
    return n ? fmi2Error : fmi2OK;
}

COLD fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String values[]) {
    ONLY_WHEN(READABLE);
    return no_string(c, r, n);
}

COLD fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String values[]) {
    ONLY_WHEN(SETTABLE);
    return no_string(c, r, n);
}

COLD fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer orders[], const fmi2Real values[]) {
    ONLY_WHEN(SETTABLE);
    ANSWER(unit_set_input_derivatives(c, r, n, orders, values, __func__));
}

COLD fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer orders[], fmi2Real values[]) {
    ONLY_WHEN(STEPPING | TERMINATED);
    ANSWER(unit_get_output_derivatives(c, r, n, orders, values, __func__));
}

/* --- FMU states --- */

COLD fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    ONLY_WHEN(ANY);
    ANSWER(unit_save(c, s, __func__));
}

COLD fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) {
    ONLY_WHEN(ANY);
    ANSWER(unit_restore(c, s, __func__));
}

COLD fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    ONLY_WHEN(ANY);
    ANSWER(unit_free_state(c, s, __func__));
}

COLD fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    ONLY_WHEN(ANY);
    ANSWER(unit_serialized_size(c, s, n, __func__));
}

COLD fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t n) {
    ONLY_WHEN(ANY);
    ANSWER(unit_serialize(c, s, (uint8_t *)bytes, n, __func__));
}

COLD fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t n, fmi2FMUstate *s) {
    ONLY_WHEN(ANY);
    ANSWER(unit_deserialize(c, (const uint8_t *)bytes, n, s, __func__));
}

/* --- status: every step ends within its call --- */

COLD static fmi2Status unknown(const Unit *c, const void *value, const char *call) {
    if (!unit_given(c, value, call)) return fmi2Error;
    unit_say(c, UNIT_DISCARD, "this status is not known: no step is pending");
    return fmi2Discard;
}

COLD fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    ONLY_WHEN(STEPPING | TERMINATED);
    return unknown(c, value, __func__);
}

COLD fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    ONLY_WHEN(STEPPING | TERMINATED);
    return unknown(c, value, __func__);
}

COLD fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    ONLY_WHEN(STEPPING | TERMINATED);
    return unknown(c, value, __func__);
}

COLD fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    ONLY_WHEN(STEPPING | TERMINATED);
    if (kind != fmi2LastSuccessfulTime) return unknown(c, value, __func__);
    if (!unit_given(c, value, __func__)) return fmi2Error;
    *value = unit_time(c);
    return fmi2OK;
}

COLD fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    ONLY_WHEN(STEPPING | TERMINATED);
    if (kind != fmi2Terminated) return unknown(c, value, __func__);
    if (!unit_given(c, value, __func__)) return fmi2Error;
    *value = unit_mode(c) == TERMINATED;
    return fmi2OK;
}

/* --- not offered; functions of model exchange exist since some importers look for all functions of the standard --- */

#define NOT_OFFERED(function, ...)                                                         \
    COLD fmi2Status function(__VA_ARGS__) {                                                \
        if (c) unit_fail(c, #function " is not offered by this co-simulation unit");       \
        return fmi2Error;                                                                  \
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
