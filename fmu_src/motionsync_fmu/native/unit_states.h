/* Part of unit.c: FMU states. */
#ifndef UNIT_STATES_H
#define UNIT_STATES_H

/* FNV-1a by words: any change within one word changes the sum. The checksum itself counts as 0. */
static uint64_t checksum(const uint8_t *state) {
    uint64_t sum = 14695981039346656037u;
    for (size_t i = 0; i < sizeof(State); i += sizeof sum) {
        uint64_t word = 0;
        if (i != offsetof(State, checksum)) memcpy(&word, state + i, sizeof word);
        sum = (sum ^ word) * 1099511628211u;
        sum ^= sum >> 32;
    }
    return sum;
}

COLD static bool is_own_state(const Unit *u, const void *state, const char *call) {
    if (!unit_check_pointer(u, state, call)) return false;
    bool same = !memcmp(state, &u->now, offsetof(State, checksum)); /* magic, GUID and size */
    if (!same) unit_report(u, UNIT_ERROR, "%s: this FMU state belongs to another FMU", call);
    return same;
}

COLD static State *new_state(const Unit *u, const char *call) {
    State *copy = u->memory.allocate(1, sizeof *copy);
    if (!copy) unit_report(u, UNIT_ERROR, "%s: out of memory", call);
    return copy;
}

COLD Status unit_save(const Unit *u, void **state, const char *call) {
    if (!unit_check_pointer(u, state, call) || (*state && !is_own_state(u, *state, call))) return UNIT_ERROR;
    if (!*state && !(*state = new_state(u, call))) return UNIT_ERROR;
    memcpy(*state, &u->now, sizeof(State));
    return UNIT_OK;
}

COLD Status unit_restore(Unit *u, const void *state, const char *call) {
    if (!is_own_state(u, state, call)) return UNIT_ERROR;
    memcpy(&u->now, state, sizeof(State));
    update_caches(u);
    return UNIT_OK;
}

COLD Status unit_free_state(const Unit *u, void **state, const char *call) {
    if (!u) return UNIT_ERROR;
    if (!state || !*state) return UNIT_OK; /* the standard: nothing to do */
    if (!is_own_state(u, *state, call)) return UNIT_ERROR;
    u->memory.release(*state);
    *state = NULL;
    return UNIT_OK;
}

COLD Status unit_serialized_size(const Unit *u, const void *state, size_t *n, const char *call) {
    if (!is_own_state(u, state, call) || !unit_check_pointer(u, n, call)) return UNIT_ERROR;
    *n = sizeof(State);
    return UNIT_OK;
}

COLD Status unit_serialize(const Unit *u, const void *state, uint8_t bytes[], size_t n, const char *call) {
    if (!is_own_state(u, state, call) || !unit_check_pointer(u, bytes, call)) return UNIT_ERROR;
    if (n < sizeof(State))
        return unit_report(u, UNIT_ERROR, "%s: there must be at least %d bytes", call, (int64_t)sizeof(State));
    memcpy(bytes, state, sizeof(State));
    uint64_t sum = checksum(bytes);
    memcpy(bytes + offsetof(State, checksum), &sum, sizeof sum);
    return UNIT_OK;
}

#define LARGEST_INTEGER ((int64_t)1 << 60) /* sums of a few integers do not overflow; no block counts so far */

static int64_t whole_at(const uint8_t *bytes) {
    int64_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

/* Whether Booleans, integers and counts, on which branches, sums and loops rely, have values that the block can give them. */
COLD static bool has_valid_flags_and_counts(const Model *model) {
    const uint8_t *flag = model->bytes - 1, *integer = model->bytes - 1;
    for (const uint16_t *distance = FLAGS; *distance; distance++)
        if (*(flag += *distance) > 1) return false;
    for (const uint16_t *distance = INTEGERS; *distance; distance++) {
        int64_t value = whole_at(integer += *distance);
        if (value < -LARGEST_INTEGER || value > LARGEST_INTEGER) return false;
    }
    for (const Count *count = COUNTS; count->offset >= 0; count++) {
        int64_t value = whole_at(model->bytes + count->offset);
        if (value < 0 || value > count->most) return false;
    }
    return true;
}

/* Whether this unit can have made a state. Its checksum does not prove that: a forged state may have a correct one. */
COLD static bool is_valid_state(const State *s) {
    int64_t derivatives = has_derivatives() ? 1 << 1 | 1 << 2 : 0;
    bool is_mode = s->mode == INSTANTIATED || s->mode == INITIALIZING || s->mode == STEPPING || s->mode == TERMINATED;
    return is_mode && !(s->derivatives_given & ~derivatives) && is_finite(s->time) && s->stop == s->stop &&
           has_valid_flags_and_counts(&s->model);
}

COLD Status unit_deserialize(const Unit *u, const uint8_t bytes[], size_t n, void **state, const char *call) {
    if (!unit_check_pointer(u, bytes, call) || !unit_check_pointer(u, state, call)) return UNIT_ERROR;
    if (n != sizeof(State))
        return unit_report(u, UNIT_ERROR, "%s: an FMU state of this unit has %d bytes", call, (int64_t)sizeof(State));
    if (!is_own_state(u, bytes, call)) return UNIT_ERROR;
    uint64_t sum;
    memcpy(&sum, bytes + offsetof(State, checksum), sizeof sum);
    if (sum != checksum(bytes)) return unit_report(u, UNIT_ERROR, "%s: this FMU state is damaged", call);
    State *copy = new_state(u, call);
    if (!copy) return UNIT_ERROR;
    memcpy(copy, bytes, sizeof *copy);
    copy->checksum = 0;
    if (!is_valid_state(copy)) {
        u->memory.release(copy);
        return unit_report(u, UNIT_ERROR, "%s: this FMU state is none that this unit makes", call);
    }
    *state = copy;
    return UNIT_OK;
}

#endif
