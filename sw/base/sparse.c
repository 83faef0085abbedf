/* SPDX-License-Identifier: Apache-2.0 */
/* sparse.c - see sparse.h. */
#include "sparse.h"

#include "room.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX
/* Compiled for each size of blocks. */
#define INLINE static inline __attribute__((always_inline))

/* ---- who meets whom ---- */

void fp3_sparse_begin(fp3_sparse *s, uint32_t count, uint32_t size) {
    s->count = count;
    s->size = size;
    s->pairs = 0;
}

fp3_status fp3_sparse_meet(fp3_sparse *s, uint32_t a, uint32_t b, fp3_error *error) {
    const fp3_status status =
        fp3_room((void **)&s->pair, &s->pair_room, sizeof *s->pair, s->pairs + 1u, error);
    if (status)
        return status;
    s->laid_pairs =
        s->pairs < s->laid_pairs && s->pair[s->pairs][0] == a && s->pair[s->pairs][1] == b
            ? s->laid_pairs
            : NONE; /* the order is of others */
    s->pair[s->pairs][0] = a;
    s->pair[s->pairs++][1] = b;
    return FP3_OK;
}

static uint32_t find(const fp3_sparse *s, uint32_t a, uint32_t b) {
    uint32_t at = s->first[a];
    while (at != NONE && s->meeting[at].to != b)
        at = s->meeting[at].next;
    return at;
}

static fp3_status meet(fp3_sparse *s, uint32_t a, uint32_t b, fp3_error *error) {
    if (find(s, a, b) != NONE)
        return FP3_OK;
    const fp3_status status = fp3_room((void **)&s->meeting, &s->meeting_room, sizeof *s->meeting,
                                       s->meetings + 2u, error);
    if (status)
        return status;
    const uint32_t at = s->meetings, block = s->count + at / 2;
    s->meeting[at] = (fp3_meeting){b, s->first[a], block};
    s->meeting[at + 1] = (fp3_meeting){a, s->first[b], block};
    s->first[a] = at;
    s->first[b] = at + 1;
    s->meetings += 2;
    s->degree[a]++;
    s->degree[b]++;
    return FP3_OK;
}

/* ---- the order ---- */

static fp3_status make_room(fp3_sparse *s, fp3_error *error) {
    const struct {
        uint32_t **array, *room;
    } all[] = {{&s->first, &s->first_room},  {&s->degree, &s->degree_room},
               {&s->rank, &s->rank_room},    {&s->order, &s->order_room},
               {&s->few, &s->few_room},      {&s->start, &s->start_room},
               {&s->target, &s->target_room}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof all / sizeof *all; i++)
        status =
            fp3_room((void **)all[i].array, all[i].room, sizeof(uint32_t), s->count + 1u, error);
    return status;
}

static uint32_t fewest(const fp3_sparse *s) {
    uint32_t best = NONE;
    for (uint32_t i = 0; i < s->count; i++)
        if (s->rank[i] == NONE && (best == NONE || s->degree[i] < s->degree[best]))
            best = i;
    return best;
}

/* Whoever a body meets when it is eliminated meet each other from then on. */
static fp3_status eliminate(fp3_sparse *s, uint32_t k, uint32_t rank, uint32_t *few,
                            fp3_error *error) {
    fp3_status status = FP3_OK;
    s->rank[k] = rank;
    s->order[rank] = k;
    for (uint32_t at = s->first[k]; !status && at != NONE; at = s->meeting[at].next) {
        const uint32_t i = s->meeting[at].to;
        if (s->rank[i] != NONE)
            continue;
        s->degree[i]--;
        for (uint32_t other = s->meeting[at].next; !status && other != NONE;
             other = s->meeting[other].next)
            if (s->rank[s->meeting[other].to] == NONE)
                status = meet(s, i, s->meeting[other].to, error);
        if (s->degree[i] == 1 && *few < s->count)
            s->few[(*few)++] = i;
    }
    return status;
}

