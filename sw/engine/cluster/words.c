/* SPDX-License-Identifier: Apache-2.0 */
/* words.c - words of objects, wherever they are. */
#include "engine/common/cells.h"
#include "inside.h"

#include <stdlib.h>
#include <string.h>

/* How many of the own objects have a smaller number. */
static uint32_t place_of(const fp3_ranked *self, size_t number) {
    uint32_t low = 0, high = self->share[self->ranks->rank];
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (self->mine[middle] < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Those of a range that are here, as cells of the own engine. */
static fp3_cells own_cells(const fp3_ranked *self, fp3_cells cells) {
    const uint32_t begin = place_of(self, cells.first),
                   end = place_of(self, cells.first + cells.count);
    cells.first = self->first + begin;
    cells.count = end - begin;
    return cells;
}

static fp3_status read_constants(const fp3_engine *engine, fp3_cells cells, void *words) {
    const fp3_ranked *self = engine->self;
    memcpy(words, &self->constants[(size_t)cells.number * engine->config->registers + cells.first],
           cells.count * sizeof *self->constants);
    return FP3_OK;
}

fp3_status fp3_ranks_read(fp3_engine *engine, fp3_cells cells, void *words) {
    fp3_ranked *self = engine->self;
    const unsigned ranks = self->ranks->count;
    if (cells.kind == FP3_CELLS_CONSTANT)
        return read_constants(engine, cells, words);
    const fp3_cells here = own_cells(self, cells);
    uint64_t *bytes = calloc(ranks, sizeof *bytes), *next = calloc(ranks, sizeof *next);
    uint32_t *own = malloc((here.count + 1) * sizeof *own), *to = words,
             *all = malloc((cells.count + 1) * sizeof *all);
    fp3_status status = bytes && next && own && all ? FP3_OK : fp3_no_memory(engine->def.error);
    if (!status)
        status = fp3_ranks_read_own(self, here, own);
    for (size_t i = cells.first; !status && i < cells.first + cells.count; i++)
        bytes[self->whose[i]] += sizeof *own;
    if (!status) {
        self->ranks->calls->gather(self->ranks->world, own, bytes, all);
        for (unsigned r = 1; r < ranks; r++)
            next[r] = next[r - 1] + bytes[r - 1] / sizeof *own;
        for (size_t i = 0; i < cells.count; i++)
            to[i] = all[next[self->whose[cells.first + i]]++];
    }
    free(bytes);
    free(next);
    free(own);
    free(all);
    return status;
}

static fp3_status write_constants(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_ranked *self = engine->self;
    const int group = self->own ? self->group[cells.number] : -1;
    memcpy(&self->constants[(size_t)cells.number * engine->config->registers + cells.first], words,
           cells.count * sizeof *self->constants);
    if (group < 0)
        return FP3_OK;
    cells.number = (uint32_t)group;
    return fp3_cells_write(self->own, cells, words);
}

fp3_status fp3_ranks_write_guests(fp3_ranked *self, fp3_cells cells, const uint32_t *words) {
    const uint64_t read = self->own->layout.groups[0].lists.shape.published;
    fp3_status status = FP3_OK;
    if (cells.kind != FP3_CELLS_REGISTER || !(read >> cells.number & 1))
        return FP3_OK; /* no neighbour reads it */
    for (uint32_t i = 0; !status && i < self->guest_count; i++) {
        const size_t at = self->guests[i] - cells.first;
        if (self->guests[i] >= cells.first && at < cells.count)
            status = fp3_cells_write(
                self->own, (fp3_cells){cells.kind, cells.number, fp3_ranks_row(self, i), 1},
                words + at);
    }
    return status;
}

fp3_status fp3_ranks_write(fp3_engine *engine, fp3_cells cells, const void *words) {
    fp3_ranked *self = engine->self;
    const uint32_t which[] = {cells.kind, cells.number, (uint32_t)cells.first,
                              (uint32_t)cells.count};
    fp3_ranks_note(self, which, 4);
    fp3_ranks_note(self, words, cells.count);
    if (cells.kind == FP3_CELLS_CONSTANT)
        return write_constants(engine, cells, words);
    const fp3_cells here = own_cells(self, cells);
    const uint32_t begin = (uint32_t)here.first - self->first, *from = words;
    uint32_t *own = malloc((here.count + 1) * sizeof *own);
    fp3_status status = own ? FP3_OK : fp3_ranks_no_memory(engine);
    for (size_t i = 0; !status && i < here.count; i++)
        own[i] = from[self->mine[begin + i] - cells.first];
    if (!status)
        status = fp3_ranks_write_own(self, here, own);
    free(own);
    return status || !self->own ? status : fp3_ranks_write_guests(self, cells, words);
}
