/* How often a function is called. COLD: seldom; the function is compiled for size, apart from the others. */
#ifndef HEAT_H
#define HEAT_H

#if defined __clang__
#define COLD __attribute__((cold, minsize))
#elif defined __GNUC__
#define COLD __attribute__((cold))
#else
#define COLD
#endif

#endif
