/* SPDX-License-Identifier: Apache-2.0 */
/* guess.c - see guess.h. */
#include "guess.h"

#include "own3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the kinetic energy that a guess may add: bodies that swing go to and fro between the
 * springs of their joints and speed. With 0 a double pendulum loses six times as much in a minute.
 */
#define MOST 0.02

typedef struct {
    double energy, first, second; /* of speeds before; of their change, in both orders */
    float keep;                   /* share of the guess that stays */
    int is_driven;                /* by the caller */
} island;

struct fp3_guess {
    uint32_t *root;   /* of each slot that is joined: the lowest one of its island */
    uint32_t *slot;   /* those that are joined, ascending */
    fp3_four *before; /* of these */
    island *of;       /* of each root */
    uint32_t count;
    uint32_t root_room, slot_room, before_room, of_room;
};

static uint32_t fours_of(const fp3_bodies *bodies) { return bodies->space ? FP3_FOURS3 : 1; }

static const fp3_law_rows *rows_of(const fp3_bodies *bodies, int law) {
    return bodies->space ? &bodies->space->joined[law] : &bodies->joined[law];
}
_Static_assert(FP3_JOINT_LAWS == FP3_JOINT_LAWS3, "as many laws of joints in space");

/* ---- of a step ---- */

static uint32_t root_of(uint32_t *root, uint32_t k) {
    while (root[k] != k)
        k = root[k] = root[root[k]];
    return k;
}

static void unite(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    fp3_guess *g = bodies->guess;
    const uint32_t slots[2] = {a, b};
    for (int i = 0; i < 2; i++)
        if (slots[i] < bodies->movable && g->root[slots[i]] == FP3_NOBODY)
            g->root[slots[i]] = slots[i];
    if (a >= bodies->movable || b >= bodies->movable)
        return;
    a = root_of(g->root, a);
    b = root_of(g->root, b);
    g->root[a < b ? b : a] = a < b ? a : b;
}

static fp3_status make_room(fp3_bodies *bodies) {
    if (!bodies->guess)
        bodies->guess = calloc(1, sizeof *bodies->guess);
    fp3_guess *g = bodies->guess;
    if (!g)
        return fp3_no_memory(bodies->error);
    const size_t count = bodies->movable + 1u;
    fp3_status status =
        fp3_bodies_room((void **)&g->root, &g->root_room, sizeof *g->root, count, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&g->slot, &g->slot_room, sizeof *g->slot, count,
                                 bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&g->before, &g->before_room, sizeof *g->before,
                                 fours_of(bodies) * count, bodies->error);
    if (!status)
        status = fp3_bodies_room((void **)&g->of, &g->of_room, sizeof *g->of, count, bodies->error);
    return status;
}

static int goes(const fp3_bodies *bodies, uint32_t slot) {
    return slot > bodies->movable && fp3_body_goes(bodies, bodies->in_slot[slot]);
}

static void drive(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    fp3_guess *g = bodies->guess;
    if (goes(bodies, a) || goes(bodies, b))
        g->of[g->root[a < bodies->movable ? a : b]].is_driven = 1;
}

fp3_status fp3_guess_begin(fp3_bodies *bodies) {
    if (bodies->guess)
        bodies->guess->count = 0;
    if (!bodies->joints)
        return FP3_OK;
    const fp3_status status = make_room(bodies);
    if (status)
        return status;
    fp3_guess *g = bodies->guess;
    for (uint32_t k = 0; k < bodies->movable; k++)
        g->root[k] = FP3_NOBODY;
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            unite(bodies, rows_of(bodies, law)->a[i], rows_of(bodies, law)->b[i]);
    for (uint32_t k = 0; k < bodies->movable; k++) {
        if (g->root[k] == FP3_NOBODY)
            continue;
        g->root[k] = root_of(g->root, k);
        g->of[g->root[k]].is_driven = 0;
        g->slot[g->count++] = k;
    }
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            drive(bodies, rows_of(bodies, law)->a[i], rows_of(bodies, law)->b[i]);
    return FP3_OK;
}

int fp3_guess_has(const fp3_bodies *bodies) { return bodies->guess && bodies->guess->count; }

void fp3_guess_free(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    if (!g)
        return;
    free(g->root);
    free(g->slot);
    free(g->before);
    free(g->of);
    free(g);
    bodies->guess = NULL;
}

/* ---- of a substep ---- */

void fp3_guess_note(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    const uint32_t fours = fours_of(bodies);
    for (uint32_t k = 0; k < g->count; k++)
        memcpy(&g->before[fours * k], &bodies->speed[fours * g->slot[k]],
               fours * sizeof *g->before);
}

