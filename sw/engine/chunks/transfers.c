/* SPDX-License-Identifier: Apache-2.0 */
/* transfers.c - see transfers.h. */
#include "transfers.h"

#include "gen/registers.h"
#include "machine/config.h"

#define FLAG(field) (1u << FP3_TRANSFER_CONTROL_##field##_LO)
#define DONE (1u << FP3_STATUS_DONE_LO)
#define RAISED (1u << FP3_STATUS_RAISED_LO)
#define DESCRIPTOR 4u

static uint32_t address_of(const fp3_chunks_maker *m, uint32_t word) {
    return m->chunks->at + 4 * word;
}

static void describe(fp3_chunks_maker *m, uint32_t word, uint32_t place, uint32_t words,
                     uint32_t control) {
    const uint32_t row[DESCRIPTOR] = {address_of(m, word), place, words, control};
    fp3_chunks_put(m, row, DESCRIPTOR);
    if (!m->counts)
        return;
    m->chunks->descriptors++;
    if (control & FLAG(LOAD))
        m->chunks->in += words;
    if (control & FLAG(STORE))
        m->chunks->out += words;
}

static void set(fp3_chunks_maker *m, uint32_t word, uint32_t address, uint32_t words) {
    describe(m, word, address, words, FLAG(LOAD));
}

/* A word of the part that is moved now. */
static uint32_t objects_at(const fp3_chunks_maker *m, uint32_t word) {
    return FP3_ADDRESS_IN(m->config->space_bit, FP3_SPACE_OBJECTS, m->base + word);
}

/* Words reg .. reg+count-1 of records from this row of a half on, to or from where memory has those
 * of the objects in a range of places. */
static void move(fp3_chunks_maker *m, uint32_t at, uint32_t count, fp3_stretch range, uint32_t half,
                 uint32_t row, uint32_t reg, uint32_t flag) {
    const uint32_t log2 = m->chunks->log2;
    describe(m, at + range.first * count,
             objects_at(m, half * fp3_chunks_upper(m) + (row << log2) + reg), range.count * count,
             flag | (count & 63) << FP3_TRANSFER_CONTROL_RUN_LO |
                 ((1u << log2) - count) << FP3_TRANSFER_CONTROL_SKIP_LO);
}

/* Published words are in place `from`. */
static void load_run(fp3_chunks_maker *m, const fp3_chunks_run *run, int from, fp3_stretch range,
                     uint32_t row) {
    move(m, run->at[run->is_published && from], run->count, range, 0, row, run->reg, FLAG(LOAD));
}

static void load_ghosts(fp3_chunks_maker *m, const fp3_chunks_run *run, int from,
                        const fp3_piece *piece) {
    uint32_t row = piece->own.count;
    for (uint32_t r = 0; r < piece->range_count; r++) {
        const fp3_stretch range = m->chunks->cut.ranges[piece->range_first + r];
        load_run(m, run, from, range, row);
        row += range.count;
    }
}

static void move_words(fp3_chunks_maker *m, const fp3_chunk_words *parts, uint32_t flag) {
    for (uint32_t i = 0; i < FP3_CHUNKS_PARTS; i++)
        if (parts[i].count)
            describe(m, parts[i].at, objects_at(m, parts[i].to), parts[i].count, flag);
}

/* awake: in memory, the number of objects, which are those in the first rows. */
static void start(fp3_chunks_maker *m, uint32_t awake, uint32_t part) {
    set(m, m->half, FP3_ADDR_HALF, 1);
    set(m, awake, FP3_ADDR_WINDOW_AWAKE, 1);
    set(m, m->start[part], FP3_ADDR_CONTROL, 1);
}

/* Waits until the run has ended. The list ends if status is another word then. */
static void await(fp3_chunks_maker *m, uint32_t status) {
    describe(m, 0, FP3_ADDR_STATUS, status, FLAG(WAIT));
}

/* ... or the list goes on at this word of memory. */
static void await_or(fp3_chunks_maker *m, uint32_t status, uint32_t word) {
    describe(m, word, FP3_ADDR_STATUS, status, FLAG(WAIT) | FLAG(OTHERWISE));
}

/* ---- runs, one after the other ---- */

