/* random_models.c - compiled programs on the engines against the equations, bit for bit.
 *
 *     random_models <CASES      one case a line:
 *     MODEL INTEGRATOR CONFIG PASSES ARITHMETIC STEPS VISIT HAS_RTL IS_WILD SEED OBSERVED
 *
 * PASSES is a set of FP3_PASS(...) in hexadecimal, ARITHMETIC 0 plain, 1 compensated, 2
 * double-single, OBSERVED "all" or names with commas. States begin at numbers of SEED; IS_WILD:
 * infinities and NaNs are among them. Prints "bad", "refused" or "same" for each case, and exits
 * with 1 where one is bad.
 *
 * Reference and program come from one graph, so what the graph means is checked by itself: in
 * double, a step of Euler's method and its events against the evaluation of the model.
 */
#include <fp3/compile.h>
#include <fp3/engine.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <machine/format.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 64, OBJECTS = 2, TEXT = 256 };

typedef struct {
    char model[4096], integrator[4096], config[TEXT], observed[4096];
    unsigned passes;
    int arithmetic, has_rtl, is_wild;
    uint64_t steps;
    uint32_t visit, seed;
} job;

typedef struct {
    const job *j;
    fp3_model *model;
    fp3_integrator *integrator;
    fp3_compiled *compiled;
    double params[STATES + 1], initial[OBJECTS][STATES + 1];
    float wanted[OBJECTS][STATES + 1], low[OBJECTS][STATES + 1];
    char why[1024];
} bench;

static uint32_t next(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* As the configuration has it; 1 for what it has no word for. */
static double as_word(const char *config, double x) {
    const fp3_config *of = fp3_config_find(config);
    uint32_t word;
    return !of || fp3_format_word(of, (float)x, &word) ? 1 : (double)fp3_format_value(of, word);
}

static double start_of(uint32_t *seed, int is_wild) {
    static const double special[] = {
        0.0,      -0.0,           1,    -1,       0x1p-149, -0x1p-140, 0x1p-126, 0x1.8p-63, 0x1p126,
        -0x1p127, 0x1.fffffep127, 3.25, INFINITY, NAN,      -INFINITY};
    const uint32_t most = sizeof special / sizeof *special, which = next(seed) % 24;
    if (which < (is_wild ? most : most - 3))
        return special[which];
    return (float)((next(seed) / 8388608.0 - 1) * ldexp(1, (int)(next(seed) % 5) - 2));
}

static int compile(bench *b, fp3_error *error) {
    const char *observed[STATES];
    char names[sizeof b->j->observed];
    fp3_compile_def def = fp3_compile_default();
    def.config = b->j->config;
    def.passes = b->j->passes | FP3_PASS(FP3_PASS_ZERO); /* 0 k is not 0 where k is infinite */
    static const fp3_arithmetic arithmetics[] = {FP3_PLAIN, FP3_COMPENSATED, FP3_DOUBLE_SINGLE};
    def.arithmetic = arithmetics[b->j->arithmetic];
    if (def.arithmetic == FP3_DOUBLE_SINGLE)
        def.passes &= ~FP3_PASS(FP3_PASS_EXACT_DIVISION); /* is refused there */
    strcpy(names, b->j->observed);
    if (strcmp(names, "all") != 0) {
        def.observed = observed;
        for (char *name = strtok(names, ","); name; name = strtok(NULL, ","))
            observed[def.observed_count++] = name;
    }
    char *report = NULL;
    if (fp3_model_load(b->j->model, &b->model, &report, error)) {
        free(report);
        snprintf(b->why, sizeof b->why, "bad model: %s", error->text);
        return 1;
    }
    if (fp3_integrator_find(b->j->integrator, &b->integrator, error)) {
        snprintf(b->why, sizeof b->why, "bad integrator: %s", error->text);
        return 1;
    }
    const fp3_status status = fp3_compile(b->model, b->integrator, &def, &b->compiled, error);
    if (status)
        snprintf(b->why, sizeof b->why, "%s: %s", status == FP3_E_PROGRAM ? "refused" : "bad",
                 error->text);
    return status != FP3_OK;
}

/* What the host must write has a name, and no more is used than was said. */
static int check_image(bench *b) {
    const fp3_compiled *c = b->compiled;
    for (uint32_t i = 0; i < c->input_count; i++)
        if (!fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST)) {
            snprintf(b->why, sizeof b->why, "bad: no '%s' in the image", c->inputs[i].name);
            return 1;
        }
    if (c->image->registers > c->registers || c->image->shared > c->constants) {
        snprintf(b->why, sizeof b->why,
                 "bad: %" PRIu32 " registers and %" PRIu32 " constants of %" PRIu32 " and %" PRIu32,
                 c->image->registers, c->image->shared, c->registers, c->constants);
        return 1;
    }
    return 0;
}

