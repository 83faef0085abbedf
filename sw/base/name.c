/* SPDX-License-Identifier: Apache-2.0 */
/* name.c - what is a name, in programs and models. */
#include <fp3/image.h>
#include <string.h>

int fp3_name_valid(const char *text) {
    static const char *const reserved[] = {"first", "step", "last", "inf", "nan"};
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
        if (!strcmp(text, reserved[i]))
            return 0;
    /* Not isalpha: that depends on the locale. */
    size_t length = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
    return length > 0 && length < FP3_NAME_SIZE && !text[length] && !(*text >= '0' && *text <= '9');
}
