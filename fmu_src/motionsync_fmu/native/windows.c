/* What a Windows library needs beside its own functions. It replaces the C start-up code and zig's library, which would
 * be linked as a whole and be half of the file. On other platforms this file is empty. */
#ifdef _WIN32
#include <stdint.h>

int library_main(void *library, uint32_t reason, void *reserved) { return 1; } /* the C library starts by itself */

/* The remainder with the sign of x, exact; each coprocessor instruction removes some bits of the quotient. */
double fmod(double x, double y) {
    long double rest = x, divisor = y;
    uint16_t status;
    do __asm__("fprem\n\tfnstsw %1" : "+t"(rest), "=a"(status) : "u"(divisor) : "cc");
    while (status & 0x400);
    return (double)rest;
}

/* Called with a frame's size in rax before it is reserved: touches each of its pages in turn, as Windows demands. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    pushq %rcx\n"
        "    pushq %rax\n"
        "    leaq 24(%rsp), %rcx\n"
        "1:  cmpq $4096, %rax\n"
        "    jb 2f\n"
        "    subq $4096, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    subq $4096, %rax\n"
        "    jmp 1b\n"
        "2:  subq %rax, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    popq %rax\n"
        "    popq %rcx\n"
        "    ret\n");
#endif
