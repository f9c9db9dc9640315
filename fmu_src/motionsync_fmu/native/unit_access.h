/* Part of unit.c: getters and setters of values and derivatives. */
#ifndef UNIT_ACCESS_H
#define UNIT_ACCESS_H

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

COLD static bool refuse_reference(const Unit *u, uint32_t r, int kinds) {
    unit_report(u, UNIT_ERROR, "no %s has the value reference %d", kind_names(kinds), (int64_t)r);
    return false;
}

COLD static bool refuse_setting(const Unit *u, uint32_t r) {
    unit_report(u, UNIT_ERROR, "%s (%s) cannot be set now", name_of(VARIABLES + r), text_at(VARIABLES[r].role));
    return false;
}

static inline bool can_get(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!check_mode(u, modes, call)) return false;
    if (n && !(r && values)) return unit_check_pointer(u, NULL, call);
    for (size_t i = 0; i < n; i++)
        if (!is_of_kind(r[i], kinds)) return refuse_reference(u, r[i], kinds);
    if (u->now.mode == INITIALIZING) update_outputs(u);
    return true;
}

static inline bool can_set(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                        const char *call) {
    if (!check_mode(u, modes, call)) return false;
    if (n && !(r && values)) return unit_check_pointer(u, NULL, call);
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], kinds)) return refuse_reference(u, r[i], kinds);
        if (!(VARIABLES[r[i]].modes & u->now.mode)) return refuse_setting(u, r[i]);
    }
    return true;
}

/* The same for the kinds that are got and set less often than Reals: one function for all of them. */
static bool can_get_others(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_get(u, modes, kinds, r, n, values, call);
}

static bool can_set_others(Unit *u, int modes, int kinds, const uint32_t r[], size_t n, const void *values,
                           const char *call) {
    return can_set(u, modes, kinds, r, n, values, call);
}

COLD static void set_out_of_range_real(Unit *u, const Variable *v, double x) {
    u->out_of_range -= is_out_of_range(u, v);
    *(double *)address_of(u, v) = x;
    u->out_of_range += is_out_of_range(u, v);
}

static inline void set_real(Unit *u, const Variable *v, double x) {
    const Range *range = range_of(v);
    bool fits = x >= range->min && x <= range->max && fabs(x) >= range->smallest; /* a zero may be allowed, too */
    if (fits && !u->out_of_range) *(double *)address_of(u, v) = x;
    else set_out_of_range_real(u, v, x);
}
static inline void set_integer(Unit *u, const Variable *v, int64_t x) { *(int64_t *)address_of(u, v) = x; }
static inline void set_boolean(Unit *u, const Variable *v, int32_t x) { *(uint8_t *)address_of(u, v) = x != 0; }

/* A getter and a setter. PARAMETER: the parameter `kinds`, or nothing; Value and Stored: the type of the values for the
 * importer, and in the model's memory; `others`: the suffix of can_get and can_set. */
#define ACCESS(names, name, PARAMETER, kinds, Value, Stored, others)                                             \
    Status unit_get_##names(Unit *u, int modes, PARAMETER const uint32_t r[], size_t n, Value values[],        \
                            const char *call) {                                                              \
        if (!can_get##others(u, modes, kinds, r, n, values, call)) return UNIT_ERROR;                        \
        for (size_t i = 0; i < n; i++) values[i] = (Value)*(const Stored *)value_at(u, VARIABLES + r[i]);          \
        return UNIT_OK;                                                                                      \
    }                                                                                                        \
    Status unit_set_##names(Unit *u, int modes, PARAMETER const uint32_t r[], size_t n, const Value values[],  \
                            const char *call) {                                                              \
        if (!can_set##others(u, modes, kinds, r, n, values, call)) return UNIT_ERROR;                        \
        for (size_t i = 0; i < n; i++) set_##name(u, VARIABLES + r[i], values[i]);                           \
        return UNIT_OK;                                                                                      \
    }
#define KINDS int kinds,
ACCESS(reals, real, , REAL, double, double, )
ACCESS(integers, integer, KINDS, kinds, int32_t, int64_t, _others)
ACCESS(enumerations, integer, , ENUMERATION, int64_t, int64_t, _others)
ACCESS(booleans, boolean, , BOOLEAN, int32_t, uint8_t, _others)
ACCESS(flags, boolean, , BOOLEAN, bool, uint8_t, _others)

/* --- derivatives --- */

/* Whether derivatives can be set or got now, and the three lists are there. */
COLD static bool check_derivative_call(const Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                            const double values[], const char *call) {
    if (!unit_check_mode(u, modes, call)) return false;
    return !n || (unit_check_pointer(u, r, call) && unit_check_pointer(u, orders, call) &&
                  unit_check_pointer(u, values, call));
}

COLD static bool check_input_derivatives(const Unit *u, const uint32_t r[], size_t n, const int32_t orders[],
                                         const char *call) {
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], REAL)) return refuse_reference(u, r[i], REAL);
        const Variable *v = VARIABLES + r[i];
        if (!v->input) {
            unit_report(u, UNIT_ERROR, "%s: %s (%s) is no input", call, name_of(v), text_at(v->role));
            return false;
        }
        if (orders[i] < 1) {
            unit_report(u, UNIT_ERROR, "%s: order = %d is not allowed: it must be >= 1", call, (int64_t)orders[i]);
            return false;
        }
    }
    return true;
}

COLD Status unit_set_input_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                       const double values[], const char *call) {
    if (!check_derivative_call(u, modes, r, n, orders, values, call)) return UNIT_ERROR;
    if (!check_input_derivatives(u, r, n, orders, call)) return UNIT_ERROR;
    bool ignored = false;
    for (size_t i = 0; i < n; i++) {
        if (takes_derivatives(u) && (int)r[i] == MASTER[0] && orders[i] <= 2) {
            u->now.derivatives[orders[i]] = values[i];
            u->now.derivatives_given |= 1 << orders[i];
        } else {
            ignored = true;
        }
    }
    if (!ignored) return UNIT_OK;
    return unit_report(u, UNIT_WARNING,
                    "%s: ignored but for orders 1 and 2 of the master's position where it is the one at the step's start",
                    call);
}

COLD Status unit_get_output_derivatives(Unit *u, int modes, const uint32_t r[], size_t n, const int32_t orders[],
                                        double values[], const char *call) {
    if (!check_derivative_call(u, modes, r, n, orders, values, call)) return UNIT_ERROR;
    for (size_t i = 0; i < n; i++) {
        if (!is_of_kind(r[i], REAL)) return refuse_reference(u, r[i], REAL), UNIT_ERROR;
        if ((int)r[i] != SLAVE[0] || orders[i] < 1 || orders[i] > 2)
            return unit_report(u, UNIT_ERROR, "%s: only orders 1 and 2 of the slave's position are available", call);
    }
    for (size_t i = 0; i < n; i++) values[i] = *real_at(u, SLAVE[orders[i]]);
    return UNIT_OK;
}

#endif
