/* SPDX-License-Identifier: Apache-2.0 */
/* variants.c - see variants.h. */
#include "variants.h"

#include "world/fields.h"

#include <fp3/compile.h>
#include <stdlib.h>

#define PARAM_APART 1e-3
#define STATE_APART 2e-3

void fp3_bench_variant(const fp3_model *model, size_t object, double *params, double *initial) {
    const uint32_t adapted = fp3_model_adapted(model);
    const uint32_t until = adapted == FP3_NONE ? FP3_NONE : fp3_model_param(model, "until");
    for (uint32_t i = 0; i < model->param_count; i++)
        params[i] = (float)(model->params[i].value * (model->params[i].is_shared || i >= until
                                                          ? 1
                                                          : 1 + PARAM_APART * (double)object));
    for (uint32_t i = 0; i < model->state_count; i++)
        initial[i] =
            (float)(model->states[i].value * (i >= adapted ? 1 : 1 + STATE_APART * (double)object));
}

/* Rows of all objects: params, then starts. */
static void vary(const fp3_model *model, size_t objects, size_t variants, double *params,
                 double *initial) {
    for (size_t i = 0; i < objects; i++)
        fp3_bench_variant(model, i % variants, params + i * model->param_count,
                          initial + i * model->state_count);
}

fp3_status fp3_bench_start(fp3_engine *engine, const fp3_compiled *compiled, const fp3_model *model,
                           double h, size_t variants, fp3_error *error) {
    const size_t objects = fp3_engine_objects(engine);
    const fp3_fields_def def = {.engine = engine,
                                .objects = objects,
                                .image = compiled->image,
                                .compiled = compiled,
                                .h = h};
    fp3_fields *fields = NULL;
    double *params = calloc(objects * model->param_count + 1, sizeof *params);
    double *initial = calloc(objects * model->state_count + 1, sizeof *initial);
    fp3_status status =
        params && initial ? fp3_engine_load(engine, compiled->image) : fp3_no_memory(error);
    if (!status)
        status = fp3_fields_open(&def, &fields, error);
    if (!status) {
        vary(model, objects, variants, params, initial);
        status = fp3_fields_write_rows(fields, 0, objects, params, initial, error);
    }
    if (!status)
        status = fp3_fields_settle(fields, error);
    fp3_fields_close(&fields);
    free(params);
    free(initial);
    return status;
}
