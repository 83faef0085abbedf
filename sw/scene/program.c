/* program.c - images, assembled and compiled programs, and their values. */
#include "program.h"

#include <fp3/asm.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

static int ends(const char *path, const char *end) {
    const size_t size = strlen(path), length = strlen(end);
    return size > length && strcmp(path + size - length, end) == 0;
}

int fp3_program_is_model(const char *path) { return ends(path, ".ode"); }

int fp3_program_is_known(const char *path) {
    return fp3_program_is_model(path) || ends(path, ".s") || ends(path, ".fp3");
}

static fp3_status assemble(const char *path, fp3_program_source *source, fp3_error *error) {
    char *text = NULL;
    size_t size = 0;
    fp3_assembly *assembly = NULL;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (!status)
        status = fp3_assemble(text, size, path, &assembly, error);
    if (!status) {
        source->own = assembly->image;
        assembly->image = NULL;
    }
    fp3_assembly_free(&assembly);
    free(text);
    return status;
}

static fp3_status compile(const char *path, const fp3_program_def *def, fp3_program_source *source,
                          fp3_error *error) {
    char *report = NULL;
    fp3_error why;
    fp3_compile_def how = fp3_compile_default();
    how.config = def->config;
    how.is_compensated = def->is_compensated;
    fp3_status status = fp3_model_load(path, &source->model, &report, error);
    free(report);
    if (!status)
        status = fp3_integrator_find(def->integrator ? def->integrator : "rk4", &source->integrator,
                                     error);
    if (status)
        return status;
    status = fp3_compile(source->model, source->integrator, &how, &source->compiled, &why);
    if (status)
        return fp3_fail(error, status, "%s: %s", path, why.text);
    source->image = source->compiled->image;
    return FP3_OK;
}

fp3_status fp3_program_load(const char *path, const fp3_program_def *def,
                            fp3_program_source *source, fp3_error *error) {
    *source = (fp3_program_source){0};
    if (fp3_program_is_model(path))
        return compile(path, def, source, error);
    fp3_status status = ends(path, ".s") ? assemble(path, source, error)
                                         : fp3_image_load(path, &source->own, error);
    source->image = source->own;
    return status;
}

void fp3_program_close(fp3_program_source *source) {
    fp3_image_free(&source->own);
    fp3_compiled_free(&source->compiled);
    fp3_integrator_free(&source->integrator);
    fp3_model_free(&source->model);
    source->image = NULL;
}

/* ---- values of a model ---- */

static fp3_status take(fp3_params *params, const char *name, double share, double *value,
                       int *is_spread, fp3_error *error) {
    int spreads = 0;
    if (!fp3_params_has(params, name))
        return FP3_OK;
    const fp3_status status = fp3_params_at(params, name, share, value, &spreads, error);
    *is_spread |= spreads;
    return status;
}

static fp3_status check_spread(const fp3_quantity *q, int is_spread, fp3_error *error) {
    if (!q->is_shared || !is_spread)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "parameter '%s' is spread, and the model has one for all objects", q->name);
}

static fp3_status collect(const fp3_model *model, fp3_params *params, double share,
                          double *quantities, double *initial, double *h, int *is_spread,
                          fp3_error *error) {
    fp3_status status = FP3_OK;
    int h_spreads = 0;
    *h = model->step;
    for (uint32_t i = 0; !status && i < model->param_count; i++) {
        int spreads = 0;
        quantities[i] = model->params[i].value;
        status = take(params, model->params[i].name, share, &quantities[i], &spreads, error);
        if (!status)
            status = check_spread(&model->params[i], spreads, error);
        *is_spread |= spreads;
    }
    for (uint32_t i = 0; !status && i < model->state_count; i++) {
        initial[i] = model->states[i].value;
        status = take(params, model->states[i].name, share, &initial[i], is_spread, error);
    }
    /* A model's own h hides that of the integrator. */
    const int is_own =
        fp3_model_param(model, "h") != FP3_NONE || fp3_model_state(model, "h") != FP3_NONE;
    if (!status && !is_own)
        status = take(params, "h", share, h, &h_spreads, error);
    if (!status && h_spreads)
        status = fp3_fail(error, FP3_E_ARGUMENT, "'h' is spread, and all objects have the same");
    return status;
}

fp3_status fp3_program_inputs(const fp3_program_source *source, fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error) {
    const fp3_model *model = source->model;
    double *quantities = calloc(model->param_count + 1u, sizeof *quantities);
    double *initial = calloc(model->state_count + 1u, sizeof *initial), h = 0;
    fp3_status status =
        quantities && initial ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    *is_spread = 0;
    fp3_params_begin(params);
    if (!status)
        status = collect(model, params, share, quantities, initial, &h, is_spread, error);
    if (!status)
        status = fp3_params_end(params, error);
    if (!status)
        status = fp3_compiled_inputs(source->compiled, quantities, initial, h, values, error);
    free(quantities);
    free(initial);
    return status;
}

static fp3_status write_object(const fp3_program_source *source, const fp3_params_target *to,
                               size_t object, const float *values) {
    const fp3_compiled *c = source->compiled;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->input_count; i++) {
        const fp3_symbol *s = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        if (s->symbol_class != FP3_SYMBOL_SHARED)
            status = fp3_engine_write(to->engine, to->first + object, 1, s->index, &values[i]);
        else if (object == 0)
            status = fp3_engine_write_shared_of(to->engine, to->group, s->index, 1, &values[i]);
    }
    return status;
}

static fp3_status apply_model(const fp3_program_source *source, fp3_params *params,
                              const fp3_params_target *to, fp3_error *error) {
    float *values = calloc(source->compiled->input_count + 1u, sizeof *values);
    fp3_status status = values ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    int is_spread = 1;
    for (size_t i = 0; !status && i < to->objects; i++) {
        const double share = to->objects > 1 ? (double)i / (double)(to->objects - 1) : 0;
        if (is_spread)
            status = fp3_program_inputs(source, params, share, values, &is_spread, error);
        if (!status)
            status = write_object(source, to, i, values);
    }
    free(values);
    return status;
}

fp3_status fp3_program_apply(const fp3_program_source *source, fp3_params *params,
                             const fp3_params_target *to, fp3_error *error) {
    return source->model ? apply_model(source, params, to, error)
                         : fp3_params_apply_to(params, to, error);
}
