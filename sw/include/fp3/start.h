/* fp3/start.h - what the inputs of a compiled program are for an object.
 *
 *     float values[...];   program->input_count of them
 *     fp3_compiled_inputs(program, params, initial, h, values, &error);
 *     ... write each: program->inputs[i].name ...
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
