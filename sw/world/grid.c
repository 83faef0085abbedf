/* SPDX-License-Identifier: Apache-2.0 */
/* grid.c - see grid.h. */
#include "grid.h"

#include <math.h>
#include <stdlib.h>

const char *fp3_grid_kind_name(fp3_grid_kind kind) {
    static const char *const names[] = {"structural", "shear", "bending"};
    return names[kind];
}

void fp3_grid_at(const fp3_grid *grid, size_t object, uint32_t at[FP3_GRID_AXES]) {
    for (unsigned k = 0; k < FP3_GRID_AXES; k++) {
        const uint32_t count = k < grid->axes ? grid->count[k] : 1;
        at[k] = (uint32_t)(object % count);
        object /= count;
    }
}

/* From an object to one that it is linked with. */
typedef struct {
    int by[FP3_GRID_AXES];
    double length;
} way;

enum { WAYS_MAX = 2 * 3 + 10 };

static int kind_of(const int by[FP3_GRID_AXES]) {
    int ones = 0, twos = 0;
    for (unsigned k = 0; k < FP3_GRID_AXES; k++) {
        ones += abs(by[k]) == 1;
        twos += abs(by[k]) == 2;
    }
    return ones == 1 && !twos   ? FP3_GRID_STRUCTURAL
           : ones > 1 && !twos  ? FP3_GRID_SHEAR
           : !ones && twos == 1 ? FP3_GRID_BENDING
                                : -1;
}

/* Only ways to objects with a higher number, so that no link is there twice. */
static unsigned list_ways(const fp3_grid *grid, unsigned kinds, way ways[WAYS_MAX]) {
    unsigned count = 0;
    for (int z = 0; z <= 2; z++)
        for (int y = z ? -2 : 0; y <= 2; y++)
            for (int x = z || y ? -2 : 1; x <= 2; x++) {
                way w = {.by = {x, y, z}};
                const int kind = kind_of(w.by);
                double square = 0;
                int is_inside = kind >= 0 && (kinds >> kind & 1);
                for (unsigned k = 0; k < FP3_GRID_AXES; k++) {
                    const double part = k < grid->axes ? w.by[k] * grid->spacing[k] : 0;
                    square += part * part;
                    is_inside = is_inside && (k < grid->axes || !w.by[k]);
                }
                w.length = sqrt(square);
                if (is_inside)
                    ways[count++] = w;
            }
    return count;
}

/* The object at the end of the way, or the same one: there is none. */
static size_t end_of(const fp3_grid *grid, size_t object, const way *w) {
    uint32_t at[FP3_GRID_AXES];
    size_t end = 0;
    fp3_grid_at(grid, object, at);
    for (unsigned k = grid->axes; k-- > 0;) {
        const int64_t to = (int64_t)at[k] + w->by[k];
        if (to < 0 || to >= grid->count[k])
            return object;
        end = end * grid->count[k] + (size_t)to;
    }
    return end;
}

fp3_status fp3_grid_link(const fp3_grid *grid, unsigned kinds, fp3_grid_links *made,
                         fp3_error *error) {
    way ways[WAYS_MAX];
    const unsigned way_count = list_ways(grid, kinds, ways);
    size_t objects = 1, count = 0;
    for (unsigned k = 0; k < grid->axes; k++)
        objects *= grid->count[k];
    const size_t most = objects * way_count;
    *made = (fp3_grid_links){.ends = malloc((2 * most + 1) * sizeof *made->ends),
                             .length = malloc((most + 1) * sizeof *made->length)};
    if (!made->ends || !made->length)
        return fp3_no_memory(error);
    for (size_t i = 0; i < objects; i++)
        for (unsigned n = 0; n < way_count; n++) {
            const size_t end = end_of(grid, i, &ways[n]);
            if (end == i)
                continue;
            made->ends[count] = (uint32_t)i;
            made->ends[most + count] = (uint32_t)end;
            made->length[count++] = ways[n].length;
        }
    made->links = (fp3_links){.count = count, .a = made->ends, .b = made->ends + most};
    return FP3_OK;
}

void fp3_grid_links_free(fp3_grid_links *made) {
    free(made->ends);
    free(made->length);
    *made = (fp3_grid_links){0};
}
