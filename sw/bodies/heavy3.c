/* SPDX-License-Identifier: Apache-2.0 */
/* heavy3.c - heavy sets in space: see heavy.h. A body has six numbers, v and w. */
#include "heavy.h"
#include "own3.h"

#include <math.h>
#include <string.h>

#define LAW(name) (1 << (FP3_LAW_##name - FP3_LAW_pin3))

static fp3_contact3_row *contact_of(const fp3_bodies *bodies, const fp3_heavy_link *link) {
    const fp3_law_rows *rows = &bodies->space->contacts;
    return (fp3_contact3_row *)rows->row + rows->lane[link->of] / FP3_WIDE;
}
static uint32_t contact_lane(const fp3_bodies *bodies, const fp3_heavy_link *link) {
    return bodies->space->contacts.lane[link->of] % FP3_WIDE;
}

static int holds(const fp3_joint *j) { return j->generation & 1; }

/* Passes leave it alone, but for its gaps and rolling resistance: without friction, also where rows
 * are renewed. */
static void take_over(fp3_bodies *bodies, fp3_heavy_link *link) {
    fp3_contact3_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link);
    link->stiff = link->ratio * (double)r->soft[lane] / (double)r->fade[lane];
    link->rate = (double)r->rate[lane];
    link->mu = (double)r->mu[lane];
    for (int k = 0; k < FP3_POINTS3; k++) {
        link->was[k] = r->point[k].p[lane] > 0 ? 0 : -1;
        link->mass[k] = (double)r->point[k].j[lane];
        fp3_put(&r->point[k].j, lane, 0);
    }
    fp3_wide *const words[] = {&r->fade, &r->mu, &r->f1, &r->f2, &r->ft};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        fp3_put(words[i], lane, 0);
}

static void begin(fp3_bodies *bodies, fp3_heavy_link *link) {
    if (link->is_contact)
        take_over(bodies, link);
}

/* The row keeps the sum, by which what rolls is held. */
static void forget(fp3_bodies *bodies, fp3_heavy_link *link) {
    if (link->is_contact) {
        fp3_contact3_row *r = contact_of(bodies, link);
        const uint32_t lane = contact_lane(bodies, link);
        float total = 0;
        for (int k = 0; k < FP3_POINTS3; k++) {
            link->held[k] = (double)r->point[k].p[lane];
            total += r->point[k].p[lane];
            fp3_put(&r->point[k].p, lane, 0);
        }
        fp3_put(&r->total, lane, total);
        memset(link->rub, 0, sizeof link->rub);
        return;
    }
    fp3_joint3 *space = &bodies->space->joint[link->of];
    for (int i = 0; i < 3; i++)
        link->held[i] = (double)space->pin[i];
    link->held[3] = (double)(space->line[0] + space->line[1] + space->line[2] - space->line[3]);
    memset(space->pin, 0, sizeof space->pin);
    memset(space->line, 0, sizeof space->line);
    memset(space->twist, 0, sizeof space->twist);
    if (fp3_space_holds_turn(&bodies->joint[link->of].def))
        memset(space->spin, 0, sizeof space->spin);
}

