/* cmd_bench.c - fp3 bench: the ship on the hardware against golden and truth. The pairs of program
 * and configuration, scenes of many objects, the tables, the JSON; ship_bench.c runs one.
 */
#include "base/file.h"
#include "cli.h"
#include "machine/config.h"
#include "ship_bench.h"

#include <argp.h>
#include <errno.h>
#include <glob.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PROGRAMS "programs/ship*.s"
#define PAPER_FIRST 445
#define PAPER_NEXT 418
#define STEPS_LEAST 20 /* after the first, where the steps are shared by many objects */

typedef struct {
    const char *config, *program, *params, *json;
    uint64_t steps; /* after the first, of one object; many share them */
    int scenes;
} options;

/* What was run, and what came of it. */
typedef struct {
    fp3_ship_case what;
    fp3_ship_result got;
    const fp3_config *config;
} outcome;

/* ---- what is told ---- */

/* Of a counter, what each step after the first adds. */
static double per_step(const outcome *o, fp3_counter counter) {
    return ((double)o->got.all.counter[counter] - (double)o->got.one.counter[counter]) /
           (double)(o->what.steps - 1);
}

static double rate(const outcome *o) {
    const fp3_stats *all = &o->got.all;
    return all->seconds > 0 ? (double)all->counter[FP3_COUNTER_CYCLES] / all->seconds : 0;
}

/* No schedule of this program on this organisation takes fewer cycles per object-step. A step has I
 * instructions, A of them for the adder and M for the multiplier (a madd counts in both). In a tile a
 * scheduler issues one instruction per cycle for L lanes, and there are S schedulers (S or L is 1):
 * I / (S * L). An adder begins one sum per cycle, and there is one for each lane: A / L; likewise
 * M / L. The largest of the three, shared by all tiles. */
static double bound(const outcome *o) {
    const fp3_config *c = o->config;
    const double issue = (double)o->got.issues / c->schedulers;
    const double uses = o->got.adds > o->got.muls ? o->got.adds : o->got.muls;
    return (issue > uses ? issue : uses) / c->lanes / c->tiles;
}

static double issued_per_step(const outcome *o) {
    double sum = 0;
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (strncmp(fp3_counter_name((fp3_counter)i), "issued_", 7) == 0)
            sum += per_step(o, (fp3_counter)i);
    return sum;
}

static void print_head(const options *o) {
    printf("The ship of Equations (1), one integration and %" PRIu64
           " more (many objects share them). first, next: cycles; /object: next per "
           "object-step.\n\n",
           o->steps);
    printf("%-24s %7s %9s %7s %7s %7s", "program, config", "first", "next", "objects", "/object",
           "bound");
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10s", fp3_counter_name((fp3_counter)i) + strlen("stall_"));
    printf(" %9s %9s %9s\n", "error v", "error s", "cycles/s");
    printf("%-24s %7d %9d\n", "the paper", PAPER_FIRST, PAPER_NEXT);
}

static void print_outcome(const outcome *o) {
    char name[64];
    const double next = per_step(o, FP3_COUNTER_CYCLES);
    snprintf(name, sizeof name, "%s, %s", o->what.program, o->what.config);
    printf("%-24s %7" PRIu64 " %9.6g %7" PRIu64 " %7.2f %7.2f", name,
           o->got.one.counter[FP3_COUNTER_CYCLES], next, o->got.objects,
           next / (double)o->got.objects, bound(o));
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10.6g", per_step(o, (fp3_counter)i));
    printf(" %9.2e %9.2e %9.2e  mismatches %" PRIu64 " of %" PRIu64 " words\n", o->got.rel_err_v,
           o->got.rel_err_s, rate(o), o->got.mismatches, o->got.words);
    fflush(stdout);
}

static void put_integer(json_t *to, const char *name, uint64_t value) {
    json_object_set_new(to, name, json_integer((json_int_t)value));
}

static void put_real(json_t *to, const char *name, double value) {
    json_object_set_new(to, name, json_real(value));
}

/* What runs and scenes both tell: names, sizes, what was compared. */
static json_t *common_json(const outcome *o) {
    json_t *object = json_object();
    json_object_set_new(object, "config", json_string(o->what.config));
    json_object_set_new(object, "program", json_string(o->what.program));
    put_integer(object, "objects", o->got.objects);
    put_integer(object, "steps", o->what.steps);
    put_integer(object, "words", o->got.words);
    put_integer(object, "mismatches", o->got.mismatches);
    put_integer(object, "object_steps", o->got.all.object_steps);
    put_real(object, "cycles_per_second", rate(o));
    return object;
}

