/* reference.h - a step's graph evaluated node by node, in FP32 or in double. */
#ifndef FP3_REFERENCE_H
#define FP3_REFERENCE_H

#include "compiler/build.h"

/* b has carried nothing. start: of each variable; it is overwritten. states: in row i, of each state of the model that
 * is a variable, its value after steps[i] steps. is_exact: nothing is rounded to FP32, and estimates are what they
 * estimate. */
fp3_status fp3_reference_run(const build *b, const double *params, double h, int is_exact,
                             double *start, const uint64_t *steps, size_t count, double *states,
                             fp3_error *error);

#endif
