/* Runs of a unit that is linked into the program, without a C library: carries out the calls in run.h, and answers a hash
 * of the bits of all variables after each initialization and each step; 0 if a call fails, or if the unit asks for memory
 * but once.
 *
 * REPLAY is the name of this function. run.h, which is generated, has
 *   GUID, KINDS        texts; of KINDS one letter a variable: R, I or B
 *   struct call CALLS  what is done: n: start a run; R, I, B: set a variable; x: leave the initialization mode; s: step */
#include <stddef.h>
#include <stdint.h>
#include "fmi2Functions.h"

struct call {
    char what;
    unsigned variable;
    uint64_t bits; /* of a Real, or of the step size; an Integer or Boolean */
};
#include "run.h"

static union {
    double aligned;
    unsigned char bytes[1 << 14];
} memory;
static int given;

static void *allocate(size_t n, size_t size) {
    unsigned char *p = memory.bytes;
    if (given++ || n * size > sizeof memory) return NULL;
    for (size_t i = 0; i < n * size; i++) p[i] = 0;
    return p;
}

static void release(void *p) { given -= p == memory.bytes; }

#ifdef BARE
#include "instance.h"
Memory system_memory(void) { return (Memory){allocate, release}; } /* in place of memory.c */
#endif

static double real(uint64_t bits) {
    union {
        uint64_t bits;
        double x;
    } both = {bits};
    return both.x;
}

static uint64_t mixed(uint64_t hash, uint64_t bits) {
    hash = (hash ^ bits) * 1099511628211u;
    return hash ^ hash >> 32;
}

static uint64_t with_all_values(fmi2Component unit, uint64_t hash) {
    for (fmi2ValueReference r = 0; KINDS[r]; r++) {
        union {
            double x;
            uint64_t bits;
        } value = {0.0};
        fmi2Integer n = 0;
        if (KINDS[r] == 'R') fmi2GetReal(unit, &r, 1, &value.x);
        else if (KINDS[r] == 'I') fmi2GetInteger(unit, &r, 1, &n);
        else fmi2GetBoolean(unit, &r, 1, &n);
        hash = mixed(hash, KINDS[r] == 'R' ? value.bits : (uint32_t)n);
    }
    return hash;
}

uint64_t REPLAY(void);

uint64_t REPLAY(void) {
    const fmi2CallbackFunctions callbacks = {NULL, allocate, release, NULL, NULL};
    uint64_t hash = 14695981039346656037u;
    fmi2Component unit =
        fmi2Instantiate("unit", fmi2CoSimulation, GUID, "file:///", &callbacks, fmi2False, fmi2False);
    double time = 0.0;
    for (size_t i = 0; i < sizeof CALLS / sizeof *CALLS; i++) {
        const fmi2ValueReference r = CALLS[i].variable;
        const fmi2Real x = real(CALLS[i].bits);
        const fmi2Integer n = (fmi2Integer)CALLS[i].bits;
        fmi2Status status = fmi2OK;
        switch (CALLS[i].what) {
        case 'n':
            time = 0.0;
            if (fmi2Reset(unit) || fmi2SetupExperiment(unit, fmi2False, 0.0, 0.0, fmi2False, 0.0)) return 0;
            status = fmi2EnterInitializationMode(unit);
            break;
        case 'R': status = fmi2SetReal(unit, &r, 1, &x); break;
        case 'I': status = fmi2SetInteger(unit, &r, 1, &n); break;
        case 'B': status = fmi2SetBoolean(unit, &r, 1, &n); break;
        case 'x': status = fmi2ExitInitializationMode(unit); break;
        default:
            status = fmi2DoStep(unit, time, x, fmi2True);
            time += x;
        }
        if (status) return 0;
        if (CALLS[i].what == 'x' || CALLS[i].what == 's') hash = with_all_values(unit, hash);
    }
    int all = given;
    fmi2FreeInstance(unit);
    return all == 1 && !given ? hash : 0;
}