/* Of `count` numbers of a speed, with a symmetric matrix of masses. */
static void add_energy(const double *mass, const fp3_four before, const fp3_four now, int count,
                       island *of) {
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++) {
            const double m = mass[count * i + k], v = (double)before[k],
                         by = (double)now[i] - (double)before[i];
            of->energy += 0.5 * m * v * (double)before[i];
            of->first += m * v * by;
            of->second += 0.5 * m * by * ((double)now[k] - v);
        }
}

static double over_one(float inverse) { return inverse > 0 ? 1 / (double)inverse : 0; }

/* The inertia of a body in space as joints feel it now; 0: it does not turn. */
static void inertia_of(const fp3_bodies *bodies, uint32_t number, double to[9]) {
    float t[6];
    memset(to, 0, 9 * sizeof *to);
    if (!(bodies->space->body[number].moment[0] > 0))
        return;
    fp3_space_back(bodies, number, 1, t);
    const double xx = t[0], yy = t[1], zz = t[2], xy = t[3], xz = t[4], yz = t[5];
    const double c[6] = {yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy,
                         yz * xz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
    const double det = (xx * c[0] + xy * c[3]) + xz * c[4];
    static const int at[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
    for (int i = 0; i < 9 && det > 0; i++)
        to[i] = c[at[i]] / det;
}

static void add_body(const fp3_bodies *bodies, uint32_t k, island *of) {
    const uint32_t slot = bodies->guess->slot[k], fours = fours_of(bodies);
    const fp3_four *before = &bodies->guess->before[fours * k], *now = &bodies->speed[fours * slot];
    const double m = over_one(bodies->heft[fours * slot][0]);
    double mass[9] = {m, 0, 0, 0, m, 0, 0, 0, bodies->space ? m : over_one(bodies->heft[slot][1])};
    add_energy(mass, before[0], now[0], 3, of);
    if (bodies->space) {
        inertia_of(bodies, bodies->in_slot[slot], mass);
        add_energy(mass, before[1], now[1], 3, of);
    }
}

/* The share of the guess that adds no more than it may. */
static float share_of(const island *of) {
    const double may = MOST * of->energy;
    if (!(of->first + of->second > may) || of->is_driven)
        return 1;
    return (float)((sqrt(of->first * of->first + 4 * of->second * may) - of->first) /
                   (2 * of->second));
}

static float *keep_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t i) {
    const uint32_t slot = rows->a[i] < bodies->movable ? rows->a[i] : rows->b[i];
    return &bodies->guess->of[bodies->guess->root[slot]].keep;
}

static int gives(const fp3_bodies *bodies, int law, uint32_t i) {
    if (!bodies->space)
        return fp3_joint_gives(bodies, law, i);
    const fp3_impulses3 p = fp3_space_impulses(rows_of(bodies, law), law, i);
    int is_any = 0;
    for (uint32_t k = 0; k < p.count; k++)
        is_any |= (p.gives >> k & 1) && *p.word[k] != 0;
    return is_any;
}

static void scale(fp3_bodies *bodies, int law, uint32_t i, float by) {
    if (!bodies->space) {
        fp3_joint_scale(bodies, law, i, by);
        return;
    }
    const fp3_impulses3 p = fp3_space_impulses(rows_of(bodies, law), law, i);
    for (uint32_t k = 0; k < p.count && by < 1; k++)
        *p.word[k] *= by;
}

void fp3_guess_check(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    const uint32_t fours = fours_of(bodies);
    int is_any = 0;
    for (uint32_t k = 0; k < g->count; k++) {
        island *of = &g->of[g->root[g->slot[k]]];
        if (g->root[g->slot[k]] == g->slot[k])
            *of = (island){.is_driven = of->is_driven};
        add_body(bodies, k, of);
    }
    for (uint32_t k = 0; k < g->count; k++) {
        island *of = &g->of[g->slot[k]];
        if (g->root[g->slot[k]] == g->slot[k])
            is_any |= (of->keep = share_of(of)) < 1;
    }
    for (int law = 0; law < FP3_JOINT_LAWS && is_any; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            if (gives(bodies, law, i))
                *keep_of(bodies, rows_of(bodies, law), i) = 1;
    for (int law = 0; law < FP3_JOINT_LAWS && is_any; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            scale(bodies, law, i, *keep_of(bodies, rows_of(bodies, law), i));
    for (uint32_t k = 0; k < g->count && is_any; k++) {
        const uint32_t slot = g->slot[k];
        const float keep = g->of[g->root[slot]].keep;
        if (!(keep < 1))
            continue;
        for (uint32_t i = 0; i < fours; i++) {
            const fp3_four by =
                (keep - 1) * (bodies->speed[fours * slot + i] - g->before[fours * k + i]);
            bodies->speed[fours * slot + i] += by;
            bodies->base[fours * slot + i] += by;
        }
    }
}
