/* Part of fuzz.h: calls that get, set, serialize and forge FMU states. */
/* --- copies of states, which come from any instance and are restored in any --- */

static StoredState *random_stored_state(void) { return stored_states + below(STATES); }

static void get_fmu_state(Slot *s) {
    StoredState *k = random_stored_state();
    if (passes_null()) {
        check_call(s, GetFMUstate, FMI(GetFMUstate)(start_call(s), NULL), ERROR, false);
        return;
    }
    memory_is_out = one_in(30);
    int expected = status_if(is_in(s, ANY) && !(memory_is_out && !k->state));
    Answer status = FMI(GetFMUstate)(start_call(s), &k->state);
    memory_is_out = false;
    if (!check_call(s, GetFMUstate, status, expected, false)) k->expected = s->expected;
}

static void set_fmu_state(Slot *s) {
    StoredState *k = random_stored_state();
    int expected = status_if(is_in(s, ANY) && k->state);
    if (!check_call(s, SetFMUstate, FMI(SetFMUstate)(start_call(s), k->state), expected, true)) s->expected = k->expected;
}

static void free_fmu_state(Slot *s) {
    StoredState *k = random_stored_state();
    if (passes_null()) {
        check_call(s, FreeFMUstate, FMI(FreeFMUstate)(start_call(s), NULL), status_if(is_in(s, ANY)), false);
        return;
    }
    check_call(s, FreeFMUstate, FMI(FreeFMUstate)(start_call(s), &k->state), status_if(is_in(s, ANY)), false);
    if (s->unit && k->state) fail("a freed state's pointer is not NULL");
}

/* A state of another unit: as long as one of this unit, and only the host frees it. */
static void foreign_fmu_state(Slot *s) {
    Byte *bytes = malloc(size), out[BYTES];
    memcpy(bytes, twin.bytes, size);
    bytes[below(48)] ^= (Byte)(1 << below(8)); /* in what a unit is recognized by */
    FmuState foreign = bytes;
    size_t n;
    switch (below(5)) {
    case 0: check_call(s, SetFMUstate, FMI(SetFMUstate)(start_call(s), foreign), ERROR, false); break;
    case 1: check_call(s, GetFMUstate, FMI(GetFMUstate)(start_call(s), &foreign), ERROR, false); break;
    case 2: check_call(s, FreeFMUstate, FMI(FreeFMUstate)(start_call(s), &foreign), ERROR, false); break;
    case 3:
        check_call(s, SerializedFMUstateSize, FMI(SerializedFMUstateSize)(start_call(s), foreign, &n), ERROR, false);
        break;
    default:
        check_call(s, SerializeFMUstate, FMI(SerializeFMUstate)(start_call(s), foreign, out, size), ERROR, false);
    }
    if (foreign != bytes) fail("a foreign state's pointer was changed");
    free(bytes);
}

static void serialized_fmu_state_size(Slot *s) {
    StoredState *k = random_stored_state();
    size_t state_size = 0, *n = passes_null() ? NULL : &state_size;
    Answer status = FMI(SerializedFMUstateSize)(start_call(s), k->state, n);
    check_call(s, SerializedFMUstateSize, status, status_if(is_in(s, ANY) && k->state && n), false);
    if (!status && state_size != size) fail("the size of a state has changed");
}

static void serialize_fmu_state(Slot *s) {
    StoredState *k = random_stored_state();
    size_t n = one_in(4) ? below(size) : size + (one_in(4) ? below(100) : 0);
    Byte *bytes = allocate_exactly(n, 1);
    int expected = status_if(is_in(s, ANY) && k->state && bytes && n >= size);
    check_call(s, SerializeFMUstate, FMI(SerializeFMUstate)(start_call(s), k->state, bytes, n), expected, false);
    free(bytes);
}

/* Bytes of a state, whole or in one of the ways in which files and wires spoil them: whether they are still good. */
static bool damage_bytes(Byte *bytes, size_t n) {
    Byte whole[BYTES];
    memcpy(whole, bytes, n);
    switch (below(8)) {
    case 0: /* a few bits */
        for (size_t i = 1 + below(4); i; i--) bytes[below(n)] ^= (Byte)(1 << below(8));
        break;
    case 1: /* a few bytes */
        for (size_t i = 1 + below(20); i; i--) bytes[below(n)] = (Byte)random_bits();
        break;
    case 2: /* everything */
        for (size_t i = 0; i < n; i++) bytes[i] = (Byte)random_bits();
        break;
    case 3: /* two parts in the wrong order */
        memmove(bytes, bytes + n / 2, n / 2);
        break;
    default: break;
    }
    return memcmp(whole, bytes, n);
}

