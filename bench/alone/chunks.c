/* SPDX-License-Identifier: Apache-2.0 */
/* chunks.c - more objects than the store holds: they stay in memory, and one list of transfers
 * takes chunk after chunk to the store, runs it, and takes it back. */
#include "hardware.h"
#include "rows.h"

#include "machine/visit.h"
#include <fp3/engine.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Words of memory: the start of a run, descriptors, objects. */
#define START 0u
#define LIST_AT 16u
#define OBJECTS 0x10000u
#define DESCRIPTORS_MOST ((OBJECTS - LIST_AT) / 4)
#define BIT(field) (1u << FP3_TRANSFER_CONTROL_##field##_LO)

typedef struct {
    fp3_image *image;
    fp3_visit *visit;
    fp3_engine *fast;
    uint32_t record; /* the binary logarithm of the words of one */
    uint32_t objects, chunks;
    uint32_t lanes, rows; /* of a chunk, rows of each lane; the last ones may be the same object */
} scene;

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Objects of which each has another speed, on the engine fast. */
static void open_scene(scene *s, const char *path, uint32_t objects) {
    fp3_error error;
    fp3_engine_def def = fp3_engine_default();
    def.engine = "fast";
    def.config = "many_full"; /* the arithmetic of every such configuration */
    def.objects = objects;
    def.error = &error;
    NEED(!fp3_image_load(path, &s->image, &error) && !fp3_visit_make(s->image, &s->visit, &error));
    s->record = s->visit->log2 < 3 ? 3 : s->visit->log2;
    NEED(!fp3_engine_open(&def, &s->fast) && !fp3_engine_load(s->fast, s->image));
    NEED(!fp3_engine_set(s->fast, "h", 0.015625f) && !fp3_engine_set(s->fast, "c2", -1));
    NEED(!fp3_engine_set(s->fast, "r_x", 0.5f));
    const fp3_symbol *speed = fp3_image_find(s->image, "v_y", FP3_CLASSES_OBJECT);
    NEED(speed);
    for (uint32_t i = 0; i < objects; i++) {
        const float v = 1.5f + 0.4f * (float)i / (float)objects;
        NEED(!fp3_engine_write(s->fast, i, 1, speed->index, &v));
    }
}

/* Objects of a chunk. In memory those of a lane stand together, lane behind lane. */
static uint32_t chunk_of(const scene *s) { return s->lanes * s->rows; }

/* The words of the objects as they are in fast, as records. */
static void put_records(const scene *s, uint32_t *records) {
    const uint32_t words = 1u << s->record;
    for (uint32_t i = 0; i < s->chunks * chunk_of(s); i++)
        for (uint32_t r = 0; r < words; r++)
            if (s->visit->kept >> r & 1) {
                float value;
                const uint32_t of = i < s->objects ? i : s->objects - 1;
                NEED(!fp3_engine_read(s->fast, of, 1, r, &value));
                records[i * words + r] = bits_of(value);
            }
}

/* FNV-1a of the words that are kept, object by object. */
static uint64_t hash_of(const scene *s, const uint32_t *records) {
    uint64_t hash = 14695981039346656037u;
    for (uint32_t i = 0; i < s->objects; i++)
        for (uint32_t r = 0; r < 1u << s->record; r++)
            if (s->visit->kept >> r & 1)
                hash = (hash ^ records[(i << s->record) + r]) * 1099511628211u;
    return hash;
}

static void load_program(const scene *s, fp3_bare *fp3) {
    fp3_bare_constant *constants = malloc((s->image->constant_count + 1) * sizeof *constants);
    NEED(constants);
    for (uint32_t i = 0; i < s->image->constant_count; i++)
        constants[i] =
            (fp3_bare_constant){s->image->constants[i].index, s->image->constants[i].bits};
    const fp3_bare_program p = {.words = s->visit->code,
                                .word_count = s->visit->code_count,
                                .loads = s->visit->loads_in_front,
                                .stores = s->visit->stores_behind,
                                .step = s->visit->step,
                                .last = s->visit->last,
                                .constants = constants,
                                .constant_count = s->image->constant_count,
                                .registers = 1,
                                .shared = 1,
                                .record = s->record,
                                .revision = fp3->revision,
                                .arithmetic = s->image->words};
    NEED(!fp3_bare_load(fp3, 0, &p));
    free(constants);
    const char *const names[] = {"h", "c2"};
    for (int i = 0; i < 2; i++) {
        float value;
        const fp3_symbol *symbol = fp3_image_find(s->image, names[i], FP3_CLASSES_SHARED);
        NEED(symbol && !fp3_engine_get(s->fast, 0, names[i], &value));
        NEED(!fp3_bare_write_shared(fp3, 0, symbol->index, bits_of(value)));
    }
    NEED(!fp3_bare_list(fp3, 0, chunk_of(s)));
}

