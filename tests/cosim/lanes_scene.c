/* lanes_scene.c - a scene whose objects see each other, on several lanes: the words of the isa
 * engine, the cycles that were foreseen, and how many of these copy words from lane to lane.
 *
 *     lanes_scene SCENE CONFIGURATION STEPS          on engine rtl
 *     lanes_scene SCENE CONFIGURATION STEPS LANES    nothing runs: what it would take with so many
 * lanes, and room for all
 *
 * Prints one line: objects N, rows N (of the fullest lane), copies N, words N (of each), cycles N,
 * of copies N.
 */
#include "engine/common/ghosts.h"
#include "engine/common/partition.h"
#include "foreseen.h"

#include <fp3/scene.h>
#include <inttypes.h>
#include <machine/cycles.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fp3_error error;

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

/* lanes: instead of the configuration's; 0: those. */
static fp3_engine *open_engine(const fp3_scene *scene, const char *name, uint32_t lanes) {
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_scene_engine(scene);
    fp3_config config = *fp3_config_find(def.config);
    def.engine = name;
    def.error = &error;
    config.lanes = lanes;
    config.store_words = 1 << 20;
    told(lanes ? fp3_engine_open_as(&def, &config, &engine) : fp3_engine_open(&def, &engine));
    told(fp3_scene_load(scene, engine, &error));
    return engine;
}

static fp3_members *group_of(const fp3_engine *engine) {
    return &fp3_engine_layout(engine)->groups[0];
}

/* As a driver does it when a run begins. */
static void place(const fp3_engine *engine) {
    fp3_members *group = group_of(engine);
    uint32_t *slot = malloc(group->objects * sizeof *slot);
    if (!slot)
        exit(1);
    told(fp3_partition_find(engine, slot));
    told(fp3_layout_arrange(group, slot, 0, &error));
}

/* Each step is then a run, with lists of its own. */
static int is_near(const fp3_engine *engine) {
    const fp3_lists *lists = &group_of(engine)->lists;
    int is = 0;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is = is || lists->lists[i].is_near;
    return is;
}

static void print(fp3_engine *engine, uint32_t steps, uint64_t cycles) {
    const fp3_members *group = group_of(engine);
    const fp3_config *config = fp3_engine_config(engine);
    fp3_ghosts ghosts;
    uint32_t words = 0;
    told(fp3_ghosts_find(engine, &ghosts));
    for (uint64_t left = fp3_layout_published(group); left; left &= left - 1)
        words++;
    printf("objects %" PRIu32 ", rows %" PRIu32 ", copies %" PRIu32 ", words %" PRIu32
           ", cycles %" PRIu64 ", of copies %" PRIu64 "\n",
           group->objects, fp3_layout_rows(fp3_engine_layout(engine), config, 0, 0), ghosts.count,
           words, cycles,
           steps * group->lists.shape.phases * fp3_cycles_copies(config, ghosts.count, words));
    fp3_ghosts_free(&ghosts);
}

static int compare(fp3_engine *isa, fp3_engine *rtl, size_t objects) {
    uint32_t *x = malloc(objects * sizeof *x), *y = malloc(objects * sizeof *y);
    int differ = 0;
    if (!x || !y)
        exit(1);
    for (uint32_t reg = 0; reg < 1u << group_of(rtl)->log2; reg++) {
        told(fp3_engine_read_words(isa, 0, objects, reg, x));
        told(fp3_engine_read_words(rtl, 0, objects, reg, y));
        differ += memcmp(x, y, objects * sizeof *x) != 0;
    }
    if (differ)
        printf("FAIL: %d registers differ\n", differ);
    free(x);
    free(y);
    return differ;
}

int main(int argc, char **argv) {
    fp3_scene *scene = NULL;
    uint64_t cycles = 0;
    int failed = 0;
    if (argc < 4)
        return 2;
    const uint32_t steps = (uint32_t)strtoul(argv[3], NULL, 0);
    told(fp3_scene_open(argv[1], argv[2], &scene, &error));
    fp3_engine *isa = open_engine(scene, "isa", argc > 4 ? (uint32_t)strtoul(argv[4], NULL, 0) : 0);
    if (argc > 4) {
        place(isa);
        told(foreseen_cycles(isa, steps, &cycles));
        print(isa, steps, cycles);
    } else {
        fp3_engine *rtl = open_engine(scene, "rtl", 0);
        fp3_stats stats;
        told(fp3_engine_run(rtl, steps, &stats));
        told(foreseen_cycles(rtl, steps, &cycles));
        told(fp3_engine_run(isa, steps, NULL));
        print(rtl, steps, stats.counter[FP3_COUNTER_CYCLES]);
        failed = compare(isa, rtl, fp3_engine_definition(rtl)->objects);
        if (!is_near(rtl) && cycles != stats.counter[FP3_COUNTER_CYCLES]) {
            printf("FAIL: %" PRIu64 " cycles were foreseen\n", cycles);
            failed = 1;
        }
        fp3_engine_close(&rtl);
    }
    fp3_engine_close(&isa);
    fp3_scene_close(&scene);
    return failed != 0;
}