static void deserialize_fmu_state(Slot *s) {
    StoredState *from = random_stored_state(), *to = random_stored_state();
    size_t n = one_in(10) ? below(size) : size + (one_in(10) ? 1 + below(100) : 0);
    Byte *bytes = allocate_exactly(n, 1);
    bool is_valid = is_in(s, ANY) && bytes && n == size && from->state;
    if (bytes) memset(bytes, 0, n);
    if (s->unit && bytes && n == size && from->state) {
        if (FMI(SerializeFMUstate)(s->unit, from->state, bytes, n)) fail("a state cannot be serialized");
        if (damage_bytes(bytes, n)) is_valid = false, met[damaged]++;
    }
    ExpectedState expected = from->expected;
    FmuState new_state = NULL, *destination = passes_null() ? NULL : &new_state;
    memory_is_out = one_in(30);
    is_valid = is_valid && destination && !memory_is_out;
    Answer status = FMI(DeSerializeFMUstate)(start_call(s), bytes, n, destination);
    memory_is_out = false;
    check_call(s, DeSerializeFMUstate, status, status_if(is_valid), false);
    if (!status != !!new_state) fail("deserialized: status and pointer disagree");
    if (new_state) {
        if (to->state && FMI(FreeFMUstate)(s->unit, &to->state)) fail("an FMU state cannot be freed");
        to->state = new_state;
        to->expected = expected;
    }
    free(bytes);
}

/* --- forged states: with the right checksum, but of nothing that the unit has ever been --- */

enum { CHECKSUM = 56, FORGEABLE = 64, MEMORY = 120 }; /* offsets in a serialized state; the block's memory is last */

/* As in instance_states.h: FNV-1a by words, each mixed; the checksum itself counts as 0. */
static void set_checksum(Byte *bytes) {
    uint64_t sum = 14695981039346656037u, word;
    memset(bytes + CHECKSUM, 0, sizeof sum);
    for (size_t i = 0; i < size; i += sizeof word) {
        memcpy(&word, bytes + i, sizeof word);
        sum = (sum ^ word) * 1099511628211u;
        sum ^= sum >> 32;
    }
    memcpy(bytes + CHECKSUM, &sum, sizeof sum);
}

enum { WHOLE = sizeof INTEGERS / sizeof *INTEGERS - 1 };

/* An integer that is small, has any number of bits, or is the least or the greatest: sums of such ones could overflow. */
static Value random_whole(void) {
    if (one_in(2)) return of_integer((int)below(80) - 8);
    int64_t whole = one_in(2) ? INT64_MAX : (int64_t)(random_bits() >> (1 + below(63)));
    return (Value){.integer = one_in(2) ? whole : -whole - 1};
}

static Value random_word(size_t at) {
    for (const int *whole = INTEGERS; *whole >= 0; whole++)
        if (at == MEMORY + (size_t)*whole) return random_whole();
    return one_in(4) ? (Value){.bits = random_bits()} : of_real(random_real());
}

/* The twin takes such a state over, and steps: it may answer what it likes, but in time and within its memory. */
static void forge_state(Slot *s) {
    Byte *bytes = malloc(size);
    memcpy(bytes, s->bytes, size);
    for (size_t i = 1 + below(4); i; i--) {
        size_t any = FORGEABLE + 8 * below((size - FORGEABLE) / 8);
        size_t at = one_in(2) ? MEMORY + (size_t)INTEGERS[below(WHOLE)] : any;
        Value word = random_word(at);
        memcpy(bytes + at, &word, one_in(3) ? 1 + below(4) : 8);
    }
    set_checksum(bytes);
    FmuState new_state = NULL;
    Answer status = FMI(DeSerializeFMUstate)(start_call(s), bytes, size, &new_state);
    check_call(s, DeSerializeFMUstate, status, EITHER, false);
    free(bytes);
    if (s->unit) met[status ? forged_refused : forged_accepted]++;
    if (status) return;
    if (FMI(SetFMUstate)(start_call(&twin), new_state)) fail("a state that was accepted cannot be restored");
    for (int i = 0; i < 3; i++)
        if (!FMI(DoStep)(twin.unit, s->expected.time, random_step(), false)) met[forged_step]++;
    if (FMI(Reset)(twin.unit) || FMI(FreeFMUstate)(twin.unit, &new_state)) fail("a forged state cannot be left");
}
