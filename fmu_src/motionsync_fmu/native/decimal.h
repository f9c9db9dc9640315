/* Numbers as texts in messages: the same on all platforms, without a C library. */
#ifndef DECIMAL_H
#define DECIMAL_H

#include "heat.h"
#include <float.h>
#include <stdint.h>
#include <string.h>

enum { DECIMAL_TEXT_SIZE = 32, FEW_DIGITS = 6 }; /* bytes that the text of a number needs at most, with its end */

/* The number in so many significant digits, at most 12, or in six if they are enough, as C's %g writes it, with a point
 * whatever the locale is. What was written in so many digits is written so again; of any other number the last digit
 * may be the neighbouring one, since a number far from 1 is rounded some hundred times on the way, each time by 1.1e-16
 * of it. Returns the end of the text. */
COLD static char *write_decimal(char *to, double x, int digits) {
    uint64_t whole, most = 1;
    int exponent = 0, n = digits;
    char written[DECIMAL_TEXT_SIZE];
    if (x < 0.0 || (x == 0.0 && 1.0 / x < 0.0)) *to++ = '-', x = -x;
    if (x != x || x > DBL_MAX) return (char *)memcpy(to, x != x ? "nan" : "inf", 4) + 3;
    for (; x >= 10.0; exponent++) x /= 10.0;
    for (; x > 0.0 && x < 1.0; exponent--) x *= 10.0;
    for (int i = 1; i < n; i++) most *= 10;
    whole = (uint64_t)(x * (double)most + 0.5);
    if (whole == most * 10) whole = most, exponent++;
    for (; n > 1 && whole % 10 == 0; n--) whole /= 10;
    for (int i = n; i--; whole /= 10) written[i] = (char)('0' + whole % 10);
    int scientific = exponent < -4 || exponent >= (n > FEW_DIGITS ? digits : FEW_DIGITS);
    int before = scientific ? 1 : exponent + 1; /* the point */
    for (int i = before < 1 ? before - 1 : 0; i < n || i < before; i++) {
        *to++ = i >= 0 && i < n ? written[i] : '0';
        if (i + 1 == before && i + 1 < n) *to++ = '.';
    }
    if (scientific) {
        int size = exponent < 0 ? -exponent : exponent;
        *to++ = 'e';
        *to++ = exponent < 0 ? '-' : '+';
        if (size >= 100) *to++ = (char)('0' + size / 100);
        *to++ = (char)('0' + size / 10 % 10);
        *to++ = (char)('0' + size % 10);
    }
    *to = 0;
    return to;
}

#endif
