/* SPDX-License-Identifier: Apache-2.0 */
/* lu.h - a sparse system of linear equations, solved by instructions without pivoting. */
#ifndef FP3_LU_H
#define FP3_LU_H

#include "compiler/step/options.h"
#include "compiler/value/term.h"

#define FP3_LU_MOST FP3_STATES_MAX /* equations */
/* A pivot that is smaller than this share of what it came from has lost its digits. */
#define FP3_LU_LEAST 0x1p-12

typedef struct {
    dag *g;
    uint32_t count;
    term cell[FP3_LU_MOST][FP3_LU_MOST]; /* node FP3_NONE: 0 */
    uint32_t order[FP3_LU_MOST];         /* of elimination */
    term inverse[FP3_LU_MOST];           /* of each pivot */
    term summand[FP3_LU_MOST]; /* of each diagonal: a part of it; the diagonal itself: it is no sum
                                */
} fp3_lu;

/* Empty: the caller fills `cell`, of which the diagonal is there, and `summand`. */
void fp3_lu_open(fp3_lu *lu, dag *g, uint32_t count);
/* In the order that fills fewest cells (Markowitz, 1957, on the diagonal). A pivot below
 * FP3_LU_LEAST of its diagonal, or a diagonal below FP3_LU_LEAST of its summand, counts as 0: its
 * reciprocal is a NaN and raises invalid, so that the object fails. */
void fp3_lu_factor(fp3_lu *lu);
/* x becomes the solution for the right-hand side x; FP3_NONE there: 0. */
void fp3_lu_solve(const fp3_lu *lu, term *x);

term fp3_one_over(dag *g, term x);

#endif
