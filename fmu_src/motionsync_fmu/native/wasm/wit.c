/* FMI 3.0 as a WebAssembly component (layered standard fmi-ls-wasm, draft 0.1.0): each function of its interface
 * `co-simulation`, by the component model's canonical ABI, calls that of fmi3.c. */
#define FMI3_Export static /* the functions are called from here only */
#include "fmi3.c"

#define IN(package, name) __attribute__((import_module(package), import_name(name)))
#define OUT(name) __attribute__((export_name(name)))
#define HERE "fmi:fmi3/co-simulation@3.0.0"
#define METHOD(name) OUT(HERE "#[method]co-simulation-instance." name)
#define POST(name) OUT("cabi_post_" HERE "#[method]co-simulation-instance." name) void

typedef struct {
    char *bytes;
    size_t length;
} String;

OUT("_initialize") void initialize_nothing(void) {} /* of a library there would be a C library to start */

/* --- memory: a unit and its states are all that is kept, so that what is freed is soon taken again --- */

typedef struct Room {
    struct Room *next; /* of the free ones */
    size_t size;       /* behind this head */
} Room;

enum { PAGE = 65536, ALIGNED = 16 };
extern uint8_t __heap_base[]; /* where the linker's part of the memory ends */
static Room *free_rooms;
static size_t used; /* up to here the memory is taken; 0: nothing is */

static void *allocate(size_t n, size_t each) {
    size_t size = (n * each + ALIGNED - 1) & -(size_t)ALIGNED;
    for (Room **at = &free_rooms; *at; at = &(*at)->next) {
        Room *room = *at;
        if (room->size < size || room->size > 2 * size) continue;
        *at = room->next;
        return room + 1;
    }
    if (!used) used = ((size_t)__heap_base + ALIGNED - 1) & -(size_t)ALIGNED;
    size_t end = used + ALIGNED + size, there = __builtin_wasm_memory_size(0) * PAGE;
    if (end > there && __builtin_wasm_memory_grow(0, (end - there + PAGE - 1) / PAGE) == (size_t)-1) return NULL;
    Room *room = (Room *)(used + ALIGNED - sizeof(Room));
    room->size = size;
    used = end;
    return room + 1;
}

static void release(void *place) {
    if (!place) return;
    Room *room = (Room *)place - 1;
    room->next = free_rooms;
    free_rooms = room;
}

Memory system_memory(void) { return (Memory){allocate, release}; }

/* Memory for what is passed: taken piece by piece, given back as a whole when the results of a call have been read. */
typedef struct Chunk {
    struct Chunk *next;
    size_t room; /* its head included */
} Chunk;
static Chunk *chunk;
static size_t taken;

OUT("cabi_realloc") void *give(void *old, size_t size, size_t align, size_t wanted) {
    taken = (taken + align - 1) & -align;
    if (!chunk || taken + wanted > chunk->room) { /* what has been given stays where it is */
        size_t least = sizeof *chunk + align + wanted, all = least > PAGE ? least : PAGE;
        Chunk *more = allocate(1, all);
        if (!more) __builtin_trap();
        *more = (Chunk){chunk, all};
        chunk = more;
        taken = (sizeof *chunk + align - 1) & -align;
    }
    uint8_t *place = (uint8_t *)chunk + taken;
    taken += wanted;
    return old ? memcpy(place, old, size < wanted ? size : wanted) : place;
}

static void give_back(void) {
    while (chunk && chunk->next) {
        Chunk *next = chunk->next;
        release(chunk);
        chunk = next;
    }
    taken = sizeof *chunk;
}

/* --- messages: the environment of a unit is its name --- */

IN("fmi:fmi3/callbacks@3.0.0", "log-message")
void host_log(const char *name, size_t nName, int32_t status, const char *category, size_t nCategory, const char *text,
              size_t nText);

static void tell_host(fmi3InstanceEnvironment name, fmi3Status status, fmi3String category, fmi3String text) {
    host_log(name, strlen(name), status, category, strlen(category), text, strlen(text));
}

/* --- results --- */

typedef struct {
    uint8_t failed;
    union {
        struct {
            void *values;
            size_t length;
        } list;
        uint8_t status;
    } is;
} List;
static List list;

static List *listed(fmi3Status status, void *values, size_t length) {
    list.failed = status > fmi3Warning;
    if (list.failed) list.is.status = (uint8_t)status;
    else list.is.list.values = values, list.is.list.length = length;
    return &list;
}

static char *text(const char *bytes, size_t length) { /* with an end, as C has it */
    char *copy = give(NULL, 0, 1, length + 1);
    memcpy(copy, bytes, length);
    copy[length] = 0;
    return copy;
}

