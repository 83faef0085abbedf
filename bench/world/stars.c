/* stars.c - all pairs by a loop written by hand: the step of programs/world/stars.ode by leapfrog.
 *
 * Two vectors of objects go through all others together; of each one, four words are spread over a
 * vector.
 */
#include "hand.h"
#include "vector.h"

#include <stdlib.h>

enum { VECTORS = 2, BLOCK = VECTORS * WIDTH };

typedef struct {
    size_t objects, room;
    float h, soft_square;
    float *memory, *x[2][3], *v[3], *m; /* m: G m */
    int half;
} stars;

static void stars_close(void *state) {
    stars *s = state;
    if (s)
        free(s->memory);
    free(s);
}

static void *stars_open(const hand_world *w) {
    stars *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->objects = w->objects;
    s->room = (w->objects + BLOCK - 1) / BLOCK * BLOCK;
    s->h = w->h;
    s->soft_square = w->soft_square;
    s->memory = aligned_alloc(64, 10 * s->room * sizeof *s->memory);
    if (!s->memory) {
        stars_close(s);
        return NULL;
    }
    memset(s->memory, 0, 10 * s->room * sizeof *s->memory);
    for (int c = 0; c < 3; c++) {
        s->x[0][c] = s->memory + (size_t)c * s->room;
        s->x[1][c] = s->memory + (size_t)(3 + c) * s->room;
        s->v[c] = s->memory + (size_t)(6 + c) * s->room;
        memcpy(s->x[0][c], w->x[c], w->objects * sizeof(float));
        memcpy(s->v[c], w->v[c], w->objects * sizeof(float));
    }
    s->m = s->memory + 9 * s->room;
    for (size_t i = 0; i < w->objects; i++)
        s->m[i] = w->gravity * w->weight[i];
    return s;
}

INLINE void pull_by(vec m, float soft_square, const vec x[3], const vec other[3], lanes who,
                    vec sum[3]) {
    vec way[3];
    for (int c = 0; c < 3; c++)
        way[c] = other[c] - x[c];
    const vec square = madd(way[2], way[2], madd(way[1], way[1], way[0] * way[0])) + soft_square;
    const vec y = rsqrt(square), over = madd(y, step_of(square, y), y);
    const vec force = m * ((over * over) * over);
    for (int c = 0; c < 3; c++)
        sum[c] = add_where(who, sum[c], force * way[c]);
}

/* Of one vector, by objects first .. end - 1; with the objects themselves among them if is_own. */
INLINE void pull_all(const stars *s, float *const *x, size_t at, size_t first, size_t end,
                     int is_own, vec sum[VECTORS][3]) {
    vec here[VECTORS][3];
    for (int k = 0; k < VECTORS; k++)
        for (int c = 0; c < 3; c++)
            here[k][c] = load(x[c] + at + (size_t)k * WIDTH);
    for (size_t j = first; j < end; j++) {
        const vec other[3] = {all(x[0][j]), all(x[1][j]), all(x[2][j])}, m = all(s->m[j]);
        for (size_t k = 0; k < VECTORS; k++) {
            lanes who = (lanes)~0u;
            if (is_own && (j - at) / WIDTH == k)
                who = (lanes) ~(1u << (j - at) % WIDTH);
            pull_by(m, s->soft_square, here[k], other, who, sum[k]);
        }
    }
}

/* The second phase: a kick, and half a drift. */
static void step_block(stars *s, size_t at) {
    float *const *old = s->x[1], *const *new = s->x[0];
    vec sum[VECTORS][3];
    for (int k = 0; k < VECTORS; k++)
        for (int c = 0; c < 3; c++)
            sum[k][c] = all(-0.0f);
    const size_t end = at + BLOCK < s->objects ? at + BLOCK : s->objects;
    pull_all(s, old, at, 0, at, 0, sum);
    pull_all(s, old, at, at, end, 1, sum);
    pull_all(s, old, at, end, s->objects, 0, sum);
    for (size_t k = 0; k < VECTORS; k++)
        for (int c = 0; c < 3; c++) {
            const size_t i = at + k * WIDTH;
            const vec v = madd(all(s->h), sum[k][c], load(s->v[c] + i));
            store(s->v[c] + i, v);
            store(new[c] + i, madd(all(s->h / 2), v, load(old[c] + i)));
        }
}

static int stars_run(void *state, uint64_t steps) {
    stars *s = state;
    for (; steps; steps--) {
        for (int c = 0; c < 3; c++)
            for (size_t i = 0; i < s->room; i += WIDTH)
                store(s->x[1][c] + i, madd(all(s->h / 2), load(s->v[c] + i), load(s->x[0][c] + i)));
        for (size_t at = 0; at < s->objects; at += BLOCK)
            step_block(s, at);
    }
    return 1;
}

static void stars_read(const void *state, hand_world *w) {
    const stars *s = state;
    for (int c = 0; c < 3; c++) {
        memcpy(w->x[c], s->x[0][c], s->objects * sizeof(float));
        memcpy(w->v[c], s->v[c], s->objects * sizeof(float));
    }
}

const hand_loop HAND(hand_stars) = {.scene = "stars",
                                    .kind = HAND_KIND,
                                    .open = stars_open,
                                    .run = stars_run,
                                    .read = stars_read,
                                    .close = stars_close,
                                    .is_exact = is_exact};
