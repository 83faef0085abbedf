/* SPDX-License-Identifier: Apache-2.0 */
/* conditions.c - order conditions of Runge-Kutta methods and of splittings.
 *
 * A method has order p if the elementary weight of every rooted tree with at most p vertices is
 * 1/gamma: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, theorem II.2.13.
 * A splitting of x' = v, v' = a(x) is a partitioned Runge-Kutta method: its trees have vertices of
 * two colours in turn, and one for a position has one child at most, since x' is linear: Hairer,
 * Lubich and Wanner, Geometric Numerical Integration, chapter III.2.
 * Of a Rosenbrock method, a vertex with one child has the weights A + Gamma, any other A: Hairer
 * and Wanner, Solving Ordinary Differential Equations II, theorem IV.7.3.
 */
#include "conditions.h"

#include <math.h>

/* Keeps the residual of a tree if it is the largest so far, or NaN. */
static void keep(const fp3_tree *trees, unsigned tree, double weight, int is_kick,
                 fp3_condition *worst) {
    const double residual = weight - 1 / trees[tree].gamma;
    if (worst->tree[0] && !isnan(residual) && !(fabs(residual) > fabs(worst->residual)))
        return;
    fp3_tree_text(trees, tree, worst->tree);
    worst->residual = residual;
    worst->is_kick = is_kick;
}

static void of_runge_kutta(const fp3_integrator *method, const fp3_tree *trees,
                           fp3_condition *worst) {
    /* Weight of each tree as a child, by stage: of several children, and of an only one. */
    double inner[FP3_TREE_COUNT][FP3_STAGES_MAX], only[FP3_TREE_COUNT][FP3_STAGES_MAX];
    for (unsigned tree = 0; tree < FP3_TREE_COUNT; tree++) {
        double weight = 0, at[FP3_STAGES_MAX];
        for (unsigned i = 0; i < method->stages; i++) {
            at[i] = 1;
            for (unsigned child = 0; child < trees[tree].child_count; child++)
                at[i] *= (trees[tree].child_count == 1 ? only : inner)[trees[tree].child[child]][i];
            weight += method->b[i] * at[i];
            inner[tree][i] = 0;
            for (unsigned j = 0; j < i; j++)
                inner[tree][i] += method->a[i][j] * at[j];
            only[tree][i] = inner[tree][i];
            for (unsigned j = 0; j <= i; j++)
                only[tree][i] += method->gamma[i][j] * at[j];
        }
        keep(trees, tree, weight, 0, &worst[trees[tree].order]);
    }
}

/* The second index is the colour of a tree's root: 0 a drift, 1 a kick. */
typedef struct {
    int exists[FP3_TREE_COUNT][2];
    double before[FP3_TREE_COUNT][2]
                 [FP3_STAGES_MAX + 1]; /* sums over the substeps before each one */
} coloured;

static int exists(const coloured *c, const fp3_tree *tree, int is_kick) {
    if (!is_kick && tree->child_count > 1)
        return 0;
    for (unsigned child = 0; child < tree->child_count; child++)
        if (!c->exists[tree->child[child]][!is_kick])
            return 0;
    return 1;
}

static void of_splitting(const fp3_integrator *method, const fp3_tree *trees,
                         fp3_condition *worst) {
    coloured c = {0};
    for (unsigned tree = 0; tree < FP3_TREE_COUNT; tree++) {
        for (int is_kick = 0; is_kick < 2; is_kick++) {
            c.exists[tree][is_kick] = exists(&c, &trees[tree], is_kick);
            if (!c.exists[tree][is_kick])
                continue;
            double *before = c.before[tree][is_kick];
            before[0] = 0;
            for (unsigned i = 0; i < method->stages; i++) {
                double at = method->substeps[i].is_kick == is_kick;
                for (unsigned child = 0; child < trees[tree].child_count; child++)
                    at *= c.before[trees[tree].child[child]][!is_kick][i];
                before[i + 1] = before[i] + method->substeps[i].coefficient * at;
            }
            keep(trees, tree, before[method->stages], is_kick, &worst[trees[tree].order]);
        }
    }
}

void fp3_conditions(const fp3_integrator *integrator, fp3_condition worst[FP3_TREE_ORDER + 1]) {
    fp3_tree trees[FP3_TREE_COUNT];
    fp3_trees(trees);
    for (unsigned order = 1; order <= FP3_TREE_ORDER; order++)
        worst[order] = (fp3_condition){0};
    if (integrator->kind == FP3_SPLITTING)
        of_splitting(integrator, trees, worst);
    else
        of_runge_kutta(integrator, trees, worst);
}

/* A residual that is NaN does not hold. */
static int holds(const fp3_condition *condition) {
    return fabs(condition->residual) <= FP3_CONDITION_TOLERANCE;
}

unsigned fp3_integrator_order(const fp3_integrator *integrator, double *worst, double *next) {
    fp3_condition conditions[FP3_TREE_ORDER + 1];
    *worst = *next = 0;
    if (integrator->kind == FP3_STOERMER) {
        /* The local error is h^4 x''''/12; summed twice, it gives a second-order error. */
        *next = 1.0 / 12;
        return 2;
    }
    fp3_conditions(integrator, conditions);
    unsigned order = 0;
    while (order < FP3_TREE_ORDER && holds(&conditions[order + 1])) {
        order++;
        *worst = fmax(*worst, fabs(conditions[order].residual));
    }
    if (order < FP3_TREE_ORDER)
        *next = fabs(conditions[order + 1].residual);
    return order;
}
