/* SPDX-License-Identifier: Apache-2.0 */
/* scene_invariants.c - see scene_invariants.h. */
#include "scene_invariants.h"

#include "invariants.h"
#include "lab/scene/crowd.h"
#include "run_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Terms of all times: more than this take seconds. */
#define TERMS 3e7

/* Groups that see each other. */
typedef struct {
    fp3_invariant_group *groups;
    size_t *numbers; /* in the scene */
    size_t count;
    fp3_invariants *of;
    fp3_invariant *found, *first;
} together;

typedef struct {
    const fp3_definition *of;
    size_t group; /* SIZE_MAX: of all objects of a set together */
    size_t set, number;
} entry;

struct fp3_scene_invariants {
    const fp3_scene *scene;
    const uint64_t *steps;
    fp3_crowd crowd;
    size_t width;
    size_t *first; /* of each group, its place in a row */
    double *start;
    together *sets;
    size_t set_count;
    entry *entries;
    size_t count;
    double *values; /* of the expressions of a model, its params, states and first states */
};

/* ---- what there is ---- */

static int comes_and_goes(const fp3_scene *scene) {
    for (size_t k = 0; k < scene->group_count; k++) {
        const fp3_scene_group *g = &scene->groups[k];
        if (fp3_model_removes(g->program->model))
            return 1;
        for (size_t i = 0; i < g->objects; i++) {
            uint64_t born, gone;
            fp3_scene_life(g, i, &born, &gone);
            if (born > 0 || gone != FP3_FOREVER)
                return 1;
        }
    }
    return 0;
}

static fp3_status open_set(fp3_scene_invariants *v, const fp3_run_set *from, together *set,
                           fp3_error *error) {
    set->groups = calloc(from->count + 1, sizeof *set->groups);
    set->numbers = calloc(from->count + 1, sizeof *set->numbers);
    if (!set->groups || !set->numbers)
        return fp3_no_memory(error);
    set->count = from->count;
    for (size_t i = 0; i < from->count; i++) {
        const fp3_scene_group *g = from->groups[i];
        set->groups[i] = (fp3_invariant_group){g->name, g->program, g->params, g->objects, NULL, 0};
        set->numbers[i] = (size_t)(g - v->scene->groups);
    }
    fp3_status status = fp3_invariants_open(set->groups, set->count, &set->of, error);
    const size_t count = status ? 0 : fp3_invariants_count(set->of);
    set->found = calloc(2 * count + 1, sizeof *set->found);
    set->first = set->found + count;
    return status ? status : set->found ? FP3_OK : fp3_no_memory(error);
}

static fp3_status open_sets(fp3_scene_invariants *v, fp3_error *error) {
    fp3_run_part *parts = calloc(v->scene->group_count + 1, sizeof *parts);
    fp3_run_set *sets = NULL;
    size_t count = 0;
    fp3_status status = parts ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < v->scene->group_count; i++) {
        const fp3_scene_group *g = &v->scene->groups[i];
        parts[i] = (fp3_run_part){g->program, g->params, NULL, g->first, g->objects, 0};
    }
    if (!status)
        status = fp3_run_sets_make(v->scene, parts, v->scene->group_count, &sets, &count, error);
    v->sets = calloc(count + 1, sizeof *v->sets);
    if (!status && !v->sets)
        status = fp3_no_memory(error);
    for (; !status && v->set_count < count; v->set_count++)
        status = open_set(v, &sets[v->set_count], &v->sets[v->set_count], error);
    fp3_run_sets_free(&sets, count);
    free(parts);
    return status;
}

/* Of groups that add it up the first one's. */
static const fp3_definition *definition_of(const together *set, const char *name) {
    for (size_t i = 0; i < set->count; i++) {
        const fp3_model *m = set->groups[i].program->model;
        for (uint32_t k = 0; k < m->group_invariant_count; k++)
            if (!strcmp(m->group_invariants[k].name, name))
                return &m->group_invariants[k];
    }
    return NULL;
}

