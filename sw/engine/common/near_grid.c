/* SPDX-License-Identifier: Apache-2.0 */
/* near_grid.c - see near_grid.h. */
#include "near_grid.h"

#include <stdlib.h>

#define CELLS_PER_OBJECT 4.0
#define LARGER 2.0 /* cells of a box are at most this much larger than a list reaches */

/* From this cell on numbers of FP32 are farther apart than a cell is wide: those that are near have
 * the same number. */
#define LAST_CELL 0x1p25

static uint32_t row_of(const fp3_near_grid *g, uint32_t i) {
    return g->of.rows ? g->of.rows[i] : i;
}

/* Where a number is not finite, the object is nowhere. */
static void find_box(fp3_near_grid *g, double extent[FP3_NEAR_DIMENSIONS]) {
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        double least = INFINITY, most = -INFINITY;
        for (uint32_t i = 0; i < g->of.count; i++) {
            const double x = fp3_near_at(g->rule, g->now, k, row_of(g, i)), size = fabs(x);
            least = x < least && size < INFINITY ? x : least;
            most = x > most && size < INFINITY ? x : most;
        }
        g->least[k] = least <= most ? least : 0;
        extent[k] = least <= most ? most - least : 0;
    }
}

/* Cells at least as large as the list reaches, and not many more than there are objects. */
static void measure(fp3_near_grid *g) {
    const double reach = g->of.reach;
    double extent[FP3_NEAR_DIMENSIONS] = {0}, count;
    find_box(g, extent);
    g->size = reach;
    do {
        count = 1;
        for (uint32_t k = 0; k < g->now->dimensions; k++)
            count *= floor(extent[k] / g->size) + 1;
        if (count > CELLS_PER_OBJECT * g->of.count + 64)
            g->size *= 1.25;
    } while (count > CELLS_PER_OBJECT * g->of.count + 64);
    if (!g->of.is_box && g->size > LARGER * reach) {
        g->size = reach *
                  (1 + FP3_NEAR_ROUNDING); /* so that no rounding puts who is near two cells away */
        for (g->mask = 1; g->mask < 2.0 * g->of.count;)
            g->mask = 2 * g->mask + 1;
    }
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        g->cells[k] =
            !g->mask && k < g->now->dimensions ? (uint32_t)floor(extent[k] / g->size) + 1 : 1;
}

static uint32_t column(const fp3_near_grid *g, uint32_t k, double x) {
    if (k >= g->now->dimensions)
        return 0;
    const double c = (x - g->least[k]) / g->size;
    return !(c >= 0) ? 0 : c < g->cells[k] ? (uint32_t)c : g->cells[k] - 1;
}

/* The cell of a number; without a box. */
static double cell_at(const fp3_near_grid *g, double x) { return floor(x / g->size) + 0.0; }

/* What is left of the hash of a cell. */
static uint32_t hash(const fp3_near_grid *g, const double cell[FP3_NEAR_DIMENSIONS]) {
    uint64_t sum = 0;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        uint64_t bits;
        memcpy(&bits, &cell[k], sizeof bits);
        sum = (sum ^ bits >> 32 ^ bits) *
              0x9e3779b97f4a7c15u; /* of small numbers the lower half is 0 */
        sum ^= sum >> 32;
    }
    return (uint32_t)sum & g->mask;
}

static uint32_t find_cell(const fp3_near_grid *g, uint32_t row) {
    double at[FP3_NEAR_DIMENSIONS] = {0};
    for (uint32_t k = 0; k < g->now->dimensions; k++)
        at[k] = fp3_near_at(g->rule, g->now, k, row);
    if (!g->mask)
        return (column(g, 2, at[2]) * g->cells[1] + column(g, 1, at[1])) * g->cells[0] +
               column(g, 0, at[0]);
    for (uint32_t k = 0; k < g->now->dimensions; k++)
        at[k] = cell_at(g, at[k]);
    return hash(g, at);
}

static void find_cells(void *of, uint32_t part) {
    const fp3_near_grid *g = of;
    const fp3_row_range own = fp3_near_part((fp3_row_range){0, g->of.count}, part, g->parts);
    for (uint32_t i = own.first; i < own.end; i++)
        g->cell[i] = find_cell(g, row_of(g, i));
}

