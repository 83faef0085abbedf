/* start.c - values of a program's inputs, rounded once. */
#include <fp3/start.h>

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "before.h"
#include "compiler/adaptive/adapted.h"
#include "compiler/compiled.h"
#include "compiler/inputs.h"
#include "text/number.h"

/* In double, and which number of the step's table it is; FP3_NONE: none, it is of a state's start. */
typedef struct {
    double value;
    uint32_t known;
} input;

/* " (line 3 of the model)", or nothing. */
static void say_line(const fp3_compilation *k, uint32_t id, char *text, size_t size) {
    const uint32_t line = id == FP3_NONE ? 0 : fp3_known_line(&k->p.step.known, id);
    text[0] = '\0';
    if (line)
        snprintf(text, size, " (line %" PRIu32 " of the model)", line);
}

static fp3_status round_all(const fp3_compiled *made, const input *inputs, float *values,
                            fp3_error *error) {
    for (uint32_t i = 0; i < made->input_count; i++) {
        const double wanted = inputs[i].value;
        char line[48];
        const char *expected = fp3_number_single(wanted, &values[i]);
        if (!expected && !isfinite(values[i]))
            expected = isnan(wanted) ? "a finite number, and none below 2.2e-308 on the way"
                                     : "a finite number";
        if (!expected)
            continue;
        say_line(made->self, inputs[i].known, line, sizeof line);
        return fp3_fail(error, FP3_E_ARGUMENT, "%s%s is %.9g: expected %s", made->inputs[i].formula,
                        line, wanted, expected);
    }
    return FP3_OK;
}

/* In the order of fp3_inputs_make. */
static uint32_t list(const fp3_compilation *k, const double *start, const double *known,
                     input *inputs) {
    const fp3_step *step = &k->p.step;
    const conversion *c = &k->p.code;
    uint32_t count = 0;
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (fp3_inputs_has_variable(&step->variables[i]))
            inputs[count++] = (input){start[i], FP3_NONE};
    for (uint32_t i = 0; i < c->code.param_count; i++)
        inputs[count++] = (input){known[c->params[i]], c->params[i]};
    for (uint32_t i = 0; i < c->code.constant_count; i++)
        if (fp3_inputs_has_constant(step, c, i))
            inputs[count++] = (input){known[c->constants[i]], c->constants[i]};
    return count;
}

fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error) {
    const fp3_compilation *k = compiled->self;
    const fp3_step *step = &k->p.step;
    double *known = calloc(step->known.count + 1u, sizeof *known);
    double *start = calloc(step->variable_count + 1u, sizeof *start);
    input *inputs = calloc(compiled->input_count + 1u, sizeof *inputs);
    fp3_status status =
        known && start && inputs ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_known_evaluate(&step->known, params, h, known, error);
    if (!status)
        status = fp3_adapted_check(step->model, &k->options, params, initial, error);
    if (!status)
        status = fp3_before_start(step, params, initial, h, start, error);
    if (!status) {
        const uint32_t count = list(k, start, known, inputs);
        assert(count == compiled->input_count);
        (void)count;
        status = round_all(compiled, inputs, values, error);
    }
    free(known);
    free(start);
    free(inputs);
    return status;
}
