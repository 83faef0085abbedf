/* SPDX-License-Identifier: Apache-2.0 */
/* joints.c - joints come and go; their values. */
#include "own3.h"

#include "base/host.h"
#include "base/nearest.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fp3_joint_set_default(fp3_joint_def *def, size_t size) {
    memset(def, 0, size);
    if (size != sizeof *def)
        return;
    def->axis[0] = def->axle[2] = 1;
    def->ratio = 1;
    def->damping = 0.7;
    def->rest = NAN;
}

/* ---- who does not collide ---- */

static uint64_t key_of(uint32_t a, uint32_t b) {
    return (uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a);
}

static int ascending(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

int fp3_joints_part(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    const uint64_t key = key_of(a, b);
    const uint32_t lower = (uint32_t)(key >> 32);
    int is_there = 0;
    if (lower >= bodies->apart_bodies)
        return 0;
    for (uint32_t k = bodies->apart_first[lower]; k < bodies->apart_first[lower + 1]; k++)
        is_there |= bodies->apart[k] == key;
    return is_there;
}

fp3_status fp3_joints_find_apart(fp3_bodies *bodies) {
    if (!bodies->is_apart_stale)
        return FP3_OK;
    fp3_status status =
        fp3_bodies_room((void **)&bodies->apart_first, &bodies->apart_first_room,
                        sizeof *bodies->apart_first, bodies->body_count + 1u, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->apart, &bodies->apart_room,
                                 sizeof *bodies->apart, bodies->joint_count + 1u, bodies->error);
    if (status)
        return status;
    uint32_t count = 0;
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (j->generation & 1 && !j->def.may_collide)
            bodies->apart[count++] = key_of(j->a, j->b);
    }
    if (count)
        qsort(bodies->apart, count, sizeof *bodies->apart, ascending);
    for (uint32_t body = 0, k = 0; body <= bodies->body_count; body++) {
        while (k < count && bodies->apart[k] >> 32 < body)
            k++;
        bodies->apart_first[body] = k;
    }
    bodies->apart_count = count;
    bodies->apart_bodies = bodies->body_count;
    bodies->is_apart_stale = 0;
    return FP3_OK;
}

/* ---- they come ---- */

/* Both bodies. What sleeps, sleeps with all that it touches. */
static void wake(fp3_bodies *bodies, const fp3_joint *j) {
    fp3_bodies_wake(bodies, j->a);
    fp3_bodies_wake(bodies, j->b);
}

static int laws_of(const fp3_joint_def *def) {
    const int twist = 1, slide = 2, rod = 4, point = 8;
    switch (def->type) {
    case FP3_ROD:
        return rod;
    case FP3_HINGE:
        return point | (def->has_limits || def->most > 0 || def->hertz > 0 ? twist : 0);
    case FP3_SLIDER:
        return slide | twist;
    case FP3_WHEEL:
        return slide | twist;
    case FP3_WELD:
        return point | twist;
    default:
        return twist;
    }
}

