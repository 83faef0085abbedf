/* SPDX-License-Identifier: Apache-2.0 */
/* near.c - objects are sorted into cells as large as they see; neighbours are in the cells around.
 *
 * Cells fill a box, where all objects are in a box of not many more cells than there are objects.
 * Where some are far away, only cells with objects in them are kept, by a hash of where they are:
 * then the cost does not depend on the box.
 */
#include "near.h"

#include <inttypes.h>
#include <stdlib.h>

#define CELLS_PER_OBJECT 4.0
#define LARGER 2.0 /* cells of a box are at most this much larger than a list reaches */

/* From this cell on numbers of FP32 are farther apart than a cell is wide: those that are near have
 * the same number. */
#define LAST_CELL 0x1p25

/* From this number of objects on threads are asked for help. */
#define FIND_TOGETHER 1024u

/* ---- the grid ---- */

typedef struct {
    const fp3_near_rule *rule;
    const fp3_where_they_are *now;
    uint32_t objects;                        /* the first rows: those that are in the grid */
    double least[FP3_NEAR_DIMENSIONS], size; /* of a cell */
    uint32_t cells[FP3_NEAR_DIMENSIONS];     /* of the box */
    uint32_t mask;                           /* 0: there is a box; else hashes are cut with it */
    uint32_t *cell;                          /* of each of them; of a hash: what is left of it */
    uint32_t *first;                         /* of each cell, in `order` */
    uint32_t *order;                         /* rows, cell by cell, ascending */
    float *place[FP3_NEAR_DIMENSIONS];       /* of each row, in this order; NULLs: ... */
    double *exact[FP3_NEAR_DIMENSIONS];      /* ... where words are no floats */
    float far;                               /* square of how far the list reaches */
    uint32_t parts;                          /* in which the cells of rows are found */
} grid;

/* Where a number is not finite, the object is nowhere. */
static void find_box(grid *g, double extent[FP3_NEAR_DIMENSIONS]) {
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        double least = INFINITY, most = -INFINITY;
        for (uint32_t i = 0; i < g->objects; i++) {
            const double x = fp3_near_at(g->rule, g->now, k, i), size = fabs(x);
            least = x < least && size < INFINITY ? x : least;
            most = x > most && size < INFINITY ? x : most;
        }
        g->least[k] = least <= most ? least : 0;
        extent[k] = least <= most ? most - least : 0;
    }
}

/* Cells at least as large as the list reaches, and not many more than there are objects. is_box:
 * nothing but a box will do. */
static void measure(grid *g, double reach, int is_box) {
    double extent[FP3_NEAR_DIMENSIONS] = {0}, count;
    find_box(g, extent);
    g->size = reach;
    do {
        count = 1;
        for (uint32_t k = 0; k < g->now->dimensions; k++)
            count *= floor(extent[k] / g->size) + 1;
        if (count > CELLS_PER_OBJECT * g->objects + 64)
            g->size *= 1.25;
    } while (count > CELLS_PER_OBJECT * g->objects + 64);
    if (!is_box && g->size > LARGER * reach) {
        g->size = reach *
                  (1 + FP3_NEAR_ROUNDING); /* so that no rounding puts who is near two cells away */
        for (g->mask = 1; g->mask < 2.0 * g->objects;)
            g->mask = 2 * g->mask + 1;
    }
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        g->cells[k] =
            !g->mask && k < g->now->dimensions ? (uint32_t)floor(extent[k] / g->size) + 1 : 1;
}

static int is_astray(const grid *g, uint32_t row) {
    int is = 0;
    for (uint32_t k = 0; k < g->now->dimensions; k++)
        is |= !isfinite(fp3_near_at(g->rule, g->now, k, row));
    return is;
}

static uint32_t column(const grid *g, uint32_t k, uint32_t row) {
    if (k >= g->now->dimensions)
        return 0;
    const double c = (fp3_near_at(g->rule, g->now, k, row) - g->least[k]) / g->size;
    return !(c >= 0) ? 0 : c < g->cells[k] ? (uint32_t)c : g->cells[k] - 1;
}

/* The cell of a number; without a box. */
static double cell_at(const grid *g, double x) { return floor(x / g->size) + 0.0; }

