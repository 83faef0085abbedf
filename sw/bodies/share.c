/* SPDX-License-Identifier: Apache-2.0 */
/* share.c - see share.h. */
#include "share.h"
#include "own3.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- what passes change of a row ---- */

#define AT(type, word) offsetof(fp3_##type##_row, word) / sizeof(fp3_wide)
#define TURNS(type) AT(type, s), AT(type, m), AT(type, l), AT(type, u)
#define OF_POINT(k) AT(contact3, point[k].p), AT(contact3, point[k].top)

typedef struct {
    size_t size; /* of a block */
    uint32_t count, word[14];
} changed;

static const changed contact2 = {sizeof(fp3_contact2_row),
                                 7,
                                 {AT(contact2, p1), AT(contact2, f1), AT(contact2, p2),
                                  AT(contact2, f2), AT(contact2, r), AT(contact2, top1),
                                  AT(contact2, top2)}};
static const changed contact3 = {sizeof(fp3_contact3_row),
                                 14,
                                 {OF_POINT(0), OF_POINT(1), OF_POINT(2), OF_POINT(3),
                                  AT(contact3, f1), AT(contact3, f2), AT(contact3, ft),
                                  AT(contact3, l_x), AT(contact3, l_y), AT(contact3, l_z)}};

#define LAW(name) [FP3_LAW_##name - FP3_LAW_twist2]
static const changed joint2[FP3_JOINT_LAWS] = {
    LAW(twist2) = {sizeof(fp3_twist2_row), 4, {TURNS(twist2)}},
    LAW(slide2) = {sizeof(fp3_slide2_row), 5, {TURNS(slide2), AT(slide2, p)}},
    LAW(rod2) = {sizeof(fp3_rod2_row), 4, {TURNS(rod2)}},
    LAW(pin2) = {sizeof(fp3_pin2_row), 2, {AT(pin2, p_x), AT(pin2, p_y)}},
};
#undef LAW
#define LAW(name) [FP3_LAW_##name - FP3_LAW_pin3]
static const changed joint3[FP3_JOINT_LAWS3] = {
    LAW(pin3) = {sizeof(fp3_pin3_row), 3, {AT(pin3, p_x), AT(pin3, p_y), AT(pin3, p_z)}},
    LAW(spin3) = {sizeof(fp3_spin3_row), 3, {AT(spin3, p_x), AT(spin3, p_y), AT(spin3, p_z)}},
    LAW(line3) = {sizeof(fp3_line3_row), 4, {TURNS(line3)}},
    LAW(twist3) = {sizeof(fp3_twist3_row), 4, {TURNS(twist3)}},
};

/* ---- ranks ---- */

#define EVERYBODY UINT32_MAX

struct fp3_share {
    fp3_ranks ranks;
    uint32_t *root, *weight; /* of each slot its island's first one; of this one the rows */
    uint32_t *whose, *were;  /* of each slot a rank; before this step. EVERYBODY: it has no rows */
    uint32_t *island;        /* islands that have rows, by their first slots */
    uint32_t root_room, weight_room, whose_room, were_room, island_room;
    uint32_t islands, movable, number;
    uint64_t *load, *rows; /* of each rank the rows of this step, and of all */
    uint64_t sent;
    /* What this rank sends, and what all do: words of slots, words of rows. */
    float *own, *all, **at;
    uint64_t *bytes;
    uint32_t own_room, all_room;
};

fp3_share_use fp3_share_used(const fp3_bodies *bodies) {
    const fp3_share *s = bodies->share;
    return s ? (fp3_share_use){s->ranks.count, s->rows, s->sent} : (fp3_share_use){0};
}

uint32_t fp3_share_number(const fp3_bodies *bodies) {
    return bodies->share ? bodies->share->number : 0;
}

fp3_status fp3_share_agree(fp3_bodies *bodies, fp3_status status) {
    const fp3_share *s = bodies->share;
    const fp3_status most =
        s ? (fp3_status)s->ranks.calls->most(s->ranks.world, (uint64_t)status) : status;
    return most && !status ? fp3_fail(bodies->error, most, "another rank could not make a step")
                           : most;
}

static fp3_status make_arrays(fp3_bodies *bodies) {
    fp3_share *s = bodies->share;
    const uint32_t ranks = s->ranks.count;
    s->load = calloc(ranks, sizeof *s->load);
    s->rows = calloc(ranks, sizeof *s->rows);
    s->bytes = calloc(ranks, sizeof *s->bytes);
    s->at = calloc(ranks, sizeof *s->at);
    return s->load && s->rows && s->bytes && s->at ? FP3_OK : fp3_no_memory(bodies->error);
}

fp3_status fp3_share_make(fp3_bodies *bodies, const fp3_ranks *ranks) {
    bodies->share = calloc(1, sizeof *bodies->share);
    if (!bodies->share)
        return fp3_no_memory(bodies->error);
    bodies->share->ranks = *ranks;
    return make_arrays(bodies);
}

