/* SPDX-License-Identifier: Apache-2.0 */
/* derive.h - inputs of a compiled program that are computed from fields: which inputs have to be
 * computed again, for which objects. */
#ifndef FP3_BATCH_DERIVE_H
#define FP3_BATCH_DERIVE_H

#include "field.h"

typedef struct fp3_derive fp3_derive;

/* The table, and everything that def points to, must outlive *derive. Nothing has been computed
 * yet. The caller closes *derive, which is NULL on failure. */
fp3_status fp3_derive_open(const fp3_fields_def *def, const fp3_field_table *table,
                           fp3_derive **derive, fp3_error *error);
/* Sets *derive to NULL, which it may be already. */
void fp3_derive_close(fp3_derive **derive);

/* A kept field of objects first .. first+count-1 has another value. */
void fp3_derive_note(fp3_derive *derive, const fp3_field *q, size_t first, size_t count);
/* The object begins anew: all that is its own has to be computed, what it starts with, too. */
void fp3_derive_born(fp3_derive *derive, size_t object);
/* All objects begin again. */
void fp3_derive_restart(fp3_derive *derive);
/* A step was made: what an object starts with is no input any more. */
void fp3_derive_moved(fp3_derive *derive);

/* Computes what has changed and gives it to the engine. After a failure it is still to be done. */
fp3_status fp3_derive_settle(fp3_derive *derive, fp3_error *error);

#endif
