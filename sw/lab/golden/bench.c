/* SPDX-License-Identifier: Apache-2.0 */
/* bench.c - see bench.h. */
#include "bench.h"
#include "base/bits.h"
#include "engine/common/inside.h"

#include "machine/format.h"

#include "ship.h"
#include <base/fpu.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <machine/operation.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CYCLES_PER_STEP 100000 /* of all contexts: no program needs as many, it hangs */
#define PARAM_APART 0.001      /* from one object to the next, of the first one's ... */
#define STATE_APART 0.25       /* ... or this at the start, where all params are shared */

typedef struct {
    const fp3_bench_case *what;
    fp3_bench_result *result;
    fp3_params *params; /* the caller's, and what the benchmark sets */
    const fp3_image *image;
    int is_ship;
    fp3_engine *rtl, *isa;        /* isa: NULL for a ship */
    fp3_written *of_rtl, *of_isa; /* what they write */
    uint32_t *golden[2];          /* ship: of v and s, [steps + 1] words of each object */
    const fp3_symbol *own;        /* what differs from object to object ... */
    float *values;                /* ... and what it is */
    uint64_t visit;               /* steps of one */
    int is_interleaved;
} bench;

/* ---- which program it is ---- */

static const fp3_symbol *find(const fp3_image *image, const char *name, fp3_symbol_class of) {
    return fp3_image_find(image, name, FP3_CLASS(of));
}

int fp3_bench_is_ship(const fp3_program *program) {
    static const char *const values[] = {"T", "C", "rm", "h"};
    const fp3_image *image = program->image;
    int is_ship =
        !program->model && find(image, "v", FP3_SYMBOL_STATE) && find(image, "s", FP3_SYMBOL_STATE);
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        is_ship = is_ship && fp3_image_find(image, values[i], FP3_CLASSES_HOST);
    return is_ship;
}

static const fp3_symbol *own_of(const fp3_image *image) {
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_PARAM)
            return &image->symbols[i];
    return fp3_bench_state(image, 0);
}

/* ---- what is compared ---- */

/* Whether it is the first word that differs, so that it has to be told. */
static int is_first(bench *b, uint32_t got, uint32_t expected) {
    b->result->words++;
    return got != expected && b->result->mismatches++ == 0;
}

static void tell(bench *b, const char *where, uint32_t got, const char *who, uint32_t expected) {
    fp3_fail(&b->result->mismatch, FP3_E_MISMATCH,
             "%s is 0x%08" PRIx32 " (%.9g), %s has 0x%08" PRIx32 " (%.9g)", where, got,
             (double)fp3_value_of(got), who, expected, (double)fp3_value_of(expected));
}

static void compare_golden(bench *b, unsigned state, uint64_t object, uint64_t step,
                           const char *how, uint32_t got) {
    const uint32_t golden = b->golden[state][object * (b->what->steps + 1) + step];
    char where[128];
    if (!is_first(b, got, golden))
        return;
    snprintf(where, sizeof where, "object %" PRIu64 ", step %" PRIu64 ": %s as %s", object, step,
             fp3_bench_state(b->image, state)->name, how);
    tell(b, where, got, "golden", golden);
}

static void compare_isa(bench *b, unsigned state, uint64_t object, const char *how, uint64_t number,
                        uint32_t got, uint32_t expected) {
    char where[128];
    if (!is_first(b, got, expected))
        return;
    snprintf(where, sizeof where, "object %" PRIu64 ", %s %" PRIu64 ": %s", object, how, number,
             fp3_bench_state(b->image, state)->name);
    tell(b, where, got, "the isa engine", expected);
}

static fp3_status wrong_count(uint64_t object, const char *name, uint64_t writes, uint64_t steps,
                              fp3_error *error) {
    return fp3_fail(error, FP3_E_MISMATCH,
                    "object %" PRIu64 ": %s was written %" PRIu64 " times in %" PRIu64 " steps",
                    object, name, writes, steps);
}

