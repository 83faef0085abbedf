/* world_links.c - links and reaches through fp3/batch.h and fp3/program.h: what is promised, what
 * is refused. Prints a line for each promise that is broken.
 *
 *     build/tests/world_links FOLDER      with chain.ode and balls.ode of programs/world
 */
#include <fp3/batch.h>
#include <fp3/program.h>
#include <stdio.h>
#include <string.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition))                                                                          \
            printf("%d: %s: %s\n", __LINE__, #condition, error.text);                              \
    } while (0)

enum { N = 40, STEPS = 50 };

static fp3_error error;
static char chain[4096], balls[4096];
static uint32_t a[N], b[N];
static double k[N];
static float start[N];

static fp3_links line(void) {
    static const char *const names[] = {"k"};
    static const double *const fields[] = {k};
    for (uint32_t i = 0; i + 1 < N; i++) {
        a[i] = i;
        b[i] = i + 1;
        k[i] = 100 + i;
    }
    for (uint32_t i = 0; i < N; i++)
        start[i] = (float)(i * 7919 % 101) / 101;
    return (fp3_links){
        .count = N - 1, .a = a, .b = b, .names = names, .fields = fields, .field_count = 1};
}

static fp3_batch *opened(const char *model, const char *engine) {
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *made = NULL;
    def.model = model;
    def.objects = N;
    def.engine = engine;
    def.integrator = "semi_implicit_euler";
    def.error = &error;
    CHECK(!fp3_batch_open(&def, &made));
    return made;
}

/* What the first masses do that are used, with the forces in the order of the links. */
static void steps_in_c(const fp3_links *links, uint32_t used, int steps, float *u, float *v) {
    const float h = 0.0078125f;
    for (int step = 0; step < steps; step++) { /* symplectic Euler */
        float force[N];
        for (int i = 0; i < N; i++)
            force[i] = -0.0f;
        for (size_t n = 0; n < links->count; n++) {
            const float stretch = u[links->b[n]] - u[links->a[n]];
            const float of = (float)links->fields[0][n], to_a = of * stretch, to_b = of * -stretch;
            if (links->a[n] >= used || links->b[n] >= used)
                continue;
            force[links->a[n]] += to_a;
            force[links->b[n]] += to_b;
        }
        for (uint32_t i = 0; i < used; i++) {
            const float change = h * (1.0f * force[i]);
            v[i] += change;
        }
        for (uint32_t i = 0; i < used; i++) {
            const float change = h * v[i];
            u[i] += change;
        }
    }
}

static void in_plain_c(const fp3_links *links, float *u) {
    float v[N] = {0};
    memcpy(u, start, sizeof start);
    steps_in_c(links, N, STEPS, u, v);
}

static void run_chain(const char *engine) {
    fp3_links links = line();
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *made = NULL;
    float expected[N], u[N] = {0}, again[N] = {0};
    def.model = chain;
    def.objects = N;
    def.engine = engine;
    def.integrator = "semi_implicit_euler";
    def.error = &error;
    in_plain_c(&links, expected);
    CHECK(!fp3_batch_open(&def, &made));
    CHECK(fp3_batch_run(made, 1) == FP3_E_ARGUMENT && strstr(error.text, "no links are given"));
    CHECK(strstr(error.text, "columns a,b,k"));
    CHECK(!fp3_batch_link(made, "springs", &links));
    CHECK(!fp3_batch_write(made, "u", 0, N, start));
    CHECK(!fp3_batch_run(made, 20) && !fp3_batch_run(made, STEPS - 20));
    CHECK(!fp3_batch_read(made, (const char *[]){"u"}, 1, 0, N, (float *[]){u}));
    CHECK(memcmp(u, expected, sizeof u) == 0);
    k[3] = 1; /* the batch has its own copy, which a restart gives the engine again */
    CHECK(!fp3_batch_restart(made) && !fp3_batch_run(made, STEPS));
    CHECK(!fp3_batch_read(made, (const char *[]){"u"}, 1, 0, N, (float *[]){again}));
    CHECK(memcmp(again, expected, sizeof u) == 0);
    CHECK(!fp3_batch_link(made, "springs", &links)); /* others, from now on */
    CHECK(!fp3_batch_restart(made) && !fp3_batch_run(made, STEPS));
    CHECK(!fp3_batch_read(made, (const char *[]){"u"}, 1, 0, N, (float *[]){again}));
    in_plain_c(&links, expected);
    CHECK(memcmp(again, expected, sizeof u) == 0);
    fp3_batch_close(&made);
}

/* Removes the objects from this number on. */
static fp3_status remove_from(fp3_batch *made, size_t first, size_t end) {
    uint64_t handles[N];
    const fp3_status status = fp3_batch_handles(made, first, end - first, handles);
    return status ? status : fp3_batch_remove(made, handles, end - first);
}

/* Nobody sees who is removed. Who gets the number has the defaults, and no links until the host
 * gives some. */
