/* cmd_run.c - fp3 run: a program, or a scene of several, on an engine, from the host's values to the
 * final ones.
 */
#include "cli.h"

#include <argp.h>
#include <errno.h>
#include <fp3/scene.h>
#include <fp3/trace.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN 8 /* objects whose states are printed without --all */

typedef struct {
    const char *program, *scene, *config, *engine, *bus_log, *kanata, *integrator;
    uint64_t steps, cycle_limit, objects, visit;
    int all, has_steps, is_compensated;
    fp3_params *params;
} options;

enum {
    KEY_SET = 256,
    KEY_PARAMS,
    KEY_LIMIT,
    KEY_BUS_LOG,
    KEY_VISIT,
    KEY_KANATA,
    KEY_ALL,
    KEY_SCENE
};

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "Configuration (default: single, for a model single_full)", 0},
    {"integrator", 'i', "NAME", 0, "Of a model: a built-in table, or a file (default: rk4)", 0},
    {"compensated", 'k', NULL, 0, "Of a model: keep what updates round away (Kahan)", 0},
    {"engine", 'e', "ENGINE", 0,
     "rtl, the hardware under Verilator (default), or isa, an instruction-set simulator in C", 0},
    {"steps", 'n', "N", 0, "How often the step part runs (default: 1)", 0},
    {"objects", 'o', "N", 0, "How many objects (default: all contexts of the configuration full)",
     0},
    {"visit", KEY_VISIT, "N", 0, "Steps per visit of an object (default: all)", 0},
    {"all", KEY_ALL, NULL, 0, "Print the states of all objects, not of the first 8", 0},
    {"params", KEY_PARAMS, "FILE", 0, "Values of states, parameters and shared constants", 0},
    {"set", KEY_SET, "NAME=VALUE", 0, "One such value; replaces what was given before it", 0},
    {"scene", KEY_SCENE, "FILE", 0,
     "Run the objects, programs and values of FILE instead of a PROGRAM; --config, --engine, "
     "--steps and --visit replace what it says",
     0},
    {"cycle-limit", KEY_LIMIT, "N", 0,
     "Stop after N clock cycles, with exit code 1 (default: none)", 0},
    {"bus-log", KEY_BUS_LOG, "FILE", 0, "Write every transfer on the host port to FILE", 0},
    {"kanata", KEY_KANATA, "FILE", 0, "Write the pipeline's log to FILE, for the viewer Konata", 0},
    {0},
};

static uint64_t number(struct argp_state *state, const char *option, const char *text,
                       uint64_t least, uint64_t most) {
    char *end;
    errno = 0;
    const uint64_t value = strtoull(text, &end, 10);
    if (errno || end == text || *end || *text < '0' || *text > '9' || value < least || value > most)
        argp_error(state, "%s: '%s' is no number from %" PRIu64 " to %" PRIu64, option, text, least,
                   most);
    return value;
}