/* The words of all visits of an object that made so many steps. */
static fp3_status compare_visits(bench *b, unsigned state, uint64_t object, uint64_t steps,
                                 fp3_error *error) {
    uint64_t writes;
    const uint32_t *written = fp3_written_of(b->of_rtl, state, object, &writes);
    const uint64_t visits = (steps + b->visit - 1) / b->visit;
    const uint64_t least = steps + (b->is_interleaved ? visits : 0);
    if (writes != least && writes != least + visits)
        return wrong_count(object, fp3_bench_state(b->image, state)->name, writes, steps, error);
    const uint64_t again = visits ? (writes - steps) / visits : 0;
    for (uint64_t begin = 0; begin < steps; begin += b->visit) {
        const uint64_t end = steps - begin < b->visit ? steps : begin + b->visit;
        for (uint64_t i = 0; i < again; i++)
            compare_golden(b, state, object, begin, "first written", *written++);
        for (uint64_t step = begin + 1; step <= end; step++)
            compare_golden(b, state, object, step, "written", *written++);
    }
    return FP3_OK;
}

/* The words of two engines. */
static fp3_status compare_writes(bench *b, unsigned state, uint64_t object, uint64_t steps,
                                 fp3_error *error) {
    const char *name = fp3_bench_state(b->image, state)->name;
    uint64_t writes, expected;
    const uint32_t *got = fp3_written_of(b->of_rtl, state, object, &writes);
    const uint32_t *wanted = fp3_written_of(b->of_isa, state, object, &expected);
    if (writes != expected || writes > fp3_written_room(b->of_rtl))
        return wrong_count(object, name, writes, steps, error);
    for (uint64_t i = 0; i < writes; i++)
        compare_isa(b, state, object, "write", i, got[i], wanted[i]);
    return FP3_OK;
}

static fp3_status compare_end(bench *b, unsigned state, uint64_t object, uint64_t steps) {
    const uint32_t reg = fp3_bench_state(b->image, state)->index;
    float last, wanted;
    fp3_status status = fp3_engine_read(b->rtl, object, 1, reg, &last);
    if (!status && b->is_ship)
        compare_golden(b, state, object, steps, "read back", fp3_bits_of(last));
    if (status || b->is_ship)
        return status;
    status = fp3_engine_read(b->isa, object, 1, reg, &wanted);
    if (!status)
        compare_isa(b, state, object, "after step", steps, fp3_bits_of(last), fp3_bits_of(wanted));
    return status;
}

static fp3_status compare(bench *b, uint64_t object, uint64_t steps, fp3_error *error) {
    fp3_object_status about = {0};
    fp3_status status = fp3_engine_status(b->rtl, object, 1, &about);
    if (about.slept)
        steps = about.slept == FP3_REMOVED ? 0 : about.slept;
    for (unsigned i = 0; !status && fp3_bench_state(b->image, i); i++) {
        status = b->is_ship ? compare_visits(b, i, object, steps, error)
                            : compare_writes(b, i, object, steps, error);
        if (!status)
            status = compare_end(b, i, object, steps);
    }
    return status;
}

/* ---- what is expected ---- */

static fp3_status fill_golden(bench *b, uint64_t object, fp3_error *error) {
    const uint64_t steps = b->what->steps, begin = object * (steps + 1);
    const char *const names[] = {"T", "C", "rm", "h", "v", "s"};
    float x[6];
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < 6; i++) {
        double value = 0;
        status = fp3_params_get(b->params, names[i], &value, error);
        x[i] = strcmp(b->own->name, names[i]) ? (float)value : b->values[object];
    }
    if (status)
        return status;
    const fp3_ship ship = {.T = x[0], .C = x[1], .rm = x[2], .h = x[3]};
    const uint64_t callers = fp3_fpu_begin(fp3_config_find(b->what->config)->nearest != 0);
    for (uint64_t step = 0; step <= steps; step++) {
        if (step)
            fp3_ship_step(&ship, &x[4], &x[5]);
        for (unsigned i = 0; i < 2; i++)
            b->golden[i][begin + step] =
                fp3_bits_of(x[strcmp(fp3_bench_state(b->image, i)->name, "v") ? 5 : 4]);
    }
    fp3_fpu_set(callers);
    return FP3_OK;
}

static fp3_status expect_ship(bench *b, fp3_error *error) {
    const size_t words = b->result->objects * (b->what->steps + 1);
    fp3_status status = FP3_OK;
    for (int i = 0; i < 2; i++)
        if (!(b->golden[i] = malloc(words * sizeof *b->golden[i])))
            return fp3_no_memory(error);
    for (uint64_t i = 0; !status && i < b->result->objects; i++)
        status = fill_golden(b, i, error);
    return status;
}

/* ---- the error ---- */

static fp3_status value_or(const bench *b, const char *name, double otherwise, double *value,
                           fp3_error *error) {
    *value = otherwise;
    return fp3_params_has(b->params, name) ? fp3_params_get(b->params, name, value, error) : FP3_OK;
}

