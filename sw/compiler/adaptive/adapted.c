/* adapted.c - see adapted.h. */
#include "adapted.h"

#include <fp3/compile.h>
#include <math.h>

/* An update of a state rounds it by up to half of 2^-23: a tolerance below that is never met. What is compensated
 * loses a like part of what a step adds to a state, some sixteenth of it. */
#define TOLERANCE_LEAST 0x1p-23
#define TOLERANCE_LEAST_COMPENSATED 0x1p-27
#define TOLERANCE_LEAST_DOUBLE 0x1p-40 /* below that the estimate, in floats, is all rounding */
#define ABSOLUTE_LEAST 0x1p-100 /* its reciprocal, squared with an error of its size, is in range */

static fp3_status check_tolerance(double tolerance, const fp3_options *options, fp3_error *error) {
    const double least = options->arithmetic == FP3_DOUBLE_SINGLE ? TOLERANCE_LEAST_DOUBLE
                         : options->arithmetic == FP3_COMPENSATED ? TOLERANCE_LEAST_COMPENSATED
                                                                  : TOLERANCE_LEAST;
    if (tolerance >= least && tolerance <= 1)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT,
                    "'tolerance' is %.9g: expected a number from %.3g, %s, to 1", tolerance, least,
                    options->arithmetic == FP3_DOUBLE_SINGLE
                        ? "which the estimate of double-single can tell"
                    : options->arithmetic == FP3_COMPENSATED
                        ? "which a compensated update can keep"
                        : "to which FP32 rounds a state in each step (compensated: 7.45e-09)");
}

fp3_status fp3_adapted_check(const fp3_model *model, const fp3_options *options,
                             const double *params, const double *initial, fp3_error *error) {
    const uint32_t t = fp3_model_adapted(model);
    if (t == FP3_NONE)
        return FP3_OK;
    const double absolute = params[fp3_model_param(model, "absolute")];
    const double until = params[fp3_model_param(model, "until")];
    const uint32_t locate = fp3_model_param(model, "locate");
    const fp3_status status =
        check_tolerance(params[fp3_model_param(model, "tolerance")], options, error);
    if (status)
        return status;
    if (!(absolute >= ABSOLUTE_LEAST && isfinite(absolute)))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'absolute' is %.9g: expected a finite number from %.3g on", absolute,
                        ABSOLUTE_LEAST);
    if (!(until >= initial[t] && isfinite(until)))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "'until' is %.9g: expected a finite time that does not come before t, %.9g",
                        until, initial[t]);
    if (!(initial[t + 1] > 0 && isfinite(initial[t + 1])))
        return fp3_fail(error, FP3_E_ARGUMENT, "'h_next' is %.9g: expected a finite number above 0",
                        initial[t + 1]);
    if (locate != FP3_NONE && !(params[locate] > 0 && isfinite(params[locate])))
        return fp3_fail(error, FP3_E_ARGUMENT, "'locate' is %.9g: expected a finite number above 0",
                        params[locate]);
    return FP3_OK;
}
