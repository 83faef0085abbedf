/* SPDX-License-Identifier: Apache-2.0 */
/* evaluator.h - definitions and invariants of a model in double, from the states of objects. */
#ifndef FP3_OUTPUT_EVALUATOR_H
#define FP3_OUTPUT_EVALUATOR_H

#include "source.h"

typedef struct fp3_evaluator fp3_evaluator;

/* Room for blocks of that many objects. The caller frees *evaluator, after a failure too. */
fp3_status fp3_evaluator_open(const fp3_program *program, size_t room, fp3_evaluator **evaluator,
                              fp3_error *error);
/* Sets *evaluator to NULL, which it may be already. */
void fp3_evaluator_free(fp3_evaluator **evaluator);
/* Has the expression computed, and all that it is made of. FP3_E_ARGUMENT: the program lacks a
 * state that it needs, because that value is not observed. */
fp3_status fp3_evaluator_add(fp3_evaluator *evaluator, const fp3_program *program, uint32_t expr,
                             fp3_error *error);

/* Once before the first block: the params that objects were given. */
fp3_status fp3_evaluator_begin(fp3_evaluator *evaluator, const fp3_source *source,
                               fp3_error *error);
/* Reads what the block needs, after `step` steps. What goes wrong the engine tells. */
fp3_status fp3_evaluator_read(fp3_evaluator *evaluator, const fp3_source *source, uint64_t step,
                              size_t first, size_t count);
/* The values of all expressions that were added, for object i of the block; valid until the next
 * call. */
const double *fp3_evaluator_values(fp3_evaluator *evaluator, size_t i);

#endif
