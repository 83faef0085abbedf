/* SPDX-License-Identifier: Apache-2.0 */
/* joint_rows.c - the rows of joints: what a joint is made of, before and after a step. */
#include "heavy.h"
#include "own.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Springs that hold: of 72 Hz, or of a share of the substeps' rate if that is more, but no faster
 * than that rate. Pendulums lose least so; with 90 Hz and 0.375 a grid of pins, or four welded
 * boxes that stick out of a wall, swing more and more. */
#define STIFFNESS 72.0
#define RESOLVED 0.3
#define DAMPING 5.0 /* of critical damping */

#define LAW(name) (FP3_LAW_##name - FP3_LAW_twist2)
static const size_t sizes[FP3_JOINT_LAWS] = {
    [LAW(twist2)] = sizeof(fp3_twist2_row),
    [LAW(slide2)] = sizeof(fp3_slide2_row),
    [LAW(rod2)] = sizeof(fp3_rod2_row),
    [LAW(pin2)] = sizeof(fp3_pin2_row),
};

/* ---- before a step ---- */

typedef struct {
    const fp3_joint *joint;
    fp3_stance stance;
    fp3_softness firm, spring; /* of what is held; of its spring */
    float ma, ia, mb, ib;
    double h;
    uint32_t lane;
} filling;

static float inverse_of(double x) { return x > 0 ? (float)(1 / x) : 0; }

/* Limits, motor, spring or lock of a row of any law: all have these words. */
#define FILL_ROW(row, f, use, is_firm, at_rest)                                                    \
    do {                                                                                           \
        const fp3_joint_def *def_ = &(f)->joint->def;                                              \
        const fp3_softness soft_ = (is_firm) ? (f)->firm : (f)->spring;                            \
        const uint32_t lane_ = (f)->lane;                                                          \
        const int has_spring_ = (is_firm) || ((use)&FP3_USES_SPRING && def_->hertz > 0);           \
        fp3_put(&(row)->firm, lane_, (is_firm) ? 1 : 0);                                           \
        fp3_put(&(row)->rate, lane_, has_spring_ ? soft_.rate : 0);                                \
        fp3_put(&(row)->soft, lane_, has_spring_ ? soft_.soft : 0);                                \
        fp3_put(&(row)->fade, lane_, has_spring_ ? soft_.fade : 0);                                \
        fp3_put(&(row)->rest, lane_, (float)(at_rest));                                            \
        fp3_put(&(row)->speed, lane_, (float)def_->speed);                                         \
        fp3_put(&(row)->most, lane_, (use)&FP3_USES_MOTOR ? (float)(def_->most * (f)->h) : 0);     \
        fp3_put(&(row)->low, lane_,                                                                \
                (use)&FP3_USES_LIMITS && def_->has_limits ? (float)def_->low : -1e12f);            \
        fp3_put(&(row)->high, lane_,                                                               \
                (use)&FP3_USES_LIMITS && def_->has_limits ? (float)def_->high : 1e12f);            \
        fp3_put(&(row)->hold, lane_, (f)->firm.rate);                                              \
        fp3_put(&(row)->give, lane_, (f)->firm.soft);                                              \
        fp3_put(&(row)->wane, lane_, (f)->firm.fade);                                              \
    } while (0)

#define FILL_MASSES(row, f)                                                                        \
    do {                                                                                           \
        fp3_put(&(row)->ma, (f)->lane, (f)->ma);                                                   \
        fp3_put(&(row)->ia, (f)->lane, (f)->ia);                                                   \
        fp3_put(&(row)->mb, (f)->lane, (f)->mb);                                                   \
        fp3_put(&(row)->ib, (f)->lane, (f)->ib);                                                   \
    } while (0)

#define FILL_IMPULSES(row, f, from)                                                                \
    do {                                                                                           \
        fp3_put(&(row)->s, (f)->lane, (from)[0]);                                                  \
        fp3_put(&(row)->m, (f)->lane, (from)[1]);                                                  \
        fp3_put(&(row)->l, (f)->lane, (from)[2]);                                                  \
        fp3_put(&(row)->u, (f)->lane, (from)[3]);                                                  \
    } while (0)

