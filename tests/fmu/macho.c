/* dlopen and dlsym for libraries of macOS, on Linux: what is linked with this file loads them in place of Linux's own.
 *
 * Of a file for several processors it loads the part for the processor that runs it. It does what macOS does: it copies
 * the segments, adds the library's address to the addresses in them, fills in the functions of the system, protects
 * the memory, and finds functions by the library's tree of names. A library that needs more ends the program.
 *
 * Functions of FMI are called as on Linux. On x86-64 both systems have the same rules; on arm64 macOS has others for
 * unnamed arguments and for narrow ones on the stack, of which these functions have none.
 *
 * Source: <mach-o/fat.h>, <mach-o/loader.h>. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#ifdef __x86_64__
enum { PROCESSOR = 0x01000007, PAGE = 1 << 12 };
#else /* arm64 */
enum { PROCESSOR = 0x0100000C, PAGE = 1 << 14 };
#endif

typedef struct {
    uint32_t magic, processor, variant, type, commands, size, flags, reserved;
} Header;

typedef struct {
    uint32_t command, size;
    char name[16];
    uint64_t address, memory_size, offset, file_size;
    uint32_t most, protection, sections, flags;
} Segment;
enum { SEGMENT = 0x19, LOCKED_WHEN_LOADED = 0x10 };

typedef struct {
    uint32_t command, size, rebase, rebase_size, bind, bind_size, weak, weak_size, lazy, lazy_size, exported;
} Tables;
enum { TABLES = (int)0x80000022 };

/* The only library: its file, the tables and segments of the file, and the image in memory. */
static const uint8_t *file;
static uint8_t *image;
static const Tables *tables;
static const Segment *segments[16];
static size_t segment_count;

static void fail(const char *form, ...) {
    va_list arguments;
    va_start(arguments, form);
    fprintf(stderr, "macho.c: ");
    vfprintf(stderr, form, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    exit(2);
}

/* --- the functions of the system --- */

static void zero(void *memory, size_t n) { memset(memory, 0, n); }
static void binder(void) { fail("the library calls the lazy binder, but all functions are bound"); }

static uint64_t function_of_the_system(const char *name) {
    if (!strcmp(name, "_calloc")) return (uintptr_t)calloc;
    if (!strcmp(name, "_free")) return (uintptr_t)free;
    if (!strcmp(name, "_bzero") || !strcmp(name, "___bzero")) return (uintptr_t)zero;
    if (!strcmp(name, "dyld_stub_binder")) return (uintptr_t)binder;
    fail("the library needs %s, which it must not use", name);
    return 0;
}

/* --- addresses --- */

/* Read a number of seven bits per byte, and advance behind it. */
static uint64_t read_number(const uint8_t **at) {
    uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
        uint8_t byte = *(*at)++;
        value |= (uint64_t)(byte & 0x7F) << shift;
        if (byte < 0x80) return value;
    }
}

static uint64_t address_in(unsigned segment, uint64_t offset) {
    if (segment >= segment_count) fail("there is no segment %u", segment);
    return segments[segment]->address + offset;
}

/* Add the library's address to the addresses that a table lists. */
static void rebase(const uint8_t *at, const uint8_t *end) {
    uint64_t next = 0;
    while (at < end) {
        unsigned operation = *at & 0xF0, small = *at++ & 0x0F;
        uint64_t times = 0, skipped = 0;
        switch (operation) {
        case 0x00: break; /* the end */
        case 0x10: break; /* the type */
        case 0x20: next = address_in(small, read_number(&at)); break;
        case 0x30: next += read_number(&at); break;
        case 0x40: next += 8 * small; break;
        case 0x50: times = small; break;
        case 0x60: times = read_number(&at); break;
        case 0x70: times = 1, skipped = read_number(&at); break;
        case 0x80: times = read_number(&at), skipped = read_number(&at); break;
        default: fail("the operation %#x is unknown in a table of addresses", operation);
        }
        for (; times; times--, next += 8 + skipped) *(uint64_t *)(image + next) += (uintptr_t)image;
    }
}

/* Fill in the functions of the system that a table lists, also those that macOS fills in at their first call. */
static void bind(const uint8_t *at, const uint8_t *end) {
    uint64_t next = 0, address_of_function = 0;
    while (at < end) {
        unsigned operation = *at & 0xF0, small = *at++ & 0x0F;
        uint64_t times = 0, skipped = 0;
        switch (operation) {
        case 0x00: break; /* the end */
        case 0x10: break; /* the library */
        case 0x50: break; /* the type */
        case 0x40:
            address_of_function = function_of_the_system((const char *)at);
            at += strlen((const char *)at) + 1;
            break;
        case 0x70: next = address_in(small, read_number(&at)); break;
        case 0x80: next += read_number(&at); break;
        case 0x90: times = 1; break;
        case 0xA0: times = 1, skipped = read_number(&at); break;
        case 0xB0: times = 1, skipped = 8 * small; break;
        case 0xC0: times = read_number(&at), skipped = read_number(&at); break;
        default: fail("the operation %#x is unknown in a table of functions", operation);
        }
        for (; times; times--, next += 8 + skipped) *(uint64_t *)(image + next) = address_of_function;
    }
}

