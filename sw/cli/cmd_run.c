/* cmd_run.c - fp3 run: a program image on an engine, from the host's values to the final ones. */
#include "cli.h"
#include "params.h"

#include <argp.h>
#include <errno.h>
#include <fp3/engine.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    const char *image, *config, *engine, *bus_log;
    uint64_t steps, cycle_limit;
    fp3_params params;
} options;

enum { KEY_SET = 256, KEY_PARAMS, KEY_LIMIT, KEY_BUS_LOG };

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "Configuration (default: single)", 0},
    {"engine", 'e', "KIND", 0,
     "rtl, the hardware under Verilator (default), or model, the instruction set in C", 0},
    {"steps", 'n', "N", 0, "How often the step part runs (default: 1)", 0},
    {"params", KEY_PARAMS, "FILE", 0, "Values of states, parameters and shared constants", 0},
    {"set", KEY_SET, "NAME=VALUE", 0, "One such value; replaces what was given before it", 0},
    {"cycle-limit", KEY_LIMIT, "N", 0,
     "Stop after N clock cycles, with exit code 1 (default: none)", 0},
    {"bus-log", KEY_BUS_LOG, "FILE", 0, "Write every transfer on the host port to FILE", 0},
    {0},
};

static uint64_t number(struct argp_state *state, const char *option, const char *text) {
    char *end;
    errno = 0;
    const uint64_t value = strtoull(text, &end, 10);
    if (errno || end == text || *end || *text < '0' || *text > '9')
        argp_error(state, "%s: '%s' is no number from 0 to 2^64 - 1", option, text);
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
    case 'n':
        o->steps = number(state, "--steps", text);
        break;
    case KEY_LIMIT:
        o->cycle_limit = number(state, "--cycle-limit", text);
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
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* A run that ended before its time has a state, too. */
static void print(fp3_engine *engine, const fp3_image *image, const fp3_stats *stats) {
    static const char *const flags[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    for (size_t object = 0; object < fp3_engine_objects(engine); object++)
        for (uint32_t i = 0; i < image->symbol_count; i++) {
            const fp3_symbol *symbol = &image->symbols[i];
            union {
                float value;
                uint32_t bits;
            } word;
            if (symbol->kind == FP3_SYMBOL_STATE &&
                !fp3_engine_read(engine, object, 1, symbol->index, &word.value))
                printf("%-16s %-16.9g 0x%08" PRIx32 "   object %zu\n", symbol->name,
                       (double)word.value, word.bits, object);
        }
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

int fp3_cmd_run(int argc, char **argv) {
    options o = {.steps = 1, .config = "single", .engine = "rtl"};
    const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "IMAGE",
        .doc = "Runs IMAGE: its first part once, its step part N times, its last part once. Prints "
               "the final states and what the run cost."};
    argp_parse(&argp, argc, argv, 0, NULL, &o);

    fp3_error error = {""};
    fp3_image *image = NULL;
    fp3_engine *engine = NULL;
    fp3_stats stats;
    fp3_engine_def def = fp3_engine_default();
    def.kind = o.engine;
    def.config = o.config;
    def.cycle_limit = o.cycle_limit;
    def.bus_log = o.bus_log;
    def.error = &error;
    fp3_status status;
    if (!(status = fp3_image_load(o.image, &image, &error)) &&
        !(status = fp3_engine_open(&def, &engine)) && !(status = fp3_engine_load(engine, image)) &&
        !(status = fp3_params_apply(&o.params, engine, image, &error))) {
        status = fp3_engine_run(engine, o.steps, &stats);
        const fp3_error why = error; /* printing reads registers, which may fail as well */
        if (!status || status == FP3_E_LIMIT || status == FP3_E_PROGRAM)
            print(engine, image, &stats);
        error = why;
    }
    fp3_engine_close(&engine);
    fp3_image_free(&image);
    fp3_params_free(&o.params);
    return fp3_cli_done("run", status ? fp3_cli_fail("run", status, &error) : 0);
}
