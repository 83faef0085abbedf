/* cmd_bench.c - fp3 bench: the ship on the hardware against golden and truth. The pairs of program
 * and configuration, the table, the JSON; ship_bench.c runs one pair.
 */
#include "cli.h"
#include "lib/file.h"
#include "params.h"
#include "ship_bench.h"

#include <argp.h>
#include <configs.h>
#include <errno.h>
#include <fp3/asm.h>
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

typedef struct {
    const char *config, *program, *params, *json;
    uint64_t steps; /* after the first */
} options;

/* ---- what is told ---- */

/* Of a counter, what each step after the first adds. */
static double per_step(const fp3_ship_result *r, fp3_counter counter) {
    return ((double)r->all.counter[counter] - (double)r->one.counter[counter]) /
           (double)(r->steps - 1);
}

static double rate(const fp3_ship_result *r) {
    return r->all.seconds > 0 ? (double)r->all.counter[FP3_COUNTER_CYCLES] / r->all.seconds : 0;
}

static void print_head(const options *o) {
    printf("The ship of Equations (1), one integration and %" PRIu64 " more.\n\n", o->steps);
    printf("%-24s %7s %9s %7s", "program, config", "first", "next", "issue");
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10s", fp3_counter_name((fp3_counter)i) + strlen("stall_"));
    printf(" %9s %9s %9s\n", "error v", "error s", "cycles/s");
    printf("%-24s %7d %9d\n", "the paper", PAPER_FIRST, PAPER_NEXT);
}

static void print_result(const fp3_ship_result *r) {
    char name[64];
    snprintf(name, sizeof name, "%s, %s", r->program, r->config);
    printf("%-24s %7" PRIu64 " %9.9g %7.9g", name, r->one.counter[FP3_COUNTER_CYCLES],
           per_step(r, FP3_COUNTER_CYCLES),
           per_step(r, FP3_COUNTER_ISSUED_ADD) + per_step(r, FP3_COUNTER_ISSUED_MUL) +
               per_step(r, FP3_COUNTER_ISSUED_CHAIN));
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            printf(" %10.9g", per_step(r, (fp3_counter)i));
    printf(" %9.2e %9.2e %9.2e  mismatches %" PRIu64 " of %" PRIu64 " words\n", r->rel_err_v,
           r->rel_err_s, rate(r), r->mismatches, r->words);
    fflush(stdout);
}

static json_t *to_json(const fp3_ship_result *r) {
    json_t *stalls = json_object(), *object = json_object();
    const uint64_t added = r->all.counter[FP3_COUNTER_CYCLES] - r->one.counter[FP3_COUNTER_CYCLES];
    const double next = per_step(r, FP3_COUNTER_CYCLES);
    json_object_set_new(object, "config", json_string(r->config));
    json_object_set_new(object, "program", json_string(r->program));
    json_object_set_new(object, "first_cycles",
                        json_integer((json_int_t)r->one.counter[FP3_COUNTER_CYCLES]));
    json_object_set_new(object, "next_cycles",
                        added % (r->steps - 1) ? json_real(next) : json_integer((json_int_t)next));
    json_object_set_new(object, "objects", json_integer((json_int_t)r->objects));
    json_object_set_new(object, "steps", json_integer((json_int_t)r->steps));
    json_object_set_new(object, "words", json_integer((json_int_t)r->words));
    json_object_set_new(object, "mismatches", json_integer((json_int_t)r->mismatches));
    json_object_set_new(object, "rel_err_v", json_real(r->rel_err_v));
    json_object_set_new(object, "rel_err_s", json_real(r->rel_err_s));
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        if (fp3_counter_is_stall((fp3_counter)i))
            json_object_set_new(stalls, fp3_counter_name((fp3_counter)i) + strlen("stall_"),
                                json_integer((json_int_t)r->all.counter[i]));
        else
            json_object_set_new(object, fp3_counter_name((fp3_counter)i),
                                json_integer((json_int_t)r->all.counter[i]));
    json_object_set_new(object, "stalls", stalls);
    json_object_set_new(object, "cycles_per_second", json_real(rate(r)));
    return object;
}

static fp3_status write_json(const char *path, json_t *runs, fp3_error *error) {
    char folder[4096];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
        if (*folder && mkdir(folder, 0777) && errno != EEXIST)
            return fp3_fail(error, FP3_E_SYSTEM, "%s: %s", folder, strerror(errno));
    }
    json_t *root = json_pack("{s:O}", "runs", runs);
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) : NULL;
    json_decref(root);
    if (!text)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory, or a figure that is no number");
    fp3_status status = fp3_file_write(path, text, strlen(text), error);
    free(text);
    return status;
}

