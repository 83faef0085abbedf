/* speed.c - bench speed: nanoseconds for a step of the ship, by the number of objects and of steps.
 *
 * In a cell, a number of objects and of steps, all who can make them in time take turns; the figure
 * is the median. Everyone must end with the bits of the loop by hand, but GSL, which has double.
 */
#include "speed.h"

#include "commands.h"
#include "lab/measure/measure.h"

#include "base/file.h"
#include "machine/config.h"

#include <argp.h>
#include <fp3/program.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PROGRAM "programs/ship.s"
#define RUNNERS_MOST 32
#define LEAST 65536 /* object-steps in a cell ... */
#define RUNS_MOST 1024
#define WITH_FLAGS "many_full" /* a configuration that keeps a status for each object ... */
#define WITHOUT_FLAGS "lanes"  /* ... and one that does not */
#define THRUST 2.9e5f          /* of programs/ship.cfg */
#define DRAG 4.1e4f
#define MASS 8.7e5f
#define STEP 0.0078125f
#define APART 1e-3f
#define POSITION_APART 0.1 /* after 100 steps: the ship's position is of first order */

typedef struct {
    const char *json, *engine;
    double patience; /* seconds of one run, at most */
    unsigned repeats;
    uint64_t objects[16], steps[16]; /* ended by 0 */
    int is_flipped;
} options;

typedef struct {
    const options *o;
    speed_runner runner[RUNNERS_MOST];
    unsigned count;
    fp3_measure_machines *machines;
    fp3_program *program;
    bench_ships start, now, expected; /* start: of T, C, rm, v, s; the others share T, C, rm */
    json_t *rows;
} speed;

/* ---- who runs ---- */

static void add(speed *s, speed_runner runner) {
    runner.machines = s->machines;
    runner.image = s->program->image;
    s->runner[s->count++] = runner;
}

/* The hardware and `isa` have the flags of their configuration; `fast` is measured with and
 * without. */
static void add_engine(speed *s, const char *engine, const char *config, unsigned threads,
                       double ns) {
    add(s, (speed_runner){.engine = engine,
                          .config = config,
                          .threads = threads,
                          .has_flags = !config || fp3_config_find(config)->status,
                          .is_exact = 1,
                          .ns = ns,
                          .run = speed_run_engine});
}

static void add_all(speed *s) {
    const unsigned cores = (unsigned)sysconf(_SC_NPROCESSORS_ONLN);
    const bench_ship_loop *loop;
    for (unsigned i = 0; (loop = bench_ship_loop_at(i)); i++)
        add(s, (speed_runner){.engine = loop->engine,
                              .method = loop->method,
                              .threads = 1,
                              .is_exact = 1,
                              .ns = loop->ns,
                              .loop = loop,
                              .run = speed_run_loop});
    if (!strcmp(s->o->engine, "fast")) {
        add_engine(s, "fast", WITHOUT_FLAGS, 1, 0.3);
        add_engine(s, "fast", WITH_FLAGS, 1, 0.3);
        if (cores > 1)
            add_engine(s, "fast", WITHOUT_FLAGS, cores, 0.2);
        add_engine(s, "fast", WITHOUT_FLAGS, 1, 1);
        s->runner[s->count - 1].method = "interpreter";
        s->runner[s->count - 1].is_interpreter = 1;
    }
    add_engine(s, "isa", NULL, 1, 5000);
    add_engine(s, "rtl", NULL, 1, 30000);
    add(s, (speed_runner){.engine = "gsl",
                          .method = "rk4",
                          .threads = 1,
                          .ns = 150,
                          .apart = 1e-3,
                          .run = speed_run_gsl});
    add(s, (speed_runner){.engine = "gsl",
                          .method = "rk8pd",
                          .threads = 1,
                          .ns = 400,
                          .apart = 1e-3,
                          .run = speed_run_gsl});
#ifdef BENCH_BOX2D
    add(s, (speed_runner){.engine = "box2d",
                          .threads = 1,
                          .ns = 150,
                          .apart = 0.01,
                          .bodies = &bench_box2d,
                          .run = speed_run_bodies});
#endif
#ifdef BENCH_ODE
    add(s, (speed_runner){.engine = "ode",
                          .threads = 1,
                          .ns = 500,
                          .apart = 0.01,
                          .bodies = &bench_ode,
                          .run = speed_run_bodies});
#endif
}

/* ---- ships ---- */

