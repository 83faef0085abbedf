/* SPDX-License-Identifier: Apache-2.0 */
/* plan.h - when each value of a step is computed, and which variable keeps it until it is used.
 *
 * `when` of a node is phase * SLOTS + slot. Straight code has even slots, loops have odd ones.
 */
#ifndef FP3_PHASES_PLAN_H
#define FP3_PHASES_PLAN_H

#include "compiler/step/step.h"

#define FP3_CUT_SLOTS 16u
#define FP3_CUT_PHASES 64u
#define FP3_CUT_OPERANDS 4 /* of a fold of pairs */

typedef struct fp3_cut_plan {
    fp3_step *step;
    const dag *g;
    uint64_t published;         /* states of the model that neighbours read */
    uint32_t base, phase_count; /* phases of the step before these; these */
    uint32_t words;             /* of states: word * states + state */
    /* Of each node: */
    uint32_t *when; /* of one in a loop: of what it reads from outside */
    char *is_body;  /* it depends on a neighbour */
    char *is_needed;
    char *is_held;    /* a variable keeps it from its section on: */
    uint32_t *holder; /* ... this one */
    uint32_t *until;  /* ... up to this `when`, of the last section that reads it */
    char *in_kept;    /* the loops that write fields read it */
    uint32_t kept;    /* `when` of these loops */
    uint32_t *shown;  /* [phase * words + word]: node that neighbours see; or FP3_NONE */
    uint32_t *held;   /* [phase * own + variable]: node whose value it has, from begin to end */
    uint32_t own;     /* variables that the step had before */
    uint64_t handled; /* places that the step shows (fp3_coupling), as far as ... */
    uint32_t phase_of[FP3_PLACES];                 /* ... it is known in which phase */
    uint32_t slots[FP3_CUT_PHASES];                /* the last slot of each phase, an even one */
    uint32_t pool[2 * FP3_STATES_MAX], pool_count; /* the variables that keep nodes */
    int has_failed;
    /* May move nodes to later times, once it is known what is needed; NULL: they stay. */
    fp3_status (*refine)(struct fp3_cut_plan *plan, fp3_error *error);
} fp3_cut_plan;

/* Fills the plan, whose step, base and own are given; its pool may be that of an earlier plan.
 * FP3_E_LIMIT: too many phases, or values kept. The caller closes, after a failure too. */
fp3_status fp3_cut_plan_make(fp3_cut_plan *plan, fp3_error *error);
void fp3_cut_plan_close(fp3_cut_plan *plan);

/* The instruction of a fold's loop. */
uint32_t fp3_cut_fold_op(const fp3_cut_plan *plan, uint32_t fold);
/* Whether it is a leaf of a neighbour. */
int fp3_cut_is_neighbours(uint32_t op);
/* Operands that are nodes; those of both words of a fold of pairs are of each. */
unsigned fp3_cut_operands(const fp3_cut_plan *plan, uint32_t node, uint32_t list[FP3_CUT_OPERANDS]);
/* The variable that holds a node in this phase because it is its own; or FP3_NONE. */
uint32_t fp3_cut_holds(const fp3_cut_plan *plan, uint32_t node, uint32_t phase);
/* Which node a variable of the step gets at the end of a phase; FP3_NONE: it keeps what it has. */
uint32_t fp3_cut_gets(const fp3_cut_plan *plan, uint32_t phase, uint32_t variable);
/* Whether the variable keeps a value at some time between the end of one section and the end of
 * another. */
int fp3_cut_is_taken(const fp3_cut_plan *plan, uint32_t variable, uint32_t from, uint32_t to);
/* One more; its index. Without room 0, and the plan does not fit: nothing may be made of it. */
uint32_t fp3_cut_variable(fp3_cut_plan *plan, role role, uint32_t state);
uint32_t fp3_cut_pool(fp3_cut_plan *plan);
/* FP3_E_LIMIT: there are more kept values than variables. */
fp3_status fp3_cut_fits(const fp3_cut_plan *plan, fp3_error *error);
uint32_t *fp3_cut_filled(size_t count);

static inline const dag_node *fp3_cut_node(const fp3_cut_plan *plan, uint32_t node) {
    return &plan->g->nodes[node];
}

#endif
