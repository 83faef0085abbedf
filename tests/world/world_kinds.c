/* world_kinds.c - objects of two groups that see each other have the words of one group that has
 * them all.
 *
 *     world_kinds ENGINE[@CONFIG] STEPS SEED [far|same|lives|turn]      far: an object overflows;
 * same: two at one place; turn: lists of near objects were of the other kind before
 *
 * In the one group a term counts for neighbours of the own half, or of the other (`g`). In the two,
 * either half is a group, and what a term reads of the other half is a param of its program. Links,
 * near objects and all objects, own and other, some of which remember. Prints: objects N + N, words
 * N, differing N.
 */
#include <engine/common/inside.h>
#include <fp3/engine.h>
#include <fp3/program.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OBJECTS 24 /* of the larger half */
#define STATES 4

static fp3_error error;
static uint64_t state;
static uint32_t size[2]; /* of the two halves */
static const char *config = "world";

static uint32_t below(uint32_t count) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % count;
}

static void told(fp3_status status) {
    if (!status)
        return;
    printf("FAIL: %s\n", error.text);
    exit(1);
}

static const char head[] =
    "model half\nparam g = 0\nparam tx[2] = (0, 0)\nparam tg = 0\nparam w = 0\n"
    "state x[2] = (0, 0)\nstate v[2] = (0, 0)\nstep 0.01\nx' = v\n"
    "near touch(x, 0.3, s = 0)\nlinks ties(k = 1, m = 0)\nall others\n"
    "remember o in touch: o.s = o.s + 0.1*o.w\nremember o in ties: o.m = o.m + 0.1*(o.k + norm(o.x "
    "- x))\n";
/* The other half: by g, or by what is known of its words. */
static const char one[] =
    "links ties2(k = 1, m = 0)\n"
    "own = sum(o in ties: (o.k + o.m)*(o.x - x))"
    " + sum(o in touch: o.g == g ? (o.w + o.s)*(x - o.x)/norm(x - o.x) : (-0, -0))"
    " + sum(o in others: o.g == g ? 0.01*(o.x - x) : (-0, -0))\n"
    "v' = own + (sum(o in ties2: (o.k + o.m)*(o.x - x))"
    " + sum(o in touch: o.g != g ? (o.w + o.s)*(x - o.x)/norm(x - o.x) : (-0, -0))"
    " + sum(o in others: o.g != g ? 0.02*(o.x - x) : (-0, -0)))\n"
    "remember o in ties2: o.m = o.m + 0.1*(o.k + norm(o.x - x))\n";
static const char two[] =
    "param tw = 0\nlinks ties2(k = 1, m = 0)\nlinks touch2(s = 0)\nlinks others2\n"
    "own = sum(o in ties: (o.k + o.m)*(o.x - x))"
    " + sum(o in touch: (o.w + o.s)*(x - o.x)/norm(x - o.x))"
    " + sum(o in others: 0.01*(o.x - x))\n"
    "v' = own + (sum(o in ties2: (o.k + o.m)*(o.tx - x))"
    " + sum(o in touch2: dot(o.tx - x, o.tx - x) < 0.3*0.3"
    " ? (o.tw + o.s)*(x - o.tx)/norm(x - o.tx) : (-0, -0))"
    " + sum(o in others2: 0.02*(o.tx - x)))\n"
    "remember o in ties2: o.m = o.m + 0.1*(o.k + norm(o.tx - x))\n"
    "remember o in touch2: o.s = dot(o.tx - x, o.tx - x) < 0.3*0.3 ? o.s + 0.1*o.tw : 0\n";

/* Objects that are born and gone cannot be in pairs that remember. */
static int has_lives;

static void replace(char *text, const char *old, const char *new) {
    for (char *at; (at = strstr(text, old));) {
        memmove(at + strlen(new), at + strlen(old), strlen(at + strlen(old)) + 1);
        memcpy(at, new, strlen(new));
    }
}

