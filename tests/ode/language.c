/* language.c - a model, or a constant, as JSON.
 *
 *     language model FILE [t=1.5] [v=2] [v(0)=3] [m=4] ...
 *
 * prints the model and the values of its expressions at that point: what is not said is 0 or, of a
 * param, its default. Errors go to stderr, exit status 2.
 *
 *     language constant TEXT
 */
#include <fp3/model.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const op_names[] = {
#define X(NAME, operands, host) #NAME,
    FP3_EXPR_OPS(X)
#undef X
};

static json_t *index_of(uint32_t index) {
    return index == FP3_NONE ? json_null() : json_integer(index);
}

static json_t *quantities(const fp3_quantity *q, uint32_t count) {
    json_t *array = json_array();
    for (; count-- > 0; q++)
        json_array_append_new(array,
                              json_pack("{ss ss ss sf sb so so so si}", "name", q->name,
                                        "dimension", q->dimension, "doc", q->doc, "value", q->value,
                                        "shared", q->is_shared, "derivative",
                                        index_of(q->derivative), "velocity", index_of(q->velocity),
                                        "exact", index_of(q->exact), "line", (int)q->line));
    return array;
}

static json_t *definitions(const fp3_definition *d, uint32_t count) {
    json_t *array = json_array();
    for (; count-- > 0; d++)
        json_array_append_new(
            array, json_pack("{ss si si}", "name", d->name, "expr", d->expr, "line", d->line));
    return array;
}

static json_t *events(const fp3_model *m) {
    json_t *array = json_array();
    for (uint32_t i = 0; i < m->event_count; i++) {
        const fp3_event *e = &m->events[i];
        json_t *sets = json_array();
        for (uint32_t j = 0; j < e->count; j++) {
            const fp3_assignment *a = &m->assignments[e->first + j];
            json_array_append_new(sets, json_pack("[s i]", m->states[a->state].name, (int)a->expr));
        }
        json_array_append_new(array, json_pack("{si so si sb sb}", "condition", (int)e->condition,
                                               "sets", sets, "line", (int)e->line, "edge",
                                               e->armed != FP3_NONE, "stops", e->stops));
    }
    return array;
}

static json_t *expressions(const fp3_model *m, const double *values) {
    json_t *array = json_array();
    char value[40];
    for (uint32_t i = 0; i < m->expr_count; i++) {
        const fp3_expr *e = &m->exprs[i];
        snprintf(value, sizeof value, "%.17g", values[i]);
        json_array_append_new(array,
                              json_pack("{ss s[ooo] si sf si si sb ss}", "op", op_names[e->op],
                                        "operand", index_of(e->operand[0]), index_of(e->operand[1]),
                                        index_of(e->operand[2]), "index", (int)e->index, "number",
                                        e->number, "line", (int)e->line, "column", (int)e->column,
                                        "known", e->is_known, "value", value));
    }
    return array;
}

/* "v=2", "v(0)=2", "m=4" or "t=1.5". */
static int set(const fp3_model *m, char *text, double *states, double *initial, double *params,
               double *t) {
    char *equals = strchr(text, '=');
    if (!equals)
        return 0;
    double value = strtod(equals + 1, NULL);
    *equals = 0;
    char *bracket = strchr(text, '(');
    if (bracket)
        *bracket = 0;
    uint32_t state = fp3_model_state(m, text), param = fp3_model_param(m, text);
    if (!strcmp(text, "t"))
        *t = value;
    else if (state != FP3_NONE)
        (bracket ? initial : states)[state] = value;
    else if (param != FP3_NONE)
        params[param] = value;
    else
        return 0;
    return 1;
}

static int show_model(char **arguments) {
    fp3_model *m = NULL;
    char *report = NULL;
    fp3_error error;
    fp3_status status = fp3_model_load(arguments[0], &m, &report, &error);
    if (status) {
        fputs(report ? report : error.text, stderr);
        if (report && strncmp(report, error.text, strlen(error.text)))
            fputs("\nthe error is not the first line of the report\n", stderr);
        free(report);
        return fp3_exit_code(status);
    }
    double states[64] = {0}, initial[64] = {0}, params[64] = {0}, t = 0;
    for (uint32_t i = 0; i < m->param_count; i++)
        params[i] = m->params[i].value;
    for (char **a = arguments + 1; *a; a++)
        if (!set(m, *a, states, initial, params, &t)) {
            fprintf(stderr, "no '%s' in the model\n", *a);
            fp3_model_free(&m);
            return 2;
        }
    double *values = calloc((size_t)m->expr_count + 1, sizeof *values);
    const fp3_point point = {states, params, initial, t};
    fp3_model_evaluate(m, &point, values);
    json_t *all =
        json_pack("{ss ss sf sf so so so so so so}", "name", m->name, "doc", m->doc, "step",
                  m->step, "span", m->span, "states", quantities(m->states, m->state_count),
                  "params", quantities(m->params, m->param_count), "definitions",
                  definitions(m->definitions, m->definition_count), "invariants",
                  definitions(m->invariants, m->invariant_count), "events", events(m), "exprs",
                  expressions(m, values));
    json_dumpf(all, stdout, JSON_COMPACT);
    json_decref(all);
    free(values);
    fp3_model_free(&m);
    fp3_model_free(&m);
    return 0;
}

static int show_constant(const char *text) {
    fp3_error error;
    double value = 0;
    fp3_status status = fp3_constant_read(text, &value, &error);
    if (status)
        fprintf(stderr, "%s\n", error.text);
    else
        printf("%.17g\n", value);
    return fp3_exit_code(status);
}

int main(int argc, char **argv) {
    if (argc >= 3 && !strcmp(argv[1], "model"))
        return show_model(argv + 2);
    if (argc == 3 && !strcmp(argv[1], "constant"))
        return show_constant(argv[2]);
    fputs("usage: language model FILE [NAME=VALUE...] | constant TEXT\n", stderr);
    return 2;
}
