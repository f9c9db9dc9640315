/* The digits of a number, exactly: mantissa * 2^-k is mantissa * 5^k units of 10^-k, a whole number, which is written out
 * as by hand. */
#include "decimal.h"
#include "heat.h"
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { BASE = 10, MOST_DIGITS = 17, MOST_STORED_DIGITS = 800, MOST_FIVES = 25 }; /* ten times 5^25 is below 2^64 */

/* A whole number >= 0 in decimal digits, the least significant first. None here has more than 770 digits. */
typedef struct {
    int n;
    uint8_t digits[MOST_STORED_DIGITS];
} Whole;

COLD static void multiply(Whole *a, uint64_t factor) {
    uint64_t carry = 0;
    for (int i = 0; i < a->n || carry; i++) {
        if (i == a->n) a->digits[a->n++] = 0;
        carry += a->digits[i] * factor;
        a->digits[i] = (uint8_t)(carry % BASE);
        carry /= BASE;
    }
}

COLD static void times_power(Whole *a, uint64_t of, int power) {
    while (power) {
        uint64_t factor = 1;
        for (int i = 0; i < MOST_FIVES && power; i++, power--) factor *= of;
        multiply(a, factor);
    }
}

static inline int digit(const Whole *a, int i) { return i < a->n ? a->digits[i] : 0; }

/* < 0, 0 or > 0: a is less than, equal to or greater than b. */
COLD static int compare(const Whole *a, const Whole *b) {
    int i = a->n > b->n ? a->n : b->n;
    while (i && digit(a, i) == digit(b, i)) i--;
    return digit(a, i) - digit(b, i);
}

/* A number x > 0. */
typedef struct {
    Whole digits; /* of x */
    Whole margin; /* the distance to the next number above, in units of the last of these digits */
    int exponent; /* x is 0.d1d2d3... * 10^exponent */
    bool closer_below; /* the next number below is at half this distance */
    bool even; /* a number in the middle between this and the next one reads back as this one */
} Expansion;

COLD static void expand(Expansion *e, uint64_t bits) {
    int biased = (int)(bits >> 52);
    uint64_t mantissa = (bits & 0xFFFFFFFFFFFFF) | (biased ? (uint64_t)1 << 52 : 0);
    int power = (biased ? biased : 1) - 1075; /* x is mantissa * 2^power */
    e->margin.digits[0] = 1;
    e->margin.n = 1;
    times_power(&e->margin, power < 0 ? 5 : 2, power < 0 ? -power : power);
    e->digits.n = e->margin.n;
    memcpy(e->digits.digits, e->margin.digits, (size_t)e->margin.n);
    multiply(&e->digits, mantissa);
    e->exponent = e->digits.n + (power < 0 ? power : 0);
    e->closer_below = mantissa == (uint64_t)1 << 52 && biased > 1;
    e->even = !(mantissa & 1);
}

/* Whether x is to be rounded up where its last digits, `tail` of them, are left out: to the nearest, from the middle to an
 * even digit. */
COLD static bool rounds_up(const Whole *x, int tail) {
    if (!tail || x->digits[tail - 1] != BASE / 2) return tail && x->digits[tail - 1] > BASE / 2;
    for (int i = 0; i < tail - 1; i++)
        if (x->digits[i]) return true;
    return x->digits[tail] & 1;
}

/* Whether x without its last digits, rounded up or not, reads back as x: the error is not larger than half the distance
 * to the next number. */
COLD static bool reads_back(const Expansion *e, int tail, bool up) {
    Whole error;
    int nothing = up ? BASE - 1 : 0; /* a digit by which the error does not grow */
    for (int i = tail - 1; i >= e->margin.n; i--) /* the error is seldom small enough */
        if (e->digits.digits[i] != nothing) return false;
    error.n = tail;
    for (int i = 0, borrow = 0; i < tail; i++) { /* 10^tail minus these digits, if it is rounded up */
        int digit = up ? -e->digits.digits[i] - borrow : e->digits.digits[i];
        borrow = digit < 0;
        error.digits[i] = (uint8_t)(borrow ? digit + BASE : digit);
    }
    multiply(&error, !up && e->closer_below ? 4 : 2);
    int comparison = compare(&error, &e->margin);
    return comparison < 0 || (comparison == 0 && e->even);
}

/* Leaves out the last digits. */
COLD static void round_off(Expansion *e, int tail, bool up) {
    int i = tail;
    e->digits.digits[e->digits.n] = 0;
    while (up && e->digits.digits[i] == BASE - 1) e->digits.digits[i++] = 0;
    e->digits.digits[i] = (uint8_t)(e->digits.digits[i] + up);
    if (i < e->digits.n) return;
    e->digits.n++;
    e->exponent++;
}

/* --- the text --- */

COLD static char *copy(char *to, const char *text) {
    while (*text) *to++ = *text++;
    return to;
}

/* The digits of x but for the last ones, with the point and the zeros that belong to it; `before`: the number of
 * digits before the point. */
COLD static char *write_digits(char *to, const Whole *x, int tail, int before) {
    while (!x->digits[tail]) tail++;
    int n = x->n - tail;
    for (int i = before < 1 ? before - 1 : 0; i < n || i < before; i++) {
        *to++ = (char)('0' + (i >= 0 && i < n ? x->digits[x->n - 1 - i] : 0));
        if (i + 1 == before && i + 1 < n) *to++ = '.';
    }
    return to;
}

COLD static char *write_exponent(char *to, int exponent) {
    int size = exponent < 0 ? -exponent : exponent;
    *to++ = 'e';
    *to++ = exponent < 0 ? '-' : '+';
    if (size >= 100) *to++ = (char)('0' + size / 100);
    *to++ = (char)('0' + size / 10 % 10);
    *to++ = (char)('0' + size % 10);
    return to;
}

COLD static char *write_positive(char *to, uint64_t bits, int digits) {
    Expansion e;
    expand(&e, bits);
    for (int n = digits ? digits : 6;; n = n < 15 ? 15 : n + 1) {
        int tail = e.digits.n > n ? e.digits.n - n : 0;
        bool up = rounds_up(&e.digits, tail);
        if (!digits && n < MOST_DIGITS && !reads_back(&e, tail, up)) continue;
        round_off(&e, tail, up);
        bool scientific = e.exponent < -3 || e.exponent > n;
        to = write_digits(to, &e.digits, tail, scientific ? 1 : e.exponent);
        return scientific ? write_exponent(to, e.exponent - 1) : to;
    }
}

COLD size_t format_decimal(double x, int digits, char text[DECIMAL_TEXT_SIZE]) {
    char *at = text;
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bool negative = bits >> 63;
    bits &= UINT64_MAX >> 1;
    if (negative && x == x) *at++ = '-';
    if (x != x) at = copy(at, "nan");
    else if (bits >> 52 == 0x7FF) at = copy(at, "inf");
    else if (!bits) at = copy(at, "0");
    else at = write_positive(at, bits, digits);
    *at = 0;
    return (size_t)(at - text);
}