static void descriptor(uint32_t **at, uint32_t memory, uint32_t place, uint32_t words,
                       uint32_t control) {
    const uint32_t row[] = {memory, place, words, control};
    memcpy(*at, row, sizeof row);
    *at += 4;
}

/* All lanes of a chunk: one range of the store for each. */
static void move_lanes(const alone *a, const scene *s, uint32_t chunk, uint32_t control,
                       uint32_t **at) {
    const uint32_t words = s->rows << s->record;
    for (uint32_t lane = 0; lane < s->lanes; lane++)
        descriptor(at, 4 * (OBJECTS + (chunk * s->lanes + lane) * words),
                   FP3_ADDRESS_IN(a->fp3.space_bit, FP3_SPACE_OBJECTS, lane * a->fp3.store), words,
                   control);
}

static void describe(const alone *a, const scene *s) {
    uint32_t *at = a->memory + LIST_AT;
    NEED(s->chunks * (2 * s->lanes + 2) <= DESCRIPTORS_MOST);
    a->memory[START] = 1u << FP3_CONTROL_START_LO;
    for (uint32_t chunk = 0; chunk < s->chunks; chunk++) {
        move_lanes(a, s, chunk, BIT(LOAD), &at);
        descriptor(&at, 4 * START, FP3_ADDR_CONTROL, 1, BIT(LOAD));
        descriptor(&at, 0, FP3_ADDR_STATUS, 1u << FP3_STATUS_DONE_LO, BIT(WAIT));
        move_lanes(a, s, chunk, BIT(STORE), &at);
    }
    at[-1] |= BIT(LAST);
}

/* Cycles of one run of a chunk that is in the store already. */
static double in_store(alone *a, const scene *s, uint32_t steps) {
    fp3_bare_outcome outcome;
    uint64_t cycles = 0;
    for (uint32_t lane = 0; lane < s->lanes; lane++)
        alone_move(a, FP3_BARE_TO_PROCESSOR, lane, 0, s->rows,
                   4 * (OBJECTS + (lane * s->rows << s->record)));
    NEED(!fp3_bare_start(&a->fp3, 0, steps, steps, 0));
    NEED(!fp3_bare_wait(&a->fp3, 0, POLLS, &outcome) && outcome == FP3_BARE_DONE);
    NEED(!fp3_bare_counter(&a->fp3, 0, FP3_ADDR_COUNTER_CYCLES, &cycles));
    return (double)cycles / chunk_of(s) / steps;
}

void measure_chunks(const char *config, const char *image, uint32_t objects, uint32_t steps,
                    uint32_t rate, uint32_t latency) {
    scene s = {.objects = objects};
    alone a = {0};
    fp3_bare_moved how;
    fp3_stats stats;
    open_scene(&s, image, objects);
    const fp3_rtl_memory none = {0, 1, 0};
    alone_open(&a, config, &none, 0);
    s.lanes = a.fp3.lanes;
    const uint32_t most = (a.fp3.store >> s.record) * s.lanes;
    s.chunks = (objects + most - 1) / most;
    s.rows = (objects + s.chunks * s.lanes - 1) / (s.chunks * s.lanes);
    const uint32_t words = s.chunks * chunk_of(&s) << s.record;
    const fp3_rtl_memory shape = {OBJECTS + words, rate, latency};
    a.shape = shape;
    NEED(a.memory = a.hardware.ops->memory(a.rtl, &shape));
    put_records(&s, a.memory + OBJECTS);
    load_program(&s, &a.fp3);
    const double inside = in_store(&a, &s, steps); /* the settings of the run stay */
    describe(&a, &s);
    const uint64_t begin = alone_now(&a);
    NEED(!fp3_bare_move_list(&a.fp3, 4 * LIST_AT));
    const uint64_t accesses = a.accesses;
    NEED(!fp3_bare_move_wait(&a.fp3, POLLS, &how) && how == FP3_BARE_MOVED);
    const double cycles = (double)(alone_now(&a) - begin) / objects / steps;
    const uint64_t hash = hash_of(&s, a.memory + OBJECTS);
    uint32_t *wanted = calloc(words, sizeof *wanted);
    NEED(wanted && !fp3_engine_run(s.fast, steps, &stats));
    put_records(&s, wanted);
    NEED(hash == hash_of(&s, wanted));
    printf("{\"scene\": \"kepler rk4\", \"config\": \"%s\", \"memory\": %g, \"latency\": %" PRIu32
           ", \"objects\": %" PRIu32 ", \"visit\": %" PRIu32
           ", \"cycles_per_object_step\": %.3f, \"in_store\": %.3f, \"hash\": \"%016" PRIx64
           "\", \"host_accesses_between_steps\": %" PRIu64 "}\n",
           config, rate / 1000.0, latency, objects, steps, cycles, inside, hash,
           a.accesses - accesses);
    free(wanted);
    fp3_engine_close(&s.fast);
    fp3_visit_free(&s.visit);
    fp3_image_free(&s.image);
    alone_close(&a);
}
