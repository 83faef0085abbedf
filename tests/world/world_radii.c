/* world_radii.c - lists of those that are near where each object adds its radius to the reach:
 * those of a search over all pairs, in the same order.
 *
 * Radii over three decades, of few and of many levels, on points at random and on a lattice whose
 * pairs are at the distance of their reach; one kind and two, in one to three dimensions, with
 * words that are floats and logarithms, some objects that do not live and one that is nowhere, rows
 * in another order, threads, few rows. And what a boulder costs among gravel.
 */
#include <base/threads.h>
#include <engine/common/near_few.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 1500, KINDS_OWN = 3 };

static unsigned checked, wrong, entries;

static uint32_t random_state;
static uint32_t below(uint32_t end) {
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * end >> 32);
}

static void run(void *threads, void (*task)(void *of, uint32_t number), void *of, uint32_t count) {
    fp3_threads_run(threads, task, of, count);
}

typedef struct {
    uint32_t seed, objects, dimensions;
    const fp3_config *format;
    int is_lattice, is_few, kinds, turned;
    double decades;
    const fp3_crew *crew;
} scene;

static uint32_t place[FP3_NEAR_DIMENSIONS][2 * MOST], radii[2 * MOST], row[MOST], order[MOST];
static uint8_t lives[MOST];

static uint32_t word_of(const scene *s, double x) {
    uint32_t word;
    if (fp3_format_word(s->format ? s->format : fp3_config_find("world"), (float)x, &word))
        exit(1);
    return word;
}

/* On a lattice radii are halves of its width, so that many pairs are at the distance of their
 * reach. */
static void put(const scene *s, size_t stride) {
    const double side = s->dimensions == 1 ? 4000 : s->dimensions == 2 ? 120 : 30;
    for (uint32_t i = 0; i < s->objects; i++) {
        const uint32_t at[] = {i % 13, i / 13 % 13, i / 169};
        for (uint32_t k = 0; k < s->dimensions; k++)
            place[k][i * stride] = word_of(
                s, s->is_lattice ? (double)at[k] : side * (double)below(1u << 24) * 0x1p-24);
        const double least = s->is_lattice ? 0.5 : 0.02;
        double radius = least * pow(10, s->decades * below(1000) / 1000);
        if (s->is_lattice)
            radius = 0.5 * (1 + (double)below(8));
        if (below(9) == 0 && s->seed % 3 == 0)
            radius = 0;
        if (s->decades == 0)
            radius = i % 700 == 3 ? 30 * least : least; /* boulders among gravel */
        radii[i * stride] = word_of(s, radius);
        lives[i] = below(8) > 0;
        row[i] = order[i] = i;
    }
    if (!s->format)
        place[0][7 * stride] = FP3_BITS_NAN;
    for (uint32_t i = s->objects - 1; i > 0; i--) {
        const uint32_t k = below(i + 1), m = below(i + 1), was = row[i], had = order[i];
        row[i] = row[k];
        row[k] = was;
        order[i] = order[m];
        order[m] = had;
    }
}

/* Both kinds see each other from the side of the own one. */
static int may_see(const fp3_where_they_are *w, uint32_t i, uint32_t j) {
    return !w->theirs[0] ? i != j : i < w->own && j >= w->from;
}

/* 1: it has to be in the list; 0: it must not; -1: it may. */
static int is_near(const fp3_near_rule *rule, const fp3_where_they_are *w, uint32_t i, uint32_t j) {
    double square = 0;
    for (uint32_t k = 0; k < w->dimensions; k++) {
        const double way = fp3_near_at(rule, w, k, i) - fp3_near_at(rule, w, k, j);
        square += way * way;
    }
    const double far = fp3_near_reach_of(rule, w, i, j) + rule->skin;
    const double slack = fp3_near_slack(rule);
    return square <= far * far ? 1 : square > far * far * slack * slack * (1 + 1e-6) ? 0 : -1;
}

static int is_right(const fp3_near_rule *rule, const fp3_where_they_are *w, const uint32_t *begin,
                    const uint32_t *other, uint32_t own) {
    for (uint32_t i = 0; i < own; i++) {
        uint32_t n = begin[i];
        for (uint32_t k = w->theirs[0] ? w->from : 0; k < w->objects; k++) {
            const uint32_t object = w->order ? w->order[k] : k;
            const uint32_t j = w->row && !w->theirs[0] ? w->row[object] : object;
            const int is = may_see(w, i, j) ? is_near(rule, w, i, j) : 0,
                      has = n < begin[i + 1] && other[n] == j;
            if (is >= 0 && is != has)
                return 0;
            n += (uint32_t)has;
        }
        if (n != begin[i + 1])
            return 0;
    }
    return 1;
}