void fp3_share_free(fp3_bodies *bodies) {
    fp3_share *s = bodies->share;
    if (!s)
        return;
    void *const arrays[] = {s->root, s->weight, s->whose, s->were, s->island, s->load,
                            s->rows, s->own,    s->all,   s->at,   s->bytes};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(s);
    bodies->share = NULL;
}

/* ---- who has what ---- */

static fp3_status make_room(fp3_bodies *bodies) {
    fp3_share *s = bodies->share;
    const size_t slots = bodies->slots + 1u;
    const struct {
        uint32_t **array, *room;
    } all[] = {{&s->root, &s->root_room},
               {&s->weight, &s->weight_room},
               {&s->whose, &s->whose_room},
               {&s->were, &s->were_room},
               {&s->island, &s->island_room}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof all / sizeof *all; i++)
        status = fp3_bodies_room((void **)all[i].array, all[i].room, sizeof **all[i].array, slots,
                                 bodies->error);
    return status;
}

/* The one that moves, of the two slots of a row, or `movable`. */
static uint32_t inner_of(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    return a < bodies->movable ? a : b < bodies->movable ? b : bodies->movable;
}

static void weigh(fp3_bodies *bodies, uint32_t body_a, uint32_t body_b, uint32_t rows) {
    fp3_share *s = bodies->share;
    const uint32_t slot =
        inner_of(bodies, fp3_slot_of(bodies, body_a), fp3_slot_of(bodies, body_b));
    if (slot < bodies->movable)
        s->weight[s->root[slot]] += rows;
}

/* Rows of islands, and which islands have any. */
static void find_islands(fp3_bodies *bodies) {
    fp3_share *s = bodies->share;
    memset(s->weight, 0, bodies->movable * sizeof *s->weight);
    for (uint32_t i = 0; i < bodies->contacts.count; i++) {
        const fp3_touch2 *t = &bodies->touch[bodies->contacts.of[i]];
        weigh(bodies, t->body_a, t->body_b, bodies->space ? t->patches : 1);
    }
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        const fp3_joint *j = &bodies->joint[i];
        if (j->generation & 1)
            weigh(bodies, j->a, j->b, (uint32_t)__builtin_popcount(j->laws));
    }
    s->islands = 0;
    for (uint32_t k = 0; k < bodies->movable; k++)
        if (s->weight[k])
            s->island[s->islands++] = k;
}

static void give(fp3_share *s, uint32_t island) {
    uint32_t to = 0;
    for (uint32_t r = 1; r < s->ranks.count; r++)
        if (s->load[r] < s->load[to])
            to = r;
    s->load[to] += s->weight[island];
    s->whose[island] = to;
}

static int size_of(uint32_t weight) { return 31 - __builtin_clz(weight); }

/* Large ones first, by powers of two, to whom has least. */
static void hand_out(fp3_share *s) {
    int has[32] = {0};
    for (uint32_t i = 0; i < s->islands; i++)
        has[size_of(s->weight[s->island[i]])] = 1;
    for (int size = 31; size >= 0; size--)
        for (uint32_t i = 0; has[size] && i < s->islands; i++)
            if (size_of(s->weight[s->island[i]]) == size)
                give(s, s->island[i]);
}

fp3_status fp3_share_divide(fp3_bodies *bodies) {
    fp3_share *s = bodies->share;
    const fp3_status status = s ? make_room(bodies) : FP3_OK;
    if (status || !s)
        return status;
    uint32_t *const before = s->whose;
    s->whose = s->were;
    s->were = before;
    fp3_bodies_islands(bodies, s->root);
    find_islands(bodies);
    memset(s->load, 0, s->ranks.count * sizeof *s->load);
    memset(s->whose, -1, bodies->movable * sizeof *s->whose);
    hand_out(s);
    for (uint32_t k = 0; k < bodies->movable; k++)
        s->whose[k] = s->whose[s->root[k]];
    s->number += s->movable != bodies->movable ||
                 memcmp(s->whose, s->were, bodies->movable * sizeof *s->whose) != 0;
    s->movable = bodies->movable;
    for (uint32_t r = 0; r < s->ranks.count; r++)
        s->rows[r] += s->load[r];
    return FP3_OK;
}

static uint32_t rank_of(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    const uint32_t slot = inner_of(bodies, a, b);
    return slot < bodies->movable ? bodies->share->whose[slot] : EVERYBODY;
}

int fp3_share_has(const fp3_bodies *bodies, uint32_t a, uint32_t b) {
    if (!bodies->share)
        return 1;
    const uint32_t rank = rank_of(bodies, a, b);
    return rank == EVERYBODY || rank == bodies->share->ranks.rank;
}

/* ---- what all get ---- */

typedef enum { COUNT, PUT, TAKE } doing;

/* Whether this rank puts or takes words of that one; whoever counts has them counted. */
static int is_mine(fp3_share *s, doing what, uint32_t rank, uint32_t words) {
    if (what == COUNT)
        s->bytes[rank] += words * sizeof(float);
    return what != COUNT && (rank == s->ranks.rank) == (what == PUT);
}

