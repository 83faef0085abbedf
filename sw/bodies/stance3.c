/* SPDX-License-Identifier: Apache-2.0 */
/* stance3.c - where a joint is in space. In double: angles of a chain are differences of large
 * ones.
 */
#include "own3.h"
#include "turn.h"

#include <math.h>
#include <string.h>

/* A body's turn and its centre of mass, after its way. */
typedef struct {
    double q[4], at[3];
} pose;

static pose pose_of(const fp3_bodies *bodies, uint32_t number, int has_way) {
    const fp3_body *body = &bodies->body[number];
    pose p;
    memcpy(p.q, bodies->space->body[number].q, sizeof p.q);
    memcpy(p.at, body->at, sizeof p.at);
    if (!has_way || body->slot == FP3_NOBODY)
        return p;
    const fp3_four d = bodies->way[2 * body->slot], q = bodies->way[2 * body->slot + 1];
    const double by[4] = {d[3], q[0], q[1], q[2]};
    fp3_multiply3(by, bodies->space->body[number].q, p.q);
    const double size =
        sqrt((p.q[0] * p.q[0] + p.q[1] * p.q[1]) + (p.q[2] * p.q[2] + p.q[3] * p.q[3]));
    for (int i = 0; i < 4; i++)
        p.q[i] /= size;
    for (int i = 0; i < 3; i++)
        p.at[i] += d[i];
    return p;
}

static fp3_point3 point_of(const double x[3]) {
    return (fp3_point3){(float)x[0], (float)x[1], (float)x[2]};
}

static void arm_of(const fp3_bodies *bodies, uint32_t body, const pose *p, const double anchor[3],
                   double arm[3]) {
    const float *c = bodies->body[body].centre;
    const double from[3] = {anchor[0] - c[0], anchor[1] - c[1], anchor[2] - c[2]};
    fp3_turned3_by(p->q, from, arm);
}

static double dot(const double a[3], const double b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* From one direction to another, about what and how far. */
static fp3_point3 lean(const double a[3], const double b[3], double *angle) {
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]};
    const double sine = sqrt(dot(c, c));
    *angle = fp3_angle_of(sine, dot(a, b));
    const double share = sine > 1e-12 ? *angle / sine : 1;
    return (fp3_point3){(float)(share * c[0]), (float)(share * c[1]), (float)(share * c[2])};
}

/* How b has turned since the joint was made, as a has it. */
static void turned_since(const fp3_joint3 *j, const pose *a, const pose *b, double r[4]) {
    const double back_a[4] = {a->q[0], -a->q[1], -a->q[2], -a->q[3]},
                 from[4] = {j->q[0], -j->q[1], -j->q[2], -j->q[3]};
    double now[4];
    fp3_multiply3(back_a, b->q, now);
    fp3_multiply3(now, from, r);
    const double sign = r[0] < 0 ? -1 : 1; /* the shorter way round */
    for (int i = 0; i < 4; i++)
        r[i] *= sign;
}

static void direction(const double v[3], double to[3]) {
    const double size = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        to[i] = v[i] / size;
}

/* The inverse inertia of a step's beginning, turned with the body. */
void fp3_space_back(const fp3_bodies *bodies, uint32_t number, int has_way, float back[6]) {
    const fp3_body *body = &bodies->body[number];
    const float *from = bodies->space->body[number].back;
    if (!(bodies->space->body[number].moment[0] > 0)) {
        memset(back, 0, 6 * sizeof *back);
        return;
    }
    if (!has_way || body->slot == FP3_NOBODY) {
        memcpy(back, from, 6 * sizeof *back);
        return;
    }
    const fp3_four d = bodies->way[2 * body->slot], q = bodies->way[2 * body->slot + 1];
    const float by[4] = {d[3], q[0], q[1], q[2]};
    const fp3_turn3 t = fp3_turn_of3(by);
    /* Columns of the product R T, then of R (R T)'. */
    const fp3_point3 x = fp3_turned3(&t, (fp3_point3){from[0], from[3], from[4]}),
                     y = fp3_turned3(&t, (fp3_point3){from[3], from[1], from[5]}),
                     z = fp3_turned3(&t, (fp3_point3){from[4], from[5], from[2]});
    const fp3_point3 u = fp3_turned3(&t, (fp3_point3){x.x, y.x, z.x}),
                     v = fp3_turned3(&t, (fp3_point3){x.y, y.y, z.y}),
                     w = fp3_turned3(&t, (fp3_point3){x.z, y.z, z.z});
    const float made[6] = {u.x, v.y, w.z, u.y, u.z, v.z};
    memcpy(back, made, sizeof made);
}

