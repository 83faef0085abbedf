/* SPDX-License-Identifier: Apache-2.0 */
/* colours.c - see colours.h. */
#include "colours.h"

#include <stdlib.h>
#include <string.h>

static fp3_status make_room(fp3_colours *c, uint32_t movable, uint32_t colours, fp3_error *error) {
    if (c->body_room < movable) {
        uint64_t *taken = realloc(c->taken, 2 * (size_t)movable * sizeof *taken);
        if (!taken)
            return fp3_no_memory(error);
        c->taken = taken;
        c->body_room = 2 * movable;
    }
    if (c->room < colours + 2) {
        uint32_t *first = realloc(c->first, 2 * (size_t)(colours + 2) * sizeof *first);
        if (!first)
            return fp3_no_memory(error);
        c->first = first;
        c->room = 2 * (colours + 2);
    }
    return FP3_OK;
}

static uint32_t greedy(fp3_colours *c, const uint32_t *a, const uint32_t *b, uint32_t count,
                       uint32_t movable, uint32_t *colour) {
    uint32_t colours = 0, beyond = FP3_COLOURS_MASKED;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t taken =
            (a[i] < movable ? c->taken[a[i]] : 0) | (b[i] < movable ? c->taken[b[i]] : 0);
        colour[i] = ~taken ? (uint32_t)__builtin_ctzll(~taken) : beyond++;
        const uint64_t own = ~taken ? (uint64_t)1 << colour[i] : 0;
        if (a[i] < movable)
            c->taken[a[i]] |= own;
        if (b[i] < movable)
            c->taken[b[i]] |= own;
        if (colours <= colour[i])
            colours = colour[i] + 1;
    }
    return colours;
}

static uint32_t blocks_of(uint32_t lanes, uint32_t wide, uint32_t together) {
    const uint32_t most = wide * together;
    return (lanes + most - 1) / most * together;
}

fp3_status fp3_colours_find(fp3_colours *c, const uint32_t *a, const uint32_t *b, uint32_t count,
                            uint32_t movable, uint32_t wide, uint32_t together, uint32_t *colour,
                            uint32_t *place, fp3_error *error) {
    fp3_status status = make_room(c, movable + 1, FP3_COLOURS_MASKED, error);
    if (status)
        return status;
    memset(c->taken, 0, movable * sizeof *c->taken);
    c->count = greedy(c, a, b, count, movable, colour);
    status = make_room(c, movable + 1, c->count, error);
    if (status)
        return status;
    memset(c->first, 0, (c->count + 2) * sizeof *c->first);
    for (uint32_t i = 0; i < count; i++)
        c->first[colour[i] + 2]++;
    /* From here on `first[k + 1]` counts the contacts that colour k has so far, in lanes. */
    for (uint32_t k = 0; k < c->count; k++) {
        c->first[k + 2] = c->first[k + 1] + blocks_of(c->first[k + 2], wide, together) * wide;
    }
    for (uint32_t i = 0; i < count; i++)
        place[i] = c->first[colour[i] + 1]++;
    /* Each has moved to the end of its contacts: back to where its blocks begin. */
    for (uint32_t k = c->count; k > 0; k--)
        c->first[k] = blocks_of(c->first[k], wide, together);
    return FP3_OK;
}

void fp3_colours_free(fp3_colours *c) {
    free(c->first);
    free(c->taken);
    *c = (fp3_colours){0};
}
