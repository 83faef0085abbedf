/* SPDX-License-Identifier: Apache-2.0 */
/* linked.c - objects that see each other, more than the store holds: all steps are one list of
 * transfers. Simulated hardware makes it, or the image of memory is for another system. */
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
    const uint32_t *rows;  /* of each object; NULL: its number */
    const uint32_t *order; /* NULL: their numbers */
    uint32_t first;
} ordered;

static uint32_t longest(const void *user, uint32_t reg, uint32_t first, uint32_t rows) {
    const ordered *s = user;
    const fp3_list *list = s->lists->lists;
    uint32_t most = 0;
    while (list->reg != reg)
        list++;
    for (uint32_t i = s->first + first; i < s->first + first + rows; i++) {
        const uint32_t object = s->order ? s->order[i] : i;
        const uint32_t length = fp3_list_length(list, s->rows ? s->rows[object] : object);
        most = length > most ? length : most;
    }
    return most;
}

/* Cycles of a step of these, as tests/cosim/foreseen.h holds them to the hardware's. */
static uint64_t cycles_of(const fp3_config *config, const fp3_members *group, const ordered *s,
                          uint32_t rows) {
    const fp3_phased program = {group->program.decoded, group->program.count};
    const fp3_phased_run run = {.rows = rows, .longest = longest, .user = s};
    return fp3_phased_cycles(config, &program, &run);
}