void fp3_space_inertia(const fp3_bodies *bodies, uint32_t number, double to[6]) {
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    const fp3_body3 *space = &bodies->space->body[number];
    const pose now = pose_of(bodies, number, 1);
    double q[4];
    fp3_multiply3(now.q, space->axes, q);
    memset(to, 0, 6 * sizeof *to);
    for (int axis = 0; axis < 3; axis++) {
        const double own[3] = {axis == 0, axis == 1, axis == 2};
        double n[3];
        fp3_turned3_by(q, own, n);
        for (int k = 0; k < 6; k++)
            to[k] += (double)space->moment[axis] * (n[row[k]] * n[column[k]]);
    }
}

fp3_stance3 fp3_space_stance(const fp3_bodies *bodies, uint32_t number, int has_way) {
    const fp3_joint *j = &bodies->joint[number];
    const fp3_joint3 *space = &bodies->space->joint[number];
    const pose a = pose_of(bodies, j->a, has_way), b = pose_of(bodies, j->b, has_way);
    const int is_wheel = j->def.type == FP3_WHEEL;
    double arm_a[3], arm_b[3], gap[3], own[3], axis[3], axle[3], other[3], r[4], error[3];
    arm_of(bodies, j->a, &a, space->anchor_a, arm_a);
    arm_of(bodies, j->b, &b, space->anchor_b, arm_b);
    for (int i = 0; i < 3; i++)
        gap[i] = (b.at[i] - a.at[i]) + (arm_b[i] - arm_a[i]);
    direction(j->def.axis, own);
    fp3_turned3_by(a.q, own, axis);
    direction(j->def.axle, own);
    fp3_turned3_by(a.q, own, axle);
    fp3_turned3_by(b.q, is_wheel ? space->axle_b : space->axis_b, other);
    turned_since(space, &a, &b, r);
    fp3_turned3_by(a.q, r + 1, error);
    const double sine = sqrt(dot(error, error)), angle = 2 * fp3_angle_of(sine, r[0]),
                 share = sine > 1e-12 ? angle / sine : 2;
    direction(is_wheel ? j->def.axle : j->def.axis, own);
    fp3_stance3 s = {
        .arm_a = point_of(arm_a),
        .arm_b = point_of(arm_b),
        .gap = point_of(gap),
        .axis = point_of(axis),
        .axle = point_of(axle),
        .error = {(float)(share * error[0]), (float)(share * error[1]), (float)(share * error[2])},
        .about = 2 * fp3_angle_of(dot(r + 1, own), r[0])};
    s.lean = lean(is_wheel ? axle : axis, other, &s.swing);
    fp3_space_back(bodies, j->a, has_way, s.back_a);
    fp3_space_back(bodies, j->b, has_way, s.back_b);
    return s;
}

double fp3_stance_at(const fp3_stance3 *s, fp3_joint_type type) {
    switch (type) {
    case FP3_ROD:
        return (double)fp3_size3(s->gap);
    case FP3_SLIDER:
    case FP3_WHEEL:
        return (double)fp3_dot3(s->gap, s->axis);
    case FP3_BALL:
        return s->swing;
    case FP3_WELD:
        return (double)fp3_size3(s->error);
    default:
        return s->about;
    }
}

double fp3_space_joint_at(const fp3_bodies *bodies, uint32_t number) {
    const fp3_stance3 s = fp3_space_stance(bodies, number, 0);
    return fp3_stance_at(&s, bodies->joint[number].def.type);
}

