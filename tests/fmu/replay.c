/* A plain C host: carries out the calls that it reads, and writes what the unit answers, number by number.
 *
 * replay LIBRARY GUID KINDS: KINDS has one letter a variable: R, I or B. Lines on standard input:
 *   e        set up and enter initialization mode       x            exit initialization mode
 *   R r bits set the Real of value reference r          I r v, B r v set an Integer or Boolean
 *   s t h    do a step (t and h as bits)                g            get all variables
 *   n        go on with a new instance
 * Numbers are written and read as the 16 hexadecimal digits of their bits. Each line is answered by one line: the
 * status, or for g all values. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "fmi2FunctionTypes.h"
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
    void *found = FIND(library, name);
    if (found) return found;
    fprintf(stderr, "%s is missing\n", name);
    exit(2);
}

static double number(const char *bits) {
    uint64_t n = strtoull(bits, NULL, 16);
    double x;
    memcpy(&x, &n, sizeof x);
    return x;
}

static void show(fmi2Component unit, const char *kinds) {
    fmi2GetRealTYPE *get_real = need("fmi2GetReal");
    fmi2GetIntegerTYPE *get_integer = need("fmi2GetInteger");
    fmi2GetBooleanTYPE *get_boolean = need("fmi2GetBoolean");
    for (fmi2ValueReference r = 0; kinds[r]; r++) {
        double x = 0.0;
        int n = 0;
        uint64_t bits;
        switch (kinds[r]) {
        case 'R':
            get_real(unit, &r, 1, &x);
            memcpy(&bits, &x, sizeof bits);
            printf("%016" PRIx64 " ", bits);
            continue;
        case 'I': get_integer(unit, &r, 1, &n); break;
        default: get_boolean(unit, &r, 1, &n);
        }
        printf("%d ", n);
    }
    printf("\n");
}

int main(int count, char **arguments) {
    if (count != 4 || !(library = OPEN(arguments[1]))) {
        fprintf(stderr, "usage: replay LIBRARY GUID KINDS\n");
        return 2;
    }
    fmi2CallbackFunctions callbacks = {0};
    fmi2Component unit = NULL;
    char line[256], first[64], second[64];
    while (fgets(line, sizeof line, stdin)) {
        char order;
        if (sscanf(line, "%c %63s %63s", &order, first, second) < 1) continue;
        fmi2ValueReference r = (fmi2ValueReference)strtoul(first, NULL, 10);
        double x = number(second);
        int n = atoi(second), status = 0;
        switch (order) {
        case 'n':
            ((fmi2FreeInstanceTYPE *)need("fmi2FreeInstance"))(unit);
            unit = ((fmi2InstantiateTYPE *)need("fmi2Instantiate"))("unit", fmi2CoSimulation, arguments[2], "file:///",
                                                                    &callbacks, fmi2False, fmi2False);
            status = unit ? 0 : 3;
            break;
        case 'e':
            ((fmi2SetupExperimentTYPE *)need("fmi2SetupExperiment"))(unit, fmi2False, 0.0, 0.0, fmi2False, 0.0);
            status = ((fmi2EnterInitializationModeTYPE *)need("fmi2EnterInitializationMode"))(unit);
            break;
        case 'x': status = ((fmi2ExitInitializationModeTYPE *)need("fmi2ExitInitializationMode"))(unit); break;
        case 'R': status = ((fmi2SetRealTYPE *)need("fmi2SetReal"))(unit, &r, 1, &x); break;
        case 'I': status = ((fmi2SetIntegerTYPE *)need("fmi2SetInteger"))(unit, &r, 1, &n); break;
        case 'B': status = ((fmi2SetBooleanTYPE *)need("fmi2SetBoolean"))(unit, &r, 1, &n); break;
        case 's': status = ((fmi2DoStepTYPE *)need("fmi2DoStep"))(unit, number(first), x, fmi2True); break;
        default: show(unit, arguments[3]); continue;
        }
        printf("%d\n", status);
    }
    ((fmi2FreeInstanceTYPE *)need("fmi2FreeInstance"))(unit);
    return 0;
}
