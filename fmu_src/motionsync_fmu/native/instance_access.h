/* Part of instance.c: getters and setters of values and derivatives. */
#ifndef INSTANCE_ACCESS_H
#define INSTANCE_ACCESS_H

/* --- values --- */

COLD static const char *kind_names(int kinds) {
    switch (kinds) {
    case REAL: return "Real";
    case INTEGER: return "Integer";
    case ENUMERATION: return "Enumeration";
    case BOOLEAN: return "Boolean";
    default: return "Integer or Enumeration";
    }
}

static inline bool is_of_kind(uint32_t r, int kinds) { return r < COUNT && kinds & VARIABLES[r].kind; }

COLD static bool refuse_reference(const Instance *self, uint32_t r, int kinds) {
    instance_report(self, STATUS_ERROR, "no %s has the value reference %d", kind_names(kinds), (int64_t)r);
    return false;
}

COLD static bool refuse_setting(const Instance *self, uint32_t r) {
    instance_report(self, STATUS_ERROR, "%s (%s) cannot be set now", name_of(VARIABLES + r),
                    text_at(VARIABLES[r].role));
    return false;
}

static inline bool can_get(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!check_mode(self, modes, call)) return false;
    if (n && !(r && values)) return instance_check_pointer(self, NULL, call);
    for (size_t i = 0; i < n; i++)
        if (!is_of_kind(r[i], kinds)) return refuse_reference(self, r[i], kinds);
    if (self->now.mode == INITIALIZING) update_outputs(self);
    return true;
}

static inline bool can_set(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!check_mode(self, modes, call)) return false;
    if (n && !(r && values)) return instance_check_pointer(self, NULL, call);
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], kinds)) return refuse_reference(self, r[i], kinds);
        if (!(VARIABLES[r[i]].modes & self->now.mode)) return refuse_setting(self, r[i]);
    }
    return true;
}

/* The same for the kinds that are got and set less often than Reals: one function for all of them. */
static bool can_get_others(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_get(self, modes, kinds, r, n, values, call);
}

static bool can_set_others(Instance *self, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_set(self, modes, kinds, r, n, values, call);
}

COLD static void set_out_of_range_real(Instance *self, const Variable *v, double x) {
    self->out_of_range -= is_out_of_range(self, v);
    *(double *)address_of(self, v) = x;
    self->out_of_range += is_out_of_range(self, v);
}

static inline void set_real(Instance *self, const Variable *v, double x) {
    const Range *range = range_of(v);
    bool fits = x >= range->min && x <= range->max && fabs(x) >= range->smallest; /* a zero may be allowed, too */
    if (fits && !self->out_of_range) *(double *)address_of(self, v) = x;
    else set_out_of_range_real(self, v, x);
}
static inline void set_integer(Instance *self, const Variable *v, int64_t x) { *(int64_t *)address_of(self, v) = x; }
static inline void set_boolean(Instance *self, const Variable *v, int32_t x) {
    *(uint8_t *)address_of(self, v) = x != 0;
}

/* A getter and a setter. PARAMETER: the parameter `kinds`, or nothing; Value and Stored: the type of the values for the
 * importer, and in the model's memory; `others`: the suffix of can_get and can_set. */
#define ACCESS(names, name, PARAMETER, kinds, Value, Stored, others)                                                   \
    Status instance_get_##names(Instance *self, int modes, PARAMETER const uint32_t r[], size_t n, Value values[],     \
                                const char *call) {                                                                    \
        if (!can_get##others(self, modes, kinds, r, n, values, call)) return STATUS_ERROR;                             \
        for (size_t i = 0; i < n; i++) values[i] = (Value) * (const Stored *)value_at(self, VARIABLES + r[i]);         \
        return STATUS_OK;                                                                                              \
    }                                                                                                                  \
    Status instance_set_##names(Instance *self, int modes, PARAMETER const uint32_t r[], size_t n,                     \
                                const Value values[], const char *call) {                                              \
        if (!can_set##others(self, modes, kinds, r, n, values, call)) return STATUS_ERROR;                             \
        for (size_t i = 0; i < n; i++) set_##name(self, VARIABLES + r[i], values[i]);                                  \
        return STATUS_OK;                                                                                              \
    }
#define KINDS int kinds,
ACCESS(reals, real, , REAL, double, double, )
ACCESS(integers, integer, KINDS, kinds, int32_t, int64_t, _others)
ACCESS(enumerations, integer, , ENUMERATION, int64_t, int64_t, _others)
ACCESS(booleans, boolean, , BOOLEAN, int32_t, uint8_t, _others)
ACCESS(flags, boolean, , BOOLEAN, bool, uint8_t, _others)

/* --- derivatives --- */

/* Whether derivatives can be set or got now, and the three lists are there. */
COLD static bool check_derivative_call(const Instance *self, int modes, const uint32_t r[], size_t n,
                                       const int32_t orders[], const double values[], const char *call) {
    if (!instance_check_mode(self, modes, call)) return false;
    return !n || (instance_check_pointer(self, r, call) && instance_check_pointer(self, orders, call) &&
                  instance_check_pointer(self, values, call));
}

COLD static bool check_input_derivatives(const Instance *self, const uint32_t r[], size_t n, const int32_t orders[],
                                         const char *call) {
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], REAL)) return refuse_reference(self, r[i], REAL);
        const Variable *v = VARIABLES + r[i];
        if (!v->input) {
            instance_report(self, STATUS_ERROR, "%s: %s (%s) is no input", call, name_of(v), text_at(v->role));
            return false;
        }
        if (orders[i] < 1) {
            instance_report(self, STATUS_ERROR, "%s: order = %d is not allowed: it must be >= 1", call,
                            (int64_t)orders[i]);
            return false;
        }
    }
    return true;
}

COLD Status instance_set_input_derivatives(Instance *self, int modes, const uint32_t r[], size_t n,
                                           const int32_t orders[], const double values[], const char *call) {
    if (!check_derivative_call(self, modes, r, n, orders, values, call)) return STATUS_ERROR;
    if (!check_input_derivatives(self, r, n, orders, call)) return STATUS_ERROR;
    bool ignored = false;
    for (size_t i = 0; i < n; i++) {
        if (takes_derivatives(self) && (int)r[i] == MASTER[0] && orders[i] <= 2) {
            self->now.derivatives[orders[i]] = values[i];
            self->now.derivatives_given |= 1 << orders[i];
        } else {
            ignored = true;
        }
    }
    if (!ignored) return STATUS_OK;
    return instance_report(
        self, STATUS_WARNING,
        "%s: ignored but for orders 1 and 2 of the master's position where it is the one at the step's start", call);
}

COLD Status instance_get_output_derivatives(Instance *self, int modes, const uint32_t r[], size_t n,
                                            const int32_t orders[], double values[], const char *call) {
    if (!check_derivative_call(self, modes, r, n, orders, values, call)) return STATUS_ERROR;
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], REAL)) return refuse_reference(self, r[i], REAL), STATUS_ERROR;
        if ((int)r[i] != SLAVE[0] || orders[i] < 1 || orders[i] > 2)
            return instance_report(self, STATUS_ERROR, "%s: only orders 1 and 2 of the slave's position are available",
                                   call);
    }
    for (size_t i = 0; i < n; i++) values[i] = *real_at(self, SLAVE[orders[i]]);
    return STATUS_OK;
}

#endif
