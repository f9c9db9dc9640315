/* How often functions are called. COLD: seldom; the function is compiled for size, apart from the others. HOT: with each
 * value or step; the function becomes part of those that call it. */
#ifndef HEAT_H
#define HEAT_H

#if defined __clang__
#define COLD __attribute__((cold, minsize))
#define HOT inline __attribute__((always_inline))
#elif defined __GNUC__
#define COLD __attribute__((cold))
#define HOT inline __attribute__((always_inline))
#else
#define COLD
#define HOT inline
#endif

#endif
