/* SPDX-License-Identifier: Apache-2.0 */
/* heavy2.c - heavy sets in a plane: see heavy.h. */
#include "heavy.h"

#include "turn.h"

#include <math.h>
#include <string.h>

static fp3_contact2_row *contact_of(const fp3_bodies *bodies, const fp3_heavy_link *link) {
    return (fp3_contact2_row *)bodies->contacts.row + bodies->contacts.lane[link->of] / FP3_WIDE;
}
static uint32_t contact_lane(const fp3_bodies *bodies, const fp3_heavy_link *link) {
    return bodies->contacts.lane[link->of] % FP3_WIDE;
}

static int holds(const fp3_joint *j) {
    return j->generation & 1 && (j->def.type == FP3_HINGE || j->def.type == FP3_WELD);
}

/* Passes leave it alone, but for its gaps and rolling resistance. Its spring is as stiff for the
 * lightest body as that of others for the heaviest. */
static void take_over(fp3_bodies *bodies, fp3_heavy_link *link) {
    fp3_contact2_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link);
    link->was[0] = r->p1[lane] > 0 ? 0 : -1;
    link->was[1] = r->p2[lane] > 0 ? 0 : -1;
    fp3_wide *const words[] = {&r->j1, &r->j2, &r->k1, &r->k2, &r->fade, &r->f1, &r->f2};
    link->stiff = link->ratio * (double)r->soft[lane] / (double)r->fade[lane];
    link->rate = (double)r->rate[lane];
    link->mass[0] = (double)r->j1[lane];
    link->mass[1] = (double)r->j2[lane];
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        fp3_put(words[i], lane, 0);
}

static void begin(fp3_bodies *bodies, fp3_heavy_link *link) {
    if (link->is_contact) {
        take_over(bodies, link);
        return;
    }
    const fp3_joint *joint = &bodies->joint[link->of];
    const fp3_stance s = fp3_joint_stance(bodies, joint);
    for (int i = 0; i < 2; i++) {
        link->arm_a[i] = s.arm_a[i];
        link->arm_b[i] = s.arm_b[i];
        link->gap[i] = s.gap[i];
    }
    link->gap[2] = fp3_joint_angle(bodies, joint);
}

static void forget(fp3_bodies *bodies, fp3_heavy_link *link) {
    if (link->is_contact) {
        fp3_contact2_row *r = contact_of(bodies, link);
        const uint32_t lane = contact_lane(bodies, link);
        link->held[0] = (double)r->p1[lane];
        link->held[1] = (double)r->p2[lane];
        r->p1[lane] = r->p2[lane] = link->rub[0] = link->rub[1] = 0;
        return;
    }
    fp3_joint *joint = &bodies->joint[link->of];
    for (int i = 0; i < 2; i++) {
        link->held[i] = (double)joint->point[i];
        joint->point[i] = 0;
    }
    memset(joint->twist, 0, sizeof joint->twist);
}

static void weigh(const fp3_bodies *bodies, uint32_t slot, double *mass) {
    const float m = bodies->heft[slot][0], i = bodies->heft[slot][1];
    mass[0] = mass[4] = 1 / (double)m;
    mass[8] = i > 0 ? 1 / (double)i : FP3_HEAVY_STANDS / (double)m;
}

static void speed(const fp3_bodies *bodies, uint32_t slot, double *to) {
    for (int k = 0; k < 3; k++)
        to[k] = (double)bodies->speed[slot][k];
}

static void turned(const fp3_bodies *bodies, uint32_t slot, const double arm[2], double to[2]) {
    float turn[2] = {1, 0};
    fp3_turn2_by(turn, bodies->way[slot][2]);
    to[0] = (double)turn[0] * arm[0] - (double)turn[1] * arm[1];
    to[1] = (double)turn[1] * arm[0] + (double)turn[0] * arm[1];
}

/* A pull turns a body towards it, so much that light links between heavy bodies would swing faster
 * than substeps can follow. The pull is as if it were where the arm is at the end of the substep:
 * the body resists by as much more. */
static void stiffen(const fp3_bodies *bodies, const fp3_heavy_link *link, uint32_t number,
                    const double arm[2], double sign) {
    const double by = sign * (arm[0] * link->held[0] + arm[1] * link->held[1]);
    if (number != FP3_NO_SPRING && by > 0 && !bodies->heavy->is_calm)
        bodies->heavy->springs.mass[number * 9 + 8] += bodies->def.h / bodies->def.substeps * by;
}

static fp3_drive3 drive_of(const fp3_bodies *bodies, const fp3_heavy_link *link, double angle) {
    const float inverse = bodies->heft[link->slot[0]][1] + bodies->heft[link->slot[1]][1];
    fp3_joint_def def = bodies->joint[link->of].def;
    fp3_drive3 d = {.mass = inverse > 0 ? 1 / inverse : 0,
                    .is_firm = def.type == FP3_WELD && !(def.hertz > 0)};
    const int is_hinge = def.type == FP3_HINGE;
    def.rest = is_hinge ? def.rest : 0; /* as joint_rows.c has it */
    fp3_drive_use(&d, &def, is_hinge ? FP3_USES_ALL : FP3_USES_SPRING, angle, FP3_FARTHEST,
                  bodies->def.h / bodies->def.substeps);
    return d;
}

