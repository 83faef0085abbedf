/* mix.c - groups of objects with programs of their own, in one engine.
 *
 *     mix [SEED [ROUNDS]]
 *
 * Three things. Placing: random problems, against every division of the schedulers that there is.
 * Bits: every configuration of several schedulers runs random programs for random groups; every
 * retirement, register, constant and status must be that of the isa engine with the same groups,
 * and that of an isa engine which has one group alone; then other groups are loaded into the same
 * engines. Cycles: what the schedulers need is what was predicted, and no other division would have
 * ended earlier.
 */
#include "engine/common/inside.h"
#include "stream.h"

#include <fp3/image.h>
#include <inttypes.h>
#include <stdlib.h>

enum { GROUPS_MAX = 8, SCHEDULERS_MAX = 64 };

static unsigned failed;

#define FAIL(...)                                                                                  \
    do {                                                                                           \
        if (failed++ < 10) {                                                                       \
            printf("FAIL line %d: ", __LINE__);                                                    \
            printf(__VA_ARGS__);                                                                   \
            putchar('\n');                                                                         \
        }                                                                                          \
    } while (0)
#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition))                                                                          \
            FAIL("%s", #condition);                                                                \
    } while (0)

static void die(const char *why) {
    printf("FAIL: %s\n", why);
    exit(1);
}

/* ---- placing ---- */

typedef struct {
    const fp3_config *config;
    uint32_t visit;
    const fp3_to_place *groups;
    size_t count;
} problem;

static uint64_t end_of(const problem *p, size_t group, uint32_t schedulers) {
    const fp3_to_place *g = &p->groups[group];
    return fp3_placement_cycles(p->config, g->program, p->visit,
                                fp3_placement_fullest(p->config, g->objects, schedulers));
}

/* The earliest end of groups from .. with so many schedulers; UINT64_MAX: they do not fit. */
static uint64_t best_end(const problem *p, size_t from, uint32_t schedulers) {
    uint64_t best = UINT64_MAX;
    if (from == p->count)
        return 0;
    const uint32_t rows = fp3_placement_rows(p->config, p->groups[from].log2);
    for (uint32_t n = 1; n <= schedulers; n++) {
        uint64_t end = best_end(p, from + 1, schedulers - n);
        const uint64_t own = end_of(p, from, n);
        if (fp3_placement_fullest(p->config, p->groups[from].objects, n) > rows)
            continue;
        end = own > end ? own : end;
        best = end < best ? end : best;
    }
    return best;
}

static uint64_t end_of_placing(const problem *p, const uint32_t *group_of) {
    const uint32_t schedulers = fp3_config_schedulers(p->config);
    uint64_t end = 0;
    for (size_t i = 0; i < p->count; i++) {
        uint32_t n = 0;
        for (uint32_t scheduler = 0; scheduler < schedulers; scheduler++)
            n += group_of[scheduler] == i;
        if (n == 0)
            return UINT64_MAX;
        const uint64_t own = end_of(p, i, n);
        end = own > end ? own : end;
    }
    return end;
}

static void check_placing(chance *c) {
    fp3_config config = {.name = "random", .interleave = 1};
    config.tiles = 1 + below(c, 7);
    config.schedulers = below(c, 3) ? 1 : 1 + below(c, 3);
    config.lanes = 1 + below(c, 3);
    config.contexts = 1 + below(c, 40);
    config.registers = 32;
    config.store_words = 64u << below(c, 6);
    config.add_latency = 1 + below(c, 8);
    config.mul_latency = 2 + below(c, 8);
    uint32_t group_of[SCHEDULERS_MAX];
    fp3_decoded code[20] = {0};
    for (size_t i = 0; i < 20; i++)
        code[i].of = fp3_operation_find(below(c, 2) ? FP3_OP_MUL : FP3_OP_ADD);
    fp3_code programs[GROUPS_MAX];
    fp3_to_place groups[GROUPS_MAX];
    const problem p = {&config, below(c, 3), groups, 1 + below(c, 4)};
    for (size_t i = 0; i < p.count; i++) {
        const uint32_t size = 1 + below(c, 20), step = below(c, size);
        programs[i] = (fp3_code){NULL, code, size, step, step + 1 + below(c, size - step), 0, -1};
        groups[i] =
            (fp3_to_place){&programs[i], 1 + below(c, below(c, 2) ? 400 : 20), 3 + below(c, 3)};
    }
    fp3_error error;
    const uint64_t best = best_end(&p, 0, fp3_config_schedulers(&config));
    const fp3_status status =
        fp3_placement_make(&config, p.visit, groups, p.count, group_of, &error);
    EXPECT(status == (best == UINT64_MAX ? FP3_E_PROGRAM : FP3_OK));
    if (!status && end_of_placing(&p, group_of) != best)
        FAIL("%zu groups on %" PRIu32 " schedulers end at %" PRIu64 ", not %" PRIu64, p.count,
             fp3_config_schedulers(&config), end_of_placing(&p, group_of), best);
}

