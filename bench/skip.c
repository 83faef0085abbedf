/* skip.c - bench skip: each way of leaving out what a scene does not need, with and without.
 *
 * All sides of a case take turns on the engine fast; the figure is the shortest time of the steps
 * alone. Cycles are those of the Verilated hardware. Every side must end with the bits of the first
 * in all objects that are not idle, or the row says how many words differ.
 */
#include "skip.h"

#include "commands.h"
#include "lab/measure/points.h"

#include "base/file.h"

#include <argp.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FAST_CONFIG "many_full"
#define RUNS 4                    /* after one load */
#define NEVER (UINT64_C(1) << 40) /* a step that no run reaches */

typedef struct {
    const char *json;
    uint32_t objects, steps; /* on fast */
    uint32_t rtl_steps;
    uint32_t
        idle_objects; /* of the hardware, where some are idle: many, so that 1 % hide the latency */
    unsigned repeats;
    int is_flipped;
    unsigned first; /* case ... */
    int is_one;     /* ... and no other */
} options;

typedef struct {
    const skip_case *of;
    const skip_side *side;
    fp3_program *program;
    fp3_engine *engine;
    double seconds; /* the least */
    float *ends;    /* observed states of all objects, one state after the other */
} runner;

typedef struct {
    const options *o;
    json_t *rows;
} skip;

/* ---- a program ---- */

static const char *name_at(const skip_side *side, const fp3_program *program, size_t i) {
    size_t count = 0;
    if (side->observed[0])
        return i < 4 ? side->observed[i] : NULL;
    for (uint32_t k = 0; k < program->image->symbol_count; k++)
        if (program->image->symbols[k].symbol_class == FP3_SYMBOL_STATE &&
            (int)program->image->symbols[k].index != fp3_image_slept(program->image) &&
            count++ == i)
            return program->image->symbols[k].name;
    return NULL;
}

static size_t count_names(const skip_side *side, const fp3_program *program) {
    size_t count = 0;
    while (name_at(side, program, count))
        count++;
    return count;
}

static fp3_status compile(const skip_case *of, const skip_side *side, const char *config,
                          fp3_program **program, fp3_error *error) {
    fp3_program_def def = fp3_program_default();
    size_t observed = 0;
    while (observed < 4 && side->observed[observed])
        observed++;
    def.integrator = of->integrator;
    def.compile.config = config;
    def.compile.passes &= ~side->without;
    def.compile.observed = observed ? side->observed : NULL;
    def.compile.observed_count = observed;
    return fp3_program_open(of->program, &def, program, NULL, error);
}

/* Objects differ: the first state of a model by a hundredth. */
static fp3_status make_params(const fp3_program *program, fp3_params **params, fp3_error *error) {
    fp3_status status = fp3_params_make(params, error);
    if (!status && program->model) {
        char text[128];
        const fp3_quantity *first = &program->model->states[0];
        const double value = first->value;
        snprintf(text, sizeof text, "%s=%.17g:%.17g", first->name, value,
                 value != 0 ? value * 1.01 : 0.01);
        status = fp3_params_spread(*params, text, error);
    } else if (!status) {
        static const char *const more[] = {"slept=0", "eps=0"};
        status = fp3_params_load(*params, "programs/ship.cfg", error);
        if (!status)
            status = fp3_params_spread(*params, "T=2.4e5:3.3e5", error);
        for (int i = 0; !status && i < 2 && fp3_image_slept(program->image) >= 0; i++)
            status = fp3_params_set(*params, more[i], error);
    }
    return status;
}

/* ---- who is idle ---- */

/* Those who are not lie evenly. */
static int is_idle(const skip_case *of, const skip_side *side, uint64_t object) {
    return of->idle && (object + 1) * side->percent / 100 == object * side->percent / 100;
}

static fp3_status put_to_rest(const runner *r) {
    fp3_status status = FP3_OK;
    const size_t objects = fp3_engine_objects(r->engine);
    for (size_t i = 0; !status && i < objects; i++)
        if (is_idle(r->of, r->side, i))
            status = r->of->idle == SKIP_SLEEP
                         ? fp3_engine_remove(r->engine, i, 1)
                         : fp3_engine_live(r->engine, i, 1, NEVER, FP3_FOREVER);
    return status;
}

/* ---- a run ---- */

/* A step first, so that what an engine needs once is not timed; then all steps RUNS times.
 * *seconds: the least that the processor was given to one of these. */
static fp3_status run(const runner *r, uint32_t steps, int runs, double *seconds, fp3_stats *stats,
                      fp3_error *error) {
    fp3_params *params = NULL;
    fp3_status status = make_params(r->program, &params, error);
    if (!status)
        status = fp3_program_load(r->program, params, r->engine, error);
    if (!status)
        status = put_to_rest(r);
    if (!status)
        status = fp3_engine_run(r->engine, 1, stats);
    *seconds = INFINITY;
    for (int i = 0; !status && i < runs; i++) {
        const double begin = fp3_measure_spent();
        status = fp3_engine_run(r->engine, steps, stats);
        *seconds = fmin(*seconds, fp3_measure_spent() - begin);
    }
    fp3_params_free(&params);
    return status;
}

