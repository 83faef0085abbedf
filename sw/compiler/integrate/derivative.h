/* SPDX-License-Identifier: Apache-2.0 */
/* derivative.h - a model with the partial derivatives of its equations. */
#ifndef FP3_DERIVATIVE_H
#define FP3_DERIVATIVE_H

#include <fp3/model.h>

typedef struct {
    fp3_model model;   /* another's, with more expressions; the other must outlive it */
    uint32_t *partial; /* [state * (state_count + 1) + by]: an expression, FP3_NONE: 0 */
    uint32_t *rate; /* of each event: how fast b - a of its condition a <= b grows; FP3_NONE: not at
                       all, or no such condition */
} fp3_differentiated;

/* By each state and, last, by t. A selection is differentiated on the chosen side, and a comparison
 * is constant. Of a sum over neighbours it is the sum of derivatives by the object's own
 * states; a least or a most over neighbours counts as constant. has_partial: 0: only rates are
 * computed, and all of `partial` is FP3_NONE. FP3_E_SYSTEM: out of memory. The caller closes, after
 * a failure too. */
fp3_status fp3_differentiate(const fp3_model *model, int has_partial, fp3_differentiated *made,
                             fp3_error *error);
void fp3_differentiated_close(fp3_differentiated *made);

#endif
