/* SPDX-License-Identifier: Apache-2.0 */
/* run_growth.h - whether the time step of a run was too long for the forces in it: by how much one
 * step of the method enlarges a small disturbance (lab/scene/spectrum.h).
 *
 *     fp3_run_growth *of = NULL;
 *     fp3_status status = fp3_run_growth_open(set, &of, error);
 *     if (!status)
 *         status = fp3_run_growth_look(of, columns, 1, error);
 *     fp3_run_growth_text(of, text);
 *     fp3_run_growth_close(&of);
 */
#ifndef FP3_CHECK_RUN_GROWTH_H
#define FP3_CHECK_RUN_GROWTH_H

#include "run_set.h"

typedef struct fp3_run_growth fp3_run_growth;

/* The caller closes *of, which is NULL on failure, and where nothing is looked at: objects that do
 * not see each other, and adaptive steps. Every function here takes NULL. */
fp3_status fp3_run_growth_open(const fp3_run_set *set, fp3_run_growth **of, fp3_error *error);
/* Sets *of to NULL, which it may be already. */
void fp3_run_growth_close(fp3_run_growth **of);

/* Keeps the largest growth of all looks. columns: of each part, the states at this share of the
 * run, of a number for each object. */
fp3_status fp3_run_growth_look(fp3_run_growth *of, const double *const *columns, double share,
                               fp3_error *error);

/* What is said of it; "" if nothing grows. */
#define FP3_RUN_GROWTH_TEXT_SIZE 320
void fp3_run_growth_text(const fp3_run_growth *of, char text[FP3_RUN_GROWTH_TEXT_SIZE]);

/* Looks at the end of the run, at its start, and where few objects see each other in the end, at
 * some of them side by side. Says a warning, and adds it to *warnings. path: of a run without a
 * scene. */
fp3_status fp3_run_growth_warn(const fp3_run_set *set, fp3_run_say_fn *say, const char *path,
                               size_t *warnings, fp3_error *error);

#endif
