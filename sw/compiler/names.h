/* SPDX-License-Identifier: Apache-2.0 */
/* names.h - what the program calls its registers and constants. */
#ifndef FP3_NAMES_H
#define FP3_NAMES_H

#include "compiler/code/convert.h"
#include "compiler/schedule/lines.h"

typedef struct {
    char (*object)[FP3_NAME_SIZE];   /* of each object register; "" of one that is not in use */
    char (*constant)[FP3_NAME_SIZE]; /* of each shared constant; a number stands for itself */
    uint32_t object_count, constant_count;
} fp3_names;

/* FP3_E_SYSTEM, or FP3_E_PROGRAM: a number is too large for FP32. The caller closes, after a
 * failure too. */
fp3_status fp3_names_make(const fp3_step *step, const conversion *c, const fp3_schedule *schedule,
                          fp3_names *names, fp3_error *error);
void fp3_names_close(fp3_names *names);

#endif