static fp3_status write_object(bench *b, fp3_engine *engine, size_t object, fp3_error *error) {
    const fp3_compiled *c = b->compiled;
    float *values = calloc(c->input_count + 1u, sizeof *values);
    double tame[STATES + 1];
    for (uint32_t i = 0; i < b->model->state_count; i++)
        tame[i] = isfinite(b->initial[object][i]) ? b->initial[object][i] : 0;
    fp3_status status = fp3_compiled_inputs(c, b->params, tame, b->model->step, values, error);
    for (uint32_t i = 0; !status && i < c->input_count; i++) {
        const fp3_symbol *s = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        if (c->inputs[i].state != FP3_NONE)
            values[i] = (float)b->initial[object][c->inputs[i].state];
        status = c->inputs[i].is_shared ? fp3_engine_write_shared(engine, s->index, 1, &values[i])
                                        : fp3_engine_write(engine, object, 1, s->index, &values[i]);
    }
    free(values);
    return status;
}

static int word_differs(bench *b, fp3_engine *engine, const char *where, uint32_t reg,
                        size_t object, float wanted) {
    float found = 0;
    uint32_t bits[2];
    if (fp3_engine_read(engine, object, 1, reg, &found))
        abort();
    memcpy(&bits[0], &found, 4);
    memcpy(&bits[1], &wanted, 4);
    if (isnan(found))
        bits[0] = 0x7fc00000;
    if (bits[0] == bits[1])
        return 0;
    snprintf(b->why, sizeof b->why,
             "bad: %s, object %zu: %.9g %08" PRIx32 ", expected %.9g %08" PRIx32, where, object,
             (double)found, bits[0], (double)wanted, bits[1]);
    return 1;
}

static int differs(bench *b, fp3_engine *engine, const char *engine_name, size_t object) {
    for (uint32_t i = 0; i < b->model->state_count; i++) {
        const char *name = b->model->states[i].name;
        const fp3_symbol *s = fp3_image_find(b->compiled->image, name, FP3_CLASS(FP3_SYMBOL_STATE));
        const int low = fp3_compiled_low(b->compiled, i);
        char where[TEXT];
        snprintf(where, sizeof where, "%s, '%.60s'", engine_name, name);
        if (s && word_differs(b, engine, where, s->index, object, b->wanted[object][i]))
            return 1;
        if (low >= 0 && word_differs(b, engine, where, (uint32_t)low, object, b->low[object][i]))
            return 1;
    }
    return 0;
}

static int run_on(bench *b, const char *engine_name) {
    fp3_error error = {.text = ""};
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    int is_bad = 0;
    def.engine = engine_name;
    def.config = b->j->config;
    def.visit = b->j->visit;
    def.error = &error;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_engine_load(engine, b->compiled->image);
    const size_t objects = status || fp3_engine_objects(engine) == 1 ? 1 : OBJECTS;
    for (size_t i = 0; !status && i < objects; i++)
        status = write_object(b, engine, i, &error);
    if (!status)
        status = fp3_engine_run(engine, b->j->steps, NULL);
    for (size_t i = 0; !status && !is_bad && i < objects; i++)
        is_bad = differs(b, engine, engine_name, i);
    if (status)
        snprintf(b->why, sizeof b->why, "%s: %s",
                 strstr(error.text, ": expected a") ? "refused" : "bad", error.text);
    fp3_engine_close(&engine);
    return status || is_bad;
}

/* Whether double and the program must agree: no 1/0, no sine beyond pi, nothing huge. */
static int is_tame(const fp3_model *model, const double *values) {
    for (uint32_t i = 0; i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        const double first = e->operand[0] == FP3_NONE ? 1 : fabs(values[e->operand[0]]);
        const double second = e->operand[1] == FP3_NONE ? 1 : fabs(values[e->operand[1]]);
        if (!(fabs(values[i]) < 1e4) || (e->op == FP3_EXPR_DIV && second < 1e-3) ||
            ((e->op == FP3_EXPR_SQRT || e->op == FP3_EXPR_POWER) && first < 1e-3) ||
            ((e->op == FP3_EXPR_SIN || e->op == FP3_EXPR_COS) && first > 3.1))
            return 0;
    }
    return 1;
}