/* Of the cycles that a step adds, in how many a unit of each kind is used, on average. */
static json_t *utilisation_json(const outcome *o) {
    const double cycles = per_step(o, FP3_COUNTER_CYCLES) * o->config->tiles;
    const double chain = per_step(o, FP3_COUNTER_ISSUED_CHAIN);
    json_t *object = json_object();
    put_real(object, "add", (per_step(o, FP3_COUNTER_ISSUED_ADD) + chain) / cycles);
    put_real(object, "mul", (per_step(o, FP3_COUNTER_ISSUED_MUL) + chain) / cycles);
    put_real(object, "issue", issued_per_step(o) / cycles / o->config->schedulers);
    return object;
}

static json_t *to_json(const outcome *o) {
    json_t *stalls = json_object(), *object = common_json(o);
    const uint64_t *one = o->got.one.counter, *all = o->got.all.counter;
    const uint64_t added = all[FP3_COUNTER_CYCLES] - one[FP3_COUNTER_CYCLES];
    const double next = per_step(o, FP3_COUNTER_CYCLES);
    put_integer(object, "first_cycles", one[FP3_COUNTER_CYCLES]);
    json_object_set_new(object, "next_cycles",
                        added % (o->what.steps - 1) ? json_real(next)
                                                    : json_integer((json_int_t)next));
    put_real(object, "cycles_per_object_step", next / (double)o->got.objects);
    put_real(object, "bound", bound(o));
    put_real(object, "rel_err_v", o->got.rel_err_v);
    put_real(object, "rel_err_s", o->got.rel_err_s);
    for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
        const char *name = fp3_counter_name((fp3_counter)i);
        const int is_stall = fp3_counter_is_stall((fp3_counter)i);
        put_integer(is_stall ? stalls : object, is_stall ? name + strlen("stall_") : name, all[i]);
    }
    json_object_set_new(object, "stalls", stalls);
    json_object_set_new(object, "unit_utilisation", utilisation_json(o));
    return object;
}

static fp3_status write_json(const char *path, json_t *runs, json_t *scenes, fp3_error *error) {
    char folder[4096];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
        if (*folder && mkdir(folder, 0777) && errno != EEXIST)
            return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", folder, strerror(errno));
    }
    json_t *root = json_pack("{s:O, s:O}", "runs", runs, "scenes", scenes);
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(root);
    if (!text)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory, or a figure that is no number");
    fp3_status status = fp3_file_write(path, text, strlen(text), error);
    free(text);
    return status;
}

/* ---- the table of runs ---- */

static fp3_status open_program(const char *path, fp3_program **program, fp3_error *error) {
    const fp3_program_def def = fp3_program_default();
    return fp3_program_open(path, &def, program, NULL, error);
}

typedef struct {
    json_t *runs, *scenes;
    fp3_params *params;
    fp3_error mismatch; /* the first of all */
} results;

static void note_mismatch(const outcome *o, results *to) {
    if (o->got.mismatches && !to->mismatch.text[0])
        fp3_fail(&to->mismatch, FP3_E_MISMATCH, "%s, %s: %s", o->what.program, o->what.config,
                 o->got.mismatch.text);
}

/* After the first, so many as make the object-steps that one object is asked for. */
static uint64_t steps_for(const options *o, const fp3_config *config) {
    const uint64_t objects =
        (uint64_t)config->contexts * config->lanes * fp3_config_schedulers(config);
    const uint64_t least = o->steps < STEPS_LEAST ? o->steps : STEPS_LEAST;
    return o->steps / objects > least ? o->steps / objects : least;
}

/* One pair. *is_unfit: it is left out, and error says why. */
static fp3_status bench_pair(const options *o, const fp3_program *image, const char *program,
                             const fp3_config *config, results *to, int *is_unfit,
                             fp3_error *error) {
    outcome x = {.config = config,
                 .what = {.config = config->name,
                          .program = program,
                          .awake_of = 1,
                          .steps = steps_for(o, config) + 1}};
    fp3_status status = fp3_ship_bench(image, to->params, &x.what, &x.got, is_unfit, error);
    if (*is_unfit)
        return status;
    if (status) {
        const fp3_error why = *error;
        return fp3_fail(error, status, "%s, %s: %s", program, config->name, why.text);
    }
    print_outcome(&x);
    json_array_append_new(to->runs, to_json(&x));
    note_mismatch(&x, to);
    return FP3_OK;
}

