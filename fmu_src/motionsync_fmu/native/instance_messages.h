/* Part of instance.c: messages for the importer. None has a percent sign, since many importers use the text as a
 * format. */
#ifndef INSTANCE_MESSAGES_H
#define INSTANCE_MESSAGES_H

#include "instance_memory.h"
#include "decimal.h"
#include <stdarg.h>

typedef struct {
    char bytes[2048];
    size_t length;
} Text;

COLD static void append(Text *text, const char *from, size_t length) {
    size_t capacity = sizeof text->bytes - 1 - text->length;
    if (length > capacity) length = capacity;
    memcpy(text->bytes + text->length, from, length);
    text->length += length;
    text->bytes[text->length] = 0;
}

COLD static void append_text(Text *text, const char *from) { append(text, from, strlen(from)); }

COLD static void append_integer(Text *text, int64_t x) {
    char digits[20];
    size_t first = sizeof digits;
    uint64_t rest = x < 0 ? -(uint64_t)x : (uint64_t)x;
    do digits[--first] = (char)('0' + rest % 10);
    while (rest /= 10);
    if (x < 0) digits[--first] = '-';
    append(text, digits + first, sizeof digits - first);
}

COLD static void append_real(Text *text, double x, int digits) {
    char decimal[DECIMAL_TEXT_SIZE];
    append(text, decimal, (size_t)(write_decimal(decimal, x, digits) - decimal));
}

/* What was set has more digits than what was computed, so that one finds it again. */
COLD static void append_value(Text *text, const Instance *self, const Variable *v) {
    append_text(text, name_of(v));
    append_text(text, " = ");
    if (v->kind == REAL) append_real(text, number_of(self, v), v->modes ? SHOWN_DIGITS : COMPUTED_DIGITS);
    else if (v->kind == BOOLEAN) append_text(text, number_of(self, v) != 0.0 ? "True" : "False");
    else append_integer(text, *(const int64_t *)value_at(self, v));
}

/* A variable by its number; or, with a number from COUNT on, the variable in this group whose name ends with the text
 * at that index, NULL if the group has none. */
COLD static const Variable *find_listed_variable(int number, const char *group) {
    if (number < COUNT) return VARIABLES + number;
    const char *name = TEXTS;
    size_t length = strlen(group);
    for (const Variable *v = VARIABLES; v < VARIABLES + COUNT; v++, name += strlen(name) + 1)
        if (!memcmp(name, group, length) && !strcmp(name + length, text_at(number - COUNT))) return v;
    return NULL;
}

COLD static void append_values(Text *text, const Instance *self, const int16_t *list, const char *group,
                               const char *before) {
    for (; *list >= 0; list++) {
        const Variable *v = find_listed_variable(*list, group);
        if (!v) continue;
        append_text(text, before);
        append_value(text, self, v);
        before = ", ";
    }
    if (*before == ',') append_text(text, ")");
}

/* Whether messages of this status reach the importer: if not, no text is made. */
static bool is_logged(const Instance *self, Status status) {
    static const Category CATEGORIES[] = {LOG_NOTHING, LOG_WARNING, LOG_DISCARD, LOG_ERROR};
    return self->log && self->logged_categories & CATEGORIES[status];
}

COLD void instance_set_categories(Instance *self, int categories) { self->logged_categories = categories; }

/* Besides the conversions in instance.h, %v stands for a variable and its value, %f for a double with few digits, and
 * %l for a list of variables and their values, which the group follows and what comes before the first one: "(" or ",".
 */
COLD Status instance_report(const Instance *self, Status status, const char *format, ...) {
    if (!is_logged(self, status)) return status;
    Text text;
    text.length = 0;
    va_list arguments;
    va_start(arguments, format);
    for (; *format; format++) {
        if (*format != '%') append(&text, format, 1);
        else if (*++format == 's') append_text(&text, va_arg(arguments, const char *));
        else if (*format == 'd') append_integer(&text, va_arg(arguments, int64_t));
        else if (*format == 'v') append_value(&text, self, va_arg(arguments, const Variable *));
        else if (*format == 'r') append_real(&text, va_arg(arguments, double), SHOWN_DIGITS);
        else if (*format == 'f') append_real(&text, va_arg(arguments, double), COMPUTED_DIGITS);
        else {
            const int16_t *list = va_arg(arguments, const int16_t *);
            const char *group = va_arg(arguments, const char *);
            append_values(&text, self, list, group, va_arg(arguments, const char *));
        }
    }
    va_end(arguments);
    self->log(self->importer, status, text.bytes);
    return status;
}

COLD static const char *mode_text(int64_t mode) {
    switch (mode) {
    case INSTANTIATED: return "is instantiated";
    case INITIALIZING: return "is in initialization mode";
    case STEPPING: return "is in step mode";
    default: return "has been terminated";
    }
}

COLD bool instance_check_mode(const Instance *self, int modes, const char *call) {
    if (!self) return false;
    if (!(self->now.mode & modes))
        instance_report(self, STATUS_ERROR, "%s is not allowed now: the unit %s", call, mode_text(self->now.mode));
    return self->now.mode & modes;
}

/* The same for the functions that are called most: this one can be inlined, and calls another only to report an error.
 */
static inline bool check_mode(const Instance *self, int modes, const char *call) {
    return (self && self->now.mode & modes) || instance_check_mode(self, modes, call);
}

COLD bool instance_check_pointer(const Instance *self, const void *pointer, const char *call) {
    if (self && !pointer) instance_report(self, STATUS_ERROR, "%s: a pointer is missing", call);
    return self && pointer;
}

#endif
