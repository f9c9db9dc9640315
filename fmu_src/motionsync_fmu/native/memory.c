/* The system's memory, for importers that give none. */
#include "instance.h"

#ifdef _WIN32
/* Of kernel32, which every process has. There are several C libraries, and each has memory of its own. */
__declspec(dllimport) void *__stdcall GetProcessHeap(void);
__declspec(dllimport) void *__stdcall HeapAlloc(void *heap, unsigned long flags, size_t size);
__declspec(dllimport) int __stdcall HeapFree(void *heap, unsigned long flags, void *block);

static void *allocate(size_t n, size_t size) { return HeapAlloc(GetProcessHeap(), 0, n * size); }
static void release(void *block) { HeapFree(GetProcessHeap(), 0, block); }
Memory system_memory(void) { return (Memory){allocate, release}; }
#else
#include <stdlib.h>

Memory system_memory(void) { return (Memory){calloc, free}; }
#endif
