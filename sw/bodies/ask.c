/* SPDX-License-Identifier: Apache-2.0 */
/* ask.c - what a ray or a shape meets.
 *
 * Each shape is looked at; those that are too far, by their extents, cost a few operations. All is
 * computed from where the question is asked, so it is as exact far from the origin.
 */
#include "own3.h"
#include "shapes/query2.h"
#include "turn.h"

#include "base/host.h"

#include <math.h>
#include <stdio.h>

#define FARTHEST 1e9

/* Who asks: a shape that stands somewhere, or a point. */
typedef struct {
    double at[3];
    int is_shape;
    fp3_shape2 plane;
    fp3_pose2 turn;
    fp3_form3 *form; /* in space */
    fp3_pose3 turn3;
    float extent;
} asker;

/* What was found of a shape, as seen from who asks. */
typedef struct {
    fp3_point3 at, normal;
    float gap, fraction;
} answer;

static asker point_at(const double *x, size_t dimensions) {
    asker a = {.turn = {.c = 1}, .turn3 = {.q = {1, 0, 0, 0}}};
    a.plane.core.count = 1;
    for (size_t i = 0; i < dimensions; i++)
        a.at[i] = x[i];
    return a;
}

static fp3_point3 between(const fp3_bodies *bodies, const asker *from, uint32_t body) {
    const double *at = bodies->body[body].at;
    return (fp3_point3){(float)(at[0] - from->at[0]), (float)(at[1] - from->at[1]),
                        (float)(at[2] - from->at[2])};
}

/* Whether a way from the origin comes as near as that to a place, or a little farther. */
static int comes_near(fp3_point3 way, fp3_point3 place, float reach) {
    const float square = fp3_dot3(way, way);
    float t = square > 0 ? fp3_dot3(way, place) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const fp3_point3 left = fp3_along3(place, -t, way);
    const float wide = reach * 1.001f + 1e-5f * (fabsf(place.x) + fabsf(place.y) + fabsf(place.z));
    return fp3_dot3(left, left) <= wide * wide;
}

/* Whether a shape is one of those that are asked about, and not too far from the way. */
static int may_be(const fp3_bodies *bodies, const asker *from, uint32_t number, uint32_t mask,
                  fp3_point3 way, float reach) {
    const fp3_attached *shape = &bodies->shape[number];
    if (!(shape->generation & 1) || !(shape->category & mask))
        return 0;
    return (shape->form && shape->form->kind != FP3_FORM_HULL) || !isfinite(reach) ||
           comes_near(way, between(bodies, from, shape->body),
                      shape->extent + from->extent + reach);
}

static fp3_pose2 pose2_of(const fp3_bodies *bodies, const asker *from, uint32_t body) {
    const fp3_point3 at = between(bodies, from, body);
    const float *turn = bodies->body[body].turn;
    return (fp3_pose2){{at.x, at.y}, turn[0], turn[1]};
}

static fp3_hit hit_of(const fp3_bodies *bodies, const asker *from, uint32_t shape,
                      const answer *found, double distance) {
    const fp3_attached *s = &bodies->shape[shape];
    return (fp3_hit){
        .body = fp3_bodies_handle(bodies, s->body),
        .shape = (uint64_t)s->generation << 32 | shape,
        .point = {from->at[0] + found->at.x, from->at[1] + found->at.y, from->at[2] + found->at.z},
        .normal = {found->normal.x, found->normal.y, found->normal.z},
        .distance = distance,
        .fraction = found->fraction};
}

static fp3_status check(const fp3_bodies *bodies, const char *name, const double *values,
                        size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs(values[i]) <= FARTHEST))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s[%zu] is %g, expected -1e9 to 1e9",
                            name, i, values[i]);
    return FP3_OK;
}

/* Of several rows of `width` numbers. */
static fp3_status check_rows(const fp3_bodies *bodies, const char *name, const double *values,
                             size_t rows, size_t width) {
    char of[32];
    for (size_t i = 0; i < rows * width; i++)
        if (!(fabs(values[i]) <= FARTHEST)) {
            snprintf(of, sizeof of, "%s[%zu]", name, i / width);
            return check(bodies, of, values + i / width * width, width);
        }
    return FP3_OK;
}

