/* SPDX-License-Identifier: Apache-2.0 */
/* lists.c - see lists.h.
 *
 * Lists are behind the records of either half. A near list gets room for as many entries as it may
 * have. The wide list that it is made of also stands where the upper half has records in a step:
 * the program that makes lists publishes nothing, so it has records in the lower half alone. */
#include "lists.h"

#include "check.h"

/* Words of the store that are free: of each part the first ones, as lists come. A list is in one
 * part. */
typedef struct {
    uint32_t next[FP3_CHUNKS_PARTS], end[FP3_CHUNKS_PARTS];
    uint32_t part, parts;
    uint32_t records; /* words before it */
} room;

/* Returns 0 if there is no room. */
static int take(room *r, uint32_t words, uint32_t *place) {
    for (; r->part < r->parts; r->part++)
        if (r->end[r->part] - r->next[r->part] >= words) {
            *place = r->next[r->part];
            r->next[r->part] += words;
            return 1;
        }
    return 0;
}

static uint64_t records_of(const fp3_chunks_maker *m, const fp3_piece *piece) {
    return ((uint64_t)piece->own.count + piece->ghosts) << m->chunks->log2;
}

/* Behind the records. 0: these alone have no room. */
static int open_room(const fp3_chunks_maker *m, const fp3_piece *piece, room *r) {
    const uint32_t upper = fp3_chunks_upper(m), words = fp3_chunks_room(m);
    const uint64_t records = records_of(m, piece);
    const uint32_t behind = records > words ? words : (uint32_t)records;
    *r = (room){{behind, upper + behind}, {words, upper + words}, 0, 2, behind};
    return records <= words;
}

/* What the lists of a step leave. */
static room wide_room(const fp3_chunks_maker *m, const room *lists) {
    const uint32_t upper = fp3_chunks_upper(m), words = fp3_chunks_room(m);
    return (room){{upper, lists->next[0], lists->next[1]},
                  {upper + lists->records, words, upper + words},
                  0,
                  3,
                  0};
}

static uint32_t object_at(const fp3_chunks_maker *m, const fp3_piece *piece, uint32_t i) {
    return m->chunks->cut.object[piece->own.first + i];
}

static const fp3_list *wide_list(const fp3_chunks_maker *m) {
    return &m->lists.lists[m->near.list - m->group->lists.lists];
}

/* Words that the object's list has in the store during a step. */
static uint32_t words_of(const fp3_chunks_maker *m, const fp3_list *list, uint32_t object) {
    const uint32_t words = fp3_chunks_words(list, object);
    return list->is_near && words > m->near.room ? m->near.room : words;
}

static int wide_fits(const fp3_chunks_maker *m, const fp3_piece *piece, const room *lists) {
    room r = wide_room(m, lists);
    uint32_t place;
    for (uint32_t i = 0; m->near.list && i < piece->own.count; i++) {
        const uint32_t length = fp3_list_length(wide_list(m), object_at(m, piece, i));
        if (length >= FP3_CHUNKS_LENGTH || !take(&r, length, &place))
            return 0;
    }
    return 1;
}

static int fits(const fp3_chunks_maker *m, const fp3_piece *piece) {
    uint32_t place;
    room r;
    if (!open_room(m, piece, &r))
        return 0;
    for (uint32_t k = 0; k < m->lists.shape.list_count; k++)
        for (uint32_t i = 0; i < piece->own.count; i++)
            if (!take(&r, words_of(m, &m->lists.lists[k], object_at(m, piece, i)), &place))
                return 0;
    return wide_fits(m, piece, &r);
}

/* ---- the cut ---- */

/* The next number of pieces from this one on for which a piece is whole batches, or nearly: a batch
 * that is not full takes as long as one that is. Never a smaller number, or the cut would not end.
 */
static uint32_t whole(const fp3_chunks_maker *m, uint64_t count) {
    const uint32_t objects = m->group->objects, contexts = m->config->contexts;
    if (count >= objects)
        return objects;
    const uint64_t batches = (objects + count - 1) / count / contexts;
    const uint64_t pieces =
        batches && count > 1 ? (objects + batches * contexts - 1) / (batches * contexts) : count;
    return (uint32_t)(pieces > count ? pieces : count);
}

