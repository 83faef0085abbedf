/* SPDX-License-Identifier: Apache-2.0 */
#include "bodies/shapes/shape3.h"

#include <string.h>

#define SMALLEST 1e-6f
#define NO_HALF 255

static int is_in_range(float x) { return x >= -FP3_LARGEST3 && x <= FP3_LARGEST3; }

int fp3_shape3_takes(uint32_t count, const fp3_point3 *point, float radius) {
    for (uint32_t i = 0; i < count; i++)
        if (!is_in_range(point[i].x) || !is_in_range(point[i].y) || !is_in_range(point[i].z))
            return 0;
    return radius >= 0 && radius <= FP3_LARGEST3;
}

static fp3_status refuse_numbers(fp3_error *error) {
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "a shape's numbers must be finite and at most 1e6, its radius not negative");
}

/* Centre and extent, once corners and faces are known. */
static void measure(fp3_shape3 *s) {
    fp3_point3 sum = {0, 0, 0};
    s->extent = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const float reach = fp3_size3(s->corner[i]);
        sum = fp3_add3(sum, s->corner[i]);
        s->extent = reach > s->extent ? reach : s->extent;
    }
    /* Upwards, for what sums of three squares lose. */
    s->extent = (s->extent + s->radius) * 1.000001f;
    s->middle = fp3_times3(1.0f / (float)s->count, sum);
    s->inner = s->faces ? FP3_LARGEST3 : 0;
    for (uint32_t f = 0; f < s->faces; f++) {
        const float deep = s->offset[f] - fp3_dot3(s->normal[f], s->middle);
        s->inner = deep < s->inner ? deep : s->inner;
    }
    s->inner = s->inner > 0 ? s->inner : 0;
}

fp3_status fp3_ball3(fp3_point3 centre, float radius, fp3_shape3 *shape, fp3_error *error) {
    if (!fp3_shape3_takes(1, &centre, radius))
        return refuse_numbers(error);
    memset(shape, 0, sizeof *shape);
    shape->count = 1;
    shape->radius = radius;
    shape->corner[0] = centre;
    measure(shape);
    return FP3_OK;
}

/* Whether two corners are so close that no direction can be told. */
static int are_one(fp3_point3 a, fp3_point3 b) {
    const float size = fp3_size3(a) + fp3_size3(b), apart = fp3_size3(fp3_subtract3(a, b));
    return apart < SMALLEST || apart < 1e-6f * size;
}

fp3_status fp3_capsule3(fp3_point3 a, fp3_point3 b, float radius, fp3_shape3 *shape,
                        fp3_error *error) {
    if (!fp3_shape3_takes(1, &a, radius) || !fp3_shape3_takes(1, &b, radius))
        return refuse_numbers(error);
    if (are_one(a, b))
        return fp3_ball3(a, radius, shape, error);
    memset(shape, 0, sizeof *shape);
    shape->count = shape->halves = 2;
    shape->radius = radius;
    shape->corner[0] = a;
    shape->corner[1] = b;
    shape->from[1] = shape->next[0] = 1;
    measure(shape);
    return FP3_OK;
}

/* Newell's normal, in double: it needs no three chosen corners. */
static int plane(fp3_shape3 *s, uint32_t f, const uint8_t *loop, uint32_t length) {
    double x = 0, y = 0, z = 0;
    const fp3_point3 o = s->corner[loop[0]];
    for (uint32_t i = 0; i < length; i++) {
        const fp3_point3 *p = &s->corner[loop[i]], *q = &s->corner[loop[(i + 1) % length]];
        const double ax = (double)p->x - o.x, ay = (double)p->y - o.y, az = (double)p->z - o.z;
        const double bx = (double)q->x - o.x, by = (double)q->y - o.y, bz = (double)q->z - o.z;
        x += ay * bz - az * by;
        y += az * bx - ax * bz;
        z += ax * by - ay * bx;
    }
    const double size = sqrt(x * x + y * y + z * z);
    if (!(size > 0))
        return 0;
    s->normal[f] = (fp3_point3){(float)(x / size), (float)(y / size), (float)(z / size)};
    s->offset[f] = fp3_dot3(s->normal[f], o);
    for (uint32_t i = 0; i < s->count; i++) { /* no corner is outside */
        const float h = fp3_dot3(s->normal[f], s->corner[i]);
        s->offset[f] = h > s->offset[f] ? h : s->offset[f];
    }
    return 1;
}

int fp3_shape3_close(fp3_shape3 *s, uint32_t faces, uint8_t (*loop)[FP3_CORNERS3],
                     const uint8_t *length) {
    uint8_t half[FP3_CORNERS3][FP3_CORNERS3], used[FP3_HALVES3] = {0};
    memset(half, NO_HALF, sizeof half);
    s->faces = faces;
    s->halves = 0;
    for (uint32_t f = 0; f < faces; f++) {
        uint8_t of[FP3_CORNERS3] = {0};
        for (uint32_t i = 0; i < length[f]; i++) {
            const uint8_t a = loop[f][i], b = loop[f][(i + 1) % length[f]];
            if (a != b && half[a][b] == NO_HALF && s->halves < FP3_HALVES3) {
                half[a][b] = (uint8_t)s->halves;
                half[b][a] = (uint8_t)(s->halves + 1);
                s->halves += 2;
            }
            if (a == b || half[a][b] == NO_HALF || used[half[a][b]])
                return 0;
            of[i] = half[a][b];
            used[of[i]] = 1;
            s->from[of[i]] = a;
            s->face[of[i]] = (uint8_t)f;
        }
        for (uint32_t i = 0; i < length[f]; i++)
            s->next[of[i]] = of[(i + 1) % length[f]];
        s->first[f] = of[0];
        if (!plane(s, f, loop[f], length[f]))
            return 0;
    }
    for (uint32_t h = 0; h < s->halves; h++)
        if (!used[h])
            return 0;
    if (faces > 2 && s->count + faces != s->halves / 2 + 2) /* Euler */
        return 0;
    measure(s);
    return 1;
}

