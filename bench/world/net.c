/* net.c - springs by a loop written by hand: the step of programs/world/net.ode by
 * semi_implicit_euler.
 *
 * A block of objects, as many as a vector has, goes through its entries together. Entries are
 * arranged when the loop is opened: if the objects of a block have neighbours at the same distances
 * in number, as on a grid, a place in its list is a distance, and the neighbours are loaded as they
 * lie. Objects that have none at a distance (those at an edge) do nothing there, which changes no
 * bit. Else a place has a neighbour of each object, and they are gathered.
 */
#include "hand.h"
#include "vector.h"

#include <stdlib.h>

typedef struct {
    ptrdiff_t by;          /* from each object to its neighbour ... */
    const int32_t *index;  /* ... unless they are here, by number */
    const float *k, *rest; /* a vector each, which places may share */
    lanes mask;            /* who has an entry */
} place;

typedef struct {
    size_t objects, blocks, margin;
    float h, pull[3];
    float *memory, *x[2][3], *v[3], *w; /* x: two halves */
    int half;
    place *places;
    size_t *first; /* of each block */
    void *kept;    /* blocks of memory that places point to */
} net;

/* ---- memory ---- */

typedef struct piece {
    struct piece *next;
    _Alignas(64) char bytes[];
} piece;

static void *keep(net *n, size_t size) {
    piece *p = aligned_alloc(64, (sizeof *p + size + 63) / 64 * 64);
    if (!p)
        return NULL;
    p->next = n->kept;
    n->kept = p;
    return p->bytes;
}

static void net_close(void *state) {
    net *n = state;
    if (!n)
        return;
    for (piece *p = n->kept, *next; p; p = next) {
        next = p->next;
        free(p);
    }
    free(n->memory);
    free(n->places);
    free(n->first);
    free(n);
}

/* ---- places ---- */

/* Objects of a block: those behind the last one have no entries. */
static uint32_t entries_of(const hand_world *w, size_t object) {
    return object < w->objects ? w->begin[object + 1] - w->begin[object] : 0;
}

static ptrdiff_t way_of(const hand_world *w, size_t object, uint32_t entry) {
    return (ptrdiff_t)w->other[w->begin[object] + entry] - (ptrdiff_t)object;
}

/* The longest list's distances; 1 if each list of the block is a part of them, in their order. */
static int find_ways(const hand_world *w, size_t at, uint32_t most, ptrdiff_t *ways) {
    for (size_t i = at; i < at + WIDTH; i++)
        if (entries_of(w, i) == most)
            for (uint32_t k = 0; k < most; k++)
                ways[k] = way_of(w, i, k);
    for (size_t i = at; i < at + WIDTH; i++) {
        uint32_t k = 0;
        for (uint32_t e = 0; e < entries_of(w, i); e++, k++) {
            while (k < most && ways[k] != way_of(w, i, e))
                k++;
            if (k == most)
                return 0;
        }
    }
    return 1;
}

/* A vector that was kept for this place of the block before serves again. */
static const float *vector_kept(net *n, const float *values, const float *before) {
    if (before && !memcmp(before, values, sizeof(vec)))
        return before;
    float *kept = keep(n, sizeof(vec));
    if (kept)
        memcpy(kept, values, sizeof(vec));
    return kept;
}

/* *p is still that of the block before, or empty. The entry of each object, -1: none. */
static int fill_place(net *n, const hand_world *w, size_t at, const int64_t *entry, int is_run,
                      place *p) {
    float k[WIDTH] = {0}, rest[WIDTH] = {0};
    int32_t index[WIDTH];
    p->mask = 0;
    for (int i = 0; i < WIDTH; i++) {
        const int64_t e = entry[i];
        index[i] = (int32_t)(at + (size_t)i + 1 < n->objects ? at + (size_t)i + 1 : 0);
        if (e < 0)
            continue;
        p->mask |= (lanes)(1u << i);
        p->by = (ptrdiff_t)w->other[e] - (ptrdiff_t)(at + (size_t)i);
        index[i] = (int32_t)w->other[e];
        k[i] = w->stiffness[e];
        rest[i] = w->rest[e];
    }
    /* What does nothing may be anything: then vectors are the same more often. */
    for (int i = 0; i < WIDTH; i++)
        if (entry[i] < 0) {
            k[i] = p->k ? p->k[i] : 0;
            rest[i] = p->rest ? p->rest[i] : 0;
        }
    p->k = vector_kept(n, k, p->k);
    p->rest = vector_kept(n, rest, p->rest);
    p->index = NULL;
    if (!is_run) {
        int32_t *kept = keep(n, sizeof index);
        if (kept)
            memcpy(kept, index, sizeof index);
        p->index = kept;
    }
    return p->k && p->rest && (is_run || p->index);
}

static int arrange_block(net *n, const hand_world *w, size_t block, ptrdiff_t *ways) {
    const size_t at = block * WIDTH;
    uint32_t most = 0;
    for (size_t i = at; i < at + WIDTH; i++)
        most = entries_of(w, i) > most ? entries_of(w, i) : most;
    const int is_run = find_ways(w, at, most, ways);
    uint32_t used[WIDTH] = {0};
    for (uint32_t k = 0; k < most; k++) {
        place *p = &n->places[n->first[block] + k];
        int64_t entry[WIDTH];
        for (size_t i = 0; i < WIDTH; i++) {
            const int has = used[i] < entries_of(w, at + i) &&
                            (!is_run || way_of(w, at + i, used[i]) == ways[k]);
            entry[i] = has ? (int64_t)w->begin[at + i] + used[i] : -1;
            used[i] += (uint32_t)has;
        }
        *p = (place){.by = 0};
        if (block && k < n->first[block] - n->first[block - 1])
            *p = n->places[n->first[block - 1] + k];
        if (!fill_place(n, w, at, entry, is_run, p))
            return 0;
    }
    n->first[block + 1] = n->first[block] + most;
    return 1;
}