/* A tile's two schedulers get one program that multiplies and one that adds. */
static void unlike_programs_share(void) {
    const fp3_decoded mul = {.of = fp3_operation_find(FP3_OP_MUL)};
    const fp3_decoded add = {.of = fp3_operation_find(FP3_OP_ADD)};
    const fp3_decoded muls[] = {mul, mul, mul, mul}, adds[] = {add, add, add, add};
    const fp3_code multiplies = {NULL, muls, 4, 0, 4, 0, -1}, sums = {NULL, adds, 4, 0, 4, 0, -1};
    const fp3_config config = {.name = "random",
                               .interleave = 1,
                               .tiles = 2,
                               .schedulers = 2,
                               .lanes = 1,
                               .contexts = 24,
                               .store_words = 1024,
                               .add_latency = 8,
                               .mul_latency = 8};
    const fp3_to_place groups[] = {{&multiplies, 96, 3}, {&sums, 96, 3}};
    uint32_t group_of[4];
    EXPECT(!fp3_placement_make(&config, 0, groups, 2, group_of, NULL));
    EXPECT(group_of[0] != group_of[1] && group_of[2] != group_of[3]);
}

/* ---- bits ---- */

/* What retired, for each register of each object: how often, and a hash in the order of its writes.
 */
typedef struct {
    uint64_t *hash;
} journal;

static void note(void *user, const fp3_retirement *r) {
    uint64_t *hash = &((journal *)user)->hash[(size_t)r->object * REGISTERS_MAX + r->reg];
    *hash = (*hash ^ (r->bits + ((uint64_t)r->flags << 32) + 1)) * 0x100000001b3u;
}

static void begin(journal *j, size_t objects) {
    free(j->hash);
    j->hash = calloc(objects * REGISTERS_MAX, sizeof *j->hash);
    if (!j->hash)
        die("out of memory");
}

typedef struct {
    fp3_engine *engine;
    journal j;
    fp3_error error;
    fp3_stats stats;
} machine;

/* Both engines with all groups, and for each group an isa engine with that one alone. */
enum { RTL, ISA, ALONE };
typedef struct {
    const fp3_config *config;
    chance c;
    machine m[ALONE + GROUPS_MAX];
    size_t count;
    uint32_t objects, words, visit;
    uint32_t first[GROUPS_MAX], sizes[GROUPS_MAX];
    stream s[GROUPS_MAX];
    fp3_image *images[GROUPS_MAX];
    size_t broken; /* the group whose program has an illegal word; count: none */
} bench;

static uint32_t groups_most(const fp3_config *config) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    return schedulers < GROUPS_MAX ? schedulers : GROUPS_MAX;
}

static void open_machine(bench *b, machine *m, const char *engine, uint32_t objects) {
    fp3_engine_def def = fp3_engine_default();
    def.engine = engine;
    def.config = b->config->name;
    def.objects = objects;
    def.visit = b->visit;
    def.retire = note;
    def.retire_user = &m->j;
    def.error = &m->error;
    begin(&m->j, objects);
    if (fp3_engine_open(&def, &m->engine))
        die(m->error.text);
}

static void close_machine(machine *m) {
    fp3_engine_close(&m->engine);
    free(m->j.hash);
    m->j.hash = NULL;
}

/* Objects for so many groups, as many in all as there are; every group has room in one scheduler.
 */