/* What belongs to an image, and what to a scene. */
static void check(const options *o, struct argp_state *state) {
    if (!o->program && !o->scene)
        argp_error(state, "expected a program, or --scene FILE");
    if (o->program && o->scene)
        argp_error(state, "--scene: found '%s', but the scene names its programs itself",
                   o->program);
    if ((o->integrator || o->is_compensated) && !(o->program && fp3_program_is_model(o->program)))
        argp_error(state, "--integrator, --compensated: only a model (*.ode) is compiled");
    if (o->scene && o->objects)
        argp_error(state, "--scene: the scene says how many objects there are, not --objects");
    if (o->scene && fp3_params_count(o->params))
        argp_error(state, "--scene: values are in the scene, not in --params or --set");
    if (o->scene && o->kanata)
        argp_error(state, "--kanata: a log is of one program, not of a scene");
    if (o->kanata && o->engine && strcmp(o->engine, "rtl") != 0)
        argp_error(state, "--kanata: only the hardware, engine rtl, has a pipeline");
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    fp3_error error;
    switch (key) {
    case 'c':
        o->config = text;
        break;
    case 'e':
        o->engine = text;
        break;
    case 'o':
        o->objects = number(state, "--objects", text, 1, UINT32_MAX);
        break;
    case 'i':
        o->integrator = text;
        break;
    case 'k':
        o->is_compensated = 1;
        break;
    case KEY_VISIT:
        o->visit = number(state, "--visit", text, 1, UINT32_MAX);
        break;
    case KEY_ALL:
        o->all = 1;
        break;
    case KEY_KANATA:
        o->kanata = text;
        break;
    case 'n':
        o->steps = number(state, "--steps", text, 0, UINT64_MAX);
        o->has_steps = 1;
        break;
    case KEY_SCENE:
        o->scene = text;
        break;
    case KEY_LIMIT:
        o->cycle_limit = number(state, "--cycle-limit", text, 0, UINT64_MAX);
        break;
    case KEY_BUS_LOG:
        o->bus_log = text;
        break;
    case KEY_PARAMS:
        if (fp3_params_load(o->params, text, &error))
            argp_failure(state, 2, 0, "%s", error.text);
        break;
    case KEY_SET:
        if (fp3_params_set(o->params, text, &error))
            argp_failure(state, 2, 0, "%s", error.text);
        break;
    case ARGP_KEY_ARG:
        if (o->program)
            argp_error(state, "found '%s', expected one program", text);
        o->program = text;
        break;
    case ARGP_KEY_END:
        check(o, state);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void print_state(fp3_engine *engine, const fp3_symbol *symbol, size_t object, int is_slept) {
    union {
        float value;
        uint32_t bits;
    } word;
    if (fp3_engine_read(engine, object, 1, symbol->index, &word.value))
        return;
    if (is_slept)
        printf("%-16s %-16" PRIu32, symbol->name, word.bits);
    else
        printf("%-16s %-16.9g", symbol->name, (double)word.value);
    printf(" 0x%08" PRIx32 "   object %zu\n", word.bits, object);
}

/* The objects of one program. */
typedef struct {
    const fp3_image *image;
    size_t first, objects;
} part;

static void print_states(fp3_engine *engine, const part *of, int all) {
    const int slept = fp3_image_slept(of->image);
    const size_t shown = all || of->objects < SHOWN ? of->objects : SHOWN;
    for (size_t n = 0; n < shown; n++)
        for (uint32_t i = 0; i < of->image->symbol_count; i++)
            if (of->image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
                print_state(engine, &of->image->symbols[i], of->first + n,
                            (int)of->image->symbols[i].index == slept);
    if (shown < of->objects)
        printf("%-16s %zu objects, which --all prints\n", "more", of->objects - shown);
}

/* How many objects sleep, and since which steps; how many met an invalid or an overflow. */
static void print_status(fp3_engine *engine, const part *of) {
    size_t asleep = 0, failed = 0, first = 0;
    uint32_t begin = UINT32_MAX, end = 0, step = UINT32_MAX;
    for (size_t i = of->first; i < of->first + of->objects; i++) {
        fp3_object_status status;
        if (fp3_engine_status(engine, i, 1, &status))
            return;
        if (status.slept && status.slept != FP3_REMOVED) {
            asleep++;
            begin = status.slept < begin ? status.slept : begin;
            end = status.slept > end ? status.slept : end;
        }
        if (status.failed && status.failed < step) {
            step = status.failed;
            first = i;
        }
        failed += status.failed != 0;
    }
    if (fp3_image_slept(of->image) >= 0)
        printf("%-16s %zu of %zu", "asleep", asleep, of->objects);
    if (asleep)
        printf(", since steps %" PRIu32 " to %" PRIu32, begin, end);
    if (fp3_image_slept(of->image) >= 0)
        putchar('\n');
    if (failed)
        printf("%-16s %zu of %zu: invalid or overflow, first in step %" PRIu32 ", object %zu\n",
               "failed", failed, of->objects, step, first);
}

static void print_occupancy(fp3_engine *engine, const fp3_stats *stats) {
    for (uint32_t scheduler = 0; scheduler < stats->schedulers; scheduler++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        if (!fp3_engine_scheduler_counters(engine, scheduler, counter))
            fp3_occupancy_print(stdout, scheduler, counter);
    }
}

static void print_cost(const fp3_stats *stats) {
    static const char *const flags[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    printf("%-16s %" PRIu64 "\n", "object_steps", stats->object_steps);
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        printf("%-16s %" PRIu64 "\n", fp3_counter_name((fp3_counter)i), stats->counter[i]);
    printf("%-16s%s", "flags", stats->flags ? "" : " none");
    for (int i = 4; i >= 0; i--)
        if (stats->flags >> i & 1)
            printf(" %s", flags[i]);
    putchar('\n');
    printf("%-16s %.0f\n", "cycles/second",
           stats->seconds > 0 ? (double)stats->counter[FP3_COUNTER_CYCLES] / stats->seconds : 0.0);
}

static void print_group(fp3_engine *engine, const fp3_scene *scene, size_t number, int all) {
    const fp3_scene_group *group = &scene->groups[number];
    const part of = {group->program->image, group->first, group->objects};
    printf("group %-10zu %s, objects %zu to %zu\n", number, group->path, group->first,
           group->first + group->objects - 1);
    print_states(engine, &of, all);
    print_status(engine, &of);
    printf("%-16s %" PRIu64 "\n\n", "object_steps", fp3_engine_group_steps(engine, number));
}

/* Whose cycles each scheduler spent, and how long the first to end waited for the last. */
static void print_balance(fp3_engine *engine, const fp3_stats *stats) {
    uint64_t least = UINT64_MAX, most = 0;
    printf("balance of schedulers\n");
    for (uint32_t scheduler = 0; scheduler < stats->schedulers; scheduler++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        fp3_scheduler_share share;
        if (fp3_engine_scheduler_counters(engine, scheduler, counter) ||
            fp3_engine_scheduler_share(engine, scheduler, &share))
            return;
        const uint64_t cycles = counter[FP3_COUNTER_CYCLES];
        printf("  scheduler %-8" PRIu32 " %12" PRIu64 "  group %zu, %zu objects\n", scheduler,
               cycles, share.group, share.objects);
        least = cycles < least ? cycles : least;
        most = cycles > most ? cycles : most;
    }
    printf("  %-18s %12.1f %%\n", "imbalance",
           most ? 100.0 * (double)(most - least) / (double)most : 0.0);
}

/* What is run: a program, or a scene. */
typedef struct {
    const fp3_program *program;
    const fp3_scene *scene;
} task;

/* A run that ended before its time has a state, too. */
static void print(fp3_engine *engine, const task *of, const fp3_engine_def *def,
                  const fp3_stats *stats, int all) {
    const int is_rtl = strcmp(def->engine, "rtl") == 0;
    if (of->program) {
        const part objects = {of->program->image, 0, fp3_engine_objects(engine)};
        print_states(engine, &objects, all);
        print_status(engine, &objects);
    }
    for (size_t i = 0; of->scene && i < of->scene->group_count; i++)
        print_group(engine, of->scene, i, all);
    print_cost(stats);
    if (is_rtl)
        print_occupancy(engine, stats);
    if (is_rtl && of->scene)
        print_balance(engine, stats);
}

/* *has_run: it came as far. */
static fp3_status run(const options *o, const task *of, const fp3_engine_def *def, int *has_run,
                      fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_stats stats;
    fp3_status status = fp3_engine_open(def, &engine);
    if (!status)
        status = of->scene ? fp3_scene_load(of->scene, engine, error)
                           : fp3_program_load(of->program, o->params, engine, error);
    if (!status) {
        status = fp3_engine_run(engine, o->steps, &stats);
        const fp3_error why = *error; /* printing reads registers, which may fail as well */
        *has_run = !status || status == FP3_E_LIMIT || status == FP3_E_PROGRAM;
        if (*has_run)
            print(engine, of, def, &stats, o->all);
        *error = why;
    }
    fp3_engine_close(&engine);
    return status;
}

/* With the pipeline's log, if that is asked for; of a run that ended before its time, too. */
static fp3_status run_and_log(const options *o, const task *of, fp3_engine_def *def,
                              fp3_error *error) {
    fp3_kanata *kanata = NULL;
    if (o->kanata) {
        fp3_status status =
            fp3_kanata_open(o->kanata, def->config, of->program->image, &kanata, error);
        if (status)
            return status;
        def->trace = fp3_kanata_trace;
        def->trace_user = kanata;
    }
    fp3_error other;
    int has_run = 0;
    fp3_status status = run(o, of, def, &has_run, error);
    fp3_status logged = has_run ? fp3_kanata_close(&kanata, &other) : FP3_OK;
    fp3_kanata_free(&kanata);
    if (status || !logged)
        return status;
    *error = other;
    return logged;
}

/* What both have. */
static void define(const options *o, fp3_engine_def *def, fp3_error *error) {
    def->engine = o->engine ? o->engine : def->engine;
    def->visit = o->visit ? (uint32_t)o->visit : def->visit;
    def->cycle_limit = o->cycle_limit;
    def->bus_log = o->bus_log;
    def->error = error;
}

static fp3_status run_program(const options *o, fp3_error *error) {
    fp3_program_def how = fp3_program_default();
    fp3_engine_def def = fp3_engine_default();
    fp3_program *program = NULL;
    def.config = o->config                          ? o->config
                 : fp3_program_is_model(o->program) ? how.compile.config
                                                    : def.config;
    how.compile.config = def.config;
    how.compile.is_compensated = o->is_compensated;
    how.integrator = o->integrator ? o->integrator : how.integrator;
    def.objects = (uint32_t)o->objects;
    define(o, &def, error);
    fp3_status status = fp3_program_open(o->program, &how, &program, NULL, error);
    if (!status)
        status = run_and_log(o, &(task){.program = program}, &def, error);
    fp3_program_close(&program);
    return status;
}

/* Where the options say nothing, the scene does. */
static fp3_status run_scene(options *o, fp3_error *error) {
    fp3_scene *scene = NULL;
    int has_run = 0;
    fp3_status status = fp3_scene_open(o->scene, o->config, &scene, error);
    if (status)
        return status;
    fp3_engine_def def = fp3_scene_engine(scene);
    o->steps = o->has_steps ? o->steps : scene->steps;
    define(o, &def, error);
    status = run(o, &(task){.scene = scene}, &def, &has_run, error);
    fp3_scene_close(&scene);
    return status;
}

int fp3_cmd_run(int argc, char **argv) {
    options o = {.steps = 1};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "PROGRAM\n--scene FILE",
        .doc =
            "Runs PROGRAM (an image, assembly *.s, or a model *.ode, which is compiled): its first "
            "part once, its step part N times, its last part once, for every object. Prints the "
            "final states and what the run cost. A scene has several programs, each for objects of "
            "its own."};
    fp3_error error = {""};
    fp3_status status = fp3_params_make(&o.params, &error);
    if (!status) {
        argp_parse(&argp, argc, argv, 0, NULL, &o);
        status = o.scene ? run_scene(&o, &error) : run_program(&o, &error);
    }
    fp3_params_free(&o.params);
    return fp3_cli_done("run", status ? fp3_cli_fail("run", status, &error) : 0);
}
