/* SPDX-License-Identifier: Apache-2.0 */
/* theory.h - what an integrator does to x' = v, v' = -k x - c v, from its table alone, in double.
 *
 * With a time step of 1. The eigenvalues are -z e^(+-i angle), so k = z^2 and c = 2 z cos(angle):
 * angle 0 is decay, a quarter turn the undamped oscillator.
 */
#ifndef FP3_STRESS_THEORY_H
#define FP3_STRESS_THEORY_H

#include <fp3/model.h>

/* The magnitude of the largest eigenvalue of a step: |R| of a Runge-Kutta or Chebyshev method, for
 * others that of the matrix of its substeps. */
double fp3_theory_growth(const fp3_integrator *integrator, double z, double angle);
/* The smallest z above which something grows; 0: at once; infinite: none (linearly implicit
 * methods). */
double fp3_theory_limit(const fp3_integrator *integrator, double angle);
/* The smallest z at which the largest eigenvalue to the power of steps is gain. */
double fp3_theory_onset(const fp3_integrator *integrator, double angle, double steps, double gain);
/* The largest c of x' = v, v' = -c v with which v does not grow. */
double fp3_theory_damped(const fp3_integrator *integrator);

#endif