/* What is left of the hash of a cell. */
static uint32_t hash(const grid *g, const double cell[FP3_NEAR_DIMENSIONS]) {
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

static uint32_t find_cell(const grid *g, uint32_t row) {
    double cell[FP3_NEAR_DIMENSIONS] = {0};
    if (!g->mask)
        return (column(g, 2, row) * g->cells[1] + column(g, 1, row)) * g->cells[0] +
               column(g, 0, row);
    for (uint32_t k = 0; k < g->now->dimensions; k++)
        cell[k] = cell_at(g, fp3_near_at(g->rule, g->now, k, row));
    return hash(g, cell);
}

static void find_cells(void *of, uint32_t part) {
    const grid *g = of;
    const fp3_row_range own = fp3_near_part((fp3_row_range){0, g->objects}, part, g->parts);
    for (uint32_t i = own.first; i < own.end; i++)
        g->cell[i] = find_cell(g, i);
}

static fp3_status sort(grid *g, fp3_error *error) {
    const uint32_t objects = g->objects;
    const size_t cells =
        g->mask ? (size_t)g->mask + 1 : (size_t)g->cells[0] * g->cells[1] * g->cells[2];
    g->cell = malloc((objects + 2u) * sizeof *g->cell);
    g->order = malloc((objects + 1u) * sizeof *g->order);
    g->first = calloc(cells + 2, sizeof *g->first);
    const size_t places = (size_t)(objects + 1u) * FP3_NEAR_DIMENSIONS;
    if (g->rule->format)
        g->exact[0] = calloc(places, sizeof(double));
    else
        g->place[0] = calloc(places, sizeof(float));
    if (!g->cell || !g->order || !g->first || !(g->exact[0] || g->place[0]))
        return fp3_no_memory(error);
    for (uint32_t k = 1; k < FP3_NEAR_DIMENSIONS; k++) {
        g->place[k] = g->place[0] ? g->place[k - 1] + objects + 1 : NULL;
        g->exact[k] = g->exact[0] ? g->exact[k - 1] + objects + 1 : NULL;
    }
    g->parts = fp3_near_parts(g->now, FIND_TOGETHER);
    fp3_parts_make(g->now->crew, find_cells, g, g->parts);
    for (uint32_t i = 0; i < objects; i++)
        g->first[g->cell[i] + 2]++;
    for (size_t c = 2; c < cells + 2; c++)
        g->first[c] += g->first[c - 1];
    for (uint32_t i = 0; i < objects; i++) {
        const uint32_t n = g->first[g->cell[i] + 1]++;
        g->order[n] = i;
        for (uint32_t k = 0; k < g->now->dimensions; k++)
            if (g->place[0])
                g->place[k][n] = (float)fp3_near_at(g->rule, g->now, k, i);
            else
                g->exact[k][n] = fp3_near_at(g->rule, g->now, k, i);
    }
    return FP3_OK;
}

/* Pairs of rows that are near, from the side of each: row i has found[first[i]] .. of them, in the
 * order of the cells. A part of the rows. */
typedef struct {
    uint32_t *first; /* of all rows; each has one more behind it */
    uint32_t *found;
    size_t count, room;
    uint64_t looks; /* at how many objects it took to find them */
    uint32_t begin, end;
    fp3_status status;
    fp3_error error;
} pairs;

/* ---- those that are near ---- */

/* Of the rows order[from] .. order[end - 1] those that are near one at this place; itself, too.
 * There is room for all. */
static uint32_t find(const grid *g, const double *place, uint32_t from, uint32_t end,
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

static uint32_t find_exact(const grid *g, const double *place, uint32_t from, uint32_t end,
                           uint32_t *found) {
    uint32_t count = 0;
    for (uint32_t n = from; n < end; n++) {
        const double x = g->exact[0][n] - place[0], y = g->exact[1][n] - place[1],
                     z = g->exact[2][n] - place[2];
        found[count] = g->order[n];
        count += x * x + y * y + z * z < (double)g->far;
    }
    return count;
}

static fp3_status need_room(pairs *p, size_t more, fp3_error *error) {
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
static fp3_status take(const grid *g, const double *place, uint32_t from, uint32_t end, pairs *p,
                       fp3_error *error) {
    const fp3_status status = need_room(p, end - from + (size_t)1, error);
    p->looks += end - from;
    if (!status)
        p->count += (g->exact[0] ? find_exact : find)(g, place, from, end, p->found + p->count);
    return status;
}

/* The cells around a row's, and its own, a line of them at a time. */
static fp3_status find_in_box(const grid *g, uint32_t row, const double *place, pairs *p,
                              fp3_error *error) {
    uint32_t low[FP3_NEAR_DIMENSIONS], high[FP3_NEAR_DIMENSIONS];
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        const uint32_t c = column(g, k, row);
        low[k] = c ? c - 1 : 0;
        high[k] = c + 1 < g->cells[k] ? c + 1 : c;
    }
    for (uint32_t z = low[2]; !status && z <= high[2]; z++)
        for (uint32_t y = low[1]; !status && y <= high[1]; y++) {
            const size_t line = ((size_t)z * g->cells[1] + y) * g->cells[0];
            status =
                take(g, place, g->first[line + low[0]], g->first[line + high[0] + 1], p, error);
        }
    return status;
}

/* The same cells, each by itself; those that have one hash are looked at once. */
static fp3_status find_by_hash(const grid *g, const double *place, pairs *p, fp3_error *error) {
    uint32_t hashes[27], count = 0;
    double own[FP3_NEAR_DIMENSIONS] = {0};
    int wide[FP3_NEAR_DIMENSIONS] = {0};
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; k < g->now->dimensions; k++) {
        own[k] = cell_at(g, place[k]);
        wide[k] = fabs(own[k]) < LAST_CELL;
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
            status = take(g, place, g->first[hashes[i]], g->first[hashes[i] + 1], p, error);
    }
    return status;
}

/* An object whose position is not finite has found no object but itself. */
static fp3_status find_itself(uint32_t row, pairs *p, fp3_error *error) {
    const fp3_status status = need_room(p, 1, error);
    if (!status)
        p->found[p->count++] = row;
    return status;
}

static fp3_status too_many(const grid *g, fp3_error *error) {
    return fp3_fail(error, FP3_E_LIMIT,
                    "the lists of near objects have more than 2147483647 entries: the %" PRIu32
                    " objects are too many, or the reach is too long",
                    g->now->objects);
}

static fp3_status find_around(const grid *g, uint32_t row, pairs *p, fp3_error *error) {
    double place[FP3_NEAR_DIMENSIONS] = {0};
    for (uint32_t k = 0; k < g->now->dimensions; k++)
        place[k] = fp3_near_at(g->rule, g->now, k, row);
    p->first[row] = (uint32_t)p->count;
    fp3_status status = is_astray(g, row)
                            ? (g->now->theirs[0] ? FP3_OK : find_itself(row, p, error))
                        : g->mask ? find_by_hash(g, place, p, error)
                                  : find_in_box(g, row, place, p, error);
    return !status && p->count > INT32_MAX ? too_many(g, error) : status;
}

/* All parts, and where each row's begin in its part. */
typedef struct {
    const grid *g;
    pairs *part;
    uint32_t *first, count;
} search;

static void find_part(void *of, uint32_t number) {
    const search *s = of;
    pairs *p = &s->part[number];
    for (uint32_t i = p->begin; !p->status && i < p->end; i++)
        p->status = find_around(s->g, i, p, &p->error);
}

static fp3_status find_pairs(search *s, fp3_error *error) {
    const fp3_row_range theirs = fp3_near_sought(s->g->now);
    s->count = fp3_near_parts(s->g->now, FIND_TOGETHER);
    s->part = calloc(s->count, sizeof *s->part);
    s->first = malloc((theirs.end + 2u) * sizeof *s->first);
    if (!s->part || !s->first)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < s->count; i++) {
        s->part[i].first = s->first;
        s->part[i].begin = fp3_near_part(theirs, i, s->count).first;
        s->part[i].end = fp3_near_part(theirs, i, s->count).end;
    }
    fp3_parts_make(s->g->now->crew, find_part, s, s->count);
    size_t all = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const pairs *p = &s->part[i];
        if (p->status && error)
            *error = p->error;
        if (p->status)
            return p->status;
        all += p->count;
    }
    return all > INT32_MAX ? too_many(s->g, error) : FP3_OK;
}