/* ---- what is met first ---- */

static int cast(const fp3_bodies *bodies, const asker *from, uint32_t number, fp3_point3 way,
                float slop, answer *found) {
    const fp3_attached *shape = &bodies->shape[number];
    if (bodies->space) {
        const fp3_pose3 pose =
            fp3_space_pose(bodies, shape->body, between(bodies, from, shape->body));
        fp3_hit3 hit;
        if (!fp3_form_cast(shape->form, &pose, from->is_shape ? &from->form->shape : NULL,
                           &from->turn3, way, slop, &hit))
            return 0;
        *found = (answer){fp3_add3(pose.at, hit.arm), hit.normal, 0, hit.fraction};
        return 1;
    }
    const fp3_pose2 pose = pose2_of(bodies, from, shape->body);
    const fp3_point2 along = {way.x, way.y};
    fp3_hit2 hit;
    if (!(from->is_shape
              ? fp3_cast2(&shape->shape, &pose, &from->plane, &from->turn, along, slop, &hit)
              : fp3_ray2(&shape->shape, &pose, (fp3_point2){0, 0}, along, &hit)))
        return 0;
    *found = (answer){{pose.at.x + hit.arm.x, pose.at.y + hit.arm.y, 0},
                      {hit.normal.x, hit.normal.y, 0},
                      0,
                      hit.fraction};
    return 1;
}

static fp3_hit first_hit(const fp3_bodies *bodies, const asker *from, const double *way,
                         uint32_t mask) {
    const int is_space = bodies->space != NULL;
    const fp3_point3 along = {(float)way[0], (float)way[1], is_space ? (float)way[2] : 0};
    const double length =
        sqrt((way[0] * way[0] + way[1] * way[1]) + (is_space ? way[2] * way[2] : 0));
    const float slop = (float)(1e-3 * bodies->def.size);
    fp3_hit best = {.fraction = INFINITY, .distance = INFINITY};
    for (uint32_t i = 0; i < bodies->shape_count; i++) {
        answer found;
        if (may_be(bodies, from, i, mask, along, from->is_shape ? slop : 0) &&
            cast(bodies, from, i, along, slop, &found) && found.fraction < best.fraction)
            best = hit_of(bodies, from, i, &found, found.fraction * length);
    }
    return best;
}

fp3_status fp3_bodies_ray(fp3_bodies *bodies, const double *from, const double *way, size_t count,
                          uint32_t mask, fp3_hit *hits) {
    FP3_HOST;
    const size_t width = bodies->def.dimensions;
    fp3_status status = check_rows(bodies, "from", from, count, width);
    if (!status)
        status = check_rows(bodies, "way", way, count, width);
    for (size_t i = 0; !status && i < count; i++) {
        const asker point = point_at(from + width * i, width);
        hits[i] = first_hit(bodies, &point, way + width * i, mask);
    }
    return status;
}

static fp3_status turn_of(const fp3_bodies *bodies, const double *turn, asker *to) {
    double of[2];
    if (!turn)
        return FP3_OK;
    const fp3_status status = check(bodies, "turn", turn, bodies->space ? 4 : 1);
    if (status)
        return status;
    for (int i = 0; bodies->space && i < 4; i++)
        to->turn3.q[i] = (float)turn[i];
    if (!fp3_turn3_is_good(to->turn3.q))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "turn: expected a quaternion with a length from 1e-3 to 1e3");
    fp3_turn2_of(bodies->space ? 0 : *turn, of);
    to->turn = (fp3_pose2){{0, 0}, (float)of[0], (float)of[1]};
    return FP3_OK;
}

