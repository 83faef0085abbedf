/* SPDX-License-Identifier: Apache-2.0 */
/* stance.c - where a joint is. */
#include "own.h"

#include <math.h>

static void turn(const fp3_body *body, double x, double y, double to[2]) {
    to[0] = body->turn[0] * x - body->turn[1] * y;
    to[1] = body->turn[1] * x + body->turn[0] * y;
}

fp3_stance fp3_joint_stance(const fp3_bodies *bodies, const fp3_joint *j) {
    const fp3_body *a = &bodies->body[j->a], *b = &bodies->body[j->b];
    fp3_stance s = {0};
    turn(a, j->anchor_a[0] - a->centre[0], j->anchor_a[1] - a->centre[1], s.arm_a);
    turn(b, j->anchor_b[0] - b->centre[0], j->anchor_b[1] - b->centre[1], s.arm_b);
    turn(a, j->axis[0], j->axis[1], s.axis);
    for (int i = 0; i < 2; i++)
        s.gap[i] = (b->at[i] - a->at[i]) + (s.arm_b[i] - s.arm_a[i]);
    return s;
}

double fp3_joint_angle(const fp3_bodies *bodies, const fp3_joint *j) {
    const double ratio = j->def.type == FP3_GEAR ? j->def.ratio : -1;
    return bodies->body[j->b].angle + ratio * bodies->body[j->a].angle - j->from;
}

double fp3_joint_at(const fp3_bodies *bodies, const fp3_joint *j) {
    const fp3_stance s = fp3_joint_stance(bodies, j);
    if (j->def.type == FP3_ROD)
        return sqrt(s.gap[0] * s.gap[0] + s.gap[1] * s.gap[1]);
    if (j->def.type == FP3_SLIDER || j->def.type == FP3_WHEEL)
        return s.gap[0] * s.axis[0] + s.gap[1] * s.axis[1];
    return fp3_joint_angle(bodies, j);
}
