/* SPDX-License-Identifier: Apache-2.0 */
/* second.c - see second.h. */
#include "second.h"

#include "world/values.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS 16 /* at the second run, for the size of each state */

/* ---- programs ---- */

/* One with room for long programs. */
static const char *config_of(const fp3_second *s) {
    int sees = 0;
    for (size_t i = 0; i < s->count; i++)
        sees |= s->parts[i].run->program->sees_others;
    return sees ? "world" : "many_full";
}

static fp3_status compile(const fp3_second *s, fp3_second_part *p, const fp3_program_def *def,
                          fp3_error *error) {
    const fp3_program *first = p->run->program;
    fp3_compile_def how = def->compile;
    fp3_compiled *made = NULL;
    how.config = config_of(s);
    const fp3_status status = fp3_compile(first->model, first->integrator, &how, &made, error);
    if (status)
        return status;
    fp3_compiled_free(&p->program.compiled);
    p->program = *first;
    p->program.compiled = made;
    p->program.image = made->image;
    return FP3_OK;
}

/* Programs of groups that see each other have phases that fit. */
static fp3_status compile_all(const fp3_second *s, fp3_arithmetic arithmetic, fp3_error *error) {
    fp3_program_def def = fp3_program_default();
    fp3_joined *list = calloc(s->count, sizeof *list);
    fp3_status status = list ? FP3_OK : fp3_no_memory(error);
    def.compile.config = config_of(s);
    def.compile.arithmetic = arithmetic;
    def.compile.is_for_host = 1;
    for (size_t i = 0; !status && i < s->count; i++) {
        fp3_second_part *p = &s->parts[i];
        status = compile(s, p, &def, error);
        list[i] = (fp3_joined){fp3_run_set_name(s->set, i), &p->program, &def};
    }
    if (!status && s->count > 1)
        status = fp3_programs_join(list, s->count, error);
    free(list);
    return status;
}

/* ---- values ---- */

/* A part of what the run has: of the value that was given, or of the model's. */
static fp3_status scale(fp3_second_part *p, const char *name, double factor, double *value,
                        fp3_error *error) {
    fp3_status status =
        fp3_params_has(p->params, name) ? fp3_params_get(p->params, name, value, error) : FP3_OK;
    *value *= factor;
    return status ? status : fp3_params_put(p->params, name, *value, error);
}

/* Values that are computed from what has been scaled would change the equations. */
static fp3_status check_formulas(const fp3_second_part *p, fp3_error *error) {
    fp3_value_look one;
    for (size_t i = 0; fp3_values_look(p->run->params, i, &one); i++) {
        double first = 0, second = 0;
        fp3_status status =
            one.formula ? fp3_params_get(p->run->params, one.name, &first, error) : FP3_OK;
        if (!status && one.formula)
            status = fp3_params_get(p->params, one.name, &second, error);
        if (status)
            return status;
        if (first != second)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "--check: '%s' is computed from a value that a check changes; give a "
                            "number instead",
                            one.name);
    }
    return FP3_OK;
}

static fp3_status scale_all(fp3_second_part *p, fp3_error *error) {
    const fp3_model *m = p->model;
    double value = m->step;
    fp3_status status = fp3_params_copy(p->run->params, &p->params, error);
    if (!status && !p->is_chosen) {
        status = scale(p, FP3_NAME_STEP, 0.5, &value, error);
        p->end = 2 * value * (double)p->run->steps;
        snprintf(p->how, sizeof p->how, "h = %.9g", value);
        if (!p->is_adaptive)
            snprintf(p->how + strlen(p->how), sizeof p->how - strlen(p->how),
                     " in %" PRIu64 " steps", 2 * p->run->steps);
    }
    static const char *const names[] = {"absolute", "tolerance"};
    for (size_t i = 0; !status && p->is_chosen && i < 2; i++) {
        value = m->params[fp3_model_param(m, names[i])].value;
        status = scale(p, names[i], 0.1, &value, error);
        snprintf(p->how, sizeof p->how, "tolerance %.9g", value);
    }
    return status ? status : check_formulas(p, error);
}

/* The same times in twice the steps. */
static fp3_status double_steps(const fp3_second_part *p, const char *what, fp3_scene_steps *steps,
                               fp3_error *error) {
    const uint64_t apart =
        steps->last > steps->first ? steps->last - steps->first : steps->first - steps->last;
    if (steps->first == FP3_FOREVER)
        return FP3_OK;
    if (p->objects > 1 && apart % (p->objects - 1))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "--check: the %s of %zu objects from step %" PRIu64 " to %" PRIu64
                        " are rounded to whole steps, and with half the step to other times",
                        what, p->objects, steps->first, steps->last);
    steps->first *= 2;
    steps->last *= 2;
    return FP3_OK;
}

static fp3_status live(const fp3_second_part *p, fp3_scene_group *second, fp3_error *error) {
    const fp3_status status = double_steps(p, "births", &second->born, error);
    return status ? status : double_steps(p, "ends", &second->gone, error);
}

/* Before a long run that would be refused in the end. */
static fp3_status check_count(const fp3_second_part *p, fp3_error *error) {
    if (p->is_adaptive || fp3_image_steps(p->program.image) < 0 ||
        p->run->steps <= FP3_STEPS_LIMIT / 2)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "--check: half the step takes %" PRIu64
                    " steps, and a program with t counts %d at most",
                    2 * p->run->steps, FP3_STEPS_LIMIT);
}

/* ---- the engine ---- */

