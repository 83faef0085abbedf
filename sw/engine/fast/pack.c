/* SPDX-License-Identifier: Apache-2.0 */
/* pack.c - see pack.h.
 *
 * An object's neighbours keep their order, but a vector need not take the first neighbours of all
 * its objects in one turn: who waits a turn has -0 added, which leaves no trace. So where objects
 * have different numbers of neighbours, as at the edges of a grid, a turn can still take those that
 * stand side by side.
 */
#include "pack.h"

#include <stdlib.h>
#include <string.h>

#define LANES_MOST 16

/* What a turn costs, about: neighbours side by side, those that are gathered, and more where some
 * objects have none. */
enum { COST_ROW = 4, COST_GATHERED = 10, COST_IN_PART = 1 };

typedef struct {
    const fp3_fast_given *given;
    unsigned lanes;
    int *tape;
    size_t size, room;
    size_t *turn; /* of the vector: where each one's head is */
    size_t turns, turn_room;
    int is_gathered;
} packer;

/* The vector that is packed. Lanes behind the last object have what that one has. */
typedef struct {
    uint32_t first; /* object */
    uint32_t begin[LANES_MOST],
        end[LANES_MOST];       /* entries of each lane's object, or of the one that stands in */
    uint32_t next[LANES_MOST]; /* entry; end: it has none left */
    unsigned from[LANES_MOST]; /* the lane that stands in, or itself */
    unsigned takes;            /* a bit for each lane that takes part in the turn */
} vector;

static vector start(const packer *p, uint32_t first) {
    const fp3_fast_given *g = p->given;
    vector v = {.first = first};
    unsigned one = 0;
    for (unsigned i = 0; i < p->lanes; i++) {
        const uint32_t object = first + i < g->objects ? first + i : g->objects - 1;
        v.begin[i] = v.next[i] = g->begin[object];
        v.end[i] = g->begin[object + 1];
        v.from[i] = i;
        if (v.begin[i] != v.end[i])
            one = i;
    }
    for (unsigned i = 0; i < p->lanes; i++)
        if (v.begin[i] == v.end[i]) {
            v.from[i] = one;
            v.begin[i] = v.begin[one];
            v.end[i] = v.next[i] = v.end[one];
        }
    return v;
}

static void step(const packer *p, vector *v) {
    for (unsigned i = 0; i < p->lanes; i++)
        v->next[i] += v->takes >> i & 1;
}

/* From a lane to the neighbour of an entry: those whose way is the same stand side by side. */
static int64_t way(const packer *p, const vector *v, unsigned lane, uint32_t entry) {
    return (int64_t)p->given->other[entry] - lane - v->first;
}

/* The entry of a lane with this way, from one on; its end: there is none. */
static uint32_t find_way(const packer *p, const vector *v, unsigned lane, uint32_t from,
                         int64_t to) {
    while (from < v->end[lane] && way(p, v, lane, from) != to)
        from++;
    return from;
}

/* ---- who takes part in a turn ---- */

/* Everybody who has a neighbour left. */
static void take_all(const packer *p, vector *v) {
    v->takes = 0;
    for (unsigned i = 0; i < p->lanes; i++)
        v->takes |= (unsigned)(v->next[i] < v->end[i]) << i;
}

/* Those whose next neighbour is this way. */
static unsigned those(const packer *p, const vector *v, int64_t to) {
    unsigned takes = 0;
    for (unsigned i = 0; i < p->lanes; i++)
        takes |= (unsigned)(v->next[i] < v->end[i] && way(p, v, i, v->next[i]) == to) << i;
    return takes;
}

/* The more the better, but rather nobody who comes to such a neighbour later. */
static int score(const packer *p, const vector *v, int64_t to) {
    const unsigned takes = those(p, v, to);
    int found = __builtin_popcount(takes);
    for (unsigned i = 0; i < p->lanes; i++)
        if (!(takes >> i & 1) && find_way(p, v, i, v->next[i], to) < v->end[i])
            found -= LANES_MOST;
    return found;
}

/* Of neighbours that stand side by side, the best ones. */
static void take_side_by_side(const packer *p, vector *v) {
    int64_t best = 0;
    int most = INT32_MIN;
    unsigned seen = 0;
    v->takes = 0;
    for (unsigned i = 0; i < p->lanes; i++) {
        if (seen >> i & 1 || v->next[i] >= v->end[i])
            continue;
        const int64_t to = way(p, v, i, v->next[i]);
        const int found = score(p, v, to);
        seen |= those(p, v, to);
        if (found > most) {
            most = found;
            best = to;
            v->takes = those(p, v, best);
        }
    }
}

