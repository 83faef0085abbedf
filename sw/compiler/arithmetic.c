/* SPDX-License-Identifier: Apache-2.0 */
/* arithmetic.c - what each arithmetic is called, what it implies, and what it is for. */
#include <fp3/compile.h>

#include <string.h>

#define KIND(kind) (1u << (kind))
#define ALL_KINDS (KIND(FP3_CHEBYSHEV + 1) - 1)

/* Folded: the coefficients of a splitting contain h anyway, and adaptive steps do not know h
 * beforehand. */
static const struct {
    fp3_arithmetic_facts facts;
    unsigned kinds; /* of integrators, whose programs differ from the plain ones */
    int is_for_adaptive;
} table[FP3_ARITHMETICS] = {
    [FP3_PLAIN] = {{"plain", "plain", 0}, ALL_KINDS, 1},
    [FP3_COMPENSATED] = {{"compensated", "compensated", 0}, ALL_KINDS, 1},
    [FP3_FOLDED] = {{"folded", "folded",
                     FP3_PASS(FP3_PASS_FOLD_STEP) | FP3_PASS(FP3_PASS_FOLD_PRODUCT)},
                    KIND(FP3_RUNGE_KUTTA),
                    0},
    [FP3_DOUBLE_SINGLE] = {{"double_single", "double-single", 0}, ALL_KINDS, 1},
};

const fp3_arithmetic_facts *fp3_arithmetic_of(fp3_arithmetic arithmetic) {
    return &table[arithmetic].facts;
}

fp3_arithmetic fp3_arithmetic_find(const char *name) {
    int i = 0;
    while (i < FP3_ARITHMETICS && strcmp(table[i].facts.name, name) != 0)
        i++;
    return (fp3_arithmetic)i;
}

int fp3_arithmetic_applies(fp3_arithmetic arithmetic, const fp3_integrator *integrator,
                           int is_adaptive) {
    return is_adaptive ? integrator->embedded_order && table[arithmetic].is_for_adaptive
                       : (table[arithmetic].kinds & KIND(integrator->kind)) != 0;
}
