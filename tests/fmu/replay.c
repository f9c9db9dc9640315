/* A plain C host: carries out the calls that it reads, and writes what the unit answers, number by number.
 *
 * replay LIBRARY GUID KINDS: KINDS has one letter a variable: R, I, E or B. Lines on standard input:
 *   e        set up and enter initialization mode       x            exit initialization mode
 *   R r bits set the Real of value reference r          I, E, B r v  set an Integer, Enumeration or Boolean
 *   s t h    do a step (t and h as bits)                g            get all variables
 *   n        go on with a new instance
 * Numbers are written and read as the 16 hexadecimal digits of their bits. Each line is answered by one line: the
 * status, or for g all values. It is compiled for FMI 2.0, or with -DFMI=3 for FMI 3.0. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#endif

static void *library;

static void *need(const char *name) {
    void *function = FIND(library, name);
    if (function) return function;
    fprintf(stderr, "%s is missing\n", name);
    exit(2);
}

/* A function of the library, looked for at the first call from here. */
#define CALL(function)                                                                                                 \
    ({                                                                                                                 \
        static function##TYPE *address;                                                                                \
        if (!address) address = (function##TYPE *)need(#function);                                                     \
        address;                                                                                                       \
    })

/* --- the two versions --- */

#if FMI == 3
#include "fmi3FunctionTypes.h"
typedef fmi3Instance Unit;
typedef fmi3ValueReference Reference;
#define LIFE(function) CALL(fmi3##function)

static Unit make(const char *guid) {
    return CALL(fmi3InstantiateCoSimulation)("unit", guid, "/", false, false, false, false, NULL, 0, NULL, NULL, NULL);
}
static int enter(Unit unit) { return CALL(fmi3EnterInitializationMode)(unit, false, 0.0, 0.0, false, 0.0); }
static int step(Unit unit, double time, double h) {
    bool event, ended, early;
    double reached;
    return CALL(fmi3DoStep)(unit, time, h, true, &event, &ended, &early, &reached);
}
static double get_real(Unit unit, Reference r) {
    double x = 0.0;
    CALL(fmi3GetFloat64)(unit, &r, 1, &x, 1);
    return x;
}
static int get_number(Unit unit, char kind, Reference r) {
    int32_t integer = 0;
    int64_t choice = 0;
    bool flag = false;
    switch (kind) {
    case 'I': CALL(fmi3GetInt32)(unit, &r, 1, &integer, 1); return integer;
    case 'E': CALL(fmi3GetInt64)(unit, &r, 1, &choice, 1); return (int)choice;
    default: CALL(fmi3GetBoolean)(unit, &r, 1, &flag, 1); return flag;
    }
}
static int set_real(Unit unit, Reference r, double x) { return CALL(fmi3SetFloat64)(unit, &r, 1, &x, 1); }
static int set_number(Unit unit, char kind, Reference r, int n) {
    int64_t choice = n;
    bool flag = n;
    switch (kind) {
    case 'I': return CALL(fmi3SetInt32)(unit, &r, 1, &n, 1);
    case 'E': return CALL(fmi3SetInt64)(unit, &r, 1, &choice, 1);
    default: return CALL(fmi3SetBoolean)(unit, &r, 1, &flag, 1);
    }
}
#else
#include "fmi2FunctionTypes.h"
typedef fmi2Component Unit;
typedef fmi2ValueReference Reference;
#define LIFE(function) CALL(fmi2##function)

static Unit make(const char *guid) {
    static fmi2CallbackFunctions callbacks;
    return CALL(fmi2Instantiate)("unit", fmi2CoSimulation, guid, "file:///", &callbacks, fmi2False, fmi2False);
}
static int enter(Unit unit) {
    CALL(fmi2SetupExperiment)(unit, fmi2False, 0.0, 0.0, fmi2False, 0.0);
    return CALL(fmi2EnterInitializationMode)(unit);
}
static int step(Unit unit, double time, double h) { return CALL(fmi2DoStep)(unit, time, h, fmi2True); }
static double get_real(Unit unit, Reference r) {
    double x = 0.0;
    CALL(fmi2GetReal)(unit, &r, 1, &x);
    return x;
}
static int get_number(Unit unit, char kind, Reference r) {
    int n = 0;
    if (kind == 'B') CALL(fmi2GetBoolean)(unit, &r, 1, &n);
    else CALL(fmi2GetInteger)(unit, &r, 1, &n);
    return n;
}
static int set_real(Unit unit, Reference r, double x) { return CALL(fmi2SetReal)(unit, &r, 1, &x); }
static int set_number(Unit unit, char kind, Reference r, int n) {
    return kind == 'B' ? CALL(fmi2SetBoolean)(unit, &r, 1, &n) : CALL(fmi2SetInteger)(unit, &r, 1, &n);
}
#endif

/* --- the orders --- */

static double number(const char *bits) {
    uint64_t n = strtoull(bits, NULL, 16);
    double x;
    memcpy(&x, &n, sizeof x);
    return x;
}

static void show(Unit unit, const char *kinds) {
    for (Reference r = 0; kinds[r]; r++) {
        if (kinds[r] == 'R') {
            double x = get_real(unit, r);
            uint64_t bits;
            memcpy(&bits, &x, sizeof bits);
            printf("%016" PRIx64 " ", bits);
        } else {
            printf("%d ", get_number(unit, kinds[r], r));
        }
    }
    printf("\n");
}

int main(int count, char **arguments) {
    if (count != 4 || !(library = OPEN(arguments[1]))) {
        fprintf(stderr, "usage: replay LIBRARY GUID KINDS\n");
        return 2;
    }
    Unit unit = NULL;
    char line[256], first[64], second[64];
    while (fgets(line, sizeof line, stdin)) {
        char order;
        if (sscanf(line, "%c %63s %63s", &order, first, second) < 1) continue;
        Reference r = (Reference)strtoul(first, NULL, 10);
        int status = 0;
        switch (order) {
        case 'n':
            LIFE(FreeInstance)(unit);
            unit = make(arguments[2]);
            status = unit ? 0 : 3;
            break;
        case 'e': status = enter(unit); break;
        case 'x': status = LIFE(ExitInitializationMode)(unit); break;
        case 'R': status = set_real(unit, r, number(second)); break;
        case 's': status = step(unit, number(first), number(second)); break;
        case 'g': show(unit, arguments[3]); continue;
        default: status = set_number(unit, order, r, atoi(second));
        }
        printf("%d\n", status);
    }
    LIFE(FreeInstance)(unit);
    return 0;
}
