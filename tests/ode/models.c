/* models - a model and its truth, as lines that a test can read.
 *
 *     models show FILE                     step, span, then each state, param and invariant
 *     models truth FILE TIME [NAME=VALUE]  each state and invariant at that time, from these
 *                                          params and starts
 */
#include <fp3/truth.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fp3_model *model;
    double *params, *initial, *states, *values;
} bench;

static int load(bench *b, const char *path) {
    char *report = NULL;
    fp3_error error;
    const fp3_status status = fp3_model_load(path, &b->model, &report, &error);
    if (status) {
        fprintf(stderr, "%s\n", report ? report : error.text);
        free(report);
        return fp3_exit_code(status);
    }
    const fp3_model *m = b->model;
    b->params = calloc(m->param_count + 1, sizeof *b->params);
    b->initial = calloc(m->state_count + 1, sizeof *b->initial);
    b->states = calloc(m->state_count + 1, sizeof *b->states);
    b->values = calloc(m->expr_count + 1, sizeof *b->values);
    if (!b->params || !b->initial || !b->states || !b->values)
        abort();
    for (uint32_t i = 0; i < m->param_count; i++)
        b->params[i] = m->params[i].value;
    for (uint32_t i = 0; i < m->state_count; i++)
        b->initial[i] = m->states[i].value;
    return 0;
}

static void unload(bench *b) {
    fp3_model_free(&b->model);
    free(b->params);
    free(b->initial);
    free(b->states);
    free(b->values);
}

static int show(const bench *b) {
    const fp3_model *m = b->model;
    printf("model %s %.17g %.17g %s\n", m->name, m->step, m->span, m->doc);
    for (uint32_t i = 0; i < m->state_count; i++) {
        const fp3_quantity *s = &m->states[i];
        printf("state %s %.17g %s %s\n", s->name, s->value, s->exact == FP3_NONE ? "-" : "exact",
               s->velocity == FP3_NONE ? "-" : m->states[s->velocity].name);
    }
    for (uint32_t i = 0; i < m->param_count; i++)
        printf("param %s %.17g\n", m->params[i].name, m->params[i].value);
    for (uint32_t i = 0; i < m->invariant_count; i++)
        printf("invariant %s\n", m->invariants[i].name);
    return 0;
}

/* NAME=VALUE. */
static int set(bench *b, const char *text) {
    const char *equals = strchr(text, '=');
    char name[FP3_NAME_SIZE] = "";
    if (!equals || (size_t)(equals - text) >= sizeof name)
        return 2;
    memcpy(name, text, (size_t)(equals - text));
    const uint32_t param = fp3_model_param(b->model, name);
    const uint32_t state = fp3_model_state(b->model, name);
    if (param == FP3_NONE && state == FP3_NONE)
        return 2;
    *(param != FP3_NONE ? &b->params[param] : &b->initial[state]) = strtod(equals + 1, NULL);
    return 0;
}

static int truth(bench *b, double t) {
    const fp3_model *m = b->model;
    fp3_error error;
    const fp3_status status = fp3_model_truth(m, b->params, b->initial, t, b->states, &error);
    if (status) {
        fprintf(stderr, "%s\n", error.text);
        return fp3_exit_code(status);
    }
    for (uint32_t i = 0; i < m->state_count; i++)
        printf("%s %.17g\n", m->states[i].name, b->states[i]);
    fp3_model_evaluate(
        m, &(fp3_point){.states = b->states, .params = b->params, .initial = b->initial, .t = t},
        b->values);
    for (uint32_t i = 0; i < m->invariant_count; i++)
        printf("%s %.17g\n", m->invariants[i].name, b->values[m->invariants[i].expr]);
    return 0;
}

int main(int argc, char **argv) {
    bench b = {0};
    int result = argc >= 3 ? load(&b, argv[2]) : 2;
    if (!result && argc == 3 && strcmp(argv[1], "show") == 0) {
        result = show(&b);
    } else if (!result && argc >= 4 && strcmp(argv[1], "truth") == 0) {
        for (int i = 4; i < argc && !result; i++)
            result = set(&b, argv[i]);
        if (!result)
            result = truth(&b, strtod(argv[3], NULL));
    } else if (!result) {
        result = 2;
    }
    if (result == 2 && argc < 3)
        fprintf(stderr, "usage: models show FILE | truth FILE TIME [NAME=VALUE]...\n");
    unload(&b);
    return result;
}
