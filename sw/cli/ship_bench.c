/* ship_bench.c - see ship_bench.h. */
#include "ship_bench.h"

#include "isa.h"
#include "machine/config.h"

#include <fp3/golden.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CYCLES_PER_STEP 100000 /* of all contexts: no ship program needs as many, it hangs */
#define THRUST_APART 0.001     /* from one object to the next, of the first one's ... */
#define SPEED_APART 0.25 /* [m/s] ... or this at the start, where the thrust is shared by all */

/* A state's register. Of each object there is room for so many words. */
typedef struct {
    const char *name;
    uint32_t reg;
    uint32_t *golden;  /* [steps + 1] the host's value, then the value after each step */
    uint32_t *written; /* [room] as it retires */
    uint64_t *writes;  /* of each object; may exceed the room */
} watch;

typedef struct {
    const fp3_ship_case *what;
    fp3_ship_result *result;
    const fp3_program *program;
    fp3_params *params;    /* the host's */
    watch state[2];        /* v, s */
    const fp3_symbol *own; /* the parameter that differs from object to object: T or v ... */
    float *values;         /* ... and what it is */
    int is_interleaved;
    uint64_t visit; /* steps of one */
    uint64_t room;
} bench;

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static float value_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* ---- what is compared ---- */

static void record(void *user, const fp3_retirement *retirement) {
    bench *b = user;
    for (int i = 0; i < 2; i++) {
        watch *w = &b->state[i];
        if (retirement->reg != w->reg || retirement->object >= b->result->objects)
            continue;
        const uint64_t n = w->writes[retirement->object]++;
        if (n < b->room)
            w->written[retirement->object * b->room + n] = retirement->bits;
    }
}

static uint32_t golden_at(const bench *b, const watch *w, uint64_t object, uint64_t step) {
    return w->golden[object * (b->what->steps + 1) + step];
}

static void compare_word(bench *b, const watch *w, uint64_t object, uint64_t step, const char *how,
                         uint32_t got) {
    fp3_ship_result *r = b->result;
    const uint32_t golden = golden_at(b, w, object, step);
    r->words++;
    if (got == golden || r->mismatches++)
        return;
    fp3_fail(&r->mismatch, FP3_E_MISMATCH,
             "object %" PRIu64 ", step %" PRIu64 ": %s as %s is 0x%08" PRIx32
             " (%.9g), golden has 0x%08" PRIx32 " (%.9g)",
             object, step, w->name, how, got, (double)value_of(got), golden,
             (double)value_of(golden));
}

/* The words of all visits of an object that made so many steps. */
static fp3_status compare_writes(bench *b, const watch *w, uint64_t object, uint64_t steps,
                                 fp3_error *error) {
    const uint32_t *written = &w->written[object * b->room];
    const uint64_t writes = w->writes[object], visits = (steps + b->visit - 1) / b->visit;
    const uint64_t least = steps + (b->is_interleaved ? visits : 0);
    if (writes != least && writes != least + visits)
        return fp3_fail(error, FP3_E_MISMATCH,
                        "object %" PRIu64 ": %s was written %" PRIu64 " times in %" PRIu64 " steps",
                        object, w->name, writes, steps);
    const uint64_t again = visits ? (writes - steps) / visits : 0;
    for (uint64_t begin = 0; begin < steps; begin += b->visit) {
        const uint64_t end = steps - begin < b->visit ? steps : begin + b->visit;
        for (uint64_t i = 0; i < again; i++)
            compare_word(b, w, object, begin, "first written", *written++);
        for (uint64_t step = begin + 1; step <= end; step++)
            compare_word(b, w, object, step, "written", *written++);
    }
    return FP3_OK;
}

static fp3_status compare(bench *b, fp3_engine *engine, uint64_t object, uint64_t steps,
                          fp3_error *error) {
    fp3_object_status about = {0};
    fp3_status status = fp3_engine_status(engine, object, 1, &about);
    if (about.slept)
        steps = about.slept == FP3_REMOVED ? 0 : about.slept;
    for (int i = 0; i < 2 && !status; i++) {
        const watch *w = &b->state[i];
        float last;
        status = compare_writes(b, w, object, steps, error);
        if (!status)
            status = fp3_engine_read(engine, object, 1, w->reg, &last);
        if (!status)
            compare_word(b, w, object, steps, "read back", bits_of(last));
    }
    return status;
}

