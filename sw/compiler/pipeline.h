/* SPDX-License-Identifier: Apache-2.0 */
/* pipeline.h - the passes in a row: a model and an integrator to a schedule.
 *
 *     model, integrator -> fit -> integrate -> carry -> choose, convert -> schedule
 */
#ifndef FP3_PIPELINE_H
#define FP3_PIPELINE_H

#include <fp3/model.h>

#include "compiler/code/convert.h"
#include "compiler/schedule/lines.h"
#include "compiler/step/fit.h"

typedef struct {
    fp3_step step;
    conversion code;
    fp3_schedule *schedule;
    fp3_fit fit;
    int lacks_constants; /* there are more than the configuration has */
    int lacks_registers; /* the words of a program fit, but its values do not */
} fp3_pipeline;

/* The caller closes, after a failure too. */
fp3_status fp3_pipeline_run(fp3_pipeline *p, const fp3_model *model,
                            const fp3_integrator *integrator, const fp3_options *options,
                            fp3_error *error);
void fp3_pipeline_close(fp3_pipeline *p);

#endif