/* ---- a turn ---- */

/* A row of the columns; -1: it would not be one. */
static int row_at(const packer *p, const vector *v, int64_t to) {
    const int64_t base = v->first + to;
    return base >= 0 && base + p->lanes <= p->given->rows ? (int)base : -1;
}

/* The row that those who take part see; entry: of each lane. */
static int base_of(const packer *p, const vector *v, const uint32_t *entry) {
    const unsigned one = (unsigned)__builtin_ctz(v->takes);
    const int64_t to = way(p, v, one, entry[one]);
    for (unsigned i = one; i < p->lanes; i++)
        if (v->takes >> i & 1 && way(p, v, i, entry[i]) != to)
            return -1;
    return row_at(p, v, to);
}

/* A row that the others see, which are not all: some pair of theirs. */
static int others_of(const packer *p, const vector *v, uint32_t *entry) {
    const unsigned one = (unsigned)__builtin_ctz(~v->takes);
    for (uint32_t e = v->begin[one]; e < v->end[one]; e++) {
        const int64_t to = way(p, v, one, e);
        unsigned i = one;
        uint32_t found[LANES_MOST];
        for (; i < p->lanes; i++) {
            found[i] = v->takes >> i & 1 ? entry[i] : find_way(p, v, i, v->begin[i], to);
            if (found[i] == v->end[i])
                break;
        }
        if (i < p->lanes || row_at(p, v, to) < 0)
            continue;
        memcpy(entry + one, found + one, (p->lanes - one) * sizeof *entry);
        return row_at(p, v, to);
    }
    return -1;
}

static int are_fields_the_same(const packer *p, const uint32_t *entry) {
    const size_t fields = p->given->fields;
    for (unsigned i = 1; fields && i < p->lanes; i++)
        if (memcmp(&p->given->field[entry[0] * fields], &p->given->field[entry[i] * fields],
                   fields * sizeof *p->given->field) != 0)
            return 0;
    return 1;
}

static unsigned all_of(const packer *p) { return (1u << p->lanes) - 1; }

/* is_for_nobody: padding, the last turn once more, whose results are not used. */
static void put_turn(packer *p, const vector *v, int is_for_nobody) {
    const fp3_fast_given *g = p->given;
    uint32_t entry[LANES_MOST] = {0};
    for (unsigned i = 0; i < p->lanes; i++)
        entry[i] = v->takes >> i & 1 ? v->next[i] : v->begin[i];
    int base = base_of(p, v, entry), others = base;
    if (base >= 0 &&
        v->takes != all_of(p)) /* if no object takes part, all would see the row of the others */
        others = is_for_nobody ? -1 : others_of(p, v, entry);
    if (others < 0)
        base = -1;
    const int is_same = !g->is_written && are_fields_the_same(p, entry);
    const unsigned takes = is_for_nobody ? 0 : v->takes;
    int *at = p->tape + p->size;
    p->turn[p->turns++] = p->size;
    p->is_gathered |= base < 0;
    *at++ = base;
    *at++ = others;
    *at++ = (int)((is_same ? FP3_TURN_SAME : 0u) | takes << FP3_TURN_TAKES);
    for (unsigned i = 0; base < 0 && i < p->lanes; i++)
        *at++ = (int)g->other[entry[i]];
    for (unsigned i = 0; g->is_written && i < p->lanes; i++)
        *at++ = (int)(entry[i] * g->fields);
    for (uint32_t f = 0; !g->is_written && f < g->fields; f++)
        for (unsigned i = 0; i < (is_same ? 1 : p->lanes); i++)
            memcpy(at++, &g->field[(size_t)entry[i] * g->fields + f], sizeof *at);
    p->size = (size_t)(at - p->tape);
}

/* ---- a vector ---- */

static unsigned cost_of_turn(const packer *p, const vector *v) {
    return (base_of(p, v, v->next) < 0 ? COST_GATHERED : COST_ROW) +
           (v->takes != all_of(p) ? COST_IN_PART : 0);
}

static unsigned cost_of_all(const packer *p, uint32_t first) {
    vector v = start(p, first);
    unsigned cost = 0;
    for (take_all(p, &v); v.takes; step(p, &v), take_all(p, &v))
        cost += cost_of_turn(p, &v);
    return cost;
}

/* Whether turns of neighbours that stand side by side cost less than this. Where there are none the
 * search for them would take long: it ends when turns have fewer than a quarter of the lanes. */
