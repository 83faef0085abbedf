/* both.h - objects that see each other, on the hardware and on the isa engine: the same words and
 * lists in both, what a run leaves in them, random links. Of a test that is one file.
 */
#ifndef FP3_TESTS_BOTH_H
#define FP3_TESTS_BOTH_H

#include "chance.h"
#include "foreseen.h"

#include <fp3/engine.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS_MAX = 200, LINKS_MAX = 6, FIELDS_MAX = 2 };

static unsigned failed, runs;
static const char *config = "world";
static uint32_t most = OBJECTS_MAX;
static fp3_error error;

#define FAIL(...)                                                                                  \
    do {                                                                                           \
        if (failed++ < 10) {                                                                       \
            printf("FAIL line %d: ", __LINE__);                                                    \
            printf(__VA_ARGS__);                                                                   \
            putchar('\n');                                                                         \
        }                                                                                          \
    } while (0)

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

typedef struct {
    fp3_engine *isa, *rtl;
    const fp3_image *image;
    uint32_t objects;
} both;

static fp3_engine *open_engine(const char *name, uint32_t objects, uint64_t limit) {
    fp3_engine *engine;
    fp3_engine_def def = fp3_engine_default();
    def.engine = name;
    def.config = config;
    def.objects = objects;
    def.error = &error;
    def.cycle_limit = limit;
    told(fp3_engine_open(&def, &engine));
    return engine;
}

static both open_both(const fp3_image *image, uint32_t objects) {
    both b = {open_engine("isa", objects, 0), open_engine("rtl", objects, 0), image, objects};
    told(fp3_engine_load(b.isa, image));
    told(fp3_engine_load(b.rtl, image));
    return b;
}

static void close_both(both *b) {
    fp3_engine_close(&b->isa);
    fp3_engine_close(&b->rtl);
}

static fp3_members *group_of(const fp3_engine *engine) {
    return &fp3_engine_layout(engine)->groups[0];
}

static uint32_t words_of(const both *b) { return 1u << group_of(b->rtl)->log2; }

static void compare(const both *b, const char *what, const char *how) {
    uint32_t isa[OBJECTS_MAX], rtl[OBJECTS_MAX];
    for (uint32_t reg = 0; reg < words_of(b); reg++) {
        told(fp3_engine_read_words(b->isa, 0, b->objects, reg, isa));
        told(fp3_engine_read_words(b->rtl, 0, b->objects, reg, rtl));
        for (uint32_t i = 0; i < b->objects; i++)
            if (isa[i] != rtl[i])
                FAIL("%s, %s: object %" PRIu32 " of %" PRIu32 ", word %" PRIu32 ": isa 0x%08" PRIx32
                     ", rtl 0x%08" PRIx32,
                     what, how, i, b->objects, reg, isa[i], rtl[i]);
    }
}

/* ---- runs ---- */

/* What entries remember, on both. */
static void compare_fields(const both *b, const char *what, const char *how) {
    const fp3_lists *isa = &group_of(b->isa)->lists, *rtl = &group_of(b->rtl)->lists;
    for (uint32_t i = 0; i < isa->shape.list_count; i++) {
        const fp3_list *one = &isa->lists[i], *two = &rtl->lists[i];
        const size_t entries = one->begin ? one->begin[one->objects] : 0;
        if (!one->kept || !entries)
            continue;
        if (memcmp(one->begin, two->begin, (one->objects + 1) * sizeof *one->begin) ||
            memcmp(one->field, two->field, entries * one->fields * sizeof *one->field))
            FAIL("%s, %s: list %" PRIu32 " does not remember the same", what, how, i);
    }
}

static void run_both(const both *b, uint32_t steps, const char *what, const char *how) {
    fp3_stats isa, rtl;
    told(fp3_engine_run(b->isa, steps, &isa));
    told(fp3_engine_run(b->rtl, steps, &rtl));
    runs++;
    if (isa.flags != rtl.flags)
        FAIL("%s, %s: flags %" PRIx32 " and %" PRIx32, what, how, isa.flags, rtl.flags);
    if (isa.object_steps != rtl.object_steps)
        FAIL("%s, %s: object-steps", what, how);
    compare(b, what, how);
    compare_fields(b, what, how);
    const fp3_lists *lists = &group_of(b->rtl)->lists;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        if (lists->lists[i].is_near)
            return; /* each step is a run, with lists of its own */
    uint64_t foreseen = 0;
    told(foreseen_cycles(b->rtl, steps, &foreseen));
    if (rtl.counter[FP3_COUNTER_CYCLES] != foreseen)
        FAIL("%s, %s: %" PRIu32 " objects, %" PRIu32 " steps: %" PRIu64
             " cycles, expected %" PRIu64,
             what, how, b->objects, steps, rtl.counter[FP3_COUNTER_CYCLES], foreseen);
}

/* ---- lists ---- */

typedef struct {
    uint32_t begin[OBJECTS_MAX + 1], other[OBJECTS_MAX * LINKS_MAX];
    float fields[OBJECTS_MAX * LINKS_MAX * FIELDS_MAX];
} links;

static void link_some(chance *c, uint32_t objects, uint32_t most, uint32_t fields, links *l) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < objects; i++) {
        l->begin[i] = count;
        for (uint32_t k = objects > 1 ? below(c, most + 1) : 0; k > 0; k--) {
            l->other[count] = (i + 1 + below(c, objects - 1)) % objects;
            for (uint32_t f = 0; f < fields; f++)
                l->fields[count * fields + f] = f == 0 ? 5.0f + (float)below(c, 100) : 0.1f;
            count++;
        }
    }
    l->begin[objects] = count;
}

#endif
