/* SPDX-License-Identifier: Apache-2.0 */
/* scaled.c - see scaled.h. */
#include "scaled.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

double fp3_scaled_step(const fp3_scene_group *group) {
    double h = group->program->model->step;
    fp3_error none;
    if (fp3_params_has(group->params, FP3_NAME_STEP))
        (void)fp3_params_get(group->params, FP3_NAME_STEP, &h, &none);
    return h;
}

/* Those of all objects have to be whole steps before and after. */
static fp3_status scale_life(const fp3_scene_group *group, uint64_t parts, uint64_t joined,
                             fp3_scene_steps *steps, fp3_error *error) {
    const uint64_t apart =
        steps->last > steps->first ? steps->last - steps->first : steps->first - steps->last;
    const uint64_t others = group->objects > 1 ? group->objects - 1 : 1;
    if (steps->first == FP3_FOREVER)
        return FP3_OK;
    if ((parts > 1 || joined > 1) && (apart % (others * joined) || steps->first % joined))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "group '%s': births or ends of %zu objects from step %" PRIu64
                        " to %" PRIu64 " are rounded to whole steps, and with steps of another "
                        "length to other times",
                        group->name, group->objects, steps->first, steps->last);
    steps->first = steps->first / joined * parts;
    steps->last = steps->last / joined * parts;
    return FP3_OK;
}

static fp3_status scale_group(fp3_scene_group *group, const fp3_params *given, uint64_t parts,
                              uint64_t joined, fp3_error *error) {
    const double h = fp3_scaled_step(group) * (double)joined / (double)parts;
    fp3_status status = fp3_params_copy(given, &group->params, error);
    if (status || (parts == 1 && joined == 1))
        return status;
    if (fp3_params_has(given, FP3_NAME_STEPS))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "group '%s': found a value of 'steps', which with steps of another length "
                        "is another time",
                        group->name);
    status = fp3_params_put(group->params, FP3_NAME_STEP, h, error);
    if (!status)
        status = scale_life(group, parts, joined, &group->born, error);
    return status ? status : scale_life(group, parts, joined, &group->gone, error);
}

fp3_status fp3_scaled_open(const fp3_scene *scene, uint64_t parts, uint64_t joined, fp3_scaled *s,
                           fp3_error *error) {
    fp3_status status = FP3_OK;
    *s = (fp3_scaled){.scene = *scene, .groups = calloc(scene->group_count + 1, sizeof *s->groups)};
    if (!s->groups)
        return fp3_no_memory(error);
    s->scene.groups = s->groups;
    s->scene.steps = scene->steps / joined * parts;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        const fp3_scene_group *of = &scene->groups[i];
        s->groups[i] = *of;
        status = scale_group(&s->groups[i], of->params, parts, joined, error);
        if (s->groups[i].params == of->params) /* no copy was made */
            s->groups[i].params = NULL;
    }
    return status;
}

void fp3_scaled_close(fp3_scaled *s) {
    for (size_t i = 0; s->groups && i < s->scene.group_count; i++)
        fp3_params_free(&s->groups[i].params);
    free(s->groups);
    *s = (fp3_scaled){.groups = NULL};
}

fp3_status fp3_run_state_read(const fp3_program *program, fp3_engine *engine, uint32_t state,
                              size_t first, size_t count, double *values, fp3_error *error) {
    const fp3_symbol *symbol = fp3_image_find(program->image, program->model->states[state].name,
                                              FP3_CLASS(FP3_SYMBOL_STATE));
    const int low = fp3_compiled_low(program->compiled, state);
    float *words = malloc((count + 1) * sizeof *words);
    if (!words)
        return fp3_no_memory(error);
    fp3_status status =
        symbol ? fp3_engine_read(engine, first, count, symbol->index, words) : FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        values[i] = symbol ? (double)words[i] : NAN;
    if (!status && symbol && low >= 0)
        status = fp3_engine_read(engine, first, count, (uint32_t)low, words);
    for (size_t i = 0; !status && symbol && low >= 0 && i < count; i++)
        values[i] += (double)words[i];
    free(words);
    return status;
}

fp3_status fp3_scaled_row(const fp3_scene *scene, fp3_engine *engine, double *row,
                          fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t k = 0; k < scene->group_count; k++) {
        const fp3_scene_group *g = &scene->groups[k];
        for (uint32_t s = 0; !status && s < g->program->model->state_count; s++) {
            status = fp3_run_state_read(g->program, engine, s, g->first, g->objects, row, error);
            row += g->objects;
        }
    }
    return status;
}