static fp3_status find_order(fp3_sparse *s, fp3_error *error) {
    fp3_status status = FP3_OK;
    uint32_t few = 0;
    for (uint32_t i = s->count; i-- > 0;)
        if (s->degree[i] <= 1)
            s->few[few++] = i;
    for (uint32_t rank = 0; !status && rank < s->count;) {
        const uint32_t k = few ? s->few[--few] : fewest(s);
        if (s->rank[k] == NONE)
            status = eliminate(s, k, rank++, &few, error);
    }
    return status;
}

static int by_rank(const void *a, const void *b) {
    const uint32_t x = ((const fp3_later *)a)->to, y = ((const fp3_later *)b)->to;
    return (x > y) - (x < y);
}

/* Blocks that change when the k-th body is eliminated. */
static fp3_status find_targets(fp3_sparse *s, uint32_t k, fp3_error *error) {
    const uint32_t count = s->start[k + 1] - s->start[k];
    const fp3_later *later = &s->later[s->start[k]];
    uint32_t *onto;
    const fp3_status status = fp3_room((void **)&s->onto, &s->onto_room, sizeof *s->onto,
                                       (size_t)s->target[k] + (size_t)count * count + 1u, error);
    if (status)
        return status;
    onto = &s->onto[s->target[k]];
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count; j++)
            *onto++ = s->meeting[find(s, s->order[later[i].to], s->order[later[j].to])].block;
    s->target[k + 1] = (uint32_t)(onto - s->onto);
    return FP3_OK;
}

static fp3_status find_blocks(fp3_sparse *s, fp3_error *error) {
    fp3_status status =
        fp3_room((void **)&s->later, &s->later_room, sizeof *s->later, s->meetings + 1u, error);
    if (!status)
        status = fp3_room((void **)&s->block, &s->block_room, sizeof(double),
                          ((size_t)s->count + s->meetings / 2 + 1) * s->size * s->size, error);
    s->start[0] = s->target[0] = 0;
    for (uint32_t k = 0; !status && k < s->count; k++) {
        uint32_t at = s->start[k];
        for (uint32_t m = s->first[s->order[k]]; m != NONE; m = s->meeting[m].next)
            if (s->rank[s->meeting[m].to] > k)
                s->later[at++] = (fp3_later){s->rank[s->meeting[m].to], s->meeting[m].block};
        s->start[k + 1] = at;
        if (at > s->start[k])
            qsort(&s->later[s->start[k]], at - s->start[k], sizeof *s->later, by_rank);
        status = find_targets(s, k, error);
    }
    return status;
}

fp3_status fp3_sparse_order(fp3_sparse *s, fp3_error *error) {
    if (s->laid == s->count && s->laid_pairs == s->pairs)
        return FP3_OK;
    s->laid = NONE;
    fp3_status status = make_room(s, error);
    s->meetings = 0;
    for (uint32_t i = 0; !status && i < s->count; i++) {
        s->first[i] = s->rank[i] = NONE;
        s->degree[i] = 0;
    }
    for (uint32_t i = 0; !status && i < s->pairs; i++)
        status = meet(s, s->pair[i][0], s->pair[i][1], error);
    if (!status)
        status = find_order(s, error);
    if (!status)
        status = find_blocks(s, error);
    if (!status) {
        s->laid = s->count;
        s->laid_pairs = s->pairs;
    }
    return status;
}

/* ---- values ---- */

void fp3_sparse_clear(fp3_sparse *s) {
    memset(s->block, 0,
           ((size_t)s->count + s->meetings / 2) * s->size * s->size * sizeof *s->block);
}

static double *at(const fp3_sparse *s, uint32_t block) {
    return &s->block[(size_t)block * s->size * s->size];
}

double *fp3_sparse_block(const fp3_sparse *s, uint32_t a, uint32_t b, int *is_swapped) {
    *is_swapped = s->rank[a] > s->rank[b];
    return at(s, a == b ? a : s->meeting[find(s, a, b)].block);
}

