/* One unit for a web page, compiled to WebAssembly, and the runner that carries it along a scenario. The page is its
 * importer: it makes memory grow for the numbers of a run, which it writes there. */
#include "run_host.h"
#include "unit.h"

#define EXPORT(name) __attribute__((export_name(#name)))

__attribute__((import_module("page"), import_name("log"))) void page_log(Status status, const char *text, size_t length);

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

static void release(void *memory) { (void)memory; } /* the one unit stays as long as the page */

static Unit *unit;
static bool failed; /* in the run itself, where Python would raise */

/* Start anew: a unit in initialization mode. The address of the block's memory; NULL: memory is lacking. */
EXPORT(reset) void *web_reset(void) {
    if (!unit && !(unit = unit_new(0, (Memory){allocate, release}, write_log, UNIT_ERROR))) return NULL;
    unit_reset(unit);
    unit_enter_initialization(unit);
    return unit_memory(unit);
}

/* Set a variable, by its value reference. */

EXPORT(set_real) Status web_set_real(uint32_t r, double value) {
    return unit_set_reals(unit, INITIALIZING | STEPPING, &r, 1, &value, "set");
}

EXPORT(set_integer) Status web_set_integer(uint32_t r, int32_t value) {
    return unit_set_integers(unit, INITIALIZING | STEPPING, INTEGER | ENUMERATION, &r, 1, &value, "set");
}

EXPORT(set_boolean) Status web_set_boolean(uint32_t r, int32_t value) {
    return unit_set_booleans(unit, INITIALIZING | STEPPING, &r, 1, &value, "set");
}

/* Initialize the unit, with the axis as it is at time 0, and begin the run. */
EXPORT(initialize) Status web_initialize(Run *r) {
    failed = false;
    run_start(r, &failed);
    Status status = unit_exit_initialization(unit);
    if (!status) run_begin(r, &failed);
    return failed ? UNIT_ERROR : status;
}

/* Set what the scenario sets for the next step. False: the run is at its end. */
EXPORT(prepare) bool web_prepare(Run *r) {
    if (!run_prepare(r, &failed)) return false;
    if (run_first_refused(r) >= 0) unit_count_out_of_range(unit);
    return true;
}

/* Step the unit, and record what comes of it; a refused step is not recorded. */
EXPORT(step) Status web_step(Run *r) {
    Status status = unit_step(unit, unit_time(unit), r->step, "step");
    if (!status) run_finish(r, &failed);
    return failed ? UNIT_ERROR : status;
}

/* End the run: the unit logs what has happened again and again. */
EXPORT(terminate) void web_terminate(void) { unit_terminate(unit); }

/* All steps that are left, up to one that is refused. */
EXPORT(carry) Status web_carry(Run *r) {
    Status status = UNIT_OK;
    while (!status && web_prepare(r)) status = web_step(r);
    return status;
}