static void come_and_go(const char *engine) {
    fp3_links links = line();
    fp3_batch *made = opened(chain, engine);
    uint64_t handles[N];
    float u[N], v[N] = {0}, found[N] = {0};
    memcpy(u, start, sizeof start);
    CHECK(!fp3_batch_link(made, "springs", &links) && !fp3_batch_write(made, "u", 0, N, start));
    CHECK(!remove_from(made, 25, N) && !fp3_batch_run(made, 7) && !fp3_batch_run(made, 4));
    steps_in_c(&links, 25, 11, u, v);
    CHECK(!fp3_batch_add(made, N - 25, handles) && !fp3_batch_run(made, 2));
    steps_in_c(&links, 25, 2, u, v); /* the others are linked no more: they stay */
    CHECK(!fp3_batch_write_of(made, "u", handles, N - 25, &start[25]));
    memcpy(u + 25, start + 25, (N - 25) * sizeof *u);
    CHECK(!fp3_batch_link(made, "springs", &links) && !fp3_batch_run(made, 5));
    steps_in_c(&links, N, 5, u, v);
    CHECK(!remove_from(made, 30, N) && !fp3_batch_run(made, 3));
    steps_in_c(&links, 30, 3, u, v);
    CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "link 29 joins object 30, which does not live"));
    CHECK(!remove_from(made, 0, 30) && !fp3_batch_living(made) && !fp3_batch_run(made, 3));
    CHECK(!fp3_batch_add(made, N, handles) && !fp3_batch_write(made, "u", 0, N, start));
    CHECK(fp3_batch_add(made, 1, handles) == FP3_E_LIMIT && strstr(error.text, "40 of 40 live"));
    k[20] = 3;
    CHECK(!fp3_batch_link(made, "springs", &links) && !remove_from(made, 12, N));
    CHECK(!fp3_batch_restart(made) && !fp3_batch_run(made, 9));
    memcpy(u, start, sizeof start);
    memset(v, 0, sizeof v);
    steps_in_c(&links, 12, 9, u, v);
    CHECK(!fp3_batch_read(made, (const char *[]){"u"}, 1, 0, 12, (float *[]){found}));
    CHECK(memcmp(u, found, 12 * sizeof *u) == 0);
    fp3_batch_close(&made);
}

static void refuse(void) {
    fp3_batch *made = opened(chain, "fast");
    fp3_links links = line();
    const char *const wrong[] = {"stiff"};
    CHECK(!fp3_batch_link(made, "springs", &links));
    CHECK(fp3_batch_link(made, "spring", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "no relation 'spring'"));
    links.names = wrong;
    CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "no field 'stiff'"));
    links = line();
    b[5] = 5;
    CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "link 5 joins object 5 with 5"));
    b[5] = N;
    CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "two objects of 0 to 39"));
    for (int turn = 0; turn < 2; turn++) { /* the same pair again, either way round */
        links = line();
        a[9] = turn ? b[2] : a[2];
        b[9] = turn ? a[2] : b[2];
        CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
        CHECK(strstr(error.text, "link 9 joins objects") && strstr(error.text, "as link 2 does"));
    }
    uint32_t begin[N + 1] = {0, 400000000}; /* far beyond the entries, before it descends */
    const uint32_t other[2] = {1, 0};
    const float field[2] = {1, 1};
    for (int i = 2; i <= N; i++)
        begin[i] = 2;
    CHECK(fp3_engine_set_neighbours(
              fp3_batch_engine(made), 0, "springs",
              &(fp3_neighbours){.begin = begin, .other = other, .fields = field}) ==
          FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "begin[2] is below begin[1]"));
    links = line();
    k[7] = 1.0f / 0.0f;
    CHECK(fp3_batch_link(made, "springs", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "link 7 has k = inf"));
    CHECK(!fp3_batch_run(made, 1)); /* with the first links */
    fp3_batch_close(&made);
    made = opened(balls, "fast");
    links = line();
    CHECK(fp3_batch_link(made, "touch", &links) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "by itself"));
    fp3_batch_close(&made);
}

/* Balls along a line, 0.09 apart: they touch once their radius has grown, and so they move. */
static void grow(const char *engine, double skin, float x[N]) {
    static const float none[N];
    float at[N];
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *made = NULL;
    for (int i = 0; i < N; i++)
        at[i] = 10 + 0.09f * (float)i;
    def.model = balls;
    def.objects = N;
    def.engine = engine;
    def.integrator = "semi_implicit_euler";
    def.skin = skin;
    def.error = &error;
    CHECK(!fp3_batch_open(&def, &made));
    CHECK(!fp3_batch_set(made, "R", 0.01) && !fp3_batch_set(made, "g_y", 0));
    CHECK(!fp3_batch_set(made, "side", 100) && !fp3_batch_set(made, "x_y", 10));
    CHECK(!fp3_batch_set(made, "x_z", 10) && !fp3_batch_write(made, "x_x", 0, N, at));
    CHECK(!fp3_batch_run(made, 10));
    CHECK(!fp3_batch_read(made, (const char *[]){"v_x"}, 1, 0, N, (float *[]){x}));
    CHECK(memcmp(x, none, sizeof none) == 0);
    CHECK(!fp3_batch_set(made, "R", 0.05));
    CHECK(!fp3_batch_run(made, 100));
    CHECK(!fp3_batch_read(made, (const char *[]){"x_x"}, 1, 0, N, (float *[]){x}));
    CHECK(x[0] < 9.99f && x[N - 1] > 13.52f);
    CHECK(!fp3_batch_set(made, "R", -1)); /* what cannot be is refused by the next step */
    CHECK(fp3_batch_run(made, 1) == FP3_E_ARGUMENT && strstr(error.text, "reach of 'touch' is -2"));
    CHECK(!fp3_batch_set(made, "R", 0.05) && !fp3_batch_run(made, 1));
    fp3_batch_close(&made);
}