static double length_of(const double v[3]) {
    return sqrt((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
}

#define PI 3.14159265358979323846

/* What a type has besides a place: whoever says more would think that it counts. */
static fp3_status check_words(const fp3_bodies *bodies, const fp3_joint_def *def, const char *of) {
    static const struct {
        const char *name;
        uint8_t has_limits, has_motor, has_spring;
    } types[] = {[FP3_ROD] = {"rod", 1, 1, 1},       [FP3_HINGE] = {"hinge", 1, 1, 1},
                 [FP3_SLIDER] = {"slider", 1, 1, 1}, [FP3_WHEEL] = {"wheel", 1, 1, 1},
                 [FP3_WELD] = {"weld", 0, 0, 1},     [FP3_GEAR] = {"gear", 0, 0, 0},
                 [FP3_BALL] = {"ball", 1, 0, 1}};
    const char *extra = def->has_limits && !types[def->type].has_limits  ? "limits"
                        : def->most > 0 && !types[def->type].has_motor   ? "motor: most must be 0"
                        : def->hertz > 0 && !types[def->type].has_spring ? "spring: hertz must be 0"
                        : def->ratio != 1 && def->type != FP3_GEAR       ? "ratio: it must be 1"
                                                                         : NULL;
    return extra ? fp3_fail(bodies->error, FP3_E_ARGUMENT, "%sa %s has no %s", of,
                            types[def->type].name, extra)
                 : FP3_OK;
}

/* In space what springs back in all directions rests as it was made. */
static int has_rest(const fp3_bodies *bodies, fp3_joint_type type) {
    return !bodies->space || (type != FP3_WELD && type != FP3_BALL);
}

/* Angles in space are from -pi to pi. */
static fp3_status check_space(const fp3_bodies *bodies, const fp3_joint_def *def, size_t which) {
    const int is_angle = def->type == FP3_HINGE || def->type == FP3_BALL;
    const double *a = def->axis, *b = def->axle,
                 along =
                     ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) / (length_of(a) * length_of(b));
    if (is_angle && def->has_limits && !(def->low >= -PI && def->high <= PI))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: its limits are %g and %g, expected angles from -pi to pi",
                        which, def->low, def->high);
    if (def->type == FP3_BALL && def->has_limits && def->low != 0)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: limits of a ball are %g and %g, expected 0 and an angle from 0 "
                        "to pi",
                        which, def->low, def->high);
    if (def->type == FP3_WHEEL && !(fabs(along) < 0.9))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: the axle of a wheel is along its axis, expected across it",
                        which);
    if (!isnan(def->rest) && !has_rest(bodies, def->type))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: rest is %g, and a %s in space has none, expected NaN", which,
                        def->rest, def->type == FP3_BALL ? "ball" : "weld");
    if (!isnan(def->rest) && !(fabs(def->rest) <= 1e9))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: rest is %g, expected -1e9 to 1e9, or NaN", which, def->rest);
    return FP3_OK;
}

static fp3_status check(const fp3_bodies *bodies, const fp3_joint_def *def, size_t which) {
    const double deep = bodies->space ? 1e6 : 0; /* the third number */
    const fp3_bodies_range ranges[] = {{"type", def->type, FP3_ROD, FP3_BALL},
                                       {"anchor_a[0]", def->anchor_a[0], -1e6, 1e6},
                                       {"anchor_a[1]", def->anchor_a[1], -1e6, 1e6},
                                       {"anchor_a[2]", def->anchor_a[2], 0 - deep, deep},
                                       {"anchor_b[0]", def->anchor_b[0], -1e6, 1e6},
                                       {"anchor_b[1]", def->anchor_b[1], -1e6, 1e6},
                                       {"anchor_b[2]", def->anchor_b[2], 0 - deep, deep},
                                       {"axis[0]", def->axis[0], -1e6, 1e6},
                                       {"axis[1]", def->axis[1], -1e6, 1e6},
                                       {"axis[2]", def->axis[2], 0 - deep, deep},
                                       {"axle[0]", def->axle[0], -1e6, 1e6},
                                       {"axle[1]", def->axle[1], -1e6, 1e6},
                                       {"axle[2]", def->axle[2], -1e6, 1e6},
                                       {"ratio", def->ratio, -1e6, 1e6},
                                       {"low", def->low, -1e9, 1e9},
                                       {"high", def->high, -1e9, 1e9},
                                       {"speed", def->speed, -1e9, 1e9},
                                       {"most", def->most, 0, 1e12},
                                       {"hertz", def->hertz, 0, 1e6},
                                       {"damping", def->damping, 0, 1e6},
                                       {"force", def->force, 0, 1e12},
                                       {"torque", def->torque, 0, 1e12}};
    uint32_t a, b;
    char of[32];
    fp3_status status = FP3_OK;
    if (def->type == (bodies->space ? FP3_GEAR : FP3_BALL))
        status =
            fp3_fail(bodies->error, FP3_E_ARGUMENT, "joint %zu: %s", which,
                     bodies->space ? "a gear is in a plane alone" : "a ball is in space alone");
    snprintf(of, sizeof of, "joint %zu: ", which);
    if (!status)
        status = fp3_ranges_check(ranges, sizeof ranges / sizeof *ranges, of, bodies->space != NULL,
                                  bodies->error);
    if (!status)
        status = check_words(bodies, def, of);
    if (!status && (fp3_bodies_numbered(bodies, &def->a, 0, &a) ||
                    fp3_bodies_numbered(bodies, &def->b, 0, &b)))
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "joint %zu: a, %" PRIx64 ", or b, %" PRIx64 ", is no body", which, def->a,
                          def->b);
    if (status)
        return status;
    if (a == b)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "joint %zu joins a body with itself", which);
    if (bodies->body[a].type != FP3_DYNAMIC && bodies->body[b].type != FP3_DYNAMIC)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: neither of its bodies is dynamic", which);
    if (!(length_of(def->axis) > 1e-6) || !(length_of(def->axle) > 1e-6))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "joint %zu: its ax%s has no direction",
                        which, length_of(def->axis) > 1e-6 ? "le" : "is");
    if (def->has_limits && def->low > def->high)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "joint %zu: low, %g, is above high, %g",
                        which, def->low, def->high);
    if (bodies->space)
        return check_space(bodies, def, which);
    if (!isnan(def->rest) && !(fabs(def->rest) <= 1e9))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "joint %zu: rest is %g, expected -1e9 to 1e9, or NaN", which, def->rest);
    return FP3_OK;
}