#define FILL_ARMS(row, f)                                                                          \
    do {                                                                                           \
        fp3_put(&(row)->a_x, (f)->lane, (float)(f)->stance.arm_a[0]);                              \
        fp3_put(&(row)->a_y, (f)->lane, (float)(f)->stance.arm_a[1]);                              \
        fp3_put(&(row)->b_x, (f)->lane, (float)(f)->stance.arm_b[0]);                              \
        fp3_put(&(row)->b_y, (f)->lane, (float)(f)->stance.arm_b[1]);                              \
        fp3_put(&(row)->gap_x, (f)->lane, (float)(f)->stance.gap[0]);                              \
        fp3_put(&(row)->gap_y, (f)->lane, (float)(f)->stance.gap[1]);                              \
    } while (0)

static void fill_twist(const fp3_bodies *bodies, const filling *f, fp3_twist2_row *row) {
    const fp3_joint *j = f->joint;
    const fp3_joint_type type = j->def.type;
    const double ratio = type == FP3_GEAR ? j->def.ratio : -1;
    const int is_firm =
        type == FP3_SLIDER || type == FP3_GEAR || (type == FP3_WELD && !(j->def.hertz > 0));
    const int use = type == FP3_HINGE   ? FP3_USES_ALL
                    : type == FP3_WHEEL ? FP3_USES_MOTOR
                    : type == FP3_WELD  ? FP3_USES_SPRING
                                        : 0;
    FILL_MASSES(row, f);
    fp3_put(&row->ratio, f->lane, (float)ratio);
    fp3_put(&row->turned, f->lane, (float)fp3_joint_angle(bodies, j));
    fp3_put(&row->j, f->lane, inverse_of(f->ib + ratio * ratio * f->ia));
    FILL_ROW(row, f, use, is_firm, type == FP3_HINGE ? j->def.rest : 0);
    FILL_IMPULSES(row, f, j->twist);
}

static void fill_slide(const filling *f, fp3_slide2_row *row) {
    const fp3_joint *j = f->joint;
    const double *e = f->stance.axis;
    FILL_MASSES(row, f);
    FILL_ARMS(row, f);
    fp3_put(&row->n_x, f->lane, (float)e[0]);
    fp3_put(&row->n_y, f->lane, (float)e[1]);
    fp3_put(&row->stay, f->lane, f->firm.rate);
    fp3_put(&row->bend, f->lane, f->firm.soft);
    fp3_put(&row->lose, f->lane, f->firm.fade);
    FILL_ROW(row, f, j->def.type == FP3_WHEEL ? FP3_USES_SPRING | FP3_USES_LIMITS : FP3_USES_ALL, 0,
             j->def.rest);
    FILL_IMPULSES(row, f, j->slide);
    fp3_put(&row->p, f->lane, j->slide[4]);
}

static void fill_rod(const filling *f, fp3_rod2_row *row) {
    const fp3_joint *j = f->joint;
    FILL_MASSES(row, f);
    FILL_ARMS(row, f);
    FILL_ROW(row, f, FP3_USES_ALL, !(j->def.hertz > 0) && !j->def.has_limits, j->def.rest);
    FILL_IMPULSES(row, f, j->rod);
}

static void fill_point(const filling *f, fp3_pin2_row *row) {
    const fp3_joint *j = f->joint;
    FILL_MASSES(row, f);
    FILL_ARMS(row, f);
    fp3_put(&row->rate, f->lane, f->firm.rate);
    fp3_put(&row->soft, f->lane, f->firm.soft);
    fp3_put(&row->fade, f->lane, f->firm.fade);
    fp3_put(&row->p_x, f->lane, j->point[0]);
    fp3_put(&row->p_y, f->lane, j->point[1]);
}

static void fill(const fp3_bodies *bodies, int law, uint32_t i, double h, fp3_softness firm) {
    const fp3_law_rows *rows = &bodies->joined[law];
    const fp3_joint *j = &bodies->joint[rows->of[i]];
    const fp3_body *a = &bodies->body[j->a], *b = &bodies->body[j->b];
    filling f = {.joint = j,
                 .stance = fp3_joint_stance(bodies, j),
                 .firm = firm,
                 .spring = law == LAW(pin2) ? (fp3_softness){0, 0, 0}
                                            : fp3_soften(j->def.hertz, j->def.damping, h),
                 .ma = fp3_inverse_mass(a->mass),
                 .ia = fp3_inverse_mass(a->inertia),
                 .mb = fp3_inverse_mass(b->mass),
                 .ib = fp3_inverse_mass(b->inertia),
                 .h = h,
                 .lane = rows->lane[i] % FP3_WIDE};
    const uint32_t block = rows->lane[i] / FP3_WIDE;
    if (law == LAW(twist2))
        fill_twist(bodies, &f, (fp3_twist2_row *)rows->row + block);
    else if (law == LAW(slide2))
        fill_slide(&f, (fp3_slide2_row *)rows->row + block);
    else if (law == LAW(rod2))
        fill_rod(&f, (fp3_rod2_row *)rows->row + block);
    else
        fill_point(&f, (fp3_pin2_row *)rows->row + block);
}

