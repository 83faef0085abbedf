/* SPDX-License-Identifier: Apache-2.0 */
/* inputs.h - what the host writes before a run, by name and formula. */
#ifndef FP3_COMPILER_INPUTS_H
#define FP3_COMPILER_INPUTS_H

#include <fp3/compile.h>

#include "names.h"

/* Whether the host gives this variable, or known value, to a program. */
int fp3_inputs_has_variable(const variable *v);
int fp3_inputs_has_constant(const fp3_step *step, const conversion *c, uint32_t constant);

/* Variables, then params, then shared constants. The caller frees, after a failure too. */
fp3_status fp3_inputs_make(const fp3_step *step, const conversion *c, const fp3_names *names,
                           fp3_input **inputs, uint32_t *count, fp3_error *error);
void fp3_inputs_free(fp3_input *inputs, uint32_t count);

#endif
