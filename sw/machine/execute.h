/* SPDX-License-Identifier: Apache-2.0 */
/* execute.h - what each arithmetic operation gives: the only place in C that says so.
 *
 *     uint32_t flags;
 *     const uint64_t callers = fp3_fpu_begin(config->nearest);
 *     const uint32_t d = fp3_execute(config, FP3_OP_MADD, (const uint32_t[]){a, b, c}, &flags);
 *     fp3_fpu_set(callers);
 *
 * A new operation needs its row in isa/isa.toml and its cases in execute.c.
 */
#ifndef FP3_EXECUTE_H
#define FP3_EXECUTE_H

#include "base/fpu.h"
#include "config.h"

#include <stdint.h>

/* The bits of d from those of a, b and c; operands that the operation does not have are not read.
 * flags, unless NULL: the exceptions raised, as FP3_FLAG_*, 0 where the configuration flags none.
 * op is arithmetic: fp3_operation_is_arithmetic. */
uint32_t fp3_execute(const fp3_config *config, uint32_t op, const uint32_t operands[3],
                     uint32_t *flags);

/* Whether each lane is computed by fp3_execute, in integers, as no processor has such arithmetic:
 * logarithmic words, and numbers with fewer fraction bits. The processor's flags and rounding then
 * do not matter, but for `rint`. */
int fp3_execute_is_of_words(const fp3_config *config);

/* Whether floats have this operation in integers, too: `rcp` and `rsqrt` of the key `mixed`. */
int fp3_execute_is_by_logarithms(const fp3_config *config, uint32_t op);

/* Whether `sleep` with these operands puts an object to sleep: |a| < b. */
int fp3_execute_sleeps(const fp3_config *config, const uint32_t operands[3]);

/* What fp3_execute gives, in double and without the machine's roundings; an estimate is what it
 * estimates. */
double fp3_execute_exact(uint32_t op, double a, double b, double c);

#endif
