/* SPDX-License-Identifier: Apache-2.0 */
/* chebyshev.h - Runge-Kutta-Chebyshev methods of second order: their recurrence, and the table that
 * it comes to. */
#ifndef FP3_CHEBYSHEV_H
#define FP3_CHEBYSHEV_H

#include <fp3/model.h>

enum {
    FP3_CHEBYSHEV_LEAST = 2, /* stages */
    FP3_CHEBYSHEV_MOST = 20, /* roundings were measured up to here: docs/integrators.md */
};

/* Fills all that a method of `stages` stages, FP3_CHEBYSHEV_LEAST to FP3_CHEBYSHEV_MOST, has:
 * table->stages is one more, as the estimate of the error has the slope at the new state.
 * Sommeijer, Shampine and Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl.
 * Math. 88 (1997). */
void fp3_chebyshev_make(fp3_integrator *table, unsigned stages, double damping);

#endif
