/* SPDX-License-Identifier: Apache-2.0 */
/* packing.c - see packing.h. */
#include "packing.h"

#include <math.h>

#define SIDE 4      /* objects along each axis */
#define WITHIN 0.98 /* of the reach */

/* The first relation of near objects of the own group; FP3_NONE: none. */
static uint32_t touching(const fp3_model *m) {
    for (uint32_t r = 0; r < m->relation_count; r++)
        if (m->relations[r].kind == FP3_NEAR && m->relations[r].of_kind == FP3_NONE)
            return r;
    return FP3_NONE;
}

static double reach_of(const fp3_crowd_group *g, uint32_t relation, size_t i, size_t j) {
    const uint32_t radius = g->model->relations[relation].radius;
    const double *radii = radius == FP3_NONE ? NULL : g->params + radius * g->objects;
    return g->sights[relation].reach + (radii ? radii[i] + radii[j] : 0);
}

static int is_within(const fp3_crowd_group *g, uint32_t relation, size_t i, size_t j) {
    const fp3_relation *r = &g->model->relations[relation];
    const double reach = reach_of(g, relation, i, j);
    double square = 0;
    for (uint32_t k = 0; k < r->dimensions; k++) {
        const double *x = g->states + (r->position + k) * g->objects;
        square += (x[j] - x[i]) * (x[j] - x[i]);
    }
    return square < reach * reach;
}

static double neighbours_of(const fp3_crowd_group *g, uint32_t relation, size_t i) {
    const fp3_crowd_sight *s = &g->sights[relation];
    double neighbours = 0;
    for (size_t e = s->begin[i]; e < s->begin[i + 1]; e++)
        neighbours += g->is_alive[s->who[e]] && is_within(g, relation, i, s->who[e]);
    return neighbours;
}

double fp3_packing_neighbours(const fp3_crowd *crowd) {
    double objects = 0, neighbours = 0;
    for (uint32_t k = 0; k < crowd->group_count; k++) {
        const fp3_crowd_group *g = &crowd->groups[k];
        const uint32_t relation = touching(g->model);
        for (size_t i = 0; relation != FP3_NONE && i < g->objects; i++)
            if (fp3_crowd_moves(g, i)) {
                objects++;
                neighbours += neighbours_of(g, relation, i);
            }
    }
    return objects > 0 ? neighbours / objects : INFINITY;
}

/* Places the objects of a packing, whose first one is where the middle of all was. */
static void place(const fp3_crowd_group *g, uint32_t relation, const size_t *who, size_t count) {
    const fp3_relation *r = &g->model->relations[relation];
    const double apart = WITHIN * reach_of(g, relation, who[0], who[0]);
    for (size_t k = 0, row = 1; k < r->dimensions; k++, row *= SIDE) {
        const uint32_t velocity = g->model->states[r->position + k].velocity;
        double *x = g->states + (r->position + k) * g->objects, sum = 0;
        for (size_t i = 0; i < g->objects; i++)
            sum += x[i];
        for (size_t n = 0; n < count; n++) {
            x[who[n]] = sum / (double)g->objects + apart * (double)(n / row % SIDE);
            if (velocity != FP3_NONE)
                g->states[velocity * g->objects + who[n]] = 0;
        }
    }
}

/* Objects of one radius: of any other the distance would not fit. */
int fp3_packing_make(const fp3_crowd_group *g) {
    const uint32_t relation = g->objects ? touching(g->model) : FP3_NONE;
    size_t who[SIDE * SIDE * SIDE] = {0}, most = 1, count = 0;
    if (relation == FP3_NONE)
        return 0;
    for (uint32_t k = 0; k < g->model->relations[relation].dimensions && k < 3; k++)
        most *= SIDE;
    for (size_t i = 0; i < g->objects; i++) {
        const int is_alike = reach_of(g, relation, i, i) == reach_of(g, relation, 0, 0);
        g->is_alive[i] = (char)(is_alike && count < most);
        if (g->is_alive[i])
            who[count++] = i;
    }
    if (count > 1)
        place(g, relation, who, count);
    return count > 1;
}