static int arrange(net *n, const hand_world *w) {
    ptrdiff_t *ways = malloc((w->begin[w->objects] + 1) * sizeof *ways);
    int is_made = ways != NULL;
    for (size_t b = 0; is_made && b < n->blocks; b++)
        is_made = arrange_block(n, w, b, ways);
    free(ways);
    return is_made;
}

/* Before and behind the objects there is room: at an edge a distance may lead outside. */
static size_t margin_of(const hand_world *w) {
    size_t most = 0;
    for (size_t i = 0; i < w->objects; i++)
        for (uint32_t k = 0; k < entries_of(w, i); k++) {
            const size_t by = (size_t)llabs((long long)way_of(w, i, k));
            most = by > most ? by : most;
        }
    return (most + 2 * WIDTH) / WIDTH * WIDTH;
}

static void *net_open(const hand_world *w) {
    net *n = calloc(1, sizeof *n);
    if (!n)
        return NULL;
    n->objects = w->objects;
    n->blocks = (w->objects + WIDTH - 1) / WIDTH;
    n->margin = margin_of(w);
    n->h = w->h;
    memcpy(n->pull, w->pull, sizeof n->pull);
    const size_t column = n->blocks * WIDTH + 2 * n->margin;
    n->memory = aligned_alloc(64, 10 * column * sizeof *n->memory);
    n->places = malloc((w->begin[w->objects] + 1) * sizeof *n->places);
    n->first = calloc(n->blocks + 1, sizeof *n->first);
    if (!n->memory || !n->places || !n->first) {
        net_close(n);
        return NULL;
    }
    memset(n->memory, 0, 10 * column * sizeof *n->memory);
    for (int k = 0; k < 10; k++) {
        float *to = n->memory + (size_t)k * column + n->margin;
        float **at = k < 3 ? &n->x[0][k] : k < 6 ? &n->x[1][k - 3] : k < 9 ? &n->v[k - 6] : &n->w;
        const float *from = k < 6 ? w->x[k % 3] : k < 9 ? w->v[k - 6] : w->weight;
        memcpy(to, from, w->objects * sizeof *to);
        *at = to;
    }
    if (!arrange(n, w)) {
        net_close(n);
        return NULL;
    }
    return n;
}

/* ---- a step ---- */

/* The force along a spring, over its length: times the way it is the force. */
INLINE vec force_of(const place *p, vec x, vec y, vec z) {
    const vec square = madd(z, z, madd(y, y, x * x)), over = rsqrt(square);
    const vec part = load(p->rest) * over;
    return load(p->k) * (1.0f - madd(part, step_of(square, over), part));
}

INLINE vec other_of(const place *p, const float *column, size_t at) {
    return p->index ? gather(column, p->index) : load(column + (ptrdiff_t)at + p->by);
}

static void step_block(net *n, size_t block) {
    const size_t at = block * WIDTH;
    float *const *old = n->x[n->half], *const *new = n->x[1 - n->half];
    const place *p = n->places + n->first[block], *end = n->places + n->first[block + 1];
    const vec x[3] = {load(old[0] + at), load(old[1] + at), load(old[2] + at)};
    vec sum_x = all(-0.0f), sum_y = sum_x, sum_z = sum_x;
    for (; p < end; p++) {
        const vec way_x = other_of(p, old[0], at) - x[0], way_y = other_of(p, old[1], at) - x[1],
                  way_z = other_of(p, old[2], at) - x[2];
        const vec force = force_of(p, way_x, way_y, way_z);
        sum_x = add_where(p->mask, sum_x, force * way_x);
        sum_y = add_where(p->mask, sum_y, force * way_y);
        sum_z = add_where(p->mask, sum_z, force * way_z);
    }
    const vec w = load(n->w + at), sum[3] = {sum_x, sum_y, sum_z};
    for (int c = 0; c < 3; c++) {
        const vec v = madd(all(n->h), w * (n->pull[c] + sum[c]), load(n->v[c] + at));
        store(n->v[c] + at, v);
        store(new[c] + at, madd(all(n->h), v, x[c]));
    }
}

static int net_run(void *state, uint64_t steps) {
    net *n = state;
    for (; steps; steps--) {
        for (size_t b = 0; b < n->blocks; b++)
            step_block(n, b);
        n->half = 1 - n->half;
    }
    return 1;
}

static void net_read(const void *state, hand_world *w) {
    const net *n = state;
    for (int c = 0; c < 3; c++) {
        memcpy(w->x[c], n->x[n->half][c], n->objects * sizeof(float));
        memcpy(w->v[c], n->v[c], n->objects * sizeof(float));
    }
}

const hand_loop HAND(hand_net) = {.scene = "net",
                                  .kind = HAND_KIND,
                                  .open = net_open,
                                  .run = net_run,
                                  .read = net_read,
                                  .close = net_close,
                                  .is_exact = is_exact};