/* Runs of one program, whose objects and words no other one of them changes. */
typedef struct runs {
    uint32_t count;
    int from; /* place of published words */
    void (*load)(fp3_chunks_maker *m, const struct runs *runs, uint32_t number);
    void (*store)(fp3_chunks_maker *m, const struct runs *runs, uint32_t number);
    uint32_t (*awake)(const fp3_chunks_maker *m, uint32_t number);
    uint32_t was;    /* of a check: where objects were */
    uint32_t raised; /* where the list goes on if an object has raised; 0: it ends */
} runs;

static void load(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    m->base = number % m->parts * fp3_chunks_room(m);
    r->load(m, r, number);
}

static void store(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    m->base = number % m->parts * fp3_chunks_room(m);
    if (r->store)
        r->store(m, r, number);
}

/* With two parts words of one are moved while the other one runs. */
static void make_runs(fp3_chunks_maker *m, const runs *r) {
    const int is_ahead = m->parts > 1;
    for (uint32_t i = 0; i < r->count; i++) {
        if (!is_ahead || !i)
            load(m, r, i);
        start(m, r->awake(m, i), i % m->parts);
        if (is_ahead && i)
            store(m, r, i - 1);
        if (is_ahead && i + 1 < r->count)
            load(m, r, i + 1);
        if (r->raised)
            await_or(m, DONE, r->raised);
        else
            await(m, DONE);
        if (!is_ahead || i + 1 == r->count)
            store(m, r, i);
    }
}

/* In any case: after a run status is not 0. Returns the descriptor, for `land`. */
static uint32_t jump(fp3_chunks_maker *m) {
    const uint32_t at = m->chunks->words;
    await_or(m, 0, 0);
    return at;
}

static void land(fp3_chunks_maker *m, uint32_t jump) {
    if (!m->is_full)
        m->chunks->memory[jump] = address_of(m, m->chunks->words);
}

static void load_program(fp3_chunks_maker *m, const fp3_chunks_program *program) {
    set(m, program->at, FP3_ADDR_WINDOW_PROGRAM, program->words);
    set(m, program->shape, FP3_ADDR_STEP, 3);
    set(m, program->published, FP3_ADDR_PUBLISHED, 2);
}

/* ---- lists of near objects ---- */

static int has_place(const fp3_chunks_maker *m, const fp3_chunks_run *run) {
    for (uint32_t k = 0; k < m->near.names.dimensions; k++)
        if (m->near.names.at[k] - run->reg < run->count)
            return 1;
    return 0;
}

static const fp3_chunks_run *near_run(const fp3_chunks_maker *m) {
    return fp3_chunks_run_of(m->chunks, m->near.names.list);
}

static uint32_t rows_of(const fp3_chunks_maker *m) { return fp3_chunks_room(m) >> m->chunks->log2; }

static void load_places(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    const fp3_chunks *chunks = m->chunks;
    const uint32_t rows = rows_of(m), first = number * rows, left = chunks->cut.objects - first;
    const fp3_stretch range = {first, left < rows ? left : rows};
    for (uint32_t i = 0; i < chunks->run_count; i++)
        if (has_place(m, &chunks->runs[i]))
            load_run(m, &chunks->runs[i], r->from, range, 0);
    move(m, r->was, m->near.names.dimensions, range, 0, 0, m->near.names.made[0], FLAG(LOAD));
}

static uint32_t rows_awake(const fp3_chunks_maker *m, uint32_t number) {
    return (number + 1) * rows_of(m) > m->chunks->cut.objects ? m->near.rest : m->near.rows;
}

/* All objects compare where they are with where they were, as many at a time as a half has rows.
 * The list goes on at `raised` if one has moved too far; 0: it ends. */
static void check(fp3_chunks_maker *m, int from, const fp3_chunks_program *program, uint32_t was,
                  uint32_t raised) {
    const uint32_t rows = rows_of(m), objects = m->chunks->cut.objects;
    const runs r = {.count = (objects + rows - 1) / rows,
                    .from = from,
                    .load = load_places,
                    .awake = rows_awake,
                    .was = was,
                    .raised = raised};
    load_program(m, program);
    make_runs(m, &r);
}

