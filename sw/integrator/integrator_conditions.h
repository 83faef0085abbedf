/* integrator_conditions.h - how far an integrator is from the conditions of each order. */
#ifndef FP3_INTEGRATOR_CONDITIONS_H
#define FP3_INTEGRATOR_CONDITIONS_H

#include <fp3/integrator.h>

#include "trees.h"

/* Coefficients are sums and products of doubles, and published ones have 14 digits or more. */
#define FP3_CONDITION_TOLERANCE 1e-10

typedef struct {
    double residual;          /* elementary weight - 1/gamma, of the tree where it is largest */
    char tree[FP3_TREE_TEXT]; /* "" where an order has no condition */
    int is_kick;              /* splitting: the tree's root is a velocity, else a position */
} fp3_condition;

/* worst[n] is of order n, 1 .. FP3_TREE_ORDER; worst[0] is not written. For Runge-Kutta and
 * splittings. */
void fp3_conditions(const fp3_integrator *integrator, fp3_condition worst[FP3_TREE_ORDER + 1]);

/* NaN is no zero either. */
int fp3_condition_holds(const fp3_condition *condition);

#endif
