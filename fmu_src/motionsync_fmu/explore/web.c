/* One unit for a web page, compiled to WebAssembly, over the unit's core: the page is its importer, and makes memory
 * grow for its own lists of value references and values. */
#include "unit.h"

#define EXPORT(name) __attribute__((export_name(#name)))

__attribute__((import_module("page"), import_name("told"))) void page_told(Status status, const char *text, size_t length);

static void tell(const void *importer, Status status, const char *text) {
    size_t length = 0;
    while (text[length]) length++;
    page_told(status, text, length);
}

enum { PAGE = 65536 }; /* bytes that memory grows by */

/* Further memory, all 0. */
static void *allocate(size_t n, size_t size) {
    size_t pages = __builtin_wasm_memory_grow(0, (n * size + PAGE - 1) / PAGE);
    return pages == SIZE_MAX ? NULL : (void *)(pages * PAGE);
}

static void release(void *room) { (void)room; } /* the one unit stays as long as the page */

static Unit *unit;

/* Begin anew: a unit in initialization mode. False: memory is lacking. */
EXPORT(begin) bool web_begin(void) {
    if (!unit && !(unit = unit_new(0, (Memory){allocate, release}, tell, UNIT_ERROR))) return false;
    unit_reset(unit);
    unit_enter_initialization(unit);
    return true;
}

EXPORT(initialize) Status web_initialize(void) { return unit_exit_initialization(unit); }
EXPORT(step) Status web_step(double h) { return unit_step(unit, unit_time(unit), h, "step"); }

EXPORT(set_reals) Status web_set_reals(const uint32_t r[], size_t n, const double values[]) {
    return unit_set_reals(unit, INITIALIZING | STEPPING, r, n, values, "set");
}

EXPORT(set_integers) Status web_set_integers(const uint32_t r[], size_t n, const int32_t values[]) {
    return unit_set_integers(unit, INITIALIZING | STEPPING, INTEGER | ENUMERATION, r, n, values, "set");
}

EXPORT(set_booleans) Status web_set_booleans(const uint32_t r[], size_t n, const int32_t values[]) {
    return unit_set_booleans(unit, INITIALIZING | STEPPING, r, n, values, "set");
}

/* Values as numbers: those of so many Reals, then of so many Integers and enumerations, then of so many Booleans. */
EXPORT(get) void web_get(const uint32_t r[], size_t reals, size_t integers, size_t booleans, double values[]) {
    unit_get_reals(unit, ANY, r, reals, values, "get");
    for (size_t i = reals; i < reals + integers + booleans; i++) {
        int32_t x = 0;
        if (i < reals + integers) unit_get_integers(unit, ANY, INTEGER | ENUMERATION, r + i, 1, &x, "get");
        else unit_get_booleans(unit, ANY, r + i, 1, &x, "get");
        values[i] = x;
    }
}
