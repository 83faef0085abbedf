/* SPDX-License-Identifier: Apache-2.0 */
/* only.h - values of some objects of a group. */
#ifndef FP3_SCENE_ONLY_H
#define FP3_SCENE_ONLY_H

#include "base/settings.h"

#include <fp3/scene.h>

/* The setting `only` of a group, whose program, objects and other values are there. */
fp3_status fp3_only_read(const fp3_settings *s, const config_setting_t *from,
                         const fp3_scene_group *group);

#endif
