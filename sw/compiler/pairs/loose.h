/* SPDX-License-Identifier: Apache-2.0 */
/* loose.h - pairs that are not renormalised: sums and products of a step.
 *
 * A sum of pairs takes 8 operations instead of 20, a product about two thirds. The price: the error
 * of a sum that cancels is relative to its terms, as with floats, not to the sum. Sources: Lange
 * and Rump, Faithfully rounded floating-point computations, ACM TOMS 46 (2020); Graillat, Langlois
 * and Louvet, Algorithms for accurate, validated and fast polynomial evaluation, Japan J. Indust.
 * Appl. Math. 26 (2009).
 */
#ifndef FP3_LOOSE_H
#define FP3_LOOSE_H

#include "double_single.h"

/* Stands for high + low, or high - low. |low| is at most `spread` u of the value's size: of a
 * float, a known value, a state or a normalised pair its magnitude, of a sum the sum of both sizes,
 * of a product their product. */
typedef struct {
    fp3_pair words;
    int is_less;  /* it is high - low */
    int is_rough; /* high need not be the value, rounded */
    unsigned spread;
} fp3_loose;

/* No spread is larger: a result that had a larger one is renormalised. */
#define FP3_SPREAD_MOST 4

fp3_loose fp3_loose_of(fp3_pair x); /* a normalised pair */
fp3_loose fp3_loose_negated(dag *g, fp3_loose x);

/* With the spreads k and l of the operands, errors in units of u^2 of the size of the result: at
 * most 2 + 3 max(k, l) for sums and 2 + 4 k + 4 l + k l for products; by 2^n exact. For normalised
 * operands: 3 and 8. x y has the words of y x, and x + y has the words of y + x. */
fp3_loose fp3_loose_add(dag *g, fp3_loose x, fp3_loose y);
fp3_loose fp3_loose_sub(dag *g, fp3_loose x, fp3_loose y);
fp3_loose fp3_loose_mul(dag *g, fp3_loose x, fp3_loose y);

/* Renormalised, without an error: high is the sum, rounded. */
fp3_pair fp3_loose_pair(dag *g, fp3_loose x);
/* That word alone. */
uint32_t fp3_loose_first(dag *g, fp3_loose x);

#endif
