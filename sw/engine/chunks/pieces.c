/* SPDX-License-Identifier: Apache-2.0 */
/* pieces.c - see pieces.h. */
#include "pieces.h"

#include "engine/common/partition.h"

#include <stdlib.h>
#include <string.h>

/* An object, and another piece that sees it: the object's number above that of the piece. */
typedef struct {
    uint64_t *keys;
    size_t count;
} sights;

/* What places go by: the piece, the other pieces that see the object, the order of the walk. */
typedef struct {
    uint32_t piece, slot, object;
    const uint64_t *seen;
    size_t seen_count;
} standing;

static int by_key(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static int by_standing(const void *a, const void *b) {
    const standing *x = a, *y = b;
    if (x->piece != y->piece)
        return x->piece < y->piece ? -1 : 1;
    for (size_t i = 0; i < x->seen_count && i < y->seen_count; i++) {
        const uint32_t p = (uint32_t)x->seen[i], q = (uint32_t)y->seen[i];
        if (p != q)
            return p < q ? -1 : 1;
    }
    if (x->seen_count != y->seen_count)
        return x->seen_count < y->seen_count ? -1 : 1;
    return (x->slot > y->slot) - (x->slot < y->slot);
}

/* As the partition deals objects out to lanes: the first ones have one more. */
static uint32_t before(const fp3_pieces *cut, uint32_t piece) {
    const uint32_t more = cut->objects % cut->count;
    return piece * (cut->objects / cut->count) + (piece < more ? piece : more);
}

static uint32_t piece_at(const fp3_pieces *cut, uint32_t place) {
    const uint32_t least = cut->objects / cut->count, more = cut->objects % cut->count;
    return place < more * (least + 1) ? place / (least + 1)
                                      : more + (place - more * (least + 1)) / least;
}

static size_t sort(uint64_t *keys, size_t count) {
    size_t kept = 0;
    qsort(keys, count, sizeof *keys, by_key);
    for (size_t i = 0; i < count; i++)
        if (!kept || keys[kept - 1] != keys[i])
            keys[kept++] = keys[i];
    return kept;
}

static fp3_status look(const fp3_lists *lists, const fp3_pieces *cut, const uint32_t *slot,
                       sights *s) {
    size_t entries = 0;
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        entries += lists->lists[k].begin[cut->objects];
    if (!(s->keys = malloc((entries + 1) * sizeof *s->keys)))
        return FP3_E_SYSTEM;
    for (uint32_t k = 0; k < lists->shape.list_count; k++) {
        const fp3_list *list = &lists->lists[k];
        for (uint32_t i = 0; i < cut->objects; i++) {
            const uint32_t piece = piece_at(cut, slot[i]);
            for (uint32_t e = list->begin[i]; e < list->begin[i + 1]; e++)
                if (piece_at(cut, slot[list->other[e]]) != piece)
                    s->keys[s->count++] = (uint64_t)list->other[e] << 32 | piece;
        }
    }
    s->count = sort(s->keys, s->count);
    return FP3_OK;
}

static fp3_status stand(fp3_pieces *cut, const uint32_t *slot, const sights *s) {
    standing *list = malloc(cut->objects * sizeof *list);
    size_t next = 0;
    if (!list)
        return FP3_E_SYSTEM;
    for (uint32_t i = 0; i < cut->objects; i++) {
        list[i] = (standing){piece_at(cut, slot[i]), slot[i], i, s->keys + next, 0};
        for (; next < s->count && s->keys[next] >> 32 == i; next++)
            list[i].seen_count++;
    }
    qsort(list, cut->objects, sizeof *list, by_standing);
    for (uint32_t i = 0; i < cut->objects; i++) {
        cut->object[i] = list[i].object;
        cut->place[list[i].object] = i;
    }
    free(list);
    return FP3_OK;
}

/* What each piece sees, by place. */
static fp3_status divide(fp3_pieces *cut, sights *s) {
    uint32_t range = 0;
    for (size_t i = 0; i < s->count; i++)
        s->keys[i] = s->keys[i] << 32 | cut->place[s->keys[i] >> 32];
    qsort(s->keys, s->count, sizeof *s->keys, by_key);
    if (!(cut->ranges = malloc((s->count + 1) * sizeof *cut->ranges)))
        return FP3_E_SYSTEM;
    size_t next = 0;
    for (uint32_t p = 0; p < cut->count; p++) {
        fp3_piece *piece = &cut->pieces[p];
        *piece = (fp3_piece){{before(cut, p), before(cut, p + 1) - before(cut, p)}, 0, range, 0};
        for (; next < s->count && s->keys[next] >> 32 == p; next++, piece->ghosts++) {
            const uint32_t place = (uint32_t)s->keys[next];
            fp3_stretch *last = piece->range_count ? &cut->ranges[range - 1] : NULL;
            if (last && last->first + last->count == place)
                last->count++;
            else {
                cut->ranges[range++] = (fp3_stretch){place, 1};
                piece->range_count++;
            }
        }
    }
    return FP3_OK;
}

/* Pieces `first` on, so many: across the longest side of what they fill, until it is one. */
static void bisect(const fp3_positions *places, const fp3_pieces *cut, fp3_positioned *list,
                   uint32_t first, uint32_t pieces) {
    const uint32_t begin = before(cut, first), half = pieces / 2;
    if (pieces < 2)
        return;
    fp3_positions_sort(places, list + begin, before(cut, first + pieces) - begin);
    bisect(places, cut, list, first, half);
    bisect(places, cut, list, first + half, pieces - half);
}

static int by_weight(const void *a, const void *b) {
    const fp3_positioned *x = a, *y = b;
    return x->weight != y->weight ? (x->weight > y->weight) - (x->weight < y->weight)
                                  : (x->object > y->object) - (x->object < y->object);
}

/* A batch takes as long as its longest list, so within a piece lists of one length stand together.
 */
static fp3_status order_by_place(const fp3_positions *places, const uint32_t *lengths,
                                 const fp3_pieces *cut, uint32_t *slot) {
    fp3_positioned *list = malloc(cut->objects * sizeof *list);
    if (!list)
        return FP3_E_SYSTEM;
    for (uint32_t i = 0; i < cut->objects; i++)
        list[i] = (fp3_positioned){0, i, lengths[i]};
    bisect(places, cut, list, 0, cut->count);
    for (uint32_t p = 0; p < cut->count; p++)
        qsort(list + before(cut, p), before(cut, p + 1) - before(cut, p), sizeof *list, by_weight);
    for (uint32_t i = 0; i < cut->objects; i++)
        slot[list[i].object] = i;
    free(list);
    return FP3_OK;
}

static fp3_status order_by_links(fp3_engine *engine, uint32_t pieces, uint32_t *slot) {
    fp3_config *config = fp3_engine_config(engine);
    const uint32_t lanes = config->lanes;
    config->lanes = pieces; /* a piece is what a lane would have */
    const fp3_status status = fp3_partition_find(engine, slot);
    config->lanes = lanes;
    return status;
}

fp3_status fp3_pieces_make(fp3_engine *engine, const fp3_lists *lists, const fp3_pieces_by *by,
                           uint32_t count, fp3_pieces *cut, fp3_error *error) {
    const uint32_t objects = fp3_engine_layout(engine)->groups[0].objects;
    sights s = {NULL, 0};
    *cut = (fp3_pieces){.objects = objects,
                        .count = count,
                        .place = malloc(objects * sizeof *cut->place),
                        .object = malloc(objects * sizeof *cut->object),
                        .pieces = malloc(count * sizeof *cut->pieces)};
    uint32_t *slot = malloc(objects * sizeof *slot);
    fp3_status status = FP3_E_SYSTEM;
    if (cut->place && cut->object && cut->pieces && slot)
        status = by ? order_by_place(by->places, by->lengths, cut, slot)
                    : order_by_links(engine, count, slot);
    if (!status)
        status = look(lists, cut, slot, &s);
    if (!status)
        status = stand(cut, slot, &s);
    if (!status)
        status = divide(cut, &s);
    free(slot);
    free(s.keys);
    return status ? fp3_no_memory(error) : FP3_OK;
}

void fp3_pieces_free(fp3_pieces *cut) {
    free(cut->place);
    free(cut->object);
    free(cut->pieces);
    free(cut->ranges);
    *cut = (fp3_pieces){0};
}

uint32_t fp3_pieces_row(const fp3_pieces *cut, const fp3_piece *piece, uint32_t object) {
    const uint32_t place = cut->place[object];
    uint32_t row = piece->own.count;
    if (place - piece->own.first < piece->own.count)
        return place - piece->own.first;
    for (uint32_t i = piece->range_first;; i++) {
        const fp3_stretch *range = &cut->ranges[i];
        if (place - range->first < range->count)
            return row + place - range->first;
        row += range->count;
    }
}