static void weigh(const fp3_bodies *bodies, uint32_t slot, double *mass) {
    static const int at[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    const uint32_t number = bodies->in_slot[slot];
    const double m = (double)bodies->body[number].mass;
    double inertia[6];
    fp3_space_inertia(bodies, number, inertia);
    if (!(bodies->space->body[number].moment[0] > 0))
        inertia[0] = inertia[1] = inertia[2] = FP3_HEAVY_STANDS * m;
    for (int i = 0; i < 3; i++) {
        mass[7 * i] = m;
        for (int k = 0; k < 3; k++)
            mass[6 * (i + 3) + k + 3] = inertia[at[3 * i + k]];
    }
}

static void speed(const fp3_bodies *bodies, uint32_t slot, double *to) {
    for (int k = 0; k < 6; k++)
        to[k] = (double)bodies->speed[2 * slot + (uint32_t)k / 3][k % 3];
}

typedef struct {
    double x, y, z;
} vector;

static const vector NONE = {0, 0, 0};

static vector vector_of(fp3_point3 p) { return (vector){p.x, p.y, p.z}; }

static vector cross(vector a, vector b) {
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* A row along n at an arm of each body, and about `more`. */
static void aim(vector n, vector arm_a, vector arm_b, vector more, double of_a[6], double of_b[6]) {
    const vector a = cross(arm_a, n), b = cross(arm_b, n);
    const double to_a[6] = {-n.x, -n.y, -n.z, -a.x - more.x, -a.y - more.y, -a.z - more.z},
                 to_b[6] = {n.x, n.y, n.z, b.x + more.x, b.y + more.y, b.z + more.z};
    memcpy(of_a, to_a, sizeof to_a);
    memcpy(of_b, to_b, sizeof to_b);
}

/* As in a plane (heavy2.c): about all that is across the arm. */
static void stiffen(const fp3_bodies *bodies, uint32_t number, vector arm, vector pull,
                    double sign) {
    const double r[3] = {arm.x, arm.y, arm.z},
                 by = sign * (arm.x * pull.x + arm.y * pull.y + arm.z * pull.z),
                 square = arm.x * arm.x + arm.y * arm.y + arm.z * arm.z;
    if (bodies->heavy->is_calm || number == FP3_NO_SPRING || !(by > 0))
        return;
    const fp3_springs *s = &bodies->heavy->springs;
    for (uint32_t i = 0; i < 3; i++)
        for (uint32_t k = 0; k < 3; k++)
            s->mass[36 * number + 6 * (i + 3) + k + 3] +=
                bodies->def.h / bodies->def.substeps * by * ((i == k) - r[i] * r[k] / square);
}

static vector without(int axis, const fp3_point3 *is_free) {
    const vector n = {axis == 0, axis == 1, axis == 2};
    if (!is_free)
        return n;
    const vector f = vector_of(*is_free);
    const double along = n.x * f.x + n.y * f.y + n.z * f.z;
    return (vector){n.x - along * f.x, n.y - along * f.y, n.z - along * f.z};
}

/* A line or an axis that is free is taken out of three rows: what is left is square to it, and so
 * are their impulses together. */
static void fill_point(fp3_bodies *bodies, fp3_heavy_link *link, double rate) {
    fp3_joint3 *space = &bodies->space->joint[link->of];
    const fp3_stance3 *s = &bodies->space->stance[link->of];
    const int is_line = fp3_is_on_line3(bodies->joint[link->of].def.type);
    const fp3_point3 gap =
        fp3_at_most3(is_line ? fp3_along3(s->gap, -fp3_dot3(s->gap, s->axis), s->axis) : s->gap,
                     FP3_FARTHEST3 * (float)bodies->def.size);
    const vector arm_a = vector_of(is_line ? fp3_add3(s->arm_a, s->gap) : s->arm_a),
                 arm_b = vector_of(s->arm_b);
    const double gaps[3] = {gap.x, gap.y, gap.z};
    for (int i = 0; i < 3; i++) {
        double a[6], b[6];
        const fp3_heavy_row row = {i, &space->pin[i], a, b, INFINITY, rate * gaps[i], 1};
        aim(without(i, is_line ? &s->axis : NULL), arm_a, arm_b, NONE, a, b);
        fp3_heavy_put(bodies, link, &row);
    }
}

static void fill_turn(fp3_bodies *bodies, fp3_heavy_link *link, double rate) {
    fp3_joint3 *space = &bodies->space->joint[link->of];
    const fp3_stance3 *s = &bodies->space->stance[link->of];
    const fp3_joint_type type = bodies->joint[link->of].def.type;
    const fp3_point3 *is_free = type == FP3_HINGE   ? &s->axis
                                : type == FP3_WHEEL ? &s->axle
                                                    : NULL,
                     error = fp3_at_most3(is_free ? s->lean : s->error, FP3_FARTHEST_TURN3);
    const double errors[3] = {error.x, error.y, error.z};
    for (int i = 0; i < 3; i++) {
        double a[6], b[6];
        const fp3_heavy_row row = {3 + i, &space->spin[i], a, b, INFINITY, rate * errors[i], 1};
        aim(NONE, NONE, NONE, without(i, is_free), a, b);
        fp3_heavy_put(bodies, link, &row);
    }
}

static void fill_joint(fp3_bodies *bodies, fp3_heavy_link *link, int push) {
    const fp3_joint *joint = &bodies->joint[link->of];
    fp3_joint3 *space = &bodies->space->joint[link->of];
    const fp3_stance3 *s = &bodies->space->stance[link->of];
    const double rate = push && !bodies->heavy->is_calm ? bodies->heavy->rate : 0,
                 h = bodies->def.h / bodies->def.substeps;
    const fp3_drive3 along = fp3_space_drive_along(bodies, link->of, h),
                     about = fp3_space_drive_about(bodies, link->of, h);
    const vector n = vector_of(along.n), arm_a = vector_of(along.arm_a),
                 arm_b = vector_of(s->arm_b),
                 pull = {link->held[0] + link->held[3] * n.x, link->held[1] + link->held[3] * n.y,
                         link->held[2] + link->held[3] * n.z};
    const int laws = fp3_space_laws_of(&joint->def);
    double a[6], b[6];
    stiffen(bodies, link->a, vector_of(s->arm_a), pull, -1);
    stiffen(bodies, link->b, arm_b, pull, 1);
    if (laws & LAW(pin3))
        fill_point(bodies, link, rate);
    if (fp3_space_holds_turn(&joint->def))
        fill_turn(bodies, link, rate);
    if (laws & LAW(line3)) {
        aim(n, arm_a, arm_b, NONE, a, b);
        fp3_heavy_drive(bodies, link, &along, 6, space->line, a, b, push);
    }
    if (laws & LAW(twist3)) {
        aim(NONE, NONE, NONE, vector_of(about.n), a, b);
        fp3_heavy_drive(bodies, link, &about, 10, space->twist, a, b, push);
    }
}

/* As rub3.ode: at the middle of all points, along both tangents and about the normal. */
static void fill_friction(fp3_bodies *bodies, fp3_heavy_link *link, const vector of[5],
                          uint32_t normals) {
    const fp3_contact3_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link), first = bodies->heavy->springs.rows - normals;
    const double belt[3] = {r->s1[lane], r->s2[lane], 0}, radius = r->radius[lane];
    for (int i = 0; i < (radius > 0 ? 3 : 2); i++) {
        double a[6], b[6];
        const double k = i < 2 ? INFINITY : bodies->heavy->springs.hardest * radius * radius;
        const fp3_heavy_row along = {FP3_POINTS3 + i, &link->rub[i], a, b, k, -belt[i], 1};
        aim(i < 2 ? of[1 + i] : NONE, of[3], of[4], i < 2 ? NONE : of[0], a, b);
        fp3_spring *row = fp3_heavy_put(bodies, link, &along);
        row->is_driven = belt[i] != 0;
        if (i == 1)
            continue; /* it follows the row before */
        row->is_disc = i == 0;
        row->normal = first;
        row->normals = normals;
        row->share = i == 0 ? link->mu : link->mu * radius;
        row->most = 0;
    }
}

/* As push3.ode, point by point. Both passes of a substep have the same arms, as in a plane. */
static void fill_contact(fp3_bodies *bodies, fp3_heavy_link *link, int push) {
    fp3_contact3_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link);
    const double now[6] = {r->c_x[lane], r->c_y[lane], r->c_z[lane],
                           r->e_x[lane], r->e_y[lane], r->e_z[lane]};
    if (push) {
        memcpy(link->arm[0], now, 3 * sizeof *now);
        memcpy(link->arm[1], now + 3, 3 * sizeof *now);
    }
    const double *c = link->arm[0], *e = link->arm[1];
    const vector n = {r->n_x[lane], r->n_y[lane], r->n_z[lane]},
                 d = {r->d_x[lane], r->d_y[lane], r->d_z[lane]}, s = cross(n, d),
                 of[5] = {n, d, s, {c[0], c[1], c[2]}, {e[0], e[1], e[2]}};
    uint32_t normals = 0;
    for (int k = 0; k < FP3_POINTS3; k++) {
        fp3_contact3_point *p = &r->point[k];
        const double x = p->x[lane], y = p->y[lane],
                     gap =
                         p->gap[lane] + r->lift[lane] + x * r->slope_x[lane] + y * r->slope_y[lane];
        const vector at = {y * d.x - x * s.x, y * d.y - x * s.y, y * d.z - x * s.z};
        double a[6], b[6];
        if (!(link->mass[k] > 0))
            continue;
        aim(n, of[3], of[4], at, a, b);
        fp3_heavy_push(
            bodies, link,
            (fp3_heavy_row){.which = k, .word = FP3_WORD_OF(p->p, lane), .of_a = a, .of_b = b}, gap,
            push);
        normals++;
    }
    if (normals && link->mu > 0)
        fill_friction(bodies, link, of, normals);
}