static fp3_status read_ends(runner *r) {
    const size_t objects = fp3_engine_objects(r->engine);
    fp3_status status = FP3_OK;
    const char *name;
    for (size_t i = 0; !status && (name = name_at(r->side, r->program, i)); i++) {
        const fp3_symbol *s = fp3_image_find(r->program->image, name, FP3_CLASS(FP3_SYMBOL_STATE));
        status = fp3_engine_read(r->engine, 0, objects, s->index, r->ends + i * objects);
    }
    return status;
}

static fp3_status open_runner(runner *r, const skip_case *of, const skip_side *side,
                              const char *engine, const char *config, uint32_t objects,
                              fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    *r = (runner){.of = of, .side = side, .seconds = INFINITY};
    def.engine = engine;
    def.config = config;
    def.objects = objects;
    def.threads = 1;
    def.visit = !strcmp(engine, "rtl") ? of->visit : 0;
    def.error = error;
    fp3_status status = compile(of, side, config, &r->program, error);
    if (!status)
        status = fp3_engine_open(&def, &r->engine);
    if (status)
        return status;
    r->ends =
        calloc(fp3_engine_objects(r->engine) * count_names(side, r->program) + 1, sizeof *r->ends);
    return r->ends ? FP3_OK : fp3_no_memory(error);
}

static void close_runner(runner *r) {
    fp3_engine_close(&r->engine);
    fp3_program_close(&r->program);
    free(r->ends);
}

/* ---- what differs ---- */

/* Words of objects that are not idle that are other ones than the first side's. */
static uint64_t count_other(const runner *first, const runner *r) {
    const size_t objects = fp3_engine_objects(r->engine);
    const size_t names = count_names(r->side, r->program);
    uint64_t other = 0;
    for (size_t i = 0; i < objects; i++)
        for (size_t k = 0; k < names && !is_idle(r->of, r->side, i); k++)
            other += memcmp(&r->ends[k * objects + i], &first->ends[k * objects + i],
                            sizeof *r->ends) != 0;
    return other;
}

static void flip(runner *r) {
    uint32_t bits;
    memcpy(&bits, r->ends, sizeof bits);
    bits ^= 1;
    memcpy(r->ends, &bits, sizeof bits);
}

/* ---- rows ---- */

static json_t *row_of(const runner *r) {
    const fp3_image *image = r->program->image;
    return json_pack("{s:s, s:s, s:s, s:s?, s:s, s:I, s:I}", "way", r->of->way, "program",
                     r->of->program, "side", r->side->what, "integrator",
                     r->program->model ? r->of->integrator : NULL, "config",
                     r->side->config ? r->side->config : FAST_CONFIG, "percent",
                     (json_int_t)(r->of->idle ? r->side->percent : 100), "instructions",
                     (json_int_t)(image->last - image->step));
}

/* Of each configuration, cycles for a step of each object, idle or not. */
static fp3_status add_cycles(const skip *s, const skip_case *of, const skip_side *side,
                             const char *config, runner *first, json_t *row, fp3_error *error) {
    runner r = {0};
    fp3_stats stats;
    double ignored;
    fp3_status status =
        open_runner(&r, of, side, "rtl", config, of->idle ? s->o->idle_objects : 0, error);
    if (!status)
        status = run(&r, s->o->rtl_steps, 1, &ignored, &stats, error);
    if (!status)
        status = read_ends(&r);
    if (!status) {
        const double steps = (double)s->o->rtl_steps * (double)fp3_engine_objects(r.engine);
        json_object_set_new(json_object_get(row, "cycles"), config,
                            json_real((double)stats.counter[FP3_COUNTER_CYCLES] / steps));
        json_object_set_new(row, "other_words",
                            json_integer(json_integer_value(json_object_get(row, "other_words")) +
                                         (json_int_t)(first->engine ? count_other(first, &r) : 0)));
    }
    if (!status && !first->engine)
        *first = r;
    else
        close_runner(&r);
    return status;
}

static unsigned count_sides(const skip_case *of) {
    unsigned count = 0;
    while (count < SKIP_SIDES && of->side[count].what)
        count++;
    return count;
}

/* ---- a case ---- */