static fp3_status sort(fp3_near_grid *g, fp3_error *error) {
    const uint32_t objects = g->of.count;
    const size_t cells =
        g->mask ? (size_t)g->mask + 1 : (size_t)g->cells[0] * g->cells[1] * g->cells[2];
    g->cell = malloc((objects + 2u) * sizeof *g->cell);
    g->order = malloc((objects + 1u) * sizeof *g->order);
    g->first = calloc(cells + 2, sizeof *g->first);
    const size_t places = (size_t)(objects + 1u) * FP3_NEAR_DIMENSIONS;
    if (fp3_near_is_exact(g->rule))
        g->exact[0] = calloc(places, sizeof(double));
    else
        g->place[0] = calloc(places, sizeof(float));
    if (g->of.shares)
        g->share = malloc((objects + 1u) * sizeof *g->share);
    if (!g->cell || !g->order || !g->first || !(g->exact[0] || g->place[0]) ||
        (g->of.shares && !g->share))
        return fp3_no_memory(error);
    for (uint32_t k = 1; k < FP3_NEAR_DIMENSIONS; k++) {
        g->place[k] = g->place[0] ? g->place[k - 1] + objects + 1 : NULL;
        g->exact[k] = g->exact[0] ? g->exact[k - 1] + objects + 1 : NULL;
    }
    g->parts = objects < FP3_NEAR_TOGETHER ? 1 : fp3_parts_of(g->now->crew);
    fp3_parts_make(g->now->crew, find_cells, g, g->parts);
    for (uint32_t i = 0; i < objects; i++)
        g->first[g->cell[i] + 2]++;
    for (size_t c = 2; c < cells + 2; c++)
        g->first[c] += g->first[c - 1];
    for (uint32_t i = 0; i < objects; i++) {
        const uint32_t n = g->first[g->cell[i] + 1]++, row = row_of(g, i);
        g->order[n] = row;
        if (g->share)
            g->share[n] = g->of.shares[row];
        for (uint32_t k = 0; k < g->now->dimensions; k++)
            if (g->place[0])
                g->place[k][n] = (float)fp3_near_at(g->rule, g->now, k, row);
            else
                g->exact[k][n] = fp3_near_at(g->rule, g->now, k, row);
    }
    return FP3_OK;
}

/* ---- those that are near ---- */

/* Of the rows order[from] .. order[end - 1] those that are near one at this place; itself, too.
 * There is room for all. */
static uint32_t find(const fp3_near_grid *g, const double *place, uint32_t from, uint32_t end,
                     uint32_t *found) {
    const float at[] = {(float)place[0], (float)place[1], (float)place[2]};
    uint32_t count = 0;
    for (uint32_t n = from; n < end; n++) {
        const float x = g->place[0][n] - at[0], y = g->place[1][n] - at[1],
                    z = g->place[2][n] - at[2];
        found[count] = g->order[n];
        count += x * x + y * y + z * z < g->far;
    }
    return count;
}

/* How far those reach differs. */
static uint32_t find_each(const fp3_near_grid *g, const fp3_near_seeker *s, uint32_t from,
                          uint32_t end, uint32_t *found) {
    const float at[] = {(float)s->place[0], (float)s->place[1], (float)s->place[2]};
    uint32_t count = 0;
    for (uint32_t n = from; n < end; n++) {
        const float x = g->place[0][n] - at[0], y = g->place[1][n] - at[1],
                    z = g->place[2][n] - at[2], reach = g->share[n] + s->share;
        found[count] = g->order[n];
        count += x * x + y * y + z * z < reach * reach;
    }
    return count;
}

static uint32_t find_exact(const fp3_near_grid *g, const fp3_near_seeker *s, uint32_t from,
                           uint32_t end, uint32_t *found) {
    const double *place = s->place;
    uint32_t count = 0;
    for (uint32_t n = from; n < end; n++) {
        const double x = g->exact[0][n] - place[0], y = g->exact[1][n] - place[1],
                     z = g->exact[2][n] - place[2];
        found[count] = g->order[n];
        const float reach = g->share ? g->share[n] + s->share : 0;
        count += x * x + y * y + z * z < (double)(g->share ? reach * reach : g->far);
    }
    return count;
}