/* Where two bodies do not turn against each other, any point that both have may be held. At this
 * one between their centres what holds the point does not turn one against the other, and what
 * holds the angle does not move the point: so neither has to make good what the other does. */
static void anchor_between(const fp3_bodies *bodies, fp3_joint *j) {
    const fp3_body *a = &bodies->body[j->a], *b = &bodies->body[j->b];
    const fp3_stance s = fp3_joint_stance(bodies, j);
    const double ia = fp3_inverse_mass(a->inertia), ib = fp3_inverse_mass(b->inertia);
    const double share = ia + ib > 0 ? ib / (ia + ib) : 0.5;
    /* From the joint to that point, in the world. */
    const double x = -share * s.arm_b[0] - (1 - share) * (s.arm_a[0] + s.gap[0]);
    const double y = -share * s.arm_b[1] - (1 - share) * (s.arm_a[1] + s.gap[1]);
    j->anchor_a[0] += (float)(a->turn[0] * x + a->turn[1] * y);
    j->anchor_a[1] += (float)(a->turn[0] * y - a->turn[1] * x);
    j->anchor_b[0] += (float)(b->turn[0] * x + b->turn[1] * y);
    j->anchor_b[1] += (float)(b->turn[0] * y - b->turn[1] * x);
}

static void place(fp3_bodies *bodies, fp3_joint *j, const fp3_joint_def *def) {
    const uint32_t generation = j->generation + 1;
    const double length = length_of(def->axis);
    *j = (fp3_joint){.def = *def,
                     .a = (uint32_t)def->a,
                     .b = (uint32_t)def->b,
                     .generation = generation,
                     .laws = (uint8_t)(bodies->space ? fp3_space_laws_of(def) : laws_of(def))};
    if (bodies->space) {
        fp3_space_joint_place(bodies, (uint32_t)(j - bodies->joint));
        return;
    }
    for (int i = 0; i < 2; i++) {
        j->anchor_a[i] = (float)def->anchor_a[i];
        j->anchor_b[i] = (float)def->anchor_b[i];
        j->axis[i] = (float)(def->axis[i] / length);
    }
    if ((def->type == FP3_WELD && !(def->hertz > 0)) || def->type == FP3_SLIDER)
        anchor_between(bodies, j);
    j->from = bodies->body[j->b].angle +
              (def->type == FP3_GEAR ? def->ratio : -1) * bodies->body[j->a].angle;
    if (isnan(def->rest))
        j->def.rest = fp3_joint_at(bodies, j);
}

