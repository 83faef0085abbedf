/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive.h - groups of a scene whose objects choose their steps. */
#ifndef FP3_SCENE_ADAPTIVE_H
#define FP3_SCENE_ADAPTIVE_H

#include <fp3/program.h>
#include <fp3/scene.h>

#include "base/settings.h"

/* The settings `tolerance`, `until` and `absolute` of a group. Nothing of a group without them. */
fp3_status fp3_scene_adaptive_read(const fp3_settings *s, const config_setting_t *from,
                                   fp3_program_def *def);

/* After the last group of the list. FP3_E_ARGUMENT: lifetimes in a scene with adaptive steps. */
fp3_status fp3_scene_adaptive_check(const fp3_settings *s, const config_setting_t *list,
                                    const fp3_scene *scene);

/* How many groups have adaptive steps. */
size_t fp3_scene_adaptive_count(const fp3_scene *scene);

#endif
