/* SPDX-License-Identifier: Apache-2.0 */
/* near_few.h - lists of a few rows among many: each of them looks at all. */
#ifndef FP3_ENGINE_NEAR_FEW_H
#define FP3_ENGINE_NEAR_FEW_H

#include "near.h"

/* Up to this number of pairs a look at each costs less than lists of all objects. */
#define FP3_NEAR_FEW 0x10000u

/* Whether lists are needed of so few rows that a look at each pair costs less than a grid. */
int fp3_near_are_few(const fp3_where_they_are *now);
/* As fp3_near_make; lists of the other rows are empty. */
fp3_status fp3_near_make_few(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                             uint32_t **other, fp3_error *error);

#endif