static void share_out(bench *b) {
    const uint32_t most = (b->config->store_words / b->words) * b->config->lanes;
    uint32_t left = b->objects;
    for (size_t i = 0; i < b->count; i++) {
        const uint32_t others = (uint32_t)(b->count - i - 1);
        const uint32_t least = left > others * most ? left - others * most : 1;
        const uint32_t room = left - others < most ? left - others : most;
        b->sizes[i] = i + 1 == b->count ? left : least + below(&b->c, room - least + 1);
        b->first[i] = i ? b->first[i - 1] + b->sizes[i - 1] : 0;
        left -= b->sizes[i];
    }
}

static void make_programs(bench *b) {
    b->broken = below(&b->c, 4) ? b->count : below(&b->c, (uint32_t)b->count);
    for (size_t i = 0; i < b->count; i++) {
        do
            make_stream(&b->c, &b->s[i], b->config, b->words);
        while (b->s[i].illegal != NOWHERE || (i == b->broken && b->s[i].sleeps));
        if (i == b->broken)
            b->s[i].code[below(&b->c, b->s[i].count)] = UINT32_MAX;
        const fp3_image draft = stream_image(&b->s[i]);
        if (fp3_image_make(&draft, &b->images[i], &b->m[RTL].error))
            die(b->m[RTL].error.text);
    }
}

static void load_all(bench *b) {
    fp3_group groups[GROUPS_MAX];
    for (size_t i = 0; i < b->count; i++)
        groups[i] = (fp3_group){.image = b->images[i], .objects = b->sizes[i]};
    for (int k = 0; k < ALONE; k++)
        if (fp3_engine_load_groups(b->m[k].engine, groups, b->count))
            die(b->m[k].error.text);
    for (size_t i = 0; i < b->count; i++) {
        open_machine(b, &b->m[ALONE + i], "isa", b->sizes[i]);
        if (fp3_engine_load(b->m[ALONE + i].engine, b->images[i]))
            die(b->m[ALONE + i].error.text);
    }
    /* As after a first run: before any step, a sleep in the first part would write 0, for awake. */
    for (size_t k = 0; k < ALONE + b->count; k++)
        *fp3_engine_clock(b->m[k].engine) = 1;
}

static void write_one(bench *b, size_t group, uint32_t object, uint32_t reg, uint32_t bits) {
    for (int k = 0; k < ALONE; k++)
        EXPECT(!fp3_engine_write_words(b->m[k].engine, b->first[group] + object, 1, reg, &bits));
    EXPECT(!fp3_engine_write_words(b->m[ALONE + group].engine, object, 1, reg, &bits));
}

/* From the machines with all groups to the one with this group alone. */
static void copy_group(bench *b, size_t group) {
    fp3_engine *alone = b->m[ALONE + group].engine;
    for (uint32_t object = 0; object < b->sizes[group]; object++)
        for (uint32_t reg = 0; reg < b->words && reg < b->config->registers; reg++) {
            uint32_t word[2];
            for (int k = 0; k < ALONE; k++)
                EXPECT(!fp3_engine_read_words(b->m[k].engine, b->first[group] + object, 1, reg,
                                              &word[k]));
            if (word[RTL] != word[ISA])
                FAIL("after a load: object %" PRIu32 " r%" PRIu32, b->first[group] + object, reg);
            EXPECT(!fp3_engine_write_words(alone, object, 1, reg, &word[ISA]));
        }
    for (uint32_t i = 0; i < b->config->registers; i++) {
        uint32_t word[2];
        for (int k = 0; k < ALONE; k++)
            EXPECT(!fp3_engine_read_shared_words(b->m[k].engine, group, i, 1, &word[k]));
        if (word[RTL] != word[ISA])
            FAIL("after a load: group %zu k%" PRIu32, group, i);
        EXPECT(!fp3_engine_write_shared_words(alone, 0, i, 1, &word[ISA]));
    }
}

static void write_values(bench *b, size_t group) {
    for (uint32_t i = 0; i < b->config->registers; i++) {
        const uint32_t bits = value(&b->c);
        for (int k = 0; k < ALONE; k++)
            EXPECT(!fp3_engine_write_shared_words(b->m[k].engine, group, i, 1, &bits));
        EXPECT(!fp3_engine_write_shared_words(b->m[ALONE + group].engine, 0, i, 1, &bits));
    }
    for (uint32_t object = 0; object < b->sizes[group]; object++)
        for (uint32_t reg = 0; reg < b->s[group].pool; reg++)
            if ((int)reg != b->s[group].slept)
                write_one(b, group, object, reg, value(&b->c));
}