#define STATUS(name, function)                                                \
    METHOD(name) int32_t wit_##function(Unit *c) { return function(c); } \
    POST(name) post_##function(int32_t x) { give_back(); }

/* --- life --- */

OUT("fmi:fmi3/common@3.0.0#get-version") String *wit_version(void) {
    static String version;
    version.bytes = (char *)fmi3GetVersion(), version.length = strlen(version.bytes);
    return &version;
}
OUT("cabi_post_fmi:fmi3/common@3.0.0#get-version") void post_version(String *x) { give_back(); }

IN("[export]" HERE, "[resource-new]co-simulation-instance") int32_t handle_of(Unit *c);

OUT(HERE "#[static]co-simulation-instance.instantiate-co-simulation")
void *wit_instantiate(char *name, size_t nName, char *token, size_t nToken, char *resources, size_t nResources,
                      int32_t visible, int32_t logging, int32_t event, int32_t early, uint32_t *intermediate,
                      size_t nIntermediate) {
    static struct {
        uint8_t some;
        int32_t handle;
    } made_unit;
    char *called = text(name, nName);
    Unit *c = fmi3InstantiateCoSimulation(called, text(token, nToken), text(resources, nResources), visible, logging,
                                          event, early, intermediate, nIntermediate, called, tell_host, NULL);
    if (c) {
        Importer *importer = unit_importer(c);
        importer->environment = importer->name; /* which lives as long as the unit */
        made_unit.handle = handle_of(c);
    }
    made_unit.some = c != NULL;
    return &made_unit;
}
OUT("cabi_post_" HERE "#[static]co-simulation-instance.instantiate-co-simulation")
void post_instantiate(void *x) { give_back(); }

OUT(HERE "#[dtor]co-simulation-instance") void wit_free(Unit *c) { fmi3FreeInstance(c); }

METHOD("set-debug-logging") int32_t wit_logging(Unit *c, int32_t on, String *categories, size_t n) {
    const char **known = give(NULL, 0, 4, n * sizeof *known);
    for (size_t i = 0; i < n; i++) known[i] = text(categories[i].bytes, categories[i].length);
    return fmi3SetDebugLogging(c, on, n, known);
}
POST("set-debug-logging") post_logging(int32_t x) { give_back(); }

METHOD("enter-initialization-mode")
int32_t wit_enter(Unit *c, int32_t hasTolerance, double tolerance, double start, int32_t hasStop, double stop) {
    return fmi3EnterInitializationMode(c, hasTolerance, tolerance, start, hasStop, stop);
}
POST("enter-initialization-mode") post_enter(int32_t x) { give_back(); }
STATUS("exit-initialization-mode", fmi3ExitInitializationMode)
STATUS("enter-event-mode", fmi3EnterEventMode)
STATUS("enter-step-mode", fmi3EnterStepMode)
STATUS("enter-configuration-mode", fmi3EnterConfigurationMode)
STATUS("exit-configuration-mode", fmi3ExitConfigurationMode)
STATUS("evaluate-discrete-states", fmi3EvaluateDiscreteStates)
STATUS("terminate", fmi3Terminate)
STATUS("reset", fmi3Reset)

METHOD("do-step") void *wit_step(Unit *c, double t, double h, int32_t noSetFMUStatePriorToCurrentPoint) {
    static struct {
        uint8_t failed;
        struct {
            double reached;
            uint8_t event, ended, early;
        } is;
    } result;
    bool event, ended, early;
    double reached;
    fmi3Status status = fmi3DoStep(c, t, h, noSetFMUStatePriorToCurrentPoint, &event, &ended, &early, &reached);
    result.failed = status > fmi3Warning;
    result.is.reached = reached, result.is.event = event, result.is.ended = ended, result.is.early = early;
    if (result.failed) *(uint8_t *)&result.is = (uint8_t)status;
    return &result;
}
POST("do-step") post_step(void *x) { give_back(); }

/* --- values --- */

#define VALUES(name, Type, Value)                                                                       \
    METHOD("get-" name) void *wit_get_##Type(Unit *c, uint32_t *r, size_t n) {                      \
        Value *values = give(NULL, 0, sizeof(Value), n * sizeof(Value));                                \
        return listed(fmi3Get##Type(c, r, n, values, n), values, n);                                    \
    }                                                                                                   \
    POST("get-" name) post_get_##Type(void *x) { give_back(); }                                         \
    METHOD("set-" name) int32_t wit_set_##Type(Unit *c, uint32_t *r, size_t n, Value *x, size_t m) { \
        return fmi3Set##Type(c, r, n, x, m);                                                            \
    }                                                                                                   \
    POST("set-" name) post_set_##Type(int32_t x) { give_back(); }