static fp3_status list(fp3_scene_invariants *v, fp3_error *error) {
    size_t most = 0;
    for (uint32_t k = 0; k < v->crowd.group_count; k++)
        most += v->crowd.groups[k].model->invariant_count;
    for (size_t s = 0; s < v->set_count; s++)
        most += fp3_invariants_count(v->sets[s].of);
    v->entries = calloc(most + 1, sizeof *v->entries);
    if (!v->entries)
        return fp3_no_memory(error);
    for (uint32_t k = 0; k < v->crowd.group_count; k++) {
        const fp3_model *m = v->crowd.groups[k].model;
        for (uint32_t i = 0; !fp3_model_removes(m) && i < m->invariant_count; i++)
            v->entries[v->count++] = (entry){&m->invariants[i], k, 0, 0};
    }
    for (size_t s = 0; s < v->set_count; s++)
        for (size_t i = 0; i < fp3_invariants_count(v->sets[s].of); i++)
            v->entries[v->count++] = (entry){
                definition_of(&v->sets[s], fp3_invariants_name(v->sets[s].of, i)), SIZE_MAX, s, i};
    return FP3_OK;
}

static fp3_status take_room(fp3_scene_invariants *v, fp3_error *error) {
    size_t most = 0;
    v->first = calloc(v->crowd.group_count + 1u, sizeof *v->first);
    for (uint32_t k = 0; v->first && k < v->crowd.group_count; k++) {
        const fp3_model *m = v->crowd.groups[k].model;
        const size_t needed = m->expr_count + m->param_count + 2u * m->state_count;
        v->first[k] = v->width;
        v->width += m->state_count * v->crowd.groups[k].objects;
        most = needed > most ? needed : most;
    }
    v->values = calloc(most + 1, sizeof *v->values);
    v->start = calloc(v->width + 1, sizeof *v->start);
    if (!v->first || !v->values || !v->start)
        return fp3_no_memory(error);
    for (uint32_t k = 0; k < v->crowd.group_count; k++) {
        const fp3_crowd_group *g = &v->crowd.groups[k];
        memcpy(v->start + v->first[k], g->states,
               g->model->state_count * g->objects * sizeof *v->start);
    }
    return FP3_OK;
}

fp3_status fp3_scene_invariants_open(const fp3_scene *scene, const uint64_t *steps,
                                     fp3_scene_invariants **of, fp3_error *error) {
    fp3_scene_invariants *v = *of = calloc(1, sizeof *v);
    if (!v)
        return fp3_no_memory(error);
    v->scene = scene;
    v->steps = steps;
    fp3_status status = fp3_crowd_open(scene, &v->crowd, error);
    if (!status)
        status = take_room(v, error);
    if (!status && !comes_and_goes(scene))
        status = open_sets(v, error);
    if (!status)
        status = list(v, error);
    if (status)
        fp3_scene_invariants_close(of);
    return status;
}

void fp3_scene_invariants_close(fp3_scene_invariants **of) {
    fp3_scene_invariants *v = *of;
    if (!v)
        return;
    for (size_t s = 0; s < v->set_count; s++) {
        fp3_invariants_close(&v->sets[s].of);
        free(v->sets[s].groups);
        free(v->sets[s].numbers);
        free(v->sets[s].found);
    }
    free(v->sets);
    fp3_crowd_close(&v->crowd);
    free(v->first);
    free(v->entries);
    free(v->start);
    free(v->values);
    free(v);
    *of = NULL;
}

size_t fp3_scene_invariants_count(const fp3_scene_invariants *v) { return v->count; }

const fp3_definition *fp3_scene_invariants_name(const fp3_scene_invariants *v, size_t number) {
    return v->entries[number].of;
}

const fp3_scene_group *fp3_scene_invariants_group(const fp3_scene_invariants *v, size_t number) {
    const size_t group = v->entries[number].group;
    return group == SIZE_MAX ? NULL : &v->scene->groups[group];
}

/* ---- values ---- */

/* Time stands still for an object that is not born, or gone. */
static double time_of(const fp3_crowd_group *g, size_t object, uint64_t step) {
    const uint64_t born = g->born[object], gone = g->gone[object];
    return g->offset[object] + g->h * (double)(step < born ? born : step > gone ? gone : step);
}

static void gather(const double *columns, uint32_t count, size_t objects, size_t object,
                   double *row) {
    for (uint32_t k = 0; k < count; k++)
        row[k] = columns[k * objects + object];
}

