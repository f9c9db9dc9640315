/* What the host's program needs on Windows in place of a C library's start and printing: zig takes a minute and a half
 * to compile those of MinGW. The rest is in ucrtbase.dll, which Windows and Wine have. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

int host(int count, char **arguments); /* the main function of replay.c */
int _configure_narrow_argv(int mode);

int printf(const char *format, ...) {
    va_list values;
    va_start(values, format);
    int written = __stdio_common_vfprintf(0, stdout, format, NULL, values);
    va_end(values);
    return written;
}

int fprintf(FILE *file, const char *format, ...) {
    va_list values;
    va_start(values, format);
    int written = __stdio_common_vfprintf(0, file, format, NULL, values);
    va_end(values);
    return written;
}

int sscanf(const char *text, const char *format, ...) {
    va_list places;
    va_start(places, format);
    int matches = __stdio_common_vsscanf(0, text, (size_t)-1, format, NULL, places);
    va_end(places);
    return matches;
}

void start(void) {
    _configure_narrow_argv(1);
    exit(host(__argc, __argv));
}
