/* SPDX-License-Identifier: Apache-2.0 */
/* near_levels.c - see near_levels.h. */
#include "near_levels.h"

#include <stdlib.h>

/* Objects of a level reach at least this share of what the first of them does. */
#define WIDTH 0.5f

/* So that no rounding of a sum in FP32 puts who is near two cells away; where levels are far apart,
 * FP3_NEAR_ROUNDING in each share does. */
#define ROUNDING 1e-6

/* ---- the middle radius ---- */

#define SAMPLES 255u

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of some rows, spread over all. */
double fp3_near_middle(const fp3_near_rule *rule, const fp3_where_they_are *now) {
    double radius[SAMPLES] = {0};
    uint32_t count = 0;
    for (uint32_t i = 0; i < SAMPLES && i < now->objects; i++) {
        const uint32_t row =
            now->objects < SAMPLES ? i : (uint32_t)((uint64_t)i * now->objects / SAMPLES);
        if (now->theirs[0] && row >= now->own && row < now->from)
            continue;
        radius[count] = fp3_near_radius(rule, now, row);
        count += radius[count] > 0;
    }
    qsort(radius, count, sizeof *radius, compare);
    return rule->reach + (count ? 2 * radius[count / 2] : 0);
}

/* The largest component of a position that is a number. */
static double farthest(const fp3_near_rule *rule, const fp3_where_they_are *now) {
    double most = 0;
    for (uint32_t k = 0; k < now->dimensions; k++)
        for (uint32_t i = 0; i < now->objects; i++) {
            const double size = fabs(fp3_near_at(rule, now, k, i));
            most = size > most && size < INFINITY ? size : most;
        }
    return most;
}

void fp3_near_find_margins(fp3_near_rule *rule, const fp3_where_they_are *now) {
    if (rule->share > 0)
        rule->skin = fmin(rule->share * fp3_near_middle(rule, now), FP3_NEAR_MOST);
    rule->rounding = rule->is_pair ? FP3_NEAR_PAIR_ROUNDING * farthest(rule, now) : 0;
}

/* ---- levels ---- */

static int is_in(const fp3_where_they_are *w, uint32_t row) {
    return !w->theirs[0] || row < w->own || row >= w->from;
}

/* The largest share up to `below`; 0: there is none. */
static float largest(const fp3_near_levels *l, float below) {
    float most = 0;
    for (uint32_t i = 0; i < l->now->objects; i++)
        if (is_in(l->now, i) && l->shares[i] <= below)
            most = l->shares[i] > most ? l->shares[i] : most;
    return most;
}

/* How far the first of each level reaches. */
static void find_levels(fp3_near_levels *l, float first[FP3_NEAR_LEVELS]) {
    for (uint32_t i = 0; i < l->now->objects; i++)
        l->shares[i] = is_in(l->now, i) ? fp3_near_share(l->rule, l->now, i) : 0;
    first[0] = largest(l, INFINITY);
    l->count = 1;
    while (l->count < FP3_NEAR_LEVELS) {
        const float next = largest(l, WIDTH * first[l->count - 1]);
        if (!(next > 0))
            return;
        first[l->count++] = next;
    }
}

static void place(fp3_near_levels *l, const float first[FP3_NEAR_LEVELS],
                  uint32_t begin[2 * FP3_NEAR_LEVELS + 1]) {
    uint32_t next[2 * FP3_NEAR_LEVELS];
    for (uint32_t i = 0; i < l->now->objects; i++) {
        uint32_t level = 0;
        while (level + 1 < l->count && l->shares[i] <= first[level + 1])
            level++;
        l->level[i] = (uint8_t)level;
        if (is_in(l->now, i))
            begin[2 * level + (uint32_t)fp3_near_is_theirs(l->now, i) + 1]++;
    }
    for (uint32_t i = 0; i < 2 * FP3_NEAR_LEVELS; i++)
        begin[i + 1] += begin[i];
    memcpy(next, begin, sizeof next);
    for (uint32_t i = 0; i < l->now->objects; i++)
        if (is_in(l->now, i))
            l->rows[next[2u * l->level[i] + (uint32_t)fp3_near_is_theirs(l->now, i)]++] = i;
}

