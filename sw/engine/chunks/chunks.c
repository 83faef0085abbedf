/* SPDX-License-Identifier: Apache-2.0 */
/* chunks.c - see chunks.h.
 *
 * Memory has words that do not change, places of words that do, and at its end the list. */
#include "chunks.h"

#include "check.h"

#include "gen/registers.h"
#include "machine/config.h"
#include "machine/operation.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define FLAG(field) (1u << FP3_TRANSFER_CONTROL_##field##_LO)
#define DESCRIPTOR 4u
#define MOST_STEPS (1u << 24) /* that a descriptor can count */

/* Where in memory the lists of a chunk's objects are, and how many words; behind the records of
 * either half of the store. */
typedef struct {
    uint32_t at[2], words[2], awake;
} chunk_data;

typedef struct {
    uint32_t at, words, shape; /* its words; the registers step, last, size */
} phase_data;

/* What is being made. */
typedef struct {
    fp3_engine *engine;
    const fp3_members *group;
    const fp3_config *config;
    fp3_chunks *chunks;
    uint32_t room; /* words that chunks->memory could have */
    int is_full;   /* of host memory, or of addresses */
    chunk_data *data;
    phase_data *phases;
    uint32_t phase_count, start, half, enable;
    uint32_t constants, settings; /* words of memory: what the list loads once */
    int counts;                   /* descriptors are those of the first step */
    fp3_error *error;
} maker;

/* ---- memory ---- */

/* Of so many words that follow, which one is the first. Their addresses have 32 bits. */
static uint32_t put(maker *m, const uint32_t *words, uint32_t count) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t first = chunks->words;
    if (m->is_full || count > (UINT32_MAX - chunks->at) / 4 - first) {
        m->is_full = 1;
        return 0;
    }
    if (count > m->room - first) {
        const uint32_t room = 2 * (first + count); /* below 2^31: of 4 GB */
        uint32_t *memory = realloc(chunks->memory, (size_t)room * sizeof *memory);
        if (!memory) {
            m->is_full = 1;
            return 0;
        }
        chunks->memory = memory;
        m->room = room;
    }
    if (words)
        memcpy(chunks->memory + first, words, count * sizeof *words);
    else
        memset(chunks->memory + first, 0, count * sizeof *words);
    chunks->words += count;
    return first;
}

static uint32_t put_word(maker *m, uint32_t word) { return put(m, &word, 1); }

/* ---- registers that are moved alike ---- */

static void find_runs(maker *m) {
    const fp3_members *group = m->group;
    const uint64_t stored = group->visit->stored, seen = group->lists.shape.published;
    fp3_chunks *chunks = m->chunks;
    fp3_chunks_run *last = NULL;
    for (uint32_t number = 0; number < chunks->numbers.moved; number++) {
        const uint64_t reg = BIT(chunks->numbers.before[number]);
        const int is_stored = (stored & reg) != 0, is_seen = (seen & reg) != 0;
        if (!last || last->is_stored != is_stored || last->is_seen != is_seen) {
            last = &chunks->runs[chunks->run_count++];
            *last = (fp3_chunks_run){.reg = number, .is_stored = is_stored, .is_seen = is_seen};
            last->is_published = is_stored && is_seen;
        }
        last->count++;
    }
}

static fp3_status put_run(maker *m, fp3_chunks_run *run, uint32_t *words) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t objects = chunks->cut.objects;
    fp3_status status = FP3_OK;
    for (int place = 0; place < 1 + run->is_published; place++)
        run->at[place] = put(m, NULL, objects * run->count);
    for (uint32_t k = 0; !status && !m->is_full && k < run->count; k++) {
        status = fp3_engine_read_words(m->engine, 0, objects, chunks->numbers.before[run->reg + k],
                                       words);
        for (uint32_t i = 0; !status && i < objects; i++)
            chunks->memory[run->at[0] + chunks->cut.place[i] * run->count + k] = words[i];
    }
    return status;
}

/* By the number that the register has now. */
static const fp3_chunks_run *run_of(const fp3_chunks *chunks, uint32_t number) {
    for (uint32_t i = 0; i < chunks->run_count; i++)
        if (number - chunks->runs[i].reg < chunks->runs[i].count)
            return &chunks->runs[i];
    return NULL;
}

/* ---- lists ---- */

/* Words of the store for lists behind the records: the first words of half 0, then of half 1, as
 * lists come; a list is in one half. */
typedef struct {
    uint32_t next[2], end[2];
    int half;
} room;

/* Returns 0 if there is no room. */
static int take(room *r, uint32_t words, uint32_t *place) {
    for (; r->half < 2; r->half++)
        if (r->end[r->half] - r->next[r->half] >= words) {
            *place = r->next[r->half];
            r->next[r->half] += words;
            return 1;
        }
    return 0;
}

