/* SPDX-License-Identifier: Apache-2.0 */
/* crowd.c - see crowd.h. */
#include "crowd.h"

#include "base/host.h"
#include "world/apply.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is refused ---- */

__attribute__((format(printf, 4, 5))) static fp3_status refuse(const fp3_scene *scene,
                                                               const fp3_scene_group *group,
                                                               fp3_error *error, const char *format,
                                                               ...) {
    char text[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return fp3_fail_at(error, FP3_E_PROGRAM, scene->path, (unsigned)group->line, 0, "%s%s%s%s",
                       group->name ? "group '" : "", group->name ? group->name : "",
                       group->name ? "': " : "", text);
}

static fp3_status check(const fp3_scene *scene, const fp3_scene_group *group, fp3_error *error) {
    const fp3_model *m = group->program->model;
    if (!m)
        return refuse(scene, group, error,
                      "a truth is computed from equations, and '%s' is no model", group->path);
    if (fp3_adaptive_is(group->program->image))
        return refuse(scene, group, error,
                      "adaptive steps have no one time step that could be halved: expected a "
                      "group without 'tolerance' and 'until'");
    return FP3_OK;
}

/* ---- values ---- */

static void *columns(size_t count, size_t objects) {
    return calloc(count * objects + 1, sizeof(double));
}

static fp3_status take_room(fp3_crowd_group *g, fp3_error *error) {
    const fp3_model *m = g->model;
    const size_t n = g->objects + 1u;
    g->params = columns(m->param_count, g->objects);
    g->states = columns(m->state_count, g->objects);
    g->offset = columns(1, g->objects);
    g->born = calloc(n, sizeof *g->born);
    g->gone = calloc(n, sizeof *g->gone);
    g->is_alive = calloc(n, 1);
    g->is_stopped = calloc(n, 1);
    g->words = calloc(m->param_count + 1u, sizeof *g->words);
    g->sights = calloc(m->relation_count + 1u, sizeof *g->sights);
    return g->params && g->states && g->offset && g->born && g->gone && g->is_alive &&
                   g->is_stopped && g->words && g->sights
               ? FP3_OK
               : fp3_no_memory(error);
}

static void put_object(fp3_crowd_group *g, const fp3_object_values *of, size_t i) {
    for (uint32_t k = 0; k < g->model->param_count; k++)
        g->params[k * g->objects + i] = of->params[k];
    for (uint32_t k = 0; k < g->model->state_count; k++)
        g->states[k * g->objects + i] = of->initial[k];
    fp3_scene_life(g->of, i, &g->born[i], &g->gone[i]);
    g->h = of->h;
    g->offset[i] = (of->steps - (double)g->born[i]) * of->h;
}

static fp3_status take_values(fp3_crowd_group *g, fp3_error *error) {
    fp3_object_values of;
    const double last = g->objects > 1 ? (double)(g->objects - 1) : 1;
    fp3_status status = fp3_object_values_open(g->of->program, g->of->params, &of, error);
    for (size_t i = 0; !status && i < g->objects; i++) {
        status = fp3_object_values_at(&of, (double)i / last, error);
        if (!status)
            put_object(g, &of, i);
    }
    fp3_object_values_free(&of);
    return status;
}

/* ---- kinds ---- */

/* The one group of this name: fp3_scene_open has looked. */
static uint32_t group_named(const fp3_crowd *crowd, const char *name) {
    uint32_t i = 0;
    while (i < crowd->group_count && strcmp(crowd->groups[i].of->name, name) != 0)
        i++;
    return i < crowd->group_count ? i : FP3_NONE;
}

static fp3_status find_words(fp3_crowd *crowd, fp3_crowd_group *g, fp3_error *error) {
    const fp3_model *m = g->model;
    for (uint32_t p = 0; p < m->param_count; p++)
        g->words[p].group = FP3_NONE;
    for (uint32_t k = 0; k < m->kind_count; k++) {
        const fp3_kind *kind = &m->kinds[k];
        const uint32_t other = group_named(crowd, kind->name);
        for (uint32_t p = kind->first; p < kind->first + kind->count; p++) {
            const char *name = m->params[p].name + strlen(kind->name) + 1;
            const fp3_model *theirs = other == FP3_NONE ? NULL : crowd->groups[other].model;
            const uint32_t state = theirs ? fp3_model_state(theirs, name) : FP3_NONE;
            const uint32_t param = theirs ? fp3_model_param(theirs, name) : FP3_NONE;
            if (state == FP3_NONE && param == FP3_NONE)
                return fp3_fail(error, FP3_E_PROGRAM, "model '%s': kind '%s' has no '%s'", m->name,
                                kind->name, name);
            g->words[p] =
                (fp3_crowd_word){other, state != FP3_NONE ? state : param, state != FP3_NONE};
        }
    }
    for (uint32_t r = 0; r < m->relation_count; r++) {
        const uint32_t kind = m->relations[r].of_kind;
        g->sights[r].group = kind == FP3_NONE ? (uint32_t)(g - crowd->groups)
                                              : group_named(crowd, m->kinds[kind].name);
    }
    return FP3_OK;
}

const double *fp3_crowd_theirs(const fp3_crowd *crowd, double *const *states,
                               const fp3_crowd_group *group, const fp3_relation *r, int is_param,
                               uint32_t index) {
    uint32_t seen = (uint32_t)(group - crowd->groups);
    if (r->of_kind != FP3_NONE) {
        const fp3_crowd_word *word = &group->words[index];
        seen = word->group;
        index = word->index;
        is_param = !word->is_state;
    }
    const fp3_crowd_group *other = &crowd->groups[seen];
    return (is_param ? other->params : states[seen]) + index * other->objects;
}

/* ---- all of it ---- */

static fp3_status open_group(fp3_crowd_group *g, const fp3_scene *scene, const fp3_scene_group *of,
                             fp3_error *error) {
    fp3_status status = check(scene, of, error);
    if (status)
        return status;
    g->of = of;
    g->model = of->program->model;
    g->integrator = of->program->integrator;
    g->objects = of->objects;
    status = take_room(g, error);
    return status ? status : take_values(g, error);
}

fp3_status fp3_crowd_open(const fp3_scene *scene, fp3_crowd *crowd, fp3_error *error) {
    fp3_status status = FP3_OK;
    *crowd = (fp3_crowd){.groups = calloc(scene->group_count + 1, sizeof *crowd->groups)};
    if (!crowd->groups)
        return fp3_no_memory(error);
    crowd->group_count = (uint32_t)scene->group_count;
    for (uint32_t i = 0; !status && i < crowd->group_count; i++) {
        status = open_group(&crowd->groups[i], scene, &scene->groups[i], error);
        if (!status)
            crowd->states += crowd->groups[i].objects * crowd->groups[i].model->state_count;
    }
    for (uint32_t i = 0; !status && i < crowd->group_count; i++)
        status = find_words(crowd, &crowd->groups[i], error);
    fp3_crowd_live(crowd, 0, 1);
    return status;
}

void fp3_crowd_close(fp3_crowd *crowd) {
    for (uint32_t i = 0; i < crowd->group_count; i++) {
        fp3_crowd_group *g = &crowd->groups[i];
        for (uint32_t r = 0; g->sights && r < g->model->relation_count; r++) {
            fp3_crowd_sight *s = &g->sights[r];
            free(s->begin);
            free(s->who);
            free(s->fields);
            free(s->next);
            free(s->own);
            free(s->theirs);
        }
        free(g->params);
        free(g->states);
        free(g->offset);
        free(g->born);
        free(g->gone);
        free(g->is_alive);
        free(g->is_stopped);
        free(g->words);
        free(g->sights);
    }
    free(crowd->groups);
    *crowd = (fp3_crowd){0};
}

void fp3_crowd_live(fp3_crowd *crowd, uint64_t step, uint64_t parts) {
    for (uint32_t k = 0; k < crowd->group_count; k++) {
        fp3_crowd_group *g = &crowd->groups[k];
        const uint32_t removed = g->model ? fp3_model_state(g->model, FP3_NAME_REMOVED) : FP3_NONE;
        const uint64_t now = step / parts;
        for (size_t i = 0; i < g->objects && g->is_alive; i++)
            g->is_alive[i] = g->born[i] <= now && now < g->gone[i] &&
                             (removed == FP3_NONE || g->states[removed * g->objects + i] == 0);
    }
}