static void fill_joint(fp3_bodies *bodies, fp3_heavy_link *link, int push) {
    fp3_joint *joint = &bodies->joint[link->of];
    const double rate = push && !bodies->heavy->is_calm ? bodies->heavy->rate : 0;
    const fp3_four way = bodies->way[link->slot[1]] - bodies->way[link->slot[0]];
    double a[2], b[2];
    turned(bodies, link->slot[0], link->arm_a, a);
    turned(bodies, link->slot[1], link->arm_b, b);
    stiffen(bodies, link, link->a, a, -1);
    stiffen(bodies, link, link->b, b, 1);
    const double of_a[3][3] = {{-1, 0, a[1]}, {0, -1, -a[0]}, {0, 0, -1}},
                 of_b[3][3] = {{1, 0, -b[1]}, {0, 1, b[0]}, {0, 0, 1}};
    for (int i = 0; i < 2; i++) {
        const double apart =
            link->gap[i] + (double)way[i] + (b[i] - link->arm_b[i]) - (a[i] - link->arm_a[i]);
        const double back = rate * fp3_within(apart, FP3_FARTHEST * bodies->def.size);
        const fp3_heavy_row row = {i, &joint->point[i], of_a[i], of_b[i], INFINITY, back, 1};
        fp3_heavy_put(bodies, link, &row);
    }
    const fp3_drive3 about = drive_of(bodies, link, link->gap[2] + (double)way[2]);
    fp3_heavy_drive(bodies, link, &about, 2, joint->twist, of_a[2], of_b[2], push);
}

/* A push, then its friction. Both passes of a substep have the same arms: what the first one gave a
 * light body between heavy ones, the second has to take back where it was given. */
static void fill_point(fp3_bodies *bodies, fp3_heavy_link *link, int push, int point,
                       fp3_wide *const words[6]) {
    const fp3_contact2_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link);
    const double nx = r->n_x[lane], ny = r->n_y[lane];
    double *arm = link->arm[point];
    for (int i = 0; push && i < 4; i++)
        arm[i] = (double)(*words[i])[lane];
    const double along_a[3] = {-nx, -ny, -arm[0]}, along_b[3] = {nx, ny, arm[1]},
                 aside_a[3] = {ny, -nx, -arm[2]}, aside_b[3] = {-ny, nx, arm[3]};
    if (!(link->mass[point] > 0))
        return;
    const fp3_heavy_row along = {.which = point,
                                 .word = (float *)words[5] + lane,
                                 .of_a = along_a,
                                 .of_b = along_b},
                        aside = {2 + point, &link->rub[point],      aside_a, aside_b,
                                 INFINITY,  -(double)r->belt[lane], 1};
    const fp3_springs *s = &bodies->heavy->springs;
    fp3_heavy_push(bodies, link, along, (*words[4])[lane], push);
    fp3_spring *row = fp3_heavy_put(bodies, link, &aside);
    row->is_driven = r->belt[lane] != 0;
    row->normal = s->rows - 2;
    row->share = r->mu[lane];
    row->most = 0;
}

static void fill(fp3_bodies *bodies, fp3_heavy_link *link, int push) {
    if (!link->is_contact) {
        fill_joint(bodies, link, push);
        return;
    }
    fp3_contact2_row *r = contact_of(bodies, link);
    fp3_wide *const words[2][6] = {{&r->a1, &r->b1, &r->c1, &r->e1, &r->gap1, &r->p1},
                                   {&r->a2, &r->b2, &r->c2, &r->e2, &r->gap2, &r->p2}};
    fill_point(bodies, link, push, 0, words[0]);
    fill_point(bodies, link, push, 1, words[1]);
}

static void move(fp3_bodies *bodies, uint32_t slot, const double *change) {
    const fp3_four by = {(float)change[0], (float)change[1],
                         bodies->heft[slot][1] > 0 ? (float)change[2] : 0, 0};
    bodies->speed[slot] += by;
    bodies->base[slot] += by;
}

static int is_moving(const fp3_bodies *bodies, uint32_t slot) {
    const fp3_four v = bodies->speed[slot];
    return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

static int has_pushed(const fp3_bodies *bodies, uint32_t contact) {
    const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[contact]];
    return t->p[0] > 0 || t->p[1] > 0;
}

static void end(fp3_bodies *bodies, const fp3_heavy_link *link) {
    fp3_contact2_row *r = contact_of(bodies, link);
    fp3_put(&r->f1, contact_lane(bodies, link), link->rub[0]);
    fp3_put(&r->f2, contact_lane(bodies, link), link->rub[1]);
}

const fp3_heavy_laws fp3_heavy_laws2 = {holds, is_moving, has_pushed, begin, forget,
                                        weigh, speed,     fill,       move,  end};
