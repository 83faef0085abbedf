/* SPDX-License-Identifier: Apache-2.0 */
/* split.c - see split.h. */
#include "split.h"

#include <string.h>

enum { STEPS = 4 };

static int has_parts(const fp3_image *image) {
    return image->step > 0 || image->last < image->code_count;
}

/* A small engine with the first object. */
static fp3_status open_one(const fp3_program *program, const fp3_params *params, const char *config,
                           fp3_engine **engine, fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    def.engine = "isa";
    def.config = config;
    def.objects = 1;
    def.error = error;
    fp3_status status = fp3_engine_open(&def, engine);
    return status ? status : fp3_program_load(program, params, *engine, error);
}

/* In runs of so many steps. *is_good: they came to their end. */
static void run(fp3_engine *engine, unsigned steps, int *is_good) {
    for (unsigned made = 0; made < STEPS; made += steps)
        *is_good &= !fp3_engine_run(engine, steps, NULL);
}

/* The bits of one state in both. */
static fp3_status compare(const fp3_symbol *symbol, fp3_engine *one, fp3_engine *other,
                          const char *why, fp3_error *error) {
    float a = 0, b = 0;
    fp3_status status = fp3_engine_read(one, 0, 1, symbol->index, &a);
    if (!status)
        status = fp3_engine_read(other, 0, 1, symbol->index, &b);
    if (status || !memcmp(&a, &b, sizeof a))
        return status;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "a run of this program cannot be split by %s: after %d steps '%s' is %.9g "
                    "in one run and %.9g in %d runs, so its first or last part does more than "
                    "prepare and complete values",
                    why, STEPS, symbol->name, (double)a, (double)b, STEPS);
}

/* A run that ends before its time is told when it is made. */
static fp3_status check(const fp3_image *image, fp3_engine *one, fp3_engine *other, const char *why,
                        fp3_error *error) {
    fp3_status status = FP3_OK;
    int is_good = 1;
    run(one, STEPS, &is_good);
    run(other, 1, &is_good);
    for (uint32_t i = 0; is_good && !status && i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
            status = compare(&image->symbols[i], one, other, why, error);
    return status;
}

fp3_status fp3_split_check(const fp3_program *program, const fp3_params *params, const char *config,
                           const char *why, fp3_error *error) {
    const fp3_image *image = program->image;
    fp3_engine *one = NULL, *other = NULL;
    if (program->model || !has_parts(image))
        return FP3_OK;
    fp3_status status = open_one(program, params, config, &one, error);
    if (!status)
        status = open_one(program, params, config, &other, error);
    if (!status)
        status = check(image, one, other, why, error);
    fp3_engine_close(&one);
    fp3_engine_close(&other);
    return status;
}

fp3_status fp3_split_check_scene(const fp3_scene *scene, const char *why, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        fp3_error told = {.text = ""};
        status = fp3_split_check(group->program, group->params, scene->config, why, &told);
        if (status)
            fp3_fail_at(error, status, scene->path, (unsigned)group->line, 0, "%s", told.text);
    }
    return status;
}
