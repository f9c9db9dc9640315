/* A plain C host: loads the library of an FMU, without any Python, and does what it reads on standard input.
 *
 *     host LIBRARY GUID
 *
 * One command a line. r is a value reference; a Real may be written in hexadecimal, and is printed so:
 *
 *     real r x            set a Real
 *     integer r i         set an Integer or Enumeration
 *     boolean r b         set a Boolean
 *     initialize          from instantiation to step mode, at time 0
 *     step h              doStep, s
 *     reals r ...         print variables, on one line
 *     integers r ...
 *     booleans r ...
 *
 * and to measure, with a master that moves by v h a step:
 *
 *     master r r r        what to set at each step: position, velocity and acceleration
 *     outputs r ...       the Reals to get after each step
 *     commands r ...      the Booleans to raise
 *     steady n h v        n times set, doStep, get; prints {"ns": mean of a step}
 *     worst n h v         n times the same with the commands raised, each after a step with them low; the steps are
 *                         timed one by one: {"median_ns": ..., "p999_ns": ..., "slowest_ns": ...,
 *                         "undisturbed_ns": ...}
 *
 * The machine interrupts some steps. All is done 5 times over: undisturbed is the slowest step if the quickest of its 5
 * times counts.
 *
 * Any call that does not answer OK ends it. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "fmi2FunctionTypes.h"

#define FUNCTIONS(X)                                                                                             \
    X(Instantiate) X(FreeInstance) X(SetupExperiment) X(EnterInitializationMode) X(ExitInitializationMode)       \
    X(Terminate) X(SetReal) X(SetInteger) X(SetBoolean) X(GetReal) X(GetInteger) X(GetBoolean) X(DoStep)
#define MEMBER(name) fmi2##name##TYPE *name;
static struct {
    FUNCTIONS(MEMBER)
} fmi;

enum { MOST = 64, TIMES = 5 };

typedef struct {
    fmi2ValueReference r[MOST];
    size_t n;
} References;

static fmi2Component unit;
static double now;   /* s */
static double place; /* of the master */
static References master, outputs, commands;

static void end(const char *why, const char *what) {
    fprintf(stderr, "host: %s %s\n", why, what);
    exit(1);
}

static void want(fmi2Status status, const char *call) {
    if (status != fmi2OK) end("not OK:", call);
}

static void note(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    fprintf(stderr, "%s\n", message);
}