static int has_sleep(const bench *b, size_t group) {
    return fp3_engine_layout(b->m[ISA].engine)->groups[group].program.slept >= 0;
}

/* Nobody sleeps because of what a register held before. */
static void wake_all(bench *b, size_t group) {
    if (!has_sleep(b, group))
        return;
    for (int k = 0; k < ALONE; k++)
        EXPECT(!fp3_engine_wake(b->m[k].engine, b->first[group], b->sizes[group]));
    EXPECT(!fp3_engine_wake(b->m[ALONE + group].engine, 0, b->sizes[group]));
}

static void remove_some(bench *b, size_t group) {
    if (!has_sleep(b, group) || below(&b->c, 2))
        return;
    const uint32_t first = below(&b->c, b->sizes[group]);
    const uint32_t count = 1 + below(&b->c, b->sizes[group] - first);
    for (int k = 0; k < ALONE; k++)
        EXPECT(!fp3_engine_remove(b->m[k].engine, b->first[group] + first, count));
    EXPECT(!fp3_engine_remove(b->m[ALONE + group].engine, first, count));
}

/* got: of all groups; expected: of the same with an offset of 0, or of one group alone. */
static void compare(bench *b, machine *got, machine *expected, size_t group, uint32_t offset) {
    const uint32_t first = b->first[group];
    for (uint32_t n = 0; n < b->sizes[group]; n++) {
        fp3_object_status s[2];
        EXPECT(!fp3_engine_status(got->engine, first + n, 1, &s[0]));
        EXPECT(!fp3_engine_status(expected->engine, offset + n, 1, &s[1]));
        if (memcmp(&s[0], &s[1], sizeof s[0]) != 0)
            FAIL("group %zu, object %" PRIu32 ": status", group, first + n);
        for (uint32_t reg = 0; reg < b->s[group].pool; reg++) {
            uint32_t word[2];
            EXPECT(!fp3_engine_read_words(got->engine, first + n, 1, reg, &word[0]));
            EXPECT(!fp3_engine_read_words(expected->engine, offset + n, 1, reg, &word[1]));
            if (word[0] != word[1])
                FAIL("group %zu, object %" PRIu32 " r%" PRIu32 ": 0x%08" PRIx32
                     ", not 0x%08" PRIx32,
                     group, first + n, reg, word[0], word[1]);
        }
        for (uint32_t reg = 0; reg < REGISTERS_MAX; reg++)
            if (got->j.hash[(size_t)(first + n) * REGISTERS_MAX + reg] !=
                expected->j.hash[(size_t)(offset + n) * REGISTERS_MAX + reg])
                FAIL("group %zu, object %" PRIu32 " r%" PRIu32 ": other retirements", group,
                     first + n, reg);
    }
}

static void compare_run(bench *b, const fp3_status *status) {
    const int is_broken = b->broken < b->count;
    uint64_t object_steps = 0;
    uint32_t flags = 0;
    char text[32];
    snprintf(text, sizeof text, b->count > 1 ? "group %zu: word" : "word", b->broken);
    for (int k = 0; k < ALONE; k++) {
        EXPECT(status[k] == FP3_OK || (is_broken && status[k] == FP3_E_PROGRAM));
        EXPECT(!status[k] || strncmp(b->m[k].error.text, text, strlen(text)) == 0);
    }
    for (size_t i = 0; i < b->count; i++) {
        const uint64_t steps = b->m[ALONE + i].stats.object_steps;
        if (i != b->broken) {
            compare(b, &b->m[RTL], &b->m[ISA], i, b->first[i]);
            compare(b, &b->m[RTL], &b->m[ALONE + i], i, 0);
        }
        flags |= b->m[ALONE + i].stats.flags;
        object_steps += steps;
        EXPECT(status[RTL] || fp3_engine_group_steps(b->m[RTL].engine, i) == steps);
    }
    EXPECT(status[RTL] == status[ISA]);
    if (status[RTL])
        object_steps = 0;
    for (int k = 0; k < ALONE; k++) {
        EXPECT(b->m[k].stats.object_steps == object_steps);
        EXPECT(status[k] || b->m[k].stats.flags == flags);
    }
}

