/* balls.c - contact by a loop written by hand: the step of programs/world/balls.ode by
 * semi_implicit_euler.
 *
 * Objects stand in the order of a grid's cells, and each has a record of 32 bytes: those of
 * neighbours are loaded whole and transposed. Lists reach a skin farther than contact; they are
 * made again when somebody has moved by half of it. An entry's place in the order of a sum is the
 * neighbour's number, wherever it stands. Of two kinds each ball has a sum over its own and one
 * over the other kind, so it has two lists; all balls stand among each other.
 */
#include "hand.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>

#define SKIN 0.3 /* of the reach */
#define FAR 1e9f /* where nobody is: what fills up lists */
enum { RECORD = 8, CELLS_MOST = 1 << 24 };
enum { OWN, OTHER, LISTS };

typedef struct {
    size_t objects, first_kind, blocks;
    hand_contact c;
    float h, limit; /* of a square: who has moved farther needs a new list */
    float *memory, *x[3], *v[3], *since[3];
    float *records[2]; /* x y z - v_x v_y v_z - of each object, and of one that is far from all */
    int half;
    uint32_t *number, *place; /* of whom stands where; where who stands */
    int32_t *entries;         /* WIDTH for each turn of a block */
    size_t *first;            /* of each block's lists, one after the other, in turns */
    size_t room;              /* in turns */
} balls;

static void balls_close(void *state) {
    balls *b = state;
    if (!b)
        return;
    free(b->memory);
    free(b->records[0]);
    free(b->number);
    free(b->place);
    free(b->entries);
    free(b->first);
    free(b);
}

/* ---- records ---- */

#if WIDTH == 16
#define UNPACK_LOW _mm512_unpacklo_ps
#define UNPACK_HIGH _mm512_unpackhi_ps
#define SHUFFLE _mm512_shuffle_ps
typedef __m512 wide;
/* Four records in each quarter of four vectors; quarters 1 and 3 are the halves with velocities. */
INLINE wide two(const float *records, const int32_t *entry, int i) {
    const int k = i < 4 ? i : i + 4;
    const __m256d low = _mm256_castps_pd(_mm256_load_ps(records + RECORD * entry[k]));
    const __m256d high = _mm256_castps_pd(_mm256_load_ps(records + RECORD * entry[k + 4]));
    return _mm512_castpd_ps(_mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1));
}
#define JOIN_X(a, b) (vec) _mm512_shuffle_f32x4(a, b, 0x88)
#define JOIN_V(a, b) (vec) _mm512_shuffle_f32x4(a, b, 0xdd)
#else
#define UNPACK_LOW _mm256_unpacklo_ps
#define UNPACK_HIGH _mm256_unpackhi_ps
#define SHUFFLE _mm256_shuffle_ps
typedef __m256 wide;
INLINE wide two(const float *records, const int32_t *entry, int i) {
    return _mm256_load_ps(records + RECORD * entry[i]);
}
#define JOIN_X(a, b) (vec) _mm256_permute2f128_ps(a, b, 0x20)
#define JOIN_V(a, b) (vec) _mm256_permute2f128_ps(a, b, 0x31)
#endif

INLINE void load_records(const float *records, const int32_t *entry, vec x[3], vec v[3]) {
    wide part[2][3];
    for (int k = 0; k < 2; k++) {
        const wide a = two(records, entry, 4 * k), b = two(records, entry, 4 * k + 1),
                   c = two(records, entry, 4 * k + 2), d = two(records, entry, 4 * k + 3);
        const wide low = UNPACK_LOW(a, b), more = UNPACK_LOW(c, d);
        part[k][0] = SHUFFLE(low, more, 0x44);
        part[k][1] = SHUFFLE(low, more, 0xee);
        part[k][2] = SHUFFLE(UNPACK_HIGH(a, b), UNPACK_HIGH(c, d), 0x44);
    }
    for (int k = 0; k < 3; k++) {
        x[k] = JOIN_X(part[0][k], part[1][k]);
        v[k] = JOIN_V(part[0][k], part[1][k]);
    }
}

INLINE void store_part(float *to, const vec from[3]) {
    for (int q = 0; q < WIDTH / 4; q++) {
        __m128 row[4] = {_mm_setzero_ps(), _mm_setzero_ps(), _mm_setzero_ps(), _mm_setzero_ps()};
        for (int k = 0; k < 3; k++)
            memcpy(&row[k], (const char *)&from[k] + 16 * q, 16);
        _MM_TRANSPOSE4_PS(row[0], row[1], row[2], row[3]);
        for (int i = 0; i < 4; i++)
            _mm_store_ps(to + RECORD * (4 * q + i), row[i]);
    }
}

