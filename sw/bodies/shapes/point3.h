/* SPDX-License-Identifier: Apache-2.0 */
/* point3.h - points, turns and poses in space, in FP32 with a stated order of operations.
 *
 * Every sum of three terms is (x + y) + z. No function here calls another than sqrtf, so the bits
 * are the same wherever FP32 is IEEE 754's.
 */
#ifndef FP3_BODIES_POINT3_H
#define FP3_BODIES_POINT3_H

#include <math.h>
#include <stdint.h>

typedef struct {
    float x, y, z;
} fp3_point3;

/* In the world a local point p is at + R p. q is (w, x, y, z); its length does not matter, but has
 * to be from 1e-3 to 1e3. */
typedef struct {
    fp3_point3 at;
    float q[4];
} fp3_pose3;

/* R by its rows, and a shift. */
typedef struct {
    fp3_point3 row[3], at;
} fp3_turn3;

static inline fp3_point3 fp3_add3(fp3_point3 a, fp3_point3 b) {
    return (fp3_point3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline fp3_point3 fp3_subtract3(fp3_point3 a, fp3_point3 b) {
    return (fp3_point3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline fp3_point3 fp3_times3(float s, fp3_point3 a) {
    return (fp3_point3){s * a.x, s * a.y, s * a.z};
}

/* a + s d */
static inline fp3_point3 fp3_along3(fp3_point3 a, float s, fp3_point3 d) {
    return (fp3_point3){a.x + s * d.x, a.y + s * d.y, a.z + s * d.z};
}

static inline float fp3_dot3(fp3_point3 a, fp3_point3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline fp3_point3 fp3_cross3(fp3_point3 a, fp3_point3 b) {
    return (fp3_point3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float fp3_size3(fp3_point3 a) { return sqrtf(fp3_dot3(a, a)); }

/* Along axis 0, 1 or 2. */
static inline float fp3_part3(fp3_point3 a, uint32_t axis) {
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

/* False for a number that is not finite. */
static inline int fp3_is_finite3(fp3_point3 a) {
    return a.x - a.x == 0 && a.y - a.y == 0 && a.z - a.z == 0;
}

static inline float fp3_square_of_turn3(const float q[4]) {
    return (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
}

static inline int fp3_turn3_is_good(const float q[4]) {
    const float square = fp3_square_of_turn3(q);
    return square >= 1e-6f && square <= 1e6f;
}

/* Whether collisions and queries take the pose. */
static inline int fp3_pose3_is_good(const fp3_pose3 *pose) {
    return fp3_is_finite3(pose->at) && fp3_turn3_is_good(pose->q);
}

/* The turn of a quaternion, without a shift. */
static inline fp3_turn3 fp3_turn_of3(const float q[4]) {
    const float s = 2.0f / fp3_square_of_turn3(q);
    const float x = s * q[1], y = s * q[2], z = s * q[3];
    const float wx = q[0] * x, wy = q[0] * y, wz = q[0] * z;
    const float xx = q[1] * x, xy = q[1] * y, xz = q[1] * z;
    const float yy = q[2] * y, yz = q[2] * z, zz = q[3] * z;
    return (fp3_turn3){.row = {{1.0f - (yy + zz), xy - wz, xz + wy},
                               {xy + wz, 1.0f - (xx + zz), yz - wx},
                               {xz - wy, yz + wx, 1.0f - (xx + yy)}}};
}

static inline fp3_point3 fp3_turned3(const fp3_turn3 *t, fp3_point3 p) {
    return (fp3_point3){fp3_dot3(t->row[0], p), fp3_dot3(t->row[1], p), fp3_dot3(t->row[2], p)};
}

static inline fp3_point3 fp3_placed3(const fp3_turn3 *t, fp3_point3 p) {
    return fp3_add3(t->at, fp3_turned3(t, p));
}

/* By the inverse turn. */
static inline fp3_point3 fp3_unturned3(const fp3_turn3 *t, fp3_point3 p) {
    return fp3_along3(fp3_along3(fp3_times3(p.x, t->row[0]), p.y, t->row[1]), p.z, t->row[2]);
}

/* b's frame in a's: the inverse of a's turn (of_a) behind b's pose. */
static inline fp3_turn3 fp3_between3(const fp3_pose3 *a, const fp3_turn3 *of_a,
                                     const fp3_pose3 *b) {
    const float *p = a->q, *q = b->q;
    const float turn[4] = {(p[0] * q[0] + p[1] * q[1]) + (p[2] * q[2] + p[3] * q[3]),
                           (p[0] * q[1] - p[1] * q[0]) + (p[3] * q[2] - p[2] * q[3]),
                           (p[0] * q[2] - p[2] * q[0]) + (p[1] * q[3] - p[3] * q[1]),
                           (p[0] * q[3] - p[3] * q[0]) + (p[2] * q[1] - p[1] * q[2])};
    fp3_turn3 to = fp3_turn_of3(turn);
    to.at = fp3_unturned3(of_a, fp3_subtract3(b->at, a->at));
    return to;
}

#endif
