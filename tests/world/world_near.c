/* world_near.c - whether a list of those that are near is stale: exactly when somebody has moved by
 * more than half the skin.
 *
 * In one to three dimensions, where squares are ordinary numbers and where FP32 has none of them,
 * and also if the caller has the processor flush what is subnormal. And what lists are made of
 * where some objects are far away: the same, at a cost that does not depend on how far; and of a
 * few rows.
 */
#include <base/threads.h>
#include <engine/common/near_few.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#define FLUSH 0x8040u /* results and operands */

enum { OBJECTS = 5, MOVED = 3 };

static unsigned checked, wrong;

static void expect(const char *what, double scale, uint32_t dimensions, int is, int wanted) {
    checked++;
    if (is == wanted)
        return;
    wrong++;
    printf("FAIL %s, skin %g, %u dimensions: %d\n", what, scale, (unsigned)dimensions, is);
}

/* One of the objects moves by this share of the skin, along a diagonal. */
static int is_stale(double skin, uint32_t dimensions, float share) {
    fp3_near_rule rule = {.dimensions = dimensions, .reach = FP3_NEAR_LEAST, .skin = skin};
    fp3_where_they_are now = {.stride = 1, .objects = OBJECTS, .dimensions = dimensions};
    float place[FP3_NEAR_DIMENSIONS][OBJECTS] = {{0}};
    const float along[] = {0, 1, 0.70710678f, 0.57735027f};
    uint32_t *begin, *other;
    fp3_error error;
    for (uint32_t k = 0; k < dimensions; k++)
        now.position[k] = (const uint32_t *)(const void *)place[k];
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    for (uint32_t k = 0; k < dimensions; k++)
        place[k][MOVED] = share * (float)skin * along[dimensions];
    int is = fp3_near_is_stale(&rule, &now);
    if (share > 1e38f) { /* who is not finite has moved there, and then not any more */
        free(begin);
        free(other);
        if (fp3_near_make(&rule, &now, &begin, &other, &error))
            exit(1);
        is = is && !fp3_near_is_stale(&rule, &now) && begin[MOVED] == begin[MOVED + 1];
    }
    free(begin);
    free(other);
    fp3_near_close(&rule);
    return is;
}

/* Two that are farther apart than the reach by a few units in the last place: a program that rounds
 * in another order may see them as near, so the list has them, however narrow the skin is. */
static int has_pair_at_reach(uint32_t dimensions) {
    fp3_near_rule rule = {.dimensions = dimensions, .reach = 1, .skin = 1e-30};
    fp3_where_they_are now = {.stride = 1, .objects = 2, .dimensions = dimensions};
    float place[FP3_NEAR_DIMENSIONS][2] = {{0}};
    uint32_t *begin, *other;
    fp3_error error;
    place[dimensions - 1][1] = 1 + 0x1p-21f;
    for (uint32_t k = 0; k < dimensions; k++)
        now.position[k] = (const uint32_t *)(const void *)place[k];
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    const int has = begin[1] == 1 && begin[2] == 2 && other[0] == 1 && other[1] == 0;
    free(begin);
    free(other);
    fp3_near_close(&rule);
    return has;
}

/* ---- one that is far away ---- */

enum { SIDE = 20, MANY = SIDE * SIDE * SIDE };

/* A block of objects, `outside` of them as far away as can be in all axes; lists of `count` by a
 * search over all. Returns looks for each. */