/* m = l l' in place, of a block: l is below, with the reciprocals of its diagonal. Whether m is
 * positive. Roundings are as small as those of m's largest numbers, which an inverse in place of l
 * would not keep. */
INLINE int root(double *m, uint32_t n) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = m[i * n + j];
            for (uint32_t k = 0; k < j; k++)
                sum -= m[i * n + k] * m[j * n + k];
            if (i == j && !(sum > 0 && sum < HUGE_VAL))
                return 0;
            m[i * n + j] = i == j ? 1 / sqrt(sum) : sum * m[j * n + j];
        }
    return 1;
}

/* x with l x = x, of `columns` columns. */
INLINE void below(const double *l, double *x, uint32_t n, uint32_t columns) {
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t c = 0; c < columns; c++) {
            double sum = x[i * columns + c];
            for (uint32_t k = 0; k < i; k++)
                sum -= l[i * n + k] * x[k * columns + c];
            x[i * columns + c] = sum * l[i * n + i];
        }
}

/* x with l' x = x */
INLINE void above(const double *l, double *x, uint32_t n) {
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t k = i + 1; k < n; k++)
            x[i] -= l[k * n + i] * x[k];
        x[i] *= l[i * n + i];
    }
}

/* to -= a' b, of `columns` columns of b. */
INLINE void take(double *to, const double *a, const double *b, uint32_t n, uint32_t columns) {
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j < columns; j++)
                to[i * columns + j] -= a[k * n + i] * b[k * columns + j];
}

INLINE int factor(fp3_sparse *s, const uint32_t n) {
    for (uint32_t k = 0; k < s->count; k++) {
        const uint32_t *onto = &s->onto[s->target[k]];
        const fp3_later *end = &s->later[s->start[k + 1]];
        const double *own = at(s, s->order[k]);
        if (!root(at(s, s->order[k]), n))
            return 0;
        for (const fp3_later *i = &s->later[s->start[k]]; i < end; i++)
            below(own, at(s, i->block), n, n);
        for (const fp3_later *i = &s->later[s->start[k]]; i < end; i++) {
            take(at(s, s->order[i->to]), at(s, i->block), at(s, i->block), n, n);
            for (const fp3_later *j = i + 1; j < end; j++)
                take(at(s, *onto++), at(s, i->block), at(s, j->block), n, n);
        }
    }
    return 1;
}

INLINE void solve(const fp3_sparse *s, double *x, const uint32_t n) {
    for (uint32_t k = 0; k < s->count; k++) {
        double *own = &x[s->order[k] * n];
        below(at(s, s->order[k]), own, n, 1);
        for (uint32_t i = s->start[k]; i < s->start[k + 1]; i++)
            take(&x[s->order[s->later[i].to] * n], at(s, s->later[i].block), own, n, 1);
    }
    for (uint32_t k = s->count; k-- > 0;) {
        double *own = &x[s->order[k] * n];
        for (uint32_t i = s->start[k]; i < s->start[k + 1]; i++) {
            const double *of = at(s, s->later[i].block), *from = &x[s->order[s->later[i].to] * n];
            for (uint32_t r = 0; r < n; r++)
                for (uint32_t c = 0; c < n; c++)
                    own[r] -= of[r * n + c] * from[c];
        }
        above(at(s, s->order[k]), own, n);
    }
}

int fp3_sparse_factor(fp3_sparse *s) { return s->size == 3 ? factor(s, 3) : factor(s, 6); }

void fp3_sparse_solve(const fp3_sparse *s, double *x) {
    if (s->size == 3)
        solve(s, x, 3);
    else
        solve(s, x, 6);
}

void fp3_sparse_free(fp3_sparse *s) {
    void *const all[] = {s->pair,  s->first,   s->degree, s->rank, s->order, s->few,
                         s->start, s->meeting, s->target, s->onto, s->later, s->block};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}
