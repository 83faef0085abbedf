/* start.c - values of a program's inputs, rounded once. */
#include <fp3/start.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "before.h"
#include "compiler/compiled.h"
#include "compiler/inputs.h"
#include "text/number.h"

static fp3_status round_all(const fp3_compiled *made, const double *wanted, float *values,
                            fp3_error *error) {
    for (uint32_t i = 0; i < made->input_count; i++) {
        const char *expected = fp3_number_single(wanted[i], &values[i]);
        if (!expected && !isfinite(values[i]))
            expected = isnan(wanted[i]) ? "a finite number, and none below 2.2e-308 on the way"
                                        : "a finite number";
        if (expected)
            return fp3_fail(error, FP3_E_ARGUMENT, "'%s' = %s is %.9g: expected %s",
                            made->inputs[i].name, made->inputs[i].formula, wanted[i], expected);
    }
    return FP3_OK;
}

/* In the order of fp3_inputs_make. */
static uint32_t list(const fp3_compilation *k, const double *start, const double *known,
                     double *wanted) {
    const fp3_step *step = &k->p.step;
    const conversion *c = &k->p.code;
    uint32_t count = 0;
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (fp3_inputs_has_variable(&step->variables[i]))
            wanted[count++] = start[i];
    for (uint32_t i = 0; i < c->code.param_count; i++)
        wanted[count++] = known[c->params[i]];
    for (uint32_t i = 0; i < c->code.constant_count; i++)
        if (fp3_inputs_has_constant(step, c, i))
            wanted[count++] = known[c->constants[i]];
    return count;
}

fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error) {
    const fp3_compilation *k = compiled->self;
    const fp3_step *step = &k->p.step;
    double *known = calloc(step->known.count + 1u, sizeof *known);
    double *start = calloc(step->variable_count + 1u, sizeof *start);
    double *wanted = calloc(compiled->input_count + 1u, sizeof *wanted);
    fp3_status status =
        known && start && wanted ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_known_evaluate(&step->known, params, h, known, error);
    if (!status)
        status = fp3_before_start(step, params, initial, h, start, error);
    if (!status) {
        const uint32_t count = list(k, start, known, wanted);
        assert(count == compiled->input_count);
        (void)count;
        status = round_all(compiled, wanted, values, error);
    }
    free(known);
    free(start);
    free(wanted);
    return status;
}