/* Words side by side. */
static void carry(fp3_share *s, doing what, uint32_t rank, float *words, uint32_t count) {
    if (!is_mine(s, what, rank, count))
        return;
    float *const at = s->at[rank];
    memcpy(what == PUT ? at : words, what == PUT ? words : at, count * sizeof *words);
    s->at[rank] += count;
}

static void carry_slots(fp3_bodies *bodies, doing what) {
    const uint32_t fours = bodies->space ? FP3_FOURS3 : 1;
    fp3_share *s = bodies->share;
    for (uint32_t k = 0; k < bodies->movable; k++) {
        if (s->whose[k] == EVERYBODY)
            continue;
        carry(s, what, s->whose[k], (float *)&bodies->speed[fours * k], 4 * fours);
        carry(s, what, s->whose[k], (float *)&bodies->way[fours * k], 4 * fours);
    }
}

/* Words of a lane of a block. */
static void carry_lane(const changed *of, doing what, float *lane, float *at) {
    for (uint32_t w = 0; what == PUT && w < of->count; w++)
        at[w] = lane[of->word[w] * FP3_WIDE];
    for (uint32_t w = 0; what == TAKE && w < of->count; w++)
        lane[of->word[w] * FP3_WIDE] = at[w];
}

static void carry_rows(fp3_bodies *bodies, doing what, const fp3_law_rows *rows,
                       const changed *of) {
    fp3_share *s = bodies->share;
    for (uint32_t i = 0; i < rows->count; i++) {
        const uint32_t block = rows->lane[i] / FP3_WIDE, lane = rows->lane[i] % FP3_WIDE;
        const fp3_ends2 *ends = &rows->ends[block];
        const uint32_t rank = rank_of(bodies, ends->a[lane], ends->b[lane]);
        if (rank == EVERYBODY || !is_mine(s, what, rank, of->count))
            continue;
        float *row = (float *)(void *)((char *)rows->row + block * of->size);
        carry_lane(of, what, row + lane, s->at[rank]);
        s->at[rank] += of->count;
    }
}

/* Impulses that are found at once (heavy.h) stand with their joints. */
static void carry_joints(fp3_bodies *bodies, doing what) {
    for (uint32_t i = 0; i < bodies->joint_count; i++) {
        fp3_joint *j = &bodies->joint[i];
        if (!(j->generation & 1) || !j->is_heavy)
            continue;
        const uint32_t rank = rank_of(bodies, fp3_slot_of(bodies, j->a), fp3_slot_of(bodies, j->b));
        if (bodies->space) {
            fp3_joint3 *space = &bodies->space->joint[i];
            carry(bodies->share, what, rank, space->pin, 3);
            carry(bodies->share, what, rank, space->spin, 3);
            carry(bodies->share, what, rank, space->line, 4);
            carry(bodies->share, what, rank, space->twist, 4);
            continue;
        }
        carry(bodies->share, what, rank, j->point, 2);
        carry(bodies->share, what, rank, j->twist, 4);
    }
}

static void carry_all(fp3_bodies *bodies, doing what) {
    carry_slots(bodies, what);
    carry_joints(bodies, what);
    carry_rows(bodies, what, bodies->space ? &bodies->space->contacts : &bodies->contacts,
               bodies->space ? &contact3 : &contact2);
    for (int i = 0; bodies->space && i < FP3_JOINT_LAWS3; i++)
        carry_rows(bodies, what, &bodies->space->joined[i], &joint3[i]);
    for (int i = 0; !bodies->space && i < FP3_JOINT_LAWS; i++)
        carry_rows(bodies, what, &bodies->joined[i], &joint2[i]);
}

static fp3_status make_words(fp3_bodies *bodies, uint64_t words) {
    fp3_share *s = bodies->share;
    const fp3_status status =
        fp3_bodies_room((void **)&s->own, &s->own_room, sizeof *s->own, words, bodies->error);
    return status ? status
                  : fp3_bodies_room((void **)&s->all, &s->all_room, sizeof *s->all, words,
                                    bodies->error);
}

fp3_status fp3_share_gather(fp3_bodies *bodies, fp3_status status) {
    fp3_share *s = bodies->share;
    if (!s)
        return status;
    uint64_t words = 0;
    memset(s->bytes, 0, s->ranks.count * sizeof *s->bytes);
    if (!status)
        carry_all(bodies, COUNT);
    for (uint32_t r = 0; r < s->ranks.count; r++)
        words += s->bytes[r] / sizeof(float);
    if (!status)
        status = make_words(bodies, words);
    status = fp3_share_agree(bodies, status);
    if (status)
        return status;
    s->at[s->ranks.rank] = s->own;
    carry_all(bodies, PUT);
    s->ranks.calls->gather(s->ranks.world, s->own, s->bytes, s->all);
    float *at = s->all;
    for (uint32_t r = 0; r < s->ranks.count; r++) {
        s->at[r] = at;
        at += s->bytes[r] / sizeof *at;
    }
    carry_all(bodies, TAKE);
    s->sent += words * sizeof(float) * (s->ranks.count - 1u);
    return FP3_OK;
}
