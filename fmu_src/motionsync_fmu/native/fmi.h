/* What the functions of FMI 2.0 and FMI 3.0 share. fmi2.c and fmi3.c define before they include this, once:
 *
 *   Answer               the standard's type of a status, which has the numbers of the core's
 *   Logger, Environment  the importer's function for messages, and what it is given back with each
 *   DISCARDED            the log category of a message with the status discard
 *   CATEGORIES           the names of all log categories, for a message
 *
 * and afterwards log_to, which hands a message to the importer. */
#include <string.h>
#include "unit.h"

#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* the standard has them, and some mean nothing to these units */
#endif

typedef struct { /* what these functions keep with each unit */
    Logger logger;
    Environment environment;
    char name[];
} Importer;

static Write log_to;

/* The log categories by status, from UNIT_WARNING on. */
static const char *category(int i) {
    return i == 0 ? "logStatusWarning" : i == 1 ? DISCARDED : "logStatusError";
}

enum {
    SETTABLE = INSTANTIATED | INITIALIZING | STEPPING,
    READABLE = INITIALIZING | STEPPING | TERMINATED,
    STEPPED = STEPPING | TERMINATED
};

/* The function ends with the status of this call of the core. */
#define ANSWER(status) return (Answer)(status)

/* The function ends with an error unless the unit is in one of these modes. */
#define ONLY_WHEN(modes) \
    if (!unit_may(c, modes, __func__)) ANSWER(UNIT_ERROR)

/* A unit with this name and GUID; NULL, and an error is logged, if something is wrong. `wrong`: what is, if not one of
 * these two; else NULL. `refused`: as for unit_new. */
static Unit *instantiate(const char *name, const char *guid, Memory memory, Logger logger, Environment environment,
                         Status refused, const char *wrong, const char *call) {
    const char *called = name ? name : "";
    Unit *c = unit_new(sizeof(Importer) + strlen(called) + 1, memory, logger ? log_to : NULL, refused);
    if (!c) return NULL;
    Importer *importer = unit_importer(c);
    importer->logger = logger;
    importer->environment = environment;
    memcpy(importer->name, called, strlen(called) + 1);
    if (!*called) unit_say(c, UNIT_ERROR, "%s: the instance needs a name", call);
    else if (wrong) unit_say(c, UNIT_ERROR, "%s: %s", call, wrong);
    else if (!guid || strcmp(guid, unit_guid()))
        unit_say(c, UNIT_ERROR, "%s: the GUID is not that of this unit, %s", call, unit_guid());
    else {
        unit_reset(c);
        return c;
    }
    unit_free(c);
    return NULL;
}

/* The categories of these names, as a set for unit_log; without names, all. */
static Status find_categories(const Unit *c, size_t n, const char *const names[], int *found, const char *call) {
    *found = n ? LOG_NOTHING : LOG_ALL;
    if (n && !unit_given(c, names, call)) return UNIT_ERROR;
    for (size_t k = 0; k < n; k++) {
        int named = names[k] && !strcmp(names[k], "logAll") ? LOG_ALL : LOG_NOTHING;
        for (int i = 0; i < 3; i++)
            if (names[k] && !strcmp(names[k], category(i))) named |= LOG_WARNING << i;
        if (!named) return unit_say(c, UNIT_ERROR, "%s: the categories are " CATEGORIES, call);
        *found |= named;
    }
    return UNIT_OK;
}

/* Of a type that no variable has: only an empty list of them can be asked for or set. */
static Status none_of(const Unit *c, const char *type, int modes, const uint32_t r[], size_t n, const char *call) {
    if (!unit_may(c, modes, call)) return UNIT_ERROR;
    return n ? unit_say(c, UNIT_ERROR, "no %s has the value reference %d", type, (int64_t)(r ? *r : 0)) : UNIT_OK;
}

static Status not_offered(const Unit *c, const char *call) {
    return c ? unit_say(c, UNIT_ERROR, "%s is not offered by this co-simulation unit", call) : UNIT_ERROR;
}
