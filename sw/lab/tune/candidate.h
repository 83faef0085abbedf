/* SPDX-License-Identifier: Apache-2.0 */
/* candidate.h - an integrator with an arithmetic, as a program, and what it costs. */
#ifndef FP3_TUNE_CANDIDATE_H
#define FP3_TUNE_CANDIDATE_H

#include <fp3/compile.h>

/* An integrator with an arithmetic, and fixed or adaptive steps, or fixed ones that are cut at
 * events. */
typedef struct {
    fp3_integrator *integrator;
    fp3_arithmetic arithmetic;
    int is_adaptive, is_cut; /* at most one */
    double maxstep;          /* the longest step, if it is; 0: none */
    fp3_model *adapted;      /* what the programs are of, if it is adaptive or cut */
    fp3_compiled *timed;     /* for the configuration that costs are of; NULL: not compiled yet */
    fp3_compiled *measured;  /* for fp3_meter_config of it; the same pointer where that is it */
    int is_refused;          /* by the compiler */
} fp3_candidate;

void fp3_candidate_free(fp3_candidate *candidate);

/* FP3_E_PROGRAM and FP3_E_LIMIT: the model cannot be compiled so. */
fp3_status fp3_candidate_compile(fp3_candidate *candidate, const fp3_model *model,
                                 const char *config, fp3_error *error);

/* For an object over so many steps, or attempts: a mean need not be whole. All contexts full; 0:
 * not known beforehand. */
double fp3_candidate_cycles(const fp3_candidate *candidate, const char *config, double steps);

#endif
