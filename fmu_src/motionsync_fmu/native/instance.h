/* The core of a native instance: a block's values, steps, messages and states, for the FMI functions above it.
 *
 * The core knows no version of FMI: a file such as fmi2.c gives the standard's functions their names and types,
 * restricts when they may be called, and passes the rest on. `call` is the name of the standard's function, for the
 * messages. A call that fails changes nothing, logs why, and may be repeated. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "portable.h"

typedef struct Instance Instance; /* one instance: all that changes is in it, there are no globals */

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR } Status; /* with the numbers of FMI 2 and 3 */

/* One phase of an instance's life, or a set of them. */
typedef enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, ANY = 15 } Mode;

/* The kinds of messages, by status; an instance logs a set of them. */
typedef enum { LOG_NOTHING = 0, LOG_WARNING = 1, LOG_DISCARD = 2, LOG_ERROR = 4, LOG_ALL = 7 } Category;

/* One kind of variables, or a set of them. */
typedef enum { REAL = 1, INTEGER = 2, BOOLEAN = 4, ENUMERATION = 8 } Kind;

/* A function that passes a message to the importer; `importer`: what the FMI functions store with the instance. */
typedef void LogFunction(const void *importer, Status status, const char *text);

/* Where an instance gets memory: a block for n things of a size, aligned for all of C's types, or NULL; and what
 * releases such a block. An instance gets memory when it is made and for each new FMU state, and at no other time. */
typedef struct {
    void *(*allocate)(size_t n, size_t size);
    void (*release)(void *block);
} Memory;

Memory system_memory(void); /* the system's, in memory.c */

/* --- life --- */

const char *instance_guid(void);

/* A new instance, which logs all if there is a `log`; `size` bytes, all 0, are for what the FMI functions store with
 * it; `refusal_status`: what a refused step returns, STATUS_DISCARD or STATUS_ERROR. NULL if memory is lacking. It must
 * be reset before anything but instance_importer_data, instance_report and instance_free is called with it. */
Instance *instance_new(size_t size, Memory memory, LogFunction *log, Status refusal_status);
void instance_free(Instance *self);
void *instance_importer_data(Instance *self);
void instance_reset(Instance *self);

Mode instance_mode(const Instance *self);
double instance_time(const Instance *self); /* the start time, or the end of the last step */
Status instance_set_times(Instance *self, double start, double stop,
                          const char *call); /* stop: INFINITY if there is none */
void instance_enter_initialization(Instance *self);
Status instance_exit_initialization(Instance *self);
Status instance_step(Instance *self, double time, double h, const char *call); /* in step mode only */
void instance_terminate(Instance *self); /* logs first what has happened again and again */

/* --- messages --- */

void instance_set_categories(Instance *self, int categories);

/* Logs a message, and returns its status. In the format %s stands for a text, %d for an int64_t, %r for a double. */
Status instance_report(const Instance *self, Status status, const char *format, ...);
bool instance_check_mode(const Instance *self, int modes,
                         const char *call); /* false, and an error is logged, in any other mode */
bool instance_check_pointer(const Instance *self, const void *pointer, const char *call); /* the same for NULL */

/* --- values, by the value references `r` of their variables --- */

/* `modes`: when the call is allowed; `kinds`: the variables that it may name, if its name does not say so. These
 * functions are called most, and check the mode themselves. */

Status instance_get_reals(Instance *self, int modes, const uint32_t r[], size_t n, double values[], const char *call);
Status instance_get_integers(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, int32_t values[],
                         const char *call);
Status instance_get_enumerations(Instance *self, int modes, const uint32_t r[], size_t n, int64_t values[],
                                 const char *call);
Status instance_get_booleans(Instance *self, int modes, const uint32_t r[], size_t n, int32_t values[],
                             const char *call);
Status instance_get_flags(Instance *self, int modes, const uint32_t r[], size_t n, bool values[], const char *call);
Status instance_set_reals(Instance *self, int modes, const uint32_t r[], size_t n, const double values[],
                          const char *call);
Status instance_set_integers(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, const int32_t values[],
                         const char *call);
Status instance_set_enumerations(Instance *self, int modes, const uint32_t r[], size_t n, const int64_t values[],
                             const char *call);
Status instance_set_booleans(Instance *self, int modes, const uint32_t r[], size_t n, const int32_t values[],
                             const char *call);
Status instance_set_flags(Instance *self, int modes, const uint32_t r[], size_t n, const bool values[],
                          const char *call);

/* Derivatives of inputs act in the next step only; those of the slave's position are always there. */
Status instance_set_input_derivatives(Instance *self, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                  const double values[], const char *call);
Status instance_get_output_derivatives(Instance *self, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                   double values[], const char *call);

/* The block's memory. A program that is compiled with this one may write allowed values there; after any other it has
 * to call instance_count_out_of_range, so that the next step is refused. */
void *instance_memory(Instance *self);
void instance_count_out_of_range(Instance *self);

/* --- states: copies of all that steps and setters change; any instance of this instance can restore them --- */

Status instance_save(const Instance *self, void **state,
                     const char *call); /* into a new state, or over the one given */
Status instance_restore(Instance *self, const void *state, const char *call);
Status instance_free_state(const Instance *self, void **state, const char *call);
Status instance_serialized_size(const Instance *self, const void *state, size_t *n, const char *call);
Status instance_serialize(const Instance *self, const void *state, uint8_t bytes[], size_t n, const char *call);
Status instance_deserialize(const Instance *self, const uint8_t bytes[], size_t n, void **state, const char *call);

#endif