/* ---- lists ---- */

typedef struct {
    double low[3], size;
    size_t count[3];
    uint32_t *begin;
} grid;

static size_t cell_of(const grid *g, const float *const x[3], size_t i, size_t at[3]) {
    for (int k = 0; k < 3; k++)
        at[k] = (size_t)((x[k][i] - g->low[k]) / g->size);
    return (at[1] * g->count[2] + at[2]) * g->count[0] + at[0];
}

static int make_grid(const balls *b, double size, grid *g) {
    size_t cells = 1;
    g->size = size;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < b->objects; i++) {
            low = fmin(low, b->x[k][i]);
            high = fmax(high, b->x[k][i]);
        }
        if (!(high - low < 1e6 * size))
            return 0;
        g->low[k] = low;
        g->count[k] = (size_t)((high - low) / size) + 1;
        cells *= g->count[k];
        if (cells > CELLS_MOST)
            return 0;
    }
    g->begin = calloc(cells + 2, sizeof *g->begin);
    return g->begin != NULL;
}

/* Puts all objects into the order of their cells: columns by way of the records, which are free
 * now. */
static void sort(balls *b, const grid *g) {
    size_t at[3];
    const float *const x[3] = {b->x[0], b->x[1], b->x[2]};
    uint32_t *number = (uint32_t *)b->place; /* made anew below */
    for (size_t i = 0; i < b->objects; i++)
        g->begin[cell_of(g, x, i, at) + 2]++;
    size_t cells = g->count[0] * g->count[1] * g->count[2];
    for (size_t c = 2; c < cells + 2; c++)
        g->begin[c] += g->begin[c - 1];
    float *records = b->records[1 - b->half];
    for (size_t i = 0; i < b->objects; i++) {
        const size_t to = g->begin[cell_of(g, x, i, at) + 1]++;
        number[to] = b->number[i];
        for (int k = 0; k < 3; k++) {
            records[RECORD * to + (size_t)k] = b->x[k][i];
            records[RECORD * to + 4 + (size_t)k] = b->v[k][i];
        }
    }
    memcpy(b->number, number, b->objects * sizeof *number);
    for (size_t i = 0; i < b->objects; i++) {
        b->place[b->number[i]] = (uint32_t)i;
        for (int k = 0; k < 3; k++) {
            b->x[k][i] = b->since[k][i] = records[RECORD * i + (size_t)k];
            b->v[k][i] = records[RECORD * i + 4 + (size_t)k];
        }
    }
    memcpy(b->records[b->half], records, RECORD * b->objects * sizeof *records);
}