/* ---- the table of runs ---- */

static const char *const configs[] = {
#define X(name, ...) #name,
    FP3_CONFIGS(X)
#undef X
};

static fp3_status assemble(const char *path, fp3_assembly **assembly, fp3_error *error) {
    char *text;
    size_t size;
    fp3_status status = fp3_file_read(path, &text, &size, error);
    if (status)
        return status;
    status = fp3_assemble(text, size, path, assembly, error);
    free(text);
    return status;
}

/* All configurations that are asked for. A pair that was asked for by name must be possible. */
static fp3_status bench_program(const options *o, const char *path, fp3_params *params,
                                json_t *runs, fp3_error *mismatch, fp3_error *error) {
    char program[64];
    const char *base = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    snprintf(program, sizeof program, "%.*s", (int)strcspn(base, "."), base);
    fp3_assembly *assembly = NULL;
    fp3_status status = assemble(path, &assembly, error);
    for (size_t i = 0; i < sizeof configs / sizeof *configs && !status; i++) {
        if (o->config && strcmp(o->config, configs[i]) != 0)
            continue;
        fp3_ship_result r = {.config = configs[i], .program = program, .steps = o->steps + 1};
        int is_unfit = 0;
        status = fp3_ship_bench(assembly->image, params, &r, &is_unfit, error);
        if (is_unfit && !(o->config && o->program)) {
            printf("%s, %s: left out: %s\n", program, configs[i], error->text);
            status = FP3_OK;
            continue;
        }
        if (status) {
            const fp3_error why = *error;
            fp3_fail(error, status, "%s, %s: %s", program, configs[i], why.text);
            break;
        }
        print_result(&r);
        json_array_append_new(runs, to_json(&r));
        if (r.mismatches && !mismatch->text[0])
            fp3_fail(mismatch, FP3_E_MISMATCH, "%s, %s: %s", program, configs[i], r.mismatch.text);
    }
    fp3_assembly_free(&assembly);
    return status;
}

static fp3_status bench(const options *o, fp3_error *error) {
    char pattern[4096];
    if (!o->program)
        snprintf(pattern, sizeof pattern, "%s", PROGRAMS);
    else if (strchr(o->program, '/'))
        snprintf(pattern, sizeof pattern, "%s", o->program);
    else
        snprintf(pattern, sizeof pattern, "programs/%s.s", o->program);

    fp3_engine *probe = NULL; /* says so, and which there are, if there is no such configuration */
    fp3_engine_def def = fp3_engine_default();
    def.error = error;
    def.config = o->config ? o->config : def.config;
    fp3_status status = fp3_engine_open(&def, &probe);
    fp3_engine_close(&probe);
    if (status)
        return status;

    fp3_params params = {0};
    json_t *runs = json_array();
    fp3_error mismatch = {""};
    glob_t paths = {0};
    status = fp3_params_load(&params, o->params, error);
    if (!status && glob(pattern, 0, NULL, &paths))
        status = fp3_fail(error, FP3_E_ARGUMENT, "no program %s", pattern);
    if (!status)
        print_head(o);
    for (size_t i = 0; i < paths.gl_pathc && !status; i++)
        status = bench_program(o, paths.gl_pathv[i], &params, runs, &mismatch, error);
    if (!status && json_array_size(runs) == 0)
        status =
            fp3_fail(error, FP3_E_ARGUMENT, "no configuration asked for can execute %s", pattern);
    if (!status)
        status = write_json(o->json, runs, error);
    if (!status && mismatch.text[0])
        status = fp3_fail(error, FP3_E_MISMATCH, "%s", mismatch.text);
    globfree(&paths);
    json_decref(runs);
    fp3_params_free(&params);
    return status;
}

static const struct argp_option table[] = {
    {"config", 'c', "NAME", 0, "One configuration (default: all)", 0},
    {"program", 'p', "NAME", 0, "programs/NAME.s, or a path with a / (default: " PROGRAMS ")", 0},
    {"steps", 'n', "N", 0, "Integrations after the first (default: 10000)", 0},
    {"params", 'P', "FILE", 0, "The ship (default: programs/ship.cfg)", 0},
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
