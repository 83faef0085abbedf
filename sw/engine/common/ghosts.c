/* SPDX-License-Identifier: Apache-2.0 */
/* ghosts.c - see ghosts.h. */
#include "ghosts.h"

#include "backend.h"

#include <stdlib.h>

#define IS_NEEDED (UINT32_MAX - 1) /* instead of a row that is not yet known */

static uint32_t *row_at(const fp3_ghosts *g, uint32_t lane, uint32_t object) {
    return &g->rows[(size_t)lane * g->objects + object];
}

static fp3_where where(const fp3_engine *engine, uint32_t object) {
    return fp3_layout_where(&engine->layout, engine->config,
                            engine->layout.groups[0].first + object);
}

static void place_objects(const fp3_engine *engine, fp3_ghosts *g) {
    for (size_t i = 0; i < (size_t)g->lanes * g->objects; i++)
        g->rows[i] = FP3_NO_ROW;
    for (uint32_t i = 0; i < g->objects; i++) {
        const fp3_where at = where(engine, i);
        *row_at(g, at.lane, i) = at.row;
    }
}

/* Guests make no step and need no neighbours. They come last: hardware begins with object 0. */
static void find_needed(const fp3_engine *engine, fp3_ghosts *g) {
    const fp3_members *group = &engine->layout.groups[0];
    const fp3_lists *lists = &group->lists;
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        for (uint32_t i = 0; i < group->objects; i++) {
            const fp3_list *list = &lists->lists[k];
            const uint32_t lane = where(engine, i).lane;
            for (uint32_t turn = 0; turn < fp3_list_length(list, i); turn++) {
                uint32_t *row = row_at(g, lane, fp3_list_entry(list, i, turn));
                *row = *row == FP3_NO_ROW ? IS_NEEDED : *row;
            }
        }
}

static uint32_t needed_by(const fp3_ghosts *g, uint32_t object) {
    uint32_t lanes = 0;
    for (uint32_t lane = 0; lane < g->lanes; lane++)
        lanes += *row_at(g, lane, object) == IS_NEEDED;
    return lanes;
}

static int is_for_all(const fp3_ghosts *g, uint32_t object) {
    return g->lanes > 2 && needed_by(g, object) == g->lanes - 1;
}

static uint32_t rows_of(const fp3_engine *engine, uint32_t lane) {
    return fp3_layout_rows_with_guests(&engine->layout, engine->config, lane);
}

/* Those that all need stand first, at the same place in all lanes: lane 0 has the most rows. */
static void place_common(const fp3_engine *engine, fp3_ghosts *g) {
    const uint32_t first = rows_of(engine, 0);
    uint32_t next = first;
    for (uint32_t i = 0; i < g->objects; i++) {
        if (!is_for_all(g, i))
            continue;
        const fp3_where at = where(engine, i);
        for (uint32_t lane = 0; lane < g->lanes; lane++)
            if (lane != at.lane)
                *row_at(g, lane, i) = next;
        g->copies[g->count++] = (fp3_copy){i, at.lane, at.row, 0, next++, 1};
    }
    for (uint32_t lane = 0; lane < g->lanes; lane++)
        g->used[lane] = next > first ? next : rows_of(engine, lane);
}

static void place_others(const fp3_engine *engine, fp3_ghosts *g) {
    for (uint32_t lane = 0; lane < g->lanes; lane++)
        for (uint32_t i = 0; i < g->objects; i++)
            if (*row_at(g, lane, i) == IS_NEEDED) {
                const fp3_where at = where(engine, i);
                *row_at(g, lane, i) = g->used[lane];
                g->copies[g->count++] = (fp3_copy){i, at.lane, at.row, lane, g->used[lane]++, 0};
            }
}

static size_t count_copies(const fp3_ghosts *g) {
    size_t count = 0;
    for (uint32_t i = 0; i < g->objects; i++)
        count += is_for_all(g, i) ? 1 : needed_by(g, i);
    return count;
}

fp3_status fp3_ghosts_find(const fp3_engine *engine, fp3_ghosts *g) {
    const uint32_t lanes = engine->config->lanes, objects = engine->layout.groups[0].rows;
    *g = (fp3_ghosts){.lanes = lanes, .objects = objects};
    g->rows = malloc((size_t)lanes * objects * sizeof *g->rows);
    g->used = malloc(lanes * sizeof *g->used);
    if (g->rows && g->used) {
        place_objects(engine, g);
        find_needed(engine, g);
        g->copies = malloc((count_copies(g) + 1) * sizeof *g->copies);
    }
    if (!g->copies) {
        fp3_ghosts_free(g);
        return fp3_no_memory(engine->def.error);
    }
    place_common(engine, g);
    place_others(engine, g);
    return FP3_OK;
}

void fp3_ghosts_free(fp3_ghosts *g) {
    free(g->rows);
    free(g->used);
    free(g->copies);
    *g = (fp3_ghosts){0};
}