static double value_of(fp3_scene_invariants *v, const entry *e, size_t object, const double *start,
                       const double *row, uint64_t step) {
    const fp3_crowd_group *g = &v->crowd.groups[e->group];
    const fp3_model *m = g->model;
    double *params = v->values + m->expr_count, *states = params + m->param_count,
           *initial = states + m->state_count;
    gather(g->params, m->param_count, g->objects, object, params);
    gather(row + v->first[e->group], m->state_count, g->objects, object, states);
    gather(start + v->first[e->group], m->state_count, g->objects, object, initial);
    const fp3_point at = {
        .t = time_of(g, object, step), .states = states, .params = params, .initial = initial};
    fp3_model_evaluate(m, &at, v->values);
    return v->values[e->of->expr];
}

static int is_more(double change, double than) {
    return isnan(than) ? 0 : isnan(change) || fabs(change) > fabs(than);
}

static void look_at_each(fp3_scene_invariants *v, const entry *e, const double *start,
                         const double *rows, size_t times, fp3_scene_invariant *found) {
    const size_t objects = v->crowd.groups[e->group].objects;
    for (size_t i = 0; i < objects; i++) {
        const double first = value_of(v, e, i, start, start, 0);
        for (size_t t = 0; t < times; t++) {
            const double change =
                value_of(v, e, i, start, rows + t * v->width, v->steps[t]) - first;
            if ((!i && !t) || is_more(change, found->change))
                *found = (fp3_scene_invariant){first, change, NAN, i, t};
        }
    }
}

static fp3_status sum(fp3_scene_invariants *v, together *set, const double *row, uint64_t step,
                      fp3_error *error) {
    for (size_t i = 0; i < set->count; i++) {
        set->groups[i].columns = row + v->first[set->numbers[i]];
        set->groups[i].t = time_of(&v->crowd.groups[set->numbers[i]], 0, step);
    }
    return fp3_invariants_find(set->of, set->found, error);
}

static void note(const fp3_scene_invariants *v, size_t set, size_t time, int is_first,
                 fp3_scene_invariant *changed) {
    const together *of = &v->sets[set];
    for (size_t i = 0; i < v->count; i++) {
        const entry *e = &v->entries[i];
        if (e->group != SIZE_MAX || e->set != set)
            continue;
        const fp3_invariant *first = &of->first[e->number], *now = &of->found[e->number];
        const double change = now->value - first->value;
        if (is_first || is_more(change, changed[i].change))
            changed[i] = (fp3_scene_invariant){first->value, change,
                                               fp3_invariant_change(first, now), 0, time};
    }
}

static fp3_status look_at_all(fp3_scene_invariants *v, size_t number, const double *start,
                              const double *rows, size_t times, fp3_scene_invariant *changed,
                              fp3_error *error) {
    together *set = &v->sets[number];
    const size_t count = fp3_invariants_count(set->of);
    const size_t apart = 1 + (size_t)(fp3_invariants_work(set->of) * (double)times / TERMS);
    if (!count)
        return FP3_OK;
    fp3_status status = sum(v, set, start, 0, error);
    memcpy(set->first, set->found, count * sizeof *set->first);
    for (size_t left = times; !status && left > 0; left -= apart < left ? apart : left) {
        status = sum(v, set, rows + (left - 1) * v->width, v->steps[left - 1], error);
        if (!status)
            note(v, number, left - 1, left == times, changed);
    }
    return status;
}

fp3_status fp3_scene_invariants_look(fp3_scene_invariants *v, const double *start,
                                     const double *rows, size_t times, fp3_scene_invariant *changed,
                                     fp3_error *error) {
    fp3_status status = FP3_OK;
    start = start ? start : v->start;
    for (size_t i = 0; i < v->count; i++) {
        changed[i] = (fp3_scene_invariant){NAN, NAN, NAN, 0, 0};
        if (v->entries[i].group != SIZE_MAX)
            look_at_each(v, &v->entries[i], start, rows, times, &changed[i]);
    }
    for (size_t s = 0; !status && s < v->set_count; s++)
        status = look_at_all(v, s, start, rows, times, changed, error);
    return status;
}
