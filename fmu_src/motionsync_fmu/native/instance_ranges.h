/* Part of instance.c: which values a variable may have. A setter takes any; the initialization and each step refuse
 * those that are out of range. */
#ifndef INSTANCE_RANGES_H
#define INSTANCE_RANGES_H

#include <float.h>

static inline bool is_finite(double x) { return fabs(x) <= DBL_MAX; }

static inline const Range *range_of(const Variable *v) { return RANGES + v->range; }

/* Whether a number is in its variable's range; NaN fails every comparison. */
static inline bool is_in_range(const Variable *v, double x) {
    const Range *range = range_of(v);
    return (x >= range->min) & (x <= range->max) & ((fabs(x) >= range->smallest) | ((x == 0.0) & range->zero));
}

COLD static bool has_allowed_value(const Instance *self, const Variable *v) {
    if (v->kind == BOOLEAN) return true;
    if (v->kind != ENUMERATION) return is_in_range(v, number_of(self, v));
    const int16_t *choices = NUMBERS + range_of(v)->choices;
    for (int i = 1; i <= choices[0]; i++)
        if (choices[i] == *(const int64_t *)value_at(self, v)) return true;
    return false;
}

/* Whether a variable has an allowed value; if not, that is logged with this status. */
COLD static bool check_range(const Instance *self, const Variable *v, Status status) {
    if (has_allowed_value(self, v)) return true;
    const char *hint = v->input && number_of(self, v) == 0.0 ? "; an unwired input gives 0" : "";
    instance_report(self, status, "%v is not allowed: it must be %s%s", v, text_at(range_of(v)->text), hint);
    return false;
}

#endif
