/* Numbers as texts, exactly and without a C library. */
#ifndef DECIMAL_H
#define DECIMAL_H

#include <stddef.h>
#include "portable.h"

enum { DECIMAL_ROOM = 32 }; /* bytes that a text of a number needs at most, its end included */

/* The number in the fewest of 6, 15, 16 or 17 significant digits that read back as the same number; "nan", "inf" or
 * "-inf" for what is none. The form is that of C's %g with so many digits, with a point whatever the locale is. Answers
 * the length of the text. */
size_t decimal(double x, char text[DECIMAL_ROOM]);

#endif