static void forget(char *text) {
    for (char *at; (at = strstr(text, "remember"));)
        memmove(at, strchr(at, '\n') + 1, strlen(strchr(at, '\n')));
    replace(text, ", s = 0)", ")");
    replace(text, "o.s)", "0)");
}

/* Lives of the same objects in the one group and in the two. */
static void live(fp3_engine *engine) {
    uint64_t random = state;
    for (uint32_t i = 0; has_lives && i < size[0] + size[1]; i++) {
        const uint64_t born = below(3) ? 0 : below(6), gone = born + 1 + below(9);
        told(fp3_engine_live(engine, i, 1, born, below(3) ? gone : FP3_FOREVER));
    }
    state = random;
}

static fp3_program *compile(const char *text) {
    fp3_program_def def = fp3_program_default();
    fp3_program *program = NULL;
    char *report = NULL, all[4096];
    def.integrator = "semi_implicit_euler";
    def.compile.is_for_host = 0;
    def.compile.config = config;
    snprintf(all, sizeof all, "%s%s", head, text);
    if (has_lives)
        forget(all);
    if (fp3_program_read(all, strlen(all), "half", &def, &program, &report, &error)) {
        printf("FAIL: %s\n", report ? report : error.text);
        exit(1);
    }
    return program;
}

typedef struct {
    uint32_t begin[2 * OBJECTS + 1], other[4 * OBJECTS * OBJECTS];
    float k[8 * OBJECTS * OBJECTS]; /* k and m of each entry */
} links;

static char is_linked[2 * OBJECTS][2 * OBJECTS];

static uint32_t first_of(int half) { return half ? size[0] : 0; }

/* Those of objects first .. first+count-1 with others of another range, which are counted from
 * `base`.
 */
static void list(links *l, uint32_t first, uint32_t count, uint32_t from, uint32_t end,
                 uint32_t base, int is_across) {
    uint32_t n = 0;
    l->begin[0] = 0;
    for (uint32_t i = first; i < first + count; i++) {
        for (uint32_t j = from; j < end; j++)
            if (is_linked[i][j] && ((i < size[0]) != (j < size[0])) == is_across) {
                l->k[2 * n] = (float)(1 + (i + j) % 3);
                l->other[n++] = j - base;
            }
        l->begin[i - first + 1] = n;
    }
}

static void give(fp3_engine *engine, size_t group, const char *name, const links *l, size_t kind) {
    told(fp3_engine_set_neighbours(
        engine, group, name,
        &(fp3_neighbours){.begin = l->begin, .other = l->other, .fields = l->k, .kind = kind}));
}

static fp3_engine *open_engine(const char *name, uint32_t objects) {
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    def.engine = strncmp(name, "fast", 4) == 0 ? "fast" : name;
    def.is_interpreted = strcmp(name, "fast-interpreted") == 0;
    def.threads = 2 * (strcmp(name, "fast") == 0);
    def.config = config;
    def.objects = objects;
    def.error = &error;
    told(fp3_engine_open(&def, &engine));
    return engine;
}

static uint32_t reg(const fp3_program *p, const char *name) {
    return fp3_image_find(p->image, name, FP3_CLASSES_OBJECT)->index;
}

static const char *const states[STATES] = {"x_x", "x_y", "v_x", "v_y"};

static void write_all(fp3_engine *engine, const fp3_program *p, float (*values)[2 * OBJECTS]) {
    const float zeros[2 * OBJECTS] = {0};
    float g[2 * OBJECTS], w[2 * OBJECTS];
    const uint32_t all = size[0] + size[1];
    for (uint32_t i = 0; i < all; i++) {
        g[i] = i >= size[0];
        w[i] = 1 + (float)(i % 5);
    }
    for (int s = 0; s < STATES; s++)
        told(fp3_engine_write(engine, 0, all, reg(p, states[s]), values[s]));
    if (fp3_image_find(p->image, "g", FP3_CLASSES_OBJECT))
        told(fp3_engine_write(engine, 0, all, reg(p, "g"), g));
    told(fp3_engine_write(engine, 0, all, reg(p, "w"), w));
    if (fp3_image_find(p->image, "tw", FP3_CLASSES_OBJECT))
        told(fp3_engine_write(engine, 0, all, reg(p, "tw"), zeros));
    fp3_params *params = NULL;
    float inputs[64];
    int is_spread;
    told(fp3_params_make(&params, &error));
    told(fp3_program_inputs(p, params, 0, inputs, &is_spread, &error));
    for (uint32_t i = 0; i < p->compiled->input_count; i++)
        if (p->compiled->inputs[i].is_shared)
            told(fp3_engine_set(engine, p->compiled->inputs[i].name, inputs[i]));
    fp3_params_free(&params);
}

