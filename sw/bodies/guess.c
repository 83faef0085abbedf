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
    uint32_t first; /* of its bodies, in `slot`: up to those of the next one */
    float keep;     /* share of the guess that stays */
    int is_driven;  /* by the caller */
} island;

/* Islands stay from step to step while rows of joints do. */
struct fp3_guess {
    uint32_t *root;   /* of each slot that is joined: the lowest one of its island */
    uint32_t *number; /* ... of each slot that is joined: its island */
    uint32_t *slot;   /* those that are joined: island by island, ascending in each */
    fp3_four *before; /* of these: speeds */
    fp3_masses *mass; /* of these */
    island *of;       /* one more than there are */
    uint32_t count, islands;
    uint32_t movable, layings[FP3_JOINT_LAWS], rows[FP3_JOINT_LAWS]; /* which they are of */
    uint32_t root_room, number_room, slot_room, before_room, mass_room, of_room;
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
    if (!bodies->guess) {
        bodies->guess = calloc(1, sizeof *bodies->guess);
        if (bodies->guess)
            bodies->guess->movable = FP3_NOBODY;
    }
    fp3_guess *g = bodies->guess;
    if (!g)
        return fp3_no_memory(bodies->error);
    const size_t count = bodies->movable + 1u;
    const struct {
        void **array;
        uint32_t *room;
        size_t size;
    } arrays[] = {{(void **)&g->root, &g->root_room, sizeof *g->root},
                  {(void **)&g->number, &g->number_room, sizeof *g->number},
                  {(void **)&g->slot, &g->slot_room, sizeof *g->slot},
                  {(void **)&g->before, &g->before_room, fours_of(bodies) * sizeof *g->before},
                  {(void **)&g->mass, &g->mass_room, sizeof *g->mass},
                  {(void **)&g->of, &g->of_room, sizeof *g->of}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof arrays / sizeof *arrays; i++)
        status =
            fp3_bodies_room(arrays[i].array, arrays[i].room, arrays[i].size, count, bodies->error);
    return status;
}

/* Whether rows are those that islands were found of; from now on they are. */
static int are_known(const fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    int are = g->movable == bodies->movable;
    g->movable = bodies->movable;
    for (int law = 0; law < FP3_JOINT_LAWS; law++) {
        const fp3_law_rows *rows = rows_of(bodies, law);
        are &= g->layings[law] == rows->layings && g->rows[law] == rows->count;
        g->layings[law] = rows->layings;
        g->rows[law] = rows->count;
    }
    return are;
}

/* Islands by their lowest slots; by counting, each one's slots ascend. */
static void find_islands(const fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    for (uint32_t k = 0; k < bodies->movable; k++)
        g->root[k] = FP3_NOBODY;
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            unite(bodies, rows_of(bodies, law)->a[i], rows_of(bodies, law)->b[i]);
    g->count = g->islands = 0;
    for (uint32_t k = 0; k < bodies->movable; k++) {
        if (g->root[k] == FP3_NOBODY)
            continue;
        g->root[k] = root_of(g->root, k);
        if (g->root[k] == k)
            g->of[g->islands] = (island){.first = 0};
        g->number[k] = g->root[k] == k ? g->islands++ : g->number[g->root[k]];
        g->of[g->number[k]].first++;
        g->count++;
    }
    for (uint32_t i = 0, sum = 0; i <= g->islands; i++) {
        sum += i < g->islands ? g->of[i].first : 0;
        g->of[i].first = sum; /* where it ends, until all slots are there */
    }
    for (uint32_t k = bodies->movable; k-- > 0;)
        if (g->root[k] != FP3_NOBODY)
            g->slot[--g->of[g->number[k]].first] = k;
}

static island *island_of(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    return &bodies->guess->of[bodies->guess->number[a < bodies->movable ? a : b]];
}

static int goes(const fp3_bodies *bodies, uint32_t slot) {
    return slot > bodies->movable && fp3_body_goes(bodies, bodies->in_slot[slot]);
}

static void find_driven(const fp3_bodies *bodies) {
    for (uint32_t i = 0; i < bodies->guess->islands; i++)
        bodies->guess->of[i].is_driven = 0;
    if (bodies->slots == bodies->movable + 1) /* nothing is moved by the caller */
        return;
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++) {
            const uint32_t a = rows_of(bodies, law)->a[i], b = rows_of(bodies, law)->b[i];
            island_of(bodies, a, b)->is_driven |= goes(bodies, a) || goes(bodies, b);
        }
}

static double over_one(float inverse) { return inverse > 0 ? 1 / (double)inverse : 0; }