static void run_all(bench *b) {
    const uint64_t steps = 1 + below(&b->c, 6);
    fp3_status status[ALONE + GROUPS_MAX];
    for (size_t k = 0; k < ALONE + b->count; k++) {
        begin(&b->m[k].j, fp3_engine_objects(b->m[k].engine));
        status[k] = fp3_engine_run(b->m[k].engine, steps, &b->m[k].stats);
    }
    compare_run(b, status);
}

/* One set of groups, loaded into engines that may hold something. */
static void check_groups(bench *b) {
    b->count = 1 + below(&b->c, groups_most(b->config));
    while (b->objects < b->count ||
           b->objects > b->count * (b->config->store_words / b->words) * b->config->lanes)
        b->count = b->objects < b->count ? b->count - 1 : b->count + 1;
    share_out(b);
    make_programs(b);
    load_all(b);
    for (size_t i = 0; i < b->count; i++) {
        copy_group(b, i);
        wake_all(b, i);
        if (below(&b->c, 3))
            write_values(b, i);
        for (int k = 0; k < ALONE && b->config->status; k++)
            EXPECT(!fp3_engine_clear_status(b->m[k].engine, b->first[i], b->sizes[i]));
    }
    for (uint32_t runs = 1 + below(&b->c, 3); runs > 0 && !failed; runs--) {
        run_all(b);
        if (b->broken < b->count)
            break; /* how far it came is nobody's to say */
        for (size_t i = 0; i < b->count; i++)
            remove_some(b, i);
    }
    for (size_t i = 0; i < b->count; i++) {
        fp3_image_free(&b->images[i]);
        close_machine(&b->m[ALONE + i]);
    }
}

static void check_bits(const fp3_config *config, uint64_t seed) {
    static bench b;
    const uint32_t full = fp3_config_schedulers(config) * config->lanes;
    b = (bench){.config = config, .c = {.state = seed}};
    do
        b.words = 8u << below(&b.c, 3);
    while (b.words > config->store_words || (b.words > 8 && b.words > config->registers));
    const uint32_t room = config->store_words / b.words * config->lanes * groups_most(config);
    const uint32_t most = below(&b.c, 2) ? 3 * full : 2 * config->contexts * full;
    b.objects = 1 + below(&b.c, most < room ? most : room);
    open_machine(&b, &b.m[RTL], "rtl", b.objects);
    open_machine(&b, &b.m[ISA], "isa", b.objects);
    for (int loads = 0; loads < 3 && !failed; loads++) {
        check_groups(&b);
        if (b.broken < b.count)
            break;
    }
    close_machine(&b.m[RTL]);
    close_machine(&b.m[ISA]);
    if (failed)
        printf("  %s, seed %" PRIu64 "\n", config->name, seed);
}

/* ---- cycles ---- */

static fp3_image *assemble(const char *source) {
    fp3_assembly *assembly = NULL;
    fp3_error error = {.text = ""};
    if (fp3_assemble(source, strlen(source), "mix", &assembly, &error))
        die(error.text);
    fp3_image *image = assembly->image;
    assembly->image = NULL;
    fp3_assembly_free(&assembly);
    return image;
}

/* So many instructions a step, sums and products in registers of their own. */
static fp3_image *work(uint32_t size) {
    char source[4096] = ".state x = r0\n.param y = r1\n.temp z = r3\nstep:\n";
    for (uint32_t i = 0; i < size; i++)
        strcat(source, i % 2 ? "mul z, x, y\n" : "add x, x, y\n");
    return assemble(source);
}

/* Of a run of steps, by visits. */
static uint64_t predicted(fp3_engine *engine, size_t group, uint32_t rows, uint32_t steps) {
    const fp3_code *program = &fp3_engine_layout(engine)->groups[group].program;
    const uint32_t of = fp3_engine_definition(engine)->visit, visit = of ? of : steps;
    uint64_t sum = 0;
    for (uint32_t made = 0; made < steps; made += visit)
        sum += fp3_placement_cycles(fp3_engine_config(engine), program,
                                    steps - made < visit ? steps - made : visit, rows);
    return sum;
}

static uint64_t apart(uint64_t a, uint64_t b) { return a > b ? a - b : b - a; }

/* Each scheduler ends when it was said to, within 1 %, and the last of them no later than that of
 * the best division. */