VALUES("float64", Float64, double)
VALUES("float32", Float32, float)
VALUES("int8", Int8, int8_t)
VALUES("int16", Int16, int16_t)
VALUES("int32", Int32, int32_t)
VALUES("int64", Int64, int64_t)
VALUES("uint8", UInt8, uint8_t)
VALUES("uint16", UInt16, uint16_t)
VALUES("uint32", UInt32, uint32_t)
VALUES("uint64", UInt64, uint64_t)
VALUES("boolean", Boolean, bool)

/* --- the FMU state, always as bytes --- */

METHOD("get-fmu-state") void *wit_get_state(Unit *c) {
    fmi3FMUState state = NULL;
    void *bytes = NULL;
    size_t n = 0;
    fmi3Status status = fmi3GetFMUState(c, &state);
    if (status <= fmi3Warning) status = fmi3SerializedFMUStateSize(c, state, &n);
    if (status <= fmi3Warning) status = fmi3SerializeFMUState(c, state, bytes = give(NULL, 0, 8, n), n);
    if (state) fmi3FreeFMUState(c, &state);
    return listed(status, bytes, n);
}
POST("get-fmu-state") post_get_state(void *x) { give_back(); }
METHOD("set-fmu-state") int32_t wit_set_state(Unit *c, uint8_t *bytes, size_t n) {
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3DeserializeFMUState(c, bytes, n, &state);
    if (status <= fmi3Warning) status = fmi3SetFMUState(c, state);
    if (state) fmi3FreeFMUState(c, &state);
    return status;
}
POST("set-fmu-state") post_set_state(int32_t x) { give_back(); }

METHOD("get-output-derivatives") void *wit_derivatives(Unit *c, uint32_t (*asked)[2], size_t n) {
    uint32_t *r = give(NULL, 0, 4, n * 4);
    int32_t *orders = give(NULL, 0, 4, n * 4);
    double *values = give(NULL, 0, 8, n * 8);
    for (size_t i = 0; i < n; i++) r[i] = asked[i][0], orders[i] = (int32_t)asked[i][1];
    return listed(fmi3GetOutputDerivatives(c, r, n, orders, values, n), values, n);
}
POST("get-output-derivatives") post_derivatives(void *x) { give_back(); }

/* --- not offered; a result's status lies behind its first byte, at the alignment of what it would have held --- */

/* `at`: where the status lies in the result. */
static void *nothing(Unit *c, const char *call, size_t at) {
    static uint64_t result[4];
    memset(result, 0, sizeof result);
    *(uint8_t *)result = 1;
    ((uint8_t *)result)[at] = (uint8_t)not_offered(c, call);
    return result;
}
#define NOTHING(id, name, at, ...)                                                               \
    METHOD(name) void *wit_##id(Unit *c, ##__VA_ARGS__) { return nothing(c, name, at); }     \
    POST(name) post_##id(void *x) { give_back(); }
#define NEVER(id, name, ...)                                                                     \
    METHOD(name) int32_t wit_##id(Unit *c, ##__VA_ARGS__) { return not_offered(c, name); }   \
    POST(name) post_##id(int32_t x) { give_back(); }
#define LIST(x) void *x, size_t n##x
NOTHING(update, "update-discrete-states", 8)
NOTHING(get_string, "get-string", 4, LIST(r))
NOTHING(get_binary, "get-binary", 4, LIST(r))
NOTHING(get_clock, "get-clock", 4, LIST(r))
NEVER(set_string, "set-string", LIST(r), LIST(x))
NEVER(set_binary, "set-binary", LIST(r), LIST(x))
NEVER(set_clock, "set-clock", LIST(r), LIST(x))
NOTHING(count, "get-number-of-variable-dependencies", 8, int32_t r)
NOTHING(dependencies, "get-variable-dependencies", 4, int32_t r)
NOTHING(directional, "get-directional-derivative", 4, LIST(u), LIST(k), LIST(s))
NOTHING(adjoint, "get-adjoint-derivative", 4, LIST(u), LIST(k), LIST(s))
NOTHING(interval, "get-interval-decimal", 4, LIST(r))
NOTHING(interval_fraction, "get-interval-fraction", 4, LIST(r))
NOTHING(shift, "get-shift-decimal", 4, LIST(r))
NOTHING(shift_fraction, "get-shift-fraction", 4, LIST(r))
NEVER(set_interval, "set-interval-decimal", LIST(r), LIST(x))
NEVER(set_interval_fraction, "set-interval-fraction", LIST(r), LIST(x))
NEVER(set_shift, "set-shift-decimal", LIST(r), LIST(x))
NEVER(set_shift_fraction, "set-shift-fraction", LIST(r), LIST(x))
NEVER(input_derivatives, "set-input-derivatives", LIST(r), LIST(x))