static int compare(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* The numbers of those within the distance, in order; how many. */
static uint32_t find(const balls *b, const grid *g, size_t i, double within, uint32_t *found,
                     uint32_t most) {
    size_t at[3];
    uint32_t count = 0;
    const float *const x[3] = {b->x[0], b->x[1], b->x[2]};
    cell_of(g, x, i, at);
    for (size_t y = at[1] ? at[1] - 1 : 0; y <= at[1] + 1 && y < g->count[1]; y++)
        for (size_t z = at[2] ? at[2] - 1 : 0; z <= at[2] + 1 && z < g->count[2]; z++) {
            const size_t row = (y * g->count[2] + z) * g->count[0];
            const size_t from = row + (at[0] ? at[0] - 1 : 0);
            const size_t to = row + (at[0] + 1 < g->count[0] ? at[0] + 1 : at[0]);
            for (uint32_t j = g->begin[from]; j < g->begin[to + 1]; j++) {
                const float d[3] = {x[0][j] - x[0][i], x[1][j] - x[1][i], x[2][j] - x[2][i]};
                if (j != i && d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < within && count < most)
                    found[count++] = b->number[j];
            }
        }
    qsort(found, count, sizeof *found, compare);
    return count;
}

enum { NEIGHBOURS_MOST = 256 };

/* Those of WIDTH balls whose numbers are in found[i][from[i] .. end[i] - 1]; n: of the list. */
static int put_turns(balls *b, size_t n, uint32_t found[WIDTH][NEIGHBOURS_MOST],
                     const uint32_t from[WIDTH], const uint32_t end[WIDTH]) {
    uint32_t most = 0;
    for (size_t i = 0; i < WIDTH; i++)
        most = end[i] - from[i] > most ? end[i] - from[i] : most;
    b->first[n + 1] = b->first[n] + most;
    if (b->first[n + 1] > b->room) {
        b->room = 2 * b->first[n + 1] + 64;
        int32_t *more = realloc(b->entries, b->room * WIDTH * sizeof *more);
        if (!more)
            return 0;
        b->entries = more;
    }
    for (uint32_t k = 0; k < most; k++)
        for (size_t i = 0; i < WIDTH; i++)
            b->entries[(b->first[n] + k) * WIDTH + i] =
                k < end[i] - from[i] ? (int32_t)b->place[found[i][from[i] + k]]
                                     : (int32_t)(b->blocks * WIDTH);
    return 1;
}

static int list_block(balls *b, const grid *g, size_t block, double within) {
    uint32_t found[WIDTH][NEIGHBOURS_MOST], from[LISTS][WIDTH] = {{0}}, end[LISTS][WIDTH] = {{0}};
    for (size_t i = 0; i < WIDTH && block * WIDTH + i < b->objects; i++) {
        const size_t at = block * WIDTH + i;
        const uint32_t count = find(b, g, at, within, found[i], NEIGHBOURS_MOST);
        const int is_first = b->number[at] < b->first_kind;
        uint32_t middle = 0; /* in the order of numbers the first kind comes first */
        if (count == NEIGHBOURS_MOST)
            return 0;
        while (middle < count && found[i][middle] < b->first_kind)
            middle++;
        end[is_first ? OWN : OTHER][i] = from[is_first ? OTHER : OWN][i] = middle;
        end[is_first ? OTHER : OWN][i] = count;
    }
    return put_turns(b, LISTS * block + OWN, found, from[OWN], end[OWN]) &&
           put_turns(b, LISTS * block + OTHER, found, from[OTHER], end[OTHER]);
}

/* 0: no memory, or somebody is far away or has too many neighbours. */
static int make_lists(balls *b) {
    const double reach = 2.0 * (double)b->c.radius * (1 + SKIN) * (1 + 1e-5);
    grid g = {.begin = NULL};
    int is_made = make_grid(b, reach, &g);
    if (is_made)
        sort(b, &g);
    for (size_t k = 0; is_made && k < b->blocks; k++)
        is_made = list_block(b, &g, k, reach * reach);
    free(g.begin);
    return is_made;
}

/* ---- opening ---- */

static void *balls_open(const hand_world *w) {
    balls *b = calloc(1, sizeof *b);
    if (!b)
        return NULL;
    b->objects = w->objects;
    b->first_kind = w->first_kind;
    b->blocks = (w->objects + WIDTH - 1) / WIDTH;
    b->c = w->contact;
    b->h = w->h;
    const size_t room = b->blocks * WIDTH, records = RECORD * (room + WIDTH);
    const float half_skin = (float)SKIN * w->contact.radius;
    b->limit = half_skin * half_skin * 0.999f;
    b->memory = aligned_alloc(64, 9 * room * sizeof *b->memory);
    b->records[0] = aligned_alloc(64, 2 * records * sizeof *b->memory);
    b->number = calloc(room, sizeof *b->number);
    b->place = calloc(room, sizeof *b->place);
    b->first = calloc(LISTS * b->blocks + 1, sizeof *b->first);
    if (!b->memory || !b->records[0] || !b->number || !b->place || !b->first) {
        balls_close(b);
        return NULL;
    }
    memset(b->memory, 0, 9 * room * sizeof *b->memory);
    b->records[1] = b->records[0] + records;
    for (size_t i = 0; i < 2 * records; i++)
        b->records[0][i] = FAR;
    for (int k = 0; k < 3; k++) {
        b->x[k] = b->memory + (size_t)k * room;
        b->v[k] = b->memory + (size_t)(3 + k) * room;
        b->since[k] = b->memory + (size_t)(6 + k) * room;
        memcpy(b->x[k], w->x[k], w->objects * sizeof(float));
        memcpy(b->v[k], w->v[k], w->objects * sizeof(float));
    }
    for (size_t i = 0; i < w->objects; i++)
        b->number[i] = (uint32_t)i;
    if (!make_lists(b)) {
        balls_close(b);
        return NULL;
    }
    return b;
}

/* ---- a step ---- */

INLINE vec above_0(vec a) {
    const veci is = 0.0f < a;
    return (vec)((veci)a & is);
}
INLINE vec choose(veci is, vec a, vec b) { return (vec)(((veci)a & is) | ((veci)b & ~is)); }

INLINE void push_by(const hand_contact *c, const float *records, const int32_t *entry,
                    const vec x[3], const vec v[3], vec sum[3]) {
    vec way[3], faster[3];
    load_records(records, entry, way, faster);
    for (int k = 0; k < 3; k++) {
        way[k] -= x[k];
        faster[k] -= v[k];
    }
    const vec square = madd(way[2], way[2], madd(way[1], way[1], way[0] * way[0]));
    const vec y = rsqrt(square), more = step_of(square, y), root = square * y;
    const vec part = c->stiff * (madd(root, more, root) - 2 * c->radius) * y;
    const vec force = madd(part, more, part);
#if WIDTH == 16
    const lanes is = _mm512_cmp_ps_mask((__m512)square, (__m512)all(c->reach_square), _CMP_LT_OQ);
    for (int k = 0; k < 3; k++)
        sum[k] = add_where(is, sum[k], madd(force, way[k], c->damp * faster[k]));
#else
    const veci is = square < c->reach_square;
    for (int k = 0; k < 3; k++)
        sum[k] = choose(is, sum[k] + madd(force, way[k], c->damp * faster[k]), sum[k]);
#endif
}

/* The sums over list n. */
INLINE void sum_over(const balls *b, size_t n, const vec x[3], const vec v[3], vec to[3]) {
    vec sum_x = all(-0.0f), sum_y = sum_x, sum_z = sum_x;
    for (size_t t = b->first[n]; t < b->first[n + 1]; t++) {
        vec sum[3] = {sum_x, sum_y, sum_z};
        push_by(&b->c, b->records[b->half], b->entries + t * WIDTH, x, v, sum);
        sum_x = sum[0];
        sum_y = sum[1];
        sum_z = sum[2];
    }
    to[0] = sum_x;
    to[1] = sum_y;
    to[2] = sum_z;
}

/* The largest square of how far one of the block has moved. */
static float step_block(balls *b, size_t block) {
    const hand_contact *c = &b->c;
    const size_t at = block * WIDTH;
    vec x[3], v[3], sum[3], others[3];
    for (int k = 0; k < 3; k++) {
        x[k] = load(b->x[k] + at);
        v[k] = load(b->v[k] + at);
    }
    sum_over(b, LISTS * block + OWN, x, v, sum);
    sum_over(b, LISTS * block + OTHER, x, v, others); /* of one kind -0, which changes no sum */
    vec low[3], high[3], moved = all(0);
    for (int k = 0; k < 3; k++) {
        low[k] = above_0(c->radius - x[k]);
        high[k] = above_0(x[k] + c->radius - c->wall[k]);
    }
    const vec deep = low[0] + low[1] + low[2] + high[0] + high[1] + high[2];
    const veci is_deep = 0.0f < deep;
    float *to = b->records[1 - b->half] + RECORD * at;
    for (int k = 0; k < 3; k++) {
        const vec wall = c->damp * choose(is_deep, v[k], 0.0f * v[k]);
        const vec force = sum[k] + others[k] + c->stiff * (low[k] - high[k]) - wall;
        v[k] = madd(all(b->h), madd(force, all(c->over_m), all(c->g[k])), v[k]);
        x[k] = madd(all(b->h), v[k], x[k]);
        store(b->v[k] + at, v[k]);
        store(b->x[k] + at, x[k]);
        const vec by = x[k] - load(b->since[k] + at);
        moved += by * by;
    }
    store_part(to, x);
    store_part(to + 4, v);
    float most = 0;
    for (size_t i = 0; i < WIDTH && at + i < b->objects; i++)
        most = moved[i] > most ? moved[i] : most;
    return most;
}

static int balls_run(void *state, uint64_t steps) {
    balls *b = state;
    for (; steps; steps--) {
        float most = 0;
        for (size_t k = 0; k < b->blocks; k++)
            most = fmaxf(most, step_block(b, k));
        b->half = 1 - b->half;
        if (most > b->limit && !make_lists(b))
            return 0;
    }
    return 1;
}

static void balls_read(const void *state, hand_world *w) {
    const balls *b = state;
    for (size_t i = 0; i < b->objects; i++)
        for (int k = 0; k < 3; k++) {
            w->x[k][b->number[i]] = b->x[k][i];
            w->v[k][b->number[i]] = b->v[k][i];
        }
}

const hand_loop HAND(hand_balls) = {.scene = "balls",
                                    .kind = HAND_KIND,
                                    .open = balls_open,
                                    .run = balls_run,
                                    .read = balls_read,
                                    .close = balls_close,
                                    .is_exact = is_exact};