static void check_cycles(const fp3_config *config, chance *c, double *worst) {
    enum { STEPS = 24 };
    const size_t count = 1 + below(c, groups_most(config));
    fp3_error error;
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    fp3_stats stats;
    fp3_group groups[GROUPS_MAX];
    fp3_image *images[GROUPS_MAX];
    def.config = config->name;
    def.visit = below(c, 2) ? STEPS / 3 : 0;
    def.error = &error;
    for (size_t i = 0; i < count; i++) {
        images[i] = work(10 + below(c, 40));
        groups[i] =
            (fp3_group){.image = images[i], .objects = 1 + below(c, config->store_words / 8)};
        def.objects += (uint32_t)groups[i].objects;
    }
    if (fp3_engine_open(&def, &engine) || fp3_engine_load_groups(engine, groups, count) ||
        fp3_engine_run(engine, STEPS, &stats))
        die(error.text);
    fp3_to_place list[GROUPS_MAX];
    const fp3_layout *layout = fp3_engine_layout(engine);
    const problem p = {config, def.visit ? def.visit : STEPS, list, count};
    for (size_t i = 0; i < count; i++)
        list[i] = (fp3_to_place){&layout->groups[i].program, (uint32_t)groups[i].objects, 3};
    for (uint32_t scheduler = 0; scheduler < stats.schedulers; scheduler++) {
        const uint32_t group = layout->duty[scheduler].group;
        uint64_t counter[FP3_COUNTER_COUNT];
        EXPECT(!fp3_engine_scheduler_counters(engine, scheduler, counter));
        const uint64_t cycles = counter[FP3_COUNTER_CYCLES];
        const uint32_t rows = fp3_layout_rows(layout, config, scheduler, 0);
        const uint64_t said = predicted(engine, group, rows, STEPS);
        const double off = rows ? (double)apart(cycles, said) / (double)cycles : 0;
        *worst = off > *worst ? off : *worst;
        if (off > 0.01)
            FAIL("%s, scheduler %" PRIu32 ": %" PRIu64 " cycles, %" PRIu64 " were predicted",
                 config->name, scheduler, cycles, said);
    }
    const uint64_t visits = def.visit ? 3 : 1;
    const double best = (double)(best_end(&p, 0, fp3_config_schedulers(config)) * visits);
    if ((double)stats.counter[FP3_COUNTER_CYCLES] > 1.01 * best)
        FAIL("%s: %" PRIu64 " cycles, the best division has %.0f", config->name,
             stats.counter[FP3_COUNTER_CYCLES], best);
    fp3_engine_close(&engine);
    for (size_t i = 0; i < count; i++)
        fp3_image_free(&images[i]);
}

/* ---- promises ---- */

#define SAYS(word) (strstr(error.text, word) != NULL)