/* ---- what is expected ---- */

typedef struct {
    double T, C, m, rm, h, v, s;
} values;

static fp3_status get_values(const fp3_params *params, values *x, fp3_error *error) {
    const struct {
        const char *name;
        double *value;
    } rows[] = {{"T", &x->T}, {"C", &x->C}, {"m", &x->m}, {"rm", &x->rm},
                {"h", &x->h}, {"v", &x->v}, {"s", &x->s}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; i < sizeof rows / sizeof *rows && !status; i++)
        status = fp3_params_get(params, rows[i].name, rows[i].value, error);
    return status;
}

static void fill_golden(bench *b, const values *x, uint64_t object) {
    const uint64_t steps = b->what->steps, begin = object * (steps + 1);
    const int is_thrust = b->own->symbol_class == FP3_SYMBOL_PARAM;
    const double n = (double)object;
    const fp3_ship ship = {(float)(is_thrust ? x->T * (1 + THRUST_APART * n) : x->T), (float)x->C,
                           (float)x->rm, (float)x->h};
    float v = (float)(is_thrust ? x->v : x->v + SPEED_APART * n), s = (float)x->s;
    b->values[object] = is_thrust ? ship.T : v;
    for (uint64_t step = 0; step <= steps; step++) {
        if (step)
            fp3_ship_step(&ship, &v, &s);
        b->state[0].golden[begin + step] = bits_of(v);
        b->state[1].golden[begin + step] = bits_of(s);
    }
}

/* Fills golden, and measures its end against truth. */
static fp3_status expect(bench *b, fp3_error *error) {
    fp3_ship_result *r = b->result;
    const uint64_t steps = b->what->steps;
    values x;
    fp3_status status = get_values(b->params, &x, error);
    for (uint64_t object = 0; object < r->objects && !status; object++)
        fill_golden(b, &x, object);
    double v = x.v, s = x.s;
    if (!status)
        status = fp3_ship_truth(x.T, x.C, x.m, x.h * (double)steps, &v, &s, error);
    if (!status && (v == 0 || s == 0))
        status = fp3_fail(error, FP3_E_ARGUMENT, "a ship that ends at 0 has no relative error");
    if (!status) {
        r->rel_err_v = fabs((double)value_of(golden_at(b, &b->state[0], 0, steps)) / v - 1);
        r->rel_err_s = fabs((double)value_of(golden_at(b, &b->state[1], 0, steps)) / s - 1);
    }
    return status;
}

typedef enum { ADD, MUL, CHAIN, SLEEP, MEMORY, NONE } unit;

static unit unit_of(uint32_t word) {
    fp3_instruction in;
    if (fp3_word_decode(word, &in, NULL))
        return NONE;
    switch (in.op) {
#define X(NAME, code, mnemonic, operands, unit)                                                    \
    case code:                                                                                     \
        return unit;
        FP3_OPS(X)
#undef X
    }
    return NONE;
}

/* Of one step, what each functional unit has to do. */
static void count_uses(fp3_ship_result *r, const fp3_image *image) {
    for (uint32_t i = image->step; i < image->last; i++) {
        const unit used = unit_of(image->code[i]);
        r->issues++;
        r->adds += used == ADD || used == CHAIN;
        r->muls += used == MUL || used == CHAIN;
    }
}

/* ---- a run ---- */

/* Loads anew, so that steps are counted from 1 and everybody is awake; then removes those who shall
 * not be. */
static fp3_status set_objects(bench *b, fp3_engine *engine, fp3_error *error) {
    fp3_ship_result *r = b->result;
    fp3_status status = fp3_program_load(b->program, b->params, engine, error);
    if (!status && fp3_image_slept(b->program->image) >= 0)
        status = fp3_engine_wake(engine, 0, r->objects);
    r->awake = 0;
    for (uint64_t i = 0; i < r->objects && !status; i++) {
        status = fp3_engine_write(engine, i, 1, b->own->index, &b->values[i]);
        b->state[0].writes[i] = b->state[1].writes[i] = 0;
        if (i % b->what->awake_of == 0)
            r->awake++;
        else if (!status)
            status = fp3_engine_remove(engine, i, 1);
    }
    return status;
}

