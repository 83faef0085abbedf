/* SPDX-License-Identifier: Apache-2.0 */
/* run_invariants.h - what a run made of the invariants of all objects together (invariants.h).
 *
 *     fp3_run_invariants *of = NULL;
 *     if (!fp3_run_invariants_open(set, &of, error) && !fp3_run_invariants_end(of, error))
 *         fp3_run_invariants_print(of);
 *     fp3_run_invariants_close(&of);
 */
#ifndef FP3_CHECK_RUN_INVARIANTS_H
#define FP3_CHECK_RUN_INVARIANTS_H

#include "second.h"

typedef struct fp3_run_invariants fp3_run_invariants;

/* Finds them at the start. The caller closes *of, which is NULL on failure, and if the set has no
 * such invariant, or objects that come and go; every function here takes NULL. is_quick: NULL, too,
 * if the sums have so many terms that they would take longer than a moment. */
fp3_status fp3_run_invariants_open(const fp3_run_set *set, int is_quick, fp3_run_invariants **of,
                                   fp3_error *error);
/* Sets *of to NULL, which it may be already. */
void fp3_run_invariants_close(fp3_run_invariants **of);

/* At the end of the run; at the end of the second one. */
fp3_status fp3_run_invariants_end(fp3_run_invariants *of, fp3_error *error);
fp3_status fp3_run_invariants_end_again(fp3_run_invariants *of, const fp3_second *second,
                                        fp3_error *error);

/* A line for each. */
void fp3_run_invariants_print(const fp3_run_invariants *of);

/* The first one that has changed by more than bound, relative to its size, or has no value; a text
 * of it, or "" if there is none. */
#define FP3_RUN_INVARIANTS_TEXT_SIZE 160
void fp3_run_invariants_judge(const fp3_run_invariants *of, double bound,
                              char text[FP3_RUN_INVARIANTS_TEXT_SIZE]);

#endif