/* All configurations that are asked for. A pair that was asked for by name must be possible. */
static fp3_status bench_program(const options *o, const char *path, results *to, fp3_error *error) {
    char program[64];
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    snprintf(program, sizeof program, "%.*s", (int)strcspn(base, "."), base);
    fp3_program *opened = NULL;
    fp3_status status = open_program(path, &opened, error);
    for (uint32_t i = 0; i < fp3_config_count && !status; i++) {
        const fp3_config *config = &fp3_configs[i];
        int is_unfit = 0;
        if (o->config && strcmp(o->config, config->name) != 0)
            continue;
        status = bench_pair(o, opened, program, config, to, &is_unfit, error);
        if (is_unfit && !(o->config && o->program)) {
            printf("%s, %s: left out: %s\n", program, config->name, error->text);
            status = FP3_OK;
        }
    }
    fp3_program_close(&opened);
    return status;
}

/* ---- scenes of many objects ---- */

/* Its cycles per object-step are told as a ratio to those of the reference before it. */
typedef struct {
    const char *name, *program;
    uint32_t objects, visit, awake_of;
    uint64_t steps;
    int is_reference;
} scene;

#define SCENES "crowd" /* the configuration: a store for all of them */
static const scene scenes[] = {
    {"resident", "ship_madd", 0, 0, 1, 64, 1},
    {"16 steps per visit", "ship_madd", 10000, 16, 1, 64, 0},
    {"1 step per visit", "ship_madd", 10000, 1, 1, 4, 0},
    {"all awake", "ship_sleep", 10000, 16, 1, 16, 1},
    {"10 % awake", "ship_sleep", 10000, 16, 10, 16, 0},
    {"1 % awake", "ship_sleep", 10000, 16, 100, 16, 0},
};

static void tell_scene(const scene *s, const outcome *o, double per, double ratio, results *to) {
    const uint64_t cycles = o->got.all.counter[FP3_COUNTER_CYCLES];
    printf("%-20s %-12s %7" PRIu64 " %7" PRIu64 " %6" PRIu64 " %6" PRIu32 " %10" PRIu64
           " %8.3f %7.3f",
           s->name, s->program, o->got.objects, o->got.awake, o->what.steps, s->visit, cycles, per,
           ratio);
    printf("  mismatches %" PRIu64 " of %" PRIu64 " words\n", o->got.mismatches, o->got.words);
    fflush(stdout);
    json_t *object = common_json(o);
    json_object_set_new(object, "scene", json_string(s->name));
    put_integer(object, "awake", o->got.awake);
    put_integer(object, "visit", s->visit);
    put_integer(object, "cycles", cycles);
    put_real(object, "cycles_per_object_step", per);
    put_real(object, "ratio", ratio);
    json_array_append_new(to->scenes, object);
    note_mismatch(o, to);
}

static fp3_status bench_scene(const scene *s, double *reference, results *to, fp3_error *error) {
    char path[64];
    int is_unfit;
    fp3_program *opened = NULL;
    outcome x = {.config = fp3_config_find(SCENES),
                 .what = {SCENES, s->program, s->objects, s->visit, s->awake_of, s->steps}};
    snprintf(path, sizeof path, "programs/%s.s", s->program);
    fp3_status status = open_program(path, &opened, error);
    if (!status)
        status = fp3_ship_bench(opened, to->params, &x.what, &x.got, &is_unfit, error);
    if (!status) {
        const double per =
            (double)x.got.all.counter[FP3_COUNTER_CYCLES] / (double)x.got.all.object_steps;
        *reference = s->is_reference ? per : *reference;
        tell_scene(s, &x, per, per / *reference, to);
    } else {
        const fp3_error why = *error;
        fp3_fail(error, status, "scene '%s': %s", s->name, why.text);
    }
    fp3_program_close(&opened);
    return status;
}

