/* Part of instance.c: FMU states. */
#ifndef INSTANCE_STATES_H
#define INSTANCE_STATES_H

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

COLD static bool is_own_state(const Instance *self, const void *state, const char *call) {
    if (!instance_check_pointer(self, state, call)) return false;
    bool same = !memcmp(state, &self->now, offsetof(State, checksum)); /* magic, GUID and size */
    if (!same) instance_report(self, STATUS_ERROR, "%s: this FMU state belongs to another FMU", call);
    return same;
}

COLD static State *new_state(const Instance *self, const char *call) {
    State *copy = self->memory.allocate(1, sizeof *copy);
    if (!copy) instance_report(self, STATUS_ERROR, "%s: out of memory", call);
    return copy;
}

COLD Status instance_save(const Instance *self, void **state, const char *call) {
    if (!instance_check_pointer(self, state, call) || (*state && !is_own_state(self, *state, call)))
        return STATUS_ERROR;
    if (!*state && !(*state = new_state(self, call))) return STATUS_ERROR;
    memcpy(*state, &self->now, sizeof(State));
    return STATUS_OK;
}

COLD Status instance_restore(Instance *self, const void *state, const char *call) {
    if (!is_own_state(self, state, call)) return STATUS_ERROR;
    memcpy(&self->now, state, sizeof(State));
    update_caches(self);
    return STATUS_OK;
}

COLD Status instance_free_state(const Instance *self, void **state, const char *call) {
    if (!self) return STATUS_ERROR;
    if (!state || !*state) return STATUS_OK; /* the standard: nothing to do */
    if (!is_own_state(self, *state, call)) return STATUS_ERROR;
    self->memory.release(*state);
    *state = NULL;
    return STATUS_OK;
}

COLD Status instance_serialized_size(const Instance *self, const void *state, size_t *n, const char *call) {
    if (!is_own_state(self, state, call) || !instance_check_pointer(self, n, call)) return STATUS_ERROR;
    *n = sizeof(State);
    return STATUS_OK;
}

COLD Status instance_serialize(const Instance *self, const void *state, uint8_t bytes[], size_t n, const char *call) {
    if (!is_own_state(self, state, call) || !instance_check_pointer(self, bytes, call)) return STATUS_ERROR;
    if (n < sizeof(State))
        return instance_report(self, STATUS_ERROR, "%s: there must be at least %d bytes", call, (int64_t)sizeof(State));
    memcpy(bytes, state, sizeof(State));
    uint64_t sum = checksum(bytes);
    memcpy(bytes + offsetof(State, checksum), &sum, sizeof sum);
    return STATUS_OK;
}

#define LARGEST_INTEGER ((int64_t)1 << 60) /* sums of a few integers do not overflow; no block counts so far */

static int64_t whole_at(const uint8_t *bytes) {
    int64_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

/* Whether Booleans, integers and counts, on which branches, sums and loops rely, have values that the block can give
 * them. */
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

/* Whether this instance can have made a state. Its checksum does not prove that: a forged state may have a correct one.
 */
COLD static bool is_valid_state(const State *s) {
    int64_t derivatives = has_derivatives() ? 1 << 1 | 1 << 2 : 0;
    bool is_mode = s->mode == INSTANTIATED || s->mode == INITIALIZING || s->mode == STEPPING || s->mode == TERMINATED;
    return is_mode && !(s->derivatives_given & ~derivatives) && is_finite(s->time) && s->stop == s->stop &&
           has_valid_flags_and_counts(&s->model);
}

COLD Status instance_deserialize(const Instance *self, const uint8_t bytes[], size_t n, void **state,
                                 const char *call) {
    if (!instance_check_pointer(self, bytes, call) || !instance_check_pointer(self, state, call)) return STATUS_ERROR;
    if (n != sizeof(State))
        return instance_report(self, STATUS_ERROR, "%s: an FMU state of this unit has %d bytes", call,
                               (int64_t)sizeof(State));
    if (!is_own_state(self, bytes, call)) return STATUS_ERROR;
    uint64_t sum;
    memcpy(&sum, bytes + offsetof(State, checksum), sizeof sum);
    if (sum != checksum(bytes)) return instance_report(self, STATUS_ERROR, "%s: this FMU state is damaged", call);
    State *copy = new_state(self, call);
    if (!copy) return STATUS_ERROR;
    memcpy(copy, bytes, sizeof *copy);
    copy->checksum = 0;
    if (!is_valid_state(copy)) {
        self->memory.release(copy);
        return instance_report(self, STATUS_ERROR, "%s: this FMU state is none that this unit makes", call);
    }
    *state = copy;
    return STATUS_OK;
}

#endif
