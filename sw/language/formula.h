/* SPDX-License-Identifier: Apache-2.0 */
/* formula.h - what a formula (fp3/model.h) is made of. */
#ifndef FP3_ODE_FORMULA_H
#define FP3_ODE_FORMULA_H

#include <fp3/model.h>

/* A value that something must have. */
typedef struct {
    const char *name;
    double is;
} fp3_fact;

/* What must hold for "h == 0.125 and m == 2.0 ? 0.99 : 0/0" to have a value, in this order; *facts
 * is malloc'ed, and its names are the formula's. Count 0 and NULL: a formula of another form, or
 * out of memory. */
size_t fp3_formula_facts(const fp3_formula *formula, fp3_fact **facts);

int fp3_formula_mentions(const fp3_formula *formula, const char *name);

#endif
