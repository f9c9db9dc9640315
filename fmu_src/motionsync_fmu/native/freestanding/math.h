/* In place of the C library's header. */
#ifndef MATH_H
#define MATH_H
#ifndef INFINITY /* float.h may have it */
#define INFINITY __builtin_inf()
#endif
double fabs(double x);
double sqrt(double x);
double floor(double x);
double rint(double x);
double fmod(double x, double y);
#endif
