/* SPDX-License-Identifier: Apache-2.0 */
/* joints3.c - joints in space, and their rows.
 *
 * A joint is made of up to four laws: pin3 holds a point, spin3 a turn, line3 a distance or a way,
 * twist3 an angle. What a law must leave free, a line or an axis, is left out of the matrix of the
 * masses that it feels. Arms, errors and masses are made anew in each substep, here, for every
 * engine.
 */
#include "passing.h"
#include "share.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Springs that hold, as in a plane (joint_rows.c), but softer: with 90 Hz four welded boxes that
 * stick out of a wall swing more and more. */
#define STIFFNESS 60.0
#define RESOLVED 0.25
#define DAMPING 5.0

#define LAW(name) (FP3_LAW_##name - FP3_LAW_pin3)

/* ---- before a step ---- */

static const size_t sizes[FP3_JOINT_LAWS3] = {
    [LAW(pin3)] = sizeof(fp3_pin3_row),
    [LAW(spin3)] = sizeof(fp3_spin3_row),
    [LAW(line3)] = sizeof(fp3_line3_row),
    [LAW(twist3)] = sizeof(fp3_twist3_row),
};

/* Springs of all three angles stay with the passes: they are a matrix of what they feel. */
static int is_found_at_once(const fp3_joint *j, int law) {
    return j->is_heavy && (law != LAW(spin3) || fp3_space_holds_turn(&j->def));
}

static fp3_status lay(fp3_bodies *bodies, int law) {
    fp3_law_rows *rows = &bodies->space->joined[law];
    fp3_status status = fp3_bodies_room((void **)&rows->of, &rows->of_room, sizeof *rows->of,
                                        bodies->joint_count + 1u, bodies->error);
    if (!status)
        status = fp3_rows_make_room(bodies, rows, bodies->joint_count);
    rows->is_same = 1;
    for (uint32_t i = 0; !status && i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (!(j->generation & 1) || !(j->laws >> law & 1) || is_found_at_once(j, law))
            continue;
        const uint32_t a = fp3_slot_of(bodies, j->a), b = fp3_slot_of(bodies, j->b);
        if (a >= bodies->movable && b >= bodies->movable)
            continue;
        rows->is_same &= fp3_rows_put(rows, rows->count, a, b);
        rows->of[rows->count++] = i;
    }
    if (!status && rows->count)
        status = fp3_rows_lay(bodies, rows, rows->a, rows->b, sizes[law]);
    return status ? status : fp3_cut_rows(bodies, rows);
}

fp3_softness fp3_space_firm(double h) {
    return fp3_soften(fmax(RESOLVED / h, fmin(STIFFNESS, 1 / h)), DAMPING, h);
}

fp3_status fp3_space_joints_begin(fp3_bodies *bodies) {
    fp3_space *s = bodies->space;
    fp3_status status = fp3_bodies_room((void **)&s->stance, &s->stance_room, sizeof *s->stance,
                                        bodies->joint_count + 1u, bodies->error);
    for (int law = 0; !status && law < FP3_JOINT_LAWS3; law++) {
        s->joined[law].count = 0;
        if (bodies->joints)
            status = lay(bodies, law);
    }
    return status;
}

/* ---- in a substep ---- */

typedef struct {
    const fp3_joint *joint;
    const fp3_joint3 *space;
    const fp3_stance3 *stance;
    float ma, mb;
    fp3_softness firm, spring; /* of what is held; of its spring */
    double h;
    float farthest;
    uint32_t number, lane;
    int is_first; /* impulses are those of the step before */
} filling;