static void load_wide(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    const fp3_chunks *chunks = m->chunks;
    const fp3_piece *piece = &chunks->cut.pieces[number];
    const fp3_chunk_data *data = &m->data[number];
    for (uint32_t i = 0; i < chunks->run_count; i++)
        if (has_place(m, &chunks->runs[i])) {
            load_run(m, &chunks->runs[i], r->from, piece->own, 0);
            load_ghosts(m, &chunks->runs[i], r->from, piece);
        }
    load_run(m, near_run(m), r->from, piece->own, 0);
    move(m, m->near.wide, 1, piece->own, 0, 0, m->near.names.source, FLAG(LOAD));
    move_words(m, data->lists, FLAG(LOAD));
    move_words(m, data->wide, FLAG(LOAD));
}

static void store_lists(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    const fp3_piece *piece = &m->chunks->cut.pieces[number];
    const fp3_near_names *names = &m->near.names;
    const fp3_chunks_run *list = near_run(m);
    (void)r;
    move(m, list->at[0], 1, piece->own, 0, 0, list->reg, FLAG(STORE));
    move(m, m->near.made, names->dimensions, piece->own, 0, 0, names->made[0], FLAG(STORE));
    move_words(m, m->data[number].lists, FLAG(STORE));
}

static uint32_t chunk_awake(const fp3_chunks_maker *m, uint32_t number) {
    return m->data[number].awake;
}

static void renew(fp3_chunks_maker *m, int from) {
    const runs r = {.count = m->chunks->cut.count,
                    .from = from,
                    .load = load_wide,
                    .store = store_lists,
                    .awake = chunk_awake};
    load_program(m, &m->near.renew);
    make_runs(m, &r);
    check(m, from, &m->near.roamed, m->near.stood, 0);
}

/* Lists are made again if somebody has moved too far. What ended the check otherwise ends all. */
static void keep_lists(fp3_chunks_maker *m, int from) {
    const int counts = m->counts;
    const uint32_t over = jump(m), again = m->chunks->words;
    m->counts = 0;
    await(m, DONE | RAISED);
    renew(m, from);
    m->counts = counts;
    const uint32_t done = jump(m);
    land(m, over);
    check(m, from, &m->near.check, m->near.made, again);
    land(m, done);
}

/* ---- steps ---- */

static void load_chunk(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    const fp3_chunks *chunks = m->chunks;
    const fp3_piece *piece = &chunks->cut.pieces[number];
    for (uint32_t i = 0; i < chunks->run_count; i++) {
        load_run(m, &chunks->runs[i], r->from, piece->own, 0);
        if (chunks->runs[i].is_seen)
            load_ghosts(m, &chunks->runs[i], r->from, piece);
    }
    move_words(m, m->data[number].lists, FLAG(LOAD));
}

static void store_chunk(fp3_chunks_maker *m, const runs *r, uint32_t number) {
    const fp3_chunks *chunks = m->chunks;
    for (uint32_t i = 0; i < chunks->run_count; i++) {
        const fp3_chunks_run *run = &chunks->runs[i];
        if (run->is_stored)
            move(m, run->at[run->is_published && !r->from], run->count,
                 chunks->cut.pieces[number].own, (uint32_t)run->is_published, 0, run->reg,
                 FLAG(STORE));
    }
}

/* A step; its first phase finds published words in place `from`. Returns where they are then. */
static int make_step(fp3_chunks_maker *m, int from) {
    const int keeps = m->near.list != NULL;
    for (uint32_t p = 0; p < m->phase_count; p++, from = !from) {
        if (m->phases[p].is_near)
            keep_lists(m, from);
        if (m->phase_count > 1 || keeps)
            load_program(m, &m->phases[p]);
        const runs r = {.count = m->chunks->cut.count,
                        .from = from,
                        .load = load_chunk,
                        .store = store_chunk,
                        .awake = chunk_awake};
        make_runs(m, &r);
    }
    m->counts = 0;
    return from;
}

/* What the hardware is told once. */
static void prepare(fp3_chunks_maker *m) {
    set(m, m->constants, FP3_ADDR_WINDOW_CONSTANTS, m->config->registers);
    set(m, m->settings, FP3_ADDR_RECORD, 1);
    set(m, m->settings + 1, FP3_ADDR_STEPS, 1);
    set(m, m->settings + 2, FP3_ADDR_VISIT, 2);
    if (m->near.list)
        renew(m, 0);
    else if (m->phase_count == 1)
        load_program(m, &m->phases[0]);
}

/* A number of phases that is odd leaves published words in the second place, so two steps are what
 * is made again. */
void fp3_chunks_put_transfers(fp3_chunks_maker *m, uint32_t steps) {
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
