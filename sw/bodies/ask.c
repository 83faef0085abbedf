/* SPDX-License-Identifier: Apache-2.0 */
/* ask.c - what a ray or a shape meets.
 *
 * Each shape is looked at; those that are too far, by their extents, cost a few operations. All is
 * computed from where the question is asked, so it is as exact far from the origin.
 */
#include "own.h"
#include "query2.h"
#include "turn.h"

#include "base/host.h"

#include <math.h>

#define FARTHEST 1e9

/* A shape of those that are asked about, as seen from a place; 0: it is not one of them. */
static int shape_at(const fp3_bodies *bodies, uint32_t number, uint32_t mask, const double from[2],
                    fp3_pose2 *pose) {
    const fp3_attached *shape = &bodies->shape[number];
    if (!(shape->generation & 1) || !(shape->category & mask))
        return 0;
    const fp3_body *body = &bodies->body[shape->body];
    *pose = (fp3_pose2){{(float)(body->at[0] - from[0]), (float)(body->at[1] - from[1])},
                        body->turn[0],
                        body->turn[1]};
    return 1;
}

/* Whether a way from the origin comes as near as that to a place, or a little farther. */
static int comes_near(fp3_point2 way, fp3_point2 place, float reach) {
    const float square = fp3_dot2(way, way);
    float t = square > 0 ? fp3_dot2(way, place) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const fp3_point2 left = fp3_along2(place, -t, way);
    const float wide = reach * 1.001f + 1e-5f * (fabsf(place.x) + fabsf(place.y));
    return fp3_dot2(left, left) <= wide * wide;
}

static fp3_hit hit_of(const fp3_bodies *bodies, uint32_t shape, const double at[2],
                      fp3_point2 normal, double distance, double fraction) {
    const fp3_attached *s = &bodies->shape[shape];
    return (fp3_hit){.body = fp3_bodies_handle(bodies, s->body),
                     .shape = (uint64_t)s->generation << 32 | shape,
                     .point = {at[0], at[1]},
                     .normal = {normal.x, normal.y},
                     .distance = distance,
                     .fraction = fraction};
}

static fp3_status check(const fp3_bodies *bodies, const char *name, const double *values,
                        size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs(values[i]) <= FARTHEST))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s %zu is %g, expected -1e9 to 1e9",
                            name, i / 2, values[i]);
    return FP3_OK;
}

/* The first that a shape meets on its way, or a ray if it is NULL. */
static fp3_hit first_hit(const fp3_bodies *bodies, const fp3_shape2 *moving, fp3_pose2 turn,
                         const double from[2], const double way[2], uint32_t mask) {
    const fp3_point2 along = {(float)way[0], (float)way[1]};
    const double length = sqrt(way[0] * way[0] + way[1] * way[1]);
    const float slop = (float)(1e-3 * bodies->def.size);
    fp3_hit best = {.fraction = INFINITY, .distance = INFINITY};
    for (uint32_t i = 0; i < bodies->shape_count; i++) {
        fp3_pose2 pose;
        fp3_hit2 hit;
        const fp3_shape2 *shape = &bodies->shape[i].shape;
        if (!shape_at(bodies, i, mask, from, &pose) ||
            !comes_near(along, pose.at, shape->extent + (moving ? moving->extent + slop : 0)))
            continue;
        if (!(moving ? fp3_cast2(shape, &pose, moving, &turn, along, slop, &hit)
                     : fp3_ray2(shape, &pose, (fp3_point2){0, 0}, along, &hit)))
            continue;
        if (!(hit.fraction < best.fraction))
            continue;
        const double at[2] = {from[0] + pose.at.x + hit.arm.x, from[1] + pose.at.y + hit.arm.y};
        best = hit_of(bodies, i, at, hit.normal, hit.fraction * length, hit.fraction);
    }
    return best;
}

