/* In place of the C library's header: what memory.c needs, and FMI's headers include. */
#ifndef STDLIB_H
#define STDLIB_H
#include <stddef.h>
void *calloc(size_t n, size_t size);
void free(void *block);
#endif
