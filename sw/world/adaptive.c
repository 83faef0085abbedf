/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive.c - see adaptive.h. */
#include "adaptive.h"

#include "lifetime.h"

#include <fp3/engine.h>

size_t fp3_scene_adaptive_count(const fp3_scene *scene) {
    size_t count = 0;
    for (size_t i = 0; i < scene->group_count; i++)
        count += fp3_adaptive_is(scene->groups[i].program->image) != 0;
    return count;
}

/* ---- the file ---- */

/* *number stays 0 if it is not there. */
static fp3_status read_above_zero(const fp3_settings *s, const config_setting_t *from,
                                  const char *name, double *number) {
    const config_setting_t *at = config_setting_get_member(from, name);
    fp3_status status = at ? fp3_setting_number(s, at, name, number) : FP3_OK;
    if (!status && at && !(*number > 0))
        status = fp3_setting_expected(s, at, name, "a number above 0");
    return status;
}

fp3_status fp3_scene_adaptive_read(const fp3_settings *s, const config_setting_t *from,
                                   fp3_program_def *def) {
    const config_setting_t *tolerance = config_setting_get_member(from, "tolerance");
    const config_setting_t *until = config_setting_get_member(from, "until");
    const config_setting_t *absolute = config_setting_get_member(from, "absolute");
    const config_setting_t *maxstep = config_setting_get_member(from, "maxstep");
    if (!tolerance && (absolute || maxstep))
        return fp3_setting_wrong(
            s, absolute ? absolute : maxstep,
            "%s: expected a tolerance, too: without a tolerance all steps are h long",
            absolute ? "absolute" : "maxstep");
    if (!tolerance && !until)
        return FP3_OK;
    if (!until)
        return fp3_setting_wrong(s, tolerance,
                                 "tolerance: expected 'until', too, the time at which the objects "
                                 "of this group end");
    def->adaptive.tolerance = 0;
    fp3_status status = read_above_zero(s, from, "tolerance", &def->adaptive.tolerance);
    if (!status)
        status = read_above_zero(s, from, "until", &def->adaptive.until);
    if (!status)
        status = read_above_zero(s, from, "absolute", &def->adaptive.absolute);
    if (!status)
        status = read_above_zero(s, from, "maxstep", &def->adaptive.maxstep);
    def->is_adaptive = 1;
    return status;
}

fp3_status fp3_scene_adaptive_check(const fp3_settings *s, const config_setting_t *list,
                                    const fp3_scene *scene) {
    for (size_t i = 0; fp3_scene_adaptive_count(scene) && i < scene->group_count; i++) {
        const config_setting_t *group = config_setting_get_elem(list, (unsigned)i);
        const config_setting_t *born = config_setting_get_member(group, "born");
        if (fp3_lifetime_is_any(&scene->groups[i]))
            return fp3_setting_wrong(
                s, born ? born : config_setting_get_member(group, "gone"),
                "born, gone: are steps that a scene has in common, and objects "
                "with a tolerance choose their own");
    }
    return FP3_OK;
}
