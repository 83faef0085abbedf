/* SPDX-License-Identifier: Apache-2.0 */
/* values_text.c - the host's values for a compiled program, as a file of parameters.
 *
 * Values that the compiler computes from h and params are written as formulas, so that a run
 * computes them again. A value without a formula (a position at -h) holds for one set of values
 * alone, which its formula names: with any other set it has no value.
 */
#include "apply.h"
#include "base/host.h"
#include "values.h"

#include "base/number.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of names. */
static const char bytes[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

typedef struct {
    const fp3_program *program;
    fp3_object_values of;
    float *inputs;
    FILE *out;
    uint64_t params, states; /* that the rules so far name, a bit each */
    int has_h;
} writer;

/* The name of a param or h in the file: its register's name, which differs from the model's if
 * another register has that name. */
static const char *name_in_file(const writer *w, const char *name) {
    const fp3_compiled *c = w->program->compiled;
    for (uint32_t i = 0; i < c->input_count; i++)
        if (c->inputs[i].rule && strcmp(c->inputs[i].rule, name) == 0)
            return c->inputs[i].name;
    return name;
}

/* ... with a note that a rule names it. */
static const char *name_in_rule(writer *w, const char *name) {
    const uint32_t param = fp3_model_param(w->program->model, name);
    const uint32_t state = fp3_model_state(w->program->model, name);
    w->params |= param == FP3_NONE ? 0 : (uint64_t)1 << param;
    w->states |= state == FP3_NONE ? 0 : (uint64_t)1 << state;
    w->has_h |= strcmp(name, FP3_NAME_STEP) == 0;
    return name_in_file(w, name);
}

/* A rule with the names of the file. */
static void put_renamed(writer *w, const char *rule) {
    char name[FP3_NAME_SIZE];
    while (*rule) {
        const size_t length = strspn(rule, bytes);
        if (length > 0 && length < sizeof name && !(*rule >= '0' && *rule <= '9')) {
            snprintf(name, sizeof name, "%.*s", (int)length, rule);
            fputs(name_in_rule(w, name), w->out);
        } else
            fprintf(w->out, "%.*s", length ? (int)length : 1, rule);
        rule += length ? length : 1;
    }
}

/* As libconfig reads it: a number with a point or an exponent. */
static void put_number(const writer *w, double number, int digits) {
    char text[40];
    snprintf(text, sizeof text, "%.*g", digits, number);
    fprintf(w->out, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

/* "h == 0.125 and m == 2.0 ? 0.99 : 0/0", name by name */
typedef struct {
    writer *w;
    int count; /* of conditions */
} conditional;

static void put_condition(conditional *c, const char *name, double value) {
    fprintf(c->w->out, "%s%s == ", c->count++ ? " and " : "", name_in_rule(c->w, name));
    put_number(c->w, fp3_number_given(value, fp3_program_words(c->w->program)), 17);
}

/* How many steps were made before, where the equations have t. */
static int is_steps(const fp3_input *input) { return strcmp(input->name, FP3_NAME_STEPS) == 0; }

/* The second word of t of adaptive steps: a formula cannot be told of t. */
static int is_time(const writer *w, const fp3_input *input) {
    return input->low_of != FP3_NONE && input->low_of == fp3_model_adapted(w->program->model);
}

/* A number in the file, of which nothing is made. */
static int is_number(const writer *w, const fp3_input *input) {
    return is_steps(input) || is_time(w, input);
}

static void put_start(conditional *c) {
    const fp3_program *p = c->w->program;
    for (uint32_t i = 0; i < p->model->state_count; i++)
        if (i != fp3_model_adapted(p->model))
            put_condition(c, p->model->states[i].name, c->w->of.initial[i]);
    for (uint32_t i = 0; i < p->compiled->input_count; i++)
        if (is_steps(&p->compiled->inputs[i]))
            put_condition(c, FP3_NAME_STEPS, (double)c->w->inputs[i]);
}

/* With all that the value depends on. */
static void put_conditional(writer *w, const fp3_input *input, float value) {
    const fp3_model *model = w->program->model;
    conditional c = {.w = w};
    if (input->has_h)
        put_condition(&c, "h", w->of.h);
    for (uint32_t i = 0; i < model->param_count; i++)
        if (input->params >> i & 1)
            put_condition(&c, model->params[i].name, w->of.params[i]);
    if (input->has_start)
        put_start(&c);
    fputs(c.count ? " ? " : "", w->out);
    put_number(w, (double)value, 9);
    fputs(c.count ? " : 0/0" : "", w->out);
}

/* A state's start, or a param or h itself: not made of others. */
static int is_source(const writer *w, const fp3_input *input) {
    if (input->state != FP3_NONE)
        return 1;
    return input->rule && (strcmp(input->rule, "h") == 0 ||
                           fp3_model_param(w->program->model, input->rule) != FP3_NONE);
}

/* What is made of others, and numbers that are not a start. */
static void put_rules(writer *w) {
    const fp3_compiled *c = w->program->compiled;
    for (uint32_t i = 0; i < c->input_count; i++) {
        const fp3_input *input = &c->inputs[i];
        if (is_source(w, input)) {
            if (input->rule)
                name_in_rule(w, input->rule);
            continue;
        }
        fprintf(w->out, "%s = ", input->name);
        if (is_number(w, input)) {
            put_number(w, (double)w->inputs[i], 9);
            fputs(";\n", w->out);
            continue;
        }
        fputc('"', w->out);
        if (input->rule)
            put_renamed(w, input->rule);
        else
            put_conditional(w, input, w->inputs[i]);
        fputs("\";", w->out);
        if (!input->rule)
            fprintf(w->out, " # %s: for these values alone", input->formula);
        fputc('\n', w->out);
    }
}

/* No input of another meaning has the name. */
static fp3_status check_name(const writer *w, const char *name, fp3_error *error) {
    const fp3_compiled *c = w->program->compiled;
    for (uint32_t i = 0; i < c->input_count; i++)
        if (strcmp(c->inputs[i].name, name) == 0 && !is_source(w, &c->inputs[i]))
            return fp3_fail(error, FP3_E_PROGRAM,
                            "'%s' of the model has the name that the program gives to %s", name,
                            c->inputs[i].formula);
    return FP3_OK;
}

static fp3_status put_source(const writer *w, const char *own, double value, const char *comment,
                             fp3_error *error) {
    const char *name = name_in_file(w, own);
    fprintf(w->out, "%s = ", name);
    put_number(w, value, 17);
    fprintf(w->out, ";%s\n", comment);
    return check_name(w, name, error);
}

static int has_start(const fp3_compiled *c, const char *name) {
    for (uint32_t i = 0; i < c->input_count; i++)
        if (c->inputs[i].state != FP3_NONE && strcmp(c->inputs[i].name, name) == 0)
            return 1;
    return 0;
}

/* The starts, and what else the rules name. */
static fp3_status put_sources(const writer *w, fp3_error *error) {
    const fp3_model *model = w->program->model;
    const fp3_compiled *c = w->program->compiled;
    for (uint32_t i = 0; i < c->input_count; i++)
        if (c->inputs[i].state != FP3_NONE) {
            fprintf(w->out, "%s = ", c->inputs[i].name);
            put_number(w, w->of.initial[c->inputs[i].state], 17);
            fprintf(w->out, "; # %s\n", c->inputs[i].formula);
        }
    fp3_status status = w->has_h ? put_source(w, "h", w->of.h, " # time step", error) : FP3_OK;
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        if (w->params >> i & 1)
            status = put_source(w, model->params[i].name, w->of.params[i], "", error);
    for (uint32_t i = 0; !status && i < model->state_count; i++)
        if (w->states >> i & 1 && !has_start(c, model->states[i].name))
            status = put_source(w, model->states[i].name, w->of.initial[i], "", error);
    return status;
}

/* The rules come last, but what they name comes before. */
static fp3_status put_all(writer *w, FILE *out, fp3_error *error) {
    char *rules = NULL;
    size_t size;
    w->out = open_memstream(&rules, &size);
    if (w->out)
        put_rules(w);
    if (!w->out || fclose(w->out)) {
        free(rules);
        return fp3_no_memory(error);
    }
    w->out = out;
    if (fp3_adaptive_is(w->program->compiled->image))
        fputs("# Adaptive steps: fp3 run PROGRAM --params with this file runs until each object "
              "has come to `until`.\n",
              out);
    const fp3_status status = put_sources(w, error);
    fputs(rules, out);
    free(rules);
    return status;
}

fp3_status fp3_program_values_text(const fp3_program *program, const fp3_params *params,
                                   char **text, fp3_error *error) {
    FP3_HOST;
    size_t size = 0;
    writer w = {.program = program,
                .inputs = calloc(program->compiled->input_count + 1u, sizeof *w.inputs)};
    FILE *out = NULL;
    fp3_status status =
        w.inputs ? fp3_object_values_open(program, params, &w.of, error) : fp3_no_memory(error);
    *text = NULL;
    if (!status)
        status = fp3_object_values_at(&w.of, 0, error);
    if (!status)
        status = fp3_object_values_inputs(&w.of, w.inputs, error);
    if (!status && !(out = open_memstream(text, &size)))
        status = fp3_no_memory(error);
    if (!status)
        status = put_all(&w, out, error);
    if (out && fclose(out) && !status)
        status = fp3_no_memory(error);
    fp3_object_values_free(&w.of);
    free(w.inputs);
    return status;
}