static fp3_status open_grids(fp3_near_levels *l, fp3_error *error) {
    float first[FP3_NEAR_LEVELS];
    uint32_t begin[2 * FP3_NEAR_LEVELS + 1] = {0};
    const size_t objects = l->now->objects;
    fp3_status status = FP3_OK;
    l->shares = malloc((objects + 1) * sizeof *l->shares);
    l->level = malloc(objects + 1);
    l->rows = malloc((objects + 1) * sizeof *l->rows);
    if (!l->shares || !l->level || !l->rows)
        return fp3_no_memory(error);
    find_levels(l, first);
    place(l, first, begin);
    for (uint32_t i = 0; !status && i < 2 * l->count; i++) {
        const fp3_near_members of = {
            .rows = l->rows + begin[i],
            .count = begin[i + 1] - begin[i],
            .reach = fmax(2 * (double)first[i / 2] * (1 + ROUNDING), FP3_NEAR_LEAST),
            .shares = l->shares};
        if (of.count && (i % 2 == 0 || l->count > 1))
            status = fp3_near_grid_open(l->rule, l->now, &of, &(i % 2 ? l->theirs : l->own)[i / 2],
                                        error);
    }
    return status;
}

/* ---- who looks ---- */

/* In how many lines of cells objects look that reach this far. */
static double lines(const fp3_near_grid *g, double reach) {
    double count = 1;
    for (uint32_t k = 1; k < g->now->dimensions; k++)
        count *= fmin(2 * reach / g->size + 1, g->cells[k]);
    return count;
}

/* Of objects of a nearer level, and of those that reach farther, for each other: who has less to
 * do. Cells without a box are where they are, so only those look that see few of them. */
static int is_far_better(const fp3_near_grid *far, const fp3_near_grid *near) {
    const double reach = (far->of.reach + near->of.reach) / 2;
    if (!far->of.count || !near->of.count)
        return 0;
    return !near->mask && far->of.count * lines(near, reach) < near->of.count * lines(far, reach);
}

static void choose_lookers(fp3_near_levels *l) {
    const int are_two = l->now->theirs[0] != NULL;
    const fp3_near_grid *theirs = are_two ? l->theirs : l->own;
    for (uint32_t far = 0; far < l->count; far++) {
        l->looks[0][far][far] = !are_two; /* of two kinds theirs look for the own ones */
        l->looks[1][far][far] = 1;
        for (uint32_t near = far + 1; near < l->count; near++) {
            const int own = is_far_better(&l->own[far], &theirs[near]);
            const int their = is_far_better(&theirs[far], &l->own[near]);
            l->looks[0][far][near] = (uint8_t)own;
            l->looks[1][near][far] = (uint8_t)!own;
            l->looks[1][far][near] = (uint8_t)their;
            l->looks[0][near][far] = (uint8_t)!their;
        }
    }
}

fp3_status fp3_near_levels_open(const fp3_near_rule *rule, const fp3_where_they_are *now,
                                fp3_near_levels *levels, fp3_error *error) {
    *levels = (fp3_near_levels){.rule = rule, .now = now, .count = 1};
    const fp3_near_members all = {.count = fp3_near_seekers(now).end,
                                  .reach = fp3_near_reach(rule)};
    const fp3_status status = fp3_near_has_radii(now)
                                  ? open_grids(levels, error)
                                  : fp3_near_grid_open(rule, now, &all, &levels->own[0], error);
    if (!status)
        choose_lookers(levels);
    return status;
}

void fp3_near_levels_close(fp3_near_levels *levels) {
    for (uint32_t i = 0; i < FP3_NEAR_LEVELS; i++) {
        fp3_near_grid_close(&levels->own[i]);
        fp3_near_grid_close(&levels->theirs[i]);
    }
    free(levels->shares);
    free(levels->level);
    free(levels->rows);
}

/* ---- a search ---- */

/* An object whose position is not finite has found no object but itself. */
static fp3_status find_itself(uint32_t row, fp3_near_found *p, fp3_error *error) {
    const fp3_status status = fp3_near_need_room(p, 1, error);
    if (!status)
        p->found[p->count++] = row;
    return status;
}

fp3_status fp3_near_levels_find(const fp3_near_levels *l, uint32_t row, fp3_near_found *found,
                                fp3_error *error) {
    const fp3_where_they_are *now = l->now;
    const int is_own = now->theirs[0] && !fp3_near_is_theirs(now, row);
    const fp3_near_grid *grids = is_own ? l->theirs : l->own;
    fp3_near_seeker seeker = {.share = l->shares ? l->shares[row] : 0};
    fp3_status status = FP3_OK;
    int is_astray = 0;
    for (uint32_t k = 0; k < now->dimensions; k++) {
        seeker.place[k] = fp3_near_at(l->rule, now, k, row);
        is_astray |= !isfinite(seeker.place[k]);
    }
    if (is_astray)
        return now->theirs[0] ? FP3_OK : find_itself(row, found, error);
    const uint8_t *looks = l->looks[fp3_near_is_theirs(now, row)][l->level ? l->level[row] : 0];
    for (uint32_t i = 0; !status && i < l->count; i++)
        if (looks[i] && grids[i].of.count)
            status = fp3_near_grid_find(&grids[i], &seeker, found, error);
    return status;
}