static uint64_t in_chunks(const fp3_config *config, const fp3_members *group, const uint32_t *rows,
                          const fp3_pieces *cut) {
    uint64_t cycles = 0;
    for (uint32_t i = 0; i < cut->count; i++) {
        const ordered s = {&group->lists, rows, cut->object, cut->pieces[i].own.first};
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

/* ---- a scene, in the engine fast and in chunks ---- */

typedef struct {
    const fp3_config *config;
    fp3_scene *scene;
    fp3_engine *fast;
    fp3_chunks *chunks;
    double objects;
    /* Cycles of a step of an object, if all were in the store; and in chunks, without transfers. */
    double in_store, in_chunks;
    uint32_t ghosts;
} linked;

static void open_linked(linked *l, const char *config, const linked_run *run, uint32_t at) {
    fp3_error error;
    fp3_stats stats;
    *l = (linked){.config = fp3_config_find(config)};
    told(fp3_scene_open(run->scene, config, &l->scene, &error), &error);
    NEED(l->config);
    fp3_engine_def def = fp3_scene_engine(l->scene);
    def.engine = "fast";
    def.error = &error;
    told(fp3_engine_open(&def, &l->fast), &error);
    told(fp3_scene_load(l->scene, l->fast, &error), &error);
    if (run->from)
        told(fp3_engine_run(l->fast, run->from, &stats), &error);
    const fp3_chunks_how how = {at, run->steps, run->roam};
    told(fp3_chunks_make(l->fast, l->config, &how, &l->chunks, &error), &error);
    l->objects = l->chunks->cut.objects;
    for (uint32_t i = 0; i < l->chunks->cut.count; i++)
        l->ghosts += l->chunks->cut.pieces[i].ghosts;
}

static void close_linked(linked *l) {
    fp3_chunks_free(&l->chunks);
    fp3_engine_close(&l->fast);
    fp3_scene_close(&l->scene);
}

/* Of engine fast, whose lists of near objects say the cycles of each step. */
static uint64_t hash_after(linked *l, uint32_t steps) {
    fp3_stats stats;
    fp3_error error = {0};
    const fp3_pieces *cut = &l->chunks->cut;
    for (uint32_t i = 0; i < steps; i++) {
        told(fp3_engine_run(l->fast, 1, &stats), &error);
        const fp3_members *group = fp3_engine_members(l->fast, 0);
        const uint32_t *rows = fp3_engine_rows(l->fast);
        const ordered all = {&group->lists, rows, NULL, 0};
        l->in_store += (double)cycles_of(l->config, group, &all, cut->objects);
        l->in_chunks += (double)in_chunks(l->config, group, rows, cut);
    }
    l->in_store /= steps * l->objects;
    l->in_chunks /= steps * l->objects;
    return hash_of(l->fast, l->chunks, NULL);
}

/* ---- the hardware makes the steps ---- */

/* The status of the last run tells why a list of transfers has been refused. */
static void end_refused(alone *a, const linked_run *run) {
    const uint32_t done = 1u << FP3_STATUS_DONE_LO, raised = 1u << FP3_STATUS_RAISED_LO;
    uint32_t word = 0;
    NEED(!fp3_rtl_transfer_one(a->hardware.ops, a->rtl, 0, FP3_ADDR_STATUS, &word));
    if (word >> FP3_STATUS_NO_ROOM_LO & 1)
        fprintf(stderr, "alone: a list of near objects has no room: fewer steps\n");
    else if (word == (done | raised))
        fprintf(stderr,
                "alone: an object has gone farther than %g: fewer steps, or a larger ROAM\n",
                run->roam);
    else
        fprintf(stderr, "alone: the hardware refuses the list of transfers, status %" PRIu32 "\n",
                word);
    exit(1);
}

void measure_linked(const char *config, const linked_run *run, uint32_t rate, uint32_t latency) {
    const uint32_t steps = run->steps;
    fp3_bare_moved how;
    alone a = {0};
    linked l;
    open_linked(&l, config, run, AT);
    const fp3_chunks *chunks = l.chunks;
    const fp3_rtl_memory shape = {AT / 4 + chunks->words, rate, latency};
    alone_open(&a, config, &shape, 0);
    memcpy(a.memory + AT / 4, chunks->memory, chunks->words * sizeof *a.memory);
    const uint64_t begin = alone_now(&a);
    NEED(!fp3_bare_move_list(&a.fp3, chunks->list));
    const uint64_t accesses = a.accesses;
    const fp3_status status = fp3_bare_move_wait(&a.fp3, POLLS, &how);
    if (status == FP3_E_SYSTEM && how == FP3_BARE_REFUSED)
        end_refused(&a, run);
    NEED(!status && how == FP3_BARE_MOVED);
    const double cycles = (double)(alone_now(&a) - begin) / steps;
    const uint64_t between = a.accesses - accesses;
    const uint64_t hash = hash_of(l.fast, chunks, a.memory + AT / 4);
    const double words = (double)(chunks->in + chunks->out + 4 * chunks->descriptors);
    NEED(hash == hash_after(&l, steps));
    printf("{\"scene\": \"%s\", \"config\": \"%s\", \"memory\": %g, \"latency\": %" PRIu32
           ", \"objects\": %" PRIu32 ", \"from\": %" PRIu32 ", \"steps\": %" PRIu32
           ", \"roam\": %g, \"chunks\": %" PRIu32 ", \"ghosts\": %" PRIu32
           ", \"words_in\": %.2f, \"words_out\": %.2f, \"descriptors\": %" PRIu64
           ", \"cycles_per_object_step\": %.3f, \"in_store\": %.3f, \"lanes_busy\": %.4f, "
           "\"memory_busy\": %.4f, \"hash\": \"%016" PRIx64
           "\", \"host_accesses_between_steps\": %" PRIu64 "}\n",
           name_of(run->scene), config, rate / 1000.0, latency, chunks->cut.objects, run->from,
           steps, run->roam, chunks->cut.count, l.ghosts, (double)chunks->in / l.objects,
           (double)chunks->out / l.objects, chunks->descriptors, cycles / l.objects, l.in_store,
           l.in_chunks * l.objects / cycles, words / (rate < 1000 ? rate / 1000.0 : 1) / cycles,
           hash, between);
    close_linked(&l);
    alone_close(&a);
}

/* ---- the image of memory alone ---- */

/* Of each run of registers that steps store: where it begins before the steps, and after them. */
static void print_runs(const fp3_chunks *chunks) {
    const char *comma = "";
    for (uint32_t i = 0; i < chunks->run_count; i++) {
        const fp3_chunks_run *run = &chunks->runs[i];
        if (!run->is_stored)
            continue;
        const uint32_t last = run->at[run->is_published && chunks->is_second];
        printf("%s[%" PRIu32 ", %" PRIu32 ", %" PRIu32 "]", comma, chunks->at + 4 * run->at[0],
               chunks->at + 4 * last, run->count);
        comma = ", ";
    }
}

void image_linked(const char *config, const linked_run *run, uint32_t at, const char *image) {
    linked l;
    open_linked(&l, config, run, at);
    const fp3_chunks *chunks = l.chunks;
    FILE *file = fopen(image, "wb");
    int is_written = file && fwrite(chunks->memory, sizeof *chunks->memory, chunks->words, file) ==
                                 chunks->words;
    if (file && fclose(file))
        is_written = 0;
    if (!is_written) {
        fprintf(stderr, "alone: cannot write '%s'\n", image);
        exit(1);
    }
    const uint64_t begin = hash_of(l.fast, chunks, NULL), end = hash_after(&l, run->steps);
    printf("{\"scene\": \"%s\", \"config\": \"%s\", \"at\": %" PRIu32 ", \"words\": %" PRIu32
           ", \"list\": %" PRIu32 ", \"objects\": %" PRIu32 ", \"steps\": %" PRIu32
           ", \"chunks\": %" PRIu32 ", \"ghosts\": %" PRIu32
           ", \"in_store\": %.3f, \"begins\": \"%016" PRIx64 "\", \"ends\": \"%016" PRIx64
           "\", \"runs\": [",
           name_of(run->scene), config, at, chunks->words, chunks->list, chunks->cut.objects,
           run->steps, chunks->cut.count, l.ghosts, l.in_store, begin, end);
    print_runs(chunks);
    printf("], \"places\": [");
    for (uint32_t i = 0; i < chunks->cut.objects; i++)
        printf("%s%" PRIu32, i ? ", " : "", chunks->cut.place[i]);
    printf("]}\n");
    close_linked(&l);
}
