/* SPDX-License-Identifier: Apache-2.0 */
/* runge_kutta.h - a step of a Runge-Kutta method, as its table says. */
#ifndef FP3_RUNGE_KUTTA_H
#define FP3_RUNGE_KUTTA_H

#include "compiler/step/advance.h"

/* a->now and a->lost become those after the step. */
fp3_status fp3_runge_kutta(fp3_advance *a, fp3_error *error);

#endif
