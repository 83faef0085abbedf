/* SPDX-License-Identifier: Apache-2.0 */
/* sight.h - who sees whom in a scene: links as they are given, and near objects. */
#ifndef FP3_LAB_SIGHT_H
#define FP3_LAB_SIGHT_H

#include "crowd.h"

/* Links, and room for lists of near objects. FP3_E_ARGUMENT: links are missing, or of objects that
 * there are not. What it makes, fp3_crowd_close frees. */
fp3_status fp3_sight_open(fp3_crowd *crowd, fp3_error *error);
/* Lists of near objects for these states: of each group, its columns. Who has stopped sees nobody.
 */
fp3_status fp3_sight_look(fp3_crowd *crowd, double *const *states, fp3_error *error);
/* The next look makes all lists anew. */
void fp3_sight_forget(fp3_crowd *crowd);

#endif