static fp3_status make_ships(speed *s, size_t objects, fp3_error *error) {
    const size_t room = (objects + BENCH_SHIP_BLOCK - 1) / BENCH_SHIP_BLOCK * BENCH_SHIP_BLOCK;
    float *all = aligned_alloc(64, 9 * room * sizeof *all);
    if (!all)
        return fp3_no_memory(error);
    s->start = (bench_ships){.objects = objects,
                             .h = STEP,
                             .T = all,
                             .C = all + room,
                             .rm = all + 2 * room,
                             .v = all + 3 * room,
                             .s = all + 4 * room};
    s->now = s->expected = s->start;
    s->now.v = all + 5 * room;
    s->now.s = all + 6 * room;
    s->expected.v = all + 7 * room;
    s->expected.s = all + 8 * room;
    for (size_t i = 0; i < room; i++) {
        s->start.T[i] = THRUST * (1 + APART * (float)(i % 64));
        s->start.C[i] = DRAG;
        s->start.rm[i] = 1 / MASS;
        s->start.v[i] = s->start.s[i] = 0;
    }
    return FP3_OK;
}

static void reset(const bench_ships *from, const bench_ships *to) {
    const size_t room =
        (from->objects + BENCH_SHIP_BLOCK - 1) / BENCH_SHIP_BLOCK * BENCH_SHIP_BLOCK;
    memcpy(to->v, from->v, room * sizeof *to->v);
    memcpy(to->s, from->s, room * sizeof *to->s);
}

/* Vectors have no fewer objects than they have room for. */
static bench_ships whole(const bench_ships *ships, const speed_runner *r) {
    bench_ships all = *ships;
    if (r->loop)
        all.objects = (all.objects + r->loop->block - 1) / r->loop->block * r->loop->block;
    return all;
}

static int is_near(const float *got, const float *expected, size_t count, double apart) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs((double)got[i] - (double)expected[i]) <= apart * fabs((double)expected[i])))
            return 0;
    return 1;
}

static fp3_status check(const speed *s, const speed_runner *r, uint64_t steps, fp3_error *error) {
    const size_t count = s->now.objects, size = count * sizeof *s->now.v;
    if (s->o->is_flipped && r->run == speed_run_engine) {
        uint32_t bits;
        memcpy(&bits, s->now.v, sizeof bits);
        bits ^= 1;
        memcpy(s->now.v, &bits, sizeof bits);
    }
    if (r->is_exact
            ? !memcmp(s->now.v, s->expected.v, size) && !memcmp(s->now.s, s->expected.s, size)
            : is_near(s->now.v, s->expected.v, count, r->apart) &&
                  (steps < 100 || is_near(s->now.s, s->expected.s, count, POSITION_APART)))
        return FP3_OK;
    return fp3_fail(error, FP3_E_MISMATCH,
                    "%s%s%s: %zu objects after %" PRIu64 " steps %s the loop by hand", r->engine,
                    r->method ? " " : "", r->method ? r->method : "", count, steps,
                    r->is_exact ? "have other bits than in" : "are elsewhere than by");
}

/* ---- a cell ---- */

/* Enough of them to take ten microseconds, but for the fewest objects. */
static speed_runs runs_of(const speed *s, uint64_t steps) {
    const uint64_t made = s->start.objects * steps, count = made < LEAST ? LEAST / made : 1;
    return (speed_runs){steps, count < RUNS_MOST ? count : RUNS_MOST};
}

static int is_in_time(const speed *s, const speed_runner *r, const speed_runs *runs) {
    const double made = (double)whole(&s->start, r).objects * (double)(runs->steps * runs->count);
    const size_t most = r->loop || !r->is_exact
                            ? SIZE_MAX
                            : fp3_engine_room(r->engine, speed_config(r, s->start.objects));
    return s->start.objects <= most && r->ns * 1e-9 * made <= s->o->patience;
}

static fp3_status run(const speed *s, const speed_runner *r, const speed_runs *runs,
                      double *seconds, fp3_error *error) {
    const bench_ships ships = whole(&s->now, r);
    reset(&s->start, &s->now);
    const fp3_status status = r->run(r, &ships, runs, seconds, error);
    return status ? status : check(s, r, runs->steps * runs->count, error);
}

static void put(const speed *s, const speed_runner *r, const speed_runs *runs, double seconds,
                unsigned repeats, double by_hand) {
    const double per = 1e9 / ((double)s->start.objects * (double)(runs->steps * runs->count));
    json_t *row = json_pack("{s:s, s:s, s:I, s:b, s:I, s:I, s:f, s:f, s:I}", "program", "ship",
                            "engine", r->engine, "threads", (json_int_t)r->threads, "flags",
                            r->has_flags, "objects", (json_int_t)s->start.objects, "steps",
                            (json_int_t)runs->steps, "ns_per_object_step", seconds * per,
                            "ratio_to_hand", seconds / by_hand, "repeats", (json_int_t)repeats);
    json_object_set_new(row, "method", r->method ? json_string(r->method) : json_null());
    json_array_append_new(s->rows, row);
}

/* The loop by hand that takes the fewest nanoseconds says what everybody must end with. */
static const speed_runner *reference(const speed *s) {
    const speed_runner *best = &s->runner[0];
    for (unsigned i = 1; i < s->count; i++)
        if (s->runner[i].ns < best->ns && !strcmp(s->runner[i].engine, "hand"))
            best = &s->runner[i];
    return best;
}