static void load(const char *library) {
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!handle) end("cannot load", dlerror());
#define FIND(name)                                                                  \
    fmi.name = (fmi2##name##TYPE *)dlsym(handle, "fmi2" #name);                     \
    if (!fmi.name) end("the library has no", "fmi2" #name);
    FUNCTIONS(FIND)
}

static References references(char *text) {
    References list = {.n = 0};
    for (char *word = strtok(text, " \n"); word && list.n < MOST; word = strtok(NULL, " \n"))
        list.r[list.n++] = (fmi2ValueReference)strtoul(word, NULL, 10);
    return list;
}

static void initialize(void) {
    want(fmi.SetupExperiment(unit, fmi2False, 0.0, 0.0, fmi2False, 0.0), "fmi2SetupExperiment");
    want(fmi.EnterInitializationMode(unit), "fmi2EnterInitializationMode");
    want(fmi.ExitInitializationMode(unit), "fmi2ExitInitializationMode");
}

static void print(const char *kind, const References *list) {
    fmi2Real reals[MOST];
    fmi2Integer integers[MOST];
    switch (*kind) {
    case 'r': want(fmi.GetReal(unit, list->r, list->n, reals), "fmi2GetReal"); break;
    case 'i': want(fmi.GetInteger(unit, list->r, list->n, integers), "fmi2GetInteger"); break;
    default: want(fmi.GetBoolean(unit, list->r, list->n, integers), "fmi2GetBoolean");
    }
    for (size_t i = 0; i < list->n; i++)
        if (*kind == 'r') printf("%s%a", i ? " " : "", reals[i]);
        else printf("%s%d", i ? " " : "", integers[i]);
    printf("\n");
}

/* --- measuring --- */

static double clock_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* Set three inputs, doStep, get the outputs: three calls, as a simulation makes them. */
static inline fmi2Status full_step(double h, double velocity) {
    fmi2Real inputs[3] = {place += velocity * h, velocity, 0.0}, values[MOST];
    fmi2Status status = fmi.SetReal(unit, master.r, 3, inputs);
    status |= fmi.DoStep(unit, now, h, fmi2True);
    status |= fmi.GetReal(unit, outputs.r, outputs.n, values);
    now += h;
    return status;
}

static void steady(long n, double h, double velocity) {
    fmi2Status status = fmi2OK;
    double begun = clock_ns();
    for (long i = 0; i < n; i++) status |= full_step(h, velocity);
    double took = clock_ns() - begun;
    want(status, "a step");
    printf("{\"ns\": %.3f}\n", took / (double)n);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* One step with the commands low, then one with them raised: how long that takes, ns. */
static double command_step(double h, double velocity) {
    fmi2Boolean level[MOST] = {fmi2False};
    fmi2Status status = fmi.SetBoolean(unit, commands.r, commands.n, level);
    status |= full_step(h, velocity);
    for (size_t k = 0; k < commands.n; k++) level[k] = fmi2True;
    double begun = clock_ns();
    status |= fmi.SetBoolean(unit, commands.r, commands.n, level);
    status |= full_step(h, velocity);
    double took = clock_ns() - begun;
    want(status, "a step");
    return took;
}

static void worst(long n, double h, double velocity) {
    size_t all = TIMES * (size_t)n;
    double *took = malloc(all * sizeof *took), undisturbed = 0.0;
    if (!took) end("out of", "memory");
    for (size_t i = 0; i < all; i++) took[i] = command_step(h, velocity);
    for (long i = 0; i < n; i++) {
        double quickest = took[i];
        for (int k = 1; k < TIMES; k++)
            if (took[k * n + i] < quickest) quickest = took[k * n + i];
        if (quickest > undisturbed) undisturbed = quickest;
    }
    qsort(took, all, sizeof *took, ascending);
    printf("{\"median_ns\": %.0f, \"p999_ns\": %.0f, \"slowest_ns\": %.0f, \"undisturbed_ns\": %.0f}\n", took[all / 2],
           took[all - 1 - all / 1000], took[all - 1], undisturbed);
    free(took);
}

/* --- the commands --- */

static void obey(char *line) {
    char *rest = line + strcspn(line, " \n"), *after;
    if (*rest) *rest++ = 0;
    if (!strcmp(line, "real")) {
        fmi2ValueReference r = (fmi2ValueReference)strtoul(rest, &after, 10);
        fmi2Real x = strtod(after, NULL);
        want(fmi.SetReal(unit, &r, 1, &x), "fmi2SetReal");
    } else if (!strcmp(line, "integer") || !strcmp(line, "boolean")) {
        fmi2ValueReference r = (fmi2ValueReference)strtoul(rest, &after, 10);
        int x = (int)strtol(after, NULL, 10);
        want((*line == 'i' ? fmi.SetInteger : fmi.SetBoolean)(unit, &r, 1, &x), "setting an Integer or Boolean");
    } else if (!strcmp(line, "initialize")) {
        initialize();
    } else if (!strcmp(line, "step")) {
        double h = strtod(rest, NULL);
        want(fmi.DoStep(unit, now, h, fmi2True), "fmi2DoStep");
        now += h;
    } else if (!strcmp(line, "reals") || !strcmp(line, "integers") || !strcmp(line, "booleans")) {
        References list = references(rest);
        print(line, &list);
    } else if (!strcmp(line, "master")) {
        master = references(rest);
        if (master.n != 3) end("master needs", "three value references");
    } else if (!strcmp(line, "outputs")) {
        outputs = references(rest);
    } else if (!strcmp(line, "commands")) {
        commands = references(rest);
    } else if (!strcmp(line, "steady") || !strcmp(line, "worst")) {
        long n = strtol(rest, &after, 10);
        double h = strtod(after, &after), velocity = strtod(after, NULL);
        if (n < 1 || !master.n) end("first tell the steps and the master for", line);
        (*line == 's' ? steady : worst)(n, h, velocity);
    } else {
        end("unknown command", line);
    }
    fflush(stdout);
}

int main(int count, char *arguments[]) {
    static const fmi2CallbackFunctions callbacks = {note, calloc, free, NULL, NULL};
    if (count != 3) end("usage:", "host LIBRARY GUID");
    load(arguments[1]);
    unit = fmi.Instantiate("unit", fmi2CoSimulation, arguments[2], NULL, &callbacks, fmi2False, fmi2True);
    if (!unit) end("not instantiated:", arguments[1]);
    char line[4096];
    while (fgets(line, sizeof line, stdin)) obey(line);
    fmi.Terminate(unit);
    fmi.FreeInstance(unit);
    return 0;
}
