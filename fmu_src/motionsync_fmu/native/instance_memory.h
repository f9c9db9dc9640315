/* Part of instance.c: the tables of a block's variables, the memory of an instance, and single values in it. */
#ifndef INSTANCE_MEMORY_H
#define INSTANCE_MEMORY_H

#include "instance.h"
#include "heat.h"
#include <math.h>
#include <string.h>

/* Texts and lists of numbers are given by their places in TEXTS and NUMBERS. Pointers would need a relocation whenever
 * the library is loaded, and the table of these relocations would be as large as all other tables together. */
typedef struct { /* the allowed values of some variables */
    double min, max, smallest; /* of a number; smallest: the least magnitude but for 0 */
    bool zero; /* whether a number may be 0 */
    uint16_t choices; /* of an enumeration: how many members it has, then their numbers */
    uint16_t text; /* the same in words */
} Range;

typedef struct { /* in this sequence of members the table packs best */
    int16_t offset; /* in the model's memory; or TIME_OFFSET */
    uint16_t range; /* in RANGES */
    uint8_t modes; /* those in which it can be set */
    bool input;
    uint16_t role; /* such as "fixed parameter" */
    bool checked; /* a Real whose range each step checks */
    uint8_t kind; /* a Kind */
} Variable;

typedef struct {
    int32_t code; /* 0 in the last message of a list */
    uint16_t text;
    uint16_t variables; /* whose values the message contains: a list for find_listed_variable, which ends with -1 */
} Message;

/* When a code is logged: see `Report` in var.py. */
typedef enum { REPORT_CHANGES, REPORT_STEPS, REPORT_EPISODES } Report;

typedef struct {
    int16_t offset; /* in the model's memory; -1 in the last row */
    uint16_t group; /* of the variable that holds the code; empty if it is in none */
    uint16_t messages; /* where in MESSAGES the list of what its values mean starts */
    uint16_t episodes; /* where in a state the episodes of these messages start, if it has some */
    uint8_t report; /* a Report */
} Coded;

typedef struct {
    int64_t offset, most;
} Count;

#define TIME_OFFSET (-(int)sizeof(double)) /* of the time, where that is a variable: it is before the model's memory */
#include "model.h"

static const char *text_at(int index) { return TEXTS + index; }

enum { COUNT = sizeof VARIABLES / sizeof *VARIABLES };

/* TEXTS start with the names of the variables, in their sequence. */
COLD static const char *name_of(const Variable *v) {
    const char *name = TEXTS;
    for (ptrdiff_t n = v - VARIABLES; n; n--) name += strlen(name) + 1;
    return name;
}

/* The functions of block.c. Here a block is an array of bytes: block.h is not included, since it has the names of the
 * Python source, some of which mean other things here. The latter two return the refusal, and set `failed` where Python
 * would raise. */
typedef struct Block Block;
void block_start(Block *self);
int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed);

typedef union {
    double aligned;
    uint8_t bytes[MODEL_SIZE];
} Model;

typedef struct { /* how often a code has come since it was logged first */
    int64_t count; /* 0: it is not under way */
    double begin, end; /* the times after the first and the last step in which it was there */
    double first, worst; /* values of the first variable in its message */
} Episode;

typedef struct { /* no member leaves a gap, so that all bytes of a state are determined */
    char magic[8], guid[40];
    uint64_t size, checksum; /* the checksum is that of serialized bytes, otherwise 0 */
    int64_t mode;
    int64_t derivatives_given; /* bit n: the next step has a derivative of order n of the master's position */
    double derivatives[3]; /* by order; the first is unused */
    double stop, time; /* stop: INFINITY if there is none; the time comes last: TIME_OFFSET */
    Model model;
    Episode episodes[EPISODES + 1]; /* the last one is unused: no array of C is empty */
} State;

MUST_HOLD(the_time_is_before_the_model, offsetof(State, model) + TIME_OFFSET == offsetof(State, time));
MUST_HOLD(a_state_has_no_gaps,
          sizeof MODEL_GUID <= 40 && sizeof(State) == 8 + 40 + 9 * 8 + sizeof(Model) + (EPISODES + 1) * 40);

typedef struct { /* the inputs that a step replaces where derivatives of the master's position are given for it */
    double values[2]; /* the master's velocity and acceleration */
    int64_t mode;
} ReplacedInputs;

struct Instance {
    State now;
    int out_of_range; /* the number of checked Reals outside their ranges; a step needs 0 */
    int64_t codes[sizeof CODED / sizeof *CODED]; /* after the last step */
    int episodes; /* how many are under way */
    ReplacedInputs replaced_inputs; /* in a step */
    int logged_categories; /* a set of Category */
    Status refusal_status; /* what a refused step answers */
    Memory memory;
    LogFunction *log;
    void *importer[]; /* of the size given to instance_new, aligned for pointers */
};

/* --- one value --- */

static inline void *address_of(Instance *self, const Variable *v) {
    return (uint8_t *)&self->now + (offsetof(State, model) + v->offset);
}
static inline double *real_at(Instance *self, int variable) { return address_of(self, VARIABLES + variable); }
static inline int64_t *integer_at(Instance *self, int variable) { return address_of(self, VARIABLES + variable); }
static inline const void *value_at(const Instance *self, const Variable *v) { return address_of((Instance *)self, v); }

/* A value as a number; that of a Boolean is 0 or 1. */
COLD static double number_of(const Instance *self, const Variable *v) {
    switch (v->kind) {
    case REAL: return *(const double *)value_at(self, v);
    case BOOLEAN: return *(const uint8_t *)value_at(self, v);
    default: return (double)*(const int64_t *)value_at(self, v);
    }
}

#endif