#define PUT3(row, name, lane, p)                                                                   \
    do {                                                                                           \
        fp3_put(&(row)->name##_x, lane, (p).x);                                                    \
        fp3_put(&(row)->name##_y, lane, (p).y);                                                    \
        fp3_put(&(row)->name##_z, lane, (p).z);                                                    \
    } while (0)

/* A symmetric matrix by its diagonal and by xy, xz, yz. */
#define PUT6(row, i, o, lane, t)                                                                   \
    do {                                                                                           \
        PUT3(row, i, lane, fp3_point3_of(t));                                                      \
        PUT3(row, o, lane, fp3_point3_of((t) + 3));                                                \
    } while (0)

#define PUT_INERTIAS(row, f)                                                                       \
    do {                                                                                           \
        PUT6(row, ia, oa, (f)->lane, (f)->stance->back_a);                                         \
        PUT6(row, ib, ob, (f)->lane, (f)->stance->back_b);                                         \
    } while (0)

#define PUT_MASSES(row, f)                                                                         \
    do {                                                                                           \
        fp3_put(&(row)->ma, (f)->lane, (f)->ma);                                                   \
        fp3_put(&(row)->mb, (f)->lane, (f)->mb);                                                   \
        PUT_INERTIAS(row, f);                                                                      \
    } while (0)

#define PUT_SOFTNESS(row, f, s)                                                                    \
    do {                                                                                           \
        fp3_put(&(row)->rate, (f)->lane, (s).rate);                                                \
        fp3_put(&(row)->soft, (f)->lane, (s).soft);                                                \
        fp3_put(&(row)->fade, (f)->lane, (s).fade);                                                \
    } while (0)

/* The inverse of a symmetric matrix without what is along `free` (NULL: all of it counts): with a
 * large number there the inverse has nothing but its reciprocal there, which is taken off again. */
static void invert(const double k[6], const fp3_point3 *is_free, float to[6]) {
    const double n[3] = {is_free ? is_free->x : 0, is_free ? is_free->y : 0,
                         is_free ? is_free->z : 0};
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    const double trace = (k[0] + k[1]) + k[2];
    const double kn[3] = {(k[0] * n[0] + k[3] * n[1]) + k[4] * n[2],
                          (k[3] * n[0] + k[1] * n[1]) + k[5] * n[2],
                          (k[4] * n[0] + k[5] * n[1]) + k[2] * n[2]};
    const double nkn = (n[0] * kn[0] + n[1] * kn[1]) + n[2] * kn[2];
    double m[6]; /* P k P + trace n n', with P = 1 - n n' */
    for (int i = 0; i < 6; i++) {
        const double a = n[row[i]], b = n[column[i]];
        m[i] = ((k[i] - a * kn[column[i]]) - kn[row[i]] * b) + (nkn + trace) * (a * b);
    }
    const double c[6] = {m[1] * m[2] - m[5] * m[5], m[0] * m[2] - m[4] * m[4],
                         m[0] * m[1] - m[3] * m[3], m[4] * m[5] - m[3] * m[2],
                         m[3] * m[5] - m[4] * m[1], m[3] * m[4] - m[0] * m[5]};
    const double det = (m[0] * c[0] + m[3] * c[3]) + m[4] * c[4];
    for (int i = 0; i < 6; i++)
        to[i] = det > 0 && trace > 0
                    ? (float)(c[i] / det - (is_free ? n[row[i]] * n[column[i]] / trace : 0))
                    : 0;
}

/* m - [r] t [r], of one body: what an impulse at an arm does to the speed there. */
static void add_arm(const float t[6], fp3_point3 r, double k[6]) {
    const fp3_point3 x = {0, r.z, -r.y}, y = {-r.z, 0, r.x}, z = {r.y, -r.x, 0}; /* r x unit */
    const fp3_point3 tx = fp3_tensor3(t, x), ty = fp3_tensor3(t, y), tz = fp3_tensor3(t, z);
    const double more[6] = {fp3_dot3(x, tx), fp3_dot3(y, ty), fp3_dot3(z, tz),
                            fp3_dot3(x, ty), fp3_dot3(x, tz), fp3_dot3(y, tz)};
    for (int i = 0; i < 6; i++)
        k[i] += more[i];
}

#define VECTOR(row, name, lane)                                                                    \
    ((fp3_point3){(row)->name##_x[lane], (row)->name##_y[lane], (row)->name##_z[lane]})

/* Impulses stay square to what is free, which turns with a: what they would have along it would
 * drive it. */
static fp3_point3 without(fp3_point3 p, fp3_point3 axis) {
    return fp3_along3(p, -fp3_dot3(p, axis), axis);
}

static void fill_pin(const filling *f, fp3_pin3_row *row) {
    const fp3_stance3 *s = f->stance;
    const double m = (double)f->ma + f->mb;
    double k[6] = {m, m, m, 0, 0, 0};
    float inverse[6];
    const int is_line = fp3_is_on_line3(f->joint->def.type);
    const fp3_point3 arm_a = is_line ? fp3_add3(s->arm_a, s->gap) : s->arm_a;
    const fp3_point3 gap =
        is_line ? fp3_along3(s->gap, -fp3_dot3(s->gap, s->axis), s->axis) : s->gap;
    add_arm(s->back_a, arm_a, k);
    add_arm(s->back_b, s->arm_b, k);
    invert(k, is_line ? &s->axis : NULL, inverse);
    PUT_MASSES(row, f);
    PUT3(row, a, f->lane, arm_a);
    PUT3(row, b, f->lane, s->arm_b);
    PUT3(row, gap, f->lane, fp3_at_most3(gap, f->farthest));
    PUT6(row, j, k, f->lane, inverse);
    PUT_SOFTNESS(row, f, f->firm);
    const fp3_point3 p = f->is_first ? fp3_point3_of(f->space->pin) : VECTOR(row, p, f->lane);
    PUT3(row, p, f->lane, is_line ? without(p, s->axis) : p);
}

static void fill_spin(const filling *f, fp3_spin3_row *row) {
    const fp3_stance3 *s = f->stance;
    const fp3_joint_type type = f->joint->def.type;
    const int is_free = type == FP3_HINGE || type == FP3_WHEEL;
    const int is_spring = type == FP3_BALL || (type == FP3_WELD && f->joint->def.hertz > 0);
    double k[6];
    float inverse[6];
    for (int i = 0; i < 6; i++)
        k[i] = (double)s->back_a[i] + s->back_b[i];
    invert(k, !is_free ? NULL : type == FP3_WHEEL ? &s->axle : &s->axis, inverse);
    PUT_INERTIAS(row, f);
    const fp3_point3 error = is_free ? s->lean : s->error;
    PUT3(row, gap, f->lane, is_spring ? error : fp3_at_most3(error, FP3_FARTHEST_TURN3));
    PUT6(row, j, k, f->lane, inverse);
    fp3_put(&row->firm, f->lane, is_spring ? 0 : 1);
    PUT_SOFTNESS(row, f, is_spring ? f->spring : f->firm);
    const fp3_point3 p = f->is_first ? fp3_point3_of(f->space->spin) : VECTOR(row, p, f->lane);
    PUT3(row, p, f->lane, is_free ? without(p, type == FP3_WHEEL ? s->axle : s->axis) : p);
}

/* Limits, motor, spring or lock, in line3 and twist3. */
#define PUT_DRIVE(row, f, d, impulses)                                                             \
    do {                                                                                           \
        fp3_put(&(row)->j, (f)->lane, (d)->mass);                                                  \
        fp3_put(&(row)->firm, (f)->lane, (d)->is_firm ? 1 : 0);                                    \
        PUT_SOFTNESS(row, f, (d)->soft);                                                           \
        fp3_put(&(row)->off, (f)->lane, (d)->off);                                                 \
        fp3_put(&(row)->speed, (f)->lane, (d)->speed);                                             \
        fp3_put(&(row)->most, (f)->lane, (d)->most);                                               \
        fp3_put(&(row)->over, (f)->lane, (d)->over);                                               \
        fp3_put(&(row)->under, (f)->lane, (d)->under);                                             \
        fp3_put(&(row)->hold, (f)->lane, (f)->firm.rate);                                          \
        fp3_put(&(row)->give, (f)->lane, (f)->firm.soft);                                          \
        if ((f)->is_first) {                                                                       \
            fp3_put(&(row)->s, (f)->lane, (impulses)[0]);                                          \
            fp3_put(&(row)->m, (f)->lane, (impulses)[1]);                                          \
            fp3_put(&(row)->l, (f)->lane, (impulses)[2]);                                          \
            fp3_put(&(row)->u, (f)->lane, (impulses)[3]);                                          \
        }                                                                                          \
    } while (0)

static float inverse_of(float x) { return x > 0 ? 1 / x : 0; }

void fp3_drive_use(fp3_drive3 *d, const fp3_joint_def *def, int uses, double where, double far,
                   double h) {
    const int has_limits = uses & FP3_USES_LIMITS && def->has_limits;
    if (d->is_firm)
        d->soft = fp3_space_firm(h);
    else if (uses & FP3_USES_SPRING && def->hertz > 0)
        d->soft = fp3_soften(def->hertz, def->damping, h);
    d->off = (float)(d->is_firm ? fp3_within(where - def->rest, far) : where - def->rest);
    d->speed = (float)def->speed;
    d->most = uses & FP3_USES_MOTOR ? (float)(def->most * h) : 0;
    d->over = has_limits ? (float)fmax(where - def->low, -far) : FP3_NO_LIMIT3;
    d->under = has_limits ? (float)fmax(def->high - where, -far) : FP3_NO_LIMIT3;
}

fp3_drive3 fp3_space_drive_along(const fp3_bodies *bodies, uint32_t number, double h) {
    const fp3_joint *j = &bodies->joint[number];
    const fp3_stance3 *s = &bodies->space->stance[number];
    const float size = fp3_size3(s->gap);
    const int is_rod = j->def.type == FP3_ROD;
    fp3_drive3 d = {.n = !is_rod    ? s->axis
                         : size > 0 ? fp3_times3(1 / size, s->gap)
                                    : (fp3_point3){0, 1, 0},
                    .arm_a = is_rod ? s->arm_a : fp3_add3(s->arm_a, s->gap),
                    .is_firm = is_rod && !(j->def.hertz > 0) && !j->def.has_limits};
    const fp3_point3 a = fp3_cross3(d.arm_a, d.n), b = fp3_cross3(s->arm_b, d.n);
    d.mass = inverse_of(
        (fp3_inverse_mass(bodies->body[j->a].mass) + fp3_inverse_mass(bodies->body[j->b].mass)) +
        fp3_dot3(a, fp3_tensor3(s->back_a, a)) + fp3_dot3(b, fp3_tensor3(s->back_b, b)));
    fp3_drive_use(&d, &j->def,
                  j->def.type == FP3_WHEEL ? FP3_USES_SPRING | FP3_USES_LIMITS : FP3_USES_ALL,
                  fp3_stance_at(s, j->def.type), FP3_FARTHEST3 * bodies->def.size, h);
    return d;
}

fp3_drive3 fp3_space_drive_about(const fp3_bodies *bodies, uint32_t number, double h) {
    const fp3_joint *j = &bodies->joint[number];
    const fp3_stance3 *s = &bodies->space->stance[number];
    const fp3_joint_type type = j->def.type;
    const float size = fp3_size3(s->lean);
    fp3_drive3 d = {.n = type == FP3_BALL ? (size > 0 ? fp3_times3(1 / size, s->lean) : s->axle)
                                          : (type == FP3_WHEEL ? s->axle : s->axis)};
    d.mass = inverse_of(fp3_dot3(d.n, fp3_tensor3(s->back_a, d.n)) +
                        fp3_dot3(d.n, fp3_tensor3(s->back_b, d.n)));
    fp3_drive_use(&d, &j->def,
                  type == FP3_HINGE  ? FP3_USES_ALL
                  : type == FP3_BALL ? FP3_USES_LIMITS
                                     : FP3_USES_MOTOR,
                  type == FP3_BALL ? s->swing : s->about, FP3_FARTHEST_TURN3, h);
    if (type == FP3_BALL) /* nothing is nearer to the axis than 0 */
        d.over = FP3_NO_LIMIT3;
    return d;
}

static void fill_line(const fp3_bodies *bodies, const filling *f, fp3_line3_row *row) {
    const fp3_drive3 d = fp3_space_drive_along(bodies, f->number, f->h);
    PUT_MASSES(row, f);
    PUT3(row, n, f->lane, d.n);
    PUT3(row, a, f->lane, fp3_cross3(d.arm_a, d.n));
    PUT3(row, b, f->lane, fp3_cross3(f->stance->arm_b, d.n));
    PUT_DRIVE(row, f, &d, f->space->line);
}

static void fill_twist(const fp3_bodies *bodies, const filling *f, fp3_twist3_row *row) {
    const fp3_drive3 d = fp3_space_drive_about(bodies, f->number, f->h);
    PUT_INERTIAS(row, f);
    PUT3(row, n, f->lane, d.n);
    PUT_DRIVE(row, f, &d, f->space->twist);
}

static void fill(const fp3_bodies *bodies, int law, uint32_t i, filling *f) {
    const fp3_law_rows *rows = &bodies->space->joined[law];
    const uint32_t block = rows->lane[i] / FP3_WIDE;
    f->lane = rows->lane[i] % FP3_WIDE;
    if (law == LAW(pin3))
        fill_pin(f, (fp3_pin3_row *)rows->row + block);
    else if (law == LAW(spin3))
        fill_spin(f, (fp3_spin3_row *)rows->row + block);
    else if (law == LAW(line3))
        fill_line(bodies, f, (fp3_line3_row *)rows->row + block);
    else
        fill_twist(bodies, f, (fp3_twist3_row *)rows->row + block);
}

/* Joints from .. to - 1 whose rows this process passes over, or the others. */
static void stand(fp3_bodies *bodies, uint32_t from, uint32_t to, int is_own, int has_way) {
    for (uint32_t i = from; i < to; i++) {
        const fp3_joint *j = &bodies->joint[i];
        const uint32_t a = fp3_slot_of(bodies, j->a), b = fp3_slot_of(bodies, j->b);
        if (j->generation & 1 && (a < bodies->movable || b < bodies->movable) &&
            fp3_share_has(bodies, a, b) == is_own)
            bodies->space->stance[i] = fp3_space_stance(bodies, i, has_way);
    }
}

void fp3_space_joints_stand(fp3_bodies *bodies) {
    if (bodies->share)
        stand(bodies, 0, bodies->joint_count, 0, 1);
}

void fp3_space_joints_stand_some(void *of, uint32_t from, uint32_t to) {
    stand(of, from, to, 1, 1);
}

static void stand_first(void *of, uint32_t from, uint32_t to) { stand(of, from, to, 1, 0); }

typedef struct {
    const fp3_bodies *bodies;
    int law, is_first;
} filling_of;

/* Blocks from .. to - 1. */
static void fill_blocks(void *of, uint32_t from, uint32_t to) {
    const filling_of *all = of;
    const fp3_bodies *bodies = all->bodies;
    const fp3_space *s = bodies->space;
    const fp3_law_rows *rows = &s->joined[all->law];
    const double h = bodies->def.h / bodies->def.substeps;
    const fp3_softness firm = fp3_space_firm(h);
    for (uint32_t k = from * FP3_WIDE; k < to * FP3_WIDE; k++) {
        const uint32_t i = rows->at[k];
        if (i == FP3_NOBODY || !fp3_share_has(bodies, rows->a[i], rows->b[i]))
            continue;
        const uint32_t number = rows->of[i];
        const fp3_joint *j = &bodies->joint[number];
        filling f = {.joint = j,
                     .number = number,
                     .space = &s->joint[number],
                     .stance = &s->stance[number],
                     .ma = fp3_inverse_mass(bodies->body[j->a].mass),
                     .mb = fp3_inverse_mass(bodies->body[j->b].mass),
                     .firm = firm,
                     .spring = fp3_soften(j->def.hertz, j->def.damping, h),
                     .h = h,
                     .farthest = FP3_FARTHEST3 * (float)bodies->def.size,
                     .is_first = all->is_first};
        fill(bodies, all->law, i, &f);
    }
}

static void fill_rows(const fp3_bodies *bodies, uint32_t from, uint32_t to, int is_first) {
    for (int law = 0; law < FP3_JOINT_LAWS3; law++) {
        filling_of all = {bodies, law, is_first};
        if (bodies->space->joined[law].count)
            fp3_rows_of(bodies, &bodies->space->joined[law], from, to, fill_blocks, &all);
    }
}

void fp3_space_joints_fill_some(void *of, uint32_t from, uint32_t to) {
    fill_rows(of, from, to, 0);
}

static void fill_first(void *of, uint32_t from, uint32_t to) { fill_rows(of, from, to, 1); }

void fp3_space_joints_first(fp3_bodies *bodies) {
    const uint32_t parts = fp3_threads_parts(bodies->crew, bodies->joint_count, FP3_LEAST_STANCES);
    fp3_threads_share(bodies->crew, (fp3_lap){stand_first, bodies, 0, bodies->joint_count, parts});
    fp3_threads_share(bodies->crew, (fp3_lap){fill_first, bodies, 0, bodies->cuts, parts});
}

/* ---- after a step ---- */

#define AT3(row, lane)                                                                             \
    FP3_WORD_OF((row)->p_x, lane), FP3_WORD_OF((row)->p_y, lane), FP3_WORD_OF((row)->p_z, lane)
#define AT4(row, lane)                                                                             \
    FP3_WORD_OF((row)->s, lane), FP3_WORD_OF((row)->m, lane), FP3_WORD_OF((row)->l, lane),         \
        FP3_WORD_OF((row)->u, lane)

fp3_impulses3 fp3_space_impulses(const fp3_law_rows *rows, int law, uint32_t i) {
    const uint32_t block = rows->lane[i] / FP3_WIDE, lane = rows->lane[i] % FP3_WIDE;
    enum { SPRING = 1, MOTOR = 2, ALL = 7 };
    if (law == LAW(pin3)) {
        fp3_pin3_row *row = (fp3_pin3_row *)rows->row + block;
        return (fp3_impulses3){{AT3(row, lane)}, 3, 0};
    }
    if (law == LAW(spin3)) {
        fp3_spin3_row *row = (fp3_spin3_row *)rows->row + block;
        return (fp3_impulses3){{AT3(row, lane)}, 3, row->firm[lane] != 0 ? 0 : ALL};
    }
    if (law == LAW(line3)) {
        fp3_line3_row *row = (fp3_line3_row *)rows->row + block;
        return (fp3_impulses3){{AT4(row, lane)}, 4, row->firm[lane] != 0 ? MOTOR : MOTOR | SPRING};
    }
    fp3_twist3_row *row = (fp3_twist3_row *)rows->row + block;
    return (fp3_impulses3){{AT4(row, lane)}, 4, row->firm[lane] != 0 ? MOTOR : MOTOR | SPRING};
}

/* What is no number is forgotten, so that a joint of a body that failed goes on. */
static void mend(float *impulse, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(impulse[i]))
            impulse[i] = 0;
}
static void mend_all(fp3_joint3 *j) {
    mend(j->pin, 3);
    mend(j->spin, 3);
    mend(j->line, 4);
    mend(j->twist, 4);
}

static void keep(const fp3_bodies *bodies, int law, uint32_t i) {
    const fp3_law_rows *rows = &bodies->space->joined[law];
    fp3_joint3 *j = &bodies->space->joint[rows->of[i]];
    const fp3_impulses3 p = fp3_space_impulses(rows, law, i);
    float *const to = law == LAW(pin3)    ? j->pin
                      : law == LAW(spin3) ? j->spin
                      : law == LAW(line3) ? j->line
                                          : j->twist;
    for (uint32_t k = 0; k < p.count; k++)
        to[k] = *p.word[k];
}

static float sum(const float impulse[4]) {
    return impulse[0] + impulse[1] + impulse[2] - impulse[3];
}

/* What the joint did to b. */
static void weigh(const fp3_bodies *bodies, uint32_t number, double h) {
    fp3_joint3 *j = &bodies->space->joint[number];
    const fp3_joint_type type = bodies->joint[number].def.type;
    const fp3_stance3 *s = &bodies->space->stance[number];
    const float size = fp3_size3(s->gap), lean = fp3_size3(s->lean), back = (float)(1 / h);
    const fp3_point3 line = type != FP3_ROD ? s->axis
                            : size > 0      ? fp3_times3(1 / size, s->gap)
                                            : (fp3_point3){0, 1, 0};
    const fp3_point3 axis = type == FP3_WHEEL  ? s->axle
                            : type != FP3_BALL ? s->axis
                            : lean > 0         ? fp3_times3(1 / lean, s->lean)
                                               : s->axle;
    const fp3_point3 force = fp3_along3(fp3_point3_of(j->pin), sum(j->line), line);
    fp3_point3 torque = fp3_along3(fp3_point3_of(j->spin), sum(j->twist), axis);
    /* About the anchor that the caller knows. */
    const double moved[3] = {j->anchor_b[0] - bodies->joint[number].def.anchor_b[0],
                             j->anchor_b[1] - bodies->joint[number].def.anchor_b[1],
                             j->anchor_b[2] - bodies->joint[number].def.anchor_b[2]};
    double arm[3];
    fp3_turned3_by(bodies->space->body[bodies->joint[number].b].q, moved, arm);
    torque = fp3_add3(torque,
                      fp3_cross3((fp3_point3){(float)arm[0], (float)arm[1], (float)arm[2]}, force));
    const float forces[3] = {back * force.x, back * force.y, back * force.z},
                torques[3] = {back * torque.x, back * torque.y, back * torque.z};
    memcpy(j->force, forces, sizeof forces);
    memcpy(j->torque, torques, sizeof torques);
}

void fp3_space_joints_end(fp3_bodies *bodies, double h) {
    for (int law = 0; law < FP3_JOINT_LAWS3; law++)
        for (uint32_t i = 0; i < bodies->space->joined[law].count; i++)
            keep(bodies, law, i);
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (!(j->generation & 1) || (fp3_slot_of(bodies, j->a) >= bodies->movable &&
                                     fp3_slot_of(bodies, j->b) >= bodies->movable))
            continue;
        mend_all(&bodies->space->joint[i]);
        weigh(bodies, i, h);
        const fp3_joint3 *space = &bodies->space->joint[i];
        const float force = fp3_size3(fp3_point3_of(space->force)),
                    torque = fp3_size3(fp3_point3_of(space->torque));
        if ((j->def.force > 0 && force > (float)j->def.force) ||
            (j->def.torque > 0 && torque > (float)j->def.torque))
            fp3_joint_drop(bodies, i);
    }
}
