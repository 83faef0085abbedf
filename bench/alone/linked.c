/* SPDX-License-Identifier: Apache-2.0 */
/* linked.c - objects that see each other by links, more than the store holds: all steps are one
 * list of transfers. */
#include <fp3/scene.h> /* first: FP3_ALL is a relation there, and a macro of the bare driver */

#include "hardware.h"
#include "rows.h"

#include "engine/chunks/chunks.h"
#include "machine/config.h"
#include "machine/phased.h"
#include <inttypes.h>
#include <string.h>

#define AT 0x1000 /* where memory has them: not at its first word, so that each address counts */

/* Objects of one run: those in these places of an order. */
typedef struct {
    const fp3_lists *lists;
    const uint32_t *order; /* NULL: their numbers */
    uint32_t first;
} stood;

static uint32_t longest(const void *user, uint32_t reg, uint32_t first, uint32_t rows) {
    const stood *s = user;
    const fp3_list *list = s->lists->lists;
    uint32_t most = 0;
    while (list->reg != reg)
        list++;
    for (uint32_t i = s->first + first; i < s->first + first + rows; i++) {
        const uint32_t length = fp3_list_length(list, s->order ? s->order[i] : i);
        most = length > most ? length : most;
    }
    return most;
}

/* Cycles of a step of these, as tests/cosim/foreseen.h holds them to the hardware's. */
static uint64_t cycles_of(const fp3_config *config, const fp3_members *group, const stood *s,
                          uint32_t rows) {
    const fp3_phased program = {group->program.decoded, group->program.count};
    const fp3_phased_run run = {.rows = rows, .longest = longest, .user = s};
    return fp3_phased_cycles(config, &program, &run);
}

static uint64_t in_chunks(const fp3_config *config, const fp3_members *group,
                          const fp3_pieces *cut) {
    uint64_t cycles = 0;
    for (uint32_t i = 0; i < cut->count; i++) {
        const stood s = {&group->lists, cut->object, cut->pieces[i].own.first};
        cycles += cycles_of(config, group, &s, cut->pieces[i].own.count);
    }
    return cycles;
}

static uint64_t add(uint64_t hash, const uint32_t *words, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        hash = (hash ^ words[i]) * 1099511628211u;
    return hash;
}

/* FNV-1a of all words that steps store, register by register; from memory, or of the engine. */
static uint64_t hash_of(fp3_engine *engine, const fp3_chunks *chunks, const uint32_t *memory) {
    const uint32_t objects = chunks->cut.objects;
    uint32_t *words = malloc(objects * sizeof *words);
    uint64_t hash = 14695981039346656037u;
    NEED(words);
    for (uint32_t i = 0; i < chunks->run_count; i++)
        for (uint32_t k = 0; chunks->runs[i].is_stored && k < chunks->runs[i].count; k++) {
            const uint32_t reg = chunks->numbers.before[chunks->runs[i].reg + k];
            if (memory)
                NEED(fp3_chunks_read(chunks, memory, reg, words));
            else
                NEED(!fp3_engine_read_words(engine, 0, objects, reg, words));
            hash = add(hash, words, objects);
        }
    free(words);
    return hash;
}

static void told(fp3_status status, const fp3_error *error) {
    if (!status)
        return;
    fprintf(stderr, "alone: %s\n", error->text);
    exit(1);
}

static const char *name_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void measure_linked(const char *config, const char *path, uint32_t steps, uint32_t rate,
                    uint32_t latency) {
    fp3_scene *scene = NULL;
    fp3_engine *fast = NULL;
    fp3_chunks *chunks = NULL;
    fp3_bare_moved how;
    fp3_stats stats;
    fp3_error error;
    alone a = {0};
    told(fp3_scene_open(path, config, &scene, &error), &error);
    fp3_engine_def def = fp3_scene_engine(scene);
    def.engine = "fast";
    def.error = &error;
    told(fp3_engine_open(&def, &fast), &error);
    told(fp3_scene_load(scene, fast, &error), &error);
    const fp3_config *hardware = fp3_config_find(config);
    NEED(hardware);
    told(fp3_chunks_make(fast, hardware, AT, steps, &chunks, &error), &error);
    const fp3_rtl_memory shape = {AT / 4 + chunks->words, rate, latency};
    alone_open(&a, config, &shape, 0);
    memcpy(a.memory + AT / 4, chunks->memory, chunks->words * sizeof *a.memory);
    const uint64_t begin = alone_now(&a);
    NEED(!fp3_bare_move_list(&a.fp3, chunks->list));
    const uint64_t accesses = a.accesses;
    NEED(!fp3_bare_move_wait(&a.fp3, POLLS, &how) && how == FP3_BARE_MOVED);
    const double cycles = (double)(alone_now(&a) - begin) / steps;
    const uint64_t between = a.accesses - accesses;
    const uint64_t hash = hash_of(fast, chunks, a.memory + AT / 4);
    const fp3_members *group = &fp3_engine_layout(fast)->groups[0];
    const stood all = {&group->lists, NULL, 0};
    const double objects = chunks->cut.objects;
    const double inside = (double)cycles_of(hardware, group, &all, chunks->cut.objects) / objects;
    const double words = (double)(chunks->in + chunks->out + 4 * chunks->descriptors);
    uint32_t ghosts = 0;
    for (uint32_t i = 0; i < chunks->cut.count; i++)
        ghosts += chunks->cut.pieces[i].ghosts;
    told(fp3_engine_run(fast, steps, &stats), &error);
    NEED(hash == hash_of(fast, chunks, NULL));
    printf("{\"scene\": \"%s\", \"config\": \"%s\", \"memory\": %g, \"latency\": %" PRIu32
           ", \"objects\": %" PRIu32 ", \"steps\": %" PRIu32 ", \"chunks\": %" PRIu32
           ", \"ghosts\": %" PRIu32 ", \"words_in\": %.2f, \"words_out\": %.2f, "
           "\"descriptors\": %" PRIu64 ", \"cycles_per_object_step\": %.3f, \"in_store\": %.3f, "
           "\"lanes_busy\": %.4f, \"memory_busy\": %.4f, \"hash\": \"%016" PRIx64
           "\", \"host_accesses_between_steps\": %" PRIu64 "}\n",
           name_of(path), config, rate / 1000.0, latency, chunks->cut.objects, steps,
           chunks->cut.count, ghosts, (double)chunks->in / objects, (double)chunks->out / objects,
           chunks->descriptors, cycles / objects, inside,
           (double)in_chunks(hardware, group, &chunks->cut) / cycles,
           words / (rate < 1000 ? rate / 1000.0 : 1) / cycles, hash, between);
    fp3_chunks_free(&chunks);
    fp3_engine_close(&fast);
    fp3_scene_close(&scene);
    alone_close(&a);
}
