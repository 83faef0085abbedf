/* SPDX-License-Identifier: Apache-2.0 */
/* parts.h - the first, the step and the last part of a program as blocks. */
#ifndef FP3_PARTS_H
#define FP3_PARTS_H

#include "block.h"

/* FP3_E_ARGUMENT: the code refers to what is not there. The caller frees, after a failure too. */
fp3_status fp3_part_first(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                          fp3_error *error);
fp3_status fp3_part_step(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                         fp3_error *error);
fp3_status fp3_part_last(const fp3_step_code *code, const fp3_config *config, fp3_block *block,
                         fp3_error *error);

#endif
