/* SPDX-License-Identifier: Apache-2.0 */
/* conditions.h - how far an integrator is from the conditions of each order. */
#ifndef FP3_CONDITIONS_H
#define FP3_CONDITIONS_H

#include <fp3/model.h>

#include "trees.h"

/* A condition holds within this. Residuals are sums and products of doubles, and published
 * coefficients have 14 digits or more. */
#define FP3_CONDITION_TOLERANCE 1e-10

typedef struct {
    double residual;          /* elementary weight - 1/gamma, of the tree where it is largest */
    char tree[FP3_TREE_TEXT]; /* "" where an order has no condition */
    int is_kick;              /* splitting: the tree's root is a velocity, else a position */
} fp3_condition;

/* Of a Runge-Kutta method or a splitting. worst[n] is the condition of order n that is furthest
 * off, n = 1 .. FP3_TREE_ORDER; worst[0] is not written. */
void fp3_conditions(const fp3_integrator *integrator, fp3_condition worst[FP3_TREE_ORDER + 1]);

#endif
