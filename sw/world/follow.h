/* SPDX-License-Identifier: Apache-2.0 */
/* follow.h - starts that a model computes from params (`state x = x0`). As with `fp3 run --set`,
 * starts follow written params, unless the start is written itself. */
#ifndef FP3_BATCH_FOLLOW_H
#define FP3_BATCH_FOLLOW_H

#include "derive.h"

/* The start of objects first .. first+count-1 is written: it follows nothing any more. */
fp3_status fp3_follow_not(fp3_field *q, size_t first, size_t count, size_t objects,
                          fp3_error *error);

/* These objects are born: their starts follow params, as the model says. */
fp3_status fp3_follow_again(fp3_field *q, size_t first, size_t count, size_t objects,
                            fp3_error *error);

/* Computes the starts of objects with is_new again. After a failure this is still to be done. */
fp3_status fp3_follow_new(const fp3_fields_def *def, const fp3_field_table *table,
                          const unsigned char *is_new, fp3_error *error);
/* Computes the starts with written params again. After a failure this is still to be done. */
fp3_status fp3_follow(const fp3_fields_def *def, const fp3_field_table *table, uint64_t written,
                      fp3_derive *derive, fp3_error *error);

#endif