/* What events make of states after a step; 0: rounding errors may decide, or nothing is asked. */
static int fire(const bench *b, double h, double *states, double *values) {
    const fp3_model *m = b->model;
    double other[2][STATES + 1];
    for (uint32_t s = 0; s < m->state_count; s++)
        for (int i = 0; i < 2; i++)
            other[i][s] = states[s] * (1 + (i ? 1e-6 : -1e-6) * (s + 1)) + (i ? 1e-7 : -1e-7);
    fp3_model_evaluate(m, &(fp3_point){.states = states, .params = b->params, .t = h}, values);
    if (!is_tame(m, values))
        return 0;
    for (int i = 0; i < 2; i++)
        fp3_model_fire(m, NULL, b->params, h, other[i], values);
    fp3_model_fire(m, NULL, b->params, h, states, values);
    for (uint32_t s = 0; s < m->state_count; s++)
        for (int i = 0; i < 2; i++)
            if (!(fabs(other[i][s] - states[s]) <= 1e-3 * (1 + fabs(states[s]))))
                return 0;
    fp3_model_evaluate(m, &(fp3_point){.states = states, .params = b->params, .t = h}, values);
    return is_tame(m, values);
}

/* A step of Euler's method in double against the model's own evaluation of its equations. */
static int check_meaning(bench *b) {
    fp3_error error = {.text = ""};
    fp3_integrator *euler = NULL;
    fp3_compiled *compiled = NULL;
    fp3_compile_def def = fp3_compile_default();
    double *values = calloc(b->model->expr_count + 1u, sizeof *values), states[STATES + 1];
    const uint64_t one = 1;
    const double h = 0.25;
    double initial[STATES + 1];
    uint32_t seed = b->j->seed;
    for (uint32_t s = 0; s < b->model->state_count; s++)
        initial[s] = 0.25 + next(&seed) / 16777216.0;
    def.config = b->j->config;
    def.passes = FP3_PASS(FP3_PASS_ZERO);
    int is_bad = 0;
    if (!values || fp3_integrator_find("euler", &euler, &error))
        abort();
    fp3_model_evaluate(b->model, &(fp3_point){.states = initial, .params = b->params}, values);
    if (!fp3_compile(b->model, euler, &def, &compiled, &error) &&
        fp3_compiled_exact(compiled, b->params, initial, h, &one, 1, states, &error))
        abort();
    double wanted[STATES + 1];
    int is_asked = compiled && is_tame(b->model, values);
    for (uint32_t s = 0; s < b->model->state_count; s++)
        wanted[s] = initial[s] + h * values[b->model->states[s].derivative];
    if (is_asked && b->model->event_count)
        is_asked = fire(b, h, wanted, values);
    for (uint32_t s = 0; is_asked && !is_bad && s < b->model->state_count; s++) {
        is_bad = !(fabs(states[s] - wanted[s]) <= 1e-4 * (1 + fabs(wanted[s])));
        if (is_bad)
            snprintf(b->why, sizeof b->why, "bad: meaning of '%s': %.17g, expected %.17g",
                     b->model->states[s].name, states[s], wanted[s]);
    }
    free(values);
    fp3_compiled_free(&compiled);
    fp3_integrator_free(&euler);
    return is_bad;
}

static int run(bench *b) {
    fp3_error error;
    uint32_t seed = b->j->seed;
    if (compile(b, &error) || check_image(b))
        return 1;
    for (uint32_t i = 0; i < b->model->param_count; i++)
        b->params[i] = b->model->params[i].value;
    const int is_wild = b->j->is_wild && b->integrator->kind != FP3_STOERMER;
    for (size_t i = 0; i < OBJECTS; i++) {
        for (uint32_t s = 0; s < b->model->state_count; s++)
            b->initial[i][s] = b->integrator->kind == FP3_STOERMER
                                   ? b->model->states[s].value
                                   : as_word(b->j->config, start_of(&seed, is_wild));
        if (fp3_compiled_reference_pairs(b->compiled, b->params, b->initial[i], b->model->step,
                                         &b->j->steps, 1, b->wanted[i], b->low[i], &error)) {
            snprintf(b->why, sizeof b->why, "refused: %s", error.text);
            return 1;
        }
    }
    return check_meaning(b) || run_on(b, "isa") || (b->j->has_rtl && run_on(b, "rtl"));
}

int main(void) {
    job j;
    int is_bad = 0;
    while (scanf("%4095s %4095s %255s %x %d %" SCNu64 " %" SCNu32 " %d %d %" SCNu32 " %4095s",
                 j.model, j.integrator, j.config, &j.passes, &j.arithmetic, &j.steps, &j.visit,
                 &j.has_rtl, &j.is_wild, &j.seed, j.observed) == 11) {
        bench b = {.j = &j, .why = "same"};
        run(&b);
        puts(b.why);
        fflush(stdout);
        is_bad |= strncmp(b.why, "bad", 3) == 0;
        fp3_compiled_free(&b.compiled);
        fp3_integrator_free(&b.integrator);
        fp3_model_free(&b.model);
    }
    return is_bad;
}