fp3_status fp3_near_need_room(fp3_near_found *p, size_t more, fp3_error *error) {
    if (p->count + more <= p->room)
        return FP3_OK;
    const size_t room = 2 * p->room + more + 4096;
    uint32_t *found = realloc(p->found, room * sizeof *found);
    if (!found)
        return fp3_no_memory(error);
    p->found = found;
    p->room = room;
    return FP3_OK;
}

/* Those of order[from] .. order[end - 1]. */
static fp3_status take(const fp3_near_grid *g, const fp3_near_seeker *s, uint32_t from,
                       uint32_t end, fp3_near_found *p, fp3_error *error) {
    if (from == end)
        return FP3_OK;
    const fp3_status status = fp3_near_need_room(p, end - from + (size_t)1, error);
    p->looks += end - from;
    if (!status)
        p->count += g->exact[0] ? find_exact(g, s, from, end, p->found + p->count)
                    : g->share  ? find_each(g, s, from, end, p->found + p->count)
                                : find(g, s->place, from, end, p->found + p->count);
    return status;
}

/* The columns beside a seeker's, and its own; of one that reaches less than the grid only those
 * that it reaches. */
static void find_columns(const fp3_near_grid *g, uint32_t k, const fp3_near_seeker *s,
                         uint32_t *low, uint32_t *high) {
    const double reach = g->of.reach / 2 + (double)s->share;
    if (g->share) {
        *low = column(g, k, s->place[k] - reach);
        *high = column(g, k, s->place[k] + reach);
        return;
    }
    const uint32_t c = column(g, k, s->place[k]);
    *low = c ? c - 1 : 0;
    *high = c + 1 < g->cells[k] ? c + 1 : c;
}

/* The cells around a seeker's, and its own, a line of them at a time. */
static fp3_status find_in_box(const fp3_near_grid *g, const fp3_near_seeker *s, fp3_near_found *p,
                              fp3_error *error) {
    uint32_t low[FP3_NEAR_DIMENSIONS], high[FP3_NEAR_DIMENSIONS];
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        find_columns(g, k, s, &low[k], &high[k]);
    for (uint32_t z = low[2]; !status && z <= high[2]; z++)
        for (uint32_t y = low[1]; !status && y <= high[1]; y++) {
            const size_t line = ((size_t)z * g->cells[1] + y) * g->cells[0];
            status = take(g, s, g->first[line + low[0]], g->first[line + high[0] + 1], p, error);
        }
    return status;
}

/* The same cells, each by itself; those that have one hash are looked at once. */
static fp3_status find_by_hash(const fp3_near_grid *g, const fp3_near_seeker *s, fp3_near_found *p,
                               fp3_error *error) {
    uint32_t hashes[27], count = 0;
    double own[FP3_NEAR_DIMENSIONS] = {0};
    int wide[FP3_NEAR_DIMENSIONS] = {0};
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        own[k] = cell_at(g, s->place[k]);
        wide[k] = g->rule->is_pair || fabs(own[k]) < LAST_CELL;
    }
    for (int z = -wide[2]; z <= wide[2]; z++)
        for (int y = -wide[1]; y <= wide[1]; y++)
            for (int x = -wide[0]; x <= wide[0]; x++)
                hashes[count++] =
                    hash(g, (const double[]){own[0] + x + 0.0, own[1] + y + 0.0, own[2] + z + 0.0});
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t n = 0;
        while (hashes[n] != hashes[i])
            n++;
        if (n == i)
            status = take(g, s, g->first[hashes[i]], g->first[hashes[i] + 1], p, error);
    }
    return status;
}

fp3_status fp3_near_grid_find(const fp3_near_grid *grid, const fp3_near_seeker *seeker,
                              fp3_near_found *found, fp3_error *error) {
    return (grid->mask ? find_by_hash : find_in_box)(grid, seeker, found, error);
}

fp3_status fp3_near_grid_open(const fp3_near_rule *rule, const fp3_where_they_are *now,
                              const fp3_near_members *of, fp3_near_grid *grid, fp3_error *error) {
    *grid =
        (fp3_near_grid){.rule = rule, .now = now, .of = *of, .far = (float)(of->reach * of->reach)};
    measure(grid);
    return sort(grid, error);
}

void fp3_near_grid_close(fp3_near_grid *grid) {
    free(grid->cell);
    free(grid->order);
    free(grid->first);
    free(grid->place[0]);
    free(grid->exact[0]);
    free(grid->share);
    *grid = (fp3_near_grid){.size = 0};
}
