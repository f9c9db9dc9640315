/* COLD: a function that is seldom called. It is compiled for size, apart from the functions that every step calls. */
#ifndef COLD_H
#define COLD_H

#if defined __clang__
#define COLD __attribute__((cold, minsize))
#elif defined __GNUC__
#define COLD __attribute__((cold))
#else
#define COLD
#endif

#endif