static fp3_status make_room(fp3_bodies *bodies) {
    fp3_status status = FP3_OK;
    for (int law = 0; !status && law < FP3_JOINT_LAWS; law++) {
        fp3_law_rows *rows = &bodies->joined[law];
        status = fp3_bodies_room((void **)&rows->of, &rows->of_room, sizeof *rows->of,
                                 bodies->joint_count + 1u, bodies->error);
        if (!status)
            status = fp3_rows_make_room(bodies, rows, bodies->joint_count);
    }
    return status;
}

static void put_rows(fp3_bodies *bodies, uint32_t number, unsigned laws) {
    const fp3_joint *j = &bodies->joint[number];
    const uint32_t a = fp3_slot_of(bodies, j->a), b = fp3_slot_of(bodies, j->b);
    if (a >= bodies->movable && b >= bodies->movable)
        return;
    for (; laws; laws &= laws - 1) {
        fp3_law_rows *rows = &bodies->joined[__builtin_ctz(laws)];
        rows->is_same &= fp3_rows_put(rows, rows->count, a, b);
        rows->of[rows->count++] = number;
    }
}

static fp3_status lay(fp3_bodies *bodies) {
    fp3_status status = bodies->joints ? make_room(bodies) : FP3_OK;
    for (int law = 0; law < FP3_JOINT_LAWS; law++) {
        bodies->joined[law].count = 0;
        bodies->joined[law].is_same = 1;
    }
    if (status || !bodies->joints)
        return status;
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (j->generation & 1 && !j->is_heavy)
            put_rows(bodies, i, j->laws);
    }
    for (int law = 0; !status && law < FP3_JOINT_LAWS; law++) {
        fp3_law_rows *rows = &bodies->joined[law];
        if (rows->count)
            status = fp3_rows_lay(bodies, rows, rows->a, rows->b, sizes[law]);
        if (!status)
            status = fp3_cut_rows(bodies, rows);
    }
    return status;
}

fp3_status fp3_joints_begin(fp3_bodies *bodies, double h) {
    const fp3_softness firm = fp3_soften(fmax(RESOLVED / h, fmin(STIFFNESS, 1 / h)), DAMPING, h);
    fp3_status status = fp3_heavy_find(bodies, &fp3_heavy_laws2, firm.rate);
    if (!status)
        status = lay(bodies);
    for (int law = 0; !status && law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < bodies->joined[law].count; i++)
            fill(bodies, law, i, h, firm);
    return status;
}

/* ---- and after it ---- */

/* Impulses of a row, and how many: those of a spring or lock, a motor, both limits; one across. */
typedef struct {
    float *word[5];
    uint32_t count;
    int is_firm; /* the first one is that of a lock */
} impulses;

#define TURNS(row, lane)                                                                           \
    FP3_WORD_OF((row)->s, lane), FP3_WORD_OF((row)->m, lane), FP3_WORD_OF((row)->l, lane),         \
        FP3_WORD_OF((row)->u, lane)

static impulses impulses_of(const fp3_law_rows *rows, int law, uint32_t i) {
    const uint32_t block = rows->lane[i] / FP3_WIDE, lane = rows->lane[i] % FP3_WIDE;
    if (law == LAW(twist2)) {
        fp3_twist2_row *row = (fp3_twist2_row *)rows->row + block;
        return (impulses){{TURNS(row, lane)}, 4, row->firm[lane] != 0};
    }
    if (law == LAW(slide2)) {
        fp3_slide2_row *row = (fp3_slide2_row *)rows->row + block;
        return (impulses){{TURNS(row, lane), FP3_WORD_OF(row->p, lane)}, 5, row->firm[lane] != 0};
    }
    if (law == LAW(rod2)) {
        fp3_rod2_row *row = (fp3_rod2_row *)rows->row + block;
        return (impulses){{TURNS(row, lane)}, 4, row->firm[lane] != 0};
    }
    fp3_pin2_row *row = (fp3_pin2_row *)rows->row + block;
    return (impulses){{FP3_WORD_OF(row->p_x, lane), FP3_WORD_OF(row->p_y, lane)}, 2, 1};
}

