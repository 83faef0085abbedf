/* fp3/start.h - what the inputs of a compiled program are for an object.
 *
 *     float *values = malloc(compiled->input_count * sizeof *values);
 *     const double start[] = {0, 0}, params[] = {8.7e5, 2.9e5, 4.1e4};
 *     if (fp3_compiled_inputs(compiled, params, start, 0.0078125, values, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     for (size_t i = 0; i < compiled->input_count; i++)
 *         fp3_engine_set(engine, compiled->inputs[i].name, values[i]);
 *     free(values);
 */
#ifndef FP3_START_H
#define FP3_START_H

#include <fp3/api.h>
#include <fp3/compile.h>

FP3_API_BEGIN

/* values[i] of inputs[i] for an object with these params and start (model->param_count and
 * state_count numbers) at time 0, and time step h; `steps`, if it is an input, is 0. Computed in
 * double, rounded once. FP3_E_ARGUMENT: h is not above 0, a value is not finite, or one other than 0
 * rounds to 0 or an infinity. */
fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error);

FP3_API_END

#endif
