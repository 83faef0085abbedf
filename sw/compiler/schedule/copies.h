/* SPDX-License-Identifier: Apache-2.0 */
/* copies.h - copies of old values.
 *
 * A node that reads the old value of a variable must issue before the variable is written. If it
 * cannot (it depends on the new value, or two variables each need the other's old value), an early
 * node copies the old value, and the late reader reads the copy.
 */
#ifndef FP3_COPIES_H
#define FP3_COPIES_H

#include "block.h"

/* Adds the copies that the block needs. */
fp3_status fp3_copies_add(fp3_block *block, fp3_error *error);

/* A reader of the variable that depends on another reader reads a copy instead, so that the
 * variable can be written sooner. *is_changed: whether there are such readers. */
fp3_status fp3_copies_split(fp3_block *block, uint32_t variable, int *is_changed, fp3_error *error);

#endif
