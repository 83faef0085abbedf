/* variants.c - see variants.h. */
#include "variants.h"

#include <fp3/adaptive.h>
#include <fp3/start.h>
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

/* A column for each input, a row for each object. */
static fp3_status fill(const fp3_compiled *c, const fp3_model *model, double h, size_t objects,
                       size_t variants, float *columns, fp3_error *error) {
    double *params = calloc(model->param_count + model->state_count + 1u, sizeof *params);
    float *row = calloc(c->input_count + 1u, sizeof *row);
    fp3_status status = params && row ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t v = 0; !status && v < variants && v < objects; v++) {
        fp3_bench_variant(model, v, params, params + model->param_count);
        status = fp3_compiled_inputs(c, params, params + model->param_count, h, row, error);
        for (uint32_t i = 0; !status && i < c->input_count; i++)
            for (size_t object = v; object < objects; object += variants)
                columns[i * objects + object] = row[i];
    }
    free(params);
    free(row);
    return status;
}

fp3_status fp3_bench_write(fp3_engine *engine, const fp3_compiled *c, size_t objects,
                           const float *columns) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->input_count; i++) {
        const fp3_symbol *s = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        status = s->symbol_class == FP3_SYMBOL_SHARED
                     ? fp3_engine_write_shared(engine, s->index, 1, columns + i * objects)
                     : fp3_engine_write(engine, 0, objects, s->index, columns + i * objects);
    }
    return status;
}

fp3_status fp3_bench_start(fp3_engine *engine, const fp3_compiled *compiled, const fp3_model *model,
                           double h, size_t variants, fp3_error *error) {
    const size_t objects = fp3_engine_objects(engine);
    float *columns = calloc(compiled->input_count * objects + 1, sizeof *columns);
    fp3_status status = columns ? fp3_engine_load(engine, compiled->image)
                                : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fill(compiled, model, h, objects, variants, columns, error);
    if (!status)
        status = fp3_bench_write(engine, compiled, objects, columns);
    free(columns);
    return status;
}
