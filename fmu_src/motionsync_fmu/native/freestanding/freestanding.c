/* The functions of a C library that the C files, and the compiler by itself, call. So no library of the system is needed,
 * nor any of the compiler's, which zig would have to compile for each platform first. All results are exact or correctly rounded.
 *
 * sqrt and fabs are not here: they are instructions of all processors. */
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Without this the compiler would recognize what these loops do, and replace them by calls of the functions. */
#define NO_BUILTIN(name) __attribute__((no_builtin(#name)))

/* --- <string.h> --- */

NO_BUILTIN(memcpy) void *memcpy(void *restrict to, const void *restrict from, size_t n) {
    uint8_t *t = to;
    const uint8_t *f = from;
    for (size_t i = 0; i < n; i++) t[i] = f[i];
    return to;
}

NO_BUILTIN(memset) void *memset(void *to, int byte, size_t n) {
    uint8_t *t = to;
    for (size_t i = 0; i < n; i++) t[i] = (uint8_t)byte;
    return to;
}

NO_BUILTIN(memcmp) int memcmp(const void *a, const void *b, size_t n) {
    const uint8_t *x = a, *y = b;
    for (size_t i = 0; i < n; i++)
        if (x[i] != y[i]) return x[i] - y[i];
    return 0;
}

NO_BUILTIN(strlen) size_t strlen(const char *text) {
    size_t n = 0;
    while (text[n]) n++;
    return n;
}

NO_BUILTIN(strcmp) int strcmp(const char *a, const char *b) {
    while (*a && *a == *b) a++, b++;
    return (uint8_t)*a - (uint8_t)*b;
}

#ifdef __APPLE__ /* here the compiler calls one of these where memory is set to 0: the first on ARM, the other on x86 */
NO_BUILTIN(memset) void bzero(void *to, size_t n) {
    uint8_t *t = to;
    for (size_t i = 0; i < n; i++) t[i] = 0;
}

NO_BUILTIN(memset) void __bzero(void *to, size_t n) { /* to call bzero would be to call itself */
    uint8_t *t = to;
    for (size_t i = 0; i < n; i++) t[i] = 0;
}
#endif

/* --- <math.h> --- */

static const double LARGE = 0x1p52; /* no number from here on has a fraction */

NO_BUILTIN(rint) double rint(double x) {
    double size = fabs(x);
    if (!(size < LARGE)) return x;
    double rounded = size + LARGE - LARGE;
    return __builtin_copysign(rounded, x);
}

NO_BUILTIN(floor) double floor(double x) {
    if (!(fabs(x) < LARGE)) return x;
    double whole = (double)(int64_t)x;
    return __builtin_copysign(whole - (whole > x), x);
}

enum { EXPONENT = 52 }; /* the lowest bit of a number's exponent; below it is the mantissa */
static const uint64_t SIGN = 1ull << 63, INFINITE = 0x7FFull << EXPONENT, LEAST_NORMAL = 1ull << EXPONENT;

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static double number_of(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* A number > 0 as mantissa * 2^(exponent - 1075). */
typedef struct {
    uint64_t mantissa;
    int exponent; /* at least 1 */
} Parts;

static Parts parts_of(uint64_t bits) {
    int exponent = (int)(bits >> EXPONENT);
    return exponent ? (Parts){(bits & (LEAST_NORMAL - 1)) | LEAST_NORMAL, exponent} : (Parts){bits, 1};
}

static uint64_t joined(Parts x) {
    if (!x.mantissa) return 0;
    int shift = __builtin_clzll(x.mantissa) - 11;
    if (shift > x.exponent - 1) shift = x.exponent - 1;
    uint64_t mantissa = x.mantissa << shift;
    return mantissa < LEAST_NORMAL ? mantissa : (mantissa & (LEAST_NORMAL - 1)) | (uint64_t)(x.exponent - shift) << EXPONENT;
}

/* The remainder with the sign of x, by division of the mantissas: 11 bits of the quotient at a time. */
NO_BUILTIN(fmod) double fmod(double x, double y) {
    uint64_t sign = bits_of(x) & SIGN, a = bits_of(x) & ~SIGN, b = bits_of(y) & ~SIGN;
    if (!b || a >= INFINITE || b > INFINITE) return number_of(INFINITE | 1ull << 51); /* not a number */
    if (a < b) return x;
    Parts rest = parts_of(a), divisor = parts_of(b);
    rest.mantissa %= divisor.mantissa;
    while (rest.mantissa && rest.exponent > divisor.exponent) {
        int shift = rest.exponent - divisor.exponent < 11 ? rest.exponent - divisor.exponent : 11;
        rest.mantissa = (rest.mantissa << shift) % divisor.mantissa;
        rest.exponent -= shift;
    }
    rest.exponent = divisor.exponent;
    return number_of(sign | joined(rest));
}

/* --- Windows --- */

#ifdef _WIN32
int library_main(void *library, uint32_t reason, void *reserved) {
    (void)library, (void)reason, (void)reserved;
    return 1;
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
