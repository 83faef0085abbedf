/* SPDX-License-Identifier: Apache-2.0 */
/* pairs.c - see pairs.h. */
#include "pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVELS 64
#define LEVEL_LEAST (-30) /* cells of 2^-30 .. 2^33 */
#define FARTHEST 1e9      /* cells from the origin: beyond it all are in the last one */

typedef struct {
    int32_t cell[3];
    uint32_t box, level;
} place;

typedef struct {
    const fp3_boxes *boxes;
    place *own;       /* of each box */
    place *places;    /* bucket by bucket, in each in the order of boxes */
    uint32_t *of;     /* ... of each box the bucket */
    uint32_t *bucket; /* where each begins; one more behind the last */
    uint32_t mask;    /* buckets - 1 */
    uint64_t levels;  /* bit l: a box is of level l */
    uint64_t **keys;
    size_t *room, count;
} search;

static int is_there(const fp3_box *box) { return box->low[0] <= box->high[0]; }

static double two_to(int exponent) {
    const uint64_t bits = (uint64_t)(1023 + exponent) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}
static double cell_size(uint32_t level) { return two_to((int)level + LEVEL_LEAST); }

static uint32_t level_of(const fp3_boxes *boxes, const fp3_box *box) {
    double extent = 0;
    for (uint32_t k = 0; k < boxes->dimensions; k++)
        if (extent < box->high[k] - box->low[k])
            extent = box->high[k] - box->low[k];
    uint64_t bits;
    memcpy(&bits, &extent, sizeof bits);
    const int level = (int)(bits >> 52) - 1022 - LEVEL_LEAST; /* extent < 2^(level + LEVEL_LEAST) */
    return level < 0 ? 0 : level >= LEVELS ? LEVELS - 1 : (uint32_t)level;
}

/* The coarsest level is one cell: what is there may be larger than any. */
static int32_t cell_of(double x, uint32_t level) {
    const double at = x * two_to(-(int)level - LEVEL_LEAST);
    if (level == LEVELS - 1)
        return 0;
    const int32_t cell = (int32_t)(at < FARTHEST ? at > -FARTHEST ? at : -FARTHEST : FARTHEST);
    return cell - (at < (double)cell);
}

static uint32_t bucket_of(const search *s, const int32_t cell[3], uint32_t level) {
    uint64_t h = (uint64_t)(uint32_t)cell[0] * 0x9e3779b97f4a7c15u ^
                 (uint64_t)(uint32_t)cell[1] * 0xc2b2ae3d27d4eb4fu ^
                 (uint64_t)(uint32_t)cell[2] * 0xd6e8feb86659fd93u ^
                 (uint64_t)level * 0x165667b19e3779f9u;
    h ^= h >> 29;
    h *= 0xbf58476d1ce4e5b9u;
    return (uint32_t)(h >> 32) & s->mask;
}

static place place_of(const fp3_boxes *boxes, uint32_t number) {
    const fp3_box *box = &boxes->box[number];
    place p = {.box = number, .level = level_of(boxes, box)};
    for (uint32_t k = 0; k < boxes->dimensions; k++)
        p.cell[k] = cell_of(0.5 * (box->low[k] + box->high[k]), p.level);
    return p;
}

/* By counting. */
static fp3_status fill(search *s, fp3_error *error) {
    const uint32_t count = s->boxes->count;
    uint32_t buckets = 16;
    while (buckets < 2 * (uint64_t)count)
        buckets *= 2;
    s->mask = buckets - 1;
    s->bucket = calloc((size_t)buckets + 1, sizeof *s->bucket);
    s->own = malloc(((size_t)count + 1) * sizeof *s->own);
    s->places = malloc(((size_t)count + 1) * sizeof *s->places);
    s->of = malloc(((size_t)count + 1) * sizeof *s->of);
    if (!s->bucket || !s->own || !s->places || !s->of)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < count; i++) {
        if (!is_there(&s->boxes->box[i]))
            continue;
        s->own[i] = place_of(s->boxes, i);
        s->of[i] = bucket_of(s, s->own[i].cell, s->own[i].level);
        s->levels |= (uint64_t)1 << s->own[i].level;
        s->bucket[s->of[i]]++;
    }
    for (uint32_t b = 0, sum = 0; b <= buckets; b++) {
        sum += s->bucket[b];
        s->bucket[b] = sum;
    }
    /* From the last one down: `bucket` goes from where each one ends to where it begins. */
    for (uint32_t i = count; i-- > 0;)
        if (is_there(&s->boxes->box[i]))
            s->places[--s->bucket[s->of[i]]] = s->own[i];
    return FP3_OK;
}

static fp3_status found(search *s, uint32_t a, uint32_t b, fp3_error *error) {
    if (s->count == *s->room) {
        const size_t room = *s->room ? 2 * *s->room : 256;
        uint64_t *keys = realloc(*s->keys, room * sizeof *keys);
        if (!keys)
            return fp3_no_memory(error);
        *s->keys = keys;
        *s->room = room;
    }
    (*s->keys)[s->count++] = (uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a);
    return FP3_OK;
}

static int overlap(const search *s, uint32_t a, uint32_t b) {
    const fp3_box *x = &s->boxes->box[a], *y = &s->boxes->box[b];
    int is_apart = 0;
    for (uint32_t k = 0; k < s->boxes->dimensions; k++)
        is_apart |= (x->low[k] > y->high[k]) | (y->low[k] > x->high[k]);
    return !is_apart;
}

static int may_be(const fp3_boxes *boxes, uint32_t a, uint32_t b) {
    const fp3_box_filter *x = &boxes->filter[a], *y = &boxes->filter[b];
    return (x->may_move | y->may_move) && x->category & y->mask && y->category & x->mask;
}