fp3_status fp3_bodies_join(fp3_bodies *bodies, const fp3_joint_def *defs, size_t count,
                           uint64_t *joints) {
    FP3_HOST;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        status = check(bodies, &defs[i], i);
    const size_t wanted = bodies->joint_count + count + 1;
    if (!status)
        status = fp3_bodies_room((void **)&bodies->joint, &bodies->joint_room,
                                 sizeof *bodies->joint, wanted, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&bodies->apart, &bodies->apart_room,
                                 sizeof *bodies->apart, wanted, bodies->error);
    if (!status && bodies->space)
        status = fp3_bodies_room((void **)&bodies->space->joint, &bodies->space->joint_room,
                                 sizeof *bodies->space->joint, wanted, bodies->error);
    if (status)
        return status;
    uint32_t number = bodies->free_joint;
    for (size_t i = 0; i < count; i++) {
        while (number < bodies->joint_count && bodies->joint[number].generation & 1)
            number++;
        if (number == bodies->joint_count)
            bodies->joint_count++;
        place(bodies, &bodies->joint[number], &defs[i]);
        bodies->joints++;
        joints[i] = (uint64_t)bodies->joint[number].generation << 32 | number;
        wake(bodies, &bodies->joint[number]);
    }
    bodies->free_joint = number;
    bodies->is_apart_stale = bodies->is_changed = 1;
    return FP3_OK;
}

/* ---- and go ---- */

void fp3_joint_drop(fp3_bodies *bodies, uint32_t number) {
    fp3_joint *j = &bodies->joint[number];
    wake(bodies, j);
    j->generation++;
    bodies->joints--;
    bodies->is_apart_stale = bodies->is_changed = 1;
    if (number < bodies->free_joint)
        bodies->free_joint = number;
}

void fp3_joints_drop(fp3_bodies *bodies) {
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (j->generation & 1 && (bodies->body[j->a].is_marked | bodies->body[j->b].is_marked))
            fp3_joint_drop(bodies, i);
    }
}

int fp3_bodies_is_joined(const fp3_bodies *bodies, uint64_t joint) {
    const uint32_t number = (uint32_t)joint;
    return number < bodies->joint_count && bodies->joint[number].generation & 1 &&
           bodies->joint[number].generation == joint >> 32;
}

static fp3_status check_all(const fp3_bodies *bodies, const uint64_t *joints, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!fp3_bodies_is_joined(bodies, joints[i]))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                            "handle %zu, %" PRIx64 ": there is no such joint", i, joints[i]);
    return FP3_OK;
}

fp3_status fp3_bodies_unjoin(fp3_bodies *bodies, const uint64_t *joints, size_t count) {
    const fp3_status status = check_all(bodies, joints, count);
    for (size_t i = 0; !status && i < count; i++)
        if (fp3_bodies_is_joined(bodies, joints[i])) /* a handle may occur twice */
            fp3_joint_drop(bodies, (uint32_t)joints[i]);
    return status;
}

size_t fp3_bodies_joints(const fp3_bodies *bodies) { return bodies->joints; }

/* ---- values ---- */

typedef enum {
    SPEED,
    MOST,
    LOW,
    HIGH,
    REST,
    AT,
    FORCE_X,
    FORCE_Y,
    TORQUE,  /* in a plane */
    FORCE_Z, /* these are in space */
    TORQUE_X,
    TORQUE_Y,
    TORQUE_Z,
    VALUES
} value;
static const char *const names[VALUES] = {"speed",    "most",     "low",     "high",   "rest",
                                          "at",       "force_x",  "force_y", "torque", "force_z",
                                          "torque_x", "torque_y", "torque_z"};