static fp3_status time_sides(const skip *s, runner *list, unsigned count, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned n = 0; !status && n < s->o->repeats; n++)
        for (unsigned i = 0; !status && i < count; i++) {
            fp3_stats stats;
            double seconds = 0;
            status = run(&list[i], s->o->steps, RUNS, &seconds, &stats, error);
            list[i].seconds = fmin(list[i].seconds, seconds);
        }
    for (unsigned i = 0; !status && i < count; i++)
        status = read_ends(&list[i]);
    if (!status && s->o->is_flipped)
        flip(&list[0]);
    return status;
}

static fp3_status measure_fast(const skip *s, const skip_case *of, json_t **row, fp3_error *error) {
    runner list[SKIP_SIDES] = {{0}};
    const unsigned count = count_sides(of);
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < count; i++)
        status = open_runner(&list[i], of, &of->side[i], "fast",
                             of->side[i].config ? of->side[i].config : FAST_CONFIG, s->o->objects,
                             error);
    if (!status)
        status = time_sides(s, list, count, error);
    for (unsigned i = 0; !status && i < count; i++) {
        row[i] = row_of(&list[i]);
        const double steps = (double)s->o->steps * (double)s->o->objects;
        json_object_set_new(row[i], "ns_per_object_step", json_real(1e9 * list[i].seconds / steps));
        json_object_set_new(row[i], "ratio", json_real(list[i].seconds / list[0].seconds));
        json_object_set_new(row[i], "other_words",
                            json_integer((json_int_t)count_other(&list[0], &list[i])));
        json_object_set_new(row[i], "cycles", json_object());
        json_array_append_new(s->rows, row[i]);
    }
    for (unsigned i = 0; i < count; i++)
        close_runner(&list[i]);
    return status;
}

static fp3_status measure_hardware(const skip *s, const skip_case *of, const char *config,
                                   json_t **row, fp3_error *error) {
    runner first = {0};
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < count_sides(of); i++)
        status = add_cycles(s, of, &of->side[i], config, &first, row[i], error);
    close_runner(&first);
    return status;
}

static fp3_status measure_case(const skip *s, const skip_case *of, fp3_error *error) {
    json_t *row[SKIP_SIDES] = {NULL};
    fprintf(stderr, "skip: %s, %s\n", of->way, of->program);
    fp3_status status = measure_fast(s, of, row, error);
    for (int i = 0; !status && i < 3 && of->configs[i]; i++)
        status = measure_hardware(s, of, of->configs[i], row, error);
    return status;
}

static fp3_status write_json(const skip *s, fp3_error *error) {
    json_t *all =
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:O}", "objects", (json_int_t)s->o->objects, "steps",
                  (json_int_t)s->o->steps, "rtl_steps", (json_int_t)s->o->rtl_steps, "repeats",
                  (json_int_t)(RUNS * s->o->repeats), "idle_objects",
                  (json_int_t)s->o->idle_objects, "rows", s->rows);
    char *text = all ? json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    const fp3_status status =
        text ? fp3_file_write(s->o->json, text, strlen(text), error) : fp3_no_memory(error);
    free(text);
    json_decref(all);
    return status;
}

/* ---- the command ---- */

enum { KEY_JSON = 256, KEY_QUICK, KEY_FLIP, KEY_CASE };

static const struct argp_option table[] = {
    {"json", KEY_JSON, "FILE", 0, "Where the figures go", 0},
    {"quick", KEY_QUICK, NULL, 0, "Few objects and steps, two repeats", 0},
    {"flip", KEY_FLIP, NULL, 0, "Turn a bit of what first sides end with, which must be told", 0},
    {"case", KEY_CASE, "N", 0, "This case alone, from 0", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case KEY_JSON:
        o->json = text;
        break;
    case KEY_QUICK:
        o->objects = 512;
        o->steps = 20;
        o->rtl_steps = 2;
        o->idle_objects = 200;
        o->repeats = 2;
        break;
    case KEY_FLIP:
        o->is_flipped = 1;
        break;
    case KEY_CASE:
        o->first = (unsigned)strtoul(text, NULL, 10);
        o->is_one = 1;
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

int bench_skip_command(int argc, char **argv) {
    static const struct argp argp = {
        .options = table,
        .parser = parse,
        .doc = "What a scene does not need, done and left out: time on the engine fast, cycles, "
               "instructions, and words that differ."};
    options o = {
        .objects = 16384, .steps = 200, .rtl_steps = 20, .idle_objects = 2000, .repeats = 9};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    fp3_error error = {.text = ""};
    skip s = {.o = &o, .rows = json_array()};
    fp3_status status = s.rows ? FP3_OK : fp3_no_memory(&error);
    const skip_case *of;
    for (unsigned i = o.first; !status && (of = skip_case_at(i)) && (!o.is_one || i == o.first);
         i++)
        status = measure_case(&s, of, &error);
    if (!status)
        status = write_json(&s, &error);
    if (status)
        fprintf(stderr, "bench skip: %s\n", error.text);
    json_decref(s.rows);
    return fp3_exit_code(status);
}
