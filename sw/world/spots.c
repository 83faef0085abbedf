/* SPDX-License-Identifier: Apache-2.0 */
/* spots.c - see spots.h. */
#include "spots.h"

#include "base/host.h"
#include "compiler/start.h"
#include "engine/common/radii.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

fp3_status fp3_batch_settle_reach(fp3_batch *b) {
    const fp3_model *model = b->compiled ? fp3_start_model(b->compiled) : NULL;
    if (!b->is_reach_new || !model || !model->relation_count)
        return FP3_OK;
    double *params = calloc(model->param_count + 1u, sizeof *params);
    fp3_status status = params ? FP3_OK : fp3_no_memory(b->error);
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        if (model->params[i].is_shared)
            status = fp3_fields_get(b->fields, model->params[i].name, &params[i], b->error);
    if (!status)
        status = fp3_relations_reach(&b->relations, params, b->error);
    free(params);
    b->is_reach_new = status != FP3_OK;
    return status;
}

/* ---- names ---- */

static int is_state(const fp3_batch *b, const char *name, const char **found) {
    const fp3_model *model = b->compiled ? fp3_start_model(b->compiled) : NULL;
    *found = NULL;
    for (uint32_t i = 0; model && i < model->state_count; i++)
        if (strcmp(model->states[i].name, name) == 0)
            *found = model->states[i].name;
    const fp3_symbol *s =
        model ? NULL : fp3_image_find(b->image, name, FP3_CLASS(FP3_SYMBOL_STATE));
    if (s)
        *found = s->name;
    return *found != NULL;
}

static fp3_status name_states(fp3_batch *b, const char *of, fp3_spots *p) {
    static const char *const ends[] = {"_x", "_y", "_z"};
    const size_t length = strlen(of);
    char name[FP3_NAME_SIZE];
    if (is_state(b, of, &p->names[0])) {
        p->dimensions = 1;
        return FP3_OK;
    }
    for (uint32_t k = 0; length + 2 < sizeof name && k < 3; k++) {
        memcpy(name, of, length);
        strcpy(name + length, ends[k]);
        if (!is_state(b, name, &p->names[k]))
            break;
        p->dimensions = k + 1;
    }
    return p->dimensions ? FP3_OK
                         : fp3_fail(b->error, FP3_E_ARGUMENT,
                                    "'%s' is no relation of near objects, and no state", of);
}

static fp3_status name_relation(fp3_batch *b, const char *of, fp3_spots *p) {
    const fp3_model *model = b->compiled ? fp3_start_model(b->compiled) : NULL;
    for (uint32_t i = 0; model && i < model->relation_count; i++) {
        const fp3_relation *r = &model->relations[i];
        if (r->kind != FP3_NEAR || strcmp(r->name, of) != 0)
            continue;
        const fp3_status status = fp3_batch_settle_reach(b);
        if (r->of_kind == FP3_NONE && r->radius != FP3_NONE)
            p->radius = model->params[r->radius].name;
        p->reach = b->relations.reach[i];
        p->dimensions = r->dimensions;
        for (uint32_t k = 0; k < r->dimensions; k++)
            p->names[k] = model->states[r->position + k].name;
        return status;
    }
    return name_states(b, of, p);
}

fp3_status fp3_batch_dimensions(fp3_batch *b, const char *of, uint32_t *dimensions) {
    FP3_HOST;
    fp3_spots p = {0};
    if (!b)
        return FP3_E_ARGUMENT;
    const fp3_status status = name_relation(b, of, &p);
    *dimensions = status ? 0 : p.dimensions;
    return status;
}

/* ---- columns ---- */

fp3_status fp3_spots_open(fp3_batch *b, const char *of, fp3_spots *p) {
    *p = (fp3_spots){.objects = (uint32_t)b->objects};
    fp3_status status = name_relation(b, of, p);
    for (uint32_t k = 0; !status && k < p->dimensions; k++) {
        p->x[k] = malloc((b->objects + 1) * sizeof *p->x[k]);
        status = p->x[k] ? fp3_fields_read(b->fields, p->names[k], 0, b->objects, p->x[k], NULL,
                                           b->error)
                         : fp3_no_memory(b->error);
    }
    for (size_t i = 0; !status && i < b->objects; i++)
        if (!b->births.lives[i] || fp3_engine_life(b->engine, i) == FP3_GONE) /* by an event */
            p->x[0][i] = NAN;
    return status;
}