/* FP3_E_PROGRAM: there is no room, or not for a batch where a chunk has a part of the store. */
static fp3_status cut_in(fp3_chunks_maker *m, uint32_t parts) {
    fp3_chunks *chunks = m->chunks;
    const fp3_pieces_by near = {&m->near.places, m->near.lengths},
                        *by = m->near.list ? &near : NULL;
    const uint32_t objects = m->group->objects;
    uint64_t words = (uint64_t)objects << (chunks->log2 + 1);
    m->parts = parts;
    for (uint32_t k = 0; k < m->lists.shape.list_count; k++)
        for (uint32_t i = 0; i < objects; i++)
            words += words_of(m, &m->lists.lists[k], i);
    for (uint64_t count = words / (2 * fp3_chunks_room(m)) + 1;; count += 1 + count / 32) {
        count = whole(m, count);
        if (parts > 1 && count > 1 && objects / count < m->config->contexts)
            return FP3_E_PROGRAM;
        const fp3_status status =
            fp3_pieces_make(m->engine, &m->lists, by, (uint32_t)count, &chunks->cut, m->error);
        if (status)
            return status;
        uint32_t p = 0;
        while (p < count && fits(m, &chunks->cut.pieces[p]))
            p++;
        if (p == count)
            return FP3_OK;
        if (count == objects)
            return fp3_chunks_no_room(m->config, chunks->cut.object[p],
                                      chunks->cut.pieces[p].ghosts, m->error);
        fp3_pieces_free(&chunks->cut);
    }
}

/* With less than a full batch in each chunk lanes would wait longer than for words. */
fp3_status fp3_chunks_cut(fp3_chunks_maker *m) {
    const fp3_status status = m->config->overlap ? cut_in(m, 2) : FP3_E_PROGRAM;
    return status == FP3_E_PROGRAM ? cut_in(m, 1) : status;
}

/* ---- in memory ---- */

static void put_entries(fp3_chunks_maker *m, const fp3_piece *piece, const fp3_list *list,
                        uint32_t object) {
    const fp3_pieces *cut = &m->chunks->cut;
    for (uint32_t e = list->begin[object]; e < list->begin[object + 1]; e++) {
        const uint32_t row = fp3_pieces_row(cut, piece, list->other[e]);
        fp3_chunks_put(m, &row, 1);
        if (list->fields)
            fp3_chunks_put(m, &list->field[(size_t)e * list->fields], list->fields);
    }
}

static uint32_t word_of(uint32_t length, uint32_t place) {
    return length << FP3_OBJECTS_LENGTH_LO | place << FP3_OBJECTS_PLACE_LO;
}

/* A near list is empty until it is made for the first time. */
static void put_list(fp3_chunks_maker *m, const fp3_piece *piece, const fp3_list *list,
                     uint32_t object, uint32_t place) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t number = chunks->numbers.now[list->reg];
    const fp3_chunks_run *run = fp3_chunks_run_of(chunks, number);
    if (list->is_near)
        fp3_chunks_put(m, NULL, words_of(m, list, object));
    else
        put_entries(m, piece, list, object);
    chunks->memory[run->at[0] + chunks->cut.place[object] * run->count + number - run->reg] =
        word_of(list->is_near ? 0 : fp3_list_length(list, object), place);
}

static void put_wide(fp3_chunks_maker *m, const fp3_piece *piece, const room *lists,
                     fp3_chunk_data *data) {
    const fp3_list *wide = wide_list(m);
    room r = wide_room(m, lists);
    const room empty = r;
    uint32_t part = FP3_CHUNKS_PARTS, place = 0;
    for (uint32_t i = 0; i < piece->own.count && !m->is_full; i++) {
        const uint32_t object = object_at(m, piece, i), length = fp3_list_length(wide, object);
        take(&r, length, &place);
        if (part != r.part) {
            part = r.part;
            data->wide[part] = (fp3_chunk_words){m->chunks->words, empty.next[part], 0};
        }
        put_entries(m, piece, wide, object);
        m->chunks->memory[m->near.wide + piece->own.first + i] = word_of(length, place);
        data->wide[part].count += length;
    }
}

/* They are where `take` says, which gives places in order. */
void fp3_chunks_put_lists(fp3_chunks_maker *m, const fp3_piece *piece, fp3_chunk_data *data) {
    room r;
    open_room(m, piece, &r);
    const room empty = r;
    uint32_t part = FP3_CHUNKS_PARTS;
    for (uint32_t k = 0; k < m->lists.shape.list_count; k++)
        for (uint32_t i = 0; i < piece->own.count && !m->is_full; i++) {
            const fp3_list *list = &m->lists.lists[k];
            const uint32_t object = object_at(m, piece, i), words = words_of(m, list, object);
            uint32_t place = 0;
            take(&r, words, &place);
            if (part != r.part) {
                part = r.part;
                data->lists[part] = (fp3_chunk_words){m->chunks->words, empty.next[part], 0};
            }
            put_list(m, piece, list, object, place);
            data->lists[part].count += words;
        }
    if (m->near.list)
        put_wide(m, piece, &r, data);
    data->awake = fp3_chunks_put(m, &piece->own.count, 1);
}
