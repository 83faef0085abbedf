/* SPDX-License-Identifier: Apache-2.0 */
/* outline.c - see outline.h. */
#include "outline.h"

#include "turned.h"

#include <math.h>
#include <string.h>

unsigned fp3_view_outline(const fp3_view_recording *r, const fp3_view_shape *shape, double least,
                          double points[FP3_VIEW_WAYS][3]) {
    const double radius = shape->corners > 2 || shape->radius > least ? shape->radius : least;
    const double(*corner)[3] = (const double(*)[3])r->corners + shape->first;
    unsigned count = 0;
    for (unsigned i = 0; i < FP3_VIEW_WAYS; i++) {
        double way[2], farthest = -INFINITY;
        uint32_t best = 0;
        fp3_view_turned(360.0 * i / FP3_VIEW_WAYS, way);
        for (uint32_t k = 0; k < shape->corners; k++) {
            const double far = corner[k][0] * way[0] + corner[k][1] * way[1];
            best = far > farthest ? k : best;
            farthest = far > farthest ? far : farthest;
        }
        double *to = points[count];
        for (unsigned k = 0; k < 2; k++)
            to[k] = corner[best][k] + radius * way[k];
        to[2] = 0;
        count += !count || memcmp(to, points[count - 1], sizeof points[0]) != 0;
    }
    return count > 1 && !memcmp(points[0], points[count - 1], sizeof points[0]) ? count - 1 : count;
}

static int turn_by_angle(double angle, double turn[3][3]) {
    double c[2];
    fp3_view_turned(angle * 57.295779513082321, c);
    turn[0][0] = turn[1][1] = c[0];
    turn[1][0] = c[1];
    turn[0][1] = -c[1];
    return isfinite(angle);
}

/* A quaternion of any length. */
static int turn_by_four(const double q[4], double turn[3][3]) {
    const double size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double *v = q + 1, share = 2 / size;
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        turn[k][k] = 1 - share * (v[a] * v[a] + v[b] * v[b]);
        turn[a][k] = share * (v[k] * v[a] + q[0] * v[b]);
        turn[b][k] = share * (v[k] * v[b] - q[0] * v[a]);
    }
    return size > 0 && isfinite(size);
}

int fp3_view_pose_of(const fp3_view_recording *r, const fp3_view_axes *axes, size_t at,
                     fp3_view_pose *pose) {
    double turn[4] = {0};
    *pose = (fp3_view_pose){.turn = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}};
    for (unsigned k = 0; k < axes->count; k++)
        pose->x[k] = (double)r->columns[axes->columns[k]].values[at];
    for (unsigned k = 0; k < axes->turns; k++)
        turn[k] = (double)r->columns[axes->turn[k]].values[at];
    if (!isfinite(pose->x[0] + pose->x[1] + pose->x[2]))
        return 0;
    return axes->turns > 1 ? turn_by_four(turn, pose->turn) : turn_by_angle(turn[0], pose->turn);
}

/* How far the shape is from the origin of its body at most. */
static double reach_of(const fp3_view_recording *r, const fp3_view_shape *shape) {
    double most = 0;
    for (uint32_t k = 0; k < shape->corners; k++) {
        const double *c = r->corners[shape->first + k];
        most = fmax(most, c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    }
    return sqrt(most) + shape->radius;
}

static int widen(const fp3_view_recording *r, const fp3_view_axes *axes, unsigned axis,
                 const fp3_view_shape *shape, double ends[2]) {
    const float *values = r->columns[axes->columns[axis]].values;
    const double reach = reach_of(r, shape);
    int is_any = 0;
    for (size_t n = 0; n < r->snapshots; n++) {
        const double x = (double)values[n * r->objects + shape->object];
        if (!isfinite(x))
            continue;
        ends[0] = fmin(ends[0], x - reach);
        ends[1] = fmax(ends[1], x + reach);
        is_any = 1;
    }
    return is_any;
}

void fp3_view_outline_ends(const fp3_view_recording *r, const fp3_view_axes *axes, unsigned axis,
                           double ends[2]) {
    int is_any = 0;
    ends[0] = INFINITY;
    ends[1] = -INFINITY;
    for (int all = 0; !is_any && all < 2; all++)
        for (size_t i = 0; i < r->shape_count; i++)
            if (isfinite(r->shapes[i].radius) && (all || r->shapes[i].type != 2))
                is_any |= widen(r, axes, axis, &r->shapes[i], ends);
    if (!is_any)
        ends[0] = ends[1] = 0;
}
