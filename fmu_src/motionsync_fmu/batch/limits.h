/* Which values of a Real are allowed. */
#ifndef LIMITS_H
#define LIMITS_H

#include <math.h>
#include <stdbool.h>

typedef struct { /* `smallest`: magnitude of a value other than 0; `zero`: 1 if 0 is allowed, else 0 */
    double least, greatest, smallest, zero;
} Limit;

static inline bool allows(const Limit *limit, double x) { /* NaN fails every comparison */
    const bool is_large_enough = fabs(x) >= limit->smallest || (x == 0.0 && limit->zero != 0.0);
    return limit->least <= x && x <= limit->greatest && is_large_enough;
}

#endif