static int is_better(const packer *p, uint32_t first, unsigned most) {
    vector v = start(p, first);
    unsigned cost = 0, turns = 0, taken = 0;
    for (take_side_by_side(p, &v); v.takes; step(p, &v), take_side_by_side(p, &v)) {
        cost += cost_of_turn(p, &v);
        taken += (unsigned)__builtin_popcount(v.takes);
        if (cost >= most || (++turns >= 4 && 4 * taken < turns * p->lanes))
            return 0;
    }
    return cost < most;
}

static fp3_status need_room(packer *p, fp3_error *error) {
    const size_t most = 1 + FP3_TURN_HEAD + (2 + (size_t)p->given->fields) * p->lanes;
    if (p->size + most > p->room) {
        const size_t room = 2 * p->room + 64 * most;
        int *tape = realloc(p->tape, room * sizeof *tape);
        if (!tape)
            return fp3_no_memory(error);
        p->tape = tape;
        p->room = room;
    }
    if (p->turns == p->turn_room) {
        const size_t room = 2 * p->turn_room + 64;
        size_t *turn = realloc(p->turn, room * sizeof *turn);
        if (!turn)
            return fp3_no_memory(error);
        p->turn = turn;
        p->turn_room = room;
    }
    return FP3_OK;
}

/* Whether turns from this one on are as FP3_TURN_PLAIN. */
static int are_plain(const packer *p, size_t first) {
    const unsigned all = FP3_TURN_SAME | all_of(p) << FP3_TURN_TAKES;
    for (size_t i = first; i < first + FP3_TURNS_BESIDE; i++)
        if (i >= p->turns || (unsigned)p->tape[p->turn[i] + 2] != all || p->tape[p->turn[i]] < 0)
            return 0;
    return 1;
}

/* How many turns lack in the end, for turns side by side. */
static size_t put_side_by_side(packer *p) {
    size_t i = 0;
    while (i < p->turns) {
        int *kind = &p->tape[p->turn[i] + 2];
        *kind |= are_plain(p, i) ? FP3_TURN_PLAIN : 0;
        i += FP3_TURNS_BESIDE;
    }
    return i - p->turns;
}

static void put_stand_ins(packer *p, const vector *v) {
    int is_any = 0;
    for (unsigned i = 0; i < p->lanes; i++)
        is_any |= v->from[i] != i;
    p->tape[p->size++] = is_any;
    for (unsigned i = 0; is_any && i < p->lanes; i++)
        p->tape[p->size++] = (int)v->from[i];
}

static fp3_status pack_vector(packer *p, uint32_t first, fp3_error *error) {
    void (*take)(const packer *p, vector *v) = take_all;
    vector v = start(p, first), last = v;
    if (p->given->is_fixed && is_better(p, first, cost_of_all(p, first)))
        take = take_side_by_side;
    p->turns = 0;
    fp3_status status = need_room(p, error);
    take(p, &v);
    if (!status && v.takes)
        put_stand_ins(p, &v);
    for (; !status && v.takes; step(p, &v), take(p, &v)) {
        status = need_room(p, error);
        if (!status)
            put_turn(p, &v, 0);
        last = v;
    }
    for (size_t left = put_side_by_side(p); !status && left; left--) {
        status = need_room(p, error);
        if (!status)
            put_turn(p, &last, 1);
    }
    return status;
}

fp3_status fp3_fast_pack(const fp3_fast_given *given, unsigned lanes, fp3_fast_packed *packed,
                         fp3_error *error) {
    packer p = {.given = given, .lanes = lanes};
    fp3_status status = FP3_OK;
    *packed = (fp3_fast_packed){
        .given = *given,
        .list = {.objects = given->objects, .first = given->first, .end = given->end}};
    if (!given->begin || !lanes)
        return FP3_OK;
    if (given->is_written && (uint64_t)given->begin[given->objects] * given->fields > INT32_MAX)
        return fp3_fail(error, FP3_E_LIMIT,
                        "lists that remember have more than 2147483647 fields in all");
    const uint32_t vectors = (given->objects + lanes - 1) / lanes;
    packed->start = malloc((vectors + (size_t)1) * sizeof *packed->start);
    if (!packed->start)
        return fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < vectors; i++) {
        packed->start[i] = p.size;
        status = pack_vector(&p, i * lanes, error);
    }
    packed->start[vectors] = p.size;
    packed->tape = p.tape;
    packed->is_gathered = p.is_gathered;
    packed->list.start = packed->start;
    packed->list.tape = packed->tape;
    packed->list.field = given->is_written ? (int *)(void *)given->field : NULL;
    free(p.turn);
    return status;
}

void fp3_fast_pack_free(fp3_fast_packed *packed) {
    free(packed->start);
    free(packed->tape);
    *packed = (fp3_fast_packed){0};
}