static fp3_status bench_scenes(results *to, fp3_error *error) {
    double reference = 0;
    fp3_status status = FP3_OK;
    printf("\nScenes on " SCENES ": ships from the object store.\n\n%-20s %-12s %7s %7s %6s %6s "
           "%10s %8s %7s\n",
           "scene", "program", "objects", "awake", "steps", "visit", "cycles", "/object", "ratio");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes && !status; i++)
        status = bench_scene(&scenes[i], &reference, to, error);
    return status;
}

/* ---- all of it ---- */

/* Says so, and which there are, if there is no such configuration. */
static fp3_status check_config(const options *o, fp3_error *error) {
    fp3_engine *probe = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.error = error;
    def.config = o->config ? o->config : def.config;
    fp3_status status = fp3_engine_open(&def, &probe);
    fp3_engine_close(&probe);
    return status;
}

static fp3_status bench_programs(const options *o, results *to, fp3_error *error) {
    char pattern[4096];
    if (!o->program)
        snprintf(pattern, sizeof pattern, "%s", PROGRAMS);
    else if (strchr(o->program, '/'))
        snprintf(pattern, sizeof pattern, "%s", o->program);
    else
        snprintf(pattern, sizeof pattern, "programs/%s.s", o->program);
    glob_t paths = {0};
    fp3_status status = FP3_OK;
    if (glob(pattern, 0, NULL, &paths))
        status = fp3_fail(error, FP3_E_ARGUMENT, "no program %s", pattern);
    else
        print_head(o);
    for (size_t i = 0; i < paths.gl_pathc && !status; i++)
        status = bench_program(o, paths.gl_pathv[i], to, error);
    if (!status && json_array_size(to->runs) == 0)
        status =
            fp3_fail(error, FP3_E_ARGUMENT, "no configuration asked for can execute %s", pattern);
    globfree(&paths);
    return status;
}

static fp3_status bench(const options *o, fp3_error *error) {
    results to = {.runs = json_array(), .scenes = json_array()};
    fp3_status status = check_config(o, error);
    if (!status)
        status = fp3_params_make(&to.params, error);
    if (!status)
        status = fp3_params_load(to.params, o->params, error);
    if (!status)
        status = bench_programs(o, &to, error);
    if (!status && o->scenes)
        status = bench_scenes(&to, error);
    if (!status)
        status = write_json(o->json, to.runs, to.scenes, error);
    if (!status && to.mismatch.text[0])
        status = fp3_fail(error, FP3_E_MISMATCH, "%s", to.mismatch.text);
    json_decref(to.runs);
    json_decref(to.scenes);
    fp3_params_free(&to.params);
    return status;
}

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "One configuration (default: all)", 0},
    {"program", 'p', "NAME", 0, "programs/NAME.s, or a path with a / (default: " PROGRAMS ")", 0},
    {"steps", 'n', "N", 0,
     "Integrations after the first, of one object or shared by many (default: 10000)", 0},
    {"params", 'P', "FILE", 0, "The ship (default: programs/ship.cfg)", 0},
    {"scenes", 's', NULL, 0, "Also run scenes of 10,000 objects from the store", 0},
    {"json", 'j', "FILE", 0, "Where the figures go (default: build/results/sim.json)", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    char *end;
    switch (key) {
    case 'c':
        o->config = text;
        break;
    case 'p':
        o->program = text;
        break;
    case 'P':
        o->params = text;
        break;
    case 'j':
        o->json = text;
        break;
    case 'n':
        o->steps = strtoull(text, &end, 10);
        if (end == text || *end || *text < '0' || *text > '9' || o->steps < 1 ||
            o->steps > 10000000)
            argp_error(state, "--steps: '%s' is no number from 1 to 10000000", text);
        break;
    case 's':
        o->scenes = 1;
        break;
    case ARGP_KEY_ARG:
        argp_error(state, "found '%s', expected options only", text);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int fp3_cmd_bench(int argc, char **argv) {
    options o = {.params = "programs/ship.cfg", .json = "build/results/sim.json", .steps = 10000};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .doc = "Runs the ship on the hardware under Verilator: compares every step with the golden "
               "model bit for bit, counts cycles, measures the error against truth. Exit code 1 on "
               "any mismatch."};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    fp3_error error = {""};
    fp3_status status = bench(&o, &error);
    return fp3_cli_done("bench", status ? fp3_cli_fail("bench", status, &error) : 0);
}
