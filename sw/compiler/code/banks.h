/* SPDX-License-Identifier: Apache-2.0 */
/* banks.h - sums and products apart (`dual`): every operation reads at most one of each.
 *
 * A value is kept with what makes it: sums with sums, products with products, variables with sums.
 * Of two operands that are kept together one is moved first: a sum times 1, or a product plus -0,
 * which changes no bit and raises no flag that the operation itself would not.
 */
#ifndef FP3_BANKS_H
#define FP3_BANKS_H

#include "compiler/schedule/code.h"

/* Adds the moves to all three parts, and gives each param its register. one, minus_zero: constants.
 */
fp3_status fp3_banks_split(fp3_step_code *code, uint32_t one, uint32_t minus_zero,
                           fp3_error *error);

#endif
