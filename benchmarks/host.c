/* A plain C host: loads the library of an FMU, without any Python, and executes the commands on standard input.
 *
 *     host LIBRARY GUID
 *
 * One command a line. r is a value reference; a Real may be written in hexadecimal:
 *
 *     real r x            set a Real
 *     integer r i         set an Integer or Enumeration
 *     boolean r b         set a Boolean
 *     initialize          from instantiation to step mode, at time 0
 *     step h              doStep, s
 *     integers r ...      print Integers or enumerations, on one line
 *     booleans r ...
 *
 * and to measure, with a master that moves by v h a step:
 *
 *     master r r r        what to set at each step: position, velocity and acceleration
 *     counter r x         an Integer to set too, which gains x a second
 *     outputs r ...       the Reals to get after each step
 *     commands r ...      the Booleans to raise
 *     between r ...       the Booleans to raise in the step between, when the commands are low
 *     draw r x y          a Real to be drawn from [x, y] before each step between
 *     ahead r s x y       a Real to be set with the commands: the Real s then, plus a number drawn from [x, y]
 *     watch r ...         Integers to look at after each step with the commands raised, 4 at most
 *     steady n h v c      n times set, doStep, get, the master being faster by the share c in every second step; prints
 *                         {"ns": mean of a step, "undisturbed_ns": the same of the quickest 1000 steps on end}
 *     worst n h v p       n times the same with the commands raised, each after a step of p s with them low; the steps
 *                         are timed one by one: {"median_ns": ..., "p999_ns": ..., "slowest_ns": ...,
 *                         "undisturbed_ns": ..., "met": {"values watched": how often, ...}}
 *
 * The machine interrupts some steps. Therefore the whole is repeated 5 times with the same random numbers, and the
 * quickest of its 5 times counts for each step: the slowest of these is undisturbed_ns.
 *
 * The host ends at the first call that does not answer OK. */
#include <dlfcn.h>
#include <math.h>
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

enum { MOST = 256, TIMES = 5, WATCHED = 4, SLICE = 1000 };

typedef struct {
    fmi2ValueReference r[MOST];
    size_t n;
} References;

static fmi2Component unit;
static double now;   /* s */
static double place; /* of the master */
static References master, outputs, commands, between, watched, counter;
static double counts; /* of the counter, 1/s */

typedef struct {
    fmi2ValueReference r, base; /* base: the Real to which the number is added, if there is one */
    double low, high;
} Range;

static Range draws[MOST], aheads[MOST];
static size_t drawn, ahead;
static uint64_t seed;

typedef struct {
    fmi2Integer values[WATCHED];
    long times;
} Met;

static Met met[MOST];
static size_t kinds;

static void end(const char *why, const char *what) {
    fprintf(stderr, "host: %s %s\n", why, what);
    exit(1);
}

static void want(fmi2Status status, const char *call) {
    if (status != fmi2OK) end("not OK:", call);
}

static void note(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                 fmi2String message, ...) {
    if (status > fmi2Warning) fprintf(stderr, "%s\n", message);
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
    fmi2Integer values[MOST];
    want((*kind == 'i' ? fmi.GetInteger : fmi.GetBoolean)(unit, list->r, list->n, values), "getting Integers or Booleans");
    for (size_t i = 0; i < list->n; i++) printf("%s%d", i ? " " : "", values[i]);
    printf("\n");
}

/* --- measuring --- */

static double clock_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static fmi2Status set_master(double velocity) {
    fmi2Real inputs[3] = {place, velocity, 0.0};
    return fmi.SetReal(unit, master.r, 3, inputs);
}

/* The counter does not change where a step of a run starts, since that time is inexact. */
static fmi2Status set_counter(void) {
    fmi2Integer count = (fmi2Integer)(int64_t)(counts * now + 0.25);
    return fmi.SetInteger(unit, counter.r, 1, &count);
}

/* Set three inputs, doStep, get the outputs: three calls, as a simulation makes them; four with a counter. */
static inline fmi2Status full_step(double h, double velocity) {
    fmi2Real values[MOST];
    fmi2Status status = set_master(velocity);
    if (counter.n) status |= set_counter();
    status |= fmi.DoStep(unit, now, h, fmi2True);
    status |= fmi.GetReal(unit, outputs.r, outputs.n, values);
    now += h;
    place += velocity * h;
    return status;
}

static void steady(long n, double h, double velocity, double change) {
    const double velocities[2] = {velocity, velocity * (1.0 + change)};
    fmi2Status status = fmi2OK;
    double took = 0.0, quickest = INFINITY;
    for (long done = 0, slice; done < n; done += slice) {
        slice = n - done < SLICE ? n - done : SLICE;
        double start = clock_ns();
        for (long i = 0; i < slice; i++) status |= full_step(h, velocities[i % 2]);
        double one = clock_ns() - start;
        took += one;
        if (one / (double)slice < quickest) quickest = one / (double)slice;
    }
    want(status, "a step");
    printf("{\"ns\": %.3f, \"undisturbed_ns\": %.3f}\n", took / (double)n, quickest);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double random_in(const Range *range) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return range->low + (range->high - range->low) * ((double)(seed >> 11) * 0x1p-53);
}