/* A scene of the set alone. */
static fp3_status load_groups(const fp3_second *s, fp3_error *error) {
    fp3_scene scene = *s->set->scene;
    fp3_scene_group *groups = calloc(s->count, sizeof *groups);
    fp3_status status = groups ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < s->count; i++) {
        const fp3_second_part *p = &s->parts[i];
        groups[i] = *p->group;
        groups[i].program = (fp3_program *)(uintptr_t)&p->program;
        groups[i].params = p->params;
        groups[i].first = p->first;
        status = live(p, &groups[i], error);
    }
    scene.groups = groups;
    scene.group_count = s->count;
    scene.objects = s->def.objects;
    if (!status)
        status = fp3_scene_load(&scene, s->engine, error);
    free(groups);
    return status;
}

static fp3_status open_engine(fp3_second *s) {
    const fp3_engine_def *first = s->first_def;
    const fp3_second_part *last = &s->parts[s->count - 1];
    s->def = fp3_engine_default();
    s->def.engine = "fast";
    s->def.config = config_of(s);
    s->def.objects = (uint32_t)(last->first + last->objects);
    s->def.threads = first->threads;
    s->def.is_interpreted = strcmp(first->engine, "fast") != 0 || first->native;
    s->def.is_without_compiler = s->def.is_interpreted;
    s->def.error = s->error;
    fp3_engine_close(&s->engine);
    const fp3_status status = fp3_engine_open(&s->def, &s->engine);
    return status          ? status
           : s->set->scene ? load_groups(s, s->error)
                           : fp3_program_load(&last->program, last->params, s->engine, s->error);
}

static fp3_status look_for_growth(fp3_second *s, double share) {
    const double **columns = calloc(s->count + 1, sizeof *columns);
    if (!columns)
        return fp3_no_memory(s->error);
    for (size_t i = 0; i < s->count; i++)
        columns[i] = s->parts[i].now;
    const fp3_status status = fp3_run_growth_look(s->growth, columns, share, s->error);
    free((void *)columns);
    return status;
}

/* Notes how large each state is. */
static fp3_status look(fp3_second *s, double share) {
    fp3_status status = FP3_OK;
    for (size_t k = 0; k < s->count; k++) {
        const fp3_second_part *p = &s->parts[k];
        for (uint32_t n = 0; !status && n < p->states; n++) {
            double *row = p->now + n * p->objects, *size = p->size + n * p->objects;
            status =
                fp3_run_state_read(&p->program, s->engine, n, p->first, p->objects, row, s->error);
            for (size_t i = 0; !status && i < p->objects; i++)
                size[i] = fmax(size[i], fabs(row[i]));
        }
    }
    return status ? status : look_for_growth(s, share);
}

static fp3_status run(fp3_second *s) {
    const uint64_t steps = s->parts[0].run->steps, parts = s->is_adaptive ? 1 : LOOKS;
    fp3_status status = look(s, 0);
    for (uint64_t i = 0; !status && i < parts; i++) {
        const uint64_t made =
            s->is_adaptive ? 10 * steps : 2 * steps * (i + 1) / parts - 2 * steps * i / parts;
        status = fp3_adaptive_run(s->engine, made < UINT32_MAX ? made : UINT32_MAX, NULL);
        if (!status)
            status = look(s, (double)(i + 1) / (double)parts);
    }
    return status;
}

fp3_status fp3_second_run(fp3_second *s, fp3_arithmetic arithmetic) {
    fp3_run_growth_close(&s->growth);
    fp3_status status = fp3_run_growth_open(s->set, &s->growth, s->error);
    for (size_t i = 0; i < s->count; i++)
        memset(s->parts[i].size, 0,
               s->parts[i].objects * s->parts[i].states * sizeof *s->parts[i].size);
    if (!status)
        status = compile_all(s, arithmetic, s->error);
    for (size_t i = 0; !status && i < s->count; i++)
        status = check_count(&s->parts[i], s->error);
    if (!status)
        status = open_engine(s);
    return status ? status : run(s);
}

static fp3_status open_part(fp3_second *s, size_t number) {
    fp3_second_part *p = &s->parts[number];
    p->run = &s->set->parts[number];
    p->group = s->set->groups[number];
    p->model = p->run->program->model;
    p->objects = p->run->objects;
    p->first = number ? p[-1].first + p[-1].objects : 0;
    p->is_adaptive = fp3_adaptive_is(p->run->program->image);
    p->is_chosen = fp3_model_chooses_steps(p->model);
    p->states = p->is_adaptive ? fp3_model_adapted(p->model) : p->model->state_count;
    p->now = calloc(p->objects * p->states + 1, sizeof *p->now);
    p->size = calloc(p->objects * p->states + 1, sizeof *p->size);
    s->is_adaptive |= p->is_adaptive;
    s->is_blind |= fp3_run_loss_is_blind(p->run) ||
                   (p->run->program->sees_others && fp3_model_removes(p->model));
    return p->now && p->size ? scale_all(p, s->error) : fp3_no_memory(s->error);
}

fp3_status fp3_second_open(const fp3_run_set *set, const fp3_engine_def *def, fp3_second *s,
                           fp3_error *error) {
    *s = (fp3_second){.set = set, .first_def = def, .error = error};
    s->parts = calloc(set->count, sizeof *s->parts);
    fp3_status status = s->parts ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < set->count; i++) {
        s->count++;
        status = open_part(s, i);
    }
    s->is_blind |= set->count > 1;
    return status;
}

void fp3_second_close(fp3_second *s) {
    fp3_engine_close(&s->engine);
    fp3_run_growth_close(&s->growth);
    for (size_t i = 0; i < s->count; i++) {
        fp3_compiled_free(&s->parts[i].program.compiled);
        fp3_params_free(&s->parts[i].params);
        free(s->parts[i].now);
        free(s->parts[i].size);
    }
    free(s->parts);
    *s = (fp3_second){0};
}