/* ---- a new one ---- */

#define BIT(name) (1 << (FP3_LAW_##name - FP3_LAW_pin3))

int fp3_space_laws_of(const fp3_joint_def *def) {
    const int is_driven = def->has_limits || def->most > 0 || def->hertz > 0;
    switch (def->type) {
    case FP3_ROD:
        return BIT(line3);
    case FP3_HINGE:
        return BIT(pin3) | BIT(spin3) | (is_driven ? BIT(twist3) : 0);
    case FP3_SLIDER:
        return BIT(pin3) | BIT(spin3) | (is_driven ? BIT(line3) : 0);
    case FP3_WHEEL:
        return BIT(pin3) | BIT(spin3) | BIT(line3) | BIT(twist3);
    case FP3_BALL:
        return BIT(pin3) | (def->hertz > 0 ? BIT(spin3) : 0) | (def->has_limits ? BIT(twist3) : 0);
    default:
        return BIT(pin3) | BIT(spin3);
    }
}

/* A direction of a's axes, as b has it. */
static void as_b(const double rest[4], const double v[3], double to[3]) {
    const double back[4] = {rest[0], -rest[1], -rest[2], -rest[3]},
                 size = sqrt((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
    const double unit[3] = {v[0] / size, v[1] / size, v[2] / size};
    fp3_turned3_by(back, unit, to);
}

/* As in a plane (joints.c): what does not turn is held at a point between the centres at which what
 * holds the turn does not move it. In space no point is free of that in all directions: by the
 * means of the inertias. */
static void anchor_between(const fp3_bodies *bodies, uint32_t number) {
    const fp3_joint *j = &bodies->joint[number];
    fp3_joint3 *space = &bodies->space->joint[number];
    const fp3_stance3 s = fp3_space_stance(bodies, number, 0);
    const float *ma = bodies->space->body[j->a].moment, *mb = bodies->space->body[j->b].moment;
    const double a = (double)ma[0] + ma[1] + ma[2], b = (double)mb[0] + mb[1] + mb[2];
    const double share = !(a > 0) ? 1 : !(b > 0) ? 0 : a / (a + b); /* light ones give way */
    const fp3_point3 way = fp3_subtract3(fp3_times3((float)-share, s.arm_b),
                                         fp3_times3((float)(1 - share), fp3_add3(s.arm_a, s.gap)));
    const double to[3] = {way.x, way.y, way.z};
    const double *p = bodies->space->body[j->a].q, *q = bodies->space->body[j->b].q,
                 back_a[4] = {p[0], -p[1], -p[2], -p[3]}, back_b[4] = {q[0], -q[1], -q[2], -q[3]};
    double by_a[3], by_b[3];
    fp3_turned3_by(back_a, to, by_a);
    fp3_turned3_by(back_b, to, by_b);
    for (int i = 0; i < 3; i++) {
        space->anchor_a[i] += by_a[i];
        space->anchor_b[i] += by_b[i];
    }
}

void fp3_space_joint_place(fp3_bodies *bodies, uint32_t number) {
    fp3_joint *j = &bodies->joint[number];
    fp3_joint3 *space = &bodies->space->joint[number];
    const double *a = bodies->space->body[j->a].q, back[4] = {a[0], -a[1], -a[2], -a[3]};
    *space = (fp3_joint3){.force = {0, 0, 0}};
    memcpy(space->anchor_a, j->def.anchor_a, sizeof space->anchor_a);
    memcpy(space->anchor_b, j->def.anchor_b, sizeof space->anchor_b);
    fp3_multiply3(back, bodies->space->body[j->b].q, space->q);
    as_b(space->q, j->def.axis, space->axis_b);
    as_b(space->q, j->def.axle, space->axle_b);
    if ((j->def.type == FP3_WELD && !(j->def.hertz > 0)) || j->def.type == FP3_SLIDER)
        anchor_between(bodies, number);
    if (isnan(j->def.rest))
        j->def.rest = fp3_space_joint_at(bodies, number);
}