static fp3_status measure_cell(speed *s, uint64_t steps, fp3_error *error) {
    double seconds[RUNNERS_MOST][FP3_MEASURE_REPEATS], by_hand = INFINITY, ignored;
    fp3_status status = FP3_OK;
    const speed_runner *by = reference(s);
    const speed_runs runs = runs_of(s, steps);
    bench_ships expected = whole(&s->expected, by);
    reset(&s->start, &s->expected);
    if (!is_in_time(s, by, &runs))
        return FP3_OK;
    status = by->run(by, &expected, &runs, &ignored, error);
    for (unsigned k = 0; !status && k < s->o->repeats; k++)
        for (unsigned i = 0; !status && i < s->count; i++)
            if (is_in_time(s, &s->runner[i], &runs))
                status = run(s, &s->runner[i], &runs, &seconds[i][k], error);
    for (unsigned i = 0; !status && i < s->count; i++)
        if (is_in_time(s, &s->runner[i], &runs) && !strcmp(s->runner[i].engine, "hand"))
            by_hand = fmin(by_hand, fp3_measure_median(seconds[i], s->o->repeats));
    for (unsigned i = 0; !status && i < s->count; i++)
        if (is_in_time(s, &s->runner[i], &runs))
            put(s, &s->runner[i], &runs, fp3_measure_median(seconds[i], s->o->repeats),
                s->o->repeats, by_hand);
    return status;
}

/* ---- all cells ---- */

static fp3_status measure(speed *s, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && s->o->objects[i]; i++) {
        fprintf(stderr, "speed: %" PRIu64 " objects\n", s->o->objects[i]);
        status = make_ships(s, s->o->objects[i], error);
        for (int k = 0; !status && s->o->steps[k]; k++)
            status = measure_cell(s, s->o->steps[k], error);
        free(s->start.T);
        s->start.T = NULL;
    }
    return status;
}

static fp3_status write_json(const speed *s, fp3_error *error) {
    json_t *all = json_pack("{s:s, s:O}", "target", bench_ship_target(), "speed", s->rows);
    char *text = all ? json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    const fp3_status status =
        text ? fp3_file_write(s->o->json, text, strlen(text), error) : fp3_no_memory(error);
    free(text);
    json_decref(all);
    return status;
}

static fp3_status bench(const options *o, char **report, fp3_error *error) {
    speed s = {.o = o, .rows = json_array()};
    const fp3_program_def def = fp3_program_default();
    fp3_status status = fp3_measure_machines_open(0, &s.machines, error);
    if (!status)
        status = fp3_program_open(PROGRAM, &def, &s.program, report, error);
    if (!status) {
        add_all(&s);
        status = measure(&s, error);
    }
    if (!status)
        status = write_json(&s, error);
    fp3_program_close(&s.program);
    fp3_measure_machines_close(&s.machines);
    json_decref(s.rows);
    return status;
}

enum { KEY_JSON = 256, KEY_QUICK, KEY_FLIP, KEY_ENGINE };

static const struct argp_option table[] = {
    {"json", KEY_JSON, "FILE", 0, "Where the figures go", 0},
    {"engine", KEY_ENGINE, "NAME", 0, "Of fp3: fast (default), or isa and no other", 0},
    {"quick", KEY_QUICK, NULL, 0, "Few cells, three repeats", 0},
    {"flip", KEY_FLIP, NULL, 0, "Turn a bit of what engines give, which must be noticed", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case KEY_JSON:
        o->json = text;
        break;
    case KEY_ENGINE:
        o->engine = text;
        break;
    case KEY_QUICK:
        o->repeats = 3;
        o->patience = 0.05;
        memcpy(o->objects, (uint64_t[]){1, 1024, 16384, 0}, 4 * sizeof *o->objects);
        memcpy(o->steps, (uint64_t[]){1, 10, 100, 1000, 0}, 5 * sizeof *o->steps);
        break;
    case KEY_FLIP:
        o->is_flipped = 1;
        break;
    case ARGP_KEY_END:
        if (!o->json)
            argp_error(state, "expected --json");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int bench_speed_command(int argc, char **argv) {
    static const struct argp argp = {.options = table,
                                     .parser = parse,
                                     .doc = "Nanoseconds for a step of the ship (" PROGRAM
                                            "), by objects and steps: fp3's engines, "
                                            "loops in C by hand, GSL."};
    options o = {.engine = "fast",
                 .repeats = 7,
                 .patience = 0.5,
                 .objects = {1, 64, 1024, 16384, 131072, 1000000},
                 .steps = {1, 10, 100, 1000, 10000, 1000000}};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    fp3_error error = {.text = ""};
    char *report = NULL;
    const fp3_status status = bench(&o, &report, &error);
    if (status)
        fprintf(stderr, "bench speed: %s\n", report ? report : error.text);
    free(report);
    return fp3_exit_code(status);
}
