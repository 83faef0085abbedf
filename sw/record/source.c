/* SPDX-License-Identifier: Apache-2.0 */
/* source.c - see source.h. */
#include "source.h"

#include "base/number.h"

#include <string.h>

static fp3_status take_h(fp3_source *source, double given, fp3_error *error) {
    float h;
    const char *expected = fp3_number_step(given, &h);
    if (expected)
        return fp3_fail(error, FP3_E_ARGUMENT, "'h' is %.9g: expected %s", given, expected);
    source->has_time = 1;
    source->h = (double)h;
    if (source->program->compiled && source->program->compiled->arithmetic == FP3_DOUBLE_SINGLE)
        source->h += (double)(float)(given - (double)h);
    source->h_given = given;
    return FP3_OK;
}

fp3_status fp3_source_find_h(fp3_source *source, fp3_error *error) {
    const fp3_image *image = source->program->image;
    double given = source->program->model ? source->program->model->step : 0;
    fp3_status status = FP3_OK;
    source->has_time = 0;
    if (!source->program->model &&
        !fp3_image_find(image, FP3_NAME_STEP, FP3_CLASS(FP3_SYMBOL_SHARED)))
        return FP3_OK;
    if (fp3_params_has(source->params, FP3_NAME_STEP))
        status = fp3_params_get(source->params, FP3_NAME_STEP, &given, error);
    return status ? status : take_h(source, given, error);
}
