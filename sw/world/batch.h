/* SPDX-License-Identifier: Apache-2.0 */
/* batch.h - what the project itself asks of a batch besides fp3/batch.h. */
#ifndef FP3_BATCH_BATCH_H
#define FP3_BATCH_BATCH_H

#include <fp3/batch.h>

/* Objects first .. first+count-1 from rows as a model's truth takes them: param_count and
 * state_count numbers each. Shared values are those of the first row. initial: NULL: starts stay.
 */
fp3_status fp3_batch_write_rows(fp3_batch *batch, size_t first, size_t count, const double *params,
                                const double *initial);

#endif
