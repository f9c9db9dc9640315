/* FMI 3.0 as a WebAssembly component (layered standard fmi-ls-wasm, draft 0.1.0): each function of its interface
 * `co-simulation`, by the component model's canonical ABI, calls that of fmi3.c. */
#define FMI3_Export static /* the functions are called from here only */
#include "fmi3.c"

#define IN(package, name) __attribute__((import_module(package), import_name(name)))
#define OUT(name) __attribute__((export_name(name)))
#define INTERFACE "fmi:fmi3/co-simulation@3.0.0"
#define INSTANCE INTERFACE "#[method]co-simulation-instance."

typedef struct {
    char *bytes;
    size_t length;
} String;

OUT("_initialize") void initialize_nothing(void) {} /* a C library would have to be initialized here; there is none */

/* --- memory: only an instance and its states live longer than a call, so that released blocks are soon used again --- */

typedef struct MemoryBlock {
    struct MemoryBlock *next; /* of the free blocks */
    size_t size;       /* behind this head */
} MemoryBlock;

enum { PAGE = 65536, ALIGNED = 16 };
extern uint8_t __heap_base[]; /* the end of the linker's part of the memory */
static MemoryBlock *free_blocks;
static size_t used; /* the end of the memory in use; 0: none is */

static void *allocate(size_t n, size_t each) {
    size_t size = (n * each + ALIGNED - 1) & -(size_t)ALIGNED;
    for (MemoryBlock **at = &free_blocks; *at; at = &(*at)->next) {
        MemoryBlock *block = *at;
        if (block->size < size || block->size > 2 * size) continue;
        *at = block->next;
        return block + 1;
    }
    if (!used) used = ((size_t)__heap_base + ALIGNED - 1) & -(size_t)ALIGNED;
    size_t end = used + ALIGNED + size, available = __builtin_wasm_memory_size(0) * PAGE;
    if (end > available && __builtin_wasm_memory_grow(0, (end - available + PAGE - 1) / PAGE) == (size_t)-1) return NULL;
    MemoryBlock *block = (MemoryBlock *)(used + ALIGNED - sizeof(MemoryBlock));
    block->size = size;
    used = end;
    return block + 1;
}

static void release(void *address) {
    if (!address) return;
    MemoryBlock *block = (MemoryBlock *)address - 1;
    block->next = free_blocks;
    free_blocks = block;
}

Memory system_memory(void) { return (Memory){allocate, release}; }

/* Memory for arguments and results: the blocks of one call, released when its results have been read. Nothing is aligned to
 * more than ALIGNED. */
typedef struct CallBlock {
    struct CallBlock *next;
} CallBlock;
static CallBlock *call_blocks;

OUT("cabi_realloc") void *allocate_for_call(void *old, size_t size, size_t align, size_t new_size) {
    CallBlock *block = allocate(1, ALIGNED + new_size);
    if (!block) __builtin_trap();
    block->next = call_blocks;
    call_blocks = block;
    uint8_t *address = (uint8_t *)block + ALIGNED;
    return old ? memcpy(address, old, size < new_size ? size : new_size) : address;
}

static void release_after_call(void) {
    for (CallBlock *block; (block = call_blocks);) {
        call_blocks = block->next;
        release(block);
    }
}

/* --- messages: the environment of an instance is its name --- */

IN("fmi:fmi3/callbacks@3.0.0", "log-message")
void host_log(const char *name, size_t nName, int32_t status, const char *category, size_t nCategory, const char *text,
              size_t nText);