static fmi2Status set_level(const References *list, fmi2Boolean level) {
    fmi2Boolean levels[MOST];
    for (size_t i = 0; i < list->n; i++) levels[i] = level;
    return fmi.SetBoolean(unit, list->r, list->n, levels);
}

static fmi2Status set_draws(void) {
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < drawn; i++) {
        fmi2Real x = random_in(&draws[i]);
        status |= fmi.SetReal(unit, &draws[i].r, 1, &x);
    }
    return status;
}

static fmi2Status set_aheads(void) {
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < ahead; i++) {
        fmi2Real x;
        status |= fmi.GetReal(unit, &aheads[i].base, 1, &x);
        x += random_in(&aheads[i]);
        status |= fmi.SetReal(unit, &aheads[i].r, 1, &x);
    }
    return status;
}

/* One step with the commands low, then one with the commands raised: the time of the second step, ns. */
static double command_step(double h, double velocity, double pause) {
    fmi2Status status = set_draws();
    status |= set_level(&commands, fmi2False);
    status |= set_level(&between, fmi2True);
    status |= full_step(pause, velocity);
    status |= set_master(velocity); /* the aheads may lie before it */
    status |= set_aheads();
    status |= set_level(&between, fmi2False);
    double start = clock_ns();
    status |= set_level(&commands, fmi2True);
    status |= full_step(h, velocity);
    double took = clock_ns() - start;
    want(status, "a step");
    return took;
}

/* Count the values of the watched variables. */
static void look(void) {
    fmi2Integer values[WATCHED] = {0};
    want(fmi.GetInteger(unit, watched.r, watched.n, values), "fmi2GetInteger");
    size_t i = 0;
    while (i < kinds && memcmp(met[i].values, values, sizeof values)) i++;
    if (i == MOST) end("too many values to count:", "watch less");
    if (i == kinds) memcpy(met[kinds++].values, values, sizeof values);
    met[i].times++;
}

static void print_met(void) {
    printf("\"met\": {");
    for (size_t i = 0; i < kinds; i++) {
        printf("%s\"", i ? ", " : "");
        for (size_t k = 0; k < watched.n; k++) printf("%s%d", k ? " " : "", met[i].values[k]);
        printf("\": %ld", met[i].times);
    }
    printf("}");
}

static void worst(long n, double h, double velocity, double pause) {
    size_t all = TIMES * (size_t)n;
    double *took = malloc(all * sizeof *took), undisturbed = 0.0;
    if (!took) end("out of", "memory");
    memset(met, 0, sizeof met);
    kinds = 0;
    for (size_t i = 0; i < all; i++) {
        if (i % (size_t)n == 0) seed = 1;
        took[i] = command_step(h, velocity, pause);
        look();
    }
    for (long i = 0; i < n; i++) {
        double quickest = took[i];
        for (int k = 1; k < TIMES; k++)
            if (took[k * n + i] < quickest) quickest = took[k * n + i];
        if (quickest > undisturbed) undisturbed = quickest;
    }
    qsort(took, all, sizeof *took, ascending);
    printf("{\"median_ns\": %.0f, \"p999_ns\": %.0f, \"slowest_ns\": %.0f, \"undisturbed_ns\": %.0f, ", took[all / 2],
           took[all - 1 - all / 1000], took[all - 1], undisturbed);
    print_met();
    printf("}\n");
    free(took);
}

/* --- the commands --- */

static Range range(char *text, int based) {
    Range range = {.r = (fmi2ValueReference)strtoul(text, &text, 10)};
    if (based) range.base = (fmi2ValueReference)strtoul(text, &text, 10);
    range.low = strtod(text, &text);
    range.high = strtod(text, NULL);
    return range;
}

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
    } else if (!strcmp(line, "integers") || !strcmp(line, "booleans")) {
        References list = references(rest);
        print(line, &list);
    } else if (!strcmp(line, "master")) {
        master = references(rest);
        if (master.n != 3) end("master needs", "three value references");
    } else if (!strcmp(line, "counter")) {
        counter = (References){.r = {(fmi2ValueReference)strtoul(rest, &after, 10)}, .n = 1};
        counts = strtod(after, NULL);
    } else if (!strcmp(line, "outputs")) {
        outputs = references(rest);
    } else if (!strcmp(line, "commands")) {
        commands = references(rest);
    } else if (!strcmp(line, "between")) {
        between = references(rest);
    } else if (!strcmp(line, "watch")) {
        watched = references(rest);
        if (watched.n > WATCHED) end("too many", line);
    } else if (!strcmp(line, "draw")) {
        if (drawn == MOST) end("too many", line);
        draws[drawn++] = range(rest, 0);
    } else if (!strcmp(line, "ahead")) {
        if (ahead == MOST) end("too many", line);
        aheads[ahead++] = range(rest, 1);
    } else if (!strcmp(line, "steady") || !strcmp(line, "worst")) {
        long n = strtol(rest, &after, 10);
        double h = strtod(after, &after), velocity = strtod(after, &after), last = strtod(after, NULL);
        if (n < 1 || !master.n) end("first give the steps and the master for", line);
        if (*line == 's') steady(n, h, velocity, last);
        else worst(n, h, velocity, last);
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
