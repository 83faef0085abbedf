/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive_image.c - see adaptive_image.h. The compiler checks the values of a model
 * (sw/compiler/adaptive/adapted.c). */
#include "adaptive_image.h"

#include "values.h"

#include <fp3/engine.h>
#include <math.h>

/* *value stays what it is where the file has none; then the program says what it needs. */
static fp3_status take(const fp3_params *params, const char *name, double share, unsigned words,
                       double *value, int *is_any_spread, fp3_error *error) {
    int is_spread = 0;
    const fp3_status status =
        fp3_params_has(params, name)
            ? fp3_values_at(params, name, share, words, value, &is_spread, error)
            : FP3_OK;
    *is_any_spread |= is_spread;
    return status;
}

/* tolerance, absolute, locate and maxstep are no values of the program, but of what it gets. */
static fp3_status check_above_zero(const fp3_params *params, double share, unsigned words,
                                   int *is_spread, fp3_error *error) {
    static const char *const names[] = {"h_next", "tolerance", "absolute", "locate", "maxstep"};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof names / sizeof *names; i++) {
        double value = 1;
        status = take(params, names[i], share, words, &value, is_spread, error);
        if (!status && !(value > 0 && isfinite(value)))
            status =
                fp3_value_wrong(params, names[i], error,
                                "'%s' is %.9g: expected a finite number above 0", names[i], value);
    }
    return status;
}

fp3_status fp3_adaptive_image_check(const fp3_image *image, const fp3_params *params, double share,
                                    int *is_spread, fp3_error *error) {
    double t = 0, low = 0, until = 0;
    const unsigned words = fp3_values_words(image);
    *is_spread = 0;
    if (!fp3_adaptive_is(image))
        return FP3_OK;
    fp3_status status = check_above_zero(params, share, words, is_spread, error);
    if (!status)
        status = take(params, "t", share, words, &t, is_spread, error);
    if (!status)
        status = take(params, "t_low", share, words, &low, is_spread, error);
    if (!status && (float)((float)t + low) != (float)t)
        status = fp3_value_wrong(params, "t_low", error,
                                 "'t_low' is %.9g: expected the second word of t, %.9g, whose sum "
                                 "rounds to t",
                                 low, t);
    if (!status)
        status = take(params, "until", share, words, &until, is_spread, error);
    if (!status && !(until >= t && isfinite(until)))
        status = fp3_value_wrong(
            params, "until", error,
            "'until' is %.9g: expected a finite time that does not come before t, %.9g", until, t);
    return status;
}
