/* lives.c - objects with random lifetimes, over several runs: each holds after them what it holds
 * alone after as many steps as it lived, on every engine; and what fp3_engine_live refuses.
 *
 *     lives SEED PROGRAMS_DIRECTORY
 */
#include <fp3/engine.h>
#include <fp3/program.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS 20
#define MOST 60 /* objects */

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "lives.c:%d: %s: %s\n", __LINE__, #condition, error.text);             \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

static fp3_error error;
static uint64_t chance;

static uint32_t below(uint32_t n) {
    chance = chance * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(chance >> 33) % n;
}

typedef struct {
    float v, s;
    uint32_t slept;
} states;

static fp3_program *programs[2];           /* ship.s, ship_sleep.s */
static states alone[2][MOST][STEPS + 1];   /* after so many steps, if nobody is born or gone */
static uint64_t moved[2][MOST][STEPS + 1]; /* steps that it has not slept */
static const char *const configs[] = {"many_full", "sixteen", "shared", "array", "single"};

static void set(fp3_engine *engine, size_t object, const fp3_program *program, const char *name,
                float value) {
    const fp3_symbol *symbol = fp3_image_find(program->image, name, FP3_CLASSES_HOST);
    if (symbol)
        EXPECT(!fp3_engine_write(engine, object, 1, symbol->index, &value));
}

static void set_values(fp3_engine *engine, int program, size_t first, size_t count) {
    EXPECT(!fp3_engine_set(engine, "h", 0.5f));
    fp3_engine_set(engine, "eps", 0.057f); /* some sleep before they are gone */
    for (size_t i = 0; i < count; i++) {
        set(engine, first + i, programs[program], "v", 0.25f);
        set(engine, first + i, programs[program], "s", 0);
        set(engine, first + i, programs[program], "slept", 0);
        set(engine, first + i, programs[program], "C", 4.1e4f);
        set(engine, first + i, programs[program], "rm", 1.2e-6f);
        set(engine, first + i, programs[program], "T", 1e5f + 2e3f * (float)i);
    }
}

static states states_of(fp3_engine *engine, int program, size_t object) {
    states is = {0};
    EXPECT(!fp3_engine_get(engine, object, "v", &is.v) &&
           !fp3_engine_get(engine, object, "s", &is.s));
    if (program) {
        fp3_object_status status;
        EXPECT(!fp3_engine_status(engine, object, 1, &status));
        is.slept = status.slept;
    }
    return is;
}

static fp3_engine *open_engine(const char *name, const char *config, uint32_t objects,
                               uint32_t visit) {
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.engine = name;
    def.config = config;
    def.objects = objects;
    def.visit = visit;
    def.error = &error;
    def.is_interpreted = below(2) == 0;
    EXPECT(!fp3_engine_open(&def, &engine));
    return engine;
}

static void live_alone(int program) {
    fp3_engine *engine = open_engine("isa", "many_full", MOST, 0);
    size_t asleep = 0;
    EXPECT(!fp3_engine_load(engine, programs[program]->image));
    set_values(engine, program, 0, MOST);
    for (uint32_t n = 0; n <= STEPS; n++) {
        for (size_t i = 0; i < MOST; i++) {
            alone[program][i][n] = states_of(engine, program, i);
            const uint32_t slept = alone[program][i][n].slept;
            moved[program][i][n] = slept ? slept : n;
            asleep += n == STEPS && slept;
        }
        EXPECT(!fp3_engine_run(engine, n < STEPS, NULL));
    }
    EXPECT(program ? asleep > 5 && asleep < MOST - 5 : asleep == 0);
    fp3_engine_close(&engine);
}

/* ---- a scene ---- */

typedef struct {
    int program;
    size_t first, count;
} group;

typedef struct {
    uint64_t born, gone;
} life;

static uint64_t lived(const life *of, uint64_t made) {
    const uint64_t to = of->gone < made ? of->gone : made;
    return to > of->born ? to - of->born : 0;
}

/* What all objects hold, in which stage they are; how many steps they have made. */
static uint64_t check(fp3_engine *engine, const group *of, const life *lives, uint64_t made) {
    uint64_t steps = 0;
    for (size_t i = 0; i < of->count; i++) {
        const life *l = &lives[of->first + i];
        const uint64_t n = lived(l, made);
        const states is = states_of(engine, of->program, of->first + i);
        states expected = alone[of->program][i][n];
        expected.slept += expected.slept ? (uint32_t)l->born : 0;
        steps += moved[of->program][i][n];
        if (memcmp(&is, &expected, sizeof is)) {
            fprintf(stderr,
                    "object %zu of program %d, %" PRIu64 " to %" PRIu64 ", after %" PRIu64
                    ": %g %g %u, expected %g %g %u\n",
                    of->first + i, of->program, l->born, l->gone, made, (double)is.v, (double)is.s,
                    is.slept, (double)expected.v, (double)expected.s, expected.slept);
            exit(1);
        }
        EXPECT(fp3_engine_life(engine, of->first + i) == (made < l->born   ? FP3_UNBORN
                                                          : made < l->gone ? FP3_ALIVE
                                                                           : FP3_GONE));
    }
    return steps;
}