static double look_around(float far, uint32_t outside, const fp3_crew *crew) {
    static float place[FP3_NEAR_DIMENSIONS][MANY];
    fp3_near_rule rule = {.dimensions = FP3_NEAR_DIMENSIONS, .reach = 1, .skin = 0.1};
    fp3_where_they_are now = {
        .stride = 1, .objects = MANY, .dimensions = FP3_NEAR_DIMENSIONS, .crew = crew};
    uint32_t *begin, *other;
    fp3_error error;
    uint32_t random = 1;
    for (uint32_t i = 0; i < MANY; i++)
        for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
            const uint32_t at[] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            random = random * 1664525u + 1013904223u;
            place[k][i] = (float)at[k] - SIDE / 2 + (float)(random >> 8) * 0x1p-24f;
            if (i % 97 == 5 && i / 97 < outside)
                place[k][i] =
                    k == 1 ? -far : far * (float)(1 + i / 97 % 3); /* some of them at one place */
        }
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        now.position[k] = (const uint32_t *)(const void *)place[k];
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    const float reach = (float)(1.1 * (1 + 1e-5) * 1.1 * (1 + 1e-5));
    int is_wrong = 0;
    for (uint32_t i = 0; i < MANY; i += i % 97 == 5 ? 1 : 16)
        for (uint32_t j = 0, n = begin[i]; j < MANY; j++) {
            const float x = place[0][j] - place[0][i], y = place[1][j] - place[1][i],
                        z = place[2][j] - place[2][i];
            const int is_near = i != j && x * x + y * y + z * z < reach;
            is_wrong |= is_near != (n < begin[i + 1] && other[n] == j);
            n += (uint32_t)is_near;
        }
    expect("lists are those of a search over all", (double)far, outside, is_wrong, 0);
    free(begin);
    free(other);
    fp3_near_close(&rule);
    return (double)rule.looks / MANY;
}

/* ---- several threads ---- */

static void run(void *threads, void (*task)(void *of, uint32_t number), void *of, uint32_t count) {
    fp3_threads_run(threads, task, of, count);
}

/* A caller's thread that flushes small numbers, and traps what is invalid. */
static void run_oddly(void *user, void (*task)(void *of, uint32_t number), void *of,
                      uint32_t count) {
    const unsigned callers = _mm_getcsr();
    (void)user;
    _mm_setcsr((callers | FLUSH) & ~(unsigned)_MM_MASK_INVALID);
    for (uint32_t i = 0; i < count; i++)
        task(of, i);
    _mm_setcsr(callers);
}

/* One of many objects on a line moves by this share of the skin: the first, one in the middle, the
 * last. */
static void look_together(const fp3_crew *crew) {
    enum { ALL = 100000 };
    static float place[ALL];
    fp3_near_rule rule = {.dimensions = 1, .reach = 1, .skin = 1};
    fp3_where_they_are now = {.stride = 1, .objects = ALL, .dimensions = 1, .crew = crew};
    const uint32_t movers[] = {0, ALL / 2 + 7, ALL - 1};
    uint32_t *begin, *other;
    fp3_error error;
    for (uint32_t i = 0; i < ALL; i++)
        place[i] = (float)i;
    place[3] = NAN;
    now.position[0] = (const uint32_t *)(const void *)place;
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    for (uint32_t i = 0; i < sizeof movers / sizeof *movers; i++) {
        const float was = place[movers[i]];
        place[movers[i]] = was + 0.45f;
        expect("not far enough, together", 1, movers[i], fp3_near_is_stale(&rule, &now), 0);
        place[movers[i]] = was + 0.6f;
        expect("too far, together", 1, movers[i], fp3_near_is_stale(&rule, &now), 1);
        place[movers[i]] = was;
    }
    free(begin);
    free(other);
    fp3_near_close(&rule);
}

static void many_threads(void) {
    fp3_threads *threads = NULL;
    fp3_error error;
    if (fp3_threads_make(3, &threads, &error))
        exit(1);
    const fp3_crew crew = {run, threads, 3}, odd = {run_oddly, NULL, 3};
    look_together(NULL);
    look_together(&crew);
    look_together(&odd);
    expect("few candidates, together", 15, 8, look_around(15, 8, &crew) < 100, 1);
    expect("few candidates far away, together", 1e12, 8, look_around(1e12f, 8, &crew) < 100, 1);
    fp3_threads_free(&threads);
}

/* ---- words that are logarithms ---- */

static double number(uint32_t word) {
    const double size = word & 0x7fffffff ? exp2((word & 0x7fffffff) * 0x1p-23 - 127) : 0;
    return word >> 31 ? -size : size;
}

