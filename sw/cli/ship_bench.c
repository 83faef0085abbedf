/* ship_bench.c - see ship_bench.h. */
#include "ship_bench.h"

#include <fp3/golden.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CYCLES_PER_STEP 100000 /* no ship program needs as many: a run that does hangs */
#define SPEED_APART 0.25f      /* [m/s] from one object to the next */

/* A state's register. The words of an object begin at object * room. */
typedef struct {
    const char *name;
    uint32_t reg;
    uint32_t *golden;  /* the host's value, then the value after each step */
    uint32_t *written; /* as it retires */
    uint64_t *writes;  /* per object; may exceed the room */
} watch;

typedef struct {
    watch state[2]; /* v, s */
    uint64_t room;  /* steps + 1: words per object */
    fp3_ship_result *result;
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

static void compare_word(bench *b, const char *name, uint64_t object, uint64_t step,
                         const char *how, uint32_t got, uint32_t golden) {
    fp3_ship_result *r = b->result;
    r->words++;
    if (got == golden || r->mismatches++)
        return;
    fp3_fail(&r->mismatch, FP3_E_MISMATCH,
             "object %" PRIu64 ", step %" PRIu64 ": %s as %s is 0x%08" PRIx32
             " (%.9g), golden has 0x%08" PRIx32 " (%.9g)",
             object, step, name, how, got, (double)value_of(got), golden, (double)value_of(golden));
}

static fp3_status compare(bench *b, fp3_engine *engine, const watch *w, uint64_t object,
                          uint64_t steps, fp3_error *error) {
    const uint32_t *golden = &w->golden[object * b->room];
    const uint32_t *written = &w->written[object * b->room];
    const uint64_t writes = w->writes[object];
    if (writes != steps && writes != steps + 1)
        return fp3_fail(error, FP3_E_MISMATCH,
                        "object %" PRIu64 ": %s was written %" PRIu64 " times in %" PRIu64 " steps",
                        object, w->name, writes, steps);
    /* One write more begins with the host's value, which is golden's word 0. */
    for (uint64_t n = 0, step = steps + 1 - writes; n < writes; n++, step++)
        compare_word(b, w->name, object, step, step ? "written" : "first written", written[n],
                     golden[step]);
    float last;
    fp3_status status = fp3_engine_read(engine, object, 1, w->reg, &last);
    if (!status)
        compare_word(b, w->name, object, steps, "read back", bits_of(last), golden[steps]);
    return status;
}

/* Fills golden, and measures its end against truth. */
static fp3_status expect(bench *b, fp3_params *params, fp3_error *error) {
    fp3_ship_result *r = b->result;
    double T, C, m, rm, h, v, s;
    fp3_status status;
    if ((status = fp3_params_get(params, "T", &T, error)) ||
        (status = fp3_params_get(params, "C", &C, error)) ||
        (status = fp3_params_get(params, "m", &m, error)) ||
        (status = fp3_params_get(params, "rm", &rm, error)) ||
        (status = fp3_params_get(params, "h", &h, error)) ||
        (status = fp3_params_get(params, "v", &v, error)) ||
        (status = fp3_params_get(params, "s", &s, error)))
        return status;
    const fp3_ship ship = {(float)T, (float)C, (float)rm, (float)h};
    for (uint64_t object = 0; object < r->objects; object++) {
        float now_v = (float)v + SPEED_APART * (float)object, now_s = (float)s;
        for (uint64_t step = 0; step < b->room; step++) {
            if (step)
                fp3_ship_step(&ship, &now_v, &now_s);
            b->state[0].golden[object * b->room + step] = bits_of(now_v);
            b->state[1].golden[object * b->room + step] = bits_of(now_s);
        }
    }
    status = fp3_ship_truth(T, C, m, h * (double)r->steps, &v, &s, error);
    if (!status && (v == 0 || s == 0))
        status = fp3_fail(error, FP3_E_ARGUMENT, "a ship that ends at 0 has no relative error");
    if (!status) {
        r->rel_err_v = fabs((double)value_of(b->state[0].golden[r->steps]) / v - 1);
        r->rel_err_s = fabs((double)value_of(b->state[1].golden[r->steps]) / s - 1);
    }
    return status;
}

static fp3_status run(bench *b, fp3_engine *engine, const fp3_image *image, fp3_params *params,
                      uint64_t steps, fp3_stats *stats, fp3_error *error) {
    const watch *v = &b->state[0];
    fp3_status status = fp3_params_apply(params, engine, image, error);
    for (uint64_t object = 0; object < b->result->objects && !status; object++) {
        const float first = value_of(v->golden[object * b->room]);
        status = fp3_engine_write(engine, object, 1, v->reg, &first);
        b->state[0].writes[object] = b->state[1].writes[object] = 0;
    }
    if (!status)
        status = fp3_engine_run(engine, steps, stats);
    for (int i = 0; i < 2; i++)
        for (uint64_t object = 0; object < b->result->objects && !status; object++)
            status = compare(b, engine, &b->state[i], object, steps, error);
    return status;
}

static fp3_status prepare(bench *b, const fp3_image *image, fp3_error *error) {
    const uint64_t objects = b->result->objects, words = objects * b->room;
    for (int i = 0; i < 2; i++) {
        watch *w = &b->state[i];
        w->name = i ? "s" : "v";
        const fp3_symbol *symbol = fp3_image_find(image, w->name, FP3_KIND(FP3_SYMBOL_STATE));
        if (!symbol)
            return fp3_fail(error, FP3_E_ARGUMENT, "no ship: there is no .state %s", w->name);
        w->reg = symbol->index;
        w->golden = malloc(words * sizeof *w->golden);
        w->written = malloc(words * sizeof *w->written);
        w->writes = malloc(objects * sizeof *w->writes);
        if (!w->golden || !w->written || !w->writes)
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    return FP3_OK;
}

fp3_status fp3_ship_bench(const fp3_image *image, fp3_params *params, fp3_ship_result *result,
                          int *is_unfit, fp3_error *error) {
    bench b = {.room = result->steps + 1, .result = result};
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    def.config = result->config;
    def.cycle_limit = CYCLES_PER_STEP * result->steps;
    def.retire = record;
    def.retire_user = &b;
    def.error = error;
    *is_unfit = 0;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status) {
        result->objects = fp3_engine_objects(engine);
        status = fp3_engine_load(engine, image);
        *is_unfit = status == FP3_E_PROGRAM;
    }
    if (!status)
        status = prepare(&b, image, error);
    if (!status)
        status = expect(&b, params, error);
    if (!status)
        status = run(&b, engine, image, params, 1, &result->one, error);
    if (!status)
        status = run(&b, engine, image, params, result->steps, &result->all, error);
    fp3_engine_close(&engine);
    for (int i = 0; i < 2; i++) {
        free(b.state[i].golden);
        free(b.state[i].written);
        free(b.state[i].writes);
    }
    return status;
}
