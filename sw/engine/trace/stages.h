/* SPDX-License-Identifier: Apache-2.0 */
/* stages.h - the stages of an instruction, as docs/tracing.md draws them. */
#ifndef FP3_TRACE_STAGES_H
#define FP3_TRACE_STAGES_H

#include "machine/config.h"

#include <fp3/engine.h>

#define FP3_STAGES_MOST 5u

typedef struct {
    const char *name;
    uint64_t from; /* its first cycle; it lasts until the next stage, the last one until `end` */
} fp3_stage;

typedef struct {
    fp3_stage stages[FP3_STAGES_MOST];
    unsigned count; /* at least 1; the first begins in the cycle of the issue */
    uint64_t end;
} fp3_stages;

/* ended > issued. Stages for which there is no time are left out. */
fp3_stages fp3_stages_of(const fp3_config *config, const fp3_traced *traced);

#endif