static void look(const scene *s, const char *what) {
    const size_t stride = 1 + s->seed % 2;
    fp3_near_rule rule = {.dimensions = s->dimensions,
                          .format = s->format,
                          .reach = s->seed % 4 == 1 ? 0.25 : 0,
                          .radius = 1,
                          .their_radius = s->kinds == 2,
                          .share = s->seed % 5 * 0.1};
    fp3_where_they_are now = {.stride = stride,
                              .objects = s->objects,
                              .dimensions = s->dimensions,
                              .radius = radii,
                              .crew = s->crew};
    uint32_t *begin, *other, *few[2];
    fp3_error error;
    random_state = s->seed;
    put(s, stride);
    for (uint32_t k = 0; k < s->dimensions; k++)
        now.position[k] = place[k];
    if (s->kinds) { /* of KINDS_OWN rows of a third kind nobody knows */
        now.own = s->objects / 3;
        now.from = now.own + KINDS_OWN;
        for (uint32_t k = 0; k < s->dimensions; k++)
            now.theirs[k] = place[k];
        now.their_radius = s->kinds == 2 ? radii : NULL;
        now.radius = s->kinds == 3 ? NULL : radii;
        if (s->kinds == 3) {
            now.their_radius = radii;
            rule.radius = 0;
            rule.their_radius = 1;
        }
    } else if (s->turned) {
        now.row = row;
        now.order = order;
    }
    now.lives = s->seed % 2 ? lives : NULL;
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    const uint32_t own = s->kinds ? now.own : s->objects;
    checked++;
    entries += begin[own];
    if (!is_right(&rule, &now, begin, other, own)) {
        wrong++;
        printf("FAIL %s, seed %u, %u dimensions\n", what, (unsigned)s->seed,
               (unsigned)s->dimensions);
    }
    int is = !fp3_near_is_stale(&rule, &now);
    const uint32_t had = radii[2 * stride];
    radii[2 * stride] = word_of(s, 3.25);
    is &= s->kinds == 3 || fp3_near_is_stale(&rule, &now);
    radii[2 * stride] = had;
    now.own = s->is_few ? 9 : now.own;
    if (s->is_few &&
        (!fp3_near_are_few(&now) || fp3_near_make_few(&rule, &now, &few[0], &few[1], &error)))
        exit(1);
    if (s->is_few) {
        is &= memcmp(few[0], begin, 10 * sizeof *begin) == 0 &&
              memcmp(few[1], other, begin[9] * sizeof *other) == 0;
        free(few[0]);
        free(few[1]);
    }
    checked++;
    wrong += !is;
    if (!is)
        printf("FAIL %s, stale or few, seed %u\n", what, (unsigned)s->seed);
    free(begin);
    free(other);
    fp3_near_close(&rule);
}

/* Looks for each object: of gravel, with some boulders that reach 30 times farther or without. */
static double cost(uint32_t boulders, int is_one_reach) {
    enum { ALL = 20000 };
    static float x[2][ALL], radius[ALL];
    fp3_error error;
    uint32_t *begin, *other;
    fp3_near_rule rule = {.dimensions = 2, .radius = 1, .share = 0.3};
    fp3_where_they_are now = {.stride = 1, .objects = ALL, .dimensions = 2};
    for (uint32_t i = 0; i < ALL; i++) {
        radius[i] = i < boulders ? 15 : 0.5f;
        for (uint32_t k = 0; k < 2; k++)
            x[k][i] = 150 * (float)below(1u << 24) * 0x1p-24f;
    }
    for (uint32_t k = 0; k < 2; k++)
        now.position[k] = (const uint32_t *)(const void *)x[k];
    now.radius = (const uint32_t *)(const void *)radius;
    if (is_one_reach) {
        now.radius = NULL;
        rule = (fp3_near_rule){.dimensions = 2, .reach = 30, .skin = 0.3};
    }
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    const double looks = (double)rule.looks / ALL;
    free(begin);
    free(other);
    fp3_near_close(&rule);
    return looks;
}

static void boulders(void) {
    const double without = cost(0, 0), with = cost(10, 0), all = cost(10, 1);
    checked += 2;
    if (!(with < 1.2 * without) || !(all > 100 * without)) {
        wrong++;
        printf("FAIL looks: %g, with boulders %g, of one reach %g\n", without, with, all);
    }
}

int main(void) {
    fp3_threads *threads = NULL;
    fp3_error error;
    if (fp3_threads_make(2, &threads, &error))
        exit(1);
    const fp3_crew crew = {run, threads, 2};
    const fp3_config *logarithms = fp3_config_find("world_log");
    for (uint32_t seed = 0; seed < 6; seed++)
        for (uint32_t d = 1; d <= FP3_NEAR_DIMENSIONS; d++) {
            scene s = {.seed = seed, .objects = 260, .dimensions = d, .decades = 3};
            look(&s, "random");
            s.is_few = 1;
            s.objects = 240;
            look(&s, "few rows");
            s.is_few = 0;
            s.objects = 260;
            s.turned = 1;
            look(&s, "in another order");
            s.is_lattice = 1;
            look(&s, "lattice");
            s.turned = 0;
            for (s.kinds = 0; s.kinds < 4; s.kinds++) {
                s.is_lattice = seed % 2;
                look(&s, "kinds");
            }
            s.kinds = 0;
            s.format = logarithms;
            look(&s, "logarithms");
            s.format = NULL;
            s.is_lattice = 0;
            s.decades = 0;
            look(&s, "boulders");
            if (seed % 5)
                continue;
            s.objects = MOST;
            s.crew = &crew;
            look(&s, "threads");
            s.decades = 3;
            s.kinds = 2;
            look(&s, "threads and kinds");
        }
    boulders();
    fp3_threads_free(&threads);
    printf("%u checks, %u wrong, %u entries\n", checked, wrong, entries);
    return wrong != 0;
}