static void run_one(uint32_t steps, float (*values)[2 * OBJECTS], uint32_t (*words)[2 * OBJECTS],
                    fp3_failure *failure) {
    const uint32_t all = size[0] + size[1];
    fp3_program *p = compile(one);
    fp3_engine *engine = open_engine("isa", all);
    links *l = calloc(1, sizeof *l);
    told(fp3_engine_load(engine, p->image));
    list(l, 0, all, 0, all, 0, 0);
    give(engine, 0, "ties", l, 0);
    list(l, 0, all, 0, all, 0, 1);
    give(engine, 0, "ties2", l, 0);
    told(fp3_engine_set_neighbours(engine, 0, "others", &(fp3_neighbours){.begin = NULL}));
    told(fp3_engine_set_near(
        engine, 0, "touch",
        &(fp3_near){.position = {"x_x", "x_y"}, .dimensions = 2, .reach = 0.3, .skin = 0.1}));
    write_all(engine, p, values);
    live(engine);
    told(fp3_engine_run(engine, steps, NULL));
    for (int s = 0; s < STATES; s++)
        told(fp3_engine_read_words(engine, 0, all, reg(p, states[s]), words[s]));
    told(fp3_engine_failure(engine, 0, all, failure));
    fp3_engine_close(&engine);
    fp3_program_close(&p);
    free(l);
}

static void give_lists(fp3_engine *engine, int is_turned) {
    const uint32_t all = size[0] + size[1];
    links *l = calloc(1, sizeof *l);
    for (int half = 0; half < 2; half++) {
        const size_t group = (size_t)half, kind = (size_t)!half + 1;
        const uint32_t first = first_of(half), other = first_of(!half);
        fp3_near near = {
            .position = {"x_x", "x_y"}, .dimensions = 2, .reach = 0.3, .skin = 0.05 * half};
        list(l, first, size[half], first, first + size[half], first, 0);
        give(engine, group, "ties", l, 0);
        list(l, first, size[half], 0, all, other, 1);
        give(engine, group, "ties2", l, kind);
        told(fp3_engine_set_neighbours(engine, group, "others", &(fp3_neighbours){.begin = NULL}));
        told(fp3_engine_set_neighbours(engine, group, "others2", &(fp3_neighbours){.kind = kind}));
        told(fp3_engine_set_near(engine, group, is_turned ? "touch2" : "touch", &near));
        near.kind = kind;
        near.theirs[0] = "tx_x";
        near.theirs[1] = "w"; /* an own word */
        told(fp3_engine_set_near(engine, group, "touch2", &near) == FP3_E_ARGUMENT ? FP3_OK
                                                                                   : FP3_E_SYSTEM);
        near.theirs[1] = "tx_y";
        told(fp3_engine_set_near(engine, group, is_turned ? "touch" : "touch2", &near));
    }
    free(l);
}

static void join(fp3_engine *engine, const fp3_program *p) {
    const fp3_foreign words[2][3] = {{{"tx_x", 1, "x_x"}, {"tx_y", 1, "x_y"}, {"tw", 1, "w"}},
                                     {{"tx_x", 0, "x_x"}, {"tx_y", 0, "x_y"}, {"tw", 0, "w"}}};
    const fp3_group groups[] = {
        {.image = p->image, .objects = size[0], .foreign = words[0], .foreign_count = 3},
        {.image = p->image, .objects = size[1], .foreign = words[1], .foreign_count = 3}};
    told(fp3_engine_load_groups(engine, groups, 2));
    give_lists(engine, 0);
}

