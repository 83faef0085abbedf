/* SPDX-License-Identifier: Apache-2.0 */
/* emit.h - a schedule as assembly that a person can read. */
#ifndef FP3_EMIT_H
#define FP3_EMIT_H

#include "names.h"

/* What the first lines say beside what the program says itself. */
typedef struct {
    const char *integrator;
    unsigned order;
} fp3_title;

/* The caller frees *text. */
fp3_status fp3_emit(const fp3_step *step, const conversion *c, const fp3_schedule *schedule,
                    const fp3_names *names, const fp3_options *options, const fp3_title *title,
                    char **text, fp3_error *error);

#endif