static void fill(fp3_bodies *bodies, fp3_heavy_link *link, int push) {
    if (link->is_contact)
        fill_contact(bodies, link, push);
    else
        fill_joint(bodies, link, push);
}

static void move(fp3_bodies *bodies, uint32_t slot, const double *change) {
    const int turns = bodies->space->body[bodies->in_slot[slot]].moment[0] > 0;
    for (uint32_t k = 0; k < (turns ? 2 : 1); k++) {
        const double *of = change + 3 * k;
        const fp3_four by = {(float)of[0], (float)of[1], (float)of[2], 0};
        bodies->speed[2 * slot + k] += by;
        bodies->base[2 * slot + k] += by;
    }
}

/* Who is put down at rest is no set in space. */
static int is_moving(const fp3_bodies *bodies, uint32_t slot) {
    (void)bodies;
    (void)slot;
    return 1;
}

static void end(fp3_bodies *bodies, const fp3_heavy_link *link) {
    fp3_contact3_row *r = contact_of(bodies, link);
    const uint32_t lane = contact_lane(bodies, link);
    fp3_put(&r->f1, lane, link->rub[0]);
    fp3_put(&r->f2, lane, link->rub[1]);
    fp3_put(&r->ft, lane, link->rub[2]);
}

const fp3_heavy_laws fp3_heavy_laws3 = {holds, is_moving, is_moving, begin, forget,
                                        weigh, speed,     fill,      move,  end};
