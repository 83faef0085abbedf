/* inputs.c - names and formulas. */
#include "inputs.h"

#include "formula.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int fp3_inputs_has_variable(const variable *v) { return v->role != ROLE_CARRIED; }

int fp3_inputs_has_constant(const fp3_step *step, const conversion *c, uint32_t constant) {
    return step->known.list[c->constants[constant]].op != KNOWN_NUMBER;
}

typedef struct {
    fp3_input *list;
    uint32_t count;
} input_list;

/* Takes formula and rule. */
static fp3_status add(input_list *l, const char *name, int is_shared, uint32_t state, char *formula,
                      char *rule, fp3_error *error) {
    fp3_input *input = &l->list[l->count];
    if (!formula) {
        free(rule);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    *input = (fp3_input){.is_shared = is_shared, .state = state, .formula = formula, .rule = rule};
    snprintf(input->name, sizeof input->name, "%s", name);
    l->count++;
    return FP3_OK;
}

static char *variable_formula(const fp3_step *step, const variable *v) {
    char *text = NULL;
    if (v->role == ROLE_STEPS)
        return strdup("0");
    const char *name = step->model->states[v->state].name;
    if (asprintf(&text,
                 v->role == ROLE_STATE    ? "%s at the start"
                 : v->role == ROLE_BEFORE ? "%s at -h"
                                          : "0",
                 name) < 0)
        return NULL;
    return text;
}

static char *variable_rule(const variable *v) {
    return v->role == ROLE_LOST || v->role == ROLE_LOST_BEFORE ? strdup("0") : NULL;
}

static fp3_status add_all(const fp3_step *step, const conversion *c, const fp3_names *names,
                          input_list *l, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        if (fp3_inputs_has_variable(v))
            status = add(l, names->object[i], 0, v->role == ROLE_STATE ? v->state : FP3_NONE,
                         variable_formula(step, v), variable_rule(v), error);
    }
    for (uint32_t i = 0; !status && i < c->code.param_count; i++)
        status = add(l, names->object[step->variable_count + i], 0, FP3_NONE,
                     fp3_formula_known(&step->known, c->params[i]),
                     fp3_formula_rule(&step->known, c->params[i]), error);
    for (uint32_t i = 0; !status && i < c->code.constant_count; i++)
        if (fp3_inputs_has_constant(step, c, i))
            status = add(l, names->constant[i], 1, FP3_NONE,
                         fp3_formula_known(&step->known, c->constants[i]),
                         fp3_formula_rule(&step->known, c->constants[i]), error);
    return status;
}

fp3_status fp3_inputs_make(const fp3_step *step, const conversion *c, const fp3_names *names,
                           fp3_input **inputs, uint32_t *count, fp3_error *error) {
    const size_t most = step->variable_count + c->code.param_count + c->code.constant_count + 1u;
    input_list l = {.list = calloc(most, sizeof *l.list)};
    const fp3_status status = l.list ? add_all(step, c, names, &l, error)
                                     : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
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