static uint32_t end_of(const pairs *p, uint32_t row) {
    return row + 1 < p->end ? p->first[row + 1] : (uint32_t)p->count;
}

/* The part that has this row. */
static uint32_t part_with(const search *s, uint32_t row) {
    uint32_t part = (uint32_t)((uint64_t)row * s->count / s->g->now->objects);
    while (row >= s->part[part].end)
        part++;
    return part;
}

/* Each object is near those that are near it. So if objects come in the order of their numbers, and
 * each enters itself in the lists of those that it has found, all lists have that order. Each has
 * found itself, too. */
static fp3_status enter(const search *s, uint32_t **begin, uint32_t **other, fp3_error *error) {
    const grid *g = s->g;
    const uint32_t objects = g->now->objects;
    uint32_t *next = g->cell, count = 0; /* `cell` has served */
    *begin = malloc((objects + 2u) * sizeof **begin);
    for (uint32_t k = 0; *begin && k < s->count; k++)
        for (uint32_t i = s->part[k].begin; i < s->part[k].end; i++) {
            (*begin)[i] = count;
            count += end_of(&s->part[k], i) - s->first[i] - 1;
        }
    *other = malloc((count + (size_t)1) * sizeof **other);
    if (!*begin || !*other)
        return fp3_no_memory(error);
    (*begin)[objects] = count;
    memcpy(next, *begin, objects * sizeof *next);
    for (uint32_t i = 0; i < objects; i++) {
        const uint32_t object = g->now->order ? g->now->order[i] : i;
        const uint32_t j = g->now->row ? g->now->row[object] : object;
        const pairs *p = &s->part[part_with(s, j)];
        for (uint32_t n = s->first[j], end = end_of(p, j); n < end; n++)
            if (p->found[n] != j)
                (*other)[next[p->found[n]]++] = j;
    }
    return FP3_OK;
}

