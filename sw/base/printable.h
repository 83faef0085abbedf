/* SPDX-License-Identifier: Apache-2.0 */
/* printable.h - text of files and names on its way to a terminal, which must not be told to do
 * anything by it. */
#ifndef FP3_PRINTABLE_H
#define FP3_PRINTABLE_H

#include <stddef.h>

/* Byte i of a text that ends with 0; '?' for control characters, those of UTF-8 (U+0080 to U+009F,
 * two bytes), too. The text before it may have been replaced already. */
static inline char fp3_printable(const char *text, size_t i) {
    const unsigned char *c = (const unsigned char *)&text[i];
    const int is_first = c[0] == 0xc2 && (c[1] & 0xe0) == 0x80;
    const int is_second = (c[0] & 0xe0) == 0x80 && (i == 0 || c[-1] == 0xc2 || c[-1] == '?');
    return *c < ' ' || *c == 0x7f || is_first || is_second ? '?' : text[i];
}

#endif
