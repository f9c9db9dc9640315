/* What the C of this folder shares: the two functions of block.c, and how memory is reached by its address.
 *
 * causes.h, which library.py writes, has CAUSE_NONE and so on: the numbers of plan.py's Cause. */
#ifndef LOOP_H
#define LOOP_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "causes.h"

/* Both functions return the refusal, and set `failed` where Python would raise. */
typedef struct Block Block;
int64_t block_initialize(Block *self, bool *failed);
int64_t block_step(Block *self, double h, bool *failed);

#define AT(Type, address) (*(Type *)(intptr_t)(address))

typedef struct { /* what a Real is allowed to be; `zero`: 1 if it may be 0, else 0 */
    double least, greatest, smallest, zero;
} Limit;

static inline bool allows(const Limit *limit, double x) { /* NaN fails every comparison */
    bool sized = fabs(x) >= limit->smallest || (x == 0.0 && limit->zero != 0.0);
    return limit->least <= x && x <= limit->greatest && sized;
}

#endif
