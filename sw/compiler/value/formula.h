/* SPDX-License-Identifier: Apache-2.0 */
/* formula.h - known values and expressions as a reader would write them. */
#ifndef FP3_FORMULA_H
#define FP3_FORMULA_H

#include "known.h"

/* Cut where it is long; malloc'ed, NULL when out of memory. */
char *fp3_formula_known(const known_table *table, uint32_t id);
/* The same without cuts, definitions or rounding, for fp3_formula_read; NULL: the formula would be
 * very long, or out of memory. */
char *fp3_formula_rule(const known_table *table, uint32_t id);
/* Definitions stand by their names, except the one whose root this expression is. */
char *fp3_formula_expr(const fp3_model *model, uint32_t expr);

#endif
