/* What the functions of FMI 2.0 and FMI 3.0 share. fmi2.c and fmi3.c define before they include this, once:
 *
 *   FmiStatus            the standard's type of a status, which has the numbers of the core's
 *   Logger, Environment  the importer's function for messages, and what the importer gets back with each
 *   DISCARD_CATEGORY     the log category of a message with the status discard
 *   CATEGORIES           the names of all log categories, for a message
 *
 * and afterwards pass_to_importer, which passes a message on to the importer. */
#include <string.h>
#include "instance.h"

#if defined __GNUC__
#pragma GCC diagnostic ignored                                                                                         \
    "-Wunused-parameter" /* the standard has them, and some mean nothing to these instances */
#endif

typedef struct { /* what these functions store with each instance */
    Logger logger;
    Environment environment;
    char name[];
} Importer;

static LogFunction pass_to_importer;

/* The log categories by status, from STATUS_WARNING on. */
static const char *category_name(int i) {
    return i == 0 ? "logStatusWarning" : i == 1 ? DISCARD_CATEGORY : "logStatusError";
}

enum {
    SETTABLE = INSTANTIATED | INITIALIZING | STEPPING,
    READABLE = INITIALIZING | STEPPING | TERMINATED,
    STEPPED = STEPPING | TERMINATED
};

/* The function ends with the status of this call of the core. */
#define RETURN_STATUS(status) return (FmiStatus)(status)

/* The function ends with an error unless the instance is in one of these modes. */
#define REQUIRE_MODE(modes) \
    if (!instance_check_mode(c, modes, __func__)) RETURN_STATUS(STATUS_ERROR)

/* An instance with this name and GUID; NULL, and an error is logged, if something is wrong. `error`: what is wrong
 * besides name and GUID, or NULL; `refusal_status`: as for instance_new. */
static Instance *instantiate(const char *name, const char *guid, Memory memory, Logger logger, Environment environment,
                         Status refusal_status, const char *error, const char *call) {
    const char *instance_name = name ? name : "";
    size_t size = sizeof(Importer) + strlen(instance_name) + 1;
    Instance *c = instance_new(size, memory, logger ? pass_to_importer : NULL, refusal_status);
    if (!c) return NULL;
    Importer *importer = instance_importer_data(c);
    importer->logger = logger;
    importer->environment = environment;
    memcpy(importer->name, instance_name, strlen(instance_name) + 1);
    if (!*instance_name) instance_report(c, STATUS_ERROR, "%s: the instance needs a name", call);
    else if (error) instance_report(c, STATUS_ERROR, "%s: %s", call, error);
    else if (!guid || strcmp(guid, instance_guid()))
        instance_report(c, STATUS_ERROR, "%s: the GUID is not that of this unit, %s", call, instance_guid());
    else {
        instance_reset(c);
        return c;
    }
    instance_free(c);
    return NULL;
}

/* The categories of these names, as a set for instance_set_categories; without names, all. */
static Status find_categories(const Instance *c, size_t n, const char *const names[], int *categories,
                              const char *call) {
    *categories = n ? LOG_NOTHING : LOG_ALL;
    if (n && !instance_check_pointer(c, names, call)) return STATUS_ERROR;
    for (size_t k = 0; k < n; k++) {
        int category = names[k] && !strcmp(names[k], "logAll") ? LOG_ALL : LOG_NOTHING;
        for (int i = 0; i < 3; i++)
            if (names[k] && !strcmp(names[k], category_name(i))) category |= LOG_WARNING << i;
        if (!category) return instance_report(c, STATUS_ERROR, "%s: the categories are " CATEGORIES, call);
        *categories |= category;
    }
    return STATUS_OK;
}

/* Refuses value references of a type that no variable has; an empty list is accepted. */
static Status refuse_type(const Instance *c, const char *type, int modes, const uint32_t r[], size_t n,
                          const char *call) {
    if (!instance_check_mode(c, modes, call)) return STATUS_ERROR;
    return n ? instance_report(c, STATUS_ERROR, "no %s has the value reference %d", type, (int64_t)(r ? *r : 0))
             : STATUS_OK;
}

static Status refuse_call(const Instance *c, const char *call) {
    return c ? instance_report(c, STATUS_ERROR, "%s is not offered by this co-simulation unit", call) : STATUS_ERROR;
}
