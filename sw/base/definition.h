/* SPDX-License-Identifier: Apache-2.0 */
/* definition.h - what stands in front of each public definition (fp3_batch_def and its like): a
 * cookie with the size that the definition has in the headers of the calling program.
 *
 * fp3_NAME_default() is inline, so it compiles that size into the caller. A definition that begins
 * with anything else was not made by it, and is refused.
 */
#ifndef FP3_DEFINITION_H
#define FP3_DEFINITION_H

#include <fp3/status.h>
#include <stddef.h>

/* For fp3_NAME_set_default: clears a definition of `size` bytes and writes its cookie. Whether the
 * library's has the same size, `here`: only then the other defaults may be written. */
int fp3_definition_begin(void *def, size_t size, size_t here);

/* FP3_E_ARGUMENT unless def, which begins with its cookie, has this size. name: "fp3_batch_def". */
fp3_status fp3_definition_check(const void *def, size_t here, const char *name, fp3_error *error);

/* For a definition that has its error behind the cookie: that error, or NULL where the definition
 * is uninitialised memory, so that any pointer in it may be wild. A cookie 0 is that of a
 * definition without its default, with pointers of the caller. */
fp3_error *fp3_definition_error(const void *def, fp3_error *error);

#endif
