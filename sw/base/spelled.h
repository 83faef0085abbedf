/* SPDX-License-Identifier: Apache-2.0 */
/* spelled.h - a text of settings as libconfig may read it, and its numbers as they are spelled.
 *
 * libconfig keeps 32 bits of an integer, or of a hexadecimal number as a negative one, and makes of
 * a decimal 0 or an infinity without a word. So each number is replaced by its index in a list,
 * which libconfig takes unchanged, and the list says what stood there. Lines stay as they are.
 */
#ifndef FP3_SPELLED_H
#define FP3_SPELLED_H

#include <base/token.h>
#include <fp3/status.h>

typedef struct {
    char *text;         /* for libconfig */
    fp3_token *numbers; /* into the source, which must outlive them */
    size_t count;
} fp3_spelled;

/* FP3_E_ARGUMENT, with "name:line: ...": what libconfig would read as something else, or slowly: an
 * unended comment or text, @include, a NUL, settings beyond the limits of docs/scenes.md. The
 * caller closes *made, also after a failure. */
fp3_status fp3_spelled_open(const char *source, size_t size, const char *name, fp3_spelled *made,
                            fp3_error *error);
void fp3_spelled_close(fp3_spelled *spelled);

#endif