static fp3_status find(const fp3_bodies *bodies, const char *name, value *found) {
    const char *best = NULL;
    const fp3_token wanted = {.text = name, .length = strlen(name)};
    for (int i = 0; i < VALUES; i++) {
        if (bodies->space ? i == TORQUE : i > TORQUE)
            continue;
        *found = (value)i;
        if (strcmp(name, names[i]) == 0)
            return FP3_OK;
        fp3_nearest(wanted, names[i], &best);
    }
    return fp3_fail(bodies->error, FP3_E_ARGUMENT, "joints have no value '%s' (did you mean '%s'?)",
                    name, best ? best : "at");
}

static double *setting(fp3_joint *j, value which) {
    double *const settings[] = {&j->def.speed, &j->def.most, &j->def.low, &j->def.high,
                                &j->def.rest};
    return settings[which];
}

static double get(const fp3_bodies *bodies, uint32_t number, value which) {
    fp3_joint *j = &bodies->joint[number];
    const fp3_joint3 *space = bodies->space ? &bodies->space->joint[number] : NULL;
    const float *force = space ? space->force : j->force;
    switch (which) {
    case AT:
        return space ? fp3_space_joint_at(bodies, number) : fp3_joint_at(bodies, j);
    case FORCE_X:
    case FORCE_Y:
        return force[which - FORCE_X];
    case FORCE_Z:
        return force[2];
    case TORQUE:
        return j->torque;
    case TORQUE_X:
    case TORQUE_Y:
    case TORQUE_Z:
        return space->torque[which - TORQUE_X];
    default:
        return *setting(j, which);
    }
}

fp3_status fp3_bodies_joint_read(fp3_bodies *bodies, const char *name, const uint64_t *joints,
                                 size_t count, double *values) {
    FP3_HOST;
    value which = AT;
    fp3_status status = find(bodies, name, &which);
    if (!status)
        status = check_all(bodies, joints, count);
    for (size_t i = 0; !status && i < count; i++)
        values[i] = get(bodies, (uint32_t)joints[i], which);
    return status;
}

fp3_status fp3_bodies_joint_write(fp3_bodies *bodies, const char *name, const uint64_t *joints,
                                  size_t count, const double *values) {
    FP3_HOST;
    value which = AT;
    fp3_status status = find(bodies, name, &which);
    if (!status)
        status = check_all(bodies, joints, count);
    if (!status && which > REST)
        status = fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s of a joint is computed", name);
    for (size_t i = 0; !status && i < count; i++) {
        const fp3_joint_def *def = &bodies->joint[(uint32_t)joints[i]].def;
        const double x = values[i];
        fp3_joint_def next = *def;
        char of[32];
        snprintf(of, sizeof of, "most[%zu]: ", i);
        next.most = which == MOST ? x : next.most;
        if (!(fabs(x) <= (which == MOST ? 1e12 : 1e9)) ||
            ((which == LOW || which == HIGH) && !def->has_limits) || (which == MOST && x < 0) ||
            (which == REST && !has_rest(bodies, def->type)) ||
            (which == LOW && def->type == FP3_BALL && x != 0) || (which == LOW && x > def->high) ||
            (which == HIGH && x < def->low))
            status = fp3_fail(bodies->error, FP3_E_ARGUMENT,
                              "%s[%zu] is %g, which this joint cannot have (limits: only if it "
                              "was made with them; low of a ball: 0; rest: no weld or ball in "
                              "space)",
                              name, i, x);
        else
            status = check_words(bodies, &next, of);
    }
    for (size_t i = 0; !status && i < count; i++) {
        fp3_joint *j = &bodies->joint[(uint32_t)joints[i]];
        *setting(j, which) = values[i];
        j->laws =
            (uint8_t)(j->laws | (bodies->space ? fp3_space_laws_of(&j->def) : laws_of(&j->def)));
        wake(bodies, j);
    }
    return status;
}
