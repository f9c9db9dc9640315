/* A do-nothing FMU: FMI 2.0's functions, which store nothing and answer OK.
 *
 * The cost of calling it is the cost of the interface: function calls through pointers, and arrays that are filled. */
#include <stddef.h>
#include "fmi2Functions.h"

static int instance, state; /* only their addresses are used */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
    return &instance;
}
void fmi2FreeInstance(fmi2Component c) {}
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    return fmi2OK;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stopDefined, fmi2Real stop) {
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component c) { return fmi2OK; }

#define ACCESS(Type)                                                                                               \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type values[]) {       \
        for (size_t i = 0; i < n; i++) values[i] = 0;                                                              \
        return fmi2OK;                                                                                             \
    }                                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type values[]) { \
        return fmi2OK;                                                                                             \
    }
ACCESS(Real)
ACCESS(Integer)
ACCESS(Boolean)
ACCESS(String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) {
    *s = &state;
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) { return fmi2OK; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) {
    *s = NULL;
    return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    *n = 0;
    return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte bytes[], size_t n) { return fmi2OK; }
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t n, fmi2FMUstate *s) {
    return fmi2GetFMUstate(c, s);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t nUnknown,
                                        const fmi2ValueReference knowns[], size_t nKnown, const fmi2Real dKnown[],
                                        fmi2Real dUnknown[]) {
    return fmi2OK;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[]) {
    return fmi2OK;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[]) {
    return fmi2GetReal(c, r, n, values);
}

#define STATUS(Name, Type)                                                                             \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2StatusKind kind, fmi2##Type *value) {          \
        *value = 0;                                                                                    \
        return fmi2OK;                                                                                 \
    }
STATUS(Status, Status)
STATUS(RealStatus, Real)
STATUS(IntegerStatus, Integer)
STATUS(BooleanStatus, Boolean)
STATUS(StringStatus, String)

fmi2Status fmi2EnterEventMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) { return fmi2OK; }
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
    return fmi2OK;
}
fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) { return fmi2OK; }
fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) { return fmi2OK; }

#define STATES(Name) \
    fmi2Status fmi2Get##Name(fmi2Component c, fmi2Real values[], size_t n) { return fmi2GetReal(c, NULL, n, values); }
STATES(Derivatives)
STATES(EventIndicators)
STATES(ContinuousStates)
STATES(NominalsOfContinuousStates)