/* An object at about x moves by some last places, to just less than half the skin, and more. */
static void move_logarithm(double x, double skin) {
    const fp3_config *config = fp3_config_find("world_log");
    fp3_near_rule rule = {.dimensions = 1, .format = config, .reach = skin, .skin = skin};
    fp3_where_they_are now = {.stride = 1, .objects = 2, .dimensions = 1};
    uint32_t place[2] = {0}, *begin, *other;
    fp3_error error;
    now.position[0] = place;
    if (fp3_format_word(config, (float)x, &place[1]) ||
        fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    const double from = number(place[1]);
    expect("a logarithm has not moved", skin, 1, fp3_near_is_stale(&rule, &now), 0);
    while (fabs(number(place[1] + 1) - from) <= skin / 2)
        place[1]++;
    expect("a logarithm not far enough", skin, 1, fp3_near_is_stale(&rule, &now), 0);
    place[1]++;
    expect("a logarithm too far", skin, 1, fp3_near_is_stale(&rule, &now), 1);
    free(begin);
    free(other);
    fp3_near_close(&rule);
}

/* Some around x, some around 0, some nowhere or far away; lists of all by a search over all. */
static void list_logarithms(double x, float far) {
    enum { SOME = 400 };
    const fp3_config *config = fp3_config_find("world_log");
    static uint32_t place[2][SOME];
    fp3_near_rule rule = {.dimensions = 2, .format = config, .reach = 0.01, .skin = 1e-9};
    fp3_where_they_are now = {.stride = 1, .objects = SOME, .dimensions = 2};
    const double reach = fp3_near_reach(&rule);
    uint32_t *begin, *other, random = 7, pairs = 0;
    fp3_error error;
    int is_wrong = 0;
    for (uint32_t i = 0; i < SOME; i++)
        for (uint32_t k = 0; k < 2; k++) {
            random = random * 1664525u + 1013904223u;
            const double at = (i % 3 ? x : 0) + (i % 9 ? 0 : (double)far) +
                              0.15 * ((random >> 8) * 0x1p-24 - 0.5);
            if (fp3_format_written(config, i % 100 == 99 ? NAN : (float)at, &place[k][i]))
                exit(1);
        }
    for (uint32_t k = 0; k < 2; k++)
        now.position[k] = place[k];
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    for (uint32_t i = 0; i < SOME; i++) {
        uint32_t n = begin[i];
        for (uint32_t j = 0; j < SOME; j++) {
            const double a = number(place[0][j]) - number(place[0][i]),
                         b = number(place[1][j]) - number(place[1][i]);
            const int is_near = i != j && i % 100 != 99 && j % 100 != 99 &&
                                a * a + b * b < (double)(float)(reach * reach);
            is_wrong |= is_near != (n < begin[i + 1] && other[n] == j);
            n += (uint32_t)is_near;
            pairs += (uint32_t)is_near;
        }
        is_wrong |= n != begin[i + 1];
    }
    expect("lists of logarithms are those of a search over all", x, 2, is_wrong || pairs < SOME, 0);
    free(begin);
    free(other);
    fp3_near_close(&rule);
}

static void logarithms(void) {
    const double at[] = {0.7, 1, 1000, -3e4, -5};
    for (uint32_t i = 0; i < sizeof at / sizeof *at; i++) {
        move_logarithm(at[i], 0.01);
        move_logarithm(at[i], 0.5);
        list_logarithms(at[i], 100);
        list_logarithms(at[i], 1e30f);
    }
}

/* ---- a few among many ---- */

enum { CROWD = 300 };

static uint32_t below(uint32_t *random, uint32_t end) {
    *random = *random * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)*random * end >> 32);
}

static void shuffle(uint32_t *random, uint32_t *list) {
    for (uint32_t i = 0; i < CROWD; i++)
        list[i] = i;
    for (uint32_t i = CROWD - 1; i > 0; i--) {
        const uint32_t k = below(random, i + 1), was = list[i];
        list[i] = list[k];
        list[k] = was;
    }
}

/* Lists of the first rows are those that are made of all rows, in the same order; the others are
 * empty. */