static void weigh(const fp3_bodies *bodies) {
    const fp3_guess *g = bodies->guess;
    for (uint32_t k = 0; k < g->count; k++) {
        const fp3_four *heft = &bodies->heft[fours_of(bodies) * g->slot[k]];
        const double m = over_one((*heft)[0]);
        g->mass[k] = (fp3_masses){m, m, bodies->space ? m : over_one((*heft)[1]), 0};
    }
}

fp3_status fp3_guess_begin(fp3_bodies *bodies) {
    if (!bodies->joints) {
        if (bodies->guess)
            bodies->guess->count = bodies->guess->islands = 0;
        return FP3_OK;
    }
    const fp3_status status = make_room(bodies);
    if (status)
        return status;
    if (!are_known(bodies))
        find_islands(bodies);
    find_driven(bodies);
    weigh(bodies);
    return FP3_OK;
}

int fp3_guess_has(const fp3_bodies *bodies) { return bodies->guess && bodies->guess->count; }

void fp3_guess_free(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    if (!g)
        return;
    free(g->root);
    free(g->number);
    free(g->slot);
    free(g->before);
    free(g->mass);
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

/* Of what turns in space. */
static void add_spin(const fp3_bodies *bodies, uint32_t k, fp3_energy *of) {
    const uint32_t slot = bodies->guess->slot[k];
    const fp3_four before = bodies->guess->before[FP3_FOURS3 * k + 1],
                   now = bodies->speed[FP3_FOURS3 * slot + 1];
    double mass[9];
    inertia_of(bodies, bodies->in_slot[slot], mass);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double m = mass[3 * i + j], v = (double)before[j],
                         by = (double)now[i] - (double)before[i];
            of->before += 0.5 * m * v * (double)before[i];
            of->first += m * v * by;
            of->second += 0.5 * m * by * ((double)now[j] - v);
        }
}

static void find_energy(const fp3_bodies *bodies, uint32_t first, uint32_t end, fp3_energy *to) {
    const fp3_guess *g = bodies->guess;
    const fp3_guessed of = {bodies->speed, g->before, g->slot, g->mass, fours_of(bodies)};
    bodies->solver->energy(&of, first, end, to);
    for (uint32_t k = first; k < end && bodies->space; k++)
        add_spin(bodies, k, to);
}

/* The share of the guess that adds no more than it may; of what is not finite all, so that a step
 * names who is not. */
static float share_of(const fp3_energy *of) {
    const double may = MOST * of->before;
    if (!(of->first + of->second > may) || !isfinite(of->first + of->second))
        return 1;
    return (float)((sqrt(of->first * of->first + 4 * of->second * may) - of->first) /
                   (2 * of->second));
}

static float *keep_of(const fp3_bodies *bodies, const fp3_law_rows *rows, uint32_t i) {
    return &island_of(bodies, rows->a[i], rows->b[i])->keep;
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

/* Whether a guess is made smaller. */
static int find_shares(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    int is_any = 0;
    for (uint32_t i = 0; i < g->islands; i++) {
        g->of[i].keep = 1;
        if (g->of[i].is_driven)
            continue;
        fp3_energy energy;
        find_energy(bodies, g->of[i].first, g->of[i + 1].first, &energy);
        is_any |= (g->of[i].keep = share_of(&energy)) < 1;
    }
    return is_any;
}

static void take_back(fp3_bodies *bodies, uint32_t first, uint32_t end, float keep) {
    const fp3_guess *g = bodies->guess;
    const uint32_t fours = fours_of(bodies);
    for (uint32_t k = first; k < end && keep < 1; k++)
        for (uint32_t i = 0; i < fours; i++) {
            const uint32_t at = fours * g->slot[k] + i;
            const fp3_four by = (keep - 1) * (bodies->speed[at] - g->before[fours * k + i]);
            bodies->speed[at] += by;
            bodies->base[at] += by;
        }
}

void fp3_guess_check(fp3_bodies *bodies) {
    fp3_guess *g = bodies->guess;
    if (!find_shares(bodies))
        return;
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            if (gives(bodies, law, i))
                *keep_of(bodies, rows_of(bodies, law), i) = 1;
    for (int law = 0; law < FP3_JOINT_LAWS; law++)
        for (uint32_t i = 0; i < rows_of(bodies, law)->count; i++)
            scale(bodies, law, i, *keep_of(bodies, rows_of(bodies, law), i));
    for (uint32_t i = 0; i < g->islands; i++)
        take_back(bodies, g->of[i].first, g->of[i + 1].first, g->of[i].keep);
}
