/* near.c - objects are sorted into cells as large as they see; neighbours are in the cells around. */
#include "near.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_PER_OBJECT 4.0

/* FP32 positions are exact in double, and their distances are computed in double: what the program computes in FP32
 * may be nearer by some units in the last place, for which the list reaches a little farther. */
#define ROUNDING 1e-5

static double at(const fp3_where_they_are *w, uint32_t k, size_t object) {
    float f;
    memcpy(&f, &w->position[k][object * w->stride], sizeof f);
    return f;
}

int fp3_near_is_stale(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t *astray) {
    const double most = rule->skin * rule->skin / 4;
    int is_stale = !rule->made[0];
    *astray = UINT32_MAX;
    for (uint32_t i = 0; i < now->objects; i++) {
        double way = 0;
        for (uint32_t k = 0; k < now->dimensions; k++) {
            const double x = at(now, k, i), d = rule->made[0] ? x - rule->made[k][i] : x - x;
            way += d * d;
        }
        if (way <= most)
            continue;
        is_stale = 1;
        if (way - way != 0 && *astray == UINT32_MAX) /* infinite, or a NaN */
            *astray = i;
    }
    return is_stale;
}

typedef struct {
    const fp3_where_they_are *now;
    double least[FP3_NEAR_DIMENSIONS], size; /* of a cell */
    uint32_t cells[FP3_NEAR_DIMENSIONS];
    uint32_t *cell;  /* of each object */
    uint32_t *first; /* of each cell, in `order` */
    uint32_t *order; /* objects, cell by cell, ascending */
    double far;      /* square of how far the list reaches */
} grid;

/* Cells at least as large as the list reaches, and not many more than there are objects. */
static void measure(grid *g, double reach) {
    double extent[FP3_NEAR_DIMENSIONS] = {0}, most[FP3_NEAR_DIMENSIONS] = {0}, count;
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        g->least[k] = most[k] = at(g->now, k, 0);
        for (uint32_t i = 1; i < g->now->objects; i++) {
            g->least[k] = fmin(g->least[k], at(g->now, k, i));
            most[k] = fmax(most[k], at(g->now, k, i));
        }
        extent[k] = most[k] - g->least[k];
    }
    g->size = reach;
    do {
        count = 1;
        for (uint32_t k = 0; k < g->now->dimensions; k++)
            count *= floor(extent[k] / g->size) + 1;
        if (count > CELLS_PER_OBJECT * g->now->objects + 64)
            g->size *= 1.25;
    } while (count > CELLS_PER_OBJECT * g->now->objects + 64);
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        g->cells[k] = k < g->now->dimensions ? (uint32_t)floor(extent[k] / g->size) + 1 : 1;
}

static uint32_t column(const grid *g, uint32_t k, uint32_t object) {
    if (k >= g->now->dimensions)
        return 0;
    const double c = floor((at(g->now, k, object) - g->least[k]) / g->size);
    return c < 0 ? 0 : c >= g->cells[k] ? g->cells[k] - 1 : (uint32_t)c;
}

static fp3_status sort(grid *g, fp3_error *error) {
    const uint32_t objects = g->now->objects;
    const size_t cells = (size_t)g->cells[0] * g->cells[1] * g->cells[2];
    g->cell = malloc((objects + 1u) * sizeof *g->cell);
    g->order = malloc((objects + 1u) * sizeof *g->order);
    g->first = calloc(cells + 2, sizeof *g->first);
    if (!g->cell || !g->order || !g->first)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; i < objects; i++) {
        g->cell[i] =
            (column(g, 2, i) * g->cells[1] + column(g, 1, i)) * g->cells[0] + column(g, 0, i);
        g->first[g->cell[i] + 2]++;
    }
    for (size_t c = 2; c < cells + 2; c++)
        g->first[c] += g->first[c - 1];
    for (uint32_t i = 0; i < objects; i++)
        g->order[g->first[g->cell[i] + 1]++] = i;
    return FP3_OK;
}

static int is_near(const grid *g, uint32_t i, uint32_t j) {
    double way = 0;
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        const double d = at(g->now, k, i) - at(g->now, k, j);
        way += d * d;
    }
    return way < g->far;
}

/* The cells around an object's, and its own: from low to high along each axis. */
typedef struct {
    uint32_t low[FP3_NEAR_DIMENSIONS], high[FP3_NEAR_DIMENSIONS];
} around;

static around around_of(const grid *g, uint32_t object) {
    around a;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        const uint32_t c = column(g, k, object);
        a.low[k] = c ? c - 1 : 0;
        a.high[k] = c + 1 < g->cells[k] ? c + 1 : c;
    }
    return a;
}

static int by_number(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Those of one object; other == NULL: they are counted. */
static uint32_t find(const grid *g, uint32_t object, uint32_t *other) {
    const around a = around_of(g, object);
    uint32_t count = 0;
    for (uint32_t z = a.low[2]; z <= a.high[2]; z++)
        for (uint32_t y = a.low[1]; y <= a.high[1]; y++) {
            const size_t row = ((size_t)z * g->cells[1] + y) * g->cells[0];
            for (uint32_t n = g->first[row + a.low[0]]; n < g->first[row + a.high[0] + 1]; n++) {
                const uint32_t j = g->order[n];
                if (j == object || !is_near(g, object, j))
                    continue;
                if (other)
                    other[count] = j;
                count++;
            }
        }
    if (other)
        qsort(other, count, sizeof *other, by_number);
    return count;
}

static fp3_status fill(const grid *g, uint32_t **begin, uint32_t **other, fp3_error *error) {
    const uint32_t objects = g->now->objects;
    uint64_t entries = 0;
    *begin = malloc((objects + 2u) * sizeof **begin);
    if (!*begin)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; i < objects; i++) {
        (*begin)[i] = (uint32_t)entries;
        entries += find(g, i, NULL);
        if (entries > INT32_MAX)
            return fp3_fail(
                error, FP3_E_LIMIT,
                "a list of those that are near has more than 2147483647 entries: object %" PRIu32
                " of %" PRIu32 " is too much, or the reach is too long",
                i, objects);
    }
    (*begin)[objects] = (uint32_t)entries;
    *other = malloc(((size_t)entries + 1) * sizeof **other);
    if (!*other)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (uint32_t i = 0; i < objects; i++)
        find(g, i, *other + (*begin)[i]);
    return FP3_OK;
}

static fp3_status remember(fp3_near_rule *rule, const fp3_where_they_are *now, fp3_error *error) {
    for (uint32_t k = 0; k < now->dimensions; k++) {
        if (!rule->made[k])
            rule->made[k] = malloc((now->objects + 1u) * sizeof(double));
        if (!rule->made[k])
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        for (uint32_t i = 0; i < now->objects; i++)
            rule->made[k][i] = at(now, k, i);
    }
    rule->lists++;
    return FP3_OK;
}

fp3_status fp3_near_make(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                         uint32_t **other, fp3_error *error) {
    const double reach = (rule->reach + rule->skin) * (1 + ROUNDING);
    grid g = {.now = now, .far = reach * reach};
    *begin = *other = NULL;
    measure(&g, reach);
    fp3_status status = sort(&g, error);
    if (!status)
        status = fill(&g, begin, other, error);
    if (!status)
        status = remember(rule, now, error);
    free(g.cell);
    free(g.order);
    free(g.first);
    return status;
}

void fp3_near_close(fp3_near_rule *rule) {
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        free(rule->made[k]);
        rule->made[k] = NULL;
    }
}
