/* SPDX-License-Identifier: Apache-2.0 */
/* fill.c - one object after the other, at random places until a place is free; a grid of cells
 * finds near objects. */
#include "fill.h"

#include <math.h>
#include <stdlib.h>

#define NONE SIZE_MAX

typedef struct {
    const fp3_fill *fill;
    double *const *position;
    uint64_t random;
    double size[FP3_FILL_AXES]; /* of a cell */
    size_t cells[FP3_FILL_AXES];
    size_t *first,
        *next; /* of each cell its last object; of each object the one before in its cell */
} box;

/* splitmix64: Steele, Lea, Flood, 2014. */
static uint64_t draw(box *b) {
    uint64_t z = b->random += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* 0 to 1, without 1. */
static double share(box *b) { return (double)(draw(b) >> 11) * 0x1p-53; }

/* Cells at least as large as objects are apart, and not many more than there are objects. */
static void measure(box *b) {
    const fp3_fill *f = b->fill;
    double size = f->apart, count;
    for (unsigned k = 0; k < f->axes; k++)
        size = fmax(size, (f->to[k] - f->from[k]) * 1e-6);
    do {
        count = 1;
        for (unsigned k = 0; k < f->axes; k++)
            count *= floor((f->to[k] - f->from[k]) / size) + 1;
        if (count > 4.0 * (double)f->objects + 64)
            size *= 1.25;
    } while (count > 4.0 * (double)f->objects + 64);
    for (unsigned k = 0; k < FP3_FILL_AXES; k++) {
        b->size[k] = size;
        b->cells[k] = k < f->axes ? (size_t)floor((f->to[k] - f->from[k]) / size) + 1 : 1;
    }
}

static size_t cell_along(const box *b, unsigned k, double x) {
    if (k >= b->fill->axes)
        return 0;
    const double c = floor((x - b->fill->from[k]) / b->size[k]);
    return c < 0 ? 0 : c >= (double)b->cells[k] ? b->cells[k] - 1 : (size_t)c;
}

static int is_free_of(const box *b, size_t other, const double at[FP3_FILL_AXES]) {
    double square = 0;
    for (unsigned k = 0; k < b->fill->axes; k++) {
        const double way = b->position[k][other] - at[k];
        square += way * way;
    }
    return square >= b->fill->apart * b->fill->apart;
}

static int is_free(const box *b, const double at[FP3_FILL_AXES]) {
    size_t low[FP3_FILL_AXES], high[FP3_FILL_AXES];
    for (unsigned k = 0; k < FP3_FILL_AXES; k++) {
        const size_t c = cell_along(b, k, at[k]);
        low[k] = c ? c - 1 : 0;
        high[k] = c + 1 < b->cells[k] ? c + 1 : c;
    }
    for (size_t z = low[2]; z <= high[2]; z++)
        for (size_t y = low[1]; y <= high[1]; y++)
            for (size_t x = low[0]; x <= high[0]; x++)
                for (size_t i = b->first[(z * b->cells[1] + y) * b->cells[0] + x]; i != NONE;
                     i = b->next[i])
                    if (!is_free_of(b, i, at))
                        return 0;
    return 1;
}

/* Whether a place is free. The place is rounded first, because distances are those of rounded
 * places. */
static int place(box *b, size_t object) {
    double at[FP3_FILL_AXES] = {0};
    for (int n = 0; n < FP3_FILL_TRIES; n++) {
        for (unsigned k = 0; k < b->fill->axes; k++) {
            const double from = b->fill->from[k], to = b->fill->to[k];
            at[k] = (double)(float)(from + share(b) * (to - from));
        }
        if (!is_free(b, at))
            continue;
        for (unsigned k = 0; k < b->fill->axes; k++)
            b->position[k][object] = at[k];
        size_t *cell = &b->first[(cell_along(b, 2, at[2]) * b->cells[1] + cell_along(b, 1, at[1])) *
                                     b->cells[0] +
                                 cell_along(b, 0, at[0])];
        b->next[object] = *cell;
        *cell = object;
        return 1;
    }
    return 0;
}

fp3_status fp3_fill_box(const fp3_fill *fill, double *const position[FP3_FILL_AXES], size_t *placed,
                        fp3_error *error) {
    box b = {.fill = fill, .position = position, .random = fill->seed};
    measure(&b);
    const size_t cells = b.cells[0] * b.cells[1] * b.cells[2];
    b.first = malloc(cells * sizeof *b.first);
    b.next = malloc((fill->objects + 1) * sizeof *b.next);
    fp3_status status = b.first && b.next ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < cells; i++)
        b.first[i] = NONE;
    *placed = 0;
    while (!status && *placed < fill->objects && place(&b, *placed))
        ++*placed;
    free(b.first);
    free(b.next);
    return status;
}
