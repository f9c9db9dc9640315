/* For LD_PRELOAD: makes the blocks of GUARDED bytes that C++ frees inaccessible, and never gives them out again. A program
 * that uses such a block afterwards ends with a segmentation fault, each time, whatever lies beside it in memory. */
#include <stdlib.h>
#include <sys/mman.h>

#define GUARDED 128
#define PAGE 4096

void *_Znwm(size_t size) { /* operator new(size_t) */
    if (size != GUARDED) return malloc(size);
    return mmap(NULL, PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
}

void _ZdlPvm(void *block, size_t size) { /* operator delete(void *, size_t) */
    if (size != GUARDED) free(block);
    else mprotect(block, PAGE, PROT_NONE);
}
