/* Part of fuzz.h: calls that get and set values, and get derivatives. */
/* --- getters and setters --- */

static bool are_valid_references(const Slot *s, const Reference *r, size_t n, Kind kind, bool to_set) {
    for (size_t i = 0; i < n; i++) {
        if (TIME_IS_A_VARIABLE && r[i] == COUNT && kind == REAL && !to_set) continue;
        if (r[i] >= COUNT || VARIABLES[r[i]].kind != kind) return false;
        Access access = VARIABLES[r[i]].access;
        if (to_set && (access == OUTPUT || (access == FIXED && is_in(s, STEPPING)))) return false;
    }
    return true;
}

static int expected_of_get(const Slot *s, const Reference *r, size_t n, const void *values, Kind kind) {
    bool mode_allows = is_in(s, INITIALIZING | STEPPING | TERMINATED);
    return status_if(mode_allows && (!n || (r && values && are_valid_references(s, r, n, kind, false))));
}
static int expected_of_set(const Slot *s, const Reference *r, size_t n, const void *values, Kind kind) {
    bool mode_allows = is_in(s, INSTANTIATED | INITIALIZING | STEPPING);
    return status_if(mode_allows && (!n || (r && values && are_valid_references(s, r, n, kind, true))));
}

/* An input or parameter has the value that was set; an output is finite. */
static void check_value(const Slot *s, Reference r, Value got) {
    if (r == COUNT) { /* the time */
        if (got.real != s->expected.time) fail("the time is %g, not %g", got.real, s->expected.time);
        return;
    }
    const Variable *v = VARIABLES + r;
    Value set_value = s->expected.values[r];
    if (v->access != OUTPUT && got.bits != set_value.bits) fail("variable %u is not what it was set to", r);
    if (v->access == OUTPUT && v->kind == REAL && !isfinite(got.real)) fail("variable %u is not finite", r);
}

#define GET_AND_SET(Type, T, C, KIND, RANDOM)                                                       \
    static void get_##T(Slot *s) {                                                                  \
        size_t n = random_count();                                                                  \
        Reference *r = random_references(n, KIND, false);                                           \
        C *values = allocate_exactly(n, sizeof *values);                                            \
        bool initializing = is_in(s, INITIALIZING); /* outputs follow the inputs then */            \
        int expected = expected_of_get(s, r, n, values, KIND);                                      \
        Answer status = FMI(Get##Type)(start_call(s), r, n, values);                                \
        if (!check_call(s, Get##Type, status, expected, initializing))                              \
            for (size_t i = 0; i < n; i++) check_value(s, r[i], of_##T(values[i]));                 \
        free(r), free(values);                                                                      \
    }                                                                                               \
    static void set_##T(Slot *s) {                                                                  \
        size_t n = random_count();                                                                  \
        Reference *r = random_references(n, KIND, !one_in(20));                                     \
        C *values = allocate_exactly(n, sizeof *values);                                            \
        for (size_t i = 0; values && i < n; i++) values[i] = RANDOM;                                \
        int expected = expected_of_set(s, r, n, values, KIND);                                      \
        if (!check_call(s, Set##Type, FMI(Set##Type)(start_call(s), r, n, values), expected, true)) \
            for (size_t i = 0; i < n; i++) s->expected.values[r[i]] = of_##T(values[i]);            \
        free(r), free(values);                                                                      \
    }
GET_AND_SET(Real, real, double, REAL, random_real())
GET_AND_SET(Integer, integer, int32_t, INTEGER, random_integer())
GET_AND_SET(Boolean, boolean, Boolean, BOOLEAN, random_integer())

static void get_string(Slot *s) {
    size_t n = one_in(2) ? 0 : random_count();
    Reference *r = random_references(n, STRING, false);
    const char **values = allocate_exactly(n, sizeof *values);
    int expected = expected_of_get(s, r, n, values, STRING);
    bool initializing = is_in(s, INITIALIZING);
    check_call(s, GetString, FMI(GetString)(start_call(s), r, n, values), expected, initializing);
    free(r), free(values);
}
static void set_string(Slot *s) {
    size_t n = one_in(2) ? 0 : random_count();
    Reference *r = random_references(n, STRING, true);
    const char **values = allocate_exactly(n, sizeof *values);
    for (size_t i = 0; values && i < n; i++) values[i] = one_in(4) ? NULL : "text";
    int expected = expected_of_set(s, r, n, values, STRING);
    check_call(s, SetString, FMI(SetString)(start_call(s), r, n, values), expected, false);
    free(r), free(values);
}

/* --- derivatives --- */

static int32_t *random_orders(size_t n) {
    int32_t *order = allocate_exactly(n, sizeof *order);
    for (size_t i = 0; order && i < n; i++) order[i] = one_in(20) ? random_integer() : 1 + (int32_t)below(2);
    return order;
}

static void get_real_output_derivatives(Slot *s) {
    size_t n = below(4);
    Reference *r = random_references(n, REAL, false);
    int32_t *order = random_orders(n);
    double *values = allocate_exactly(n, sizeof *values);
    bool is_valid = is_in(s, STEPPING | TERMINATED) && (!n || (r && order && values));
    for (size_t i = 0; is_valid && i < n; i++) {
        if (!one_in(8)) r[i] = SLAVE[0];
        if (SLAVE[0] >= COUNT || r[i] != SLAVE[0] || order[i] < 1 || order[i] > 2) is_valid = false;
    }
    Answer status = FMI(GetRealOutputDerivatives)(start_call(s), r, n, order, values);
    check_call(s, GetRealOutputDerivatives, status, status_if(is_valid), false);
    for (size_t i = 0; !status && i < n; i++) {
        double value;
        if (FMI(GetReal)(s->unit, SLAVE + order[i], 1, &value) || value != values[i])
            fail("derivative %d of the slave's position is not the variable", order[i]);
    }
    free(r), free(order), free(values);
}
