/* SPDX-License-Identifier: Apache-2.0 */
/* recording.h - a recording as fp3 run writes it (docs/outputs.md), read again: names first, values
 * when it is known which are wanted.
 *
 *     fp3_view_recording *r = NULL;
 *     if (fp3_view_open("orbit.h5", &r, error) || fp3_view_want(r, "x_x", &column, error) ||
 * fp3_view_load(r, 1, error))
 *         ...
 *     fp3_view_close(&r);
 */
#ifndef FP3_VIEW_RECORDING_H
#define FP3_VIEW_RECORDING_H

#include "recorded.h"

/* The caller closes *r, which is NULL on failure. FP3_E_ARGUMENT: it is no recording; the message
 * begins with the path and, for CSV, the line and the column. */
fp3_status fp3_view_open(const char *path, fp3_view_recording **r, fp3_error *error);
void fp3_view_close(fp3_view_recording **r);

/* Reads every N-th snapshot, from the first on, of all that is wanted. FP3_E_ARGUMENT: a broken
 * file, nothing in it, or too much. */
fp3_status fp3_view_load(fp3_view_recording *r, uint64_t every, fp3_error *error);

#endif