int fp3_joint_gives(const fp3_bodies *bodies, int law, uint32_t row) {
    const impulses p = impulses_of(&bodies->joined[law], law, row);
    return law != LAW(pin2) && ((!p.is_firm && *p.word[0] != 0) || *p.word[1] != 0);
}

void fp3_joint_scale(fp3_bodies *bodies, int law, uint32_t row, float by) {
    const impulses p = impulses_of(&bodies->joined[law], law, row);
    for (uint32_t i = 0; i < p.count && by < 1; i++)
        *p.word[i] *= by;
}

/* What is no number is forgotten, so that a joint of a body that failed goes on. */
static float number_or_0(float x) { return isfinite(x) ? x : 0; }

static void keep(const fp3_law_rows *rows, int law, uint32_t i, fp3_joint *j) {
    const impulses p = impulses_of(rows, law, i);
    float *const to = law == LAW(twist2)   ? j->twist
                      : law == LAW(slide2) ? j->slide
                      : law == LAW(rod2)   ? j->rod
                                           : j->point;
    for (uint32_t k = 0; k < p.count; k++)
        to[k] = number_or_0(*p.word[k]);
}

/* Joints that heavy sets have found have no rows. */
static void mend(fp3_joint *j) {
    for (int i = 0; i < 2; i++)
        j->point[i] = number_or_0(j->point[i]);
    for (int i = 0; i < 4; i++)
        j->twist[i] = number_or_0(j->twist[i]);
}

static float sum(const float impulse[4]) {
    return impulse[0] + impulse[1] + impulse[2] - impulse[3];
}

/* What the joint did to b. */
static void weigh(const fp3_bodies *bodies, fp3_joint *j, double h) {
    double force[2] = {j->point[0], j->point[1]};
    if (j->laws & (1 << LAW(rod2) | 1 << LAW(slide2))) {
        const fp3_stance s = fp3_joint_stance(bodies, j);
        const double length = sqrt(s.gap[0] * s.gap[0] + s.gap[1] * s.gap[1]);
        const double rod = length > 0 ? sum(j->rod) / length : 0, along = sum(j->slide);
        force[0] = force[0] + rod * s.gap[0] + along * s.axis[0] - j->slide[4] * s.axis[1];
        force[1] = force[1] + rod * s.gap[1] + along * s.axis[1] + j->slide[4] * s.axis[0];
    }
    j->force[0] = (float)(force[0] / h);
    j->force[1] = (float)(force[1] / h);
    j->torque = (float)(sum(j->twist) / h);
    /* About the anchor that the caller knows. */
    const double x = j->anchor_b[0] - j->def.anchor_b[0], y = j->anchor_b[1] - j->def.anchor_b[1];
    if (x == 0 && y == 0)
        return;
    const fp3_body *b = &bodies->body[j->b];
    const double dx = b->turn[0] * x - b->turn[1] * y, dy = b->turn[1] * x + b->turn[0] * y;
    j->torque = (float)(sum(j->twist) / h + dx * j->force[1] - dy * j->force[0]);
}

static int breaks(const fp3_joint *j) {
    return (j->def.force > 0 &&
            sqrtf(j->force[0] * j->force[0] + j->force[1] * j->force[1]) > (float)j->def.force) ||
           (j->def.torque > 0 && fabsf(j->torque) > (float)j->def.torque);
}

void fp3_joints_end(fp3_bodies *bodies, double h) {
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < bodies->joined[law].count; i++)
            keep(&bodies->joined[law], law, i, &bodies->joint[bodies->joined[law].of[i]]);
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        fp3_joint *j = &bodies->joint[i];
        if (!(j->generation & 1) || (fp3_slot_of(bodies, j->a) >= bodies->movable &&
                                     fp3_slot_of(bodies, j->b) >= bodies->movable))
            continue;
        if (j->is_heavy)
            mend(j);
        weigh(bodies, j, h);
        if (breaks(j))
            fp3_joint_drop(bodies, i);
    }
}