static uint32_t compare_few(uint32_t seed, uint32_t dimensions, const fp3_config *format) {
    static uint32_t place[FP3_NEAR_DIMENSIONS][2 * CROWD];
    uint32_t random = seed, row[CROWD], order[CROWD], *all[2], *few[2];
    uint8_t lives[CROWD];
    fp3_error error;
    const size_t stride = 1 + seed % 2;
    fp3_near_rule rule = {.dimensions = dimensions, .format = format, .reach = 2.5, .skin = 0.5};
    fp3_where_they_are now = {.stride = stride, .objects = CROWD, .dimensions = dimensions};
    for (uint32_t k = 0; k < dimensions; k++) {
        for (uint32_t i = 0; i < CROWD; i++) {
            const float x = (float)below(&random, 8000) / 1000;
            if (fp3_format_word(format ? format : fp3_config_find("world"), x,
                                &place[k][i * stride]))
                exit(1);
        }
        now.position[k] = place[k];
    }
    for (uint32_t i = 0; i < CROWD; i++)
        lives[i] = below(&random, 8) > 0;
    shuffle(&random, row);
    shuffle(&random, order);
    now.row = seed & 2 ? row : NULL;
    now.order = seed & 4 ? order : NULL;
    now.lives = seed & 8 ? lives : NULL;
    if (fp3_near_make(&rule, &now, &all[0], &all[1], &error))
        exit(1);
    now.own = 1 + below(&random, 9);
    if (!fp3_near_are_few(&now) || fp3_near_make_few(&rule, &now, &few[0], &few[1], &error))
        exit(1);
    int is_wrong = 0;
    for (uint32_t i = 0; i < CROWD; i++) {
        const uint32_t count = i < now.own ? all[0][i + 1] - all[0][i] : 0;
        is_wrong |= few[0][i + 1] - few[0][i] != count ||
                    memcmp(&few[1][few[0][i]], &all[1][all[0][i]], count * sizeof *few[1]);
    }
    expect("lists of a few rows", seed, dimensions, is_wrong, 0);
    const uint32_t found = few[0][now.own];
    for (int i = 0; i < 2; i++) {
        free(all[i]);
        free(few[i]);
    }
    fp3_near_close(&rule);
    return found;
}

static void a_few(void) {
    uint32_t found = 0;
    for (uint32_t seed = 0; seed < 64; seed++)
        for (uint32_t dimensions = 1; dimensions <= 3; dimensions++) {
            found += compare_few(seed, dimensions, NULL);
            found += compare_few(seed, dimensions, fp3_config_find("world_log"));
        }
    expect("a few rows have neighbours", 0, 3, found > 10000, 1);
}

int main(void) {
    const double skins[] = {0x1p-10, 1, 0x1p40, 2e-19, 1e-21, 1e-30};
    const unsigned callers = _mm_getcsr();
    for (uint32_t i = 0; i < 2 * sizeof skins / sizeof *skins; i++)
        for (uint32_t d = 1; d <= FP3_NEAR_DIMENSIONS; d++) {
            const double skin = skins[i / 2];
            _mm_setcsr(i % 2 ? callers | FLUSH : callers);
            expect("nobody has moved", skin, d, is_stale(skin, d, 0), 0);
            expect("not far enough", skin, d, is_stale(skin, d, 0.499f), 0);
            expect("too far", skin, d, is_stale(skin, d, 0.501f), 1);
            expect("who is not finite", skin, d, is_stale(skin, d, 1e38f * 1e38f), 1);
        }
    _mm_setcsr(callers);
    for (uint32_t d = 1; d <= FP3_NEAR_DIMENSIONS; d++)
        expect("a pair at the reach", 1e-30, d, has_pair_at_reach(d), 1);
    const float fars[] = {15, 1e4f, 3e7f, 1e12f, 1e38f};
    for (uint32_t i = 0; i < sizeof fars / sizeof *fars; i++)
        for (uint32_t outside = 1; outside <= 64; outside *= 8)
            expect("few candidates for each object", (double)fars[i], outside,
                   look_around(fars[i], outside, NULL) < 100, 1);
    a_few();
    many_threads();
    logarithms();
    printf("%u checked, %u wrong\n", checked, wrong);
    return wrong != 0;
}