static int open_room(const maker *m, const fp3_piece *piece, room *r) {
    const uint32_t half = m->config->store_words / 2;
    const uint64_t records = ((uint64_t)piece->own.count + piece->ghosts) << m->chunks->log2;
    const uint32_t behind = records > half ? half : (uint32_t)records;
    *r = (room){{behind, half + behind}, {half, 2 * half}, 0};
    return records <= half;
}

static int fits(const maker *m, const fp3_piece *piece) {
    const fp3_lists *lists = &m->group->lists;
    uint32_t place;
    room r;
    if (!open_room(m, piece, &r))
        return 0;
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        for (uint32_t i = 0; i < piece->own.count; i++)
            if (!take(
                    &r,
                    fp3_chunks_words(&lists->lists[k], m->chunks->cut.object[piece->own.first + i]),
                    &place))
                return 0;
    return 1;
}

static void put_list(maker *m, const fp3_piece *piece, const fp3_list *list, uint32_t object) {
    const fp3_pieces *cut = &m->chunks->cut;
    for (uint32_t e = list->begin[object]; e < list->begin[object + 1]; e++) {
        put_word(m, fp3_pieces_row(cut, piece, list->other[e]));
        if (list->fields)
            put(m, &list->field[(size_t)e * list->fields], list->fields);
    }
}

/* They are where `take` says, which gives places in order. */
static void put_lists(maker *m, const fp3_piece *piece, chunk_data *data) {
    const fp3_lists *lists = &m->group->lists;
    fp3_chunks *chunks = m->chunks;
    room r;
    open_room(m, piece, &r);
    const room empty = r;
    data->at[0] = chunks->words;
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        for (uint32_t i = 0; i < piece->own.count && !m->is_full; i++) {
            const fp3_list *list = &lists->lists[k];
            const uint32_t object = chunks->cut.object[piece->own.first + i];
            const uint32_t number = chunks->numbers.now[list->reg];
            const fp3_chunks_run *run = run_of(chunks, number);
            uint32_t place = 0;
            const int half = r.half;
            take(&r, fp3_chunks_words(list, object), &place);
            if (half != r.half)
                data->at[1] = chunks->words;
            put_list(m, piece, list, object);
            chunks->memory[run->at[0] + (piece->own.first + i) * run->count + number - run->reg] =
                fp3_list_length(list, object) << FP3_OBJECTS_LENGTH_LO |
                place << FP3_OBJECTS_PLACE_LO;
        }
    for (int half = 0; half < 2; half++)
        data->words[half] = r.next[half] - empty.next[half];
    data->awake = put_word(m, piece->own.count);
}

/* ---- the cut ---- */

/* The next number of pieces from this one on for which a piece is whole batches, or nearly: a batch
 * that is not full takes as long as one that is. Never a smaller number, or the cut would not end.
 */
static uint32_t whole(const maker *m, uint64_t count) {
    const uint32_t objects = m->group->objects, contexts = m->config->contexts;
    if (count >= objects)
        return objects;
    const uint64_t batches = (objects + count - 1) / count / contexts;
    const uint64_t pieces =
        batches && count > 1 ? (objects + batches * contexts - 1) / (batches * contexts) : count;
    return (uint32_t)(pieces > count ? pieces : count);
}