/* The caller gives asker.form back, also after an error. */
static fp3_status shape_at(const fp3_bodies *bodies, const fp3_shape_def *def, const double *x,
                           const double *turn, asker *to) {
    fp3_status status = check(bodies, "x", x, bodies->def.dimensions);
    *to = point_at(x, status ? 0 : bodies->def.dimensions);
    to->is_shape = 1;
    if (!status)
        status = turn_of(bodies, turn, to);
    if (status)
        return status;
    status = bodies->space ? fp3_form_make(def, &to->form, bodies->error)
                           : fp3_shape_make(def, &to->plane, bodies->error);
    if (!status && to->form && to->form->kind != FP3_FORM_HULL)
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT, "a plane asks nothing: expected a shape");
    if (!status)
        to->extent = to->form ? to->form->shape.extent : to->plane.extent;
    return status;
}

fp3_status fp3_bodies_cast(fp3_bodies *bodies, const fp3_shape_def *def, const double *x,
                           const double *turn, const double *way, uint32_t mask, fp3_hit *hit) {
    FP3_HOST;
    asker shape;
    fp3_status status = shape_at(bodies, def, x, turn, &shape);
    if (!status)
        status = check(bodies, "way", way, bodies->def.dimensions);
    if (!status)
        *hit = first_hit(bodies, &shape, way, mask);
    fp3_form_give_back(shape.form);
    return status;
}

/* ---- what is near ---- */

static int look(const fp3_bodies *bodies, const asker *from, const fp3_form3 *point,
                uint32_t number, answer *found) {
    const fp3_attached *shape = &bodies->shape[number];
    if (bodies->space) {
        const fp3_pose3 pose =
            fp3_space_pose(bodies, shape->body, between(bodies, from, shape->body));
        fp3_apart3 apart;
        if (!fp3_form_separation(shape->form, &pose,
                                 from->is_shape ? &from->form->shape : &point->shape, &from->turn3,
                                 &apart))
            return 0;
        *found = (answer){fp3_add3(pose.at, apart.arm_a), apart.normal, apart.gap, 0};
        return 1;
    }
    const fp3_pose2 pose = pose2_of(bodies, from, shape->body);
    fp3_apart2 apart;
    if (!fp3_separation2(&shape->shape, &pose, &from->plane, &from->turn, &apart))
        return 0;
    *found = (answer){{pose.at.x + apart.arm_a.x, pose.at.y + apart.arm_a.y, 0},
                      {apart.normal.x, apart.normal.y, 0},
                      apart.gap,
                      0};
    return 1;
}

fp3_status fp3_bodies_overlap(fp3_bodies *bodies, const fp3_shape_def *def, const double *x,
                              const double *turn, uint32_t mask, size_t room, fp3_hit *hits,
                              size_t *count) {
    FP3_HOST;
    asker own;
    const fp3_status status = shape_at(bodies, def, x, turn, &own);
    *count = 0;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        answer found;
        if (!may_be(bodies, &own, i, mask, (fp3_point3){0, 0, 0}, 0) ||
            !look(bodies, &own, NULL, i, &found) || found.gap > 0)
            continue;
        if (*count < room)
            hits[*count] = hit_of(bodies, &own, i, &found, found.gap);
        ++*count;
    }
    fp3_form_give_back(own.form);
    return status;
}

fp3_status fp3_bodies_nearest(fp3_bodies *bodies, const double *points, size_t count, uint32_t mask,
                              fp3_hit *hits) {
    FP3_HOST;
    const size_t width = bodies->def.dimensions;
    const fp3_status status = check_rows(bodies, "points", points, count, width);
    const fp3_form3 point = {.shape = {.count = 1}};
    for (size_t k = 0; !status && k < count; k++) {
        const asker own = point_at(points + width * k, width);
        hits[k] = (fp3_hit){.distance = INFINITY, .fraction = INFINITY};
        for (uint32_t i = 0; i < bodies->shape_count; i++) {
            answer found;
            if (may_be(bodies, &own, i, mask, (fp3_point3){0, 0, 0},
                       fmaxf((float)hits[k].distance, 0)) &&
                look(bodies, &own, &point, i, &found) && found.gap < hits[k].distance)
                hits[k] = hit_of(bodies, &own, i, &found, found.gap);
        }
    }
    return status;
}
