/* SPDX-License-Identifier: Apache-2.0 */
#include "utf8.h"

/* The length of the character at p in bytes; 0 if there is none, or a control character. */
static size_t character(const unsigned char *p, size_t room) {
    if (*p < 0x80)
        return *p >= ' ' && *p != 0x7f;
    size_t length = *p >= 0xf0 ? 4 : *p >= 0xe0 ? 3 : 2;
    if (*p < 0xc2 || *p > 0xf4 || length > room)
        return 0;
    for (size_t i = 1; i < length; i++)
        if ((p[i] & 0xc0) != 0x80)
            return 0;
    /* No overlong forms, no surrogates, nothing above U+10FFFF, no control characters. */
    unsigned second = p[1];
    if ((*p == 0xc2 && second < 0xa0) || (*p == 0xe0 && second < 0xa0) ||
        (*p == 0xed && second > 0x9f) || (*p == 0xf0 && second < 0x90) ||
        (*p == 0xf4 && second > 0x8f))
        return 0;
    return length;
}

int fp3_ode_is_utf8(fp3_token t) {
    for (size_t i = 0; i < t.length;) {
        size_t length = character((const unsigned char *)t.text + i, t.length - i);
        if (!length)
            return 0;
        i += length;
    }
    return 1;
}
