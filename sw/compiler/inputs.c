/* SPDX-License-Identifier: Apache-2.0 */
/* inputs.c - names and formulas. */
#include "inputs.h"

#include "compiler/value/formula.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int fp3_inputs_has_variable(const variable *v) {
    return v->role != ROLE_CARRIED && v->role != ROLE_WORST && v->role != ROLE_LIST &&
           v->role != ROLE_SLEPT; /* awake, without a word */
}

int fp3_inputs_has_constant(const fp3_step *step, const conversion *c, uint32_t constant) {
    return step->known.list[c->constants[constant]].op != KNOWN_NUMBER;
}

typedef struct {
    fp3_input *list;
    uint32_t count;
} input_list;

/* Takes what.formula and what.rule. */
static fp3_status add(input_list *l, const char *name, fp3_input what, fp3_error *error) {
    if (!what.formula) {
        free(what.rule);
        return fp3_no_memory(error);
    }
    snprintf(what.name, sizeof what.name, "%s", name);
    l->list[l->count++] = what;
    return FP3_OK;
}

static char *variable_formula(const fp3_step *step, const variable *v) {
    char *text = NULL;
    if (v->role == ROLE_STEPS || v->role == ROLE_STOPPED)
        return strdup("0");
    const char *name = step->model->states[v->state].name;
    if (asprintf(&text,
                 v->role == ROLE_STATE         ? "%s at the start"
                 : v->role == ROLE_BEFORE      ? "%s at -h"
                 : v->role == ROLE_LOW         ? "second word of %s at the start"
                 : v->role == ROLE_LOW_BEFORE  ? "second word of %s at -h"
                 : v->role == ROLE_LOST_BEFORE ? "what rounding takes off the way of %s from -h"
                                               : "0",
                 name) < 0)
        return NULL;
    return text;
}

static char *variable_rule(const variable *v) {
    return v->role == ROLE_LOST || v->role == ROLE_STOPPED ? strdup("0") : NULL;
}

static fp3_input variable_input(const fp3_step *step, const variable *v) {
    const int is_before =
        v->role == ROLE_BEFORE || v->role == ROLE_LOW_BEFORE || v->role == ROLE_LOST_BEFORE;
    return (fp3_input){.state = v->role == ROLE_STATE ? v->state : FP3_NONE,
                       .low_of = v->role == ROLE_LOW ? v->state : FP3_NONE,
                       .formula = variable_formula(step, v),
                       .rule = variable_rule(v),
                       .params = is_before ? UINT64_MAX : 0,
                       .has_h = is_before,
                       .has_start = is_before || v->role == ROLE_LOW};
}

static fp3_input known_input(const fp3_step *step, uint32_t id, int is_shared) {
    fp3_input input = {.is_shared = is_shared,
                       .state = FP3_NONE,
                       .low_of = FP3_NONE,
                       .formula = fp3_formula_known(&step->known, id),
                       .rule = fp3_formula_rule(&step->known, id)};
    input.params = fp3_known_params(&step->known, id, &input.has_h);
    return input;
}

static fp3_status add_all(const fp3_step *step, const conversion *c, const fp3_names *names,
                          input_list *l, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < step->variable_count; i++)
        if (fp3_inputs_has_variable(&step->variables[i]))
            status = add(l, names->object[fp3_code_variable(&c->code, i)],
                         variable_input(step, &step->variables[i]), error);
    for (uint32_t i = 0; !status && i < c->code.param_count; i++)
        status = add(l, names->object[fp3_code_param(&c->code, i)],
                     known_input(step, c->params[i], 0), error);
    for (uint32_t i = 0; !status && i < c->code.constant_count; i++)
        if (fp3_inputs_has_constant(step, c, i))
            status = add(l, names->constant[i], known_input(step, c->constants[i], 1), error);
    return status;
}

fp3_status fp3_inputs_make(const fp3_step *step, const conversion *c, const fp3_names *names,
                           fp3_input **inputs, uint32_t *count, fp3_error *error) {
    const size_t most = step->variable_count + c->code.param_count + c->code.constant_count + 1u;
    input_list l = {.list = calloc(most, sizeof *l.list)};
    const fp3_status status = l.list ? add_all(step, c, names, &l, error) : fp3_no_memory(error);
    *inputs = l.list;
    *count = l.count;
    return status;
}

void fp3_inputs_free(fp3_input *inputs, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        free(inputs[i].formula);
        free(inputs[i].rule);
    }
    free(inputs);
}
