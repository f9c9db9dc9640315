/* The core of a native unit: a block's values, steps, messages and states, for the FMI functions above it.
 *
 * The core knows no version of FMI: a file such as fmi2.c gives the standard's functions their names and types, restricts
 * when they may be called, and passes the rest on. `call` is the name of the standard's function, for the messages.
 * A call that fails changes nothing, logs why, and may be repeated. */
#ifndef UNIT_H
#define UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "portable.h"

typedef struct Unit Unit; /* one instance: all that changes is in it, there are no globals */

typedef enum { UNIT_OK, UNIT_WARNING, UNIT_DISCARD, UNIT_ERROR } Status; /* with the numbers of FMI 2 and 3 */

/* One phase of a unit's life, or a set of them. */
typedef enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY = 15 } Mode;

/* The kinds of messages, by status; a unit logs a set of them. */
typedef enum { LOG_NOTHING = 0, LOG_WARNING = 1, LOG_DISCARD = 2, LOG_ERROR = 4, LOG_ALL = 7 } Category;

/* One kind of variables, or a set of them. */
typedef enum { REAL = 1, INTEGER = 2, BOOLEAN = 4, ENUMERATION = 8 } Kind;

/* A function that passes a message to the importer; `importer`: what the FMI functions store with the unit. */
typedef void LogFunction(const void *importer, Status status, const char *text);

/* Where a unit gets memory: a block for n things of a size, aligned for all of C's types, or NULL; and what releases such
 * a block. A unit gets memory when it is made and for each new FMU state, and at no other time. */
typedef struct {
    void *(*allocate)(size_t n, size_t size);
    void (*release)(void *block);
} Memory;

Memory system_memory(void); /* the system's, in memory.c */

/* --- life --- */

const char *unit_guid(void);

/* A new unit, which logs all if there is a `log`; `size` bytes, all 0, are for what the FMI functions store with it;
 * `refusal_status`: what a refused step returns, UNIT_DISCARD or UNIT_ERROR. NULL if memory is lacking. It must be reset
 * before anything but unit_importer_data, unit_report and unit_free is called with it. */
Unit *unit_new(size_t size, Memory memory, LogFunction *log, Status refusal_status);
void unit_free(Unit *u);
void *unit_importer_data(Unit *u);
void unit_reset(Unit *u);

Mode unit_mode(const Unit *u);
double unit_time(const Unit *u); /* the start time, or the end of the last step */
Status unit_set_times(Unit *u, double start, double stop, const char *call); /* stop: INFINITY if there is none */
void unit_enter_initialization(Unit *u);
Status unit_exit_initialization(Unit *u);
Status unit_step(Unit *u, double time, double h, const char *call); /* in step mode only */
void unit_terminate(Unit *u); /* logs first what has happened again and again */

/* --- messages --- */

void unit_set_categories(Unit *u, int categories);

/* Logs a message, and returns its status. In the format %s stands for a text, %d for an int64_t, %r for a double. */
Status unit_report(const Unit *u, Status status, const char *format, ...);
bool unit_check_mode(const Unit *u, int modes, const char *call); /* false, and an error is logged, in any other mode */
bool unit_check_pointer(const Unit *u, const void *pointer, const char *call); /* the same for NULL */

/* --- values, by the value references `r` of their variables --- */

/* `modes`: when the call is allowed; `kinds`: the variables that it may name, if its name does not say so. These
 * functions are called most, and check the mode themselves. */

Status unit_get_reals(Unit *u, int modes, const uint32_t r[], size_t n, double values[], const char *call);
Status unit_get_integers(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, int32_t values[],
                         const char *call);
Status unit_get_enumerations(Unit *u, int modes, const uint32_t r[], size_t n, int64_t values[], const char *call);
Status unit_get_booleans(Unit *u, int modes, const uint32_t r[], size_t n, int32_t values[], const char *call);
Status unit_get_flags(Unit *u, int modes, const uint32_t r[], size_t n, bool values[], const char *call);
Status unit_set_reals(Unit *u, int modes, const uint32_t r[], size_t n, const double values[], const char *call);
Status unit_set_integers(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const int32_t values[],
                         const char *call);
Status unit_set_enumerations(Unit *u, int modes, const uint32_t r[], size_t n, const int64_t values[],
                             const char *call);
Status unit_set_booleans(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t values[], const char *call);
Status unit_set_flags(Unit *u, int modes, const uint32_t r[], size_t n, const bool values[], const char *call);

/* Derivatives of inputs act in the next step only; those of the slave's position are always there. */
Status unit_set_input_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                  const double values[], const char *call);
Status unit_get_output_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                   double values[], const char *call);

/* The block's memory. A program that is compiled with this one may write allowed values there; after any other it has to
 * call unit_count_out_of_range, so that the next step is refused. */
void *unit_memory(Unit *u);
void unit_count_out_of_range(Unit *u);

/* --- states: copies of all that steps and setters change; any instance of this unit can restore them --- */

Status unit_save(const Unit *u, void **state, const char *call); /* into a new state, or over the one given */
Status unit_restore(Unit *u, const void *state, const char *call);
Status unit_free_state(const Unit *u, void **state, const char *call);
Status unit_serialized_size(const Unit *u, const void *state, size_t *n, const char *call);
Status unit_serialize(const Unit *u, const void *state, uint8_t bytes[], size_t n, const char *call);
Status unit_deserialize(const Unit *u, const uint8_t bytes[], size_t n, void **state, const char *call);

#endif