fp3_status fp3_bodies_ray(fp3_bodies *bodies, const double *from, const double *way, size_t count,
                          uint32_t mask, fp3_hit *hits) {
    FP3_HOST;
    fp3_status status = check(bodies, "from", from, 2 * count);
    if (!status)
        status = check(bodies, "way", way, 2 * count);
    for (size_t i = 0; !status && i < count; i++)
        hits[i] = first_hit(bodies, NULL, (fp3_pose2){.c = 1}, from + 2 * i, way + 2 * i, mask);
    return status;
}

static fp3_status pose_of(fp3_bodies *bodies, const fp3_shape_def *def, const double x[2],
                          double angle, fp3_shape2 *shape, fp3_pose2 *pose) {
    double turn[2];
    fp3_status status = check(bodies, "x", x, 2);
    if (!status)
        status = check(bodies, "angle", &angle, 1);
    if (!status)
        status = fp3_shape_make(def, shape, bodies->error);
    fp3_turn2_of(angle, turn);
    *pose = (fp3_pose2){{0, 0}, (float)turn[0], (float)turn[1]};
    return status;
}

fp3_status fp3_bodies_cast(fp3_bodies *bodies, const fp3_shape_def *def, const double x[2],
                           double angle, const double way[2], uint32_t mask, fp3_hit *hit) {
    FP3_HOST;
    fp3_shape2 shape;
    fp3_pose2 pose;
    fp3_status status = pose_of(bodies, def, x, angle, &shape, &pose);
    if (!status)
        status = check(bodies, "way", way, 2);
    if (!status)
        *hit = first_hit(bodies, &shape, pose, x, way, mask);
    return status;
}

fp3_status fp3_bodies_overlap(fp3_bodies *bodies, const fp3_shape_def *def, const double x[2],
                              double angle, uint32_t mask, size_t room, fp3_hit *hits,
                              size_t *count) {
    FP3_HOST;
    fp3_shape2 own;
    fp3_pose2 turn;
    const fp3_status status = pose_of(bodies, def, x, angle, &own, &turn);
    *count = 0;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        fp3_pose2 pose;
        fp3_apart2 apart;
        const fp3_shape2 *shape = &bodies->shape[i].shape;
        if (!shape_at(bodies, i, mask, x, &pose) ||
            !comes_near((fp3_point2){0, 0}, pose.at, shape->extent + own.extent) ||
            !fp3_separation2(shape, &pose, &own, &turn, &apart) || apart.gap > 0)
            continue;
        const double at[2] = {x[0] + pose.at.x + apart.arm_a.x, x[1] + pose.at.y + apart.arm_a.y};
        if (*count < room)
            hits[*count] = hit_of(bodies, i, at, apart.normal, apart.gap, 0);
        ++*count;
    }
    return status;
}

fp3_status fp3_bodies_nearest(fp3_bodies *bodies, const double *points, size_t count, uint32_t mask,
                              fp3_hit *hits) {
    FP3_HOST;
    const fp3_status status = check(bodies, "point", points, 2 * count);
    const fp3_shape2 point = {.core.count = 1};
    const fp3_pose2 here = {.c = 1};
    for (size_t k = 0; !status && k < count; k++) {
        const double *from = points + 2 * k;
        hits[k] = (fp3_hit){.distance = INFINITY, .fraction = INFINITY};
        for (uint32_t i = 0; i < bodies->shape_count; i++) {
            fp3_pose2 pose;
            fp3_apart2 apart;
            const fp3_shape2 *shape = &bodies->shape[i].shape;
            if (!shape_at(bodies, i, mask, from, &pose) ||
                (isfinite(hits[k].distance) &&
                 !comes_near((fp3_point2){0, 0}, pose.at,
                             shape->extent + fmaxf((float)hits[k].distance, 0))) ||
                !fp3_separation2(shape, &pose, &point, &here, &apart) ||
                !(apart.gap < hits[k].distance))
                continue;
            const double at[2] = {from[0] + pose.at.x + apart.arm_a.x,
                                  from[1] + pose.at.y + apart.arm_a.y};
            hits[k] = hit_of(bodies, i, at, apart.normal, apart.gap, 0);
        }
    }
    return status;
}
