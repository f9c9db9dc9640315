/* Numbers as texts, exactly and without a C library. */
#ifndef DECIMAL_H
#define DECIMAL_H

#include <stddef.h>
#include "portable.h"

enum { DECIMAL_TEXT_SIZE = 32 }; /* bytes that the text of a number needs at most, with its end */

/* The number in so many significant digits, up to 17; with 0 in the fewest of 6, 15, 16 or 17 that read back as the same
 * number. "nan", "inf" or "-inf" for what is no number. The form is that of C's %g with as many digits, with a point whatever
 * the locale is. Returns the length of the text. */
size_t format_decimal(double x, int digits, char text[DECIMAL_TEXT_SIZE]);

#endif