/* Where object 0 really is after all steps. */
static fp3_status find_truth(const bench *b, double *states, fp3_error *error) {
    const fp3_model *model = b->what->truth;
    double *params = calloc(model->param_count + 1u, sizeof *params), h = 0;
    double *initial = calloc(model->state_count + 1u, sizeof *initial);
    fp3_status status =
        params && initial ? value_or(b, "h", model->step, &h, error) : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        status = value_or(b, model->params[i].name, model->params[i].value, &params[i], error);
    for (uint32_t i = 0; !status && i < model->state_count; i++)
        status = value_or(b, model->states[i].name, model->states[i].value, &initial[i], error);
    if (!status)
        status = fp3_model_truth(model, params, initial, (double)(float)h * (double)b->what->steps,
                                 states, error);
    free(params);
    free(initial);
    return status;
}

static fp3_status measure_error(const bench *b, fp3_error *error) {
    const fp3_model *model = b->what->truth;
    double *truth = calloc(model->state_count + 1u, sizeof *truth);
    fp3_status status = truth ? find_truth(b, truth, error) : fp3_no_memory(error);
    const fp3_symbol *s;
    for (unsigned i = 0; !status && i < FP3_BENCH_STATES && (s = fp3_bench_state(b->image, i));
         i++) {
        const uint32_t of = fp3_model_state(model, s->name);
        float last;
        status = fp3_engine_read(b->rtl, 0, 1, s->index, &last);
        if (!status && of != FP3_NONE && truth[of] != 0)
            b->result->error[i] = fabs((double)last / truth[of] - 1);
    }
    free(truth);
    return status;
}

/* ---- a run ---- */

/* Of one step, what each functional unit has to do. */
static void count_uses(fp3_bench_result *r, const fp3_image *image) {
    for (uint32_t i = image->step; i < image->last; i++) {
        const unsigned path = image->decoded[i].of ? image->decoded[i].of->path : 0;
        r->issues++;
        r->adds += (path & FP3_UNIT_ADDER) != 0;
        r->muls += (path & FP3_UNIT_MULTIPLIER) != 0;
    }
}

/* Loads anew, so that steps are counted from 1 and everybody is awake; then removes those who shall
 * not be. */
static fp3_status set_objects(bench *b, fp3_engine *engine, fp3_error *error) {
    fp3_bench_result *r = b->result;
    fp3_status status = fp3_program_load(b->what->program, b->params, engine, error);
    if (!status && fp3_image_slept(b->image) >= 0)
        status = fp3_engine_wake(engine, 0, r->objects);
    r->awake = 0;
    for (uint64_t i = 0; i < r->objects && !status; i++) {
        status = fp3_engine_write(engine, i, 1, b->own->index, &b->values[i]);
        if (i % b->what->awake_of == 0)
            r->awake++;
        else if (!status)
            status = fp3_engine_remove(engine, i, 1);
    }
    return status;
}

static fp3_status note_failure(bench *b) {
    fp3_failure failure;
    fp3_status status = fp3_engine_failure(b->rtl, 0, b->result->objects, &failure);
    if (!status && failure.failed)
        fp3_engine_failure_text(b->rtl, &failure, b->result->failure);
    return status;
}

static fp3_status run(bench *b, uint64_t steps, fp3_stats *stats, fp3_error *error) {
    fp3_written_clear(b->of_rtl);
    fp3_status status = set_objects(b, b->rtl, error);
    if (!status)
        status = fp3_engine_run(b->rtl, steps, stats);
    if (!status && b->isa) {
        fp3_written_clear(b->of_isa);
        status = set_objects(b, b->isa, error);
        if (!status)
            status = fp3_engine_run(b->isa, steps, NULL);
    }
    for (uint64_t object = 0; object < b->result->objects && !status; object++)
        status = compare(b, object, steps, error);
    return status;
}

/* The caller's values. Where objects can sleep the limit is 0, which no change of speed is below:
 * all objects make all steps. */
static fp3_status copy_params(bench *b, fp3_error *error) {
    double eps;
    fp3_status status = fp3_params_copy(b->what->params, &b->params, error);
    if (!status && find(b->image, "eps", FP3_SYMBOL_SHARED) &&
        fp3_params_get(b->params, "eps", &eps, NULL))
        status = fp3_params_put(b->params, "eps", 0, error);
    return status;
}