/* --- the file --- */

static const uint8_t *read_file(const char *path) {
    FILE *stream = fopen(path, "rb");
    if (!stream || fseek(stream, 0, SEEK_END)) fail("%s cannot be read", path);
    size_t size = (size_t)ftell(stream);
    uint8_t *content = malloc(size);
    rewind(stream);
    if (!content || fread(content, 1, size, stream) != size) fail("%s cannot be read", path);
    fclose(stream);
    return content;
}

static uint32_t big_endian(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/* The library for this processor, in a file for several or for one. */
static const uint8_t *part_for_processor(const uint8_t *content) {
    if (big_endian(content) == 0xCAFEBABE)
        for (uint32_t i = 0; i < big_endian(content + 4); i++) {
            const uint8_t *part = content + 8 + 20 * i;
            uint32_t offset = big_endian(part + 8);
            if (big_endian(part) != PROCESSOR) continue;
            if (offset % PAGE) fail("the part for this processor does not start with a page");
            return content + offset;
        }
    return content;
}

static void read_commands(void) {
    const Header *header = (const Header *)file;
    if (header->magic != 0xFEEDFACF || header->processor != PROCESSOR) fail("this is no library for this processor");
    const uint8_t *at = file + sizeof *header;
    for (uint32_t i = 0; i < header->commands; i++) {
        const Segment *command = (const Segment *)at;
        if (command->command == SEGMENT && segment_count < 16) segments[segment_count++] = command;
        if (command->command == (uint32_t)TABLES) tables = (const Tables *)at;
        at += command->size;
    }
    if (!tables || !segment_count) fail("the library has no tables of addresses and functions of the expected kind");
}

/* Copy the content of a segment to its address. macOS maps the pages of the file itself, so both are aligned. */
static void copy_segment(const Segment *segment) {
    if (segment->address % PAGE || segment->offset % PAGE) fail("%.16s does not start with a page", segment->name);
    memcpy(image + segment->address, file + segment->offset, segment->file_size);
}

static void protect(const Segment *segment) {
    int read_only = segment->flags & LOCKED_WHEN_LOADED;
    int protection = read_only ? PROT_READ : (int)segment->protection; /* both systems have the same numbers */
    if (mprotect(image + segment->address, segment->memory_size, protection))
        fail("%.16s cannot be protected", segment->name);
}

/* Show the code that was copied to the processor, whose caches of code and data differ on arm64; a line of them has 16
 * bytes or more. zig would have to compile its library first for __builtin___clear_cache. */
static void show_code(size_t size) {
#ifdef __aarch64__
    for (size_t i = 0; i < size; i += 16) __asm__ volatile("dc cvau, %0" ::"r"(image + i) : "memory");
    __asm__ volatile("dsb ish" ::: "memory");
    for (size_t i = 0; i < size; i += 16) __asm__ volatile("ic ivau, %0" ::"r"(image + i) : "memory");
    __asm__ volatile("dsb ish\n\tisb" ::: "memory");
#else
    (void)size;
#endif
}

void *dlopen(const char *path, int mode) {
    (void)mode;
    file = part_for_processor(read_file(path));
    read_commands();
    const Segment *last = segments[segment_count - 1];
    size_t size = last->address + last->memory_size;
    image = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (image == MAP_FAILED) fail("there is no memory");
    for (size_t i = 0; i < segment_count; i++) copy_segment(segments[i]);
    rebase(file + tables->rebase, file + tables->rebase + tables->rebase_size);
    bind(file + tables->bind, file + tables->bind + tables->bind_size);
    bind(file + tables->lazy, file + tables->lazy + tables->lazy_size);
    show_code(size);
    for (size_t i = 0; i < segment_count; i++) protect(segments[i]);
    return image;
}

/* An exported function, NULL if there is none: names are in a tree, each common prefix once. */
void *dlsym(void *library, const char *name) {
    (void)library;
    char symbol[128] = "_";
    const char *left = strncat(symbol, name, sizeof symbol - 2);
    const uint8_t *tree = file + tables->exported, *at = tree;
    while (at) {
        uint64_t own = read_number(&at);
        if (!*left) return own && read_number(&at) == 0 ? image + read_number(&at) : NULL; /* flags, then the address */
        at += own;
        const uint8_t *following = NULL;
        for (unsigned children = *at++; children && !following; children--) {
            size_t length = strlen((const char *)at);
            int fits = !strncmp((const char *)at, left, length);
            at += length + 1;
            uint64_t child = read_number(&at);
            if (fits) left += length, following = tree + child;
        }
        at = following;
    }
    return NULL;
}