static fp3_status run(bench *b, fp3_engine *engine, uint64_t steps, fp3_stats *stats,
                      fp3_error *error) {
    fp3_status status = set_objects(b, engine, error);
    if (!status)
        status = fp3_engine_run(engine, steps, stats);
    for (uint64_t object = 0; object < b->result->objects && !status; object++)
        status = compare(b, engine, object, steps, error);
    return status;
}

static fp3_status prepare(bench *b, const fp3_image *image, fp3_error *error) {
    const uint64_t objects = b->result->objects, steps = b->what->steps;
    b->visit = b->is_interleaved && b->what->visit ? b->what->visit : steps;
    b->room = steps + 2 * ((steps + b->visit - 1) / b->visit);
    b->values = malloc(objects * sizeof *b->values);
    b->own = fp3_image_find(image, "T", FP3_CLASS(FP3_SYMBOL_PARAM));
    if (!b->own)
        b->own = fp3_image_find(image, "v", FP3_CLASS(FP3_SYMBOL_STATE));
    fp3_status status = FP3_OK;
    for (int i = 0; i < 2 && !status; i++) {
        watch *w = &b->state[i];
        w->name = i ? "s" : "v";
        const fp3_symbol *symbol = fp3_image_find(image, w->name, FP3_CLASS(FP3_SYMBOL_STATE));
        if (!symbol)
            return fp3_fail(error, FP3_E_ARGUMENT, "no ship: there is no .state %s", w->name);
        w->reg = symbol->index;
        w->golden = malloc(objects * (steps + 1) * sizeof *w->golden);
        w->written = malloc(objects * b->room * sizeof *w->written);
        w->writes = malloc(objects * sizeof *w->writes);
        if (!w->golden || !w->written || !w->writes || !b->values)
            status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    return status;
}

/* The caller's values; and who can sleep has a limit below which no change of speed is, so that all
 * make all steps. */
static fp3_status copy_params(bench *b, const fp3_image *image, const fp3_params *params,
                              fp3_error *error) {
    double eps;
    fp3_status status = fp3_params_copy(params, &b->params, error);
    if (status)
        return status;
    if (!fp3_image_find(image, "eps", FP3_CLASS(FP3_SYMBOL_SHARED)) ||
        !fp3_params_get(b->params, "eps", &eps, NULL))
        return FP3_OK;
    return fp3_params_set(b->params, "eps=0", error);
}

static fp3_status run_both(bench *b, fp3_engine *engine, const fp3_image *image, fp3_error *error) {
    fp3_status status = prepare(b, image, error);
    if (!status)
        status = expect(b, error);
    if (!status)
        status = run(b, engine, 1, &b->result->one, error);
    if (!status)
        status = run(b, engine, b->what->steps, &b->result->all, error);
    return status;
}

static void free_bench(bench *b) {
    for (int i = 0; i < 2; i++) {
        free(b->state[i].golden);
        free(b->state[i].written);
        free(b->state[i].writes);
    }
    free(b->values);
    fp3_params_free(&b->params);
}

fp3_status fp3_ship_bench(const fp3_program *program, const fp3_params *params,
                          const fp3_ship_case *what, fp3_ship_result *result, int *is_unfit,
                          fp3_error *error) {
    const fp3_image *image = program->image;
    bench b = {.what = what, .result = result, .program = program};
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.config = what->config;
    def.objects = what->objects;
    def.visit = what->visit;
    def.cycle_limit = CYCLES_PER_STEP * what->steps * (1 + what->objects / 100);
    def.retire = record;
    def.retire_user = &b;
    def.error = error;
    *result = (fp3_ship_result){0};
    *is_unfit = 0;
    fp3_status status = copy_params(&b, image, params, error);
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status) {
        result->objects = fp3_engine_objects(engine);
        b.is_interleaved = fp3_config_find(what->config)->interleave != 0;
        status = fp3_engine_load(engine, image);
        *is_unfit = status == FP3_E_PROGRAM;
    }
    if (!status) {
        count_uses(result, image);
        status = run_both(&b, engine, image, error);
    }
    fp3_engine_close(&engine);
    free_bench(&b);
    return status;
}
