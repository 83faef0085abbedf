/* SPDX-License-Identifier: Apache-2.0 */
/* scene_asked.c - see scene_asked.h. */
#include "scene_asked.h"

#include "base/definition.h"
#include "lab/scene/scaled.h"

#include <math.h>

#define APART 10    /* times `within`: the least tolerance */
#define WITHIN 1e-5 /* unless the tolerance asks for less */

void fp3_scene_tune_set_default(fp3_scene_tune_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    const fp3_scene_truth_def truth = fp3_scene_truth_default();
    def->safety = 2;
    def->sample = 2;
    def->held_out = 4;
    def->around = 1e-3;
    def->work = truth.work;
}

fp3_status fp3_scene_tune_settle(const fp3_scene_tune_def *asked, fp3_scene_tune_def *def,
                                 fp3_error *error) {
    *def = *asked;
    if (def->within == 0)
        def->within = fmin(WITHIN, def->tolerance / APART);
    if (!(def->tolerance > 0 && def->tolerance < 1))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "the tolerance is %g: expected a number above 0 and below 1",
                        def->tolerance);
    if (!(def->tolerance >= APART * def->within))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "the tolerance is %g: expected %d times what the solution is known "
                        "within, %g, or more",
                        def->tolerance, APART, def->within);
    if (!(def->safety >= 1 && isfinite(def->safety)) || !def->sample || !def->held_out ||
        !(def->around > 0 && def->around < 1))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "expected a safety of at least 1, scenes, and starts around a share above "
                        "0 and below 1");
    return FP3_OK;
}

fp3_status fp3_scene_tune_check(const fp3_scene *scene, fp3_error *error) {
    int sees = 0;
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        sees |= group->program->sees_others;
        if (group->program->model &&
            (float)fp3_scaled_step(group) != (float)fp3_scaled_step(&scene->groups[0]))
            return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)group->line, 0,
                               "found groups with steps of different lengths, expected one `h`");
    }
    return sees ? FP3_OK
                : fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)scene->line, 0,
                              "no object sees another one: fp3_tune is for objects that are "
                              "alone");
}
