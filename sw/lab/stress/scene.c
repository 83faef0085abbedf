/* SPDX-License-Identifier: Apache-2.0 */
/* scene.c - how near the limits of its integrators a scene comes while it runs. */
#include "suite.h"
#include "theory.h"

#include "lab/check/run_loss.h"
#include "lab/scene/spectrum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS 8
#define QUICK 2
#define WORK 1e8  /* numbers, which take a fraction of a second: of a figure, in a look */
#define SPARSE 1  /* neighbours: where an object never has more, objects hardly ever touch */
#define GROWS 1.2 /* a step: of integrators with which every oscillation grows */

/* The largest of all looks. */
typedef struct {
    double value; /* times h, or h^2 */
    double time;
    size_t group, object;
    const char *where; /* "" or what is looked at instead of the run */
} most;

typedef struct {
    const fp3_stress_options *how;
    const fp3_scene *scene;
    fp3_spectrum *spectrum;
    fp3_engine *engine;
    most *springs, *dampers; /* of each group: with those that it is tied to */
    most growth;
    double stable; /* a step with which nothing grows, of the group's */
    double neighbours;
    size_t failed;
    char failure[FP3_FAILURE_TEXT_SIZE];
    fp3_verdicts *verdicts;
    fp3_error *error;
} trial;

/* ---- looks ---- */

static const fp3_crowd_group *group_of(const trial *t, size_t group) {
    return &fp3_spectrum_crowd(t->spectrum)->groups[group];
}

static void keep(most *of, double value, double time, size_t group, size_t object,
                 const char *where) {
    if (value > of->value || isnan(value))
        *of = (most){value, time, group, object, where};
}

static fp3_status look_at_rates(trial *t, uint64_t step, size_t group, const char *where) {
    fp3_rates found;
    const fp3_status status = fp3_spectrum_rates(t->spectrum, step, group, &found, t->error);
    const double h = group_of(t, group)->h, time = h * (double)step;
    keep(&t->springs[group], h * sqrt(found.stiffness), time, found.of_springs,
         found.springs_object, where);
    keep(&t->dampers[group], h * found.damping, time, found.of_dampers, found.dampers_object,
         where);
    return status;
}

static fp3_status look(trial *t, uint64_t step, const char *where) {
    fp3_growth found = {.factor = 1};
    fp3_status status =
        t->growth.value > 1 ? FP3_OK : fp3_spectrum_growth(t->spectrum, step, &found, t->error);
    if (!status && !*where)
        t->neighbours = fmax(t->neighbours, fp3_spectrum_neighbours(t->spectrum));
    if (!status && found.factor > t->growth.value)
        t->stable = found.stable;
    if (!status)
        keep(&t->growth, found.factor, group_of(t, found.group)->h * (double)step, found.group,
             found.object, where);
    for (size_t i = 0; !status && i < t->scene->group_count; i++)
        if (fp3_spectrum_is_first(t->spectrum, i))
            status = look_at_rates(t, step, i, where);
    return status;
}

/* The states of objects that failed tell nothing. */
static fp3_status look_for_failures(trial *t) {
    fp3_failure found;
    const fp3_status status =
        fp3_engine_failure(t->engine, 0, fp3_engine_objects(t->engine), &found);
    if (!status && found.failed) {
        t->failed = found.failed;
        fp3_engine_failure_text(t->engine, &found, t->failure);
    }
    return status;
}

static fp3_status take_states(trial *t) {
    fp3_status status = FP3_OK;
    for (size_t k = 0; !status && k < t->scene->group_count; k++) {
        const fp3_scene_group *of = &t->scene->groups[k];
        const fp3_crowd_group *g = group_of(t, k);
        double *column = calloc(g->objects + 1, sizeof *column);
        status = column ? FP3_OK : fp3_no_memory(t->error);
        for (uint32_t s = 0; !status && s < g->model->state_count; s++) {
            status = fp3_run_state_read(of->program, t->engine, s, of->first, g->objects, column,
                                        t->error);
            for (size_t i = 0; !status && i < g->objects; i++)
                if (!isnan(column[i])) /* the engine has the state */
                    g->states[s * g->objects + i] = column[i];
        }
        free(column);
    }
    return status;
}

/* Beside each other, where the run hardly ever brings them so near. */
static fp3_status look_at_packed(trial *t) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && t->neighbours < SPARSE && i < t->scene->group_count; i++)
        if (fp3_spectrum_pack(t->spectrum, i))
            status = look(t, 0, "side by side");
    return status;
}

static fp3_status run(trial *t) {
    const uint64_t steps = t->scene->steps, looks = t->how->is_quick ? QUICK : LOOKS;
    fp3_status status = look(t, 0, "");
    for (uint64_t i = 0, made = 0; !status && !t->failed && i < looks; i++) {
        const uint64_t until = steps / looks * (i + 1) + steps % looks * (i + 1) / looks;
        t->how->say(t->how->say_user, "scene", t->scene->path);
        if (until == made)
            continue;
        status = fp3_adaptive_run(t->engine, until - made, NULL);
        made = until;
        if (!status)
            status = look_for_failures(t);
        if (!status && !t->failed)
            status = take_states(t);
        if (!status && !t->failed)
            status = look(t, made, "");
    }
    return status ? status : look_at_packed(t);
}

