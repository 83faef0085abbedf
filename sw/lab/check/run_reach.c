/* SPDX-License-Identifier: Apache-2.0 */
/* run_reach.c - see run_reach.h. */
#include "run_reach.h"

#include "world/apply.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The part of the reach that all pairs share, from the params of an object. */
static fp3_status same_reach(const fp3_model *m, const fp3_object_values *values, uint32_t expr,
                             double *reach, fp3_error *error) {
    double *room = calloc(m->expr_count + m->state_count + 1u, sizeof *room);
    if (!room)
        return fp3_no_memory(error);
    fp3_model_evaluate(m, &(fp3_point){.params = values->params, .states = room + m->expr_count},
                       room);
    *reach = room[expr];
    free(room);
    return FP3_OK;
}

/* Whose reach is known: not where another kind's objects add to it. */
static int is_known(const fp3_model *m, const fp3_relation *r) {
    int is = r->kind == FP3_NEAR && (r->of_kind == FP3_NONE || r->their_radius == FP3_NONE);
    for (uint32_t k = 0; is && k < r->dimensions; k++)
        is = m->states[r->position + k].velocity != FP3_NONE;
    return is;
}

/* Adds the squares of a component of the velocities. */
static fp3_status add_squares(const fp3_run_part *part, uint32_t state, double *row,
                              double *squares, fp3_error *error) {
    const fp3_status status = fp3_run_state_read(part->program, part->engine, state, part->first,
                                                 part->objects, row, error);
    for (size_t i = 0; !status && i < part->objects; i++)
        squares[i] += row[i] * row[i];
    return status;
}

/* An object in the relation, with the largest way in a step as a share of the reach. */
typedef struct {
    size_t object;
    double way, reach, h;
} fastest;

static fp3_status find(const fp3_run_part *part, const fp3_relation *r, fp3_object_values *values,
                       fastest *found, fp3_error *error) {
    const fp3_model *m = part->program->model;
    const size_t last = part->objects - 1;
    double *row = calloc(2 * part->objects + 1, sizeof *row), same = 0;
    double *squares = row + part->objects;
    fp3_status status = row ? FP3_OK : fp3_no_memory(error);
    for (uint32_t k = 0; !status && k < r->dimensions; k++)
        status = add_squares(part, m->states[r->position + k].velocity, row, squares, error);
    for (size_t i = 0; !status && i < part->objects; i++) {
        status = fp3_object_values_at(values, last ? (double)i / (double)last : 0, error);
        if (!status && i == 0)
            status = same_reach(m, values, r->reach, &same, error);
        if (status || fp3_engine_life(part->engine, part->first + i) != FP3_ALIVE)
            continue;
        const double radius = r->radius == FP3_NONE ? 0 : values->params[r->radius];
        const double reach = same + (r->of_kind == FP3_NONE ? 2 * radius : radius);
        const double way = sqrt(squares[i]) * values->h;
        if (way > reach && way * found->reach > found->way * reach)
            *found = (fastest){i, way, reach, values->h};
    }
    free(row);
    return status;
}

fp3_status fp3_run_reach_warn(const fp3_run_part *part, fp3_run_say_fn *say, const char *path,
                              size_t *warnings, fp3_error *error) {
    const fp3_model *m = part->program->model;
    fp3_object_values values = {0};
    fp3_status status = FP3_OK;
    if (!m || fp3_adaptive_is(part->program->image))
        return FP3_OK;
    for (uint32_t n = 0; !status && n < m->relation_count; n++) {
        const fp3_relation *r = &m->relations[n];
        fastest found = {.reach = 1};
        char text[240];
        if (!is_known(m, r) || (r->of_kind == FP3_NONE && part->objects < 2))
            continue;
        status = fp3_object_values_open(part->program, part->params, &values, error);
        if (!status)
            status = find(part, r, &values, &found, error);
        fp3_object_values_free(&values);
        if (status || found.way == 0)
            continue;
        snprintf(text, sizeof text,
                 "object %zu: it moves by %.3g in a step of h = %.3g, farther than '%s' reaches, "
                 "%.3g: it may pass others unseen; use a shorter step",
                 part->first + found.object, found.way, found.h, r->name, found.reach);
        say(path, text);
        ++*warnings;
    }
    return status;
}