fp3_status fp3_triangle3(const fp3_point3 corner[3], float radius, fp3_shape3 *shape,
                         fp3_error *error) {
    uint8_t loop[2][FP3_CORNERS3] = {{0, 1, 2}, {2, 1, 0}}, length[2] = {3, 3};
    if (!fp3_shape3_takes(3, corner, radius))
        return refuse_numbers(error);
    const fp3_point3 u = fp3_subtract3(corner[1], corner[0]),
                     v = fp3_subtract3(corner[2], corner[0]);
    const float area = fp3_size3(fp3_cross3(u, v)), longest = fp3_size3(u) + fp3_size3(v);
    fp3_shape3 made;
    memset(&made, 0, sizeof made);
    made.count = 3;
    made.radius = radius;
    memcpy(made.corner, corner, 3 * sizeof *corner);
    if (are_one(corner[0], corner[1]) || are_one(corner[1], corner[2]) ||
        are_one(corner[2], corner[0]) || !(area > 1e-6f * longest * longest) ||
        !fp3_shape3_close(&made, 2, loop, length))
        return fp3_fail(error, FP3_E_ARGUMENT, "the triangle's corners are on a line");
    *shape = made;
    return FP3_OK;
}

fp3_status fp3_box3(fp3_point3 half, const fp3_pose3 *pose, float radius, fp3_shape3 *shape,
                    fp3_error *error) {
    /* Corner i is at + along axis k where bit k is set; face 2 k is at +, face 2 k + 1 at -. */
    uint8_t loop[6][FP3_CORNERS3] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                     {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
    const uint8_t length[6] = {4, 4, 4, 4, 4, 4};
    fp3_turn3 turn = {.row = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (!fp3_shape3_takes(1, &half, radius) ||
        (pose && (!fp3_pose3_is_good(pose) || !fp3_shape3_takes(1, &pose->at, radius))))
        return refuse_numbers(error);
    if (!(half.x >= SMALLEST && half.y >= SMALLEST && half.z >= SMALLEST))
        return fp3_fail(error, FP3_E_ARGUMENT, "a box needs half sides of at least 1e-6");
    if (pose) {
        turn = fp3_turn_of3(pose->q);
        turn.at = pose->at;
    }
    fp3_shape3 made;
    memset(&made, 0, sizeof made);
    made.count = 8;
    made.radius = radius;
    for (uint32_t i = 0; i < 8; i++)
        made.corner[i] =
            fp3_placed3(&turn, (fp3_point3){i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                                            i & 4 ? half.z : -half.z});
    if (!fp3_shape3_takes(8, made.corner, radius))
        return refuse_numbers(error);
    if (!fp3_shape3_close(&made, 6, loop, length))
        return fp3_fail(error, FP3_E_ARGUMENT, "the box is too thin for where it is");
    const int is_turned = pose && (pose->q[1] != 0 || pose->q[2] != 0 || pose->q[3] != 0);
    made.box = is_turned ? FP3_BOX3 : FP3_STRAIGHT_BOX3;
    made.half = half;
    made.middle = turn.at;
    for (uint32_t k = 0; k < 3; k++) { /* exactly square, and opposite, as far as the turn is */
        const fp3_point3 axis = {k == 0, k == 1, k == 2};
        made.normal[2 * k] = fp3_turned3(&turn, axis);
        made.normal[2 * k + 1] = fp3_times3(-1.0f, made.normal[2 * k]);
        const float c = fp3_dot3(made.normal[2 * k], made.middle), h = fp3_part3(half, k);
        made.offset[2 * k] = c + h;
        made.offset[2 * k + 1] = h - c;
    }
    *shape = made;
    return FP3_OK;
}

fp3_bounds3 fp3_bound3(const fp3_shape3 *s, const fp3_pose3 *pose, float margin) {
    const fp3_turn3 turn = fp3_turn_of3(pose->q);
    fp3_point3 low = fp3_turned3(&turn, s->corner[0]), high = low;
    for (uint32_t i = 1; i < s->count; i++) {
        const fp3_point3 p = fp3_turned3(&turn, s->corner[i]);
        low.x = p.x < low.x ? p.x : low.x;
        low.y = p.y < low.y ? p.y : low.y;
        low.z = p.z < low.z ? p.z : low.z;
        high.x = p.x > high.x ? p.x : high.x;
        high.y = p.y > high.y ? p.y : high.y;
        high.z = p.z > high.z ? p.z : high.z;
    }
    /* Two units in the last place of what is added. */
    const float wide = (s->radius + margin) + 1e-6f * s->extent;
    const fp3_point3 e = {wide + 2.5e-7f * fabsf(pose->at.x), wide + 2.5e-7f * fabsf(pose->at.y),
                          wide + 2.5e-7f * fabsf(pose->at.z)};
    return (fp3_bounds3){fp3_subtract3(fp3_add3(pose->at, low), e),
                         fp3_add3(fp3_add3(pose->at, high), e)};
}