/* ---- verdicts ---- */

static fp3_status add(trial *t, const most *of, const char *what, double expected,
                      const char *because) {
    const fp3_crowd_group *g = group_of(t, of->group);
    fp3_verdict v = {.section = "scene",
                     .arithmetic = "",
                     .relation = FP3_AT_MOST,
                     .expected = expected,
                     .measured = of->value,
                     .because = because};
    snprintf(v.model, sizeof v.model, "%s", g->of->name);
    snprintf(v.integrator, sizeof v.integrator, "%s", g->of->program->integrator->name);
    if (of == &t->growth && of->value <= expected)
        snprintf(v.name, sizeof v.name, "%s, h = %.3g", what, g->h);
    else if (of->where && *of->where)
        snprintf(v.name, sizeof v.name, "%s, h = %.3g, objects %s", what, g->h, of->where);
    else
        snprintf(v.name, sizeof v.name, "%s, h = %.3g, object %zu at time %.4g", what, g->h,
                 of->object, of->time);
    return fp3_verdicts_add(t->verdicts, &v, t->error);
}

static fp3_status add_failed(trial *t) {
    fp3_verdict v = {.section = "scene",
                     .name = "objects that failed",
                     .integrator = "",
                     .arithmetic = "",
                     .relation = FP3_AT_MOST,
                     .measured = (double)t->failed,
                     .because = t->failure};
    snprintf(v.model, sizeof v.model, "%s", t->scene->groups[0].name);
    return fp3_verdicts_add(t->verdicts, &v, t->error);
}

/* Of a method with which each oscillation grows: what makes it grow fast. */
static double limit_of_springs(const fp3_integrator *by) {
    const double limit = fp3_theory_limit(by, M_PI_2);
    return limit > 0 ? limit : fp3_theory_onset(by, M_PI_2, 1, GROWS);
}

/* By the integrator of the group that swings or is damped fastest. */
static const fp3_integrator *integrator_of(const trial *t, const most *of) {
    return t->scene->groups[of->group].program->integrator;
}

static fp3_status judge(trial *t) {
    fp3_status status = FP3_OK;
    char because[96] = "";
    for (size_t i = 0; !status && i < t->scene->group_count; i++) {
        const most *springs = &t->springs[i], *dampers = &t->dampers[i];
        if (!fp3_spectrum_is_first(t->spectrum, i))
            continue;
        if (springs->value > 0)
            status = add(t, springs, "h omega of springs",
                         limit_of_springs(integrator_of(t, springs)), NULL);
        if (!status && dampers->value > 0)
            status = add(t, dampers, "h c/m of dampers",
                         fp3_theory_damped(integrator_of(t, dampers)), NULL);
    }
    if (t->stable > 0)
        snprintf(because, sizeof because, "with h = %.2g nothing grows",
                 t->stable * group_of(t, t->growth.group)->h);
    if (!status)
        status = add(t, &t->growth, "growth of a small error in a step", 1, because);
    return status || !t->failed ? status : add_failed(t);
}

/* ---- open and close ---- */

static fp3_status check(const fp3_scene *scene, fp3_error *error) {
    for (size_t i = 0; i < scene->group_count; i++)
        if (fp3_adaptive_is(scene->groups[i].program->image))
            return fp3_fail_at(error, FP3_E_PROGRAM, scene->path, (unsigned)scene->groups[i].line,
                               0,
                               "adaptive steps become shorter where a limit is near: expected a "
                               "group without 'tolerance' and 'until'");
    return FP3_OK;
}

static fp3_status open(trial *t) {
    fp3_engine_def def = fp3_scene_engine(t->scene);
    def.engine = "fast";
    def.error = t->error;
    t->springs = calloc(2 * t->scene->group_count + 1, sizeof *t->springs);
    if (!t->springs)
        return fp3_no_memory(t->error);
    t->dampers = t->springs + t->scene->group_count;
    fp3_status status = fp3_spectrum_open(t->scene, WORK, &t->spectrum, t->error);
    if (!status)
        status = fp3_engine_open(&def, &t->engine);
    return status ? status : fp3_scene_load(t->scene, t->engine, t->error);
}

fp3_status fp3_stress_scene(const fp3_stress_options *options, const fp3_scene *scene,
                            fp3_verdicts *verdicts, fp3_error *error) {
    trial t = {.how = options,
               .scene = scene,
               .growth = {.value = 0, .where = ""},
               .verdicts = verdicts,
               .error = error};
    fp3_status status = check(scene, error);
    if (!status)
        status = open(&t);
    if (!status)
        status = run(&t);
    if (!status)
        status = judge(&t);
    fp3_engine_close(&t.engine);
    fp3_spectrum_close(&t.spectrum);
    free(t.springs);
    return status;
}