static void see_near(void) {
    float first[N], other[N];
    grow("fast", 0, first);
    grow("isa", 0, other);
    CHECK(memcmp(first, other, sizeof first) == 0);
    grow("fast", 2, other);
    CHECK(memcmp(first, other, sizeof first) == 0);
}

/* The same links through fp3/program.h, and to the list of an image that has no model. */
static void run_program(void) {
    fp3_links links = line();
    fp3_params *params = NULL;
    fp3_engine *engine = NULL;
    fp3_program *program = NULL;
    fp3_program_def how = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_program image = {0};
    float first[N], other[N];
    CHECK(!fp3_params_make(&params, &error));
    CHECK(!fp3_program_open(chain, &how, &program, NULL, &error));
    CHECK(program->sees_others && strcmp(program->config, "world") == 0);
    def.engine = "isa";
    def.config = program->config;
    def.objects = N;
    def.error = &error;
    CHECK(!fp3_engine_open(&def, &engine));
    CHECK(!fp3_params_spread(params, "u=0:1", &error));
    CHECK(fp3_program_load(program, params, engine, &error) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "no links are given"));
    CHECK(!fp3_params_link(params, "springs", &links, &error));
    CHECK(!fp3_program_load(program, params, engine, &error));
    CHECK(!fp3_engine_run(engine, STEPS, NULL));
    CHECK(!fp3_engine_read(engine, 0, N,
                           fp3_image_find(program->image, "u", FP3_CLASSES_OBJECT)->index, first));
    image.image = program->image;
    CHECK(!fp3_params_put(params, "v", 0, &error) && !fp3_params_put(params, "w", 1, &error));
    CHECK(!fp3_params_put(params, "h", 0.0078125, &error));
    CHECK(!fp3_program_load(&image, params, engine, &error));
    CHECK(!fp3_engine_run(engine, STEPS, NULL));
    CHECK(!fp3_engine_read(engine, 0, N,
                           fp3_image_find(program->image, "u", FP3_CLASSES_OBJECT)->index, other));
    CHECK(memcmp(first, other, sizeof first) == 0);
    links.field_count = 0;
    CHECK(!fp3_params_link(params, "springs", &links, &error));
    CHECK(fp3_program_load(&image, params, engine, &error) == FP3_E_ARGUMENT);
    CHECK(strstr(error.text, "0 columns of fields, expected 1"));
    fp3_engine_close(&engine);
    fp3_program_close(&program);
    fp3_params_free(&params);
}

/* What the engine refuses is told in the caller's error, wherever the engine tells it. */
static void one_error(void) {
    fp3_error own = {.text = ""}, told;
    fp3_params *params = NULL;
    fp3_program *program = NULL;
    fp3_program_def how = fp3_program_default();
    CHECK(!fp3_params_make(&params, &error));
    CHECK(!fp3_program_open(chain, &how, &program, NULL, &error));
    for (int i = 0; i < 2; i++) {
        fp3_engine *engine = NULL;
        fp3_engine_def def = fp3_engine_default();
        def.engine = "isa";
        def.config = "single";
        def.objects = 1;
        def.error = i ? &own : NULL;
        CHECK(!fp3_engine_open(&def, &engine));
        memset(&told, 'x', sizeof told);
        CHECK(fp3_program_load(program, params, engine, &told));
        CHECK(i ? strcmp(told.text, own.text) == 0 && *own.text
                : strcmp(told.text, "refused by engine isa, whose definition has no error") == 0);
        fp3_engine_close(&engine);
    }
    fp3_program_close(&program);
    fp3_params_free(&params);
}

int main(int argc, char **argv) {
    if (argc != 2)
        return 2;
    snprintf(chain, sizeof chain, "%s/chain.ode", argv[1]);
    snprintf(balls, sizeof balls, "%s/balls.ode", argv[1]);
    run_chain("fast");
    run_chain("isa");
    come_and_go("fast");
    come_and_go("isa");
    come_and_go("rtl");
    refuse();
    see_near();
    one_error();
    run_program();
    return 0;
}