/* Each object of another kind enters itself in the lists of those that it has found. */
static fp3_status enter_theirs(const search *s, uint32_t **begin, uint32_t **other,
                               fp3_error *error) {
    const uint32_t own = s->g->objects;
    uint32_t *next = s->g->cell; /* which has served */
    *begin = calloc(s->g->now->objects + 2u, sizeof **begin);
    if (!*begin)
        return fp3_no_memory(error);
    for (uint32_t k = 0; k < s->count; k++)
        for (size_t n = 0; n < s->part[k].count; n++)
            (*begin)[s->part[k].found[n] + 1]++;
    for (uint32_t i = 0; i < s->g->now->objects; i++)
        (*begin)[i + 1] += (*begin)[i];
    memcpy(next, *begin, (own + 1u) * sizeof *next);
    *other = malloc(((*begin)[own] + (size_t)1) * sizeof **other);
    if (!*other)
        return fp3_no_memory(error);
    for (uint32_t i = s->g->now->from; i < s->g->now->objects; i++) {
        const uint32_t j = s->g->now->order ? s->g->now->order[i] : i;
        const pairs *p = s->part;
        while (j >= p->end)
            p++;
        for (uint32_t n = s->first[j], end = end_of(p, j); n < end; n++)
            (*other)[next[p->found[n]]++] = j;
    }
    return FP3_OK;
}

fp3_status fp3_near_note(fp3_near_rule *rule, const fp3_where_they_are *now, fp3_error *error) {
    for (uint32_t k = 0; k < now->dimensions; k++) {
        if (!rule->made[k])
            rule->made[k] = malloc((now->objects + 1u) * sizeof *rule->made[k]);
        if (!rule->made[k])
            return fp3_no_memory(error);
        for (uint32_t i = 0; i < now->objects; i++)
            rule->made[k][i] = fp3_near_word(now, k, i);
    }
    rule->lists++;
    return FP3_OK;
}

static fp3_status open_grid(const fp3_near_rule *rule, const fp3_where_they_are *now, int is_box,
                            grid *g, fp3_error *error) {
    const double reach = fp3_near_reach(rule);
    *g = (grid){.rule = rule,
                .now = now,
                .objects = fp3_near_seekers(now).end,
                .far = (float)(reach * reach)};
    measure(g, reach, is_box);
    return sort(g, error);
}

static void close_grid(grid *g) {
    free(g->cell);
    free(g->order);
    free(g->first);
    free(g->place[0]);
    free(g->exact[0]);
}

fp3_status fp3_near_make(fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t **begin,
                         uint32_t **other, fp3_error *error) {
    grid g;
    search s = {.g = &g};
    *begin = *other = NULL;
    fp3_status status = open_grid(rule, now, 0, &g, error);
    if (!status)
        status = find_pairs(&s, error);
    if (!status)
        status = (now->theirs[0] ? enter_theirs : enter)(&s, begin, other, error);
    if (!status)
        status = fp3_near_note(rule, now, error);
    rule->looks = 0;
    for (uint32_t i = 0; s.part && i < s.count; i++) {
        rule->looks += s.part[i].looks;
        free(s.part[i].found);
    }
    free(s.part);
    free(s.first);
    close_grid(&g);
    return status;
}

fp3_status fp3_near_order(const fp3_near_rule *rule, const fp3_where_they_are *now, uint32_t *rows,
                          fp3_error *error) {
    grid g;
    const fp3_status status = open_grid(rule, now, 1, &g, error);
    if (!status)
        memcpy(rows, g.order, now->objects * sizeof *rows);
    close_grid(&g);
    return status;
}

void fp3_near_close(fp3_near_rule *rule) {
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++) {
        free(rule->made[k]);
        rule->made[k] = NULL;
    }
}