static life random_life(void) {
    const uint64_t born = below(4) ? below(STEPS + 4) : 0;
    const uint64_t gone = below(4) ? born + 1 + below(STEPS) : below(2) ? FP3_FOREVER : 1ull << 40;
    return (life){born, gone};
}

static void try_scene(const char *name, const char *config) {
    const int is_one = !strcmp(config, "single"), is_mixed = !is_one && below(2) &&
                                                             strcmp(config, "many_full") &&
                                                             strcmp(config, "sixteen");
    const uint32_t objects = is_one ? 1 : 2 + below(MOST - 2),
                   first = is_mixed ? 1 + below(objects - 1) : objects;
    const group groups[] = {{is_one ? 0 : (int)below(2), 0, first},
                            {(int)below(2), first, objects - first}};
    const fp3_group load[] = {
        {.image = programs[groups[0].program]->image, .objects = first},
        {.image = programs[groups[1].program]->image, .objects = objects - first}};
    fp3_engine *engine = open_engine(name, config, objects, below(3) ? 0 : 1 + below(7));
    life lives[MOST];
    uint64_t before = 0;
    EXPECT(!fp3_engine_load_groups(engine, load, is_mixed ? 2 : 1));
    for (int i = 0; i <= is_mixed; i++)
        set_values(engine, groups[i].program, groups[i].first, groups[i].count);
    for (size_t i = 0; i < objects; i++) {
        lives[i] = random_life();
        EXPECT(!fp3_engine_live(engine, i, 1, lives[i].born, lives[i].gone));
    }
    for (uint64_t made = 0; made < STEPS;) {
        fp3_stats stats;
        const uint32_t steps = below(STEPS + 1 - (uint32_t)made);
        uint64_t now = 0;
        EXPECT(!fp3_engine_run(engine, steps, &stats));
        made += steps;
        for (int i = 0; i <= is_mixed; i++)
            now += check(engine, &groups[i], lives, made);
        EXPECT(stats.object_steps == now - before);
        before = now;
    }
    fp3_engine_close(&engine);
}

/* ---- ends ---- */

static void expect_refusals(void) {
    fp3_engine *engine = open_engine("isa", "many_full", 3, 0);
    fp3_stats stats;
    EXPECT(fp3_engine_live(engine, 0, 1, 0, 1) == FP3_E_ARGUMENT &&
           strstr(error.text, "no program"));
    EXPECT(!fp3_engine_load(engine, programs[0]->image));
    set_values(engine, 0, 0, 3);
    EXPECT(fp3_engine_live(engine, 0, 4, 0, 1) == FP3_E_ARGUMENT);
    EXPECT(fp3_engine_live(engine, 0, 1, 7, 7) == FP3_E_ARGUMENT &&
           strstr(error.text, "after step 7"));
    EXPECT(fp3_engine_live(engine, 0, 1, 0, 0) == FP3_E_ARGUMENT);
    /* Nobody lives: no steps, no cycles, and the clock goes on. */
    EXPECT(!fp3_engine_live(engine, 0, 3, 1ull << 32, FP3_FOREVER));
    EXPECT(!fp3_engine_run(engine, UINT32_MAX, &stats));
    EXPECT(!stats.object_steps && !stats.counter[FP3_COUNTER_CYCLES]);
    EXPECT(!fp3_engine_run(engine, 1, &stats) && !stats.object_steps);
    EXPECT(!fp3_engine_run(engine, 1, &stats) && stats.object_steps == 3);
    EXPECT(states_of(engine, 0, 2).v == alone[0][2][1].v);
    /* A load forgets. */
    EXPECT(!fp3_engine_load(engine, programs[0]->image) && fp3_engine_life(engine, 0) == FP3_ALIVE);
    fp3_engine_close(&engine);
    engine = open_engine("isa", "lanes", 8, 0);
    EXPECT(!fp3_engine_load(engine, programs[0]->image));
    EXPECT(fp3_engine_live(engine, 0, 1, 1, 2) == FP3_E_PROGRAM && strstr(error.text, "no sleep"));
    fp3_engine_close(&engine);
}

int main(int argc, char **argv) {
    static const char *const engines[] = {"isa", "fast", "rtl"}, *const names[] = {"ship.s",
                                                                                   "ship_sleep.s"};
    EXPECT(argc == 3);
    chance = strtoull(argv[1], NULL, 0);
    for (int i = 0; i < 2; i++) {
        char path[4096];
        const fp3_program_def def = fp3_program_default();
        snprintf(path, sizeof path, "%s/%s", argv[2], names[i]);
        EXPECT(!fp3_program_open(path, &def, &programs[i], NULL, &error));
        live_alone(i);
    }
    expect_refusals();
    for (size_t c = 0; c < sizeof configs / sizeof *configs; c++)
        for (size_t e = 0; e < sizeof engines / sizeof *engines; e++)
            for (int i = 0; i < (e < 2 ? 6 : 2); i++)
                try_scene(engines[e], configs[c]);
    for (int i = 0; i < 2; i++)
        fp3_program_close(&programs[i]);
    printf("lives: seed %s good\n", argv[1]);
    return 0;
}