void fp3_spots_close(fp3_spots *p) {
    for (int k = 0; k < 3; k++)
        free(p->x[k]);
    free(p->radii);
    *p = (fp3_spots){0};
}

/* ---- pairs ---- */

/* The reach, with the radii of all objects. */
static fp3_status read_radii(const fp3_batch *b, fp3_spots *p) {
    p->radii = malloc((b->objects + 1) * sizeof *p->radii);
    fp3_status status =
        p->radii ? fp3_fields_read(b->fields, p->radius, 0, b->objects, p->radii, NULL, b->error)
                 : fp3_no_memory(b->error);
    for (uint32_t i = 0; !status && i < p->objects; i++)
        if (!fp3_is_radius((double)p->radii[i]))
            status = fp3_fail(b->error, FP3_E_ARGUMENT,
                              "'%s' of object %" PRIu32 " is %g: expected 0, or 2^-50 to 2^61, "
                              "which is added to the reach",
                              p->radius, i, (double)p->radii[i]);
    return status;
}

static fp3_status check_distance(const fp3_batch *b, const char *of, double reach,
                                 double *distance) {
    if (*distance == 0 && reach == 0)
        return fp3_fail(b->error, FP3_E_ARGUMENT,
                        "'%s' has no reach, of which the program knows: expected a distance", of);
    *distance = *distance == 0 ? reach : *distance;
    return *distance >= FP3_NEAR_LEAST && *distance <= FP3_NEAR_MOST
               ? FP3_OK
               : fp3_fail(b->error, FP3_E_ARGUMENT,
                          "a distance of %g: expected one from 2^-50 to 2^63, or 0 for the reach",
                          *distance);
}

/* A list has some that are farther away. */
static size_t choose(const fp3_spots *p, double reach, const uint32_t *begin, const uint32_t *other,
                     uint32_t *a, uint32_t *b) {
    size_t count = 0;
    for (uint32_t i = 0; i < p->objects; i++) {
        const double at[] = {(double)p->x[0][i], p->x[1] ? (double)p->x[1][i] : 0,
                             p->x[2] ? (double)p->x[2][i] : 0};
        for (uint32_t e = begin[i]; e < begin[i + 1]; e++) {
            const double distance =
                p->radii ? (double)p->radii[i] + (double)p->radii[other[e]] + reach : reach;
            if (other[e] <= i || !(fp3_spots_square(p, at, other[e]) < distance * distance))
                continue;
            a[count] = i;
            b[count++] = other[e];
        }
    }
    return count;
}

static fp3_status find_pairs(const fp3_batch *b, const fp3_spots *p, double distance,
                             uint32_t **first, uint32_t **second, size_t *count) {
    fp3_near_rule rule = {
        .dimensions = p->dimensions, .reach = distance, .radius = p->radii != NULL};
    fp3_where_they_are now = {.stride = 1, .objects = p->objects, .dimensions = p->dimensions};
    uint32_t *begin = NULL, *other = NULL;
    for (uint32_t k = 0; k < p->dimensions; k++)
        now.position[k] = (const uint32_t *)(const void *)p->x[k];
    now.radius = (const uint32_t *)(const void *)p->radii;
    fp3_status status = fp3_near_make(&rule, &now, &begin, &other, b->error);
    if (!status) {
        *first = malloc((begin[p->objects] / 2 + (size_t)1) * sizeof **first);
        *second = malloc((begin[p->objects] / 2 + (size_t)1) * sizeof **second);
        status = *first && *second ? FP3_OK : fp3_no_memory(b->error);
    }
    if (!status)
        *count = choose(p, distance, begin, other, *first, *second);
    fp3_near_close(&rule);
    free(begin);
    free(other);
    return status;
}

fp3_status fp3_spots_pairs(fp3_batch *b, const char *of, double distance, uint32_t **first,
                           uint32_t **second, size_t *count) {
    fp3_spots p;
    *first = *second = NULL;
    *count = 0;
    fp3_status status = fp3_spots_open(b, of, &p);
    if (!status && distance == 0 && p.radius)
        status = read_radii(b, &p);
    if (!status)
        status = p.radii ? FP3_OK : check_distance(b, of, p.reach, &distance);
    if (p.radii)
        distance = p.reach;
    if (!status)
        status = find_pairs(b, &p, distance, first, second, count);
    fp3_spots_close(&p);
    return status;
}
