/* SPDX-License-Identifier: Apache-2.0 */
/* lifetime.c - see lifetime.h. */
#include "lifetime.h"

#include <inttypes.h>

/* Between two ends, rounded down. */
static uint64_t step_of(const fp3_scene_steps *steps, size_t object, size_t objects) {
    const uint64_t last = objects > 1 ? objects - 1 : 1;
    const int is_falling = steps->last < steps->first;
    const uint64_t least = is_falling ? steps->last : steps->first;
    const uint64_t width = is_falling ? steps->first - steps->last : steps->last - steps->first;
    const uint64_t place = is_falling ? last - object : object;
    return least + width / last * place + width % last * place / last;
}

void fp3_scene_life(const fp3_scene_group *group, size_t object, uint64_t *born, uint64_t *gone) {
    *born = step_of(&group->born, object, group->objects);
    *gone = step_of(&group->gone, object, group->objects);
}

int fp3_lifetime_is_any(const fp3_scene_group *group) {
    return group->born.first || group->born.last || group->gone.first != FP3_FOREVER ||
           group->gone.last != FP3_FOREVER;
}

/* ---- the file ---- */

static fp3_status read_pair(const fp3_settings *s, const config_setting_t *at, const char *what,
                            fp3_scene_steps *steps) {
    if (config_setting_length(at) != 2)
        return fp3_setting_expected(s, at, what, "a step, or two: [FIRST, LAST]");
    fp3_status status =
        fp3_setting_count(s, config_setting_get_elem(at, 0), what, 0, UINT32_MAX, &steps->first);
    return status ? status
                  : fp3_setting_count(s, config_setting_get_elem(at, 1), what, 0, UINT32_MAX,
                                      &steps->last);
}

static fp3_status read_steps(const fp3_settings *s, const config_setting_t *from, const char *what,
                             fp3_scene_steps *steps) {
    const config_setting_t *at = config_setting_get_member(from, what);
    if (!at)
        return FP3_OK;
    if (fp3_setting_is_list(at))
        return read_pair(s, at, what, steps);
    const fp3_status status = fp3_setting_count(s, at, what, 0, UINT32_MAX, &steps->first);
    steps->last = steps->first;
    return status;
}

/* Of all objects, as steps between are rounded. */
static fp3_status check(const fp3_settings *s, const config_setting_t *from,
                        const fp3_scene_group *group) {
    const config_setting_t *at = config_setting_get_member(from, "gone");
    for (size_t i = 0; at && i < group->objects; i++) {
        uint64_t born, gone;
        fp3_scene_life(group, i, &born, &gone);
        if (gone <= born)
            return fp3_setting_wrong(s, at,
                                     "gone: object %zu of this group is gone after step %" PRIu64
                                     ", expected a step after its birth, %" PRIu64,
                                     i, gone, born);
    }
    return FP3_OK;
}

fp3_status fp3_lifetime_read(const fp3_settings *s, const config_setting_t *from,
                             fp3_scene_group *to) {
    to->gone = (fp3_scene_steps){FP3_FOREVER, FP3_FOREVER};
    fp3_status status = read_steps(s, from, "born", &to->born);
    if (!status)
        status = read_steps(s, from, "gone", &to->gone);
    return status ? status : check(s, from, to);
}

/* ---- the engine ---- */

fp3_status fp3_lifetime_apply(const fp3_scene_group *group, fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && fp3_lifetime_is_any(group) && i < group->objects; i++) {
        uint64_t born, gone;
        fp3_scene_life(group, i, &born, &gone);
        status = fp3_engine_live(engine, group->first + i, 1, born, gone);
    }
    return status;
}
