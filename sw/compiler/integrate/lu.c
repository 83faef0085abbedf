/* SPDX-License-Identifier: Apache-2.0 */
/* lu.c - elimination on terms: what is 0 costs nothing. */
#include "lu.h"

#include "compiler/functions/division.h"
#include "compiler/value/ops.h"

static int is_zero(term t) { return t.node == FP3_NONE; }

void fp3_lu_open(fp3_lu *lu, dag *g, uint32_t count) {
    *lu = (fp3_lu){.g = g, .count = count};
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < count; j++)
            lu->cell[i][j] = fp3_term(FP3_NONE);
}

/* c - a b, where each may be 0. */
static term less_product(dag *g, term c, term a, term b) {
    if (is_zero(a) || is_zero(b))
        return c;
    const term p = fp3_term_mul(g, a, b);
    return is_zero(c) ? fp3_term_negated(p) : fp3_term_sub(g, c, p);
}

/* How many cells an elimination with this pivot touches at most. */
static uint32_t price(const fp3_lu *lu, const char *is_done, uint32_t pivot) {
    uint32_t rows = 0, columns = 0;
    for (uint32_t i = 0; i < lu->count; i++)
        if (!is_done[i] && i != pivot) {
            rows += !is_zero(lu->cell[i][pivot]);
            columns += !is_zero(lu->cell[pivot][i]);
        }
    return rows * columns;
}

static uint32_t cheapest(const fp3_lu *lu, const char *is_done) {
    uint32_t best = FP3_NONE;
    for (uint32_t i = 0; i < lu->count; i++)
        if (!is_done[i] && (best == FP3_NONE || price(lu, is_done, i) < price(lu, is_done, best)))
            best = i;
    return best;
}

term fp3_one_over(dag *g, term x) {
    if (g->is_abstract)
        return (term){op2(g, NODE_QUOTIENT, num(g, 1), x.node), x.is_negative};
    return (term){fp3_quotient(g, one(g), x.node).node, x.is_negative};
}

/* The pivot, or 0 where it has cancelled. */
static term checked(dag *g, term pivot, term diagonal) {
    if (pivot.node == diagonal.node)
        return pivot;
    const uint32_t least = mul(g, num(g, FP3_LU_LEAST), op1(g, FP3_OP_ABS, diagonal.node));
    const uint32_t is_good = op2(g, FP3_OP_LT, least, op1(g, FP3_OP_ABS, pivot.node));
    return (term){sel(g, is_good, pivot.node, num(g, 0)), pivot.is_negative};
}

static void eliminate(fp3_lu *lu, const char *is_done, uint32_t pivot) {
    dag *g = lu->g;
    for (uint32_t i = 0; i < lu->count; i++) {
        if (is_done[i] || i == pivot || is_zero(lu->cell[i][pivot]))
            continue;
        const term factor = fp3_term_mul(g, lu->cell[i][pivot], lu->inverse[pivot]);
        lu->cell[i][pivot] = factor;
        for (uint32_t j = 0; j < lu->count; j++)
            if (!is_done[j] && j != pivot)
                lu->cell[i][j] = less_product(g, lu->cell[i][j], factor, lu->cell[pivot][j]);
    }
}

void fp3_lu_factor(fp3_lu *lu) {
    char is_done[FP3_LU_MOST] = {0};
    term diagonal[FP3_LU_MOST];
    for (uint32_t i = 0; i < lu->count; i++)
        diagonal[i] = lu->cell[i][i];
    for (uint32_t n = 0; n < lu->count; n++) {
        const uint32_t pivot = cheapest(lu, is_done);
        const term was = diagonal[pivot], now = lu->cell[pivot][pivot];
        const term at = checked(lu->g, now, now.node == was.node ? lu->summand[pivot] : was);
        lu->order[n] = pivot;
        lu->inverse[pivot] = fp3_one_over(lu->g, at);
        eliminate(lu, is_done, pivot);
        is_done[pivot] = 1;
    }
}

void fp3_lu_solve(const fp3_lu *lu, term *x) {
    dag *g = lu->g;
    for (uint32_t n = 0; n < lu->count; n++)
        for (uint32_t m = 0; m < n; m++) {
            const uint32_t i = lu->order[n], j = lu->order[m];
            x[i] = less_product(g, x[i], lu->cell[i][j], x[j]);
        }
    for (uint32_t n = lu->count; n-- > 0;) {
        const uint32_t i = lu->order[n];
        for (uint32_t m = n + 1; m < lu->count; m++)
            x[i] = less_product(g, x[i], lu->cell[i][lu->order[m]], x[lu->order[m]]);
        if (!is_zero(x[i]))
            x[i] = fp3_term_mul(g, x[i], lu->inverse[i]);
    }
}
