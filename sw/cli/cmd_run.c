/* cmd_run.c - fp3 run: a program image on an engine, from the host's values to the final ones. */
#include "cli.h"
#include "kanata.h"
#include "occupancy.h"
#include "params.h"

#include <argp.h>
#include <errno.h>
#include <fp3/engine.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN 8 /* objects whose states are printed without --all */

typedef struct {
    const char *image, *config, *engine, *bus_log, *kanata;
    uint64_t steps, cycle_limit, objects, visit;
    int all;
    fp3_params params;
} options;

enum { KEY_SET = 256, KEY_PARAMS, KEY_LIMIT, KEY_BUS_LOG, KEY_VISIT, KEY_KANATA, KEY_ALL };

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "Configuration (default: single)", 0},
    {"engine", 'e', "KIND", 0,
     "rtl, the hardware under Verilator (default), or model, the instruction set in C", 0},
    {"steps", 'n', "N", 0, "How often the step part runs (default: 1)", 0},
    {"objects", 'o', "N", 0, "How many objects (default: all contexts of the configuration full)",
     0},
    {"visit", KEY_VISIT, "N", 0, "Steps per visit of an object (default: all)", 0},
    {"all", KEY_ALL, NULL, 0, "Print the states of all objects, not of the first 8", 0},
    {"params", KEY_PARAMS, "FILE", 0, "Values of states, parameters and shared constants", 0},
    {"set", KEY_SET, "NAME=VALUE", 0, "One such value; replaces what was given before it", 0},
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
        break;
    case KEY_LIMIT:
        o->cycle_limit = number(state, "--cycle-limit", text, 0, UINT64_MAX);
        break;
    case KEY_BUS_LOG:
        o->bus_log = text;
        break;
    case KEY_PARAMS:
        if (fp3_params_load(&o->params, text, &error))
            argp_failure(state, 2, 0, "%s", error.text);
        break;
    case KEY_SET:
        if (fp3_params_set(&o->params, text, &error))
            argp_failure(state, 2, 0, "%s", error.text);
        break;
    case ARGP_KEY_ARG:
        if (o->image)
            argp_error(state, "found '%s', expected one image", text);
        o->image = text;
        break;
    case ARGP_KEY_END:
        if (!o->image)
            argp_error(state, "expected an image");
        if (o->kanata && strcmp(o->engine, "rtl") != 0)
            argp_error(state, "--kanata: only the hardware, engine rtl, has a pipeline");
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

static void print_states(fp3_engine *engine, const fp3_image *image, int all) {
    const int slept = fp3_image_slept(image);
    const size_t objects = fp3_engine_objects(engine);
    const size_t shown = all || objects < SHOWN ? objects : SHOWN;
    for (size_t object = 0; object < shown; object++)
        for (uint32_t i = 0; i < image->symbol_count; i++)
            if (image->symbols[i].kind == FP3_SYMBOL_STATE)
                print_state(engine, &image->symbols[i], object,
                            (int)image->symbols[i].index == slept);
    if (shown < objects)
        printf("%-16s %zu objects, which --all prints\n", "more", objects - shown);
}

/* How many objects sleep, and since which steps; how many met an invalid or an overflow. */
static void print_status(fp3_engine *engine, const fp3_image *image) {
    const size_t objects = fp3_engine_objects(engine);
    size_t asleep = 0, failed = 0, first = 0;
    uint32_t begin = UINT32_MAX, end = 0, step = UINT32_MAX;
    for (size_t i = 0; i < objects; i++) {
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
    if (fp3_image_slept(image) >= 0)
        printf("%-16s %zu of %zu", "asleep", asleep, objects);
    if (asleep)
        printf(", since steps %" PRIu32 " to %" PRIu32, begin, end);
    if (fp3_image_slept(image) >= 0)
        putchar('\n');
    if (failed)
        printf("%-16s %zu of %zu: invalid or overflow, first in step %" PRIu32 ", object %zu\n",
               "failed", failed, objects, step, first);
}

static void print_occupancy(fp3_engine *engine, const fp3_stats *stats) {
    for (uint32_t unit = 0; unit < stats->units; unit++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        if (!fp3_engine_unit_counters(engine, unit, counter))
            fp3_occupancy_print(stdout, unit, counter);
    }
}

/* A run that ended before its time has a state, too. */
static void print(fp3_engine *engine, const fp3_image *image, const fp3_stats *stats,
                  const options *o) {
    static const char *const flags[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    print_states(engine, image, o->all);
    print_status(engine, image);
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
    if (strcmp(o->engine, "rtl") == 0)
        print_occupancy(engine, stats);
}

/* Opens, runs, prints; def has the rest of what the options say. *has_run: it came as far. */
static fp3_status run(options *o, const fp3_image *image, fp3_engine_def *def, int *has_run,
                      fp3_error *error) {
    fp3_engine *engine = NULL;
    fp3_stats stats;
    def->kind = o->engine;
    def->config = o->config;
    def->cycle_limit = o->cycle_limit;
    def->objects = (uint32_t)o->objects;
    def->visit = (uint32_t)o->visit;
    def->bus_log = o->bus_log;
    def->error = error;
    fp3_status status = fp3_engine_open(def, &engine);
    if (!status)
        status = fp3_engine_load(engine, image);
    if (!status)
        status = fp3_params_apply(&o->params, engine, image, error);
    if (!status) {
        status = fp3_engine_run(engine, o->steps, &stats);
        const fp3_error why = *error; /* printing reads registers, which may fail as well */
        *has_run = !status || status == FP3_E_LIMIT || status == FP3_E_PROGRAM;
        if (*has_run)
            print(engine, image, &stats, o);
        *error = why;
    }
    fp3_engine_close(&engine);
    return status;
}

/* With the pipeline's log, if that is asked for; of a run that ended before its time, too. */
static fp3_status run_and_log(options *o, const fp3_image *image, fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    fp3_kanata *kanata = NULL;
    if (o->kanata) {
        fp3_status status = fp3_kanata_open(o->kanata, o->config, image, &kanata, error);
        if (status)
            return status;
        def.issue = fp3_kanata_issue;
        def.retire = fp3_kanata_retire;
        def.issue_user = def.retire_user = kanata;
    }
    fp3_error other;
    int has_run = 0;
    fp3_status status = run(o, image, &def, &has_run, error);
    fp3_status logged = has_run ? fp3_kanata_close(&kanata, &other) : FP3_OK;
    fp3_kanata_free(&kanata);
    if (status || !logged)
        return status;
    *error = other;
    return logged;
}

int fp3_cmd_run(int argc, char **argv) {
    options o = {.steps = 1, .config = "single", .engine = "rtl"};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "IMAGE",
        .doc =
            "Runs IMAGE: its first part once, its step part N times, its last part once, for every "
            "object. Prints the final states and what the run cost."};
    argp_parse(&argp, argc, argv, 0, NULL, &o);

    fp3_error error = {""};
    fp3_image *image = NULL;
    fp3_status status = fp3_image_load(o.image, &image, &error);
    if (!status)
        status = run_and_log(&o, image, &error);
    fp3_image_free(&image);
    fp3_params_free(&o.params);
    return fp3_cli_done("run", status ? fp3_cli_fail("run", status, &error) : 0);
}
