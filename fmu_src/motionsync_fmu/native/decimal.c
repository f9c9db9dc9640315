/* The digits of a number by division of large whole numbers, which is exact.
 *
 * Source: G. L. Steele, J. L. White, "How to print floating-point numbers accurately", PLDI 1990. Here the digits end at
 * one of four lengths, and the last digit is rounded to the nearest, to an even one from the middle. */
#include "decimal.h"
#include "heat.h"
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { MOST_DIGITS = 17, BASE = 10 };

/* A whole number >= 0, the least significant word first; the last word is not 0. None is longer than 1111 bits. */
typedef struct {
    int n;
    uint32_t words[36];
} Whole;

COLD static Whole whole(uint64_t x) {
    Whole a;
    a.n = (x > 0) + (x > UINT32_MAX);
    a.words[0] = (uint32_t)x;
    a.words[1] = (uint32_t)(x >> 32);
    return a;
}

COLD static void multiply(Whole *a, uint32_t by) {
    uint64_t carry = 0;
    for (int i = 0; i < a->n; i++) {
        carry += (uint64_t)a->words[i] * by;
        a->words[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry) a->words[a->n++] = (uint32_t)carry;
}

COLD static void times_power_of_2(Whole *a, int power) {
    for (; power >= 31; power -= 31) multiply(a, (uint32_t)1 << 31);
    multiply(a, (uint32_t)1 << power);
}

COLD static void times_power_of_10(Whole *a, int power) {
    for (; power >= 9; power -= 9) multiply(a, 1000000000);
    for (; power > 0; power--) multiply(a, BASE);
}

/* < 0, 0 or > 0: a is less than, equal to or greater than b. */
COLD static int compare(const Whole *a, const Whole *b) {
    if (a->n != b->n) return a->n - b->n;
    for (int i = a->n - 1; i >= 0; i--)
        if (a->words[i] != b->words[i]) return a->words[i] < b->words[i] ? -1 : 1;
    return 0;
}

/* a + b, where b is not the longer one. */
COLD static Whole sum(const Whole *a, const Whole *b) {
    Whole total = *a;
    uint64_t carry = 0;
    for (int i = 0; i < total.n; i++) {
        carry += (uint64_t)total.words[i] + (i < b->n ? b->words[i] : 0);
        total.words[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry) total.words[total.n++] = (uint32_t)carry;
    return total;
}

/* a - b * times, which is not negative. */
COLD static void subtract(Whole *a, const Whole *b, uint32_t times) {
    uint64_t carry = 0;
    for (int i = 0; i < a->n; i++) {
        carry += i < b->n ? (uint64_t)b->words[i] * times : 0;
        uint32_t part = (uint32_t)carry;
        carry = (carry >> 32) + (a->words[i] < part);
        a->words[i] -= part;
    }
    while (a->n && !a->words[a->n - 1]) a->n--;
}

/* The whole part of a / b, which is at most 9; a keeps the remainder. The last word of b is from 2^27 up to 2^28: nine
 * times b is no longer than b, and the last words tell the quotient, or one less. */
COLD static char quotient(Whole *a, const Whole *b) {
    uint32_t found = a->n < b->n ? 0 : a->words[a->n - 1] / (b->words[b->n - 1] + 1);
    subtract(a, b, found);
    if (compare(a, b) >= 0) {
        subtract(a, b, 1);
        found++;
    }
    return (char)found;
}

/* A number x > 0 as 0.d1d2d3... * 10^exponent, whose further digits are those of rest / one. */
typedef struct {
    int exponent;
    Whole rest, one;
    Whole margin; /* half the distance to the next number above, in the unit of rest and one */
    bool closer_below; /* the next number below is at half this distance */
    bool even; /* a number in the middle between this and the next one reads back as this one */
} Fraction;

COLD static int floor_log2(uint64_t x) {
    int power = 0;
    while (x >>= 1) power++;
    return power;
}

COLD static Fraction fraction(uint64_t bits) {
    int biased = (int)(bits >> 52);
    uint64_t mantissa = (bits & 0xFFFFFFFFFFFFF) | (biased ? (uint64_t)1 << 52 : 0);
    int power = (biased ? biased : 1) - 1075; /* x is mantissa * 2^power */
    Fraction f;
    f.even = !(mantissa & 1);
    f.closer_below = mantissa == (uint64_t)1 << 52 && biased > 1;
    f.rest = whole(mantissa << 1);
    f.margin = whole(1);
    f.one = whole(2);
    times_power_of_2(&f.rest, power > 0 ? power : 0);
    times_power_of_2(&f.margin, power > 0 ? power : 0);
    times_power_of_2(&f.one, power < 0 ? -power : 0);
    f.exponent = ((floor_log2(mantissa) + power) * 30103 + 40000000) / 100000 - 399; /* by log10(2), or one less */
    times_power_of_10(&f.one, f.exponent > 0 ? f.exponent : 0);
    times_power_of_10(&f.rest, f.exponent < 0 ? -f.exponent : 0);
    times_power_of_10(&f.margin, f.exponent < 0 ? -f.exponent : 0);
    if (compare(&f.rest, &f.one) >= 0) {
        f.exponent++;
        multiply(&f.one, BASE);
    }
    int doubled = 27 - floor_log2(f.one.words[f.one.n - 1]);
    if (doubled < 0) doubled += 32;
    times_power_of_2(&f.rest, doubled);
    times_power_of_2(&f.margin, doubled);
    times_power_of_2(&f.one, doubled);
    return f;
}

COLD static int compare_doubled(const Whole *a, const Whole *b) {
    Whole doubled = *a;
    multiply(&doubled, 2);
    return compare(&doubled, b);
}

/* Whether the last of the digits that were taken is to be rounded up. */
COLD static bool rounds_up(const Fraction *f, char last) {
    int half = compare_doubled(&f->rest, &f->one);
    return half > 0 || (half == 0 && last & 1);
}

/* Whether the digits that were taken read back as x, once the last one is rounded. */
COLD static bool reads_back(const Fraction *f, bool up) {
    int over; /* > 0: the error is larger than the margin */
    if (up) {
        Whole reached = sum(&f->rest, &f->margin);
        over = compare(&f->one, &reached);
    } else {
        over = f->closer_below ? compare_doubled(&f->rest, &f->margin) : compare(&f->rest, &f->margin);
    }
    return over < 0 || (over == 0 && f->even);
}

typedef struct {
    char digits[MOST_DIGITS]; /* from 0 to 9; the last is not 0 */
    int n;
    int exponent; /* x is 0.d1d2d3... * 10^exponent */
    int precision; /* how many digits there were with the zeros at the end */
} Digits;

COLD static void end(Digits *d, bool up) {
    d->precision = d->n;
    while (up && d->n && d->digits[d->n - 1] == 9) d->n--;
    if (up && d->n) {
        d->digits[d->n - 1]++;
    } else if (up) {
        d->digits[d->n++] = 1;
        d->exponent++;
    }
    while (!d->digits[d->n - 1]) d->n--;
}

COLD static Digits digits_of(uint64_t bits) {
    Fraction f = fraction(bits);
    Digits d = {.n = 0, .exponent = f.exponent};
    for (;;) {
        multiply(&f.rest, BASE);
        multiply(&f.margin, BASE);
        d.digits[d.n++] = quotient(&f.rest, &f.one);
        if (d.n != 6 && d.n < 15) continue;
        bool up = rounds_up(&f, d.digits[d.n - 1]);
        if (d.n < MOST_DIGITS && !reads_back(&f, up)) continue;
        end(&d, up);
        return d;
    }
}

/* --- the text --- */

COLD static char *copy(char *to, const char *text) {
    while (*text) *to++ = *text++;
    return to;
}

/* The digits from `from` up to `to`, with zeros before and behind those that there are. */
COLD static char *digits_to(char *text, const Digits *d, int from, int to) {
    for (int i = from; i < to; i++) *text++ = (char)('0' + (i >= 0 && i < d->n ? d->digits[i] : 0));
    return text;
}

COLD static char *fixed(char *text, const Digits *d) {
    int point = d->exponent > 1 ? d->exponent : 1; /* how many digits stand before it */
    text = digits_to(text, d, d->exponent - point, d->exponent);
    if (d->n <= d->exponent) return text;
    *text++ = '.';
    return digits_to(text, d, d->exponent, d->n);
}

COLD static char *scientific(char *text, const Digits *d) {
    int exponent = d->exponent - 1, size = exponent < 0 ? -exponent : exponent;
    text = digits_to(text, d, 0, 1);
    if (d->n > 1) *text++ = '.';
    text = digits_to(text, d, 1, d->n);
    *text++ = 'e';
    *text++ = exponent < 0 ? '-' : '+';
    if (size >= 100) *text++ = (char)('0' + size / 100);
    *text++ = (char)('0' + size / 10 % 10);
    *text++ = (char)('0' + size % 10);
    return text;
}

COLD size_t decimal(double x, char text[DECIMAL_ROOM]) {
    char *at = text;
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bool negative = bits >> 63;
    bits &= UINT64_MAX >> 1;
    if (x != x) negative = false;
    if (negative) *at++ = '-';
    if (x != x) at = copy(at, "nan");
    else if (bits >> 52 == 0x7FF) at = copy(at, "inf");
    else if (!bits) at = copy(at, "0");
    else {
        Digits d = digits_of(bits);
        at = d.exponent < -3 || d.exponent > d.precision ? scientific(at, &d) : fixed(at, &d);
    }
    *at = 0;
    return (size_t)(at - text);
}