/* Of two boxes of a level the one whose cell is before the other's finds the other; in one cell the
 * one with the lower number. */
static int is_before(const int32_t a[3], const int32_t b[3]) {
    return a[2] != b[2] ? a[2] < b[2] : a[1] != b[1] ? a[1] < b[1] : a[0] < b[0];
}

static fp3_status look_into(search *s, const place *own, const int32_t cell[3], uint32_t level,
                            fp3_error *error) {
    const int is_level = level == own->level;
    if (is_level && is_before(cell, own->cell))
        return FP3_OK;
    const uint32_t least = is_level && !is_before(own->cell, cell) ? own->box + 1 : 0;
    const uint32_t bucket = bucket_of(s, cell, level);
    fp3_status status = FP3_OK;
    for (uint32_t k = s->bucket[bucket]; !status && k < s->bucket[bucket + 1]; k++) {
        const place *p = &s->places[k];
        if (p->box >= least && p->level == level && p->cell[0] == cell[0] &&
            p->cell[1] == cell[1] && p->cell[2] == cell[2] && overlap(s, own->box, p->box) &&
            may_be(s->boxes, own->box, p->box))
            status = found(s, own->box, p->box, error);
    }
    return status;
}

/* Centres of a level's boxes that overlap this one are no farther from it than half a cell. */
static fp3_status look(search *s, const place *own, uint32_t level, fp3_error *error) {
    const fp3_box *a = &s->boxes->box[own->box];
    const double half = 0.5 * cell_size(level);
    int32_t first[3] = {0}, last[3] = {0}, cell[3];
    for (uint32_t k = 0; k < s->boxes->dimensions; k++) {
        first[k] = cell_of(a->low[k] - half, level);
        last[k] = cell_of(a->high[k] + half, level);
    }
    fp3_status status = FP3_OK;
    for (cell[2] = first[2]; !status && cell[2] <= last[2]; cell[2]++)
        for (cell[1] = first[1]; !status && cell[1] <= last[1]; cell[1]++)
            for (cell[0] = first[0]; !status && cell[0] <= last[0]; cell[0]++)
                status = look_into(s, own, cell, level, error);
    return status;
}

static int ascending(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* A large box has many. */
static void sort_few(uint64_t *keys, uint32_t count) {
    if (count > 16) {
        qsort(keys, count, sizeof *keys, ascending);
        return;
    }
    for (uint32_t k = 1; k < count; k++) {
        const uint64_t key = keys[k];
        uint32_t to = k;
        for (; to > 0 && keys[to - 1] > key; to--)
            keys[to] = keys[to - 1];
        keys[to] = key;
    }
}

/* By counting the lower numbers; each has few others, of which each goes to its place. */
static fp3_status sort(search *s, fp3_error *error) {
    uint64_t *keys = *s->keys, *to = malloc((s->count + 1) * sizeof *to);
    uint32_t *first = calloc((size_t)s->boxes->count + 1, sizeof *first);
    const int is_made = to && first;
    for (size_t k = 0; is_made && k < s->count; k++)
        first[keys[k] >> 32]++;
    for (uint32_t i = 0, sum = 0; is_made && i <= s->boxes->count; i++) {
        const uint32_t own = first[i];
        first[i] = sum;
        sum += own;
    }
    for (size_t k = 0; is_made && k < s->count; k++)
        to[first[keys[k] >> 32]++] = keys[k];
    for (uint32_t i = 0; is_made && i < s->boxes->count; i++) { /* first: where it ends now */
        const uint32_t begin = i ? first[i - 1] : 0;
        sort_few(to + begin, first[i] - begin);
    }
    if (is_made)
        memcpy(keys, to, s->count * sizeof *keys);
    free(to);
    free(first);
    return is_made ? FP3_OK : fp3_no_memory(error);
}

fp3_status fp3_pairs_find_of(const fp3_boxes *boxes, const uint32_t *some, uint32_t count,
                             uint64_t **keys, size_t *room, size_t *found_count, fp3_error *error) {
    search s = {.boxes = boxes, .keys = keys, .room = room};
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t i = 0; !status && i < boxes->count; i++)
            if (i != some[k] && overlap(&s, some[k], i) && is_there(&boxes->box[i]) &&
                is_there(&boxes->box[some[k]]) && may_be(boxes, some[k], i))
                status = found(&s, some[k], i, error);
    if (!status && s.count)
        qsort(*keys, s.count, sizeof **keys, ascending);
    size_t kept = 0; /* two of `some` have found each other */
    for (size_t k = 0; k < s.count; k++)
        if (k == 0 || (*keys)[k] != (*keys)[kept - 1])
            (*keys)[kept++] = (*keys)[k];
    *found_count = kept;
    return status;
}

fp3_status fp3_pairs_find(const fp3_boxes *boxes, uint64_t **keys, size_t *room, size_t *count,
                          fp3_error *error) {
    search s = {.boxes = boxes, .keys = keys, .room = room};
    fp3_status status = fill(&s, error);
    for (uint32_t i = 0; !status && i < boxes->count; i++) {
        if (!is_there(&boxes->box[i]))
            continue;
        const place *own = &s.own[i];
        for (uint64_t left = s.levels >> own->level << own->level; !status && left;
             left &= left - 1)
            status = look(&s, own, (uint32_t)__builtin_ctzll(left), error);
    }
    free(s.bucket);
    free(s.own);
    free(s.places);
    free(s.of);
    if (!status && s.count)
        status = sort(&s, error);
    *count = s.count;
    return status;
}
