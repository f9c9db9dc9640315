/* One instance for a web page, compiled to WebAssembly, and the runner that carries it along a scenario. The page is
 * its importer: it makes memory grow for the numbers of a run, which it writes there. */
#include "run_host.h"
#include "instance.h"

#define EXPORT(name) __attribute__((export_name(#name)))

__attribute__((import_module("page"), import_name("log"))) void page_log(Status status, const char *text,
                                                                         size_t length);

static void write_log(const void *importer, Status status, const char *text) {
    size_t length = 0;
    while (text[length]) length++;
    page_log(status, text, length);
}

enum { PAGE = 65536 }; /* bytes that memory grows by */

/* Further memory, all 0. */
static void *allocate(size_t n, size_t size) {
    size_t pages = __builtin_wasm_memory_grow(0, (n * size + PAGE - 1) / PAGE);
    return pages == SIZE_MAX ? NULL : (void *)(pages * PAGE);
}

static void release(void *memory) { (void)memory; } /* the one instance stays as long as the page */

static Instance *instance;
static bool failed; /* in the run itself, where Python would raise */

/* Start anew: an instance in initialization mode. The address of the block's memory; NULL: memory is lacking. */
EXPORT(reset) void *web_reset(void) {
    if (!instance && !(instance = instance_new(0, (Memory){allocate, release}, write_log, STATUS_ERROR))) return NULL;
    instance_reset(instance);
    instance_enter_initialization(instance);
    return instance_memory(instance);
}

/* Set a variable, by its value reference. */

EXPORT(set_real) Status web_set_real(uint32_t r, double value) {
    return instance_set_reals(instance, INITIALIZING | STEPPING, &r, 1, &value, "set");
}

EXPORT(set_integer) Status web_set_integer(uint32_t r, int32_t value) {
    return instance_set_integers(instance, INITIALIZING | STEPPING, INTEGER | ENUMERATION, &r, 1, &value, "set");
}

EXPORT(set_boolean) Status web_set_boolean(uint32_t r, int32_t value) {
    return instance_set_booleans(instance, INITIALIZING | STEPPING, &r, 1, &value, "set");
}

/* Initialize the instance, with the axis as it is at time 0, and begin the run. */
EXPORT(initialize) Status web_initialize(Run *r) {
    failed = false;
    run_start(r, &failed);
    Status status = instance_exit_initialization(instance);
    if (!status) run_begin(r, &failed);
    return failed ? STATUS_ERROR : status;
}

/* Set what the scenario sets for the next step. False: the run is at its end. */
EXPORT(prepare) bool web_prepare(Run *r) {
    if (!run_prepare(r, &failed)) return false;
    if (run_first_refused(r) >= 0) instance_count_out_of_range(instance);
    return true;
}

/* Step the instance, and record what comes of it; a refused step is not recorded. */
EXPORT(step) Status web_step(Run *r) {
    Status status = instance_step(instance, instance_time(instance), r->step, "step");
    if (!status) run_finish(r, &failed);
    return failed ? STATUS_ERROR : status;
}

/* End the run: the instance logs what has happened again and again. */
EXPORT(terminate) void web_terminate(void) { instance_terminate(instance); }

/* All steps that are left, up to one that is refused. */
EXPORT(carry) Status web_carry(Run *r) {
    Status status = STATUS_OK;
    while (!status && web_prepare(r)) status = web_step(r);
    return status;
}