static void log_to_host(fmi3InstanceEnvironment name, fmi3Status status, fmi3String category, fmi3String text) {
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

static List *list_result(fmi3Status status, void *values, size_t length) {
    list.failed = status > fmi3Warning;
    if (list.failed) list.is.status = (uint8_t)status;
    else list.is.list.values = values, list.is.list.length = length;
    return &list;
}

static char *to_c_string(const char *bytes, size_t length) { /* with a zero at its end */
    char *copy = allocate_for_call(NULL, 0, 1, length + 1);
    memcpy(copy, bytes, length);
    copy[length] = 0;
    return copy;
}

/* A method of an instance, whose parameters and body follow, and what is called when its result has been read. */
#define METHOD(Result, id, name)                                                            \
    OUT("cabi_post_" INSTANCE name) void post_##id(Result result) { release_after_call(); } \
    OUT(INSTANCE name) Result wit_##id
#define STATUS(name, function) METHOD(int32_t, function, name)(Instance *c) { return function(c); }

/* --- life --- */

OUT("fmi:fmi3/common@3.0.0#get-version") String *wit_version(void) {
    static String version;
    version.bytes = (char *)fmi3GetVersion(), version.length = strlen(version.bytes);
    return &version;
}
OUT("cabi_post_fmi:fmi3/common@3.0.0#get-version") void post_version(String *x) { release_after_call(); }

IN("[export]" INTERFACE, "[resource-new]co-simulation-instance") int32_t handle_of(Instance *c);

OUT(INTERFACE "#[static]co-simulation-instance.instantiate-co-simulation")
void *wit_instantiate(char *name, size_t nName, char *token, size_t nToken, char *resources, size_t nResources,
                      int32_t visible, int32_t logging, int32_t event, int32_t early, uint32_t *intermediate,
                      size_t nIntermediate) {
    static struct {
        uint8_t some;
        int32_t handle;
    } result;
    char *instance_name = to_c_string(name, nName);
    Instance *c = fmi3InstantiateCoSimulation(instance_name, to_c_string(token, nToken), to_c_string(resources, nResources),
                                          visible, logging, event, early, intermediate, nIntermediate, instance_name,
                                          log_to_host, NULL);
    if (c) {
        Importer *importer = instance_importer_data(c);
        importer->environment = importer->name; /* which lives as long as the instance */
        result.handle = handle_of(c);
    }
    result.some = c != NULL;
    return &result;
}
OUT("cabi_post_" INTERFACE "#[static]co-simulation-instance.instantiate-co-simulation")
void post_instantiate(void *x) { release_after_call(); }

OUT(INTERFACE "#[dtor]co-simulation-instance") void wit_free(Instance *c) { fmi3FreeInstance(c); }

METHOD(int32_t, logging, "set-debug-logging")(Instance *c, int32_t on, String *categories, size_t n) {
    const char **names = allocate_for_call(NULL, 0, 4, n * sizeof *names);
    for (size_t i = 0; i < n; i++) names[i] = to_c_string(categories[i].bytes, categories[i].length);
    return fmi3SetDebugLogging(c, on, n, names);
}

METHOD(int32_t, enter, "enter-initialization-mode")(Instance *c, int32_t hasTolerance, double tolerance, double start,
                                                    int32_t hasStop, double stop) {
    return fmi3EnterInitializationMode(c, hasTolerance, tolerance, start, hasStop, stop);
}
STATUS("exit-initialization-mode", fmi3ExitInitializationMode)
STATUS("enter-event-mode", fmi3EnterEventMode)
STATUS("enter-step-mode", fmi3EnterStepMode)
STATUS("enter-configuration-mode", fmi3EnterConfigurationMode)
STATUS("exit-configuration-mode", fmi3ExitConfigurationMode)
STATUS("evaluate-discrete-states", fmi3EvaluateDiscreteStates)
STATUS("terminate", fmi3Terminate)
STATUS("reset", fmi3Reset)

METHOD(void *, step, "do-step")(Instance *c, double t, double h, int32_t noSetFMUStatePriorToCurrentPoint) {
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

/* --- values --- */

#define VALUES(name, Type, Value)                                                                  \
    METHOD(void *, get_##Type, "get-" name)(Instance *c, uint32_t *r, size_t n) {                      \
        Value *values = allocate_for_call(NULL, 0, sizeof(Value), n * sizeof(Value));              \
        return list_result(fmi3Get##Type(c, r, n, values, n), values, n);                          \
    }                                                                                              \
    METHOD(int32_t, set_##Type, "set-" name)(Instance *c, uint32_t *r, size_t n, Value *x, size_t m) { \
        return fmi3Set##Type(c, r, n, x, m);                                                       \
    }
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

METHOD(void *, get_state, "get-fmu-state")(Instance *c) {
    fmi3FMUState state = NULL;
    void *bytes = NULL;
    size_t n = 0;
    fmi3Status status = fmi3GetFMUState(c, &state);
    if (status <= fmi3Warning) status = fmi3SerializedFMUStateSize(c, state, &n);
    if (status <= fmi3Warning) status = fmi3SerializeFMUState(c, state, bytes = allocate_for_call(NULL, 0, 8, n), n);
    if (state) fmi3FreeFMUState(c, &state);
    return list_result(status, bytes, n);
}

METHOD(int32_t, set_state, "set-fmu-state")(Instance *c, uint8_t *bytes, size_t n) {
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3DeserializeFMUState(c, bytes, n, &state);
    if (status <= fmi3Warning) status = fmi3SetFMUState(c, state);
    if (state) fmi3FreeFMUState(c, &state);
    return status;
}

METHOD(void *, derivatives, "get-output-derivatives")(Instance *c, uint32_t (*queries)[2], size_t n) {
    uint32_t *r = allocate_for_call(NULL, 0, 4, n * 4);
    int32_t *orders = allocate_for_call(NULL, 0, 4, n * 4);
    double *values = allocate_for_call(NULL, 0, 8, n * 8);
    for (size_t i = 0; i < n; i++) r[i] = queries[i][0], orders[i] = (int32_t)queries[i][1];
    return list_result(fmi3GetOutputDerivatives(c, r, n, orders, values, n), values, n);
}

/* --- not offered; a result's status is behind its first byte, at the alignment of the value that it would have held --- */

/* `at`: the index of the status in the result. */
static void *refused_result(Instance *c, const char *call, size_t at) {
    static uint64_t result[4];
    memset(result, 0, sizeof result);
    *(uint8_t *)result = 1;
    ((uint8_t *)result)[at] = (uint8_t)refuse_call(c, call);
    return result;
}
#define REFUSED_RESULT(id, name, at, ...) \
    METHOD(void *, id, name)(Instance *c, ##__VA_ARGS__) { return refused_result(c, name, at); }
#define REFUSED_STATUS(id, name, ...) \
    METHOD(int32_t, id, name)(Instance *c, ##__VA_ARGS__) { return refuse_call(c, name); }
#define LIST(x) void *x, size_t n##x
REFUSED_RESULT(update, "update-discrete-states", 8)
REFUSED_RESULT(get_string, "get-string", 4, LIST(r))
REFUSED_RESULT(get_binary, "get-binary", 4, LIST(r))
REFUSED_RESULT(get_clock, "get-clock", 4, LIST(r))
REFUSED_STATUS(set_string, "set-string", LIST(r), LIST(x))
REFUSED_STATUS(set_binary, "set-binary", LIST(r), LIST(x))
REFUSED_STATUS(set_clock, "set-clock", LIST(r), LIST(x))
REFUSED_RESULT(count, "get-number-of-variable-dependencies", 8, int32_t r)
REFUSED_RESULT(dependencies, "get-variable-dependencies", 4, int32_t r)
REFUSED_RESULT(directional, "get-directional-derivative", 4, LIST(u), LIST(k), LIST(s))
REFUSED_RESULT(adjoint, "get-adjoint-derivative", 4, LIST(u), LIST(k), LIST(s))
REFUSED_RESULT(interval, "get-interval-decimal", 4, LIST(r))
REFUSED_RESULT(interval_fraction, "get-interval-fraction", 4, LIST(r))
REFUSED_RESULT(shift, "get-shift-decimal", 4, LIST(r))
REFUSED_RESULT(shift_fraction, "get-shift-fraction", 4, LIST(r))
REFUSED_STATUS(set_interval, "set-interval-decimal", LIST(r), LIST(x))
REFUSED_STATUS(set_interval_fraction, "set-interval-fraction", LIST(r), LIST(x))
REFUSED_STATUS(set_shift, "set-shift-decimal", LIST(r), LIST(x))
REFUSED_STATUS(set_shift_fraction, "set-shift-fraction", LIST(r), LIST(x))
REFUSED_STATUS(input_derivatives, "set-input-derivatives", LIST(r), LIST(x))
