/* execute.h - what each arithmetic operation gives: the only place in C that says so.
 *
 *     fenv_t callers;
 *     uint32_t flags;
 *     fp3_execute_begin(config, &callers);
 *     const uint32_t d = fp3_execute(config, FP3_OP_MADD, (const uint32_t[]){a, b, c}, &flags);
 *     fp3_execute_end(&callers);
 *
 * A new operation needs its row in isa/isa.toml and its cases in execute.c.
 */
#ifndef FP3_EXECUTE_H
#define FP3_EXECUTE_H

#include "config.h"

#include <fenv.h>
#include <stdint.h>

/* Around a sequence of fp3_execute: the host's floating-point environment becomes the configuration's
 * rounding, whatever the caller had chosen, and then the caller's again. */
void fp3_execute_begin(const fp3_config *config, fenv_t *callers);
void fp3_execute_end(const fenv_t *callers);

/* The bits of d from those of a, b and c; operands that the operation does not have are not read.
 * flags, unless NULL: the exceptions raised, as FP3_FLAG_*, 0 where the configuration flags none.
 * op is arithmetic: fp3_operation_is_arithmetic. */
uint32_t fp3_execute(const fp3_config *config, uint32_t op, const uint32_t operands[3],
                     uint32_t *flags);

/* Whether `sleep` with these operands puts an object to sleep: |a| < b. */
int fp3_execute_sleeps(const uint32_t operands[3]);

/* What fp3_execute gives, in double and without the machine's roundings; an estimate is what it estimates. */
double fp3_execute_exact(uint32_t op, double a, double b, double c);

#endif