int main(int argc, char **argv) {
    static float values[STATES][2 * OBJECTS], zeros[2 * OBJECTS];
    static uint32_t expected[STATES][2 * OBJECTS], found[STATES][2 * OBJECTS];
    uint32_t differing = 0, steps = argc > 2 ? (uint32_t)atoi(argv[2]) : 1;
    char *at = argc > 1 ? strchr(argv[1], '@') : NULL;
    if (at) {
        *at = '\0';
        config = at + 1;
    }
    has_lives = argc > 4 && strcmp(argv[4], "lives") == 0;
    state = argc > 3 ? (uint64_t)atoi(argv[3]) : 1;
    size[0] = 1 + below(OBJECTS);
    size[1] = 1 + below(OBJECTS);
    const uint32_t all = size[0] + size[1];
    for (uint32_t i = 0; i < all; i++)
        for (uint32_t j = 0; j < i; j++)
            is_linked[i][j] = is_linked[j][i] = below(6) == 0;
    for (uint32_t i = 0; i < all; i++)
        for (int s = 0; s < STATES; s++)
            values[s][i] = (float)below(1000) / 800;
    if (argc > 4 && strcmp(argv[4], "turn") != 0 && !has_lives)
        values[0][size[0]] = strcmp(argv[4], "far") == 0 ? 3e38f : values[0][0];
    if (argc > 4 && strcmp(argv[4], "same") == 0)
        values[1][size[0]] = values[1][0];
    fp3_failure one_failed, two_failed;
    run_one(steps, values, expected, &one_failed);
    fp3_program *p = compile(two);
    fp3_engine *engine = open_engine(argv[1], all);
    join(engine, p);
    if (argc > 4 && strcmp(argv[4], "turn") == 0) { /* what pairs remember then is forgotten */
        give_lists(engine, 1);
        write_all(engine, p, values);
        told(fp3_engine_write(engine, 0, all, reg(p, "tx_x"), values[0])); /* own ones are read */
        told(fp3_engine_write(engine, 0, all, reg(p, "tx_y"), values[1]));
        told(fp3_engine_write(engine, 0, all, reg(p, "tw"), values[0]));
        told(fp3_engine_run(engine, 2, NULL));
        give_lists(engine, 0);
    }
    write_all(engine, p, values);
    live(engine);
    if (argc <= 4 || has_lives) { /* words are brought again in the next run */
        told(fp3_engine_run(engine, steps / 2, NULL));
        told(fp3_engine_write(engine, 0, all, reg(p, "tx_x"), zeros));
        steps -= steps / 2;
    }
    told(fp3_engine_run(engine, steps, NULL));
    for (int s = 0; s < STATES; s++)
        told(fp3_engine_read_words(engine, 0, all, reg(p, states[s]), found[s]));
    for (uint32_t i = 0; i < all; i++)
        for (int s = 0; s < STATES; s++)
            differing += expected[s][i] != found[s][i];
    told(fp3_engine_failure(engine, 0, all, &two_failed));
    if (argc > 4) {
        char text[FP3_FAILURE_TEXT_SIZE];
        fp3_engine_failure_text(engine, &two_failed, text);
        printf("failed %zu and %zu, %s\n", one_failed.failed, two_failed.failed, text);
        differing += one_failed.failed != two_failed.failed ||
                     one_failed.object != two_failed.object || one_failed.step != two_failed.step ||
                     one_failed.flags != two_failed.flags ||
                     one_failed.partner != two_failed.partner;
    }
    printf("objects %u + %u, words %u, differing %u\n", size[0], size[1], STATES * all, differing);
    fp3_engine_close(&engine);
    fp3_program_close(&p);
    return differing != 0;
}