static fp3_status open_engine(bench *b, const char *name, uint64_t room, fp3_written **written,
                              fp3_engine **engine, fp3_error *error) {
    const fp3_bench_case *what = b->what;
    fp3_engine_def def = fp3_engine_default();
    fp3_status status = fp3_written_make(b->image, room, written, error);
    def.engine = name;
    def.config = what->config;
    def.objects = what->objects;
    def.visit = what->visit;
    def.cycle_limit = CYCLES_PER_STEP * what->steps * (1 + what->objects / 100);
    def.retire = fp3_written_retire;
    def.retire_user = *written;
    def.error = error;
    if (!status)
        status = fp3_engine_open(&def, engine);
    return status ? status : fp3_written_size(*written, fp3_engine_objects(*engine), error);
}

/* After a load: the own values, out from that of the first object. */
static fp3_status spread(bench *b, fp3_error *error) {
    float base = 0;
    b->values = malloc(b->result->objects * sizeof *b->values);
    fp3_status status =
        b->values ? fp3_engine_read(b->rtl, 0, 1, b->own->index, &base) : fp3_no_memory(error);
    for (uint64_t i = 0; !status && i < b->result->objects; i++) {
        const double n = (double)i, first = (double)base;
        b->values[i] =
            (float)(b->own->symbol_class == FP3_SYMBOL_PARAM ? first * (1 + PARAM_APART * n)
                                                             : first + STATE_APART * n);
    }
    return status;
}

static fp3_status prepare(bench *b, int *is_unfit, fp3_error *error) {
    const uint64_t visits = (b->what->steps + b->visit - 1) / b->visit;
    const uint64_t room = b->what->steps * (b->is_ship ? 1 : 2) + 2 * visits + 2;
    fp3_status status = copy_params(b, error);
    if (!status)
        status = open_engine(b, "rtl", room, &b->of_rtl, &b->rtl, error);
    if (!status) {
        status = fp3_engine_need_counters(b->rtl, error);
        *is_unfit = status != FP3_OK;
    }
    if (!status && !b->is_ship)
        status = open_engine(b, "isa", room, &b->of_isa, &b->isa, error);
    if (status)
        return status;
    b->result->objects = fp3_engine_objects(b->rtl);
    status = fp3_program_load(b->what->program, b->params, b->rtl, error);
    *is_unfit = status == FP3_E_PROGRAM;
    if (!status)
        status = spread(b, error);
    if (!status && b->is_ship)
        status = expect_ship(b, error);
    return status;
}

static void close_bench(bench *b) {
    fp3_engine_close(&b->rtl);
    fp3_engine_close(&b->isa);
    fp3_written_free(&b->of_rtl);
    fp3_written_free(&b->of_isa);
    fp3_params_free(&b->params);
    free(b->golden[0]);
    free(b->golden[1]);
    free(b->values);
}

fp3_status fp3_bench_run(const fp3_bench_case *what, fp3_bench_result *result, int *is_unfit,
                         fp3_error *error) {
    const fp3_config *config = fp3_config_find(what->config);
    const fp3_image *image = what->program->image;
    bench b = {.what = what, .result = result, .image = image, .own = own_of(image)};
    *result = (fp3_bench_result){0};
    *is_unfit = 0;
    for (unsigned i = 0; i < FP3_BENCH_STATES; i++)
        result->error[i] = NAN;
    if (!config || !fp3_bench_state(image, 0))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        config ? "the program has no .state" : "no such configuration");
    if (fp3_adaptive_is(image))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "the program has adaptive steps, expected fixed ones: fp3 bench MODEL "
                        "measures both");
    b.is_ship = fp3_bench_is_ship(what->program) && fp3_format_is_float(config) && !config->storage;
    b.is_interleaved = config->interleave != 0;
    b.visit = b.is_interleaved && what->visit ? what->visit : what->steps;
    fp3_status status = prepare(&b, is_unfit, error);
    count_uses(result, image);
    if (!status)
        status = run(&b, 1, &result->one, error);
    if (!status)
        status = run(&b, what->steps, &result->all, error);
    if (!status)
        status = note_failure(&b);
    if (!status && what->truth) {
        status = measure_error(&b, error);
        if (status == FP3_E_ARGUMENT || status == FP3_E_MISMATCH) { /* all else is measured */
            result->no_truth = *error;
            status = FP3_OK;
        }
    }
    close_bench(&b);
    return status;
}