static void promises(const char *engine) {
    fp3_error error = {.text = ""};
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *e = NULL;
    fp3_stats stats;
    float x = 0;
    def.engine = engine;
    def.config = "array";
    def.objects = 10;
    def.error = &error;
    fp3_image *one = assemble(".state x\n.shared h\nstep:\nadd x, x, h\n");
    fp3_image *two = assemble(".state y x slept\n.shared g h\nstep:\nadd y, y, g\nadd x, x, h\n"
                              "sleep slept, x, 0.5\n");
    EXPECT(!fp3_engine_open(&def, &e) && fp3_engine_groups(e) == 1);
#define GROUP(image_, objects_)                                                                    \
    { .image = (image_), .objects = (objects_) }
    const fp3_group good[] = {GROUP(one, 4), GROUP(two, 6)}, few[] = {GROUP(one, 4), GROUP(two, 5)},
                    many[] = {GROUP(one, 4), GROUP(two, 7)},
                    none[] = {GROUP(one, 10), GROUP(two, 0)},
                    five[] = {GROUP(one, 2), GROUP(two, 2), GROUP(one, 2), GROUP(two, 2),
                              GROUP(one, 2)};
    EXPECT(fp3_engine_load_groups(e, good, 0) == FP3_E_ARGUMENT && SAYS("no group"));
    EXPECT(fp3_engine_load_groups(e, few, 2) == FP3_E_ARGUMENT && SAYS("9 objects") && SAYS("10"));
    EXPECT(fp3_engine_load_groups(e, many, 2) == FP3_E_ARGUMENT && SAYS("more objects"));
    EXPECT(fp3_engine_load_groups(e, none, 2) == FP3_E_ARGUMENT && SAYS("group 1 has no objects"));
    EXPECT(fp3_engine_load_groups(e, five, 5) == FP3_E_PROGRAM && SAYS("5 groups") &&
           SAYS("'array' has 4 schedulers"));
    EXPECT(fp3_engine_run(e, 1, NULL) == FP3_E_ARGUMENT && SAYS("no program"));
    EXPECT(!fp3_engine_load_groups(e, good, 2) && fp3_engine_groups(e) == 2);
    /* h is in both, g in one; each group has its own. */
    EXPECT(!fp3_engine_set(e, "h", 2) && !fp3_engine_set(e, "g", 3));
    EXPECT(fp3_engine_set(e, "f", 1) == FP3_E_ARGUMENT && SAYS("'f'"));
    EXPECT(!fp3_engine_get(e, 0, "h", &x) && x == 2 && !fp3_engine_get(e, 9, "h", &x) && x == 2);
    EXPECT(fp3_engine_get(e, 3, "g", &x) == FP3_E_ARGUMENT);
    EXPECT(!fp3_engine_get(e, 4, "g", &x) && x == 3);
    x = 5;
    EXPECT(fp3_engine_write_shared_of(e, 2, 0, 1, &x) == FP3_E_ARGUMENT && SAYS("group 2"));
    EXPECT(!fp3_engine_write_shared_of(e, 0, 0, 1, &x));
    /* One of the first group is asked to wake, which cannot sleep: nobody is woken. */
    EXPECT(!fp3_engine_remove(e, 4, 6) && fp3_engine_wake(e, 3, 2) == FP3_E_PROGRAM);
    EXPECT(SAYS("object 3"));
    EXPECT(!fp3_engine_wake(e, 9, 1) && !fp3_engine_run(e, 7, &stats));
    EXPECT(fp3_engine_group_steps(e, 0) == 28 && fp3_engine_group_steps(e, 1) == 7);
    EXPECT(fp3_engine_group_steps(e, 2) == 0 && stats.object_steps == 35);
    EXPECT(!fp3_engine_get(e, 0, "x", &x) && x == 35 && !fp3_engine_get(e, 9, "x", &x) && x == 14);
    EXPECT(!fp3_engine_get(e, 8, "x", &x) && x == 0 && !fp3_engine_get(e, 9, "y", &x) && x == 21);
    /* Objects keep their registers in another division: r0 of 9 was y. */
    EXPECT(!fp3_engine_load(e, one) && !fp3_engine_get(e, 9, "x", &x) && x == 21);
    EXPECT(!fp3_engine_get(e, 0, "x", &x) && x == 35 && !fp3_engine_get(e, 0, "h", &x) && x == 5);
    fp3_engine_close(&e);
    def.config = "single";
    def.objects = 0;
    EXPECT(!fp3_engine_open(&def, &e) &&
           !fp3_engine_load_groups(e, &(fp3_group){.image = one, .objects = 1}, 1));
    EXPECT(fp3_engine_load_groups(e, good, 2) == FP3_E_PROGRAM);
    fp3_engine_close(&e);
    fp3_image_free(&one);
    fp3_image_free(&two);
}

int main(int argc, char **argv) {
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    const uint64_t rounds = argc > 2 ? strtoull(argv[2], NULL, 0) : 15;
    double worst = 0;
    chance c = {.state = seed};
    for (int k = 0; k < 2 && fp3_config_find("array") && fp3_config_find("single"); k++)
        promises(k ? "isa" : "rtl");
    unlike_programs_share();
    for (uint64_t n = 0; n < 400 * rounds; n++)
        check_placing(&c);
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        const fp3_config *config = &fp3_configs[i];
        for (uint64_t n = 0; n < rounds && fp3_config_schedulers(config) > 1 && !failed; n++) {
            check_bits(config, seed + n);
            if (config->schedulers == 1 && config->counters && !failed)
                check_cycles(config, &c, &worst);
        }
    }
    printf("%" PRIu64 " rounds, cycles predicted within %.2f %%, %u failed\n", rounds, 100 * worst,
           failed);
    return failed != 0;
}
