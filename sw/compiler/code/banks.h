/* SPDX-License-Identifier: Apache-2.0 */
/* banks.h - sums and products apart (`dual`): every operation reads at most one of each.
 *
 * A value is in the bank of the unit that makes it: sums and variables in the bank of sums,
 * products in the other, and so are estimates, which read the bank of sums. If both operands are in
 * one bank, one operand is moved first: a sum times 1, or a product plus -0. A move changes no bit
 * and raises no flag that the operation itself would not raise.
 */
#ifndef FP3_BANKS_H
#define FP3_BANKS_H

#include "compiler/schedule/code.h"

/* Adds the moves to all three parts, and gives each param its register. one, minus_zero: constants.
 */
fp3_status fp3_banks_split(fp3_step_code *code, uint32_t one, uint32_t minus_zero,
                           fp3_error *error);

#endif
