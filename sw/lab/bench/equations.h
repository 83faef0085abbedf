/* SPDX-License-Identifier: Apache-2.0 */
/* equations.h - a model as text for other solvers: C for a compiler, Python for JAX.
 *
 * C, with `real` as the type of all numbers, and STATES and PARAMS as their counts:
 *     static inline void slopes(real t, const real *y, const real *p, real *d);
 *     static inline void events(real began, const real *was, real t, real *y, const real *p);
 * Python:
 *     def slopes(t, y, p): ...    returns the derivatives as a tuple
 * Only what a derivative or an event needs is computed. In C whole powers up to
 * 4 are products, as people write them; with LIBM_POWERS defined, those of libm for floats.
 */
#ifndef FP3_BENCH_EQUATIONS_H
#define FP3_BENCH_EQUATIONS_H

#include <fp3/model.h>

typedef enum { FP3_BENCH_DOUBLE, FP3_BENCH_FLOAT, FP3_BENCH_PYTHON } fp3_bench_language;

/* The caller frees *text, which is NULL on failure. FP3_E_ARGUMENT: Python, and there are events or
 * projections. */
fp3_status fp3_bench_equations(const fp3_model *model, fp3_bench_language language, char **text,
                               fp3_error *error);

#endif