/* Pieces as large as fit. */
static fp3_status cut(maker *m) {
    fp3_chunks *chunks = m->chunks;
    const fp3_lists *lists = &m->group->lists;
    const uint32_t objects = m->group->objects;
    uint64_t words = (uint64_t)objects << (chunks->log2 + 1);
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        words += (uint64_t)lists->lists[k].begin[objects] * (1 + lists->lists[k].fields);
    for (uint64_t count = words / m->config->store_words + 1;; count += 1 + count / 32) {
        count = whole(m, count);
        const fp3_status status =
            fp3_pieces_make(m->engine, (uint32_t)count, &chunks->cut, m->error);
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

/* ---- the list ---- */

static uint32_t address_of(const maker *m, uint32_t word) { return m->chunks->at + 4 * word; }

static void describe(maker *m, uint32_t word, uint32_t place, uint32_t words, uint32_t control) {
    const uint32_t row[DESCRIPTOR] = {address_of(m, word), place, words, control};
    put(m, row, DESCRIPTOR);
    if (!m->counts)
        return;
    m->chunks->descriptors++;
    if (control & FLAG(LOAD))
        m->chunks->in += words;
    if (control & FLAG(STORE))
        m->chunks->out += words;
}

static void set(maker *m, uint32_t word, uint32_t address, uint32_t words) {
    describe(m, word, address, words, FLAG(LOAD));
}

static uint32_t objects_at(const maker *m, uint32_t word) {
    return FP3_ADDRESS_IN(m->config->space_bit, FP3_SPACE_OBJECTS, word);
}

/* Some places of a run to or from rows of the store. */
static void move(maker *m, const fp3_chunks_run *run, int place, fp3_stretch range, uint32_t row,
                 uint32_t half, uint32_t flag) {
    const uint32_t log2 = m->chunks->log2;
    describe(m, run->at[place] + range.first * run->count,
             objects_at(m, half * (m->config->store_words / 2) + (row << log2) + run->reg),
             range.count * run->count,
             flag | (run->count & 63) << FP3_TRANSFER_CONTROL_RUN_LO |
                 ((1u << log2) - run->count) << FP3_TRANSFER_CONTROL_SKIP_LO);
}

/* One phase of a chunk: published words are in place `from`. */
static void make_chunk(maker *m, uint32_t number, int from) {
    const fp3_chunks *chunks = m->chunks;
    const fp3_piece *piece = &chunks->cut.pieces[number];
    const chunk_data *data = &m->data[number];
    const uint32_t half = m->config->store_words / 2;
    const uint32_t records = (piece->own.count + piece->ghosts) << chunks->log2;
    for (uint32_t i = 0; i < chunks->run_count; i++) {
        const fp3_chunks_run *run = &chunks->runs[i];
        const int place = run->is_published && from;
        uint32_t row = piece->own.count;
        move(m, run, place, piece->own, 0, 0, FLAG(LOAD));
        for (uint32_t r = 0; run->is_seen && r < piece->range_count; r++) {
            const fp3_stretch range = chunks->cut.ranges[piece->range_first + r];
            move(m, run, place, range, row, 0, FLAG(LOAD));
            row += range.count;
        }
    }
    for (uint32_t i = 0; i < 2; i++)
        if (data->words[i])
            describe(m, data->at[i], objects_at(m, i * half + records), data->words[i], FLAG(LOAD));
    set(m, m->half, FP3_ADDR_HALF, 1);
    set(m, data->awake, FP3_ADDR_WINDOW_AWAKE, 1);
    set(m, m->start, FP3_ADDR_CONTROL, 1);
    describe(m, 0, FP3_ADDR_STATUS, 1u << FP3_STATUS_DONE_LO, FLAG(WAIT));
    for (uint32_t i = 0; i < chunks->run_count; i++) {
        const fp3_chunks_run *run = &chunks->runs[i];
        if (run->is_stored)
            move(m, run, run->is_published && !from, piece->own, 0, (uint32_t)run->is_published,
                 FLAG(STORE));
    }
}

static void load_phase(maker *m, const phase_data *phase) {
    set(m, phase->at, FP3_ADDR_WINDOW_PROGRAM, phase->words);
    set(m, phase->shape, FP3_ADDR_STEP, 3);
}

/* A step; its first phase finds published words in place `from`. Returns where they are then. */
static int make_step(maker *m, int from) {
    for (uint32_t p = 0; p < m->phase_count; p++, from = !from) {
        if (m->phase_count > 1)
            load_phase(m, &m->phases[p]);
        for (uint32_t i = 0; i < m->chunks->cut.count; i++)
            make_chunk(m, i, from);
    }
    m->counts = 0;
    return from;
}

/* What the hardware is told once. */
static void prepare(maker *m) {
    set(m, m->constants, FP3_ADDR_WINDOW_CONSTANTS, m->config->registers);
    set(m, m->settings, FP3_ADDR_RECORD, 1);
    set(m, m->settings + 1, FP3_ADDR_STEPS, 1);
    set(m, m->settings + 2, FP3_ADDR_VISIT, 2);
    set(m, m->settings + 4, FP3_ADDR_PUBLISHED, 2);
    if (m->phase_count == 1)
        load_phase(m, &m->phases[0]);
}

/* A number of phases that is odd leaves published words in the second place, so two steps are what
 * is made again. */
static void make_list(maker *m, uint32_t steps) {
    fp3_chunks *chunks = m->chunks;
    const uint32_t once = m->phase_count % 2 && steps > 1 ? 2 : 1, times = steps / once;
    int from = 0;
    chunks->list = address_of(m, chunks->words);
    prepare(m);
    const uint32_t begin = chunks->words;
    m->counts = 1;
    for (uint32_t i = 0; i < once; i++)
        from = make_step(m, from);
    if (times > 1)
        describe(m, begin, 0, times - 1, FLAG(AGAIN));
    if (steps % once)
        from = make_step(m, from);
    chunks->is_second = from;
    set(m, m->enable, FP3_ADDR_INTERRUPT, 1);
    if (!m->is_full)
        chunks->memory[chunks->words - 1] |= FLAG(LAST);
}

/* ---- all of it ---- */

static fp3_status find_phases(maker *m) {
    const fp3_code *program = &m->group->program;
    m->phase_count = m->group->lists.shape.phases;
    if (!(m->phases = calloc(m->phase_count + 1, sizeof *m->phases)))
        return fp3_no_memory(m->error);
    for (uint32_t p = 0, first, end; p < m->phase_count; p++)
        if (fp3_neighbourhood_phase(program, p, &first, &end))
            m->phases[p] = (phase_data){first, end - first, 0};
    return FP3_OK;
}

static void put_phases(maker *m) {
    for (uint32_t p = 0; p < m->phase_count; p++) {
        phase_data *phase = &m->phases[p];
        const uint32_t shape[] = {0, phase->words, phase->words}, first = phase->at;
        phase->at = m->chunks->words;
        for (uint32_t i = 0; i < phase->words; i++)
            put_word(
                m, fp3_chunks_renamed(&m->chunks->numbers, &m->group->program.decoded[first + i]));
        phase->shape = put(m, shape, 3);
    }
}

static fp3_status put_settings(maker *m) {
    const uint32_t count = m->chunks->numbers.published;
    const uint64_t published = count < 64 ? BIT(count) - 1 : UINT64_MAX;
    const uint32_t settings[] = {
        m->chunks->log2, 1, 1, 0, (uint32_t)published, (uint32_t)(published >> 32)};
    uint32_t constants[FP3_BANK_SHARED_COUNT] = {0};
    const fp3_status status =
        fp3_engine_read_shared_words(m->engine, 0, 0, m->config->registers, constants);
    m->constants = put(m, constants, m->config->registers);
    m->settings = put(m, settings, sizeof settings / sizeof *settings);
    m->start = put_word(m, 1u << FP3_CONTROL_START_LO);
    m->half = put_word(m, 0);
    m->enable = put_word(m, 1u << FP3_INTERRUPT_ENABLE_LO);
    put_phases(m);
    return status;
}

static fp3_status fill(maker *m, uint32_t steps) {
    fp3_chunks *chunks = m->chunks;
    uint32_t *words = malloc(m->group->objects * sizeof *words);
    m->data = calloc(chunks->cut.count, sizeof *m->data);
    fp3_status status = words && m->data ? put_settings(m) : fp3_no_memory(m->error);
    find_runs(m);
    for (uint32_t i = 0; !status && i < chunks->run_count; i++)
        status = put_run(m, &chunks->runs[i], words);
    for (uint32_t i = 0; !status && i < chunks->cut.count; i++)
        put_lists(m, &chunks->cut.pieces[i], &m->data[i]);
    if (!status)
        make_list(m, steps);
    if (!status && m->is_full)
        status = fp3_fail(m->error, FP3_E_ARGUMENT,
                          "objects in chunks: out of memory, or they would go beyond 4 GB");
    free(words);
    return status;
}

fp3_status fp3_chunks_make(fp3_engine *engine, const fp3_config *config, uint32_t at,
                           uint32_t steps, fp3_chunks **chunks, fp3_error *error) {
    const fp3_layout *layout = fp3_engine_layout(engine);
    maker m = {.engine = engine, .group = &layout->groups[0], .config = config, .error = error};
    if (!(*chunks = m.chunks = calloc(1, sizeof **chunks)))
        return fp3_no_memory(error);
    m.chunks->at = at;
    fp3_status status = fp3_chunks_check(engine, config, error);
    if (!status && (!steps || steps > MOST_STEPS || at % 4))
        status = fp3_fail(
            error, FP3_E_ARGUMENT,
            "objects in chunks: 1 to %u steps, and an address that is a multiple of 4", MOST_STEPS);
    if (!status)
        status = find_phases(&m);
    if (!status) {
        fp3_chunks_number(m.group, &m.chunks->numbers);
        m.chunks->log2 = fp3_chunks_log2(m.group);
        status = cut(&m);
    }
    if (!status)
        status = fill(&m, steps);
    free(m.data);
    free(m.phases);
    if (status)
        fp3_chunks_free(chunks);
    return status;
}

void fp3_chunks_free(fp3_chunks **chunks) {
    if (!*chunks)
        return;
    fp3_pieces_free(&(*chunks)->cut);
    free((*chunks)->memory);
    free(*chunks);
    *chunks = NULL;
}

int fp3_chunks_read(const fp3_chunks *chunks, const uint32_t *memory, uint32_t reg,
                    uint32_t *words) {
    const uint32_t number = chunks->numbers.now[reg];
    const fp3_chunks_run *run = run_of(chunks, number);
    if (!run)
        return 0;
    const uint32_t at = run->at[run->is_published && chunks->is_second];
    for (uint32_t i = 0; i < chunks->cut.objects; i++)
        words[i] = memory[at + chunks->cut.place[i] * run->count + number - run->reg];
    return 1;
}
